"""Kernels of the conventional strapdown INS in the navigation frame n.

Vectors are tuples of three floats; `p` is ``Earth.parameters``. An update sees three sets of axes, each as if it did
not turn: 0 and 1 are n at its start and end, m is n half-way. The frame of n in e is four numbers: q_en itself with a
free azimuth; with a north azimuth cos and sin of (longitude + pi/2)/2 and of (pi/2 - latitude)/2.
"""

import math

import numpy as np

from bench.earth_kernels import gravitation
from bench.jit import njit
from bench.rotation_kernels import multiply, rotate
from bench.solvers.navigation._increment_kernels import BLOCK, block_integrals, cross

LARGEST_STEP = 1e-2  # rad of longitude an update: beyond, the series of its arc tangent is not at rounding
SMALLEST_COSINE = 1e-6  # of the latitude: 6 m from a pole; nearer, latitude and longitude lose digits


@njit
def small_turn(x, y, z):
    """Return exp(t/2) of t = (x, y, z), to rounding below 0.01 rad."""
    square = x * x + y * y + z * z
    s = 1 / 2 + square * (-1 / 48 + square * (1 / 3840))
    return 1.0 + square * (-1 / 8 + square * (1 / 384)), s * x, s * y, s * z


@njit
def axis(w, x, y, z):
    """Return the Earth's axis in n, (0, cos L, sin L) if n points north; q_en = (w, x, y, z)."""
    return 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)


@njit
def place(p, c, s, h):
    """Return gravity north and up, 1/(R_N + h), and b with 1/(R_M + h) = 1/(R_N + h) + b cos^2 L; c, s of the latitude.

    Gravity is gravitation and centrifugal acceleration: the same on every meridian.
    """
    return place_of_radius(p, c, s, h, p[0] / math.sqrt(1.0 - p[1] * s * s))


@njit
def place_of_radius(p, c, s, h, R_N):
    """Return `place` where R_N is known."""
    polar = R_N * (1.0 - p[1])
    rho = (R_N + h) * c
    out, _, z = gravitation(p, rho, 0.0, (polar + h) * s)
    out = out + p[3] * p[3] * rho
    across = 1.0 / (R_N + h)
    return c * z - s * out, c * out + s * z, across, across * R_N * p[1] / (polar + h * (1.0 - p[1] * s * s))


@njit
def turned_axis(north, kx, ky, kz, hx, hy, hz):
    """Return the Earth's axis in n after a small turn h of n: k - h x k + 1/2 h x (h x k)."""
    if north:  # of the latitude only
        c, s = 1.0 - 0.5 * hx * hx, hx * (1.0 - hx * hx * (1 / 6))
        return 0.0, ky * c + kz * s, kz * c - ky * s
    ax, ay, az = cross(hx, hy, hz, kx, ky, kz)
    bx, by, bz = cross(hx, hy, hz, ax, ay, az)
    return kx - (ax - 0.5 * bx), ky - (ay - 0.5 * by), kz - (az - 0.5 * bz)


@njit
def level_turn(north, across, b, kx, ky, kz, dx, dy):
    """Return the turn of n in e that goes with a small displacement (dx, dy) in n; (kx, ky, kz) is the Earth's axis.

    Free azimuth: about horizontal axes only. North: (-dL, cosL, sinL times dx / ((R_N + h) cosL)).
    """
    if north:
        longitude = dx * across / ky
        return -dy * (across + b * ky * ky), longitude * ky, longitude * kz
    along = b * (kx * dx + ky * dy)
    return -(across * dy + along * ky), across * dx + along * kx, 0.0


@njit
def attitude_of(north, f0, f1, f2, f3):
    """Return q_en of the frame: q_z o q_x of its half angles, or the frame itself."""
    if north:
        return f0 * f2, f0 * f3, f1 * f3, f1 * f2
    return f0, f1, f2, f3


@njit
def unit_frame(north, f0, f1, f2, f3):
    """Return the frame with its quaternion, or each of its two pairs, of norm 1 to rounding: a Newton step."""
    a, b = f0 * f0 + f1 * f1, f2 * f2 + f3 * f3
    a, b = (1.5 - 0.5 * a, 1.5 - 0.5 * b) if north else (1.5 - 0.5 * (a + b), 1.5 - 0.5 * (a + b))
    return a * f0, a * f1, b * f2, b * f3


@njit
def north_step(across, b, arm, f0, f1, f2, f3, cosine, sine, middle, earth, dx, dy, dz):
    """Return the frame after the displacement d in axes 0, the gain of height, the turn of n in i reversed, and dlon.

    ``dlon = atan(dx / (arm cosL - dy sinL + dz cosL))``, arm = R_N + h; what remains lies in the new meridian and is
    resolved in n half-way in latitude. arm, cosine and sine of the latitude are those at the start, `middle` is the
    cosine half-way. The turn is that of dlon and the Earth about its axis, then of -dL about east.
    """
    t = dx / (arm * cosine - sine * dy + cosine * dz)
    longitude, sag = t * (1.0 - t * t * (1 / 3)), 0.5 * dx * t
    dy, dz = dy - sine * sag, dz + cosine * sag
    curvature = across + b * middle * middle
    half = 0.5 * curvature * dy
    c = 1.0 - 0.5 * half * half
    latitude, lift = curvature * (c * dy - half * dz), c * dz + half * dy
    c, x, _, _ = small_turn(latitude, 0.0, 0.0)
    f2, f3 = f2 * c + f3 * x, f3 * c - f2 * x
    a, _, _, z = small_turn(0.0, 0.0, longitude)
    f0, f1 = f0 * a - f1 * z, f1 * a + f0 * z
    a, _, _, z = small_turn(0.0, 0.0, -(longitude + earth))
    y, z = z * cosine, z * sine
    return f0, f1, f2, f3, lift, c * a, x * a, c * y - x * z, c * z + x * y, longitude


@njit
def wander_step(across, b, f0, f1, f2, f3, kx, ky, kz, earth, hx, hy, dx, dy, dz):
    """Return the frame after the displacement d in axes 0, the gain of height, and the turn of n in i reversed.

    d is resolved in axes m, which h takes axes 0 to; (kx, ky, kz) is the Earth's axis there. The two turns of the
    product ``exp(h) exp(turn of the Earth) exp(h)`` are taken together.
    """
    wx, wy, wz = cross(hx, hy, 0.0, dx, dy, dz)
    yx, yy, yz = cross(hx, hy, 0.0, wx, wy, wz)
    dx, dy, dz = dx - (wx - 0.5 * yx), dy - (wy - 0.5 * yy), dz - (wz - 0.5 * yz)
    tx, ty, _ = level_turn(False, across, b, kx, ky, kz, dx, dy)
    w, x, y, z = small_turn(tx, ty, 0.0)
    f0, f1, f2, f3 = multiply(f0, f1, f2, f3, w, x, y, z)
    w, x, y, z = small_turn(-(tx + earth * kx), -(ty + earth * ky), -earth * kz)
    return f0, f1, f2, f3, dz, w, x, y, z


@njit
def update(p, T, scrolling, north, held, every, first, turn, count, carry, state):
    """Do `count` updates with the integrals `turn` of `block_integrals`; return how many succeeded.

    carry: q_nb (4), frame (4), v_n (3), height, gravity in n (3) and the two numbers of the curvature half-way through
    the last update, turn of n not compensated yet (4). Fills state (12, BLOCK) with q_en, q_nb, v_n, height. With a
    north azimuth it ends before an update that comes too close to a pole.
    """
    half, square, third, earth = 0.5 * T, 0.5 * T * T, 1 / 3, T * p[3]
    qw, qx, qy, qz = carry[0], carry[1], carry[2], carry[3]
    f0, f1, f2, f3 = carry[4], carry[5], carry[6], carry[7]
    vx, vy, vz, h = carry[8], carry[9], carry[10], carry[11]
    gx, gy, gz = carry[12], carry[13], carry[14]
    across, b = carry[15], carry[16]
    late = carry[17], carry[18], carry[19], carry[20]
    ew, ex, ey, ez = attitude_of(north, f0, f1, f2, f3)
    kx, ky, kz = axis(ew, ex, ey, ez)
    for u in range(count):
        # Integrals of the specific force in axes 0: velocity (u) and displacement (s).
        ux, uy, uz = rotate(qw, qx, qy, qz, turn[4, u], turn[5, u], turn[6, u])
        if scrolling:
            sx, sy, sz = rotate(qw, qx, qy, qz, T * turn[7, u], T * turn[8, u], T * turn[9, u])
        else:
            sx, sy, sz = half * ux, half * uy, half * uz

        # The place half-way: mean displacement with the last gravity, frame by the last curvature.
        mx = half * vx + third * (sx + square * gx)
        my = half * vy + third * (sy + square * gy)
        mz = half * vz + third * (sz + square * gz)
        if north and ky < SMALLEST_COSINE:
            return u
        hx, hy, hz = level_turn(north, across, b, kx, ky, kz, mx, my)
        ax, ay, az = kx, ky, kz
        # R_N half-way by a series from that at the start: a root and a division that nothing has to wait for.
        inverse = 1.0 / (1.0 - p[1] * az * az)
        R_N = p[0] * math.sqrt(inverse)
        kx, ky, kz = turned_axis(north, kx, ky, kz, hx, hy, hz)
        delta = p[1] * (kz - az) * (kz + az) * inverse
        R_m = R_N * (1.0 + delta * (0.5 + 0.375 * delta))
        middle = h if held else h + mz + 0.5 * (hy * mx - hx * my)
        if north:
            gx = 0.0
            gy, gz, across, b = place_of_radius(p, ky, kz, middle, R_m)
        else:
            cosine = math.sqrt(kx * kx + ky * ky)
            level, gz, across, b = place_of_radius(p, cosine, kz, middle, R_m)
            level = level / cosine if cosine > 0.0 else 0.0
            gx, gy = level * kx, level * ky

        # Gravity turns with n: its integral in axes 0 is T (g + t/2 x g + t/6 x (t x g)).
        zx, zy, zz = 2.0 * hx + earth * kx, 2.0 * hy + earth * ky, 2.0 * hz + earth * kz
        wx, wy, wz = cross(zx, zy, zz, gx, gy, gz)
        yx, yy, yz = cross(zx, zy, zz, wx, wy, wz)
        ux = ux + T * (gx + 0.5 * (wx + third * yx))
        uy = uy + T * (gy + 0.5 * (wy + third * yy))
        uz = uz + T * (gz + 0.5 * (wz + third * yz))
        if scrolling:
            sx = sx + square * (gx + third * wx)
            sy = sy + square * (gy + third * wy)
            sz = sz + square * (gz + third * wz)
        else:
            sx, sy, sz = half * ux, half * uy, half * uz
        # Coriolis: in axes that do not turn v' = f + g - omega_ie x v, and relative to e the way lags by as much again.
        jx, jy, jz = p[3] * ax, p[3] * ay, p[3] * az
        rx, ry, rz = T * vx + sx, T * vy + sy, T * vz + sz
        wx, wy, wz = cross(jx, jy, jz, mx, my, mz)
        wx, wy, wz = cross(jx, jy, jz, rx - T * wx, ry - T * wy, rz - T * wz)
        vx, vy, vz = vx + (ux - wx), vy + (uy - wy), vz + (uz - wz)
        rx, ry, rz = rx - T * wx, ry - T * wy, rz - T * wz

        # The frame at the end, and velocity and attitude in its axes.
        f0, f1, f2, f3 = unit_frame(north, f0, f1, f2, f3)
        if north:
            f0, f1, f2, f3, lift, w, x, y, z, step = north_step(
                across, b, R_N + h, f0, f1, f2, f3, ay, az, ky, earth, rx, ry, rz
            )
            if step < -LARGEST_STEP or step > LARGEST_STEP:  # not a number goes on, for the caller to find
                return u
        else:
            f0, f1, f2, f3, lift, w, x, y, z = wander_step(
                across, b, f0, f1, f2, f3, kx, ky, kz, earth, hx, hy, rx, ry, rz
            )
        ew, ex, ey, ez = attitude_of(north, f0, f1, f2, f3)
        vx, vy, vz = rotate(w, x, y, z, vx, vy, vz)
        if held:
            vz = 0.0
        else:
            h = h + lift
        scale = 1.5 - 0.5 * ((qw * qw + qx * qx) + (qy * qy + qz * qz))
        if every > 1:
            late = multiply(w, x, y, z, late[0], late[1], late[2], late[3])
            w, x, y, z = 1.0, 0.0, 0.0, 0.0
            if (first + u + 1) % every == 0:
                w, x, y, z = late
                late = (1.0, 0.0, 0.0, 0.0)
        w, x, y, z = multiply(w, x, y, z, scale * qw, scale * qx, scale * qy, scale * qz)
        qw, qx, qy, qz = multiply(w, x, y, z, turn[0, u], turn[1, u], turn[2, u], turn[3, u])

        kx, ky, kz = axis(ew, ex, ey, ez)
        state[0, u], state[1, u], state[2, u], state[3, u] = ew, ex, ey, ez
        state[4, u], state[5, u], state[6, u], state[7, u] = qw, qx, qy, qz
        state[8, u], state[9, u], state[10, u], state[11, u] = vx, vy, vz, h
    carry[0], carry[1], carry[2], carry[3] = qw, qx, qy, qz
    carry[4], carry[5], carry[6], carry[7] = f0, f1, f2, f3
    carry[8], carry[9], carry[10], carry[11] = vx, vy, vz, h
    carry[12], carry[13], carry[14] = gx, gy, gz
    carry[15], carry[16] = across, b
    carry[17], carry[18], carry[19], carry[20] = late
    return count


@njit
def to_earth(p, state, begin, count, out):
    """Fill rows of out (n, 10) from `begin` on with q_eb, v_e, r_e of the states."""
    found = np.empty((10, BLOCK))
    for u in range(count):
        w, x, y, z = state[0, u], state[1, u], state[2, u], state[3, u]
        qw, qx, qy, qz = state[4, u], state[5, u], state[6, u], state[7, u]
        found[0, u], found[1, u], found[2, u], found[3, u] = multiply(w, x, y, z, qw, qx, qy, qz)
        found[4, u], found[5, u], found[6, u] = rotate(w, x, y, z, state[8, u], state[9, u], state[10, u])
        s, h = 1.0 - 2.0 * (x * x + y * y), state[11, u]
        R_N = p[0] / math.sqrt(1.0 - p[1] * s * s)
        arm = 2.0 * (R_N + h)
        found[7, u], found[8, u] = arm * (x * z + w * y), arm * (y * z - w * x)
        found[9, u] = (R_N * (1.0 - p[1]) + h) * s
    for u in range(count):
        for c in range(10):
            out[begin + u, c] = found[c, u]


@njit
def navigate(p, S, a, L, T, exact, scrolling, north, held, every, d, first, carry, out):
    """Do len(out) updates of the N increments each in d (n, 6); return how many succeeded, see `update`."""
    turn, state = np.empty((10, BLOCK)), np.empty((12, BLOCK))
    for begin in range(0, out.shape[0], BLOCK):
        count = min(BLOCK, out.shape[0] - begin)
        block_integrals(S, a, L, exact, d, begin * S.shape[0], count, turn)
        done = update(p, T, scrolling, north, held, every, first + begin, turn, count, carry, state)
        if done < count:
            return begin + done
        to_earth(p, state, begin, count, out)
    return out.shape[0]
