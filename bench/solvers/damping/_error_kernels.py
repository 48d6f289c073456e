"""Kernels of the error model: F of one step, its transition forwards and backwards, and the propagation of P.

The first seven rows (dv, dL, dlambda, phi) are full in 13 columns; all further states decay by themselves, so that
only those rows are stored. See ``bench.solvers.damping.error_model``.
"""

import math

import numpy as np

from bench.earth_kernels import radii
from bench.jit import njit

ROWS = 7
COLUMNS = 13
ORDER = 4


@njit
def matrix(q, C):
    """Add C_nb of a quaternion to C (3, 3)."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    C[0, 0] += 1.0 - 2.0 * (y * y + z * z)
    C[0, 1] += 2.0 * (x * y - w * z)
    C[0, 2] += 2.0 * (x * z + w * y)
    C[1, 0] += 2.0 * (x * y + w * z)
    C[1, 1] += 1.0 - 2.0 * (x * x + z * z)
    C[1, 2] += 2.0 * (y * z - w * x)
    C[2, 0] += 2.0 * (x * z - w * y)
    C[2, 1] += 2.0 * (y * z + w * x)
    C[2, 2] += 1.0 - 2.0 * (x * x + y * y)


@njit
def fill(p, deflection, v_E, v_N, L, f_E, f_N, f_U, C, F):
    """Fill the rows (7, 13) of F; p is ``Earth.parameters``."""
    R_M, R_N = radii(p, L)
    sine, cosine = math.sin(L), math.cos(L)
    sec = 1.0 / cosine
    tan = sine * sec
    earth_N, earth_U = p[3] * cosine, p[3] * sine
    transport = v_E / R_N
    omega_E, omega_N, omega_U = -v_N / R_M, earth_N + transport, earth_U + transport * tan
    slope = transport * sec * sec
    for i in range(F.shape[0]):
        for j in range(F.shape[1]):
            F[i, j] = 0.0
    F[0, 0] = v_N * tan / R_N
    F[0, 1] = earth_U + omega_U
    F[0, 2] = v_N * (2.0 * earth_N + slope)
    F[1, 0] = -2.0 * omega_U
    F[1, 2] = -v_E * (2.0 * earth_N + slope) + deflection * (cosine * cosine - sine * sine)
    F[0, 5], F[0, 6] = -f_U, f_N
    F[1, 4], F[1, 6] = f_U, -f_E
    F[2, 1] = 1.0 / R_M
    F[3, 0] = sec / R_N
    F[3, 2] = transport * sec * tan
    F[4, 1] = -1.0 / R_M
    F[5, 0] = 1.0 / R_N
    F[5, 2] = -earth_U
    F[6, 0] = tan / R_N
    F[6, 2] = earth_N + slope
    F[4, 5], F[4, 6] = omega_U, -omega_N
    F[5, 4], F[5, 6] = -omega_U, omega_E
    F[6, 4], F[6, 5] = omega_N, -omega_E
    for i in range(3):
        for j in range(3):
            if i < 2:
                F[i, 7 + j] = C[i, j]
            F[4 + i, 10 + j] = C[i, j]


@njit
def step_matrix(p, deflection, here, there, f_n, F):
    """Fill the rows of F with its mean over a step; here and there (7,) are v_E, v_N, L, q_nb at its ends."""
    C = np.zeros((3, 3))
    matrix(here[3:], C)
    matrix(there[3:], C)
    for i in range(3):
        for j in range(3):
            C[i, j] *= 0.5
    v_E, v_N, L = 0.5 * (here[0] + there[0]), 0.5 * (here[1] + there[1]), 0.5 * (here[2] + there[2])
    fill(p, deflection, v_E, v_N, L, f_n[0], f_n[1], f_n[2], C, F)


@njit
def transition(F, rate, dt, term, forth, half, back):
    """Fill the rows (7, 13) of exp(F dt), exp(F dt/2), exp(-F dt) by their series to order ORDER.

    rate (n,) holds 1/tau of the states beyond the rows; term (2, 7, 13) is scratch.
    """
    rows, columns = F.shape  # not the constants, whose loops the compiler would unroll for many seconds
    for i in range(rows):
        for j in range(columns):
            one = 1.0 if i == j else 0.0
            forth[i, j], half[i, j], back[i, j] = one, one, one
            term[0, i, j] = F[i, j] * dt
    shrink, sign = 0.5, -1.0
    for order in range(1, ORDER + 1):
        old, new = term[(order - 1) % 2], term[order % 2]
        for i in range(rows):
            for j in range(columns):
                forth[i, j] += old[i, j]
                half[i, j] += shrink * old[i, j]
                back[i, j] += sign * old[i, j]
        if order < ORDER:
            scale = dt / (order + 1.0)
            for i in range(rows):
                for j in range(rows):
                    new[i, j] = 0.0
                for j in range(rows, columns):
                    new[i, j] = -old[i, j] * rate[j] * scale
                for k in range(rows):
                    factor = old[i, k] * scale
                    for j in range(columns):
                        new[i, j] += factor * F[k, j]
        shrink *= 0.5
        sign = -sign


@njit
def predict(x, P, forth, half, decay, half_decay, q, dt, M, y):
    """Take the estimate x (n,) and its covariance P (n, n) over a step, in place; M (7, n) and y (n,) are scratch.

    decay and half_decay (n,) are exp(-dt/tau) and its root for the states beyond the rows; q (n,) is the density of
    the noise.
    """
    n = x.shape[0]
    rows, columns = forth.shape
    sixth = dt / 6.0
    for i in range(n):
        P[i, i] += sixth * q[i]
    for i in range(rows):
        total = 0.0
        for j in range(n):
            M[i, j] = 0.0
        for k in range(columns):
            factor = forth[i, k]
            total += factor * x[k]
            for j in range(n):
                M[i, j] += factor * P[k, j]
        y[i] = total
    for i in range(n):
        x[i] = y[i] if i < rows else x[i] * decay[i]
    for i in range(rows):
        for j in range(i + 1):
            total, noise = 0.0, 0.0
            for k in range(columns):
                total += M[i, k] * forth[j, k]
                noise += half[i, k] * half[j, k] * q[k]
            P[i, j] = total + 4.0 * sixth * noise
            P[j, i] = P[i, j]
        P[i, i] += sixth * q[i]
        for j in range(rows, n):
            value = M[i, j] * decay[j]
            if j < columns:
                value += 4.0 * sixth * half[i, j] * q[j] * half_decay[j]
            P[i, j] = value
            P[j, i] = value
    for i in range(rows, n):
        for j in range(rows, i + 1):
            P[i, j] *= decay[i] * decay[j]
            P[j, i] = P[i, j]
        P[i, i] += sixth * q[i] * (1.0 + 4.0 * half_decay[i] * half_decay[i])


@njit
def turn_back(r, back, growth, scratch):
    """Multiply the rows r (2, 13) from the right by exp(-F dt); growth (n,) is exp(dt/tau)."""
    rows, columns = back.shape
    for a in range(2):
        for j in range(columns):
            scratch[j] = r[a, j] * growth[j] if j >= rows else 0.0
        for k in range(rows):
            factor = r[a, k]
            for j in range(columns):
                scratch[j] += factor * back[k, j]
        for j in range(columns):
            r[a, j] = scratch[j]
