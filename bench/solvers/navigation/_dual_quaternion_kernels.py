"""Kernels of dual quaternions, and of the strapdown algorithm in them.

A dual quaternion is eight numbers: the real quaternion q (wxyz) and the dual q_d. For the attitude q and a vector v in
the outer frame q_d = 1/2 v o q.
"""

import math

from bench._compensated_kernels import two_sum
from bench.earth_kernels import gravitation
from bench.jit import njit
from bench.rotation_kernels import multiply, rotate
from bench.solvers.navigation._increment_kernels import body_integrals, rotation_terms
from bench.solvers.navigation._inertial_kernels import earth_fixed, earth_turn, held


@njit
def dual_exponential(x, y, z, ux, uy, uz):
    """Return exp of half the screw s + eps u: real (cos(s/2), a s), dual (-a p/2, a u + b p s), p = s . u."""
    square, p = x * x + y * y + z * z, x * ux + y * uy + z * uz
    if square < 0.04:  # the series are at rounding and do not cancel
        c = 1.0 + square * (-1 / 8 + square * (1 / 384 + square * (-1 / 46080 + square * (1 / 10321920))))
        a = 0.5 + square * (-1 / 48 + square * (1 / 3840 + square * (-1 / 645120 + square * (1 / 185794560))))
        b = -1 / 24 + square * (1 / 960 + square * (-1 / 107520 + square * (1 / 23224320)))
    else:
        s = math.sqrt(square)
        c, a = math.cos(0.5 * s), math.sin(0.5 * s) / s
        b = (0.5 * c - a) / square
    bp = b * p
    return c, a * x, a * y, a * z, -0.5 * a * p, a * ux + bp * x, a * uy + bp * y, a * uz + bp * z


@njit
def dual_part(pw, px, py, pz, mw, mx, my, mz, qw, qx, qy, qz, nw, nx, ny, nz):
    """Return the dual part of (p + eps m) o (q + eps n): p o n + m o q."""
    aw, ax, ay, az = multiply(pw, px, py, pz, nw, nx, ny, nz)
    bw, bx, by, bz = multiply(mw, mx, my, mz, qw, qx, qy, qz)
    return aw + bw, ax + bx, ay + by, az + bz


@njit
def translation(w, x, y, z, dw, dx, dy, dz):
    """Return v = 2 q_d o q*."""
    return (
        2.0 * (w * dx - x * dw + (dz * y - dy * z)),
        2.0 * (w * dy - y * dw + (dx * z - dz * x)),
        2.0 * (w * dz - z * dw + (dy * x - dx * y)),
    )


@njit
def unit(w, x, y, z, dw, dx, dy, dz):
    """Return a dual quaternion that is unit to nearly rounding made unit: |q| = 1 and q . q_d = 0."""
    scale = 1.5 - 0.5 * ((w * w + x * x) + (y * y + z * z))  # a Newton step to 1/|q|
    w, x, y, z = w * scale, x * scale, y * scale, z * scale
    dw, dx, dy, dz = dw * scale, dx * scale, dy * scale, dz * scale
    along = (w * dw + x * dx) + (y * dy + z * dz)
    return w, x, y, z, dw - along * w, dx - along * x, dy - along * y, dz - along * z


@njit
def dual_quaternion(p, T, quarter, K, S, a, L, scrolls, holds, increments, first, carry, out):
    """Do len(out) updates; p is `Earth.parameters`, K, S, a, L are those of `body_integrals`.

    quarter: cos and sin of omega_ie T/4. carry: q_ib (4), its dual part (4), the dual part (4) of the gravitational
    velocity frame, whose real part q_ie follows from the time, r_i (3), what rounding took from r_i (3), the last
    change of v_g (3), the height held.
    """
    N, rate, twelfth = K.shape[0], p[3], 1 / 12
    w, x, y, z, dw, dx, dy, dz = carry[0], carry[1], carry[2], carry[3], carry[4], carry[5], carry[6], carry[7]
    gw, gx, gy, gz = carry[8], carry[9], carry[10], carry[11]
    rx, ry, rz, lx, ly, lz = carry[12], carry[13], carry[14], carry[15], carry[16], carry[17]
    ix, iy, iz, height = carry[18], carry[19], carry[20], carry[21]
    ch, sh = earth_turn(rate, first * T)
    tx, ty, tz = translation(w, x, y, z, dw, dx, dy, dz)
    hx, hy, hz = translation(ch, 0.0, 0.0, sh, gw, gx, gy, gz)
    for k in range(out.shape[0]):
        vx, vy, vz = tx + hx, ty + hy, tz + hz
        # The screw of the body, its twist omega_ib + eps f.
        ax, ay, az, ux, uy, uz, sx, sy, sz = body_integrals(K, S, a, L, increments, N * k)
        if scrolls:
            _, _, _, bx, by, bz = rotation_terms(ax, ay, az, ux, uy, uz)
            sx, sy, sz = rotate(w, x, y, z, sx + bx, sy + by, sz + bz)
        cw, cx, cy, cz, ew, ex, ey, ez = dual_exponential(ax, ay, az, ux, uy, uz)
        dw, dx, dy, dz = dual_part(w, x, y, z, dw, dx, dy, dz, cw, cx, cy, cz, ew, ex, ey, ez)
        w, x, y, z = multiply(w, x, y, z, cw, cx, cy, cz)
        w, x, y, z, dw, dx, dy, dz = unit(w, x, y, z, dw, dx, dy, dz)
        ux, uy, uz = tx, ty, tz
        tx, ty, tz = translation(w, x, y, z, dw, dx, dy, dz)
        ux, uy, uz = tx - ux, ty - uy, tz - uz
        if not scrolls:
            sx, sy, sz = 0.5 * ux, 0.5 * uy, 0.5 * uz
        # That of the frame parallel to e, its twist omega_ie + eps G_e half-way.
        mx = rx + 0.5 * T * (vx + 0.25 * (ux + ix))
        my = ry + 0.5 * T * (vy + 0.25 * (uy + iy))
        mz = rz + 0.5 * T * (vz + 0.25 * (uz + iz))
        cm, sm = ch * quarter[0] - sh * quarter[1], sh * quarter[0] + ch * quarter[1]
        c, s = cm * cm - sm * sm, 2.0 * cm * sm
        Gx, Gy, Gz = gravitation(p, c * mx + s * my, c * my - s * mx, mz)
        cw, cx, cy, cz, ew, ex, ey, ez = dual_exponential(0.0, 0.0, rate * T, T * Gx, T * Gy, T * Gz)
        gw, gx, gy, gz = dual_part(ch, 0.0, 0.0, sh, gw, gx, gy, gz, cw, cx, cy, cz, ew, ex, ey, ez)
        ch, sh = earth_turn(rate, (first + k + 1) * T)
        along = ch * gw + sh * gz
        gw, gz = gw - along * ch, gz - along * sh
        bx, by, bz = ix, iy, iz
        ix, iy, iz = hx, hy, hz
        hx, hy, hz = translation(ch, 0.0, 0.0, sh, gw, gx, gy, gz)
        ix, iy, iz = hx - ix, hy - iy, hz - iz
        if scrolls:  # the change of G within the update, as from the last to this
            sx, sy, sz = sx - twelfth * (ix - bx), sy - twelfth * (iy - by), sz - twelfth * (iz - bz)
        rx, lx = two_sum(rx, T * (vx + (sx + 0.5 * ix)) + lx)
        ry, ly = two_sum(ry, T * (vy + (sy + 0.5 * iy)) + ly)
        rz, lz = two_sum(rz, T * (vz + (sz + 0.5 * iz)) + lz)
        vx, vy, vz = tx + hx, ty + hy, tz + hz
        ew, ex, ey, ez, vx, vy, vz, px, py, pz = earth_fixed(ch, sh, rate, w, x, y, z, vx, vy, vz, rx, ry, rz)
        if holds:
            vx, vy, vz, px, py, pz, hx, hy, hz, rx, ry, rz = held(p, ch, sh, height, vx, vy, vz, px, py, pz)
            gw, gx, gy, gz = multiply(0.0, 0.5 * (hx - tx), 0.5 * (hy - ty), 0.5 * (hz - tz), ch, 0.0, 0.0, sh)
            hx, hy, hz = translation(ch, 0.0, 0.0, sh, gw, gx, gy, gz)
            lx = ly = lz = 0.0
        row = out[k]
        row[0], row[1], row[2], row[3] = ew, ex, ey, ez
        row[4], row[5], row[6], row[7], row[8], row[9] = vx, vy, vz, px, py, pz
    carry[0], carry[1], carry[2], carry[3], carry[4], carry[5], carry[6], carry[7] = w, x, y, z, dw, dx, dy, dz
    carry[8], carry[9], carry[10], carry[11] = gw, gx, gy, gz
    carry[12], carry[13], carry[14], carry[15], carry[16], carry[17] = rx, ry, rz, lx, ly, lz
    carry[18], carry[19], carry[20] = ix, iy, iz
