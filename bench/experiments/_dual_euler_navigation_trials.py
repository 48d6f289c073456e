"""The work of `dual-euler-navigation`: position errors of every algorithm on the driven table, trial by trial."""

from dataclasses import dataclass

import numpy as np

from bench.errors import Array
from bench.experiments._dual_euler_runs import (
    DUAL,
    HELD,
    QUATERNION,
    Algorithm,
    Felt,
    TableOptions,
    Work,
    felt,
    navigate,
    reported,
)
from bench.table import Table
from bench.trajectory import navigation_errors

REPORTS = 25  # rows of a trial, evenly over the run
TIMES = 5  # of tables 2 to 4, evenly over the run
AXES = ("east_m", "north_m", "total_m")
COLUMNS = ("part", "case", "algorithm", "trial", "t_s", *AXES)


def crude(label: str, resolved: str, normalised: bool) -> Algorithm:
    """Return a first-order quaternion INS."""
    options = (*HELD, ("resolved", resolved), ("normalised", normalised))
    return Algorithm(label, "first-order-quaternion", options)


START = crude("first-order quaternion", "start", False)
END = crude("first-order quaternion, resolved at the end", "end", False)
NORMALISED = crude("first-order quaternion, normalised", "start", True)
COMPENSATED = crude("first-order quaternion, compensated", "middle", False)
TRIED = (DUAL, QUATERNION, START, END, NORMALISED, COMPENSATED)
IDEAL = (*TRIED, Algorithm("dual quaternion", "dual-quaternion", HELD))


@dataclass(frozen=True)
class Options(TableOptions):
    """The options of a table test, with more trials."""

    trials: int = 200


def position_errors(fixed: Felt, algorithm: Algorithm, increments: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return times (n,), s, and errors east, north and in all (n, 3), m."""
    found = navigate(fixed, algorithm, increments)
    every = (len(found) - 1) // REPORTS
    found = found[every::every]
    error = navigation_errors(found, fixed.motion.trajectory(found.t)).position[:, :2]
    return found.t, np.column_stack([error, np.hypot(error[:, 0], error[:, 1])])


def measure(work: Work) -> Table:
    """Return the position errors of all algorithms in some trials, and with ideal sensors."""
    fixed, case = felt(work.case), work.case.label
    runs: list[tuple[str, int | None]] = [("trial", k) for k in range(work.first, work.first + work.count)]
    runs += [("ideal", None)] if work.first == 0 else []
    rows: list[tuple[object, ...]] = []
    for part, trial in runs:
        increments = reported(fixed, work.seed, trial)
        for algorithm in TRIED if part == "trial" else IDEAL:
            t, errors = position_errors(fixed, algorithm, increments)
            about = (part, case, algorithm.label, trial or 0)
            rows += [(*about, when, *error) for when, error in zip(t.tolist(), errors.tolist(), strict=True)]
    return Table.from_rows(COLUMNS, rows, "Position errors (estimate minus truth)")
