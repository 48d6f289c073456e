"""The work of `ins-frames`: flights, algorithms, and the errors of every algorithm in every flight."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Literal

import numpy as np

from bench.campaign import Item
from bench.errors import Array, InputError, require_array, require_integer, require_scalar
from bench.motion.fast_vehicle import FastVehicle
from bench.rotation import quat_conjugate, quat_from_rotvec, quat_multiply, quat_normalize, quat_rotate
from bench.solvers.navigation import NavigationSolver
from bench.table import Table
from bench.trajectory import NavigationErrors, NavigationInitial, Trajectory, navigation_errors
from bench.units import ARCSEC, DEG

SPEEDS = (300.0, 3000.0, 7000.0)  # m/s
RATE, DURATION = 100.0, 100.0  # Hz, s
SAMPLES = 2  # increments per update
BEST_SAMPLES = 6  # of the best algorithm
WEAVE = (50.0, 30.0, 20.0)  # m, about half a g on each axis with the periods of the motion
HARSH = 20  # times the weave
SWING = (10 * DEG, 10 * DEG, 10 * DEG)  # of yaw, pitch and roll, at 1 Hz
MEASURES = ("attitude_arcsec", "velocity_m_per_s", "position_m")
# What rounding does to these runs: how far the dual quaternion gets from itself in turned body axes, rounded up.
FLOORS = {"attitude_arcsec": 2e-8, "velocity_m_per_s": 1e-9, "position_m": 1e-7}
TURNS = tuple(quat_from_rotvec(turn) for turn in ([0.5, 0.7, 0.9], [-1.1, 0.4, 2.0]))  # of the body axes
COLUMNS = ("part", "flight", "speed_m_per_s", "weave", "swing", "algorithm", "samples", "rate_hz", *MEASURES)


@dataclass(frozen=True)
class Flight:
    """One scenario.

    Attributes
    ----------
    speed : float, m/s
    weave : int
        Times the amplitudes of `WEAVE`; 0 is a level flight at constant speed.
    swing : bool
        Whether the attitude moves, 10 degrees at 1 Hz on each axis.
    """

    speed: float
    weave: int
    swing: bool

    @property
    def label(self) -> str:
        """How rows and tables name it."""
        return f"{self.speed:g} m/s, {MANOEUVRES[self.weave]}{', swing' if self.swing else ''}"

    @property
    def motion(self) -> FastVehicle:
        """The flight as a motion."""
        return FastVehicle(
            speed=self.speed,
            weave=(self.weave * WEAVE[0], self.weave * WEAVE[1], self.weave * WEAVE[2]),
            swing=SWING if self.swing else (0.0, 0.0, 0.0),
        )


MANOEUVRES = {0: "level", 1: "weave", HARSH: f"weave x {HARSH}"}
CENTRAL = Flight(3000.0, 0, True)  # of convergence and timings


@dataclass(frozen=True)
class Algorithm:
    """A navigation solver with its options, under the name that it has in rows and figures."""

    label: str
    solver: str
    options: tuple[tuple[str, Any], ...] = ()

    def make(self, samples: int = SAMPLES) -> NavigationSolver:
        """Return the solver for N samples."""
        from bench.solvers import solver

        made: NavigationSolver = solver("navigation", self.solver, samples=samples, **dict(self.options))
        return made


EXACT, FIRST = (("rotation", "exact"),), (("rotation", "first-order"),)
CONVENTIONAL = Algorithm("conventional", "navigation-frame", EXACT)
CONVENTIONAL_FIRST = Algorithm("conventional, first-order", "navigation-frame", FIRST)
IMPROVED = Algorithm("improved", "inertial-frame", EXACT)
IMPROVED_FIRST = Algorithm("improved, first-order", "inertial-frame", FIRST)
DUAL = Algorithm("dual quaternion", "dual-quaternion")
POLYNOMIAL = Algorithm("polynomial exact", "polynomial-exact")
BEST = Algorithm(f"polynomial exact, N = {BEST_SAMPLES}", "polynomial-exact")
NEW = (IMPROVED, DUAL)
TWO_SAMPLE = (CONVENTIONAL_FIRST, CONVENTIONAL, IMPROVED_FIRST, IMPROVED, DUAL, POLYNOMIAL)
GENERAL = (CONVENTIONAL, IMPROVED, DUAL, POLYNOMIAL)  # compared over N
PAIRS = {  # differences of two estimates, and what they are due to
    "rotation compensation, conventional": (CONVENTIONAL_FIRST, CONVENTIONAL),
    "rotation compensation, improved": (IMPROVED_FIRST, IMPROVED),
    "frame": (CONVENTIONAL, IMPROVED),
    "dual quaternion against improved, first-order": (DUAL, IMPROVED_FIRST),
    "dual quaternion against improved": (DUAL, IMPROVED),
    "formulas": (IMPROVED, POLYNOMIAL),
}

ROUNDING = "dual quaternion against itself in turned axes"


def postponed(every: int) -> Algorithm:
    """Return the conventional algorithm that compensates the rotation of n at every k-th update only."""
    return Algorithm(f"conventional, n every {every}", "navigation-frame", (*EXACT, ("compensate_every", every)))


@dataclass(frozen=True)
class Options:
    """Options of the experiment; the defaults are the conditions at which claims are judged.

    Attributes
    ----------
    speeds : tuple of float
        Speeds of the flights, m/s.
    duration : float
        Length of each flight, s.
    rate : float
        Sampling rate, Hz.
    postponed : tuple of int
        Updates from one compensation of the rotating n to the next, in conventional codes that postpone it.
    rates : tuple of float
        Sampling rates over which errors are shown, Hz.
    max_samples : int
        Largest number of increments per update over which errors are shown, 2 to 8.
    repeats : int
        Timings of which the median is reported; 0 for none.
    timed_updates : int
        Updates in one timing.
    """

    speeds: tuple[float, ...] = SPEEDS
    duration: float = DURATION
    rate: float = RATE
    postponed: tuple[int, ...] = (2, 10, 50, 100)
    rates: tuple[float, ...] = (25.0, 50.0, 100.0, 200.0, 400.0)
    max_samples: int = 8
    repeats: int = 21
    timed_updates: int = 4096

    def __post_init__(self) -> None:
        from bench.rig import whole_intervals

        duration = require_scalar("duration", self.duration, positive=True)
        for name in ("speeds", "rates"):
            values = tuple(float(value) for value in require_array(name, getattr(self, name), (None,)))
            if len(set(values)) < len(values) or min(values) <= 0:
                raise InputError(f"{name} must be different positive numbers, got {values}")
            object.__setattr__(self, name, values)
        for rate in (require_scalar("rate", self.rate, positive=True), *self.rates):
            if (n := whole_intervals(rate, duration)) < NavigationSolver.max_samples:
                raise InputError(
                    f"duration must hold at least {NavigationSolver.max_samples} intervals, got {n} at {rate:g} Hz"
                )
        every = tuple(require_integer("postponed", k, minimum=2) for k in self.postponed)
        if not every or len(set(every)) < len(every):
            raise InputError(f"postponed must be different integers >= 2, got {every}")
        object.__setattr__(self, "postponed", every)
        if not 2 <= require_integer("max_samples", self.max_samples, minimum=2) <= NavigationSolver.max_samples:
            limit = NavigationSolver.max_samples
            raise InputError(f"max_samples must be an integer from 2 to {limit}, got {self.max_samples}")
        require_integer("repeats", self.repeats, minimum=0)
        require_integer("timed_updates", self.timed_updates, minimum=1)


@dataclass(frozen=True)
class Work:
    """All algorithms in one flight at one rate."""

    options: Options
    part: Literal["flight", "rate", "samples"]
    flight: Flight
    rate: float


def flights(options: Options) -> list[Flight]:
    """Return all flights."""
    return [Flight(v, weave, swing) for swing in (False, True) for weave in MANOEUVRES for v in options.speeds]


def items(options: Options, seed: int) -> list[Item]:
    """Return one item for each flight, each rate and the numbers of samples; nothing is random."""
    work = [Work(options, "samples", CENTRAL, options.rate)]
    work += [Work(options, "rate", CENTRAL, rate) for rate in sorted(options.rates, reverse=True)]
    work += [Work(options, "flight", flight, options.rate) for flight in flights(options)]
    return [Item(f"{k:02d}-{one.part}", one) for k, one in enumerate(work)]


@lru_cache(maxsize=2)
def increments(flight: Flight, rate: float, duration: float) -> tuple[Array, Array]:
    """Return the increments of a flight by MuJoCo, dtheta_b (n, 3), rad, and dvel (n, 3), m/s."""
    from bench.rig import Rig

    found = Rig.load("imu", threads=1).increments(flight.motion, rate, duration)
    assert found.dtheta_b is not None  # the model has a gyro
    return found.dtheta_b, found.dvel


@lru_cache(maxsize=8)
def truth(flight: Flight, rate: float, updates: int, samples: int) -> Trajectory:
    """Return the true trajectory at the start and at every update of N samples."""
    return flight.motion.trajectory(np.arange(updates + 1) * samples / rate)


def fly(flight: Flight, algorithm: Algorithm, rate: float, duration: float, samples: int = SAMPLES) -> Trajectory:
    """Return the estimate of an algorithm, over as many whole updates as the flight holds."""
    dtheta_b, dvel = increments(flight, rate, duration)
    n, motion = len(dtheta_b) // samples * samples, flight.motion
    initial = motion.navigation_initial()
    return algorithm.make(samples).solve(dtheta_b[:n], dvel[:n], 1 / rate, initial, motion.earth)


def fly_turned(flight: Flight, algorithm: Algorithm, rate: float, duration: float, turn: Array) -> Trajectory:
    """Return what `fly` does, computed in body axes that are turned: equal, if it were not for rounding."""
    dtheta_b, dvel = (quat_rotate(turn, part) for part in increments(flight, rate, duration))
    n, motion = len(dtheta_b) // SAMPLES * SAMPLES, flight.motion
    true = motion.navigation_initial()
    place = {"latitude": true.latitude, "longitude": true.longitude, "height": true.height}
    initial = NavigationInitial(quat_multiply(true.q_nb, quat_conjugate(turn)), true.v_n, **place)
    found = algorithm.make().solve(dtheta_b[:n], dvel[:n], 1 / rate, initial, motion.earth)
    return replace(found, q_eb=quat_normalize(quat_multiply(found.q_eb, turn)))


def errors(flight: Flight, estimate: Trajectory, rate: float, samples: int = SAMPLES) -> NavigationErrors:
    """Return the errors of an estimate made by `fly`."""
    return navigation_errors(estimate, truth(flight, rate, len(estimate) - 1, samples))


def lengths(found: NavigationErrors) -> Array:
    """Return |attitude error|, arcsec, |velocity error|, m/s, and |position error|, m, shape (n, 3)."""
    parts = (found.attitude / ARCSEC, found.velocity, found.position)
    return np.stack([np.linalg.norm(part, axis=1) for part in parts], axis=1)


def measure(work: Work) -> Table:
    """Return the largest errors of the algorithms in one flight at one rate."""
    options, flight, rate = work.options, work.flight, work.rate
    found: dict[tuple[str, int], Array] = {}
    if work.part == "samples":
        for samples in range(1, options.max_samples + 1):
            for algorithm in GENERAL:
                estimate = fly(flight, algorithm, rate, options.duration, samples)
                found[algorithm.label, samples] = lengths(errors(flight, estimate, rate, samples))
        return _rows("samples", flight, rate, found)
    chosen = list(TWO_SAMPLE)
    if work.part == "flight":
        chosen += [postponed(every) for every in options.postponed]
    estimates = {algorithm: fly(flight, algorithm, rate, options.duration) for algorithm in chosen}
    for algorithm, estimate in estimates.items():
        found[algorithm.label, SAMPLES] = lengths(errors(flight, estimate, rate))
    best = fly(flight, BEST, rate, options.duration, BEST_SAMPLES)
    found[BEST.label, BEST_SAMPLES] = lengths(errors(flight, best, rate, BEST_SAMPLES))
    rows = [_rows(work.part, flight, rate, found)]
    if work.part == "flight":
        apart = {
            (what, SAMPLES): lengths(navigation_errors(estimates[a], estimates[b])) for what, (a, b) in PAIRS.items()
        }
        just_compensated = {
            (algorithm.label, SAMPLES): found[algorithm.label, SAMPLES][:: dict(algorithm.options)["compensate_every"]]
            for algorithm in (postponed(every) for every in options.postponed)
        }
        again = [fly_turned(flight, DUAL, rate, options.duration, turn) for turn in TURNS]
        rounding = np.concatenate([lengths(navigation_errors(one, estimates[DUAL])) for one in again])
        rows += [
            _rows("difference", flight, rate, {**apart, (ROUNDING, SAMPLES): rounding}),
            _rows("compensated", flight, rate, just_compensated),
        ]
    return Table.concatenate(rows)


def _rows(part: str, flight: Flight, rate: float, found: Mapping[tuple[str, int], Array]) -> Table:
    """Return a row of largest values for each (algorithm, samples)."""
    about = (part, flight.label, flight.speed, flight.weave, flight.swing)
    rows = [(*about, label, N, rate, *values.max(axis=0).tolist()) for (label, N), values in found.items()]
    return Table.from_rows(COLUMNS, rows, "Largest errors over the flight")
