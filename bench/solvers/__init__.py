"""Solvers: one algorithm a file, one frozen dataclass of options, found by discovery.

State is passed, never stored: ``start`` gives a state, ``advance(state, chunk)`` the
next state and the chunk's solution, ``solve`` is the loop over chunks, written once
per kind. To add an algorithm, put one file into the folder of its kind.
"""

from dataclasses import fields
from importlib import import_module
from typing import Any

from bench.errors import InputError, require_choice
from bench.registry import discover

KINDS = {
    "attitude": ("bench.solvers.attitude", "AttitudeSolver"),
    "damping": ("bench.solvers.damping", "DampingFilter"),
    "gyro-free": ("bench.solvers.gyro_free", "GyroFreeSolver"),
    "navigation": ("bench.solvers.navigation", "NavigationSolver"),
}


def solvers(kind: str) -> dict[str, type]:
    """Return the solver classes of a kind, by name.

    Raises
    ------
    UnknownNameError
        If there is no such kind; it lists the kinds.
    """
    package, base = KINDS[require_choice("kind of solver", kind, KINDS)]
    return discover(package, getattr(import_module(package), base))


def solver(kind: str, name: str, **options: Any) -> Any:
    """Return a solver by kind and name, with its options set.

    Raises
    ------
    UnknownNameError
        If the kind or the name is unknown; it lists the valid ones.
    InputError
        If an option is unknown or its value breaks a rule.
    """
    found = solvers(kind)
    cls = found[require_choice(f"{kind} solver", name, found)]
    known = [field.name for field in fields(cls)]
    for option in options:
        if option not in known:
            raise InputError(f"{name} has no option {option!r}; options: {', '.join(known) or 'none'}")
    return cls(**options)
