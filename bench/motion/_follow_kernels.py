"""Attitudes that follow a velocity, for numba: y along the velocity, x level, with rate and angular acceleration."""

import math

import numpy as np

from bench.earth_kernels import radii
from bench.jit import njit
from bench.rotation_kernels import multiply, normalize, rotate


@njit
def follow(velocity, acceleration, jerk, up, dup, ddup):
    """Return q, omega_b, alpha_b of the frame with y along the velocity and x across it and `up`; rows of each.

    up, dup, ddup (n, 3) are a vertical direction and its first two derivatives, in the frame of the velocity.
    """
    n = len(velocity)
    q, omega, alpha = np.empty((n, 4)), np.empty((n, 3)), np.empty((n, 3))
    for k in range(n):
        u, du, ddu = _row(up, k), _row(dup, k), _row(ddup, k)
        y, dy, ddy = _unit(_row(velocity, k), _row(acceleration, k), _row(jerk, k))
        across, bend = _cross(y, u), _add(_cross(dy, u), _cross(y, du))
        curl = _add(_add(_cross(ddy, u), _cross(y, ddu)), _add(_cross(dy, du), _cross(dy, du)))
        x, dx, ddx = _unit(across, bend, curl)
        z, dz = _cross(x, y), _add(_cross(dx, y), _cross(x, dy))
        # The columns of C' = C [omega x] are x' = C (0, w_z, -w_y) and y' = C (-w_z, 0, w_x).
        q[k, 0], q[k, 1], q[k, 2], q[k, 3] = _quaternion(x, y, z)
        omega[k, 0], omega[k, 1], omega[k, 2] = _dot(z, dy), -_dot(z, dx), _dot(y, dx)
        alpha[k, 0] = _dot(dz, dy) + _dot(z, ddy)
        alpha[k, 1] = -_dot(dz, dx) - _dot(z, ddx)
        alpha[k, 2] = _dot(dy, dx) + _dot(y, ddx)
    return q, omega, alpha


@njit
def vertical(p, L, lon, h, v_e, a_e):
    """Return the normal of the ellipsoid at geodetic positions and its first two derivatives, rows of each.

    With s = sinL, (R_N + h) N = r + e^2 R_N s z and (R_M + h) s' = v_z - s v.N; poles are ordinary points.
    """
    n = len(L)
    up, dup, ddup = np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 3))
    e2 = p[1]
    for k in range(n):
        v, a = _row(v_e, k), _row(a_e, k)
        R_M, R_N = radii(p, L[k])
        s, c = math.sin(L[k]), math.cos(L[k])
        w2 = 1.0 - e2 * s * s
        N = (c * math.cos(lon[k]), c * math.sin(lon[k]), s)
        climb = _dot(N, v)
        ds = (v[2] - s * climb) / (R_M + h[k])
        shift = e2 * R_N / w2 * ds  # of the foot of the normal on the axis
        dN = _unit_rate(N, R_N + h[k], (v[0], v[1], v[2] + shift))
        dR_M = 3.0 * R_M * e2 * s / w2 * ds
        dds = (a[2] - ds * climb - s * (_dot(dN, v) + _dot(N, a)) - ds * (dR_M + climb)) / (R_M + h[k])
        dshift = e2 * R_N / w2 * (3.0 * e2 * s / w2 * ds * ds + dds)
        _, dN, ddN = _unit_jet(N, R_N + h[k], (v[0], v[1], v[2] + shift), (a[0], a[1], a[2] + dshift))
        up[k, 0], up[k, 1], up[k, 2] = N
        dup[k, 0], dup[k, 1], dup[k, 2] = dN
        ddup[k, 0], ddup[k, 1], ddup[k, 2] = ddN
    return up, dup, ddup


@njit
def _row(rows, k):
    return rows[k, 0], rows[k, 1], rows[k, 2]


@njit
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit
def _cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit
def _add(a, b):
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@njit
def _unit_rate(u, length, dw):
    """Return u' of the unit vector u of w = length u."""
    stretch = _dot(u, dw)
    return (dw[0] - stretch * u[0]) / length, (dw[1] - stretch * u[1]) / length, (dw[2] - stretch * u[2]) / length


@njit
def _unit_jet(u, length, dw, ddw):
    """Return u, u', u'' of the unit vector u of w = length u: w'' = length'' u + 2 length' u' + length u''."""
    du = _unit_rate(u, length, dw)
    stretch = _dot(u, dw)
    change = _dot(u, ddw) + length * _dot(du, du)
    return (
        u,
        du,
        (
            (ddw[0] - change * u[0] - 2.0 * stretch * du[0]) / length,
            (ddw[1] - change * u[1] - 2.0 * stretch * du[1]) / length,
            (ddw[2] - change * u[2] - 2.0 * stretch * du[2]) / length,
        ),
    )


@njit
def _unit(w, dw, ddw):
    """Return w/|w| and its first two derivatives; NaN for w = 0, which has no direction."""
    length = math.sqrt(_dot(w, w))
    if length == 0.0:
        length = math.nan
    return _unit_jet((w[0] / length, w[1] / length, w[2] / length), length, dw, ddw)


@njit
def _quaternion(x, y, z):
    """Return the quaternion of the matrix with columns x, y, z; the largest component divides the others."""
    trace = x[0] + y[1] + z[2]
    if trace >= max(x[0], y[1], z[2]):
        q = (1.0 + trace, y[2] - z[1], z[0] - x[2], x[1] - y[0])
    elif x[0] >= max(y[1], z[2]):
        q = (y[2] - z[1], 1.0 + x[0] - y[1] - z[2], x[1] + y[0], z[0] + x[2])
    elif y[1] >= z[2]:
        q = (z[0] - x[2], x[1] + y[0], 1.0 + y[1] - x[0] - z[2], y[2] + z[1])
    else:
        q = (x[1] - y[0], z[0] + x[2], y[2] + z[1], 1.0 + z[2] - x[0] - y[1])
    return normalize(q[0], q[1], q[2], q[3])


@njit
def compose(q_ab, omega_ab_b, alpha_ab_b, q_bc, omega_bc_c, alpha_bc_c):
    """Return q_ac, omega_ac_c, alpha_ac_c of two motions after one another, rows of each."""
    n = len(q_ab)
    q, omega, alpha = np.empty((n, 4)), np.empty((n, 3)), np.empty((n, 3))
    for k in range(n):
        w, x, y, z = q_bc[k, 0], -q_bc[k, 1], -q_bc[k, 2], -q_bc[k, 3]
        turn, own = rotate(w, x, y, z, *_row(omega_ab_b, k)), _row(omega_bc_c, k)
        change, bend = rotate(w, x, y, z, *_row(alpha_ab_b, k)), _cross(own, turn)
        q[k, 0], q[k, 1], q[k, 2], q[k, 3] = normalize(
            *multiply(q_ab[k, 0], q_ab[k, 1], q_ab[k, 2], q_ab[k, 3], w, -x, -y, -z)
        )
        for i in range(3):
            omega[k, i] = turn[i] + own[i]
            alpha[k, i] = change[i] - bend[i] + alpha_bc_c[k, i]
    return q, omega, alpha
