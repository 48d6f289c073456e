"""Kernels of `array-least-squares`: the maximum-likelihood rate of one reading, and its integral.

q(omega) = (w_x^2, w_y^2, w_z^2, w_x w_y, w_x w_z, w_y w_z). With f and alpha free, -2 s^2 times the log-likelihood
of omega is q'G q - 2 q'b, up to a constant. A reading A enters as ``parts`` = [M A, b = B A, z = S A]; see
`_design.Design` for the matrices. ``free`` is the integral of alpha, which gives the rate or its signs.
"""

import math

import numpy as np

from bench.jit import njit

INTEGRAL, SQUARES, RANK_ONE = 0, 1, 2  # modes
_REFINEMENTS = 20  # Newton steps at most; two or three are taken
SWEEPS = 25  # of the implicit integration at most; about five are taken
M_ROW, B_ROW, Z_ROW = 0, 6, 12  # where M A, b and z start in parts


@njit
def apply(matrix, vectors, out):
    """Set out (n, r) to the products of the matrix (r, m) with each row of vectors (n, m)."""
    for k in range(vectors.shape[0]):
        for i in range(matrix.shape[0]):
            total = 0.0
            for j in range(matrix.shape[1]):
                total += matrix[i, j] * vectors[k, j]
            out[k, i] = total


@njit
def _cost(G, parts, k, x, y, z, rest):
    """Set rest = b - G q and return q'G q - 2 q'b."""
    q = (x * x, y * y, z * z, x * y, x * z, y * z)
    cost = 0.0
    for i in range(6):
        b = parts[k, B_ROW + i]
        total = b
        for j in range(6):
            total -= G[i, j] * q[j]
        rest[i] = total
        cost -= q[i] * (b + total)
    return cost


@njit
def _solve(xx, xy, xz, yy, yz, zz, gx, gy, gz, least):
    """Solve a symmetric system by Cholesky; the first value is false unless all pivots exceed `least`."""
    if not xx > least:
        return False, 0.0, 0.0, 0.0
    b, d = xy / xx, xz / xx
    yy, yz, zz = yy - b * xy, yz - b * xz, zz - d * xz
    if not yy > least:
        return False, 0.0, 0.0, 0.0
    e = yz / yy
    zz -= e * yz
    if not zz > least:
        return False, 0.0, 0.0, 0.0
    gy -= b * gx
    z = (gz - d * gx - e * gy) / zz
    y = gy / yy - e * z
    return True, gx / xx - b * y - d * z, y, z


@njit
def _step(G, x, y, z, rest):
    """Return the Newton step of the cost or, where its Hessian is not positive, that of Gauss-Newton.

    Half the Hessian is J'G J less the second derivatives of q times rest, half the gradient -J'rest, J = dq/dw.
    """
    gx = 2.0 * x * rest[0] + y * rest[3] + z * rest[4]
    gy = 2.0 * y * rest[1] + x * rest[3] + z * rest[5]
    gz = 2.0 * z * rest[2] + x * rest[4] + y * rest[5]
    xx = xy = xz = yy = yz = zz = 0.0
    for i in range(6):
        cx = 2.0 * x * G[i, 0] + y * G[i, 3] + z * G[i, 4]  # (G J)_i
        cy = 2.0 * y * G[i, 1] + x * G[i, 3] + z * G[i, 5]
        cz = 2.0 * z * G[i, 2] + x * G[i, 4] + y * G[i, 5]
        jx = 2.0 * x if i == 0 else y if i == 3 else z if i == 4 else 0.0
        jy = 2.0 * y if i == 1 else x if i == 3 else z if i == 5 else 0.0
        jz = 2.0 * z if i == 2 else x if i == 4 else y if i == 5 else 0.0
        xx += jx * cx
        xy += jx * cy
        xz += jx * cz
        yy += jy * cy
        yz += jy * cz
        zz += jz * cz
    trace = xx + yy + zz
    found, sx, sy, sz = _solve(
        *(xx - 2.0 * rest[0], xy - rest[3], xz - rest[4], yy - 2.0 * rest[1], yz - rest[5], zz - 2.0 * rest[2]),
        *(gx, gy, gz, 1e-13 * trace),
    )
    if not found:
        # Where an axis has no information its gradient vanishes as well, and the damping leaves it where it is.
        damping = 1e-13 * trace
        found, sx, sy, sz = _solve(xx + damping, xy, xz, yy + damping, yz, zz + damping, gx, gy, gz, 0.0)
    return (sx, sy, sz) if found else (0.0, 0.0, 0.0)


@njit
def _refine(G, parts, k, x, y, z, rest):
    """Return the minimum of the cost near (x, y, z): Newton steps, shortened until they gain."""
    cost = _cost(G, parts, k, x, y, z, rest)
    scale, trials = 1.0, 0
    sx, sy, sz = _step(G, x, y, z, rest)
    while trials < _REFINEMENTS:
        trials += 1
        size, length = x * x + y * y + z * z, sx * sx + sy * sy + sz * sz
        tx, ty, tz = x + scale * sx, y + scale * sy, z + scale * sz
        new = _cost(G, parts, k, tx, ty, tz, rest)
        # A step below 1e-6 of the rate gains less than the rounding of the cost.
        if new < cost or length <= 1e-12 * size:
            x, y, z, cost, scale = tx, ty, tz, new, 1.0
            if length <= 1e-20 * size:
                break
            sx, sy, sz = _step(G, x, y, z, rest)
        else:
            scale *= 0.25
    return x, y, z


@njit
def motion(mode, K, G, parts, k, free, j, rest, omega, alpha, f):
    """Set omega, alpha, f in row k, given row j of the integral of alpha; return how many squares were negative."""
    x, y, z = free[j, 0], free[j, 1], free[j, 2]
    negative = 0
    if mode != INTEGRAL:
        xx, yy, zz = parts[k, Z_ROW], parts[k, Z_ROW + 1], parts[k, Z_ROW + 2]
        negative = int(xx < 0.0) + int(yy < 0.0) + int(zz < 0.0)
        if mode == SQUARES:
            x = math.copysign(math.sqrt(max(xx, 0.0)), x)
            y = math.copysign(math.sqrt(max(yy, 0.0)), y)
            z = math.copysign(math.sqrt(max(zz, 0.0)), z)
        else:  # the row of the largest square, over its root
            xy, xz, yz = parts[k, Z_ROW + 3], parts[k, Z_ROW + 4], parts[k, Z_ROW + 5]
            if yy > xx and yy >= zz:
                xx, xz, xy = xy, yz, yy
                largest = yy
            elif zz > xx:
                xx, xy, xz = xz, yz, zz
                largest = zz
            else:
                largest = xx
            root = math.sqrt(max(largest, 0.0))
            x, y, z = (xx / root, xy / root, xz / root) if root > 0.0 else (0.0, 0.0, 0.0)
            if x * free[j, 0] + y * free[j, 1] + z * free[j, 2] < 0.0:
                x, y, z = -x, -y, -z
        x, y, z = _refine(G, parts, k, x, y, z, rest)
    omega[k, 0], omega[k, 1], omega[k, 2] = x, y, z
    q = (x * x, y * y, z * z, x * y, x * z, y * z)
    for i in range(3):
        f[k, i], alpha[k, i] = parts[k, i], parts[k, 3 + i]
        for c in range(6):
            f[k, i] -= K[i, c] * q[c]
            alpha[k, i] -= K[3 + i, c] * q[c]
    return negative


@njit
def stream(mode, K, G, parts, first, h, fourth, carry, omega, alpha, f):
    """Find omega, alpha, f from row `first` on; return how many squares were negative.

    carry (4, 3) is that of `_strapdown.accumulate` for the integral of alpha. As alpha depends on the rate, and the
    rate or its signs on the integral of alpha, each reading is swept until both agree.
    """
    rest, free = np.empty(6), np.empty((1, 3))
    negative = 0
    for k in range(first, parts.shape[0]):
        for i in range(3):
            past = 23.0 * carry[1, i] - 16.0 * carry[2, i] + 5.0 * carry[3, i]  # predictor
            free[0, i] = carry[0, i] + (h / 12.0 * past if fourth else h * carry[1, i])
        found = 0
        for _ in range(SWEEPS):
            found = motion(mode, K, G, parts, k, free, 0, rest, omega, alpha, f)
            if not fourth:
                break
            change, size, along, crossed = 0.0, 0.0, 0.0, False
            for i in range(3):
                past = 19.0 * carry[1, i] - 5.0 * carry[2, i] + carry[3, i]
                new = carry[0, i] + h / 24.0 * (9.0 * alpha[k, i] + past)
                change, size = max(change, abs(new - free[0, i])), max(size, abs(new))
                along += omega[k, i] * new
                crossed = crossed or math.copysign(1.0, new) != math.copysign(1.0, free[0, i])
                free[0, i] = new
            if mode == INTEGRAL:
                settled = not change > 1e-15 * size
            else:
                settled = not crossed if mode == SQUARES else not along < 0.0
            if settled:
                break
        negative += found
        for i in range(3):
            carry[3, i], carry[2, i], carry[1, i], carry[0, i] = carry[2, i], carry[1, i], alpha[k, i], free[0, i]
    return negative
