"""Kernels of the damping filters: Joseph updates, the loop over samples, and the fusion of two solutions."""

import math

import numpy as np

from bench.jit import njit
from bench.solvers.damping._error_kernels import COLUMNS, ROWS, predict, step_matrix, transition, turn_back


@njit
def joseph(x, P, h, z, variance, g, c):
    """Use one scalar measurement z = h x + noise, in place; g and c (n,) are scratch.

    P becomes (I - K h) P (I - K h)^T + K r K^T, which stays symmetric and positive whatever the rounding of K.
    """
    n = x.shape[0]
    s, residual = variance, z
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += P[i, j] * h[j]
        g[i] = total
    for i in range(n):
        s += h[i] * g[i]
        residual -= h[i] * x[i]
    # M = P - K g^T; then P' = M - (M h) K^T + r K K^T.
    for i in range(n):
        K = g[i] / s
        x[i] += K * residual
        total = 0.0
        for j in range(n):
            P[i, j] -= K * g[j]
            total += P[i, j] * h[j]
        c[i] = total
    for i in range(n):
        for j in range(i + 1):
            value = 0.5 * (P[i, j] + P[j, i])
            value += (variance * g[i] * g[j] / s - 0.5 * (c[i] * g[j] + c[j] * g[i])) / s
            P[i, j] = value
            P[j, i] = value


@njit
def measure(x, P, H, z, variance, threshold, scratch, out):
    """Use a measurement of two components unless its innovation is too large; return 1.0 if it was used.

    H is (2, n); out (4,) receives the innovation and its normalised square.
    """
    n = x.shape[0]
    a, b, d = variance, 0.0, variance
    u, v = z[0], z[1]
    for i in range(n):
        g0, g1 = 0.0, 0.0
        for j in range(n):
            g0 += P[i, j] * H[0, j]
            g1 += P[i, j] * H[1, j]
        a += H[0, i] * g0
        b += H[0, i] * g1
        d += H[1, i] * g1
        u -= H[0, i] * x[i]
        v -= H[1, i] * x[i]
    out[0], out[1] = u, v
    out[2] = (d * u * u - 2.0 * b * u * v + a * v * v) / (a * d - b * b)
    if out[2] > threshold:
        return 0.0
    for c in range(2):
        joseph(x, P, H[c], z[c], variance, scratch[0], scratch[1])
    return 1.0


@njit
def copy(source, target):
    """Copy a matrix; an assignment of slices takes seconds to compile."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]


@njit
def measurement(which, here, v_ref, x, r, held, T, H, z):
    """Fill H (2, n) and z (2,) of filter 1 (which = 0) or 2 (1); return whether there is a measurement.

    Filter 2: the INS's own change of velocity, less that of the smoothed reference v_INS - dv_1, is
    dv_1(t2) - dv_1(t1); and since Phi' = F Phi, (1/T) int F_(1:2) Phi(t, t2) dt is (1/T) [I - Phi(t2, t1)^-1]_(1:2).
    """
    for a in range(2):
        for j in range(H.shape[1]):
            H[a, j] = 0.0
        if which == 0:
            z[a] = here[a] - v_ref[a]
            H[a, a] = 1.0
            if x.shape[1] > COLUMNS:
                H[a, COLUMNS + a] = -1.0
        else:
            z[a] = (x[0, a] - held[a]) / T
            for j in range(r.shape[1]):
                H[a, j] = -r[a, j] / T
            H[a, a] += 1.0 / T
    return not math.isnan(z[0])


@njit
def run(
    p,
    deflection,
    dt,
    rows,
    f_n,
    v_ref,
    first,
    rate,
    shares,
    q,
    variances,
    threshold,
    steps,
    every,
    x,
    P,
    r,
    held,
    out_x,
    out_sigma,
    out_found,
    kept,
):
    """Run filter 1, or filters 1 and 2 in series, over the samples of a chunk.

    rows (m + 1, 7) are v_E, v_N, L, q_nb of the sample before the chunk and of its samples; `first` counts the samples
    before it. rate (n,) is 1/tau and shares (3, n) what is left of the states after dt, after dt/2 and before dt, for
    those that decay by themselves. x (f, n) and P (f, n, n) of the f filters, the rows r (2, 13) that accumulate
    Phi(t2, t1)^-1 and filter 1's velocity errors at t1 (held) are changed in place. States beyond 13 are the error of
    the reference. The
    outputs (f, m, ...) receive estimate, standard deviations, and innovation (2), NIS and whether it was used; kept
    (f, j, n, n) the covariance of every `every`-th sample.
    """
    filters, n = x.shape
    F, term = np.empty((ROWS, COLUMNS)), np.empty((2, ROWS, COLUMNS))
    forth, half, back = np.empty((ROWS, COLUMNS)), np.empty((ROWS, COLUMNS)), np.empty((ROWS, COLUMNS))
    M, scratch, H, z = np.empty((ROWS, n)), np.empty((2, n)), np.empty((2, n)), np.empty(2)
    decay, half_decay, growth = shares[0], shares[1], shares[2]
    for k in range(f_n.shape[0]):
        row = first + k
        if row > 0:
            step_matrix(p, deflection, rows[k], rows[k + 1], f_n[k], F)
            transition(F, rate, dt, term, forth, half, back)
            turn_back(r, back, growth, scratch[0])
        for which in range(filters):
            found = out_found[which, k]
            found[0], found[1], found[2], found[3] = np.nan, np.nan, np.nan, 0.0
            if row > 0:
                predict(x[which], P[which], forth, half, decay, half_decay, q, dt, M, scratch[0])
            due = which == 0 or (row > 0 and row % steps == 0)
            if due and measurement(which, rows[k + 1], v_ref[k], x, r, held, dt * steps, H, z):
                found[3] = measure(x[which], P[which], H, z, variances[which], threshold, scratch, found)
            for i in range(n):
                out_x[which, k, i] = x[which, i]
                out_sigma[which, k, i] = math.sqrt(P[which, i, i])
            if every > 0 and row % every == 0:
                copy(P[which], kept[which, (row - 1) // every - (first - 1) // every])
        if row % steps == 0:
            for a in range(2):
                for j in range(r.shape[1]):
                    r[a, j] = 1.0 if j == a else 0.0
                held[a] = x[0, a]


@njit
def fuse(x1, s1, x2, s2, gamma, box, state, out_x, out_s, weight):
    """Fuse rows of two solutions (m, n): estimates x and standard deviations s.

    Filter 1's variance grows by gamma times the square of the mean of x1 - x2: over all rows so far, or over the last
    len(box) ones; box (w, n) keeps those, state (n + 1,) their sum and the number of rows seen, both changed in place.
    """
    n = x1.shape[1]
    length = box.shape[0]
    for k in range(x1.shape[0]):
        seen = state[n]
        count = seen + 1.0
        if length > 0:
            count = min(count, float(length))
        slot = int(seen % length) if length > 0 else 0
        for i in range(n):
            difference = x1[k, i] - x2[k, i]
            state[i] += difference
            if length > 0:
                if seen >= length:
                    state[i] -= box[slot, i]
                box[slot, i] = difference
            mean = state[i] / count
            p1 = s1[k, i] * s1[k, i] + gamma[k] * mean * mean
            p2 = s2[k, i] * s2[k, i]
            share = p2 / (p1 + p2)
            weight[k, i] = share
            out_x[k, i] = share * x1[k, i] + (1.0 - share) * x2[k, i]
            out_s[k, i] = math.sqrt(share * p1)
        state[n] = seen + 1.0
