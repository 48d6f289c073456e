"""Kernel of the error simulation: errors of many trials along one path."""

import numpy as np

from bench.jit import njit
from bench.solvers.damping._error_kernels import COLUMNS, ROWS, step_matrix, transition


@njit
def propagate(p, deflection, dt, rows, f_n, rate, shares, gain, normals, x, out):
    """Take the errors x (trials, 13) along the steps of rows (m + 1, 7), in place; keep them in out (m, trials, 13).

    normals (m, trials, 13) times gain (13,) are the impulses in the middle of each step.
    """
    F, term = np.empty((ROWS, COLUMNS)), np.empty((2, ROWS, COLUMNS))
    forth, half, back = np.empty((ROWS, COLUMNS)), np.empty((ROWS, COLUMNS)), np.empty((ROWS, COLUMNS))
    decay, half_decay = shares[0], shares[1]
    new = np.empty(COLUMNS)
    for k in range(f_n.shape[0]):
        step_matrix(p, deflection, rows[k], rows[k + 1], f_n[k], F)
        transition(F, rate, dt, term, forth, half, back)
        for trial in range(x.shape[0]):
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
