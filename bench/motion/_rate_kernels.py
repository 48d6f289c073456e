"""Compiled evaluation of piecewise Chebyshev series at many times."""

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array
from bench.jit import njit


@njit
def evaluate(breaks: Array, coefficients: Array, segment: NDArray[np.int64], t: Array, out: Array) -> None:
    """Fill out (n, 4) with the series of coefficients (m, degree + 1, 4) on segment[i] at times t (n,) (Clenshaw)."""
    for i in range(t.shape[0]):
        c = coefficients[segment[i]]
        start, end = breaks[segment[i]], breaks[segment[i] + 1]
        # Both differences are exact or nearly so, however large t is beside the length of the segment.
        x = ((t[i] - start) - (end - t[i])) / (end - start)
        w1 = x1 = y1 = z1 = w2 = x2 = y2 = z2 = 0.0
        for j in range(c.shape[0] - 1, 0, -1):  # four recursions side by side hide each other's latency
            w1, w2 = 2.0 * x * w1 - w2 + c[j, 0], w1
            x1, x2 = 2.0 * x * x1 - x2 + c[j, 1], x1
            y1, y2 = 2.0 * x * y1 - y2 + c[j, 2], y1
            z1, z2 = 2.0 * x * z1 - z2 + c[j, 3], z1
        out[i, 0] = x * w1 - w2 + c[0, 0]
        out[i, 1] = x * x1 - x2 + c[0, 1]
        out[i, 2] = x * y1 - y2 + c[0, 2]
        out[i, 3] = x * z1 - z2 + c[0, 3]
