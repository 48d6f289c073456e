"""Kernels shared by the gyro-free solvers: running integrals of samples, attitude, velocity, position.

Every kernel goes sample by sample and keeps what it needs of the past in ``carry``,
so that any chunking of a stream gives the same bits. ``fourth`` chooses between
fourth-order and first-order integration; ``started`` is false for the first block
of a stream, whose first row is the initial state.
"""

import numpy as np

from bench.errors import Array
from bench.jit import njit
from bench.rotation_kernels import exponential, multiply, normalize, rotate


@njit
def accumulate(x, h, fourth, started, carry, out):
    """Integrate samples x (n, 3) from the start of the stream to every sample.

    Fourth order: the cubic through the last four samples over the last interval (Adams-Moulton); the first
    three intervals take the cubic through the first four samples, so a first block has at least four rows.
    carry (4, 3): the integral, and the last three samples, newest first.
    """
    n = x.shape[0]
    c = h / 24.0
    # First what every interval adds, in one sweep over plain memory; the sum follows.
    if fourth:
        for k in range(min(3, n)):
            for i in range(3):
                x1 = x[k - 1, i] if k > 0 else carry[1, i]
                x2 = x[k - 2, i] if k > 1 else carry[2 - k, i]
                x3 = carry[3 - k, i]
                out[k, i] = c * (9.0 * x[k, i] + 19.0 * x1 - 5.0 * x2 + x3)
        flat, added = x.reshape(3 * n), out.reshape(3 * n)
        for m in range(3 * n - 9):
            added[m + 9] = c * (9.0 * flat[m + 9] + 19.0 * flat[m + 6] - 5.0 * flat[m + 3] + flat[m])
    else:
        for i in range(3):
            out[0, i] = h * carry[1, i]
        for k in range(1, n):
            for i in range(3):
                out[k, i] = h * x[k - 1, i]
    if not started:
        for i in range(3):
            out[0, i] = 0.0
            if fourth:
                x0, x1, x2, x3 = x[0, i], x[1, i], x[2, i], x[3, i]
                out[1, i] = c * (9.0 * x0 + 19.0 * x1 - 5.0 * x2 + x3)
                out[2, i] = c * (13.0 * (x1 + x2) - x0 - x3)
    sx, sy, sz = carry[0, 0], carry[0, 1], carry[0, 2]
    for k in range(n):
        sx += out[k, 0]
        sy += out[k, 1]
        sz += out[k, 2]
        out[k, 0], out[k, 1], out[k, 2] = sx, sy, sz
    carry[0, 0], carry[0, 1], carry[0, 2] = sx, sy, sz
    for i in range(3):
        for k in range(max(0, n - 3), n):
            carry[3, i], carry[2, i], carry[1, i] = carry[2, i], carry[1, i], x[k, i]


@njit
def _turn(omega, alpha, f, gravity, h, fourth, started, carry, attitude, q, acceleration):
    """Integrate the attitude and resolve f in i; carry (2, 3): the last omega and alpha; attitude (4,): the last q.

    Fourth order: omega and alpha at both ends of an interval give the cubic Hermite integral of omega, and
    h^2/12 w0 x w1 the non-commutativity of a linear omega (Magnus); what is left out is of order h^5.
    First order: q o (1, omega h/2).
    """
    w, x, y, z = attitude[0], attitude[1], attitude[2], attitude[3]
    ox, oy, oz = carry[0, 0], carry[0, 1], carry[0, 2]
    ax, ay, az = carry[1, 0], carry[1, 1], carry[1, 2]
    c = h * h / 12.0
    for k in range(omega.shape[0]):
        px, py, pz = omega[k, 0], omega[k, 1], omega[k, 2]
        bx, by, bz = alpha[k, 0], alpha[k, 1], alpha[k, 2]
        if started or k > 0:
            if fourth:
                dw, dx, dy, dz = exponential(
                    0.5 * h * (ox + px) + c * (ax - bx + (oy * pz - oz * py)),
                    0.5 * h * (oy + py) + c * (ay - by + (oz * px - ox * pz)),
                    0.5 * h * (oz + pz) + c * (az - bz + (ox * py - oy * px)),
                )
                # 1/|q| by one Newton step, exact to rounding as |q| is 1 within 1e-9; from the quaternion before
                # the product, so that the two do not wait for each other.
                scale = 1.5 - 0.5 * ((w * w + x * x) + (y * y + z * z))
                w, x, y, z = multiply(w, x, y, z, dw, dx, dy, dz)
                w, x, y, z = w * scale, x * scale, y * scale, z * scale
            else:
                w, x, y, z = multiply(w, x, y, z, 1.0, 0.5 * h * ox, 0.5 * h * oy, 0.5 * h * oz)
                w, x, y, z = normalize(w, x, y, z)
        q[k, 0], q[k, 1], q[k, 2], q[k, 3] = w, x, y, z
        fx, fy, fz = rotate(w, x, y, z, f[k, 0], f[k, 1], f[k, 2])
        acceleration[k, 0], acceleration[k, 1], acceleration[k, 2] = fx + gravity[0], fy + gravity[1], fz + gravity[2]
        ox, oy, oz, ax, ay, az = px, py, pz, bx, by, bz
    attitude[0], attitude[1], attitude[2], attitude[3] = w, x, y, z
    carry[0, 0], carry[0, 1], carry[0, 2] = ox, oy, oz
    carry[1, 0], carry[1, 1], carry[1, 2] = ax, ay, az


def strapdown(
    omega: Array,
    alpha: Array,
    f: Array,
    gravity: Array,
    h: float,
    fourth: bool,
    started: bool,
    carry: Array,
    attitude: Array,
    q: Array,
    velocity: Array,
    position: Array,
) -> None:
    """Integrate attitude, velocity and position from omega, alpha and f at the samples.

    carry (14, 3): rows 0-3 belong to the solver's integral of alpha, 4-7 to the velocity, 8-11 to the
    position, 12-13 to the attitude. Not a kernel itself, so that `accumulate` is compiled once.
    """
    acceleration = np.empty_like(f)
    _turn(omega, alpha, f, gravity, h, fourth, started, carry[12:14], attitude, q, acceleration)
    accumulate(acceleration, h, fourth, started, carry[4:8], velocity)
    accumulate(velocity, h, fourth, started, carry[8:12], position)
