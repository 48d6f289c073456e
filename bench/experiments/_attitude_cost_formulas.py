"""The three algorithms of Xu et al. for N = 3 as their formulas are printed: kernels to be counted, not to be used.

All end in the attitude matrix, as table 1 does. Increments dtheta (3, 3), row i the i-th of an update; q wxyz, unit;
C row by row (9,). Time is in updates, so the powers of h do not appear.
"""

import math

import numpy as np

from bench.jit import njit


@njit
def matrix_of(w, x, y, z, C):
    """Fill C with the matrix of a quaternion, element by element."""
    C[0], C[4], C[8] = w * w + x * x - y * y - z * z, w * w + y * y - x * x - z * z, w * w + z * z - x * x - y * y
    C[1], C[2], C[5] = 2.0 * (x * y - w * z), 2.0 * (x * z + w * y), 2.0 * (y * z - w * x)
    C[3], C[6], C[7] = 2.0 * (x * y + w * z), 2.0 * (x * z - w * y), 2.0 * (y * z + w * x)


@njit
def rotation_vector(dtheta, q, C):
    """Turn q by eq. (4) and exp(phi/2), as the product of a 4 x 4 matrix with the column p; fill C."""
    phi, change = np.empty(3), np.empty(3)
    for i in range(3):
        change[i] = dtheta[2, i] - dtheta[0, i]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        first = dtheta[0, j] * dtheta[2, k] - dtheta[0, k] * dtheta[2, j]
        second = dtheta[1, j] * change[k] - dtheta[1, k] * change[j]
        phi[i] = dtheta[0, i] + dtheta[1, i] + dtheta[2, i] + 33 / 80 * first + 57 / 80 * second
    angle = math.sqrt(phi[0] * phi[0] + phi[1] * phi[1] + phi[2] * phi[2])
    half = angle / 2.0
    sine, a = math.sin(half), math.cos(half)
    b, c, d = phi[0] / angle * sine, phi[1] / angle * sine, phi[2] / angle * sine
    w, x, y, z = q[0], q[1], q[2], q[3]
    q[0] = w * a + -x * b + -y * c + -z * d
    q[1] = x * a + w * b + -z * c + y * d
    q[2] = y * a + z * b + w * c + -x * d
    q[3] = z * a + -y * b + x * c + w * d
    matrix_of(q[0], q[1], q[2], q[3], C)


@njit
def rate_derivatives(dtheta, halved, out):
    """Fill out (3, 3) row by row with the rate at the start and its two derivatives (eqs 2 and 9), or half of them."""
    half, nine, most = (0.25, 4.5, 13.5) if halved else (0.5, 9.0, 27.0)
    for i in range(3):
        first, second, third = dtheta[0, i], dtheta[1, i], dtheta[2, i]
        out[0, i] = (11.0 * first + 2.0 * third - 7.0 * second) * half
        out[1, i] = (3.0 * second - (2.0 * first + third)) * nine
        out[2, i] = (first + third - 2.0 * second) * most


@njit
def dense_product(A, B, out):
    """Fill out with A B, every element, zeros or not."""
    n = A.shape[0]
    for i in range(n):
        for j in range(n):
            total = A[i, 0] * B[0, j]
            for k in range(1, n):
                total += A[i, k] * B[k, j]
            out[i, j] = total


@njit
def transition(W, terms, left, out):
    """Fill out (n, n) with sum_k X^(k)/k! to k = terms, X' = W X (left) or X W, X(0) = 1 (eqs 7 and 8, 11 and 12).

    W (3, n, n): the matrix of the rate and its derivatives; X^(k) = sum_i binomial(k - 1, i) W_i X^(k-1-i).
    """
    n = W.shape[1]
    X, term = np.zeros((terms + 1, n, n)), np.empty((n, n))
    for i in range(n):
        X[0, i, i] = 1.0
    out[:, :] = X[0]
    factorial = 1
    for k in range(1, terms + 1):
        factorial *= k
        for i in range(min(k, 3)):
            if left:
                dense_product(W[i], X[k - 1 - i], term)
            else:
                dense_product(X[k - 1 - i], W[i], term)
            binomial = 1 if i == 0 else k - 1 if i == 1 else (k - 1) * (k - 2) // 2
            for r in range(n):
                for c in range(n):
                    weighted = term[r, c] if binomial == 1 else binomial * term[r, c]
                    X[k, r, c] = weighted if i == 0 else X[k, r, c] + weighted
        weight = 1.0 / factorial
        for r in range(n):
            for c in range(n):
                out[r, c] += X[k, r, c] if k == 1 else weight * X[k, r, c]


@njit
def quaternion(dtheta, terms, q, C):
    """Turn q by the 4 x 4 transition matrix of eq. (5); fill C."""
    rates, W, X = np.empty((3, 3)), np.zeros((3, 4, 4)), np.empty((4, 4))
    rate_derivatives(dtheta, True, rates)  # with the factor 1/2 of eq. (6)
    for m in range(3):
        a, b, c = rates[m, 0], rates[m, 1], rates[m, 2]
        W[m, 0, 1], W[m, 0, 2], W[m, 0, 3] = -a, -b, -c
        W[m, 1, 0], W[m, 1, 2], W[m, 1, 3] = a, c, -b
        W[m, 2, 0], W[m, 2, 1], W[m, 2, 3] = b, -c, a
        W[m, 3, 0], W[m, 3, 1], W[m, 3, 2] = c, b, -a
    transition(W, terms, True, X)
    w, x, y, z = q[0], q[1], q[2], q[3]
    for i in range(4):
        q[i] = X[i, 0] * w + X[i, 1] * x + X[i, 2] * y + X[i, 3] * z
    matrix_of(q[0], q[1], q[2], q[3], C)


@njit
def matrix(dtheta, terms, C):
    """Turn C (9,) by the 3 x 3 transition matrix of eq. (10)."""
    rates, W, X = np.empty((3, 3)), np.zeros((3, 3, 3)), np.empty((3, 3))
    rate_derivatives(dtheta, False, rates)
    for m in range(3):
        a, b, c = rates[m, 0], rates[m, 1], rates[m, 2]
        W[m, 0, 1], W[m, 0, 2], W[m, 1, 0] = -c, b, c
        W[m, 1, 2], W[m, 2, 0], W[m, 2, 1] = -a, -b, a
    transition(W, terms, False, X)
    old, new = C.copy().reshape((3, 3)), np.empty((3, 3))
    dense_product(old, X, new)
    for i in range(9):
        C[i] = new[i // 3, i % 3]
