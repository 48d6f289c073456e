"""Compiled functional iteration of the Rodrigues and the rotation vector, whose equations are not linear.

A series is an array (SIZE,) of half coefficients (see ``_chebyshev``), that of z^k at CENTRE + k; beyond its degree
it is zero, which the products rely on. w is (T/2) omega, and x runs from -1 to 1 over an update.
"""

import math

import numpy as np

from bench.jit import njit
from bench.rotation_kernels import exponential, multiply, normalize
from bench.solvers.attitude._chebyshev_kernels import NEGLIGIBLE, SETTLED, TOP, angle_turned, fit_rate

CENTRE = TOP
SIZE = 3 * TOP + 1
STALLED = 2.0**-44  # below this a change that falls no more is rounding
MOST_ROUNDS = 400
DIVERGED = 1e100
RODRIGUES = 1


@njit
def copy(a, out):
    """Set the three series out to a. Element by element: an assignment of arrays takes seconds to compile."""
    for c in range(3):
        for i in range(SIZE):
            out[c, i] = a[c, i]


@njit
def add_product(factor, a, degree_a, b, degree_b, out):
    """Add factor a b to out; return the degree, at most TOP."""
    top = min(degree_a + degree_b, TOP)
    for m in range(top + 1):
        total = a[CENTRE + m] * b[CENTRE]
        for k in range(1, degree_b + 1):
            total += b[CENTRE + k] * (a[CENTRE + m - k] + a[CENTRE + m + k])
        out[CENTRE - m] = out[CENTRE + m] = out[CENTRE + m] + factor * total
    return top


@njit
def dot(a, degree_a, b, degree_b, out):
    """Set out to a . b; return its degree."""
    out[:] = 0.0
    for c in range(3):
        top = add_product(1.0, a[c], degree_a, b[c], degree_b, out)
    return top


@njit
def add_cross(factor, a, degree_a, b, degree_b, out):
    """Add factor a x b to out."""
    for c in range(3):
        i, j = (c + 1) % 3, (c + 2) % 3
        add_product(factor, a[i], degree_a, b[j], degree_b, out[c])
        add_product(-factor, a[j], degree_a, b[i], degree_b, out[c])


@njit
def rodrigues_rate(w, n, g, degree, scratch, out):
    """Set out to w + 1/2 g x w + 1/4 (g . w) g; return its degree."""
    copy(w, out)
    add_cross(0.5, g, degree, w, n - 1, out)
    top = dot(g, degree, w, n - 1, scratch[0])
    for c in range(3):
        last = add_product(0.25, scratch[0], top, g[c], degree, out[c])
    return max(last, n - 1)


@njit
def rotation_vector_rate(w, n, phi, degree, series, scratch, out):
    """Set out to w + 1/2 phi x w + f phi x (phi x w), f = sum_j series[j] (phi . phi)^j; return its degree."""
    copy(w, out)
    add_cross(0.5, phi, degree, w, n - 1, out)
    along, square, f, other = scratch[0], scratch[1], scratch[2], scratch[3]
    degree_along = dot(phi, degree, w, n - 1, along)
    degree_square = dot(phi, degree, phi, degree, square)
    f[:] = 0.0
    degree_f = 0
    for j in range(series.shape[0] - 1, -1, -1):  # Horner
        other[:] = 0.0
        degree_f = effective_degree(other, add_product(1.0, square, degree_square, f, degree_f, other))
        other[CENTRE] += series[j]
        f, other = other, f
    last = 0
    for c in range(3):  # phi x (phi x w) = (phi . w) phi - (phi . phi) w
        other[:] = 0.0
        first = add_product(1.0, along, degree_along, phi[c], degree, other)
        second = add_product(-1.0, square, degree_square, w[c], n - 1, other)
        last = add_product(1.0, other, max(first, second), f, degree_f, out[c])
    return max(last, n - 1)


@njit
def effective_degree(series, degree):
    """Return the degree without negligible coefficients."""
    while degree > 0 and abs(series[CENTRE + degree]) < NEGLIGIBLE:
        degree -= 1
    return degree


@njit
def integrate(rate, top, y, degree):
    """Replace y, of a degree, by the integral of a series from -1; return its degree, its size and how much it changed.

    The half coefficients of the integral are (A_{k-1} - A_{k+1})/(2 k); that of k = 0 makes it 0 at -1.
    """
    longest, size, change = 0, 0.0, 0.0
    for c in range(3):
        end, total, moved, constant, sign = min(top + 1, TOP), 0.0, 0.0, 0.0, 2.0
        for k in range(1, max(end, degree) + 1):
            value = (rate[c, CENTRE + k - 1] - rate[c, CENTRE + k + 1]) / (2 * k) if k <= end else 0.0
            moved += abs(value - y[c, CENTRE + k])
            total += abs(value)
            constant += sign * value
            sign = -sign
            if abs(value) < NEGLIGIBLE:
                value = 0.0
            else:
                longest = max(longest, k)
            y[c, CENTRE + k] = y[c, CENTRE - k] = value
        y[c, CENTRE] = constant
        size, change = max(size, 2.0 * total), max(change, 4.0 * moved)
    return longest, size, change


@njit
def iterate(form, w, n, series, rounds, y, rate, scratch):
    """Iterate y to the solution over the update; return the last change.

    rounds: how many iterations, 0 for as many as it takes. The change is inf if there is no result.
    """
    y[:] = 0.0
    degree, previous, change = 0, 0.0, math.inf
    for _ in range(rounds if rounds > 0 else MOST_ROUNDS):
        if form == RODRIGUES:
            top = rodrigues_rate(w, n, y, degree, scratch, rate)
        else:
            top = rotation_vector_rate(w, n, y, degree, series, scratch, rate)
        degree, size, change = integrate(rate, top, y, degree)
        if degree == TOP or not size < DIVERGED:
            return math.inf
        ratio = change / previous if previous > 0.0 else 1.0
        left = change * ratio / (1.0 - ratio) if ratio < 0.5 else change  # the changes to come, if they fall like that
        scale = max(size, 1.0)
        if rounds == 0 and (left <= SETTLED * scale or (ratio >= 1.0 and change <= STALLED * scale)):
            return change
        previous = change
    return change if rounds > 0 else math.inf


@njit
def update_quaternion(form, y):
    """Return the turn over an update from y(1), four times the sum of the odd half coefficients, unit or not."""
    a, b, c = 0.0, 0.0, 0.0
    for k in range(CENTRE + TOP - 1, CENTRE, -2):
        a, b, c = a + 4.0 * y[0, k], b + 4.0 * y[1, k], c + 4.0 * y[2, k]
    if form == RODRIGUES:
        return 1.0, 0.5 * a, 0.5 * b, 0.5 * c
    return exponential(a, b, c)


@njit
def terms_needed(series, w):
    """Return how many terms of f leave less than a rounding: those left out are of order (|phi| / 2 pi)^2j."""
    square = 0.0
    for c in range(3):
        part = abs(w[0, c])
        for k in range(1, w.shape[0]):
            part += 2.0 * abs(w[k, c])
        square += 4.0 * part * part  # |phi| <= the integral of |w| over a length of 2
    terms, left = 1, 1.0
    while terms < series.shape[0] and left > SETTLED:
        left *= square / (4.0 * math.pi * math.pi)
        terms += 1
    return terms


@njit
def vector_iteration(form, fit, series, limit, rounds, dtheta, starts, carry, out):
    """Update the attitude len(out) times; return success, the last angle S and the largest of the last changes, rad.

    S = sum |dtheta|; an S from the limit on, or an iteration without result, ends the updates.
    """
    n = fit.shape[0]
    halves, w = np.empty((n, 3)), np.zeros((3, SIZE))
    y, rate, scratch = np.empty((3, SIZE)), np.empty((3, SIZE)), np.empty((4, SIZE))
    q0, q1, q2, q3 = carry[0], carry[1], carry[2], carry[3]
    angle, largest = 0.0, 0.0
    for k in range(out.shape[0]):
        angle = angle_turned(dtheta, starts[k], n)
        if not angle < limit:
            return False, angle, math.inf
        fit_rate(fit, 1.0, dtheta, starts[k], halves)
        for c in range(3):
            for j in range(n):
                w[c, CENTRE + j] = w[c, CENTRE - j] = halves[j, c]
        change = iterate(form, w, n, series[: terms_needed(series, halves)], rounds, y, rate, scratch)
        if not change < math.inf:
            return False, angle, change
        largest = max(largest, change)
        p0, p1, p2, p3 = update_quaternion(form, y)
        q0, q1, q2, q3 = normalize(*multiply(q0, q1, q2, q3, p0, p1, p2, p3))
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = q0, q1, q2, q3
    carry[0], carry[1], carry[2], carry[3] = q0, q1, q2, q3
    return True, angle, largest
