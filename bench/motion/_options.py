"""What the motions share in checking their options: hashable tuples in, clear errors out."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, InputError, require_array, require_unit_quaternion

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Span = tuple[float, float]

ORIGIN: Vector = (0.0, 0.0, 0.0)
IDENTITY: Quaternion = (1.0, 0.0, 0.0, 0.0)
STILL: Array = np.zeros(3)  # a derivative that vanishes at all times
STILL.flags.writeable = False


def as_vector(name: str, value: ArrayLike) -> Vector:
    """Return three finite numbers as a tuple, so that the options stay hashable and comparable."""
    x, y, z = require_array(name, value, (3,)).tolist()
    return x, y, z


def as_quaternion(name: str, value: ArrayLike) -> Quaternion:
    """Return a unit quaternion (wxyz) as a tuple, normalised to rounding."""
    q = require_unit_quaternion(name, value)
    w, x, y, z = (q / np.sqrt((q * q).sum())).tolist()
    return w, x, y, z


def as_span(name: str, value: ArrayLike) -> Span:
    """Return (start, end), s, with start < end.

    Raises
    ------
    InputError
        If the two are not finite, or the span is empty or negative.
    """
    start, end = require_array(name, value, (2,)).tolist()
    if not start < end:
        raise InputError(f"{name} must be (start, end) with start < end, got ({start!r}, {end!r})")
    return start, end


def set_options(motion: object, **values: Any) -> None:
    """Store checked options in a frozen dataclass that is being made."""
    for name, value in values.items():
        object.__setattr__(motion, name, value)


def require_within(t: Array, span: Span) -> Array:
    """Return the times, shape (n,), s, if all lie in the span (to rounding).

    Raises
    ------
    InputError
        As `require_array`, or naming the first time outside and the span.
    """
    t = require_array("t", t, (None,))
    slack = 4 * np.finfo(float).eps * max(abs(span[0]), abs(span[1]))
    outside = (t < span[0] - slack) | (t > span[1] + slack)
    if outside.any():
        k = int(np.argmax(outside))
        raise InputError(f"t must lie in the motion's span [{span[0]!r}, {span[1]!r}] s, got t[{k}] = {t[k]}")
    return t
