"""Rotations: quaternions, rotation vectors, matrices, Euler angles; vectorised NumPy.

Quaternions are Hamilton, wxyz; q_ab and C_ab take b-components to a-components,
q_ac = q_ab o q_bc. A rotation vector phi stands for q = exp(phi/2). Euler angles
are yaw psi about z, pitch P about x, roll R about y, C_nb = Rz(psi) Rx(P) Ry(R)
(3-1-2); psi is anticlockwise. All functions broadcast over leading dimensions and
do not check their input; kernels on scalars are in ``bench.rotation_kernels``.

References
----------
[1] Shuster, A survey of attitude representations, J. Astronautical Sciences 41(4), 1993.
[2] Shepperd, Quaternion from rotation matrix, J. Guidance and Control 1(3), 1978.
"""

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array


def _dot(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def cross(a: ArrayLike, b: ArrayLike) -> Array:
    """Return a x b, shape (..., 3); several times faster than `numpy.cross`."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    return np.stack(
        [
            a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1],
            a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2],
            a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0],
        ],
        axis=-1,
    )


def quat_multiply(p: ArrayLike, q: ArrayLike) -> Array:
    """Return the Hamilton product p o q, shape (..., 4)."""
    pw, px, py, pz = np.moveaxis(np.asarray(p, dtype=float), -1, 0)
    qw, qx, qy, qz = np.moveaxis(np.asarray(q, dtype=float), -1, 0)
    return np.stack(
        [
            pw * qw - px * qx - py * qy - pz * qz,
            pw * qx + px * qw + py * qz - pz * qy,
            pw * qy - px * qz + py * qw + pz * qx,
            pw * qz + px * qy - py * qx + pz * qw,
        ],
        axis=-1,
    )


def quat_conjugate(q: ArrayLike) -> Array:
    """Return q*, the inverse of a unit quaternion, shape (..., 4)."""
    return np.asarray(q, dtype=float) * np.array([1.0, -1.0, -1.0, -1.0])


def quat_normalize(q: ArrayLike) -> Array:
    """Return q / |q|, shape (..., 4)."""
    q = np.asarray(q, dtype=float)
    return q / np.sqrt((q * q).sum(axis=-1, keepdims=True))


def quat_rotate(q_ab: ArrayLike, v_b: ArrayLike) -> Array:
    """Return C_ab v_b for unit quaternions, shape (..., 3): v + 2 w u x v + 2 u x (u x v)."""
    q, v = np.asarray(q_ab, dtype=float), np.asarray(v_b, dtype=float)
    u = q[..., 1:]
    twice = 2.0 * cross(u, v)
    return v + q[..., :1] * twice + cross(u, twice)


def quat_from_rotvec(phi: ArrayLike) -> Array:
    """Return exp(phi/2), shape (..., 4), for phi of any length, rad; accurate for the tiniest phi."""
    phi = np.asarray(phi, dtype=float)
    angle = np.sqrt(_dot(phi, phi))
    # sin(x/2)/x is 1/2 to rounding below 1e-8, where x*x may underflow.
    tiny = angle < 1e-8
    scale = np.where(tiny, 0.5, np.sin(0.5 * angle) / np.where(tiny, 1.0, angle))
    return np.concatenate([np.cos(0.5 * angle)[..., None], scale[..., None] * phi], axis=-1)


def rotvec_from_quat(q: ArrayLike) -> Array:
    """Return the shortest rotation vector of unit quaternions, shape (..., 3), |phi| <= pi rad.

    q and -q give the same vector; at exactly pi the sign of the axis is that of q.
    """
    q = np.asarray(q, dtype=float)
    q = np.where(q[..., :1] < 0, -q, q)
    u = q[..., 1:]
    sine = np.sqrt(_dot(u, u))
    tiny = sine < 1e-8  # there q = (1, phi/2) to rounding, and sine*sine may underflow
    scale = np.where(tiny, 2.0, 2.0 * np.arctan2(sine, q[..., 0]) / np.where(tiny, 1.0, sine))
    return scale[..., None] * u


def matrix_from_quat(q: ArrayLike) -> Array:
    """Return C_ab of unit quaternions q_ab, shape (..., 3, 3)."""
    w, x, y, z = np.moveaxis(np.asarray(q, dtype=float), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def quat_from_matrix(C: ArrayLike) -> Array:
    """Return q_ab (w >= 0) of rotation matrices C_ab, shape (..., 4).

    The largest of the four components is found first and divides the others, so
    that no digits are lost near 180 degrees (Shepperd [2]).
    """
    C = np.asarray(C, dtype=float)
    xx, yy, zz = C[..., 0, 0], C[..., 1, 1], C[..., 2, 2]
    wx, wy, wz = C[..., 2, 1] - C[..., 1, 2], C[..., 0, 2] - C[..., 2, 0], C[..., 1, 0] - C[..., 0, 1]
    xy, xz, yz = C[..., 0, 1] + C[..., 1, 0], C[..., 0, 2] + C[..., 2, 0], C[..., 1, 2] + C[..., 2, 1]
    # Row k is 4 q_k (q_w, q_x, q_y, q_z).
    candidates = np.stack(
        [
            np.stack([1 + xx + yy + zz, wx, wy, wz], axis=-1),
            np.stack([wx, 1 + xx - yy - zz, xy, xz], axis=-1),
            np.stack([wy, xy, 1 - xx + yy - zz, yz], axis=-1),
            np.stack([wz, xz, yz, 1 - xx - yy + zz], axis=-1),
        ],
        axis=-2,
    )
    largest = np.argmax(np.diagonal(candidates, axis1=-2, axis2=-1), axis=-1)
    q = quat_normalize(np.take_along_axis(candidates, largest[..., None, None], axis=-2)[..., 0, :])
    return np.where(q[..., :1] < 0, -q, q)


def quat_from_euler(psi: ArrayLike, P: ArrayLike, R: ArrayLike) -> Array:
    """Return q_nb of yaw psi, pitch P, roll R, rad, shape (..., 4): qz(psi) o qx(P) o qy(R)."""
    halves = [0.5 * np.asarray(angle, dtype=float) for angle in (psi, P, R)]
    (cz, cx, cy), (sz, sx, sy) = map(np.cos, halves), map(np.sin, halves)
    return np.stack(
        [
            cz * cx * cy - sz * sx * sy,
            cz * sx * cy - sz * cx * sy,
            cz * cx * sy + sz * sx * cy,
            sz * cx * cy + cz * sx * sy,
        ],
        axis=-1,
    )


def euler_from_quat(q_nb: ArrayLike) -> tuple[Array, Array, Array]:
    """Return yaw psi, pitch P, roll R of unit quaternions, rad; psi and R in (-pi, pi], P in [-pi/2, pi/2].

    Where cos P vanishes to rounding only psi + R (at P = pi/2) or psi - R (at -pi/2) is defined, and R = 0 is
    returned. Close to there psi and R are poorly determined each, but together still give q_nb to rounding.
    """
    w, x, y, z = np.moveaxis(np.asarray(q_nb, dtype=float), -1, 0)
    # (w + x, y + z) and (w - x, z - y) point along (psi + R)/2 and (psi - R)/2; the product of their lengths
    # is cos P. No entry of C_nb does as well: psi and R from it err each for itself near the poles.
    half_sum, half_difference = np.arctan2(y + z, w + x), np.arctan2(z - y, w - x)
    length_sum, length_difference = np.hypot(y + z, w + x), np.hypot(z - y, w - x)
    P = np.arctan2(2 * (w * x + y * z), length_sum * length_difference)
    half_difference = np.where(length_difference < 1e-15, half_sum, half_difference)
    half_sum = np.where(length_sum < 1e-15, half_difference, half_sum)
    return wrap(half_sum + half_difference), P, wrap(half_sum - half_difference)


def euler_from_matrix(C_nb: ArrayLike) -> tuple[Array, Array, Array]:
    """Return yaw psi, pitch P, roll R of rotation matrices, as `euler_from_quat`."""
    return euler_from_quat(quat_from_matrix(C_nb))


def wrap(angle: ArrayLike) -> Array:
    """Return the angle in (-pi, pi], rad; exact for angles already there."""
    angle = np.asarray(angle, dtype=float)
    turned = angle - 2 * np.pi * np.round(angle / (2 * np.pi))
    # The quotient is rounded: next to an odd multiple of pi the turn may be one too few or too many.
    turned = np.where(turned > np.pi, turned - 2 * np.pi, turned)
    return np.where(turned <= -np.pi, turned + 2 * np.pi, turned)
