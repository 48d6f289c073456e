"""Kinematics on the rotating Earth for numba: geodetic to Earth-fixed to inertial, one pass over the samples."""

import math

import numpy as np

from bench.earth_kernels import radii
from bench.jit import njit
from bench.rotation_kernels import multiply, normalize, rotate


@njit
def inertial(rate, q_ie, q_eb, omega_eb_b, alpha_eb_b, r_e, v_e, a_e, G_e):
    """Return position, velocity, acceleration, q_ib, omega_ib_b, alpha_ib_b and gravitation in i, rows of each.

    v_i = v + w x r, a_i = a + 2 w x v + w x (w x r) with w = omega_ie, all in e and then turned to i.
    """
    n = len(r_e)
    position, velocity, acceleration, gravity = np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 3))
    q_ib, omega_ib_b, alpha_ib_b = np.empty((n, 4)), np.empty((n, 3)), np.empty((n, 3))
    for k in range(n):
        qw, qx, qy, qz = q_ie[k, 0], q_ie[k, 1], q_ie[k, 2], q_ie[k, 3]
        x, y, z = r_e[k, 0], r_e[k, 1], r_e[k, 2]
        vx, vy, vz = v_e[k, 0], v_e[k, 1], v_e[k, 2]
        ax = a_e[k, 0] - 2.0 * rate * vy - rate * rate * x
        ay = a_e[k, 1] + 2.0 * rate * vx - rate * rate * y
        position[k, 0], position[k, 1], position[k, 2] = rotate(qw, qx, qy, qz, x, y, z)
        velocity[k, 0], velocity[k, 1], velocity[k, 2] = rotate(qw, qx, qy, qz, vx - rate * y, vy + rate * x, vz)
        acceleration[k, 0], acceleration[k, 1], acceleration[k, 2] = rotate(qw, qx, qy, qz, ax, ay, a_e[k, 2])
        gravity[k, 0], gravity[k, 1], gravity[k, 2] = rotate(qw, qx, qy, qz, G_e[k, 0], G_e[k, 1], G_e[k, 2])

        bw, bx, by, bz = q_eb[k, 0], q_eb[k, 1], q_eb[k, 2], q_eb[k, 3]
        q_ib[k, 0], q_ib[k, 1], q_ib[k, 2], q_ib[k, 3] = normalize(*multiply(qw, qx, qy, qz, bw, bx, by, bz))
        ex, ey, ez = rotate(bw, -bx, -by, -bz, 0.0, 0.0, rate)
        wx, wy, wz = omega_eb_b[k, 0], omega_eb_b[k, 1], omega_eb_b[k, 2]
        omega_ib_b[k, 0], omega_ib_b[k, 1], omega_ib_b[k, 2] = wx + ex, wy + ey, wz + ez
        alpha_ib_b[k, 0] = alpha_eb_b[k, 0] - (wy * ez - wz * ey)
        alpha_ib_b[k, 1] = alpha_eb_b[k, 1] - (wz * ex - wx * ez)
        alpha_ib_b[k, 2] = alpha_eb_b[k, 2] - (wx * ey - wy * ex)
    return position, velocity, acceleration, q_ib, omega_ib_b, alpha_ib_b, gravity


@njit
def from_geodetic(p, path, q_nb, omega_nb_b, alpha_nb_b):
    """Return v_e, a_e, q_eb, omega_eb_b, alpha_eb_b; path (n, 9) holds L, L', L'', lon, .., h, h', h''.

    v_n = [(R_N + h) cosL lon', (R_M + h) L', h'].
    """
    out = _outputs(len(path))
    for k in range(len(path)):
        L, dL, ddL, lon, dlon, ddlon, h, dh, ddh = path[k]
        s, c = math.sin(L), math.cos(L)
        arm, darm, north, dnorth = _arms(p, L, s, c, h, dL, dh)
        v = (arm * dlon, north * dL, dh)
        dv = (darm * dlon + arm * ddlon, dnorth * dL + north * ddL, ddh)
        turn = (-dL, dlon * c, dlon * s)
        dturn = (-ddL, ddlon * c - dlon * s * dL, ddlon * s + dlon * c * dL)
        _assemble(k, L, lon, v, dv, turn, dturn, q_nb, omega_nb_b, alpha_nb_b, out)
    return out


@njit
def from_velocity(p, place, v_n, dv_n, q_nb, omega_nb_b, alpha_nb_b):
    """Return v_e, a_e, q_eb, omega_eb_b, alpha_eb_b; place (n, 3) holds L, lon, h; v_n east, north, up.

    L' = v_N / (R_M + h), lon' = v_E / ((R_N + h) cosL).
    """
    out = _outputs(len(place))
    for k in range(len(place)):
        L, lon, h = place[k]
        s, c = math.sin(L), math.cos(L)
        v = (v_n[k, 0], v_n[k, 1], v_n[k, 2])
        dv = (dv_n[k, 0], dv_n[k, 1], dv_n[k, 2])
        R_M, R_N = radii(p, L)
        dL, dlon = v[1] / (R_M + h), v[0] / ((R_N + h) * c)
        arm, darm, north, dnorth = _arms(p, L, s, c, h, dL, v[2])
        ddL, ddlon = (dv[1] - dnorth * dL) / north, (dv[0] - darm * dlon) / arm
        turn = (-dL, dlon * c, dlon * s)
        dturn = (-ddL, ddlon * c - dlon * s * dL, ddlon * s + dlon * c * dL)
        _assemble(k, L, lon, v, dv, turn, dturn, q_nb, omega_nb_b, alpha_nb_b, out)
    return out


@njit
def _outputs(n):
    return np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 4)), np.empty((n, 3)), np.empty((n, 3))


@njit
def _arms(p, L, s, c, h, dL, dh):
    """Return (R_N + h) cosL and R_M + h, each with its derivative in time.

    d(R_N cosL)/dL = -R_M sinL, and dR_M/dL = 3 R_M e^2 sinL cosL / (1 - e^2 sin^2 L).
    """
    R_M, R_N = radii(p, L)
    dR_M = 3.0 * R_M * p[1] * s * c / (1.0 - p[1] * s * s) * dL
    return (R_N + h) * c, -(R_M + h) * s * dL + dh * c, R_M + h, dR_M + dh


@njit
def _assemble(k, L, lon, v, dv, turn, dturn, q_nb, omega_nb_b, alpha_nb_b, out):
    """Fill row k: a_n = v_n' + omega_en x v_n, q_eb = q_en o q_nb, omega_eb = omega_nb + omega_en."""
    v_e, a_e, q_eb, omega_eb_b, alpha_eb_b = out
    cz, sz = math.cos(0.5 * lon + math.pi / 4), math.sin(0.5 * lon + math.pi / 4)
    cx, sx = math.cos(math.pi / 4 - 0.5 * L), math.sin(math.pi / 4 - 0.5 * L)
    w, x, y, z = cz * cx, cz * sx, sz * sx, sz * cx  # q_en
    bw, bx, by, bz = q_nb[k, 0], q_nb[k, 1], q_nb[k, 2], q_nb[k, 3]
    ox, oy, oz = omega_nb_b[k, 0], omega_nb_b[k, 1], omega_nb_b[k, 2]
    ax = dv[0] + turn[1] * v[2] - turn[2] * v[1]
    ay = dv[1] + turn[2] * v[0] - turn[0] * v[2]
    az = dv[2] + turn[0] * v[1] - turn[1] * v[0]
    ex, ey, ez = rotate(bw, -bx, -by, -bz, turn[0], turn[1], turn[2])
    dx, dy, dz = rotate(bw, -bx, -by, -bz, dturn[0], dturn[1], dturn[2])
    v_e[k, 0], v_e[k, 1], v_e[k, 2] = rotate(w, x, y, z, v[0], v[1], v[2])
    a_e[k, 0], a_e[k, 1], a_e[k, 2] = rotate(w, x, y, z, ax, ay, az)
    q_eb[k, 0], q_eb[k, 1], q_eb[k, 2], q_eb[k, 3] = normalize(*multiply(w, x, y, z, bw, bx, by, bz))
    omega_eb_b[k, 0], omega_eb_b[k, 1], omega_eb_b[k, 2] = ox + ex, oy + ey, oz + ez
    alpha_eb_b[k, 0] = alpha_nb_b[k, 0] + dx - (oy * ez - oz * ey)
    alpha_eb_b[k, 1] = alpha_nb_b[k, 1] + dy - (oz * ex - ox * ez)
    alpha_eb_b[k, 2] = alpha_nb_b[k, 2] + dz - (ox * ey - oy * ex)
