"""Consistency of the damping filters: errors drawn as the filters believe them, and whether they claim what they do."""

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
    Work,
    filters,
    ship,
)
from bench.solvers.damping import InsSamples, error_states
from bench.table import Table

DRAWN = "drawn"  # the reference's error as the filter of 15 states believes it
PERFECT = "none"
CONSTANT_ERROR = "constant"
LONGEST = 12.0  # h
CASES = (PERFECT, CONSTANT_ERROR, DRAWN)


def measure_consistency(work: Work) -> Table:
    """Return NEES and NIS of all filters every hour, in some trials of the fast mode.

    Trial k has the errors of ``ErrorSimulation`` with a seed of its own, white noise of the reference, and as the
    reference's constant error none, that of the figures, or one drawn from the belief of the filter of 15 states.
    """
    from bench.error_simulation import ErrorSimulation, disturbed

    options = work.options
    duration = min(options.duration, LONGEST) * HOUR
    every = round(min(HOUR, duration / 2))
    t = np.arange(round(duration) + 1, dtype=np.float64)
    true = ship(options).trajectory(t)
    truth = InsSamples.of(true)
    double, augmented = filters(options, every)
    tables = []
    for trial in range(work.index, min(work.index + TRIALS_AN_ITEM, options.trials)):
        rng = np.random.default_rng(np.random.SeedSequence(work.seed, spawn_key=(trial, 0)))
        simulation = ErrorSimulation(options.model, seed=int(rng.integers(2**62)))
        _, x = simulation.advance(simulation.start(), truth)
        ins = disturbed(truth, x[:, 0])
        errors = np.concatenate([error_states(ins, true), x[:, 0, 7:]], axis=1)
        samples = Samples(ins, true, errors)
        noise = options.model.reference_noise * rng.standard_normal((len(t), 2))
        drawn = augmented.reference_bias * rng.standard_normal(2)
        for case, constant in zip(CASES, (np.zeros(2), np.full(2, options.focus), drawn), strict=True):
            v_ref = true.v_n[:, :2] + constant + noise
            found = {}
            if case != DRAWN:
                fused = double.solve(ins, v_ref)
                found = {FIRST: fused.parts[0], SECOND: fused.parts[1], FUSION: fused}
            found[AUGMENTED] = augmented.solve(ins, v_ref)
            for name, solution in found.items():
                rows = solution.covariance_rows
                left = remaining(Damped(samples, constant, found), name)[rows]
                tables.append(
                    make_rows(
                        len(rows),
                        part=work.part,
                        case=case,
                        name=name,
                        t_h=t[rows] / HOUR,
                        value=trial,
                        nees=nees(left, solution.covariance),
                        nis=solution.nis[rows],
                        **{ERRORS[k]: left[:, k].copy() for k in range(left.shape[1])},
                    )
                )
    return Table.concatenate(tables)
