"""What an update of `ins-frames` costs: operations counted on the running kernels, and median nanoseconds."""

import time
from collections.abc import Callable, Mapping

import numpy as np

from bench.experiments._attitude_cost_counts import COUNTED, per_update
from bench.experiments._ins_frames_trials import (
    CENTRAL,
    CONVENTIONAL,
    HARSH,
    RATE,
    SAMPLES,
    TWO_SAMPLE,
    Algorithm,
    Flight,
    Options,
    increments,
)
from bench.operation_count import Operations, counting
from bench.solvers.navigation import COLUMNS
from bench.table import Table

GENERIC = Flight(CENTRAL.speed, HARSH, True)  # no rate, velocity or angle is zero or constant
FIRST = 2  # updates before those that are counted
TIMED = ("algorithm", "kernel_ns", "solve_ns", "million_increments_per_s", "kernel_against_conventional")
IN_E, IN_N = "in e", "in n"  # what an update ends with
Counts = dict[tuple[str, str], Operations]


def operations() -> Counts:
    """Return the operations per update of two increments, by algorithm and by the frame of the results.

    All solvers report attitude, velocity and position in e. A navigator that shows latitude, longitude, height and all
    else in n spares the conventional algorithm its way to e, and has the others go from e to n.
    """
    to_earth, angles, to_navigation = conversions()
    found: Counts = {}
    for algorithm in TWO_SAMPLE:
        found[algorithm.label, IN_E] = own = count(algorithm)
        if algorithm.solver == CONVENTIONAL.solver:
            found[algorithm.label, IN_N] = own.combine(to_earth, -1.0).combine(angles, 1.0)
        else:
            found[algorithm.label, IN_N] = own.combine(to_navigation, 1.0)
    return found


def conversions() -> tuple[Operations, Operations, Operations]:
    """Return the operations from n to e, from half angles to latitude and longitude, and from e to n."""
    from bench.experiments import _ins_frames_formulas as formulas

    motion = GENERIC.motion
    start, p = motion.trajectory(np.array([0.1])), motion.earth.parameters
    row = np.concatenate([start.q_eb[0], start.v_e[0], start.r_e[0]])
    q_en = np.ascontiguousarray(start.q_en[0])
    runs = (
        lambda: formulas.to_earth(p, q_en, start.q_nb[0].copy(), start.v_n[0].copy(), float(start.height[0]), row),
        lambda: formulas.angles(q_en, np.empty(2)),
        lambda: formulas.to_navigation(p, row, np.empty(10)),
    )
    tallies = []
    for run in runs:
        with counting() as tally:
            run()
        tallies.append(tally.operations)
    return tallies[0], tallies[1], tallies[2]


def count(algorithm: Algorithm) -> Operations:
    """Return the operations of one update of two increments: those of a longer run beyond those of a shorter one."""
    solver, motion = algorithm.make(), GENERIC.motion
    dtheta_b, dvel = (part[: SAMPLES * (FIRST + COUNTED)] for part in increments(GENERIC, RATE, 1.0))
    initial = motion.navigation_initial()
    solver.solve(dtheta_b, dvel, 1 / RATE, initial, motion.earth)  # loads the kernels
    tallies = []
    for updates in (FIRST, FIRST + COUNTED):
        n = SAMPLES * updates
        with counting() as tally:
            solver.solve(dtheta_b[:n], dvel[:n], 1 / RATE, initial, motion.earth)
        tallies.append(tally)
    return per_update((tallies[0], tallies[1]))


def timings(options: Options) -> Table:
    """Return median times per update; no rows without repeats.

    Interleaved: every algorithm once in every round, so that a busy machine slows all alike. Not part of the rows of
    the campaign, which must not depend on the machine.
    """
    rounds = []
    if options.repeats:
        runs = {algorithm.label: _runs(algorithm, options.timed_updates) for algorithm in TWO_SAMPLE}
        _round(runs)  # may compile
        rounds = [_round(runs) for _ in range(options.repeats)]
    rows = []
    for label in rounds[0] if rounds else ():
        kernel, solve = np.median([one[label] for one in rounds], axis=0) / options.timed_updates
        against = np.median([one[label][0] / one[CONVENTIONAL.label][0] for one in rounds])
        rows.append((label, kernel, solve, 1e3 * SAMPLES / solve, against))
    title = (
        f"Time per update of {SAMPLES} increments, median of {options.repeats} interleaved rounds of "
        f"{options.timed_updates} updates (not reproducible)"
    )
    return Table.from_rows(TIMED, rows, title)


def _runs(algorithm: Algorithm, updates: int) -> tuple[Callable[[], object], Callable[[], object]]:
    """Return a run of the kernel alone, and one of the whole of `solve`."""
    solver, motion, dt = algorithm.make(), GENERIC.motion, 1 / RATE
    one = increments(GENERIC, RATE, 1.0)
    n = SAMPLES * updates
    dtheta_b, dvel = (np.tile(part, (-(-n // len(part)), 1))[:n] for part in one)
    initial = motion.navigation_initial()
    state = solver.start(dt, initial, motion.earth)
    block, out = np.concatenate([dtheta_b, dvel], axis=1), np.empty((updates, COLUMNS))
    return (
        lambda: solver._update(state.constants, block, 0, state.carry.copy(), out),
        lambda: solver.solve(dtheta_b, dvel, dt, initial, motion.earth),
    )


def _round(runs: Mapping[str, tuple[Callable[[], object], Callable[[], object]]]) -> dict[str, tuple[float, float]]:
    """Return the time of every run in ns, kernel and solve."""
    return {label: (_time(kernel), _time(solve)) for label, (kernel, solve) in runs.items()}


def _time(run: Callable[[], object]) -> float:
    begin = time.perf_counter_ns()
    run()
    return float(time.perf_counter_ns() - begin)
