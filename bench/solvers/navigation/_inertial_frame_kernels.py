"""Kernel of the inertial-frame algorithm: attitude by the rotation vector, thrust and gravitational velocity in i."""

from bench._compensated_kernels import two_sum
from bench.earth_kernels import gravitation
from bench.jit import njit
from bench.rotation_kernels import exponential, multiply, rotate
from bench.solvers.navigation._increment_kernels import body_integrals, rotation_terms
from bench.solvers.navigation._inertial_kernels import earth_fixed, earth_turn, held


@njit
def inertial_frame(p, T, fade, K, S, a, L, exact, scrolls, holds, increments, first, carry, out):
    """Do len(out) updates; p is `Earth.parameters`, K, S, a, L are those of `body_integrals`.

    fade: by how much the mean of G across the axis is smaller for turning with e, sin(omega_ie T/2)/(omega_ie T/2).
    carry: q_ib (4), v_t (3), v_g (3), r_i (3), what rounding took from r_i (3), the last G (3), the height held.
    """
    N, rate, twelfth = K.shape[0], p[3], T / 12.0
    w, x, y, z = carry[0], carry[1], carry[2], carry[3]
    tx, ty, tz, gx, gy, gz = carry[4], carry[5], carry[6], carry[7], carry[8], carry[9]
    rx, ry, rz, lx, ly, lz = carry[10], carry[11], carry[12], carry[13], carry[14], carry[15]
    Gx, Gy, Gz, height = carry[16], carry[17], carry[18], carry[19]
    for k in range(out.shape[0]):
        # The integral of f over the update, in its first axes, and the double integral over T.
        ax, ay, az, ux, uy, uz, sx, sy, sz = body_integrals(K, S, a, L, increments, N * k)
        if exact:
            bx, by, bz, cx, cy, cz = rotation_terms(ax, ay, az, ux, uy, uz)
            ux, uy, uz, sx, sy, sz = ux + bx, uy + by, uz + bz, sx + cx, sy + cy, sz + cz
        ux, uy, uz = rotate(w, x, y, z, ux, uy, uz)
        if scrolls:
            sx, sy, sz = rotate(w, x, y, z, sx, sy, sz)
        else:
            sx, sy, sz = 0.5 * ux, 0.5 * uy, 0.5 * uz
        bw, bx, by, bz = exponential(ax, ay, az)
        scale = 1.5 - 0.5 * ((w * w + x * x) + (y * y + z * z))  # a Newton step to 1/|q|
        w, x, y, z = multiply(w, x, y, z, bw, bx, by, bz)
        w, x, y, z = w * scale, x * scale, y * scale, z * scale
        # Gravitation half-way: the field is symmetric about the axis, the same function in i as in e.
        vx, vy, vz = tx + gx, ty + gy, tz + gz
        bx, by, bz = Gx, Gy, Gz
        Gx, Gy, Gz = gravitation(
            p,
            rx + 0.5 * T * (vx + 0.25 * (ux + T * Gx)),
            ry + 0.5 * T * (vy + 0.25 * (uy + T * Gy)),
            rz + 0.5 * T * (vz + 0.25 * (uz + T * Gz)),
        )
        Gx, Gy = fade * Gx, fade * Gy
        if scrolls:  # the change of G within the update, as from the last to this
            sx, sy, sz = sx - twelfth * (Gx - bx), sy - twelfth * (Gy - by), sz - twelfth * (Gz - bz)
        rx, lx = two_sum(rx, T * (vx + (sx + 0.5 * T * Gx)) + lx)
        ry, ly = two_sum(ry, T * (vy + (sy + 0.5 * T * Gy)) + ly)
        rz, lz = two_sum(rz, T * (vz + (sz + 0.5 * T * Gz)) + lz)
        tx, ty, tz = tx + ux, ty + uy, tz + uz
        gx, gy, gz = gx + T * Gx, gy + T * Gy, gz + T * Gz
        ch, sh = earth_turn(rate, (first + k + 1) * T)
        vx, vy, vz = tx + gx, ty + gy, tz + gz
        ew, ex, ey, ez, vx, vy, vz, px, py, pz = earth_fixed(ch, sh, rate, w, x, y, z, vx, vy, vz, rx, ry, rz)
        if holds:
            vx, vy, vz, px, py, pz, gx, gy, gz, rx, ry, rz = held(p, ch, sh, height, vx, vy, vz, px, py, pz)
            gx, gy, gz = gx - tx, gy - ty, gz - tz
            lx = ly = lz = 0.0
        row = out[k]
        row[0], row[1], row[2], row[3] = ew, ex, ey, ez
        row[4], row[5], row[6], row[7], row[8], row[9] = vx, vy, vz, px, py, pz
    carry[0], carry[1], carry[2], carry[3] = w, x, y, z
    carry[4], carry[5], carry[6], carry[7], carry[8], carry[9] = tx, ty, tz, gx, gy, gz
    carry[10], carry[11], carry[12], carry[13], carry[14], carry[15] = rx, ry, rz, lx, ly, lz
    carry[16], carry[17], carry[18] = Gx, Gy, Gz
