"""Kernels of one update's increments: rotation vector, single and double integral of the specific force in the body.

Vectors are in body axes at the start of the update; increments are rows of (dtheta_b, dvel_b). `block_integrals` does
for many updates side by side what `body_integrals` and `rotation_terms` do for one, in half the time.
"""

import math

import numpy as np

from bench.jit import njit

BLOCK = 64  # updates side by side: the compiler turns each loop over them into vector instructions
SERIES = 0.04  # rad^2: for turns whose square is below, the power series are at rounding


@njit
def cross(ax, ay, az, bx, by, bz):
    """Return a x b."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@njit
def body_integrals(coning, sculling, double_sum, scrolling, d, begin):
    """Return the rotation vector, and the single and double integral of f (the latter over T) of N increments.

    d (n, 6) holds dtheta and dvel from row `begin` on. sigma = sum d_i + sum_{i<j} K_ij d_i x d_j,
    u = sum v_j + sum_ij S_ij d_i x v_j, s = sum a_j v_j + sum_ij L_ij d_i x v_j.
    """
    N = coning.shape[0]
    px = py = pz = ux = uy = uz = sx = sy = sz = 0.0
    for j in range(N):
        dx, dy, dz = d[begin + j, 0], d[begin + j, 1], d[begin + j, 2]
        vx, vy, vz = d[begin + j, 3], d[begin + j, 4], d[begin + j, 5]
        kx = ky = kz = cx = cy = cz = lx = ly = lz = 0.0
        for i in range(N):
            ex, ey, ez = d[begin + i, 0], d[begin + i, 1], d[begin + i, 2]
            c, f = sculling[i, j], scrolling[i, j]
            cx, cy, cz = cx + c * ex, cy + c * ey, cz + c * ez
            lx, ly, lz = lx + f * ex, ly + f * ey, lz + f * ez
            if i < j:
                k = coning[i, j]
                kx, ky, kz = kx + k * ex, ky + k * ey, kz + k * ez
        wx, wy, wz = cross(kx, ky, kz, dx, dy, dz)
        px, py, pz = px + (dx + wx), py + (dy + wy), pz + (dz + wz)
        wx, wy, wz = cross(cx, cy, cz, vx, vy, vz)
        ux, uy, uz = ux + (vx + wx), uy + (vy + wy), uz + (vz + wz)
        a = double_sum[j]
        wx, wy, wz = cross(lx, ly, lz, vx, vy, vz)
        sx, sy, sz = sx + (a * vx + wx), sy + (a * vy + wy), sz + (a * vz + wz)
    return px, py, pz, ux, uy, uz, sx, sy, sz


@njit
def rotation_terms(px, py, pz, ux, uy, uz):
    """Return what the turning of the body adds to the single and the double integral (over T) of f, exactly.

    For one constant rate and specific force: a1 p x u + a2 p x (p x u) and (a2 - 1/6) p x u + a3 p x (p x u),
    a1 = (1 - cos p)/p^2, a2 = (p - sin p)/p^3, a3 = (1/2 - a1)/p^2; 1/6 is in the scrolling sum already.
    """
    square = px * px + py * py + pz * pz
    if square < SERIES:
        a1 = 1 / 2 + square * (-1 / 24 + square * (1 / 720 + square * (-1 / 40320 + square * (1 / 3628800))))
        a2 = square * (-1 / 120 + square * (1 / 5040 + square * (-1 / 362880 + square * (1 / 39916800))))
        a3 = 1 / 24 + square * (-1 / 720 + square * (1 / 40320 + square * (-1 / 3628800)))
    else:
        angle = math.sqrt(square)
        a1 = (1.0 - math.cos(angle)) / square
        a2 = (1.0 - math.sin(angle) / angle) / square - 1 / 6
        a3 = (0.5 - a1) / square
    wx, wy, wz = cross(px, py, pz, ux, uy, uz)
    xx, xy, xz = cross(px, py, pz, wx, wy, wz)
    b2 = a2 + 1 / 6
    return (
        a1 * wx + b2 * xx,
        a1 * wy + b2 * xy,
        a1 * wz + b2 * xz,
        a2 * wx + a3 * xx,
        a2 * wy + a3 * xy,
        a2 * wz + a3 * xz,
    )


@njit
def block_integrals(S, a, L, exact, d, begin, count, out):
    """Fill out (10, BLOCK): quaternion of the turn of the body, single and double integral of f (the latter over T).

    Of the N count increments in d (n, 6) from row `begin` on, a column an update. S, a, L as in `body_integrals`; the
    coning is ``1/2 sum_ij S_ij d_i x d_j``, to which a constant added to S does nothing. With `exact` the integrals
    hold the `rotation_terms`.
    """
    N = S.shape[0]
    # Arrays of its own: of these the compiler knows that they do not overlap, or it would not vectorise.
    work, part, total = np.empty((N, 6, BLOCK)), np.empty((6, BLOCK)), np.zeros((10, BLOCK))
    for u in range(count):
        for j in range(N):
            for c in range(6):
                work[j, c, u] = d[begin + u * N + j, c]
    for j in range(N):
        part[:] = 0.0
        for i in range(N):
            f, g = S[i, j], L[i, j]
            for c in range(3):
                for u in range(count):
                    part[c, u] += f * work[i, c, u]
                for u in range(count):
                    part[c + 3, u] += g * work[i, c, u]
        w = a[j]
        for u in range(count):
            px, py, pz = part[0, u], part[1, u], part[2, u]
            lx, ly, lz = part[3, u], part[4, u], part[5, u]
            dx, dy, dz = work[j, 0, u], work[j, 1, u], work[j, 2, u]
            vx, vy, vz = work[j, 3, u], work[j, 4, u], work[j, 5, u]
            total[1, u] += dx + 0.5 * (py * dz - pz * dy)
            total[2, u] += dy + 0.5 * (pz * dx - px * dz)
            total[3, u] += dz + 0.5 * (px * dy - py * dx)
            total[4, u] += vx + (py * vz - pz * vy)
            total[5, u] += vy + (pz * vx - px * vz)
            total[6, u] += vz + (px * vy - py * vx)
            total[7, u] += w * vx + (ly * vz - lz * vy)
            total[8, u] += w * vy + (lz * vx - lx * vz)
            total[9, u] += w * vz + (lx * vy - ly * vx)
    turn_coefficients(total, count, part)
    for u in range(count):
        px, py, pz, ux, uy, uz = total[1, u], total[2, u], total[3, u], total[4, u], total[5, u], total[6, u]
        c, f, a1, a2, a3 = part[0, u], part[1, u], part[2, u], part[3, u], part[4, u]
        total[0, u], total[1, u], total[2, u], total[3, u] = c, f * px, f * py, f * pz
        if exact:
            wx, wy, wz = cross(px, py, pz, ux, uy, uz)
            xx, xy, xz = cross(px, py, pz, wx, wy, wz)
            b2 = a2 + 1 / 6
            total[4, u], total[5, u] = ux + (a1 * wx + b2 * xx), uy + (a1 * wy + b2 * xy)
            total[6, u] = uz + (a1 * wz + b2 * xz)
            total[7, u] += a2 * wx + a3 * xx
            total[8, u] += a2 * wy + a3 * xy
            total[9, u] += a2 * wz + a3 * xz
    for c in range(10):
        for u in range(count):
            out[c, u] = total[c, u]


@njit
def turn_coefficients(total, count, out):
    """Fill out[:5] with cos p/2, sin(p/2)/p and the a1, a2 - 1/6, a3 of `rotation_terms`; total[1:4] are the vectors p.

    Series for all, so that they are vector instructions, then the closed forms for the few turns that are large.
    """
    for u in range(count):
        px, py, pz = total[1, u], total[2, u], total[3, u]
        s = px * px + py * py + pz * pz
        out[0, u] = 1.0 + s * (-1 / 8 + s * (1 / 384 + s * (-1 / 46080 + s * (1 / 10321920))))
        out[1, u] = 0.5 + s * (-1 / 48 + s * (1 / 3840 + s * (-1 / 645120 + s * (1 / 185794560))))
        out[2, u] = 1 / 2 + s * (-1 / 24 + s * (1 / 720 + s * (-1 / 40320 + s * (1 / 3628800))))
        out[3, u] = s * (-1 / 120 + s * (1 / 5040 + s * (-1 / 362880 + s * (1 / 39916800))))
        out[4, u] = 1 / 24 + s * (-1 / 720 + s * (1 / 40320 + s * (-1 / 3628800)))
        out[5, u] = s
    for u in range(count):
        s = out[5, u]
        if s >= SERIES:
            angle = math.sqrt(s)
            out[0, u], out[1, u] = math.cos(0.5 * angle), math.sin(0.5 * angle) / angle
            out[2, u] = (1.0 - math.cos(angle)) / s
            out[3, u] = (1.0 - math.sin(angle) / angle) / s - 1 / 6
            out[4, u] = (0.5 - out[2, u]) / s
