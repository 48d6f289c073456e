"""Solvers with every combination of their options, found by trying, and what their options must refuse."""

import itertools
import re
from dataclasses import fields

import pytest

import bench
from bench.solvers import solvers

WRONG_SAMPLES = [0, 9, -1, 2.5, True, None, "3"]


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


def option_sets(kind, name, sizes, more):
    """Return the solvers of a name: all its numbers of samples among the sizes, times its options and `more` sets."""
    cls = solvers(kind)[name]
    free = {field.name: values for field in fields(cls) if (values := choices(cls, field))}
    sets = [dict(zip(free, values, strict=True)) for values in itertools.product(*free.values())] + more
    found = []
    for N, options in itertools.product(sizes, sets):
        try:
            found.append(cls(samples=N, **options))
        except bench.InputError:
            continue  # not a number of samples of this solver; what is refused is tested elsewhere
    return found


def label(solver):
    """Return a test's name for a solver: its name and the options that differ from the defaults, N always."""
    options = [
        f"{field.name}={getattr(solver, field.name)}"
        for field in fields(solver)
        if field.name == "samples" or getattr(solver, field.name) != field.default
    ]
    return "-".join([solver.name, *options])


def assert_samples_are_refused(kind, name, samples):
    with pytest.raises(bench.InputError, match=f"samples must be .*got {re.escape(repr(samples))}"):
        bench.solver(kind, name, samples=samples)


def assert_choices_are_listed(kind, name):
    cls = solvers(kind)[name]
    for field in fields(cls):
        if not isinstance(field.default, str):
            continue
        with pytest.raises(bench.UnknownNameError) as raised:
            cls(**{field.name: "nothing"})
        assert field.name in str(raised.value)
        for choice in choices(cls, field):
            assert choice in str(raised.value)
            cls(**{field.name: choice})
