"""Kernels of the nine- and six-accelerometer closed forms: readings to omega, alpha, f.

``carry`` (4, 3) is that of `accumulate` for the integral of alpha.
"""

import math

import numpy as np

from bench.jit import njit
from bench.solvers.gyro_free._strapdown import accumulate

SQRT2 = math.sqrt(2.0)


@njit
def nine_rates(arm, readings, h, fourth, started, carry, omega, alpha, f):
    """Equations 3, 4 and 6 of [Qin]; return how many squares were negative."""
    negative = 0
    half, quarter = 0.5 / arm, 0.25 / arm
    for k in range(readings.shape[0]):
        a = readings[k]
        for i in range(3):
            f[k, i] = 0.5 * (a[i] - a[i + 3])  # (3)
        sx, sy, sz = a[0] + a[3], a[1] + a[4], a[2] + a[5]
        xx, yy, zz = quarter * (sx - sy - sz), quarter * (sy - sx - sz), quarter * (sz - sx - sy)  # (4)
        negative += int(xx < 0.0) + int(yy < 0.0) + int(zz < 0.0)
        omega[k, 0], omega[k, 1], omega[k, 2] = (
            math.sqrt(max(xx, 0.0)),
            math.sqrt(max(yy, 0.0)),
            math.sqrt(max(zz, 0.0)),
        )
        alpha[k, 0] = -half * (a[1] - a[5] - SQRT2 * a[8])  # (6)
        alpha[k, 1] = -half * (a[5] - a[0] + SQRT2 * a[7])
        alpha[k, 2] = -half * (a[0] - a[4] - SQRT2 * a[6])
    integral = np.empty_like(alpha)
    accumulate(alpha, h, fourth, started, carry, integral)
    for k in range(readings.shape[0]):
        for i in range(3):
            omega[k, i] = math.copysign(omega[k, i], integral[k, i])
    return negative


@njit
def six_rates(arm, p, channel, readings, h, fourth, started, carry, omega, alpha, f):
    """Solve the cube: alpha, its integral omega, then f; channel (3, 2): those on +l e_k and -l e_k."""
    for n in range(readings.shape[0]):
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            s = readings[n, channel[k, 0]] + readings[n, channel[k, 1]]
            d = p * (readings[n, channel[j, 0]] - readings[n, channel[j, 1]])
            alpha[n, i] = p * (d - s) / (2.0 * SQRT2 * arm)
            f[n, i] = (s + d) / (2.0 * SQRT2)
    accumulate(alpha, h, fourth, started, carry, omega)
    for n in range(readings.shape[0]):
        for i in range(3):
            f[n, i] -= p * arm * omega[n, (i + 1) % 3] * omega[n, (i + 2) % 3]
