"""Every attitude solver with every combination of its options, found by trying, and increments to feed them."""

import itertools
from dataclasses import fields

import numpy as np

import bench
from bench.solvers import solvers
from bench.solvers.attitude import MAX_SAMPLES

# Options that cannot be found by trying; a solver without an entry is tested all the same.
MORE = {
    "functional-iteration": [{"iterations": 14}],
    "picard": [{"order": order} for order in (1, 2, 3)],
    "taylor-dcm": [{"terms": 14}],
    "taylor-quaternion": [{"terms": 14}],
    "windowed-taylor": [{"window": 8}, {"window": 9, "causal": True}],
}


def choices(cls, field):
    """Return the values an option may have: both of a flag, all of a name; None if it is of another kind."""
    if isinstance(field.default, bool):
        return [False, True]
    if not isinstance(field.default, str):
        return None
    try:
        cls(**{field.name: ""})
    except bench.UnknownNameError as error:
        return str(error).partition("valid: ")[2].split(", ")
    raise AssertionError(f"{cls.__name__} accepts {field.name} = ''")


def variants(name, sizes=range(1, MAX_SAMPLES + 1)):
    """Return the solvers of a name: all its numbers of samples among the sizes, times its options."""
    cls = solvers("attitude")[name]
    free = {field.name: values for field in fields(cls) if (values := choices(cls, field))}
    sets = [dict(zip(free, values, strict=True)) for values in itertools.product(*free.values())] + MORE.get(name, [])
    found = []
    for N, options in itertools.product(sizes, sets):
        try:
            found.append(cls(samples=N, **options))
        except bench.InputError:
            continue  # not a number of samples of this solver; what is refused is tested elsewhere
    return found


def all_variants(sizes=range(1, MAX_SAMPLES + 1)):
    """Return the variants of all solvers."""
    return [solver for name in sorted(solvers("attitude")) for solver in variants(name, sizes)]


def label(solver):
    """Return a test's name for a solver: its name and the options that differ from the defaults, N always."""
    options = [
        f"{field.name}={getattr(solver, field.name)}"
        for field in fields(solver)
        if field.name == "samples" or getattr(solver, field.name) != field.default
    ]
    return "-".join([solver.name, *options])


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
