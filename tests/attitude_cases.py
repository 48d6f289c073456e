"""Every attitude solver with every combination of its options, found by trying, and increments to feed them."""

import numpy as np

from bench.solvers import solvers
from bench.solvers.attitude import MAX_SAMPLES
from tests.solver_cases import option_sets

# Options that cannot be found by trying; a solver without an entry is tested all the same.
MORE = {
    "functional-iteration": [{"iterations": 14}],
    "picard": [{"order": order} for order in (1, 2, 3)],
    "taylor-dcm": [{"terms": 14}],
    "taylor-quaternion": [{"terms": 14}],
    "windowed-taylor": [{"window": 8}, {"window": 9, "causal": True}],
}


def variants(name, sizes=range(1, MAX_SAMPLES + 1)):
    """Return the solvers of a name: all its numbers of samples among the sizes, times its options."""
    return option_sets("attitude", name, sizes, MORE.get(name, []))


def all_variants(sizes=range(1, MAX_SAMPLES + 1)):
    """Return the variants of all solvers."""
    return [solver for name in sorted(solvers("attitude")) for solver in variants(name, sizes)]


def window(solver):
    """Return W, the increments that an update looks at."""
    return solver.samples + sum(solver.borrowed)


def swinging(n, rate=100.0, seed=0):
    """Return n increments of a rate of up to 3 rad/s that changes its direction all the time, from its integral."""
    rng = np.random.default_rng(seed)
    t = np.arange(n + 1) / rate
    frequency, phase = rng.uniform(1.0, 5.0, (3, 3)), rng.uniform(0, 2 * np.pi, (3, 3))
    angle = (0.3 * np.sin(frequency * t[:, None, None] + phase)).sum(axis=2) + t[:, None] * rng.normal(size=3)
    return np.diff(angle, axis=0)
