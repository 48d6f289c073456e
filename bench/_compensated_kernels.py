"""Sums, products, roots and sines that carry their rounding error along, for numba kernels: a number is high + low.

References
----------
[Dekker] Dekker: A floating-point technique for extending the available precision, Numer. Math. 18, 1971.
"""

import math

import numpy as np

from bench.jit import njit

_STEPS = 64  # table entries per radian
_BITS = 160


def _sine_table() -> np.ndarray:
    """Return sin and cos of k/64 rad up to 2 pi as high, low, high, low; from integers of 160 bits after the point."""
    one = 1 << _BITS
    step_sine = step_cosine = 0
    term, n = one, 0
    while term:
        if n % 2:
            step_sine += term * (1 - n % 4 // 2 * 2)
        else:
            step_cosine += term * (1 - n % 4 // 2 * 2)
        n += 1
        term //= n * _STEPS
    table = np.empty((int(2 * math.pi * _STEPS) + 2, 4))
    sine, cosine = 0, one
    for row in table:
        for k, value in ((0, sine), (2, cosine)):
            row[k] = value / one
            row[k + 1] = (value - int(row[k] * 2.0**_BITS)) / one
        sine, cosine = (
            (sine * step_cosine + cosine * step_sine) >> _BITS,
            (cosine * step_cosine - sine * step_sine) >> _BITS,
        )
    return table


_TABLE = _sine_table()


@njit
def two_sum(a, b):
    """Return a + b rounded, and the rounding error."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


@njit
def two_product(a, b):
    """Return a b rounded, and the rounding error [Dekker]."""
    total = a * b
    split = 134217729.0 * a  # 2^27 + 1
    a_high = split - (split - a)
    split = 134217729.0 * b
    b_high = split - (split - b)
    a_low, b_low = a - a_high, b - b_high
    return total, ((a_high * b_high - total) + a_high * b_low + a_low * b_high) + a_low * b_low


@njit
def two_root(high, low):
    """Return the square root of high + low >= 0, and what it lacks."""
    root = math.sqrt(high)
    if root == 0.0:
        return 0.0, 0.0
    square, error = two_product(root, root)
    return root, ((high - square) - error + low) / (2.0 * root)


@njit
def two_sincos(angle):
    """Return sin and cos of an angle as high, low, high, low: right to 2e-18 up to 2 pi, beyond to rounding."""
    size = abs(angle)
    k = int(size * _STEPS + 0.5) if size < 6.28 else 0
    if size >= 6.28:
        return math.sin(angle), 0.0, math.cos(angle), 0.0
    x = size - k / _STEPS  # exact, |x| <= 1/128
    x2 = x * x
    sine = x + x * x2 * (-1 / 6 + x2 * (1 / 120 + x2 * (-1 / 5040 + x2 * (1 / 362880))))
    versine = x2 * (0.5 + x2 * (-1 / 24 + x2 * (1 / 720 + x2 * (-1 / 40320))))
    s, s_low, c, c_low = _TABLE[k, 0], _TABLE[k, 1], _TABLE[k, 2], _TABLE[k, 3]
    s_high, s_rest = two_sum(s, c * sine - s * versine + (s_low + c_low * x))
    c_high, c_rest = two_sum(c, -s * sine - c * versine + (c_low - s_low * x))
    if angle < 0.0:
        return -s_high, -s_rest, c_high, c_rest
    return s_high, s_rest, c_high, c_rest
