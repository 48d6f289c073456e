"""The work of `dual-euler-navigation`: position errors of every algorithm on the driven table, trial by trial."""

from dataclasses import dataclass

import numpy as np

from bench.campaign import Item
from bench.errors import Array
from bench.experiments._dual_euler_runs import (
    DUAL,
    DURATION,
    HELD,
    QUATERNION,
    RATES,
    Algorithm,
    DrivenTable,
    Felt,
    cut,
    felt,
    navigate,
    reported,
    require_run,
    require_table,
    rows_of,
)
from bench.table import Table
from bench.trajectory import navigation_errors

CHUNK = 250  # trials: a driven table costs as much as these
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
class Options:
    """Options of the experiment; the defaults are the conditions at which claims are judged.

    Attributes
    ----------
    trials : int
        Monte Carlo trials over sensor errors, for each rate.
    duration : float
        Length of the run, s; position errors are tabled at its fifths.
    rates : tuple of float
        Of the middle axis, deg/s.
    rest : float
        Time at rest before the axis moves, s.
    fluctuation : float
        RMS of what manual operation adds to the rate, deg/s.
    """

    trials: int = 200
    duration: float = DURATION
    rates: tuple[float, ...] = RATES
    rest: float = 100.0
    fluctuation: float = 0.001

    def __post_init__(self) -> None:
        require_run(self.trials, self.duration)
        object.__setattr__(self, "rates", tuple(self.rates))
        require_table(self.rates, self.rest, self.fluctuation)

    def cases(self, seed: int) -> list[DrivenTable]:
        """Return the tables; the seed decides the fluctuations."""
        return [DrivenTable(rate, self.rest, self.fluctuation, seed, self.duration) for rate in self.rates]


@dataclass(frozen=True)
class Work:
    """Some trials on one table; the first chunk does the ideal runs too."""

    case: DrivenTable
    seed: int
    first: int
    count: int


def items(options: Options, seed: int) -> list[Item]:
    """Cut the Monte Carlo into chunks of trials, one table each."""
    return [
        Item(f"table-{k}-trial-{first:05d}", Work(case, seed, first, n))
        for first, n in cut(options.trials, CHUNK)
        for k, case in enumerate(options.cases(seed))
    ]


def position_errors(fixed: Felt, algorithm: Algorithm, increments: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return times (n,), s, and errors east, north and in all (n, 3), m."""
    found = navigate(fixed, algorithm, increments)
    every = (len(found) - 1) // REPORTS
    found = rows_of(found, slice(every, None, every))
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
