"""Nanoseconds per update, best of several: the kernels alone, and the whole of `solve`."""

import time
import warnings
from collections.abc import Callable, Sequence

import numpy as np

from bench.errors import BenchWarning
from bench.experiments._attitude_cost_counts import RATE, START, Options, increments
from bench.experiments._attitude_limits_solvers import Variant
from bench.table import Table

NAMES = ("label", "solver", "samples", "kernel_ns", "solve_ns", "million_increments_per_s")


def timings(options: Options, chosen: Sequence[Variant]) -> Table:
    """Return the times of each variant; no rows without repeats.

    Not part of the rows of the campaign: they must not depend on the machine, nor the times on busy workers.
    """
    rows = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", BenchWarning)
        for variant in chosen if options.repeats else ():
            kernel, solve = _time(options, variant)
            rows.append((variant.label, variant.name, variant.samples, kernel, solve, 1e3 * variant.samples / solve))
    title = f"Time per update, best of {options.repeats} runs of {options.timed_updates} updates (not reproducible)"
    return Table.from_rows(NAMES, rows, title)


def _time(options: Options, variant: Variant) -> tuple[float, float]:
    """Return nanoseconds per update through the kernels, and through `solve`."""
    solver, updates = variant.build(), options.timed_updates
    window = variant.samples + sum(solver.borrowed)
    n = max(variant.samples * updates, -(-window // variant.samples) * variant.samples)
    data, dt = increments(n).copy(), 1 / RATE
    own = variant.samples * np.arange(n // variant.samples)
    starts = np.clip(own - solver.borrowed[0], 0, n - window)
    state, out = solver.start(dt, START), np.empty((len(own), 4))

    def kernel() -> None:
        solver._update(state.constants, data, starts, own - starts, dt, state.carry.copy(), out)

    return _best(options, kernel) / len(own), _best(options, lambda: solver.solve(data, dt, START)) / len(own)


def _best(options: Options, run: Callable[[], object]) -> float:
    """Return the shortest time in ns, after one run that is not counted (it may compile)."""
    run()
    times = []
    for _ in range(options.repeats):
        begin = time.perf_counter_ns()
        run()
        times.append(time.perf_counter_ns() - begin)
    return float(min(times))
