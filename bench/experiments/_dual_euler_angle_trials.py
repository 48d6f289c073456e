"""The work of `dual-euler-swing` and `dual-euler-turntable`: attitudes by every algorithm, ideal and with the IMU."""

from functools import lru_cache

import numpy as np

from bench.errors import Array
from bench.experiments._dual_euler_angles import EVERY, Judged
from bench.experiments._dual_euler_runs import DUAL, QUATERNION, RATE, Felt, Work, felt, navigate, reported
from bench.rotation import quat_conjugate, quat_from_rotvec, quat_multiply, quat_normalize, quat_rotate
from bench.solvers.attitude import AttitudeSolver
from bench.table import Table

DUAL_INS, QUATERNION_INS = "dual Euler, INS", "quaternion, INS"
DUAL_ALONE, FORWARD_ALONE = "dual Euler, gyros alone", "forward Euler, gyros alone"
INS = {DUAL_INS: DUAL, QUATERNION_INS: QUATERNION}
TRIED = (DUAL_INS, QUATERNION_INS, DUAL_ALONE)
IDEAL = (*((name, 1) for name in (*TRIED, FORWARD_ALONE)), *((DUAL_INS, N) for N in (2, 4)))


def attitude_solver(name: str, samples: int) -> AttitudeSolver:
    """Return the attitude solver of an algorithm that has gyros alone."""
    from bench.solvers import solver

    forward = name == FORWARD_ALONE  # one step an update, right or wrong, as a fixed-step integration does
    made: AttitudeSolver = (
        solver("attitude", "euler", samples=samples, halvings=0)
        if forward
        else solver("attitude", "dual-euler", samples=samples)
    )
    return made


def attitudes(fixed: Felt, name: str, increments: tuple[Array, Array], samples: int) -> tuple[Array, Array]:
    """Return times and q_nb of an algorithm, `EVERY` increments apart.

    An INS reports the attitude in n where it believes to be. Gyros alone must be told the place: the solver integrates
    in the axes that n has at the start, which do not turn, and what n has turned since is taken from the time.
    """
    rows = slice(None, None, EVERY // samples)
    if name in INS:
        found = navigate(fixed, INS[name], increments, samples)[rows]
        return found.t, found.q_nb
    start, earth = fixed.motion.trajectory(np.zeros(1)), fixed.motion.earth
    q = attitude_solver(name, samples).solve(increments[0], 1 / RATE, start.q_nb[0])[rows]
    t = np.arange(len(q), dtype=np.float64) * (EVERY / RATE)
    axis_n = quat_rotate(quat_conjugate(start.q_en[0]), earth.omega_ie)
    return t, quat_normalize(quat_multiply(quat_from_rotvec(-t[:, None] * axis_n), q))


@lru_cache(maxsize=2)
def true_attitudes(fixed: Felt, n: int) -> Array:
    """Return the true q_nb at n times, `EVERY` increments apart: the same in every trial."""
    return fixed.motion.trajectory(np.arange(n, dtype=np.float64) * (EVERY / RATE)).q_nb


def judge(fixed: Felt, name: str, increments: tuple[Array, Array], samples: int = 1) -> Judged:
    """Return the angles of an algorithm beside the true ones."""
    t, q = attitudes(fixed, name, increments, samples)
    return Judged.of(t, q, true_attitudes(fixed, len(t)))


def measure(work: Work) -> Table:
    """Return measures of all trials; with the first chunk those of the ideal runs, and the angles of trial 0."""
    fixed, case = felt(work.case), work.case.label
    tables = []
    for trial in range(work.first, work.first + work.count):
        increments = reported(fixed, work.seed, trial)
        for name in TRIED:
            found = judge(fixed, name, increments)
            tables.append(found.rows("trial", case, name, 1, trial))
            if trial == 0:
                tables.append(found.series("series", case, name, 1, trial))
    if work.first == 0:
        ideal = reported(fixed, work.seed, None)
        for name, samples in IDEAL:
            found = judge(fixed, name, ideal, samples)
            tables.append(found.rows("ideal", case, name, samples, 0))
            if samples == 1:
                tables.append(found.series("ideal series", case, name, samples, 0))
    return Table.concatenate(tables)
