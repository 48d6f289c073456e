"""Chebyshev segments: the tables of one degree, and sampling of a smooth function of time on many segments at once."""

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev

from bench.errors import Array, require_array

Function = Callable[[Array], Array]  # times (n,) s -> (n, 3)

DEGREE = 24
EPS = float(np.finfo(float).eps)

NODES = -np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)
NODES[DEGREE // 2] = 0.0


def _matrices() -> tuple[Array, Array, Array]:
    """Return the matrices values -> coefficients, values -> derivative, values -> integral from -1."""
    k = np.arange(DEGREE + 1)
    ends = np.where((k == 0) | (k == DEGREE), 0.5, 1.0)
    fit = (2 / DEGREE) * ends[:, None] * ends * np.cos(np.pi * np.outer(k, DEGREE - k) / DEGREE)
    derivative = chebyshev.chebvander(NODES, DEGREE - 1) @ chebyshev.chebder(fit)
    integral = chebyshev.chebvander(NODES, DEGREE + 1) @ chebyshev.chebint(fit, lbnd=-1)
    return fit, derivative, integral


FIT, DERIVATIVE, INTEGRAL = _matrices()


def sample(name: str, function: Function, start: Array, end: Array) -> tuple[Array, Array]:
    """Return the function at the nodes of each segment, shape (m, DEGREE + 1, 3), and its derivative in x there.

    Raises
    ------
    InputError
        Naming `name`, if the function returns another shape or a non-finite value.
    """
    length = (end - start)[:, None]
    t = np.clip(start[:, None] + length * (0.5 + 0.5 * NODES), start[:, None], end[:, None])
    flat = t.ravel()
    values = require_array(name, function(flat), (len(flat), 3)).reshape(*t.shape, 3)
    derivative = DERIVATIVE @ values
    # The times are rounded, which matters once t is large beside the segment: go back to the exact nodes.
    off = NODES - ((t - start[:, None]) - (end[:, None] - t)) / length
    return values + off[:, :, None] * derivative, derivative


def evaluate_segments(breaks: Array, coefficients: Array, t: Array) -> Array:
    """Return the series of coefficients (m, DEGREE + 1, 4) between the breaks (m + 1,), at times t, shape (n, 4)."""
    from bench.motion._rate_kernels import evaluate

    segment = np.searchsorted(breaks[1:-1], t, side="right")
    out = np.empty((len(t), 4))
    evaluate(breaks, coefficients, segment, t, out)
    return out
