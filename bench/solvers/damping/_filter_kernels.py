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
def measure(x, P, H, z0, z1, variance, threshold, scratch, out):
    """Use a measurement of two components unless its innovation is too large; return 1.0 if it was used.

    H is (2, n); out (3,) receives the innovation and its normalised square.
    """
    n = x.shape[0]
    a, b, d = variance, 0.0, variance
    u, v = z0, z1
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
    if not out[2] <= threshold:
        return 0.0
    joseph(x, P, H[0], z0, variance, scratch[0], scratch[1])
    joseph(x, P, H[1], z1, variance, scratch[0], scratch[1])
    return 1.0


@njit
def change(x1, x2, P2, r, held, T, variance, threshold, scratch, found):
    """Use the change of filter 1's velocity error over T in filter 2; return 1.0 if it was used.

    The INS's own change of velocity, less that of the smoothed reference v_INS - dv_1, is dv_1(t2) - dv_1(t1); and
    since Phi' = F Phi, (1/T) int F_(1:2) Phi(t, t2) dt is (1/T) [I - Phi(t2, t1)^-1]_(1:2).
    """
    H = np.empty((2, COLUMNS))
    for a in range(2):
        for j in range(COLUMNS):
            H[a, j] = -r[a, j] / T
        H[a, a] += 1.0 / T
    z0, z1 = (x1[0] - held[0]) / T, (x1[1] - held[1]) / T
    return measure(x2, P2, H, z0, z1, variance, threshold, scratch, found)


@njit
def store(k, x, P, found, out_x, out_sigma, out_found):
    """Write row k: estimate, standard deviations, innovation (2), NIS and whether it was used."""
    for i in range(x.shape[0]):
        out_x[k, i] = x[i]
        out_sigma[k, i] = math.sqrt(P[i, i])
    for i in range(4):
        out_found[k, i] = found[i]


@njit
def run(
    p, deflection, dt, rows, f_n, v_ref, first, rate, q, variance, threshold, steps, variance2,
    x1, P1, x2, P2, r, held, every, out_x1, out_s1, out_found1, out_x2, out_s2, out_found2, kept1, kept2,
):  # fmt: skip
    """Run filter 1 and, if steps > 0, filter 2 behind it over the samples of a chunk.

    rows (m + 1, 7) are v_E, v_N, L, q_nb of the sample before the chunk and of its samples; `first` counts the samples
    before it. States beyond 13 are the error of the reference. x1, P1, x2, P2, the rows r (2, 13) that accumulate
    Phi(t2, t1)^-1 and filter 1's velocity errors at t1 (held) are changed in place.
    """
    n = x1.shape[0]
    F, term = np.empty((ROWS, COLUMNS)), np.empty((2, ROWS, COLUMNS))
    forth, half, back = np.empty((ROWS, COLUMNS)), np.empty((ROWS, COLUMNS)), np.empty((ROWS, COLUMNS))
    M, scratch, found = np.empty((ROWS, n)), np.empty((2, n)), np.empty(4)
    decay, half_decay, growth = np.exp(-dt * rate), np.exp(-0.5 * dt * rate), np.exp(dt * rate)
    H1 = np.zeros((2, n))
    for a in range(2):
        H1[a, a] = 1.0
        if n > COLUMNS:
            H1[a, COLUMNS + a] = -1.0
    kept = 0
    for k in range(f_n.shape[0]):
        row = first + k
        if row > 0:
            step_matrix(p, deflection, rows[k], rows[k + 1], f_n[k], F)
            transition(F, rate, dt, term, forth, half, back)
            predict(x1, P1, forth, half, decay, half_decay, q, dt, M, scratch[0])
        found[0], found[1], found[2], found[3] = np.nan, np.nan, np.nan, 0.0
        if not math.isnan(v_ref[k, 0]):
            z0, z1 = rows[k + 1, 0] - v_ref[k, 0], rows[k + 1, 1] - v_ref[k, 1]
            found[3] = measure(x1, P1, H1, z0, z1, variance, threshold, scratch, found)
        store(k, x1, P1, found, out_x1, out_s1, out_found1)
        if every > 0 and row % every == 0:
            kept1[kept] = P1
        if steps > 0:
            found[0], found[1], found[2], found[3] = np.nan, np.nan, np.nan, 0.0
            if row > 0:
                predict(x2, P2, forth, half, decay, half_decay, q, dt, M, scratch[0])
                turn_back(r, back, growth, scratch[0])
            if row % steps == 0:
                if row > 0:
                    found[3] = change(x1, x2, P2, r, held, dt * steps, variance2, threshold, scratch, found)
                r[:] = 0.0
                for a in range(2):
                    r[a, a] = 1.0
                    held[a] = x1[a]
            store(k, x2, P2, found, out_x2, out_s2, out_found2)
            if every > 0 and row % every == 0:
                kept2[kept] = P2
        if every > 0 and row % every == 0:
            kept += 1


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
