"""Compiled functional iteration of the quaternion, in Chebyshev series.

Series are kept by half coefficients (see ``_chebyshev``), in row CENTRE + k that of z^k; w is half the rate,
(T/4) omega, and x runs from -1 to 1 over an update. The equation is linear: the iteration q <- 1 + int q o w adds to q
terms d <- int d o w, d = 1 at first, each (S/2)^n/n! of the first and the shorter the smaller it is.
"""

import math

import numpy as np

from bench.jit import njit
from bench.rotation_kernels import multiply, normalize

TOP = 128  # largest degree kept of any series
CENTRE = TOP
NEGLIGIBLE = 2.0**-60  # smaller coefficients at the end of a series are dropped: together less than 1e-17
SETTLED = 2.0**-57  # error left by the iteration: a sixteenth of a rounding of the attitude
MOST_ROUNDS = 200  # (S/2)^n/n! has fallen to rounding long before, for the S admitted
HALF_INVERSE = np.array([0.0, *(0.5 / np.arange(1.0, TOP + 1))])


@njit
def angle_turned(dtheta, start, n):
    """Return S = sum |dtheta| of n increments."""
    total = 0.0
    for i in range(start, start + n):
        total += math.sqrt(dtheta[i, 0] ** 2 + dtheta[i, 1] ** 2 + dtheta[i, 2] ** 2)
    return total


@njit
def fit_rate(fit, factor, dtheta, start, w):
    """Fill w (N, 3) with factor times the rate fitted to N increments."""
    n = fit.shape[0]
    for k in range(n):
        for c in range(3):
            total = 0.0
            for i in range(n):
                total += fit[k, i] * dtheta[start + i, c]
            w[k, c] = factor * total


@njit
def product_with_rate(d, degree, w, n, out):
    """Fill out[k], k >= 0, with d o (0, w) for a w of n coefficients; return its degree, at most TOP."""
    top = min(degree + n - 1, TOP)
    for m in range(top + 1):
        i = CENTRE + m
        p0, p1, p2, p3 = 0.0, 0.0, 0.0, 0.0
        for k in range(max(m - degree, 0), min(m + degree + 1, n)):
            a, b, c = w[k, 0], w[k, 1], w[k, 2]
            s, x, y, z = d[i - k, 0], d[i - k, 1], d[i - k, 2], d[i - k, 3]
            if k > 0 and m + k <= degree:
                s, x, y, z = s + d[i + k, 0], x + d[i + k, 1], y + d[i + k, 2], z + d[i + k, 3]
            p0 -= a * x + b * y + c * z
            p1 += a * s + c * y - b * z
            p2 += b * s + a * z - c * x
            p3 += c * s + b * x - a * y
        out[m, 0], out[m, 1], out[m, 2], out[m, 3] = p0, p1, p2, p3
    for c in range(4):
        out[top + 1, c] = out[top + 2, c] = 0.0
    return top


@njit
def integrate(rate, top, d, q):
    """Fill d with the integral of a series from -1, and add its value at 1 to q; return its degree and size.

    The half coefficients of the integral are (A_{k-1} - A_{k+1})/(2 k); that of k = 0 makes it 0 at -1, so that it
    is four times the sum of the odd ones at 1.
    """
    degree, size, sign = 0, 0.0, 2.0
    f0, f1, f2, f3 = 0.0, 0.0, 0.0, 0.0
    e0, e1, e2, e3 = 0.0, 0.0, 0.0, 0.0
    for k in range(1, min(top + 1, TOP) + 1):
        h = HALF_INVERSE[k]
        d0, d1 = (rate[k - 1, 0] - rate[k + 1, 0]) * h, (rate[k - 1, 1] - rate[k + 1, 1]) * h
        d2, d3 = (rate[k - 1, 2] - rate[k + 1, 2]) * h, (rate[k - 1, 3] - rate[k + 1, 3]) * h
        largest = abs(d0) + abs(d1) + abs(d2) + abs(d3)
        size += 2.0 * largest
        if not largest < NEGLIGIBLE:
            degree = k
        f0, f1, f2, f3 = f0 + sign * d0, f1 + sign * d1, f2 + sign * d2, f3 + sign * d3
        if sign > 0.0:
            e0, e1, e2, e3 = e0 + d0, e1 + d1, e2 + d2, e3 + d3
        sign = -sign
        for row in (CENTRE + k, CENTRE - k):
            d[row, 0], d[row, 1], d[row, 2], d[row, 3] = d0, d1, d2, d3
    d[CENTRE, 0], d[CENTRE, 1], d[CENTRE, 2], d[CENTRE, 3] = f0, f1, f2, f3
    q[0], q[1], q[2], q[3] = q[0] + 4.0 * e0, q[1] + 4.0 * e1, q[2] + 4.0 * e2, q[3] + 4.0 * e3
    return degree, size


@njit
def iterate(w, rounds, d, rate, q):
    """Fill q (4,) with the turn over an update less 1, which is smaller and so better rounded; return the last change.

    rounds: how many iterations, 0 for as many as it takes. The change is inf if there is no result.
    """
    n, reach = w.shape[0], 0.0
    for k in range(n):  # reach bounds the integral of |w|, and so what the next term is to this
        reach += (2.0 if k == 0 else 4.0) * (abs(w[k, 0]) + abs(w[k, 1]) + abs(w[k, 2]))
    q[0], q[1], q[2], q[3] = 0.0, 0.0, 0.0, 0.0
    d[CENTRE, 0], d[CENTRE, 1], d[CENTRE, 2], d[CENTRE, 3] = 1.0, 0.0, 0.0, 0.0
    degree, size = 0, 1.0
    for i in range(rounds if rounds > 0 else MOST_ROUNDS):
        while n > 1 and (abs(w[n - 1, 0]) + abs(w[n - 1, 1]) + abs(w[n - 1, 2])) * size < NEGLIGIBLE:
            n -= 1
        top = product_with_rate(d, degree, w, n, rate)
        degree, size = integrate(rate, top, d, q)
        if degree == TOP:
            return math.inf
        if rounds == 0 and size * reach < SETTLED * (i + 2):  # a bound of the next term
            return size
    return size if rounds > 0 else math.inf


@njit
def functional_iteration(fit, limit, rounds, dtheta, starts, carry, out):
    """Update the attitude len(out) times; return success, the last angle S and the largest of the last changes, rad.

    S = sum |dtheta|; an S from the limit on, or an iteration without result, ends the updates.
    """
    n = fit.shape[0]
    w, turn = np.empty((n, 3)), np.empty(4)
    d, rate = np.empty((2 * TOP + 1, 4)), np.empty((TOP + 3, 4))
    q0, q1, q2, q3 = carry[0], carry[1], carry[2], carry[3]
    angle, largest = 0.0, 0.0
    for k in range(out.shape[0]):
        angle = angle_turned(dtheta, starts[k], n)
        if not angle < limit:
            return False, angle, math.inf
        fit_rate(fit, 0.5, dtheta, starts[k], w)
        change = 2.0 * iterate(w, rounds, d, rate, turn)
        if not change < math.inf:
            return False, angle, change
        largest = max(largest, change)
        q0, q1, q2, q3 = normalize(*multiply(q0, q1, q2, q3, 1.0 + turn[0], turn[1], turn[2], turn[3]))
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = q0, q1, q2, q3
    carry[0], carry[1], carry[2], carry[3] = q0, q1, q2, q3
    return True, angle, largest
