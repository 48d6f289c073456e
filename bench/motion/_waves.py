"""Harmonic functions of time and constant turns that stay at rounding however long the motion lasts.

``sin(w * t)`` in plain arithmetic loses the digits that the product w t has before
the point: 6e-14 rad of phase at 2 Hz after a minute. The rounding error of the product is
known exactly (Dekker), and a first-order correction puts it back.
"""

import math
from fractions import Fraction

import numpy as np

from bench.errors import Array
from bench.motion._options import Quaternion, Vector
from bench.rotation import quat_multiply

_SPLITTER = 134217729.0  # 2**27 + 1 parts a double into two halves whose products are exact


def columns(*parts: Array | float) -> Array:
    """Return (n, k) C-contiguous rows of k columns, each of shape (n,) or a constant."""
    n = max(np.size(part) for part in parts)
    rows = np.empty((n, len(parts)))
    for k, part in enumerate(parts):
        rows[:, k] = part
    return rows


def _two_product(a: float, t: Array) -> tuple[Array, Array]:
    """Return a t as a rounded product and its rounding error [Dekker 1971]."""
    product = a * t
    scaled_a, scaled_t = _SPLITTER * a, _SPLITTER * t
    a_high, t_high = scaled_a - (scaled_a - a), scaled_t - (scaled_t - t)
    a_low, t_low = a - a_high, t - t_high
    error = ((a_high * t_high - product) + a_high * t_low + a_low * t_high) + a_low * t_low
    return product, error


def sincos(rate: float, t: Array, offset: Array | float = 0.0) -> tuple[Array, Array]:
    """Return sin and cos of rate t + offset, each shape (n,), right to rounding.

    Parameters
    ----------
    rate : float, rad/s
    t : ndarray, shape (n,), s
    offset : float or ndarray, shape (n,), rad
    """
    product, error = _two_product(rate, t)
    phase = product + offset
    # The rounding error of the sum (Knuth).
    part = phase - product
    error += (product - (phase - part)) + (offset - part)
    sine, cosine = np.sin(phase), np.cos(phase)
    return sine + error * cosine, cosine - error * sine


def turn(omega: Vector, q_ib: Quaternion, t: Array) -> Array:
    """Return q_ib o exp(omega t / 2), shape (n, 4): a constant body rate from q_ib at t = 0."""
    norm = math.hypot(*omega)
    if norm == 0.0:
        return np.repeat([q_ib], len(t), axis=0)
    # |omega| beyond double precision: its rounding error times a long t would be a visible angle.
    excess = sum(Fraction(x) ** 2 for x in omega) - Fraction(norm) ** 2
    sine, cosine = sincos(0.5 * norm, t, float(excess / (4 * Fraction(norm))) * t)
    x, y, z = (component / norm for component in omega)
    return quat_multiply(q_ib, columns(cosine, x * sine, y * sine, z * sine))
