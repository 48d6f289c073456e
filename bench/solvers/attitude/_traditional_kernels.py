"""Compiled classical baselines: Runge-Kutta 4 for quaternion and matrix, and Picard's one-sample quaternion."""

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array
from bench.jit import njit
from bench.rotation_kernels import multiply
from bench.solvers.attitude._taylor_kernels import LANES, quaternion_of, turn, turn_matrix

Indices = NDArray[np.int64]


@njit
def rates(P: Array, dtheta: Array, start: int, w: Array) -> None:
    """Fill w (3, 3) with the rates at the start, in the middle and at the end of an update; P is (3, N)."""
    for row in range(3):
        x = y = z = 0.0
        for i in range(P.shape[1]):
            x += P[row, i] * dtheta[start + i, 0]
            y += P[row, i] * dtheta[start + i, 1]
            z += P[row, i] * dtheta[start + i, 2]
        w[row, 0], w[row, 1], w[row, 2] = x, y, z


@njit
def slope(a: float, x: float, y: float, z: float, rate: Array) -> tuple[float, float, float, float]:
    """Return (a, x, y, z) o (0, rate)/2."""
    return multiply(a, x, y, z, 0.0, 0.5 * rate[0], 0.5 * rate[1], 0.5 * rate[2])


@njit
def runge_kutta_quaternion(P: Array, dtheta: Array, starts: Indices, carry: Array, out: Array) -> None:
    """Do len(out) updates by one classical Runge-Kutta step of q' = q o (0, w)/2 each; carry is that of `turn`."""
    w, delta = np.empty((3, 3)), np.empty((4, LANES))
    for begin in range(0, len(out), LANES):
        end = min(begin + LANES, len(out))
        for n in range(begin, end):
            rates(P, dtheta, starts[n], w)
            a1, x1, y1, z1 = slope(1.0, 0.0, 0.0, 0.0, w[0])
            a2, x2, y2, z2 = slope(1.0 + 0.5 * a1, 0.5 * x1, 0.5 * y1, 0.5 * z1, w[1])
            a3, x3, y3, z3 = slope(1.0 + 0.5 * a2, 0.5 * x2, 0.5 * y2, 0.5 * z2, w[1])
            a4, x4, y4, z4 = slope(1.0 + a3, x3, y3, z3, w[2])
            lane = n - begin
            delta[0, lane] = (a1 + 2.0 * (a2 + a3) + a4) / 6.0
            delta[1, lane] = (x1 + 2.0 * (x2 + x3) + x4) / 6.0
            delta[2, lane] = (y1 + 2.0 * (y2 + y3) + y4) / 6.0
            delta[3, lane] = (z1 + 2.0 * (z2 + z3) + z4) / 6.0
        turn(carry, delta, begin, end, out)


@njit
def matrix_slope(K: Array, share: float, rate: Array, out: Array) -> None:
    """Fill out (9,) with (1 + share K) [rate x]."""
    x, y, z = rate[0], rate[1], rate[2]
    for i in range(3):
        p0, p1, p2 = share * K[3 * i], share * K[3 * i + 1], share * K[3 * i + 2]
        out[3 * i], out[3 * i + 1], out[3 * i + 2] = p1 * z - p2 * y, p2 * x - p0 * z, p0 * y - p1 * x
    out[1] -= z
    out[2] += y
    out[3] += z
    out[5] -= x
    out[6] -= y
    out[7] += x


@njit
def runge_kutta_matrix(
    P: Array, orthonormalise: bool, dtheta: Array, starts: Indices, carry: Array, out: Array
) -> None:
    """Do len(out) updates by one classical Runge-Kutta step of C' = C [w x] each; carry is C (9), row by row."""
    w, K = np.empty((3, 3)), np.empty((4, 9))
    zero, scratch = np.zeros(9), np.empty(9)
    for n in range(len(out)):
        rates(P, dtheta, starts[n], w)
        matrix_slope(zero, 0.0, w[0], K[0])
        matrix_slope(K[0], 0.5, w[1], K[1])
        matrix_slope(K[1], 0.5, w[1], K[2])
        matrix_slope(K[2], 1.0, w[2], K[3])
        for j in range(9):
            K[0, j] = (K[0, j] + 2.0 * (K[1, j] + K[2, j]) + K[3, j]) / 6.0
        turn_matrix(carry, K[0], orthonormalise, scratch)
        quaternion_of(carry, out[n])


@njit
def picard(cosine: Array, sine: Array, dtheta: Array, starts: Indices, carry: Array, out: Array) -> None:
    """Do len(out) updates by q o (1 + s cosine(s), sine(s) dtheta), s = |dtheta|^2; carry is that of `turn`.

    cosine (2,) and sine (2,) are the polynomials' coefficients.
    """
    delta = np.empty((4, LANES))
    for begin in range(0, len(out), LANES):
        end = min(begin + LANES, len(out))
        for n in range(begin, end):
            i, lane = starts[n], n - begin
            x, y, z = dtheta[i, 0], dtheta[i, 1], dtheta[i, 2]
            s = x * x + y * y + z * z
            scale = sine[0] + s * sine[1]
            delta[0, lane] = s * (cosine[0] + s * cosine[1])
            delta[1, lane], delta[2, lane], delta[3, lane] = scale * x, scale * y, scale * z
        turn(carry, delta, begin, end, out)
