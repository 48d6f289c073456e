"""Kernels of the polynomial-exact algorithm: the power series of the specific force in fixed axes, and its sums.

Over an update u runs from -1 to 1, and rate and force are sum_m w_m u^m and sum_m f_m u^m, in rad and m/s per half
update. Series of different updates are summed side by side in the lanes of `_taylor_kernels`, which do the same
operations in the same order whatever their neighbours.
"""

import numpy as np

from bench._compensated_kernels import two_sum
from bench.earth_kernels import gravitation
from bench.jit import njit
from bench.rotation_kernels import rotate
from bench.solvers.attitude._taylor_kernels import LANES, clear, count_terms, fit, quaternion_of, turn
from bench.solvers.navigation._inertial_kernels import earth_fixed, earth_turn, held

FARTHEST = 8.0  # rad, of all |w_m|/(m+1) together: the terms grow to its exponential before they cancel
SWEEPS = 2  # of gravitation and position: each makes the error of the first guess about T^2 g/r, 1e-8, times smaller


@njit
def first_far(sizes, lanes):
    """Return the first lane with sum_m |w_m|/(m+1) above FARTHEST, sizes (N, lanes) being |w_m|; else `lanes`."""
    for lane in range(lanes):
        total = 0.0
        for m in range(sizes.shape[0]):
            total += sizes[m, lane] / (m + 1)
        if not total < FARTHEST:
            return lane
    return lanes


@njit
def matrix_series(w, factor, last, terms, lanes, C, total):
    """Fill C (k, 9, lanes), k <= terms, with the series of C' = C [w x], C_0 = I; zero after last[lane]."""
    N = w.shape[0]
    for k in range(terms):
        clear(total, lanes)
        for m in range(min(k + 1, N)):
            for i in range(0, 9, 3):
                for lane in range(lanes):
                    p0, p1, p2 = C[k - m, i, lane], C[k - m, i + 1, lane], C[k - m, i + 2, lane]
                    x, y, z = w[m, 0, lane], w[m, 1, lane], w[m, 2, lane]
                    total[i, lane] += p1 * z - p2 * y
                    total[i + 1, lane] += p2 * x - p0 * z
                    total[i + 2, lane] += p0 * y - p1 * x
        for i in range(9):
            for lane in range(lanes):
                C[k + 1, i, lane] = factor[k] * total[i, lane] if k < last[lane] else 0.0


@njit
def force_sums(C, terms, f, weights, lanes, c, sums):
    """Fill sums (rows, 3, lanes) with sum_k weights[row, k] c_k, c_k = sum_m C_{k-m} f_m; c (3, lanes) is scratch."""
    N = f.shape[0]
    for row in range(weights.shape[0]):
        clear(sums[row], lanes)
    for k in range(terms + N - 1, -1, -1):  # small terms first
        clear(c, lanes)
        for m in range(max(0, k - terms), min(k + 1, N)):
            for i in range(3):
                for lane in range(lanes):
                    c[i, lane] += (
                        C[k - m, 3 * i, lane] * f[m, 0, lane]
                        + C[k - m, 3 * i + 1, lane] * f[m, 1, lane]
                        + C[k - m, 3 * i + 2, lane] * f[m, 2, lane]
                    )
        for row in range(weights.shape[0]):
            for i in range(3):
                for lane in range(lanes):
                    sums[row, i, lane] += weights[row, k] * c[i, lane]


@njit
def ends(C, terms, lanes, start, end):
    """Fill start and end (9, lanes) with C(-1) - I and C(1) - I."""
    clear(start, lanes)
    clear(end, lanes)
    for k in range(terms, 0, -1):
        sign = -1.0 if k % 2 else 1.0
        for i in range(9):
            for lane in range(lanes):
                start[i, lane] += sign * C[k, i, lane]
                end[i, lane] += C[k, i, lane]


@njit
def turns(start, end, lanes, E, q, delta):
    """Fill delta (4, lanes) with the quaternion, less 1, of the turn C(-1)^T C(1); E (9,) and q (4,) are scratch.

    The entries off the diagonal never meet a 1, and keep the digits of a small turn.
    """
    for lane in range(lanes):
        for i in range(3):
            for j in range(3):
                total = end[3 * i + j, lane] + start[3 * j + i, lane]
                for k in range(3):
                    total += start[3 * k + i, lane] * end[3 * k + j, lane]
                E[3 * i + j] = total
        for i in range(0, 9, 4):
            E[i] += 1.0
        quaternion_of(E, q)
        delta[0, lane], delta[1, lane], delta[2, lane], delta[3, lane] = q[0] - 1.0, q[1], q[2], q[3]


@njit
def from_start(start, lanes, sums):
    """Turn sums (rows, 3, lanes) from the axes half-way into those at the start, by C(-1) transposed."""
    for row in range(sums.shape[0]):
        for lane in range(lanes):
            x, y, z = sums[row, 0, lane], sums[row, 1, lane], sums[row, 2, lane]
            sums[row, 0, lane] = x + (start[0, lane] * x + start[3, lane] * y + start[6, lane] * z)
            sums[row, 1, lane] = y + (start[1, lane] * x + start[4, lane] * y + start[7, lane] * z)
            sums[row, 2, lane] = z + (start[2, lane] * x + start[5, lane] * y + start[8, lane] * z)


def body_series(G, factor, weights, dtheta, dvel, starts, attitude, integrals, q_ib):
    """Fill q_ib (u, 4) with the attitude after updates, and integrals (u, rows, 3) with those of f in their first axes.

    G is a table of `_rate_fit.difference_tables`, centred; weights (rows, k) are those of c_k in each integral;
    attitude (8,) is the running one of `turn`. Returns how many updates it did: the series of the next one would lose
    its digits, or needs more than len(factor) terms. Not a kernel itself: as one, it takes three times as long to
    compile.
    """
    N, K, rows = G.shape[1], len(factor), weights.shape[0]
    d, w, f = np.empty((N, 3, LANES)), np.empty((N, 3, LANES)), np.empty((N, 3, LANES))
    sizes, a, C = np.empty((N, LANES)), np.empty((K + 1, LANES)), np.empty((K + 1, 9, LANES))
    c, sums, delta = np.empty((3, LANES)), np.empty((rows, 3, LANES)), np.empty((4, LANES))
    start, end, E, q = np.empty((9, LANES)), np.empty((9, LANES)), np.empty(9), np.empty(4)
    quiet, last = np.empty(LANES, np.int64), np.empty(LANES, np.int64)
    C[0], C[0, ::4] = 0.0, 1.0
    for begin in range(0, len(starts), LANES):
        stop = min(begin + LANES, len(starts))
        lanes = stop - begin
        fit(G, 0, dtheta, starts, begin, stop, d, w)
        fit(G, 0, dvel, starts, begin, stop, d, f)
        terms = count_terms(w, lanes, factor, True, sizes, a, quiet, last)
        far = first_far(sizes, lanes)
        if far < lanes or terms == K:
            return begin + min([far, *np.flatnonzero(last[:lanes] == K)])
        matrix_series(w, factor, last, terms, lanes, C, start)
        force_sums(C, terms, f, weights, lanes, c, sums)
        ends(C, terms, lanes, start, end)
        turns(start, end, lanes, E, q, delta)
        from_start(start, lanes, sums)
        turn(attitude, delta, begin, stop, q_ib)
        integrals[begin:stop] = sums[:, :, :lanes].transpose(2, 0, 1)
    return len(starts)


@njit
def gravitate(p, T, nodes, double, rx, ry, rz, vx, vy, vz, path, G):
    """Fill G (n, 3) with the gravitation at the nodes of an update that begins at r with v.

    path (n, 3): what f adds to a straight path there; T^2 sum_j double[i, j] G_j is what G adds up to node i. G holds
    a first guess.
    """
    n = len(nodes)
    for _ in range(SWEEPS):
        for i in range(n):
            s = T * nodes[i]
            x, y, z = rx + (s * vx + path[i, 0]), ry + (s * vy + path[i, 1]), rz + (s * vz + path[i, 2])
            for j in range(n):
                c = T * T * double[i, j]
                x, y, z = x + c * G[j, 0], y + c * G[j, 1], z + c * G[j, 2]
            G[i, 0], G[i, 1], G[i, 2] = gravitation(p, x, y, z)


@njit
def integrate(p, T, nodes, mean, double, holds, q_ib, integrals, first, carry, out):
    """Do len(out) updates; q_ib (u, 4) is the attitude after them, integrals (u, 2 + n, 3) those of `body_series`.

    mean (2, n): weights of G at the nodes in its integral over T and its double integral over T^2. carry: the attitude
    before (4), v_i (3), what rounding took from it (3), r_i (3), what rounding took from that (3), the last G (3), the
    height held.
    """
    n, rate = len(nodes), p[3]
    path, G = np.empty((n, 3), out.dtype), np.empty((n, 3), out.dtype)
    G[n - 1, 0], G[n - 1, 1], G[n - 1, 2] = carry[16], carry[17], carry[18]
    w, x, y, z = carry[0], carry[1], carry[2], carry[3]
    vx, vy, vz, wx, wy, wz = carry[4], carry[5], carry[6], carry[7], carry[8], carry[9]
    rx, ry, rz, lx, ly, lz = carry[10], carry[11], carry[12], carry[13], carry[14], carry[15]
    height = carry[19]
    for k in range(len(out)):
        fx, fy, fz = rotate(w, x, y, z, integrals[k, 0, 0], integrals[k, 0, 1], integrals[k, 0, 2])
        sx, sy, sz = rotate(w, x, y, z, integrals[k, 1, 0], integrals[k, 1, 1], integrals[k, 1, 2])
        for i in range(n):
            one = integrals[k, 2 + i]
            path[i, 0], path[i, 1], path[i, 2] = rotate(w, x, y, z, one[0], one[1], one[2])
        for i in range(n - 1):
            G[i, 0], G[i, 1], G[i, 2] = G[n - 1, 0], G[n - 1, 1], G[n - 1, 2]
        gravitate(p, T, nodes, double, rx, ry, rz, vx, vy, vz, path, G)
        sx, sy, sz = sx + T * vx, sy + T * vy, sz + T * vz
        for j in range(n):
            c, s = T * mean[0, j], T * T * mean[1, j]
            fx, fy, fz = fx + c * G[j, 0], fy + c * G[j, 1], fz + c * G[j, 2]
            sx, sy, sz = sx + s * G[j, 0], sy + s * G[j, 1], sz + s * G[j, 2]
        rx, lx = two_sum(rx, sx + (lx + T * wx))
        ry, ly = two_sum(ry, sy + (ly + T * wy))
        rz, lz = two_sum(rz, sz + (lz + T * wz))
        vx, wx = two_sum(vx, fx + wx)
        vy, wy = two_sum(vy, fy + wy)
        vz, wz = two_sum(vz, fz + wz)
        w, x, y, z = q_ib[k, 0], q_ib[k, 1], q_ib[k, 2], q_ib[k, 3]
        ch, sh = earth_turn(rate, (first + k + 1) * T)
        ew, ex, ey, ez, ax, ay, az, px, py, pz = earth_fixed(ch, sh, rate, w, x, y, z, vx, vy, vz, rx, ry, rz)
        if holds:
            ax, ay, az, px, py, pz, vx, vy, vz, rx, ry, rz = held(p, ch, sh, height, ax, ay, az, px, py, pz)
            lx = ly = lz = wx = wy = wz = 0.0
        row = out[k]
        row[0], row[1], row[2], row[3] = ew, ex, ey, ez
        row[4], row[5], row[6], row[7], row[8], row[9] = ax, ay, az, px, py, pz
    carry[0], carry[1], carry[2], carry[3] = w, x, y, z
    carry[4], carry[5], carry[6], carry[7], carry[8], carry[9] = vx, vy, vz, wx, wy, wz
    carry[10], carry[11], carry[12], carry[13], carry[14], carry[15] = rx, ry, rz, lx, ly, lz
    carry[16], carry[17], carry[18] = G[n - 1, 0], G[n - 1, 1], G[n - 1, 2]
