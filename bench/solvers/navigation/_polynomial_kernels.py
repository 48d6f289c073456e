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
from bench.solvers.attitude._taylor_kernels import LANES, clear, count_terms, fit
from bench.solvers.navigation._inertial_kernels import earth_fixed, earth_turn, held

SWEEPS = 2  # of gravitation and position: each makes the error of the first guess about T^2 g/r, 1e-8, times smaller


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
def from_start(C, terms, lanes, sums, D):
    """Turn sums (rows, 3, lanes) from the axes half-way into those at the start, u = -1: by C(-1) transposed."""
    clear(D, lanes)
    for k in range(terms, -1, -1):
        sign = -1.0 if k % 2 else 1.0
        for i in range(9):
            for lane in range(lanes):
                D[i, lane] += sign * C[k, i, lane]
    for row in range(sums.shape[0]):
        for lane in range(lanes):
            x, y, z = sums[row, 0, lane], sums[row, 1, lane], sums[row, 2, lane]
            for i in range(3):
                sums[row, i, lane] = D[i, lane] * x + D[3 + i, lane] * y + D[6 + i, lane] * z


@njit
def force_integrals(G, factor, weights, dtheta, dvel, starts, integrals):
    """Fill integrals (u, rows, 3) with the integrals of f over updates, in their first axes; return how many it did.

    G is a table of `_rate_fit.difference_tables`, centred; weights (rows, k) are those of c_k in each integral. An
    update whose series needs more than len(factor) terms ends the work.
    """
    N, K, rows = G.shape[1], len(factor), weights.shape[0]
    number = dtheta.dtype
    d, w, f = np.empty((N, 3, LANES), number), np.empty((N, 3, LANES), number), np.empty((N, 3, LANES), number)
    sizes, a, C = np.empty((N, LANES), number), np.empty((K + 1, LANES), number), np.empty((K + 1, 9, LANES), number)
    D, c, sums = np.empty((9, LANES), number), np.empty((3, LANES), number), np.empty((rows, 3, LANES), number)
    quiet, last = np.empty(LANES, np.int64), np.empty(LANES, np.int64)
    for i in range(9):
        for lane in range(LANES):
            C[0, i, lane] = 0.0 if i % 4 else 1.0
    for begin in range(0, len(starts), LANES):
        end = min(begin + LANES, len(starts))
        lanes = end - begin
        fit(G, 0, dtheta, starts, begin, end, d, w)
        fit(G, 0, dvel, starts, begin, end, d, f)
        terms = count_terms(w, lanes, factor, True, sizes, a, quiet, last)
        for lane in range(lanes):
            if last[lane] == K:
                return begin + lane
        matrix_series(w, factor, last, terms, lanes, C, D)
        force_sums(C, terms, f, weights, lanes, c, sums)
        from_start(C, terms, lanes, sums, D)
        for lane in range(lanes):
            for row in range(rows):
                for i in range(3):
                    integrals[begin + lane, row, i] = sums[row, i, lane]
    return len(starts)


@njit
def gravitate(p, T, nodes, double, rx, ry, rz, vx, vy, vz, path, G):
    """Fill G (n, 3) with the gravitation at the nodes of an update that begins at r with v.

    path (n, 3): what f adds to a straight path there; T^2 sum_j double[i, j] G_j is what G adds up to node i.
    """
    n = len(nodes)
    x, y, z = gravitation(p, rx, ry, rz)
    for j in range(n):
        G[j, 0], G[j, 1], G[j, 2] = x, y, z
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
    """Do len(out) updates; q_ib (u, 4) is the attitude after them, integrals (u, 2 + n, 3) those of `force_integrals`.

    mean (2, n): weights of G at the nodes in its integral over T and its double integral over T^2. carry: the attitude
    before (4), v_i (3), what rounding took from it (3), r_i (3), what rounding took from that (3), the height held.
    """
    n, rate = len(nodes), p[3]
    path, G = np.empty((n, 3), out.dtype), np.empty((n, 3), out.dtype)
    w, x, y, z = carry[0], carry[1], carry[2], carry[3]
    vx, vy, vz, wx, wy, wz = carry[4], carry[5], carry[6], carry[7], carry[8], carry[9]
    rx, ry, rz, lx, ly, lz = carry[10], carry[11], carry[12], carry[13], carry[14], carry[15]
    height = carry[16]
    for k in range(len(out)):
        fx, fy, fz = rotate(w, x, y, z, integrals[k, 0, 0], integrals[k, 0, 1], integrals[k, 0, 2])
        sx, sy, sz = rotate(w, x, y, z, integrals[k, 1, 0], integrals[k, 1, 1], integrals[k, 1, 2])
        for i in range(n):
            one = integrals[k, 2 + i]
            path[i, 0], path[i, 1], path[i, 2] = rotate(w, x, y, z, one[0], one[1], one[2])
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
