"""Kernel of the first-order quaternion INS: one sample an update, an attitude quaternion that may lose its norm."""

import math

from bench.jit import njit
from bench.rotation_kernels import multiply, rotate
from bench.solvers.navigation._increment_kernels import cross
from bench.solvers.navigation._navigation_frame_kernels import place


@njit
def scaled_rotation(w, x, y, z, vx, vy, vz):
    """Return q o v o q*, which is |q|^2 times the rotated vector."""
    a, b, c, d = multiply(w, x, y, z, 0.0, vx, vy, vz)
    _, rx, ry, rz = multiply(a, b, c, d, w, -x, -y, -z)
    return rx, ry, rz


@njit
def to_earth(p, qw, qx, qy, qz, vx, vy, vz, L, longitude, h, out, u):
    """Fill row u of out with q_eb (unit), v_e, r_e."""
    turn, tilt = 0.5 * longitude + 0.25 * math.pi, 0.25 * math.pi - 0.5 * L
    cz, sz, cx, sx = math.cos(turn), math.sin(turn), math.cos(tilt), math.sin(tilt)
    ew, ex, ey, ez = cz * cx, cz * sx, sz * sx, sz * cx
    scale = 1.0 / math.sqrt((qw * qw + qx * qx) + (qy * qy + qz * qz))
    out[u, 0], out[u, 1], out[u, 2], out[u, 3] = multiply(
        ew, ex, ey, ez, scale * qw, scale * qx, scale * qy, scale * qz
    )
    out[u, 4], out[u, 5], out[u, 6] = rotate(ew, ex, ey, ez, vx, vy, vz)
    c, s = math.cos(L), math.sin(L)
    R_N = p[0] / math.sqrt(1.0 - p[1] * s * s)
    out[u, 7], out[u, 8] = (R_N + h) * c * math.cos(longitude), (R_N + h) * c * math.sin(longitude)
    out[u, 9] = (R_N * (1.0 - p[1]) + h) * s


@njit
def navigate(p, T, moment, normalised, held, d, carry, out):
    """Do len(out) updates with the increments d (n, 6); carry: q_nb (4), v_n (3), latitude, longitude, height.

    moment: -1, 0 or 1 for velocity increments resolved with the attitude at the start, half-way or at the end.
    """
    qw, qx, qy, qz = carry[0], carry[1], carry[2], carry[3]
    vx, vy, vz = carry[4], carry[5], carry[6]
    L, longitude, h = carry[7], carry[8], carry[9]
    for u in range(len(out)):
        c, s = math.cos(L), math.sin(L)
        gy, gz, across, bend = place(p, c, s, h)
        along = across + bend * c * c
        ey, ez = p[3] * c, p[3] * s  # omega_ie in n
        nx, ny, nz = -vy * along, vx * across, vx * across * s / c  # omega_en in n
        tx, ty, tz = d[u, 0], d[u, 1], d[u, 2]
        ax, ay, az = d[u, 3], d[u, 4], d[u, 5]
        if moment == 0:
            wx, wy, wz = cross(tx, ty, tz, ax, ay, az)
            ax, ay, az = ax + 0.5 * wx, ay + 0.5 * wy, az + 0.5 * wz
        ow, ox, oy, oz = qw, qx, qy, qz
        bw, bx, by, bz = multiply(qw, qx, qy, qz, 0.0, 0.5 * tx, 0.5 * ty, 0.5 * tz)
        half = 0.5 * T
        cw, cx, cy, cz = multiply(0.0, half * nx, half * (ey + ny), half * (ez + nz), qw, qx, qy, qz)
        qw, qx, qy, qz = qw + (bw - cw), qx + (bx - cx), qy + (by - cy), qz + (bz - cz)
        if normalised:
            scale = 1.0 / math.sqrt((qw * qw + qx * qx) + (qy * qy + qz * qz))
            qw, qx, qy, qz = scale * qw, scale * qx, scale * qy, scale * qz
        if moment > 0:
            ow, ox, oy, oz = qw, qx, qy, qz
        ux, uy, uz = scaled_rotation(ow, ox, oy, oz, ax, ay, az)
        wx, wy, wz = cross(nx, 2.0 * ey + ny, 2.0 * ez + nz, vx, vy, vz)
        fx, fy, fz = vx + (ux - T * wx), vy + (uy + T * (gy - wy)), vz + (uz + T * (gz - wz))
        if held:
            fz = 0.0
        L, longitude = L + half * (vy + fy) * along, longitude + half * (vx + fx) * across / c
        h = h + half * (vz + fz)
        vx, vy, vz = fx, fy, fz
        to_earth(p, qw, qx, qy, qz, vx, vy, vz, L, longitude, h, out, u)
    carry[0], carry[1], carry[2], carry[3] = qw, qx, qy, qz
    carry[4], carry[5], carry[6] = vx, vy, vz
    carry[7], carry[8], carry[9] = L, longitude, h
