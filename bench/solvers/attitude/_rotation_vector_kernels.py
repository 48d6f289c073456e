"""Kernels of the rotation vector: from increments and their products, from a polynomial rate, the running attitude."""

import math

import numpy as np

from bench.errors import Array, Indices
from bench.jit import njit
from bench.rotation_kernels import exponential, multiply

BLOCK = 64  # updates side by side: the compiler turns each loop over them into vector instructions
MOST_TERMS = 200  # of a power series
SMALLEST_SQUARE = 1e-36  # |q_k|^2 of a term that no longer counts
LARGEST_SQUARE = 1e10  # |q_k|^2 at which the sum, 1, has lost five digits


@njit
def rotation_vectors(K: Array, first: int, dtheta: Array, starts: Indices, phi: Array) -> None:
    """Fill phi[:, :3] with sum_i K_ii dtheta_i + sum_{i<j} K_ij dtheta_i x dtheta_j of every update.

    K (N, N): above the diagonal, the columns before `first` are zero; dtheta (n, 3); starts (u,): first increment
    of an update; phi (u, 3 or more).
    """
    N = K.shape[0]
    d, part, total = np.empty((N, 3, BLOCK)), np.empty((3, BLOCK)), np.empty((3, BLOCK))
    for begin in range(0, starts.shape[0], BLOCK):
        count = min(BLOCK, starts.shape[0] - begin)
        for u in range(count):
            s = starts[begin + u]
            for j in range(N):
                d[j, 0, u], d[j, 1, u], d[j, 2, u] = dtheta[s + j, 0], dtheta[s + j, 1], dtheta[s + j, 2]
        # The sums are written out: called as a function on slices they take twice the time.
        for c in range(3):
            k = K[0, 0]
            for u in range(count):
                total[c, u] = k * d[0, c, u]
            for i in range(1, N):
                k = K[i, i]
                for u in range(count):
                    total[c, u] += k * d[i, c, u]
        for j in range(first, N):
            for c in range(3):
                k = K[0, j]
                for u in range(count):
                    part[c, u] = k * d[0, c, u]
                for i in range(1, j):
                    k = K[i, j]
                    for u in range(count):
                        part[c, u] += k * d[i, c, u]
            for u in range(count):
                total[0, u] += part[1, u] * d[j, 2, u] - part[2, u] * d[j, 1, u]
                total[1, u] += part[2, u] * d[j, 0, u] - part[0, u] * d[j, 2, u]
                total[2, u] += part[0, u] * d[j, 1, u] - part[1, u] * d[j, 0, u]
        for u in range(count):
            phi[begin + u, 0], phi[begin + u, 1], phi[begin + u, 2] = total[0, u], total[1, u], total[2, u]


@njit
def add_polynomial_turns(tables: Array, dtheta: Array, starts: Indices, phi: Array) -> None:
    """Add to phi[:, :3] the rotation vector of the polynomial rate through the N increments of every update.

    tables (N, N, N): w_m = sum_i tables[j, m, i] dtheta_i is the coefficient of u^m of the rate, u in [0, 1] over
    increment j. The series runs over one increment at a time: over the whole update, irregular increments would
    cost it its digits. Where they still would, phi becomes NaN. Angles reach to 2 pi.
    """
    N = tables.shape[0]
    w, series = np.empty((N, 3)), np.empty((MOST_TERMS + 1, 4))
    series[0, 0] = 1.0
    series[0, 1] = series[0, 2] = series[0, 3] = 0.0
    for u in range(starts.shape[0]):
        a, b, c, d = 0.0, 0.0, 0.0, 0.0  # q - 1, so that small angles keep their digits
        for j in range(N):
            _fit(tables[j], dtheta, starts[u], j, w)
            e, x, y, z = _series(w, series)
            p, q, r, s = multiply(a, b, c, d, e, x, y, z)
            a, b, c, d = p + (a + e), q + (b + x), r + (c + y), s + (d + z)
        sine = math.sqrt(b * b + c * c + d * d)
        scale = 2.0 * math.atan2(sine, 1.0 + a) / sine if sine > 1e-8 or a < -1.0 else 2.0
        phi[u, 0] += scale * b
        phi[u, 1] += scale * c
        phi[u, 2] += scale * d


@njit
def _fit(table: Array, dtheta: Array, s: int, j: int, w: Array) -> None:
    """Fill w (N, 3) with the rate's coefficients over increment j of those from row s on.

    The table applies to what differs from increment j only, and w_0 makes up its sum: a constant rate and every
    increment keep all their digits.
    """
    N = table.shape[0]
    for c in range(3):
        own = dtheta[s + j, c]
        w[0, c] = own
        for m in range(1, N):
            value = 0.0
            for i in range(N):
                value += table[m, i] * (dtheta[s + i, c] - own)
            w[m, c] = value
            w[0, c] -= value / (m + 1)


@njit
def _series(w: Array, q: Array) -> tuple[float, float, float, float]:
    """Return q(1) - 1 of q' = q o omega/2, omega = sum_m w_m u^m, q(0) = 1; NaN where the sum loses five digits.

    q_{k+1} = 1/(2(k+1)) sum_m q_{k-m} o (0, w_m), until N terms on end are below rounding; q holds q_0 = 1, and
    room for the other terms.
    """
    N = w.shape[0]
    k, small = 0, 0
    while small < N:
        a = b = c = d = 0.0
        for m in range(min(k + 1, N)):
            p0, p1, p2, p3 = q[k - m, 0], q[k - m, 1], q[k - m, 2], q[k - m, 3]
            x, y, z = w[m, 0], w[m, 1], w[m, 2]
            a -= p1 * x + p2 * y + p3 * z
            b += p0 * x + p2 * z - p3 * y
            c += p0 * y - p1 * z + p3 * x
            d += p0 * z + p1 * y - p2 * x
        k += 1
        f = 0.5 / k
        q[k, 0], q[k, 1], q[k, 2], q[k, 3] = f * a, f * b, f * c, f * d
        size = (q[k, 0] ** 2 + q[k, 1] ** 2) + (q[k, 2] ** 2 + q[k, 3] ** 2)
        small = small + 1 if size < SMALLEST_SQUARE else 0
        if k == MOST_TERMS or not size < LARGEST_SQUARE:
            return np.nan, np.nan, np.nan, np.nan
    a = b = c = d = 0.0
    for j in range(k, 0, -1):  # small terms first
        a += q[j, 0]
        b += q[j, 1]
        c += q[j, 2]
        d += q[j, 3]
    return a, b, c, d


@njit
def turn(carry: Array, out: Array) -> None:
    """Turn the running attitude carry (4,) by the rotation vectors out[:, :3], one after another; leave q in out."""
    w, x, y, z = carry[0], carry[1], carry[2], carry[3]
    for u in range(out.shape[0]):
        dw, dx, dy, dz = exponential(out[u, 0], out[u, 1], out[u, 2])
        # 1/|q| by one Newton step, exact to rounding as |q| is 1 within 1e-9; from the quaternion before the
        # product, so that the two do not wait for each other.
        scale = 1.5 - 0.5 * ((w * w + x * x) + (y * y + z * z))
        w, x, y, z = multiply(w, x, y, z, dw, dx, dy, dz)
        w, x, y, z = w * scale, x * scale, y * scale, z * scale
        out[u, 0], out[u, 1], out[u, 2], out[u, 3] = w, x, y, z
    carry[0], carry[1], carry[2], carry[3] = w, x, y, z
