"""Discovery: one file = one algorithm, and nothing else to edit.

A class is found if it is defined in a public module of the package, derives from
the base and declares a ``name``; an object is found if it is a module attribute
of the base's type. Computed at call time and cached; there is no second list.
"""

import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from functools import cache
from types import ModuleType
from typing import TypeVar

from bench.errors import BenchError

T = TypeVar("T")


def _modules(package: str) -> Iterator[ModuleType]:
    root = importlib.import_module(package)
    for info in sorted(pkgutil.iter_modules(root.__path__), key=lambda info: info.name):
        if not info.name.startswith("_"):
            yield importlib.import_module(f"{package}.{info.name}")


def _add(found: dict[str, T], name: str, item: T) -> None:
    if name in found:
        raise BenchError(f"two definitions are named {name!r}: {found[name]!r} and {item!r}")
    found[name] = item


@cache
def discover(package: str, base: type[T]) -> dict[str, type[T]]:
    """Return the concrete subclasses of `base` in `package`, by their ``name``.

    Raises
    ------
    BenchError
        If two classes have the same name.
    """
    found: dict[str, type[T]] = {}
    for module in _modules(package):
        for _, cls in inspect.getmembers(module, inspect.isclass):
            if issubclass(cls, base) and cls.__module__ == module.__name__ and "name" in vars(cls):
                _add(found, vars(cls)["name"], cls)
    return found


@cache
def discover_objects(package: str, kind: type[T]) -> dict[str, T]:
    """Return the module-level instances of `kind` in `package`, by their ``name``.

    Raises
    ------
    BenchError
        If two objects have the same name.
    """
    found: dict[str, T] = {}
    for module in _modules(package):
        for _, item in inspect.getmembers(module, lambda item: isinstance(item, kind)):
            _add(found, item.name, item)
    return found


def first_line(item: type) -> str:
    """Return the first line of a registered class's docstring, without its name if the line starts with it."""
    line = (inspect.getdoc(item) or "").splitlines()[0].rstrip(".")
    head, colon, tail = line.partition(": ")
    return tail if colon and head.lower().replace(" ", "-") == vars(item)["name"] else line
