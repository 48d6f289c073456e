"""Kernels of one update's increments: rotation vector, single and double integral of the specific force in the body.

Vectors are in body axes at the start of the update; increments are rows of (dtheta_b, dvel_b).
"""

import math

import numpy as np

from bench.jit import njit


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
    if square < 0.04:
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


BLOCK = 64  # updates side by side: the compiler turns each loop over them into vector instructions
SERIES = 0.04  # rad^2: below this square of an angle the power series are at rounding


@njit
def block_integrals(S, a, L, exact, d, begin, count, out):
    """Fill out (10, BLOCK): quaternion of the turn of the body, single and double integral of f (the latter over T).

    ``sigma = sum d_i + 1/2 sum_ij S_ij d_i x d_j``, ``u = sum v_j + sum_ij S_ij d_i x v_j``,
    ``s = sum a_j v_j + sum_ij L_ij d_i x v_j`` of the N count increments d_i, v_i in d (n, 6) from row `begin` on. S is
    antisymmetric; 1/2 added to all of it holds the rotation of the body to first order. With `exact` it is exact for
    one constant rate and force: to u and s are added a1 sigma x u + a2 sigma x (sigma x u) and
    (a2 - 1/6) sigma x u + a3 sigma x (sigma x u), a1 = (1 - cos p)/p^2, a2 = (1 - sin p/p)/p^2, a3 = (1/2 - a1)/p^2,
    p = |sigma|; 1/6 is in L already.
    """
    N = S.shape[0]
    # Arrays that the function makes itself: the compiler sees that they do not overlap.
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
    # Coefficients a1, a2 - 1/6, a3 and those of the quaternion: series, and closed forms for the few large turns.
    for u in range(count):
        px, py, pz = total[1, u], total[2, u], total[3, u]
        s = px * px + py * py + pz * pz
        part[0, u] = 1 / 2 + s * (-1 / 24 + s * (1 / 720 + s * (-1 / 40320 + s * (1 / 3628800))))
        part[1, u] = s * (-1 / 120 + s * (1 / 5040 + s * (-1 / 362880 + s * (1 / 39916800))))
        part[2, u] = 1 / 24 + s * (-1 / 720 + s * (1 / 40320 + s * (-1 / 3628800)))
        part[3, u] = 1.0 + s * (-1 / 8 + s * (1 / 384 + s * (-1 / 46080 + s * (1 / 10321920))))
        part[4, u] = 0.5 + s * (-1 / 48 + s * (1 / 3840 + s * (-1 / 645120 + s * (1 / 185794560))))
        part[5, u] = s
    for u in range(count):
        if part[5, u] > SERIES:
            s = part[5, u]
            angle = math.sqrt(s)
            part[0, u] = (1.0 - math.cos(angle)) / s
            part[1, u] = (1.0 - math.sin(angle) / angle) / s - 1 / 6
            part[2, u] = (0.5 - part[0, u]) / s
            part[3, u], part[4, u] = math.cos(0.5 * angle), math.sin(0.5 * angle) / angle
    for u in range(count):
        px, py, pz, ux, uy, uz = total[1, u], total[2, u], total[3, u], total[4, u], total[5, u], total[6, u]
        a1, a2, a3 = part[0, u], part[1, u], part[2, u]
        c, f = part[3, u], part[4, u]
        total[0, u], total[1, u], total[2, u], total[3, u] = c, f * px, f * py, f * pz
        if exact:
            wx, wy, wz = py * uz - pz * uy, pz * ux - px * uz, px * uy - py * ux
            xx, xy, xz = py * wz - pz * wy, pz * wx - px * wz, px * wy - py * wx
            b2 = a2 + 1 / 6
            total[4, u], total[5, u] = ux + (a1 * wx + b2 * xx), uy + (a1 * wy + b2 * xy)
            total[6, u] = uz + (a1 * wz + b2 * xz)
            total[7, u] += a2 * wx + a3 * xx
            total[8, u] += a2 * wy + a3 * xy
            total[9, u] += a2 * wz + a3 * xz
    for c in range(10):
        for u in range(count):
            out[c, u] = total[c, u]
