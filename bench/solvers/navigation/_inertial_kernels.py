"""Kernels that the algorithms working in the inertial frame share: the turn of the Earth, and a held height."""

import math

from bench.earth_kernels import geodetic
from bench.jit import njit


@njit
def earth_turn(rate, t):
    """Return cos and sin of omega_ie t/2: q_ie = (cos, 0, 0, sin)."""
    half = 0.5 * rate * t
    return math.cos(half), math.sin(half)


@njit
def earth_fixed(ch, sh, rate, w, x, y, z, vx, vy, vz, rx, ry, rz):
    """Return q_eb, v_e, r_e, 10 numbers, of q_ib, v_i, r_i; q_ie = (ch, 0, 0, sh)."""
    c, s = ch * ch - sh * sh, 2.0 * ch * sh
    px, py = c * rx + s * ry, c * ry - s * rx
    return (
        ch * w + sh * z,
        ch * x + sh * y,
        ch * y - sh * x,
        ch * z - sh * w,
        c * vx + s * vy + rate * py,
        c * vy - s * vx - rate * px,
        vz,
        px,
        py,
        rz,
    )


@njit
def held(p, ch, sh, height, vx, vy, vz, px, py, pz):
    """Return v_e without its upward part, r_e moved along the normal to a geodetic height, and v_i, r_i of the two."""
    latitude, longitude, now = geodetic(p, px, py, pz)
    c, ez = math.cos(latitude), math.sin(latitude)
    ex, ey = c * math.cos(longitude), c * math.sin(longitude)
    up, lift = ex * vx + ey * vy + ez * vz, height - now
    vx, vy, vz = vx - up * ex, vy - up * ey, vz - up * ez
    px, py, pz = px + lift * ex, py + lift * ey, pz + lift * ez
    c, s = ch * ch - sh * sh, 2.0 * ch * sh
    ax, ay = vx - p[3] * py, vy + p[3] * px
    return vx, vy, vz, px, py, pz, c * ax - s * ay, s * ax + c * ay, vz, c * px - s * py, s * px + c * py, pz
