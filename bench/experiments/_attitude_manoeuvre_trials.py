"""The work of `attitude-manoeuvre`: options, and the errors of all algorithms and of the paper's own truth."""

from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np

from bench.campaign import Item
from bench.errors import Array, InputError, require_integer, require_scalar
from bench.evaluation import euler_error
from bench.experiments._attitude_trials import (
    ALL,
    UPDATE,
    Algorithm,
    Truth,
    error_rows,
    error_table,
    errors,
    quantised,
    solve,
    update_times,
)
from bench.motion.savage_manoeuvre import SPAN, SavageManoeuvre
from bench.table import Table
from bench.units import ARCSEC

RATE = 1000.0  # Hz, stated
TRUTH_RATE = 1e6  # Hz, stated
DURATION = SPAN[1]
MOTION = SavageManoeuvre()
PAPERS_TRUTH = Algorithm("one sample", "picard", samples=(1,))


@dataclass(frozen=True)
class Options:
    """Options of the experiment; the defaults are the paper's conditions.

    Attributes
    ----------
    phases : int
        Phases of the quantiser over which quantised results are taken.
    rate : float
        Sampling rate, Hz.
    truth_rate : float
        Sampling rate of the one-sample solution that the paper takes as truth, Hz.
    """

    phases: int = 200
    rate: float = RATE
    truth_rate: float = TRUTH_RATE

    def __post_init__(self) -> None:
        from bench.rig import whole_intervals

        require_integer("phases", self.phases, minimum=1)
        n = whole_intervals(require_scalar("rate", self.rate, positive=True), DURATION)
        if n % UPDATE:
            raise InputError(f"rate must give a multiple of {UPDATE} intervals in {DURATION:g} s, got {n}")
        whole_intervals(require_scalar("truth_rate", self.truth_rate, positive=True), DURATION)


@dataclass(frozen=True)
class Work:
    """The errors of the algorithms, or those of the paper's truth."""

    options: Options
    seed: int
    part: Literal["algorithms", "truth"]


def items(options: Options, seed: int) -> list[Item]:
    """Cut the work in two."""
    return [Item(part, Work(options, seed, part)) for part in ("algorithms", "truth")]


@cache
def ideal(rate: float) -> Array:
    """Return the increments of the manoeuvre, by MuJoCo, shape (n, 3), rad."""
    from bench.rig import Rig

    dtheta = Rig.load("imu", threads=1).increments(MOTION, rate, DURATION).dtheta_b
    assert dtheta is not None  # the model has a gyro
    return dtheta


def measure(work: Work) -> Table:
    """Return the errors of all algorithms, or of the paper's truth."""
    options = work.options
    if work.part == "algorithms":
        return error_rows(MOTION, ideal(options.rate), options.rate, ALL, work.seed, options.phases)
    rate, dtheta = options.truth_rate, ideal(options.truth_rate)
    truth = Truth.of(MOTION, update_times(len(dtheta), 1, rate))
    q = solve(PAPERS_TRUTH, 1, dtheta, 1 / rate, truth.q[0])
    found = (errors(q, truth) / ARCSEC).tolist()
    return error_table([(rate, PAPERS_TRUTH.label, 1, "ideal", 0, *found)])


def errors_in_time(
    options: Options, seed: int, algorithm: Algorithm, samples: int, phase: int | None
) -> tuple[Array, Array]:
    """Return times (u,), s, and signed pitch, roll and yaw errors (u, 3), arcsec, of one run; phase None is ideal."""
    dtheta, dt = ideal(options.rate), 1 / options.rate
    reported = dtheta if phase is None else quantised(dtheta, dt, seed, phase)
    t = update_times(len(dtheta), samples, options.rate)
    true = MOTION.kinematics(t).q_ib
    yaw, pitch, roll = euler_error(solve(algorithm, samples, reported, dt, true[0]), true).T
    return t, np.stack([pitch, roll, yaw], axis=1) / ARCSEC
