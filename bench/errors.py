"""Errors worth catching, and the small checks that raise them.

Every message names the argument, the rule and the value, so that bad input is
mended at the first reading. Checks run at public entry points, never in kernels.
"""

from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


class BenchError(Exception):
    """Base of all errors that strapbench raises on purpose."""


class InputError(BenchError, ValueError):
    """An argument breaks a rule; the message names the argument, the rule and the value."""


class UnknownNameError(InputError):
    """A name that is not registered; the message lists the valid ones."""

    def __init__(self, kind: str, name: object, valid: Iterable[str], otherwise: str = ""):
        valid = sorted(valid)
        close = get_close_matches(str(name), valid, n=1)
        hint = f" (did you mean {close[0]!r}?)" if close else ""
        super().__init__(f"unknown {kind} {name!r}{hint}; valid: {', '.join(valid) or 'none'}{otherwise}")
        self._arguments = (kind, name, valid, otherwise)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), self._arguments  # else it could not come back from a worker process


class AccuracyError(BenchError):
    """A requested accuracy cannot be reached; nothing less accurate is returned."""


class ObservabilityError(BenchError):
    """The sensors do not determine what was asked for; the message gives rank and lost directions."""


class OutputError(BenchError):
    """A result could not be written; what was written before is kept."""


class BenchWarning(UserWarning):
    """The result stands, but is less accurate than its options promise; the message gives the estimate."""


def require_array(name: str, value: ArrayLike, shape: tuple[int | None, ...], *, finite: bool = True) -> Array:
    """Return `value` as a C-contiguous float64 array of the given shape, all finite.

    Parameters
    ----------
    name : str
        Name of the argument, for the message.
    value : array_like
    shape : tuple of int or None
        Expected shape; None admits any positive length.
    finite : bool
        False for a caller that checks this itself, chunk by chunk, to save a pass over memory.

    Raises
    ------
    InputError
        If the value is not numeric, has another shape, is empty, or holds a NaN or an infinity.
    """
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "fiu":  # complex numbers, strings and dates would be converted silently
            raise TypeError
        array = np.asarray(array, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} must be an array of real numbers, got {value!r}") from error
    expected = "(" + ", ".join("n" if k is None else str(k) for k in shape) + ("," if len(shape) == 1 else "") + ")"
    if array.ndim != len(shape) or any(k is not None and k != n for k, n in zip(shape, array.shape, strict=True)):
        raise InputError(f"{name} must have shape {expected}, got {np.shape(value)}")
    if any(k is None and n == 0 for k, n in zip(shape, array.shape, strict=True)):
        raise InputError(f"{name} must not be empty, got shape {array.shape}")
    if finite and not np.isfinite(array).all():
        where = np.argwhere(~np.isfinite(array))[0]
        index = ", ".join(str(i) for i in where)
        raise InputError(f"{name} must be finite, got {array[tuple(where)]} at [{index}]")
    return array


def require_scalar(name: str, value: Any, *, positive: bool = False, minimum: float | None = None) -> float:
    """Return `value` as a finite float, optionally > 0 or >= `minimum`.

    Raises
    ------
    InputError
        If it is not one real number, not finite, or breaks the bound.
    """
    rule = "a positive number" if positive else "a number" if minimum is None else f"a number >= {minimum:g}"
    try:
        if isinstance(value, (bool, str, bytes)) or np.ndim(value) != 0:
            raise TypeError
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{name} must be {rule}, got {value!r}") from None
    if not np.isfinite(number) or (positive and number <= 0) or (minimum is not None and number < minimum):
        finite = "" if np.isfinite(number) else "finite, "
        raise InputError(f"{name} must be {finite}{rule}, got {value!r}")
    return number


def require_integer(name: str, value: Any, *, minimum: int) -> int:
    """Return `value` as an int >= `minimum`.

    Raises
    ------
    InputError
        If it is not an integer or below the minimum.
    """
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)) or value < minimum:
        raise InputError(f"{name} must be an integer >= {minimum}, got {value!r}")
    return int(value)


def require_flag(name: str, value: Any) -> bool:
    """Return `value` if it is True or False.

    Raises
    ------
    InputError
        Otherwise.
    """
    if not isinstance(value, (bool, np.bool_)):
        raise InputError(f"{name} must be True or False, got {value!r}")
    return bool(value)


def require_instance(name: str, value: object, cls: type | tuple[type, ...]) -> None:
    """Check that `value` is of a class, or of one of several.

    Raises
    ------
    InputError
        Otherwise.
    """
    if not isinstance(value, cls):
        names = [each.__name__ for each in (cls if isinstance(cls, tuple) else (cls,))]
        wanted = " or ".join(f"{'an' if name[0] in 'AEIO' else 'a'} {name}" for name in names)
        got = repr(value)
        raise InputError(f"{name} must be {wanted}, got {got if len(got) < 100 else type(value).__name__}")


def require_times(name: str, value: ArrayLike) -> Array:
    """Return strictly increasing finite times, shape (n,), s.

    Raises
    ------
    InputError
        As `require_array`, or if two times are equal or out of order.
    """
    t = require_array(name, value, (None,))
    step = np.diff(t)
    if (step <= 0).any():
        k = int(np.argmax(step <= 0))
        raise InputError(f"{name} must increase strictly, got {name}[{k}] = {t[k]}, {name}[{k + 1}] = {t[k + 1]}")
    return t


def require_choice(name: str, value: object, choices: Iterable[str]) -> str:
    """Return `value` if it is one of `choices`.

    Raises
    ------
    UnknownNameError
        Otherwise; it lists the choices.
    """
    choices = list(choices)
    if value not in choices:
        raise UnknownNameError(name, value, choices)
    return str(value)


def require_unit_quaternion(name: str, value: ArrayLike, shape: tuple[int | None, ...] = (4,)) -> Array:
    """Return unit quaternions (wxyz), norm 1 within 1e-9.

    Raises
    ------
    InputError
        As `require_array`, or if a norm differs from 1 by more than 1e-9 (MuJoCo would normalise it silently).
    """
    q = require_array(name, value, shape)
    norm = np.sqrt(np.einsum("...i,...i->...", q, q))
    bad = np.abs(norm - 1.0) > 1e-9
    if np.any(bad):
        k = np.argmax(bad) if bad.ndim else None
        value = float(np.atleast_1d(norm)[k or 0])
        where = "" if k is None else f" in row {k}"
        raise InputError(f"{name} must be unit quaternions (wxyz), got norm {value!r}{where}")
    return q
