"""Kernel of the error simulation: errors of many trials along one path."""

import math

import numpy as np

from bench.jit import njit
from bench.solvers.damping._error_kernels import COLUMNS, ROWS, matrix, step_matrix, transition


@njit
def halfway(row, x, out):
    """Fill out (7,) with v_E, v_N, L, q_nb half-way between truth and an INS with errors x."""
    for i in range(3):
        out[i] = row[i] + 0.5 * x[i]
    # exp(-phi/2) C_nb, to second order
    a, b, c = -0.25 * x[4], -0.25 * x[5], -0.25 * x[6]
    w, u, v, s = row[3], row[4], row[5], row[6]
    scale = 1.0 / math.sqrt(1.0 + a * a + b * b + c * c)
    out[3] = (w - a * u - b * v - c * s) * scale
    out[4] = (u + a * w + b * s - c * v) * scale
    out[5] = (v - a * s + b * w + c * u) * scale
    out[6] = (s + a * v - b * u + c * w) * scale


@njit
def propagate(p, deflection, dt, rows, f_n, rate, shares, gain, normals, x, out):
    """Take the errors x (trials, 13) along the steps of rows (m + 1, 7), in place; keep them in out (m, trials, 13).

    normals (m, trials, 13) times gain (13,) are the impulses in the middle of each step.
    """
    F, term = np.empty((ROWS, COLUMNS)), np.empty((2, ROWS, COLUMNS))
    forth, half, back = np.empty((ROWS, COLUMNS)), np.empty((ROWS, COLUMNS)), np.empty((ROWS, COLUMNS))
    here, there, f, C = np.empty(7), np.empty(7), np.empty(3), np.empty((3, 3))
    decay, half_decay = shares[0], shares[1]
    new = np.empty(COLUMNS)
    for k in range(f_n.shape[0]):
        g = f_n[k]
        for trial in range(x.shape[0]):
            # Half-way between truth and INS all terms of second order vanish: exchanging the two changes X's sign.
            e = x[trial]
            halfway(rows[k], e, here)
            halfway(rows[k + 1], e, there)
            C[:] = 0.0
            matrix(here[3:], C)
            f[0] = g[0] - 0.5 * (e[5] * g[2] - e[6] * g[1])
            f[1] = g[1] - 0.5 * (e[6] * g[0] - e[4] * g[2])
            f[2] = g[2] - 0.5 * (e[4] * g[1] - e[5] * g[0])
            for i in range(3):
                for j in range(3):
                    f[i] += 0.5 * C[i, j] * e[ROWS + j]
            step_matrix(p, deflection, here, there, f, F)
            transition(F, rate, dt, term, forth, half, back)
            for j in range(COLUMNS):
                new[j] = 0.0
            for i in range(ROWS):
                total = 0.0
                for j in range(COLUMNS):
                    total += forth[i, j] * x[trial, j] + half[i, j] * (gain[j] * normals[k, trial, j])
                new[i] = total
            for i in range(ROWS, COLUMNS):
                new[i] = decay[i] * x[trial, i] + half_decay[i] * (gain[i] * normals[k, trial, i])
            for i in range(COLUMNS):
                x[trial, i] = new[i]
                out[k, trial, i] = new[i]
