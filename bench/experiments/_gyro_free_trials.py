"""The trials of `gyro-free-circular`: options, readings of the conditions, and one trial from motion to errors."""

from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any, Literal

import numpy as np

from bench.campaign import Item
from bench.errors import Array, InputError, require_choice, require_integer, require_scalar
from bench.evaluation import attitude_error, integrated_rate_error
from bench.imu import SensorErrors
from bench.imu.turn_on_bias import TurnOnBias
from bench.imu.white_noise import WhiteNoise
from bench.motion.circular import Circular
from bench.signals import Accelerometers, GyroFreeSolution, Initial, Kinematics, Readings
from bench.table import Table
from bench.units import DEG, STANDARD_GRAVITY

BIAS = 1.5e-5  # m/s^2, stated
NOISE = 2e-10  # (m/s^2)^2 per sample or per hertz: not stated which
SYSTEMS = {"nine": "nine_accelerometer", "six": "six_accelerometer"}
TRIALS_PER_ITEM = 25
NOISE_TRIALS = 60  # trials without bias, which tell how noise alone scatters the errors
REPORT_EVERY = 2.0  # s, spacing of the reported errors
MOST_READINGS = 1e7  # a trial is held in memory
NOISE_READINGS = ("variance", "density")
INTEGRATIONS = ("fourth-order", "first-order")
GRAVITIES = ("gravity", "no gravity")


@dataclass(frozen=True)
class Options:
    """Options of the experiment; the defaults are the paper's conditions.

    Attributes
    ----------
    trials : int
        Monte Carlo trials per reading of the conditions.
    duration : float
        Length of the run, s.
    rate : float
        Sampling rate, Hz.
    circle : {"accelerating", "constant-rate"}
        The printed "0.01 rad/s^2 rotation rate": angular acceleration from rest, or a constant rate of 0.01 rad/s.
    """

    trials: int = 200
    duration: float = 60.0
    rate: float = 100.0
    circle: Literal["accelerating", "constant-rate"] = "accelerating"

    def __post_init__(self) -> None:
        require_integer("trials", self.trials, minimum=1)
        require_choice("circle", self.circle, ("accelerating", "constant-rate"))
        rate = require_scalar("rate", self.rate, minimum=1.0)
        duration = require_scalar("duration", self.duration, minimum=2 * REPORT_EVERY)
        if duration % REPORT_EVERY:
            raise InputError(f"duration must be a multiple of {REPORT_EVERY:g} s, got {self.duration!r}")
        if rate * REPORT_EVERY % 1:
            raise InputError(f"rate must give a whole number of readings in {REPORT_EVERY:g} s, got {self.rate!r} Hz")
        if rate * duration > MOST_READINGS:
            raise InputError(f"rate * duration must not exceed {MOST_READINGS:g} readings, got {rate * duration:g}")

    @property
    def t(self) -> Array:
        """Sampling times, both ends included, s."""
        return np.arange(round(self.duration * self.rate) + 1) / self.rate


@dataclass(frozen=True)
class Reading:
    """One reading of the conditions that the paper leaves open."""

    noise: str
    integration: str
    gravity: str

    @property
    def label(self) -> str:
        """Return the reading in words, unique."""
        return f"{self.noise}, {self.integration}, {self.gravity}"

    def noise_std(self, rate: float) -> float:
        """Return the standard deviation of one sample at the given rate, m/s^2."""
        return (NOISE if self.noise == "variance" else NOISE * rate) ** 0.5

    def white(self) -> WhiteNoise:
        """Return the noise of an accelerometer."""
        return WhiteNoise(density=NOISE**0.5) if self.noise == "density" else WhiteNoise(sample_std=NOISE**0.5)

    def errors(self) -> SensorErrors:
        """Return the accelerometer errors: +-bias with random signs, and white noise."""
        return SensorErrors((TurnOnBias(value=BIAS, random_sign=True), self.white()))


READINGS = tuple(Reading(*choice) for choice in product(NOISE_READINGS, INTEGRATIONS, GRAVITIES))


@dataclass(frozen=True)
class Work:
    """Some trials of one reading.

    Attributes
    ----------
    kind : {"trial", "noise", "signs"}
        Bias and noise; noise alone; bias alone, one trial for each combination of its signs, numbered in binary.
    """

    options: Options
    seed: int
    reading: Reading
    first: int
    count: int
    kind: Literal["trial", "noise", "signs"] = "trial"

    def errors(self, trial: int, channels: int) -> SensorErrors:
        """Return the accelerometer errors of one trial."""
        if self.kind == "trial":
            return self.reading.errors()
        if self.kind == "noise":
            return SensorErrors((self.reading.white(),))
        signs = [1.0 - 2.0 * (trial >> channel & 1) for channel in range(channels)]
        return SensorErrors((TurnOnBias(value=tuple(BIAS * sign for sign in signs)),))


@dataclass(frozen=True, eq=False)
class Ideal:
    """What does not change from trial to trial: truth, ideal readings and geometry, per system."""

    truth: Kinematics
    accelerometers: dict[str, Accelerometers]
    readings: dict[str, Readings]


@cache
def ideal(options: Options, gravity: str) -> Ideal:
    """Return truth and ideal readings, by MuJoCo."""
    from bench.rig import Rig

    g = STANDARD_GRAVITY if gravity == "gravity" else 0.0
    constant = options.circle == "constant-rate"
    motion = Circular(
        angular_rate=0.01 if constant else 0.0,
        angular_acceleration=0.0 if constant else 0.01,
        gravity=(0.0, 0.0, -g),
    )
    rigs = {system: Rig.load(model, threads=1) for system, model in SYSTEMS.items()}
    return Ideal(
        motion.kinematics(options.t),
        {system: rig.accelerometers for system, rig in rigs.items()},
        {system: rig.sample(motion, options.t) for system, rig in rigs.items()},
    )


def solve_trial(work: Work, trial: int, system: str) -> tuple[Readings, GyroFreeSolution]:
    """Return what the accelerometers of one system report in one trial, and what its solver makes of it.

    The noise depends on seed, trial and system only, so that the readings of the conditions are compared on the
    same noise.
    """
    from bench.solvers import solver

    options, reading = work.options, work.reading
    fixed = ideal(options, reading.gravity)
    felt = fixed.readings[system].accelerometers
    sensor = list(SYSTEMS).index(system)
    errors = work.errors(trial, felt.shape[1])
    reported = errors.apply(felt, 1 / options.rate, "samples", seed=work.seed, trial=trial, sensor=sensor)
    readings = Readings(options.t, reported)
    method = solver("gyro-free", f"{system}-accelerometer", integration=reading.integration)
    start = Initial.of(fixed.truth)
    return readings, method.solve(fixed.accelerometers[system], readings, 1 / options.rate, start)


def items(options: Options, seed: int) -> list[Item]:
    """Cut the Monte Carlo into chunks of trials."""
    work = []
    for number, reading in enumerate(READINGS):
        for first in range(0, options.trials, TRIALS_PER_ITEM):
            count = min(TRIALS_PER_ITEM, options.trials - first)
            work.append(Item(f"reading-{number}-trial-{first:05d}", Work(options, seed, reading, first, count)))
        if options.trials >= NOISE_TRIALS:
            noise = Work(options, seed, reading, 0, NOISE_TRIALS, "noise")
            work.append(Item(f"reading-{number}-noise", noise))
            if reading.noise == NOISE_READINGS[0]:  # without noise its reading does not matter
                work.append(Item(f"reading-{number}-signs", Work(options, seed, reading, 0, 2**9, "signs")))
    return work


def measure(work: Work) -> Table:
    """Return the errors of both systems in some trials, one row per trial, system and reported time."""
    tables = []
    for system, count in (("nine", work.count), ("six", min(work.count, 2**6) if work.kind == "signs" else work.count)):
        tables += [_errors(work, trial, system) for trial in range(work.first, work.first + count)]
    return Table.concatenate(tables)


def _errors(work: Work, trial: int, system: str) -> Table:
    options = work.options
    truth = ideal(options, work.reading.gravity).truth
    _, solution = solve_trial(work, trial, system)
    rotation = attitude_error(solution.q_ib, truth.q_ib) / DEG
    rate = solution.omega_ib_b - truth.omega_ib_b
    integral = integrated_rate_error(solution.omega_ib_b, truth.omega_ib_b, 1 / options.rate) / DEG
    position = solution.position - truth.position
    step = round(REPORT_EVERY * options.rate)
    every = slice(step if work.kind == "trial" else -1, None, step)
    n = len(options.t[every])
    columns: dict[str, Any] = {
        "kind": np.full(n, work.kind),
        "reading": np.full(n, work.reading.label),
        "system": np.full(n, system),
        "trial": np.full(n, trial),
        "t_s": options.t[every],
    }
    for axis in range(3):
        columns[f"integral_{'xyz'[axis]}_deg"] = integral[every, axis]
        columns[f"rotation_{'xyz'[axis]}_deg"] = rotation[every, axis]
        columns[f"position_{'xyz'[axis]}_m"] = position[every, axis]
    # Second differences see the jitter of a curve and not its drift.
    columns["roughness_deg"] = np.full(n, np.sqrt(np.mean(np.diff(integral, 2, axis=0) ** 2)))
    columns["rate_jitter_rad_per_s"] = np.full(n, np.sqrt(np.mean(rate.std(axis=0) ** 2)))
    columns["negative_squares"] = np.full(n, solution.negative_squares)
    return Table(columns, "Errors of every trial (estimate minus truth)")
