"""Attitude from pairs of vectors, and the smooth sums of specific force in inertial space that alignment compares.

References
----------
[Shuster] Shuster, Oh: Three-axis attitude determination from vector observations, J. Guidance and Control 4(1), 1981.
"""

import numpy as np

from bench.earth import WGS84, Earth
from bench.errors import Array
from bench.rotation import (
    cross,
    quat_conjugate,
    quat_from_euler,
    quat_from_matrix,
    quat_from_rotvec,
    quat_multiply,
    quat_normalize,
    quat_rotate,
)
from bench.trajectory import NavigationInitial

WINDOWS = 5  # of half the stretch, evenly over it


def two_vectors(up_n: Array, north_n: Array, up_b: Array, north_b: Array) -> Array:
    """Return q_nb that takes up_b to the direction of up_n exactly, and north_b to north_n across it (TRIAD)."""
    return quat_from_matrix(_triad(up_n, north_n) @ _triad(up_b, north_b).T)


def _triad(up: Array, north: Array) -> Array:
    """Return the unit vectors east, north, up as columns; north is made perpendicular."""
    up = up / np.linalg.norm(up)
    east = cross(north, up)
    east /= np.linalg.norm(east)
    return np.stack([east, cross(up, east), up], axis=1)


def level(up_n: Array, up_b: Array, psi: float) -> Array:
    """Return q_nb that takes up_b to the direction of up_n, nearly vertical, with yaw psi."""
    x, y, z = up_b
    q_lb = quat_from_euler(psi, np.arctan2(y, np.hypot(x, z)), np.arctan2(-x, z))
    tilt = cross([0.0, 0.0, 1.0], up_n) / up_n[2]  # a few arcsec
    return quat_multiply(quat_from_rotvec(tilt), q_lb)


def still_space(dtheta: Array, dvel: Array, dt: float) -> tuple[Array, Array]:
    """Return the integral of the specific force, (m + 1, 3), in axes w that do not turn, and q_wb at the end.

    Two increments a step; of an odd number the first is left out. An inertial navigation on an Earth that neither turns
    nor attracts is this integral.
    """
    from bench.solvers.navigation.inertial_frame import InertialFrame

    nowhere = Earth("nowhere", 1e7, 0.0, GM=1e-200, rate=0.0, J2=0.0, field="j2", source=WGS84.source)
    start = NavigationInitial(latitude=0.0, longitude=0.0)
    odd = len(dtheta) % 2
    path = InertialFrame(samples=2).solve(dtheta[odd:], dvel[odd:], dt, start, nowhere)
    return path.v_e, path.q_eb[-1]


def windows(steps: int) -> tuple[Array, Array]:
    """Return the weights cos^4 of the windows over equal steps, (WINDOWS, steps), and their centres, 0 to 1."""
    centres = np.linspace(0.25, 0.75, WINDOWS)
    phase = np.pi * ((np.arange(steps) + 0.5) / steps - centres[:, None]) / 0.5
    return np.where(np.abs(phase) < np.pi / 2, np.cos(phase) ** 4, 0.0), centres


def whitening(weights: Array) -> Array:
    """Return the matrix that makes the weights orthonormal: white noise is then equal and independent in all sums."""
    return np.asarray(np.linalg.inv(np.linalg.cholesky(weights @ weights.T)))


def least_squares_rotation(a: Array, b: Array) -> tuple[Array, float, Array]:
    """Return q_ab and the scale s with least ``sum |a_k - s C_ab b_k|^2``, and the covariance of the rotation in a.

    The q-method [Shuster] finds q; where all vectors are nearly parallel, as here, it does so to a few 1e-11 rad only,
    and two steps of Gauss and Newton give the rest. The covariance (3, 3), rad^2, is from the scatter of the residuals.
    """
    B = a.T @ b
    S = B + B.T
    K = np.empty((4, 4))
    K[0, 0] = np.trace(B)
    K[0, 1:] = K[1:, 0] = cross(b, a).sum(axis=0)
    K[1:, 1:] = S - np.trace(B) * np.eye(3)
    q = np.linalg.eigh(K)[1][:, -1]
    scale = 1.0
    for _ in range(3):
        turned = quat_rotate(q, b)
        scale = float((a * turned).sum() / (b * b).sum())
        residual = (a - scale * turned).ravel()
        # d(s C b) = -s (C b) x delta + ds C b
        slopes = [-scale * cross(turned, axis).ravel() for axis in np.eye(3)]
        design = np.stack([*slopes, turned.ravel()], axis=1)
        inverse = np.linalg.pinv(design)
        delta = inverse @ residual
        q = quat_normalize(quat_multiply(quat_from_rotvec(delta[:3]), q))
    residual = residual - design @ delta
    variance = residual @ residual / (len(residual) - 4)
    return q, scale, variance * (inverse @ inverse.T)[:3, :3]


def force_sums(earth: Earth, place: NavigationInitial, weights: Array, T: float) -> Array:
    """Return the weighted integrals, in i, of minus gravity at a place fixed to the Earth; steps of T from t = 0."""
    f_e = -earth.gravity(earth.position(place.latitude, place.longitude, place.height))
    t = (np.arange(weights.shape[1]) + 0.5) * T
    # Over a step the part across the axis turns by omega_ie T: the mean is that at the middle, a little shorter.
    fade = np.array([1.0, 1.0, 0.0]) * np.sinc(0.5 * earth.rate * T / np.pi) + np.array([0.0, 0.0, 1.0])
    return np.asarray(weights @ quat_rotate(earth.q_ie(t), f_e * fade * T))


def drift_about_north(earth: Earth, place: NavigationInitial, centres: Array, off_i: Array) -> float:
    """Return the rate about north, rad/s, that explains how the residual acceleration off_i grows eastwards.

    off_i (WINDOWS, 3) is in i at the times `centres`, s. A rate about north tilts the vertical eastwards more and more;
    one about east would be taken for the Earth's turn at another heading.
    """
    q_in = quat_multiply(earth.q_ie(centres), earth.q_en(place.latitude, place.longitude))
    off_n = quat_rotate(quat_conjugate(q_in), off_i)
    g = np.linalg.norm(earth.gravity_n(place.latitude, place.height))
    return float(np.polyfit(centres - centres.mean(), off_n[:, 0], 1)[0] / g)
