"""Compiled Taylor series of attitude, quaternion and matrix, and the running products they end in.

The series of different updates do not depend on each other: they are summed side by side in up to `LANES` lanes,
the last axis of the work arrays, so that the compiler vectorises the innermost loops. Every lane does the same
operations in the same order, whatever its neighbours: the bits do not depend on how the updates are grouped.
"""

import math

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array
from bench.jit import njit

Indices = NDArray[np.int64]
LANES = 32
TINY = 1e-18  # a term that changes nothing


@njit
def clear(total: Array, lanes: int) -> None:
    """Set the lanes of total (k, lanes) to zero; compiles much faster than an assignment to a slice."""
    for i in range(total.shape[0]):
        for lane in range(lanes):
            total[i, lane] = 0.0


@njit
def fit(G: Array, offset: int, dtheta: Array, starts: Indices, begin: int, end: int, d: Array, w: Array) -> None:
    """Fill w (W, 3, lanes) with the coefficients of the rates over the updates begin ... end.

    G[offset] is a `_rate_fit.difference_matrix`; d (W, 3, lanes) is scratch.
    """
    W, lanes = w.shape[0], end - begin
    for lane in range(lanes):
        first = starts[begin + lane]
        for i in range(W):
            for axis in range(3):
                d[i, axis, lane] = dtheta[first + i, axis]
    for order in range(1, W):
        for i in range(W - 1, order - 1, -1):
            for axis in range(3):
                for lane in range(lanes):
                    d[i, axis, lane] -= d[i - 1, axis, lane]
    for m in range(W):
        clear(w[m], lanes)
        for j in range(W - 1, m - 1, -1):  # small terms first
            c = G[offset, m, j]
            for axis in range(3):
                for lane in range(lanes):
                    w[m, axis, lane] += c * d[j, axis, lane]


@njit
def note_largest(w: Array, lanes: int, largest: Array) -> None:
    """Raise largest (W,) to the largest |w_m|^2 of the lanes."""
    for m in range(w.shape[0]):
        top = largest[m]
        for lane in range(lanes):
            x, y, z = w[m, 0, lane], w[m, 1, lane], w[m, 2, lane]
            top = max(top, x * x + y * y + z * z)
        largest[m] = top


@njit
def count_terms(
    w: Array, lanes: int, factor: Array, adapt: bool, sizes: Array, a: Array, quiet: Indices, last: Indices
) -> int:
    """Set last[lane] to the last term that counts, or to len(factor) unless `adapt`; return the largest.

    The terms are majorised by a_0 = 1, a_{k+1} = factor_k sum_m |w_m| a_{k-m}. After W tiny ones in a row all others
    are smaller still, as long as factor_k sum |w_m| is. sizes (W, lanes), a (K + 1, lanes) and quiet are scratch.
    """
    W, K = w.shape[0], len(factor)
    for lane in range(lanes):
        last[lane], quiet[lane], a[0, lane] = K, 0, 1.0
    if not adapt:
        return K
    for m in range(W):
        for lane in range(lanes):
            x, y, z = w[m, 0, lane], w[m, 1, lane], w[m, 2, lane]
            sizes[m, lane] = math.sqrt(x * x + y * y + z * z)
    left, most = lanes, 0
    for k in range(K):
        for lane in range(lanes):
            a[k + 1, lane] = 0.0
        for m in range(min(k + 1, W)):
            for lane in range(lanes):
                a[k + 1, lane] += factor[k] * sizes[m, lane] * a[k - m, lane]
        for lane in range(lanes):
            quiet[lane] = quiet[lane] + 1 if a[k + 1, lane] <= TINY else 0
            if quiet[lane] >= W and last[lane] == K:
                size = 0.0
                for m in range(W):
                    size += sizes[m, lane]
                if 2.0 * factor[k] * size <= 1.0:
                    last[lane] = most = k + 1 - W  # k only rises
                    left -= 1
        if left == 0:
            return most
    return K


@njit
def alike(offsets: Indices, begin: int) -> int:
    """Return the end of the updates from `begin` that are done side by side: of one offset, no more than LANES."""
    end = begin + 1
    while end < len(offsets) and end < begin + LANES and offsets[end] == offsets[begin]:
        end += 1
    return end


@njit
def add(a: float, b: float) -> tuple[float, float]:
    """Return the rounded sum and what rounding took from it (Knuth)."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


@njit
def turn(carry: Array, delta: Array, begin: int, end: int, out: Array) -> None:
    """Multiply the running attitude by 1 + delta, made unit, for the updates begin ... end; fill their rows of out.

    delta (4, lanes) is overwritten. carry holds q and, in the next four, what was lost to rounding when q was last
    changed. It is added the next time, so that the error of a long product grows with the size of the increments and
    not with their number.
    """
    for lane in range(end - begin):
        w, x, y, z = delta[0, lane], delta[1, lane], delta[2, lane], delta[3, lane]
        d = 2.0 * w + (w * w + x * x + y * y + z * z)  # |1 + delta|^2 - 1 with all its digits
        norm = math.sqrt(1.0 + d)
        scale = 1.0 / norm
        delta[0, lane] = w * scale - d / (norm * (1.0 + norm))
        delta[1, lane], delta[2, lane], delta[3, lane] = x * scale, y * scale, z * scale
    q0, q1, q2, q3 = carry[0], carry[1], carry[2], carry[3]
    lost0, lost1, lost2, lost3 = carry[4], carry[5], carry[6], carry[7]
    for n in range(begin, end):
        lane = n - begin
        w, x, y, z = delta[0, lane], delta[1, lane], delta[2, lane], delta[3, lane]
        # The norm drifts by roundings only: a first-order step, from the norm of the previous attitude, is ample.
        r = 0.5 * (1.0 - (q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)) - (q0 * lost0 + q1 * lost1 + q2 * lost2 + q3 * lost3)
        step0 = q0 * w - q1 * x - q2 * y - q3 * z + lost0
        step1 = q0 * x + q1 * w + q2 * z - q3 * y + lost1
        step2 = q0 * y - q1 * z + q2 * w + q3 * x + lost2
        step3 = q0 * z + q1 * y - q2 * x + q3 * w + lost3
        q0, lost0 = add(q0, step0)
        q1, lost1 = add(q1, step1)
        q2, lost2 = add(q2, step2)
        q3, lost3 = add(q3, step3)
        lost0, lost1, lost2, lost3 = lost0 + r * q0, lost1 + r * q1, lost2 + r * q2, lost3 + r * q3
        out[n, 0], out[n, 1], out[n, 2], out[n, 3] = q0, q1, q2, q3
    carry[0], carry[1], carry[2], carry[3] = q0, q1, q2, q3
    carry[4], carry[5], carry[6], carry[7] = lost0, lost1, lost2, lost3


@njit
def add_terms(q: Array, terms: int, last: Indices, lanes: int, u: float, total: Array) -> None:
    """Fill total (4, lanes) with the sum of q_k u^k, u = 1 or -1, for k from 1 to last[lane]."""
    clear(total, lanes)
    for k in range(terms, 0, -1):  # small terms first
        sign = u if k % 2 else 1.0
        for i in range(4):
            for lane in range(lanes):
                total[i, lane] += sign * q[k, i, lane] if k <= last[lane] else 0.0


@njit
def depart(start: Array, lanes: int, total: Array) -> None:
    """Turn total (4, lanes), the end of an update, into (1 + start)* o (1 + total) - 1: seen from its start."""
    for lane in range(lanes):
        a, x, y, z = start[0, lane], -start[1, lane], -start[2, lane], -start[3, lane]
        b, p, q, r = total[0, lane], total[1, lane], total[2, lane], total[3, lane]
        total[0, lane] = a + b + (a * b - x * p - y * q - z * r)
        total[1, lane] = x + p + (a * p + x * b + y * r - z * q)
        total[2, lane] = y + q + (a * q - x * r + y * b + z * p)
        total[3, lane] = z + r + (a * r + x * q - y * p + z * b)


@njit
def taylor_quaternion(
    G: Array,
    factor: Array,
    adapt: bool,
    centred: bool,
    dtheta: Array,
    starts: Indices,
    offsets: Indices,
    largest: Array,
    carry: Array,
    out: Array,
) -> None:
    """Do len(out) updates by q_{k+1} = factor_k sum_m q_{k-m} o (0, w_m), factor_k = 1/(2(k+1)).

    G is (offsets, W, W), for u from 0 to 1, or for u from -1 to 1 if `centred`; len(factor) terms are summed, or with
    `adapt` as many of them as count; largest (W,) takes the largest |w_m|^2; carry is that of `turn`.
    """
    W, K, number = G.shape[1], len(factor), dtheta.dtype
    d, w, sizes = np.empty((W, 3, LANES), number), np.empty((W, 3, LANES), number), np.empty((W, LANES), number)
    q, total, a = np.empty((K + 1, 4, LANES), number), np.empty((4, LANES), number), np.empty((K + 1, LANES), number)
    start, quiet, last = np.empty((4, LANES), number), np.empty(LANES, np.int64), np.empty(LANES, np.int64)
    for i in range(4):
        for lane in range(LANES):
            q[0, i, lane] = 0.0 if i else 1.0
    begin = 0
    while begin < len(out):
        end = alike(offsets, begin)
        lanes = end - begin
        fit(G, offsets[begin], dtheta, starts, begin, end, d, w)
        note_largest(w, lanes, largest)
        terms = count_terms(w, lanes, factor, adapt, sizes, a, quiet, last)
        for k in range(terms):
            clear(total, lanes)
            for m in range(min(k + 1, W)):
                for lane in range(lanes):
                    p0, p1, p2, p3 = q[k - m, 0, lane], q[k - m, 1, lane], q[k - m, 2, lane], q[k - m, 3, lane]
                    x, y, z = w[m, 0, lane], w[m, 1, lane], w[m, 2, lane]
                    total[0, lane] -= p1 * x + p2 * y + p3 * z
                    total[1, lane] += p0 * x + p2 * z - p3 * y
                    total[2, lane] += p0 * y - p1 * z + p3 * x
                    total[3, lane] += p0 * z + p1 * y - p2 * x
            for i in range(4):
                for lane in range(lanes):
                    q[k + 1, i, lane] = factor[k] * total[i, lane]
        add_terms(q, terms, last, lanes, 1.0, total)
        if centred:
            add_terms(q, terms, last, lanes, -1.0, start)
            depart(start, lanes, total)
        turn(carry, total, begin, end, out)
        begin = end


@njit
def quaternion_of(C: Array, out: Array) -> None:
    """Fill out (4,) with the quaternion, w >= 0, of a matrix given row by row, as `rotation.quat_from_matrix`."""
    xx, yy, zz = C[0], C[4], C[8]
    wx, wy, wz = C[7] - C[5], C[2] - C[6], C[3] - C[1]
    xy, xz, yz = C[1] + C[3], C[2] + C[6], C[5] + C[7]
    ww = xx + yy + zz
    if ww >= xx and ww >= yy and ww >= zz:
        a, b, c, d = 1.0 + ww, wx, wy, wz
    elif xx >= yy and xx >= zz:
        a, b, c, d = wx, 1.0 + xx - yy - zz, xy, xz
    elif yy >= zz:
        a, b, c, d = wy, xy, 1.0 - xx + yy - zz, yz
    else:
        a, b, c, d = wz, xz, yz, 1.0 - xx - yy + zz
    scale = 1.0 / math.sqrt(a * a + b * b + c * c + d * d)
    if scale == 0.0:
        scale = math.nan  # the squares overflow: this is no rotation
    if a < 0.0:
        scale = -scale
    out[0], out[1], out[2], out[3] = a * scale, b * scale, c * scale, d * scale


@njit
def turn_matrix(C: Array, D: Array, orthonormalise: bool, new: Array) -> None:
    """Replace C (9,) by C (1 + D), made orthonormal if asked; `new` (9,) is scratch."""
    for i in range(0, 9, 3):
        for j in range(3):
            new[i + j] = C[i + j] + (C[i] * D[j] + C[i + 1] * D[3 + j] + C[i + 2] * D[6 + j])
    if not orthonormalise:
        for j in range(9):
            C[j] = new[j]
        return
    # C (3 - C^T C)/2: the error is squared, and is as small as the truncation before.
    xx = 0.5 * (1.0 - (new[0] * new[0] + new[3] * new[3] + new[6] * new[6]))
    yy = 0.5 * (1.0 - (new[1] * new[1] + new[4] * new[4] + new[7] * new[7]))
    zz = 0.5 * (1.0 - (new[2] * new[2] + new[5] * new[5] + new[8] * new[8]))
    xy = -0.5 * (new[0] * new[1] + new[3] * new[4] + new[6] * new[7])
    xz = -0.5 * (new[0] * new[2] + new[3] * new[5] + new[6] * new[8])
    yz = -0.5 * (new[1] * new[2] + new[4] * new[5] + new[7] * new[8])
    for i in range(0, 9, 3):
        x, y, z = new[i], new[i + 1], new[i + 2]
        C[i] = x + (x * xx + y * xy + z * xz)
        C[i + 1] = y + (x * xy + y * yy + z * yz)
        C[i + 2] = z + (x * xz + y * yz + z * zz)


@njit
def taylor_matrix(
    G: Array,
    factor: Array,
    adapt: bool,
    orthonormalise: bool,
    dtheta: Array,
    starts: Indices,
    offsets: Indices,
    largest: Array,
    carry: Array,
    out: Array,
) -> None:
    """Do len(out) updates by C_{k+1} = factor_k sum_m C_{k-m} [w_m x], factor_k = 1/(k+1).

    The arguments are those of `taylor_quaternion`; carry begins with C (9), row by row.
    """
    W, K, number = G.shape[1], len(factor), dtheta.dtype
    d, w, sizes = np.empty((W, 3, LANES), number), np.empty((W, 3, LANES), number), np.empty((W, LANES), number)
    C, total, a = np.empty((K + 1, 9, LANES), number), np.empty((9, LANES), number), np.empty((K + 1, LANES), number)
    quiet, last = np.empty(LANES, np.int64), np.empty(LANES, np.int64)
    D, scratch = np.empty(9, number), np.empty(9, number)
    for j in range(9):
        for lane in range(LANES):
            C[0, j, lane] = 0.0 if j % 4 else 1.0
    begin = 0
    while begin < len(out):
        end = alike(offsets, begin)
        lanes = end - begin
        fit(G, offsets[begin], dtheta, starts, begin, end, d, w)
        note_largest(w, lanes, largest)
        terms = count_terms(w, lanes, factor, adapt, sizes, a, quiet, last)
        for k in range(terms):
            clear(total, lanes)
            for m in range(min(k + 1, W)):
                for i in range(0, 9, 3):
                    for lane in range(lanes):
                        p0, p1, p2 = C[k - m, i, lane], C[k - m, i + 1, lane], C[k - m, i + 2, lane]
                        x, y, z = w[m, 0, lane], w[m, 1, lane], w[m, 2, lane]
                        total[i, lane] += p1 * z - p2 * y
                        total[i + 1, lane] += p2 * x - p0 * z
                        total[i + 2, lane] += p0 * y - p1 * x
            for j in range(9):
                for lane in range(lanes):
                    C[k + 1, j, lane] = factor[k] * total[j, lane]
        clear(total, lanes)
        for k in range(terms, 0, -1):  # small terms first
            for j in range(9):
                for lane in range(lanes):
                    total[j, lane] += C[k, j, lane] if k <= last[lane] else 0.0
        for lane in range(lanes):
            for j in range(9):
                D[j] = total[j, lane]
            turn_matrix(carry, D, orthonormalise, scratch)
            quaternion_of(carry, out[begin + lane])
        begin = end


@njit
def neglected(sizes: Array, share: float, terms: int, tolerance: float, most: int) -> tuple[float, int]:
    """Return a bound of the terms above `terms`, and how many terms keep it below the tolerance.

    The coefficients of exp(share sum_m sizes_m u^(m+1)/(m+1)) majorise the series of a rate with |w_m| <= sizes_m.
    No more than `most` terms are looked at.
    """
    a = np.zeros(most + 1)
    a[0] = 1.0
    for k in range(most):
        for m in range(min(k + 1, sizes.shape[0])):
            a[k + 1] += sizes[m] * a[k - m]
        a[k + 1] *= share / (k + 1)
    tail = 0.0
    needed = most
    for k in range(most, terms, -1):
        tail += a[k]
        if tail <= tolerance:
            needed = k - 1
    return tail, needed
