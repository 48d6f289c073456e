"""What the dual-Euler experiments share: the swing and the driven table, sensor errors, and the navigation of both."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from bench.campaign import Item
from bench.errors import Array, InputError, require_integer, require_scalar
from bench.experiments._ins_frames_trials import Algorithm
from bench.imu.grades import grade
from bench.motion._earth_motion import EarthMotion
from bench.motion.earth_rest import EarthRest
from bench.trajectory import Trajectory
from bench.units import DEG

LATITUDE, LONGITUDE = 32.06 * DEG, 118.8 * DEG  # stated
RATE, DURATION = 100.0, 2500.0  # Hz, s: stated
AMPLITUDE, PERIOD = 90 * DEG, 256.0  # of the pitch swing: stated
RATES = (0.015, 0.15)  # deg/s, of the table: as stated, and one that reaches the poles
CHUNK = 250  # trials: a driven table costs as much as these
ENOUGH = 100  # trials, from which shares of 5 % can be told
REPORT = 25.0  # s, between reported errors
GRADE = "lyu"

HELD = (("height", "held"),)
DUAL = Algorithm("dual Euler", "dual-euler", HELD)
QUATERNION = Algorithm("quaternion", "navigation-frame", HELD)


@dataclass(frozen=True)
class Swing:
    """The simulation: heading and roll zero, the pitch swings between both poles."""

    duration: float = DURATION

    @property
    def label(self) -> str:
        """How rows and tables name it."""
        return "swing"

    def motion(self) -> EarthMotion:
        """Return the motion on the rotating Earth."""
        return EarthRest(
            latitude=LATITUDE,
            longitude=LONGITUDE,
            swing=(0.0, AMPLITUDE, 0.0),
            swing_frequency=(1.0, 2 * np.pi / PERIOD, 1.0),
        )


@dataclass(frozen=True)
class DrivenTable:
    """The driven table: at rest, then its middle axis to and fro at a constant rate between -90 and 90 degrees.

    Attributes
    ----------
    rate_deg_per_s : float
    rest : float, s
        Before the axis moves.
    fluctuation_deg_per_s : float
        RMS of what manual operation adds to the rate.
    seed : int
        Of that.
    duration : float, s
    """

    rate_deg_per_s: float
    rest: float = 100.0
    fluctuation_deg_per_s: float = 0.001
    seed: int = 0
    duration: float = DURATION

    @property
    def label(self) -> str:
        """How rows and tables name it."""
        return f"{self.rate_deg_per_s:g} deg/s"

    def motion(self) -> EarthMotion:
        """Return the motion that MuJoCo's dynamics make of the commands, on the rotating Earth."""
        from bench.turntable import Profile, Turntable

        profile = Profile(
            rate=(0.0, self.rate_deg_per_s * DEG, 0.0),
            limit=(90 * DEG, 90 * DEG, 90 * DEG),
            rest=self.rest,
            fluctuation=(0.0, self.fluctuation_deg_per_s * DEG, 0.0),
            seed=self.seed,
        )
        return Turntable().drive(profile, self.duration).motion(LATITUDE, LONGITUDE)


Case = Swing | DrivenTable


@dataclass(frozen=True)
class Work:
    """Some trials of one case; the first chunk does the ideal runs too."""

    case: Case
    seed: int
    first: int
    count: int


@dataclass(frozen=True)
class TableOptions:
    """Options of the experiment; the defaults are the conditions at which claims are judged.

    Attributes
    ----------
    trials : int
        Monte Carlo trials over sensor errors, for each rate.
    duration : float
        Length of the run, s.
    rates : tuple of float
        Of the middle axis, deg/s.
    rest : float
        Time at rest before the axis moves, s.
    fluctuation : float
        RMS of what manual operation adds to the rate, deg/s.
    """

    trials: int = 100
    duration: float = DURATION
    rates: tuple[float, ...] = RATES
    rest: float = 100.0
    fluctuation: float = 0.001

    def __post_init__(self) -> None:
        require_run(self.trials, self.duration)
        object.__setattr__(self, "rates", tuple(self.rates))
        require_table(self.rates, self.rest, self.fluctuation)
        if self.rest >= self.duration:
            raise InputError(f"rest must be shorter than duration = {self.duration:g} s, got {self.rest:g}")

    def cases(self, seed: int) -> list[DrivenTable]:
        """Return the tables; the seed decides the fluctuations."""
        return [DrivenTable(rate, self.rest, self.fluctuation, seed, self.duration) for rate in self.rates]


def table_items(options: TableOptions, seed: int) -> list[Item]:
    """Cut the Monte Carlo into chunks of trials, one table each."""
    return [
        Item(f"table-{k}-trial-{first:05d}", Work(case, seed, first, n))
        for first, n in cut(options.trials, CHUNK)
        for k, case in enumerate(options.cases(seed))
    ]


@dataclass(frozen=True, eq=False)
class Felt:
    """What does not change from trial to trial: the motion and its exact increments."""

    motion: EarthMotion
    dtheta_b: Array
    dvel: Array


@lru_cache(maxsize=2)
def felt(case: Case) -> Felt:
    """Return the motion of a case, dynamics included, and its increments, by MuJoCo."""
    from bench.rig import Rig

    motion = case.motion()
    found = Rig.load("imu", threads=1).increments(motion, RATE, case.duration)
    assert found.dtheta_b is not None  # the model has a gyro
    return Felt(motion, found.dtheta_b, found.dvel)


def reported(fixed: Felt, seed: int, trial: int | None) -> tuple[Array, Array]:
    """Return the increments that the stated IMU reports in a trial; those of a perfect one for None."""
    if trial is None:
        return fixed.dtheta_b, fixed.dvel
    sensors = grade(GRADE)
    pairs = ((sensors.gyro, fixed.dtheta_b), (sensors.accelerometer, fixed.dvel))
    gyro, accelerometer = (
        errors.apply(signal, 1 / RATE, "increments", seed=seed, trial=trial, sensor=sensor)
        for sensor, (errors, signal) in enumerate(pairs)
    )
    return gyro, accelerometer


def navigate(fixed: Felt, algorithm: Algorithm, increments: tuple[Array, Array], samples: int = 1) -> Trajectory:
    """Return what a navigation solver makes of the increments, from the true start."""
    dtheta_b, dvel = (part[: len(part) // samples * samples] for part in increments)
    motion = fixed.motion
    return algorithm.make(samples).solve(dtheta_b, dvel, 1 / RATE, motion.navigation_initial(), motion.earth)


def require_run(trials: int, duration: float) -> None:
    """Check the number of trials and the duration of an experiment.

    Raises
    ------
    InputError
        If one is out of range.
    """
    require_integer("trials", trials, minimum=1)
    if (blocks := require_scalar("duration", duration, positive=True) / REPORT) % 1 or blocks < 2:
        raise InputError(f"duration must be a multiple of {REPORT:g} s, at least {2 * REPORT:g} s, got {duration!r}")


def require_table(rates: tuple[float, ...], rest: float, fluctuation: float) -> None:
    """Check the options of the table.

    Raises
    ------
    InputError
        If one is out of range.
    """
    if not rates or len(set(rates)) < len(rates):
        raise InputError(f"rates must be different positive numbers, got {rates}")
    for rate in rates:
        require_scalar("rates", rate, positive=True)
    require_scalar("rest", rest, minimum=0.0)
    require_scalar("fluctuation", fluctuation, minimum=0.0)


def cut(trials: int, chunk: int) -> list[tuple[int, int]]:
    """Return (first, count) of chunks of trials."""
    return [(first, min(chunk, trials - first)) for first in range(0, trials, chunk)]


def not_the_papers(options: object, defaults: object, trials: int) -> str:
    """Return why a run cannot judge the paper, or nothing: conditions that differ, or too few trials."""
    changed = [
        f"{name} is {value}, not {getattr(defaults, name)}"
        for name, value in vars(options).items()
        if name != "trials" and value != getattr(defaults, name)
    ]
    if changed:
        return "; ".join(changed)
    return f"{trials} trials are too few, at least {ENOUGH} are needed" if trials < ENOUGH else ""
