"""Kernels of the nine- and six-accelerometer closed forms: readings to omega, alpha, f.

``carry`` (4, 3) is that of `accumulate` for the integral of alpha, called between two kernels so that it
is compiled once.
"""

import math

import numpy as np

from bench.errors import Array
from bench.jit import njit
from bench.solvers.gyro_free._strapdown import accumulate

SQRT2 = math.sqrt(2.0)


@njit
def _nine(arm, readings, omega, alpha, f):
    """Set f, alpha and |omega| by equations 3, 4 and 6 of [Qin]; return how many squares were negative."""
    negative = 0
    half, quarter = 0.5 / arm, 0.25 / arm
    for k in range(readings.shape[0]):
        a = readings[k]
        for i in range(3):
            f[k, i] = 0.5 * (a[i] - a[i + 3])  # (3)
        sx, sy, sz = a[0] + a[3], a[1] + a[4], a[2] + a[5]
        squares = (quarter * (sx - sy - sz), quarter * (sy - sx - sz), quarter * (sz - sx - sy))  # (4)
        for i in range(3):
            negative += int(squares[i] < 0.0)
            omega[k, i] = math.sqrt(max(squares[i], 0.0))
        alpha[k, 0] = -half * (a[1] - a[5] - SQRT2 * a[8])  # (6)
        alpha[k, 1] = -half * (a[5] - a[0] + SQRT2 * a[7])
        alpha[k, 2] = -half * (a[0] - a[4] - SQRT2 * a[6])
    return negative


def nine_rates(
    arm: float,
    readings: Array,
    h: float,
    fourth: bool,
    started: bool,
    carry: Array,
    omega: Array,
    alpha: Array,
    f: Array,
) -> int:
    """Solve the nine: roots of the squares with the signs of integrated alpha; return how many were negative."""
    negative = _nine(arm, readings, omega, alpha, f)
    integral = np.empty_like(alpha)
    accumulate(alpha, h, fourth, started, carry, integral)
    np.copysign(omega, integral, out=omega)
    return int(negative)


@njit
def _six(arm, p, channel, readings, alpha, f):
    """Set alpha, and f but for the product of two rates."""
    for n in range(readings.shape[0]):
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            s = readings[n, channel[k, 0]] + readings[n, channel[k, 1]]
            d = p * (readings[n, channel[j, 0]] - readings[n, channel[j, 1]])
            alpha[n, i] = p * (d - s) / (2.0 * SQRT2 * arm)
            f[n, i] = (s + d) / (2.0 * SQRT2)


@njit
def _six_force(arm, p, omega, f):
    """Take the product of two rates out of f."""
    for n in range(f.shape[0]):
        for i in range(3):
            f[n, i] -= p * arm * omega[n, (i + 1) % 3] * omega[n, (i + 2) % 3]


def six_rates(
    arm: float,
    p: float,
    channel: Array,
    readings: Array,
    h: float,
    fourth: bool,
    started: bool,
    carry: Array,
    omega: Array,
    alpha: Array,
    f: Array,
) -> None:
    """Solve the cube: alpha, its integral omega, then f; channel (3, 2): those on +l e_k and -l e_k."""
    _six(arm, p, channel, readings, alpha, f)
    accumulate(alpha, h, fourth, started, carry, omega)
    _six_force(arm, p, omega, f)
