"""Consistency of the damping filters: errors drawn as the filters believe them, and whether they claim what they do."""

from collections.abc import Iterator

import numpy as np

from bench.evaluation import nees
from bench.experiments._damping_runs import Damped, Samples, make_rows, remaining
from bench.experiments._damping_trials import (
    AUGMENTED,
    ERRORS,
    FIRST,
    FUSION,
    HOUR,
    SECOND,
    TRIALS_AN_ITEM,
    Options,
    Work,
    filters,
    ship,
)
from bench.solvers.damping import InsSamples, error_states
from bench.table import Table
from bench.trajectory import Trajectory

LONGEST = 12.0  # h
PERFECT = "none"
CONSTANT_ERROR = "constant"
DRAWN = "drawn"  # as the filter of 15 states believes it
CASES = (PERFECT, CONSTANT_ERROR, DRAWN)


def measure_consistency(work: Work) -> Table:
    """Return NEES and NIS of all filters every hour, in some trials of the fast mode.

    Trial k has the errors of ``ErrorSimulation`` with a seed of its own, white noise of the reference, and as the
    reference's constant error none, that of the figures, or one drawn from the belief of the filter of 15 states.
    """
    options = work.options
    duration = min(options.duration, LONGEST) * HOUR
    true = ship(options).trajectory(np.arange(round(duration) + 1, dtype=np.float64))
    truth = InsSamples.of(true)
    last = min(work.index + TRIALS_AN_ITEM, options.trials)
    tables = []
    for trial in range(work.index, last):
        for case, damped in trials(options, true, truth, work.seed, trial):
            tables += [_rows_of(work, case, trial, damped, name) for name in damped.solutions]
    return Table.concatenate(tables)


def trials(
    options: Options, true: Trajectory, truth: InsSamples, seed: int, trial: int
) -> Iterator[tuple[str, Damped]]:
    """Yield the cases of one trial, and the solutions in each; of an error that is drawn that which expects it."""
    from bench.error_simulation import ErrorSimulation, disturbed

    double, augmented = filters(options, round(min(HOUR, float(truth.t[-1]) / 2)))
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(trial, 0)))
    simulation = ErrorSimulation(options.model, seed=int(rng.integers(2**62)))
    _, x = simulation.advance(simulation.start(), truth)
    ins = disturbed(truth, x[:, 0])
    samples = Samples(ins, true, np.concatenate([error_states(ins, true), x[:, 0, 7:]], axis=1))
    noise = options.model.reference_noise * rng.standard_normal((len(truth), 2))
    drawn = augmented.reference_bias * rng.standard_normal(2)
    for case, constant in zip(CASES, (np.zeros(2), np.full(2, options.focus), drawn), strict=True):
        v_ref = true.v_n[:, :2] + constant + noise
        found = {AUGMENTED: augmented.solve(ins, v_ref)}
        if case != DRAWN:
            fused = double.solve(ins, v_ref)
            found |= {FIRST: fused.parts[0], SECOND: fused.parts[1], FUSION: fused}
        yield case, Damped(samples, constant, found)


def _rows_of(work: Work, case: str, trial: int, damped: Damped, name: str) -> Table:
    solution = damped.solutions[name]
    rows = solution.covariance_rows
    left = remaining(damped, name)[rows]
    return make_rows(
        len(rows),
        part=work.part,
        case=case,
        name=name,
        t_h=solution.t[rows] / HOUR,
        value=trial,
        nees=nees(left, solution.covariance),
        nis=solution.nis[rows],
        **{ERRORS[k]: left[:, k].copy() for k in range(left.shape[1])},
    )
