"""Alignment: the initial attitude of a strapdown unit from a stretch of data while its base stands or sways in place.

Two directions are known in the navigation frame n (east-north-up) at a known place: gravity, and the axis about which
the Earth turns. `coarse_alignment` sees both as means over a stretch at rest; `inertial_alignment` sees how gravity
turns in inertial space, and so lets the base sway. No stretch shows a constant error of the gyro towards the east, nor
one of the accelerometers across the vertical. The expected errors are therefore the scatter of the data, or what does
not fit in the other directions, or biases from a data sheet, whichever is largest.

References
----------
[Britting] Britting: Inertial Navigation Systems Analysis, 1971, chapter 9.
[Shuster] Shuster, Oh: Three-axis attitude determination from vector observations, J. Guidance and Control 4(1), 1981.
[WuPan] Wu, Pan: Velocity/position integration formula, part I: application to in-flight coarse alignment, IEEE Trans.
Aerospace and Electronic Systems 49(2), 2013.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bench import _alignment_vectors as vectors
from bench.earth import WGS84, Earth
from bench.errors import Array, InputError, ObservabilityError, require_array, require_instance, require_scalar
from bench.rotation import matrix_from_quat, quat_conjugate, quat_multiply, quat_normalize, quat_rotate
from bench.trajectory import NavigationInitial
from bench.units import DEG, DEG_PER_H

LEAST = 64  # increments
BATCHES = 16  # of a stretch at rest, whose means show the scatter


@dataclass(frozen=True, eq=False)
class Alignment:
    """The state at the end of the stretch, and how good it is expected to be (1 sigma).

    Attributes
    ----------
    initial : NavigationInitial
        At the end of the last increment, so that a recording goes on from there; velocity zero.
    sigma_tilt : float, rad
        Of the vertical, each horizontal axis: accelerometer_error / g, and what the gyro's drift tilts it by in half
        the stretch after `inertial_alignment`.
    sigma_heading : float, rad
        gyro_error / (omega_ie cos L) and sigma_tilt tan L ([Britting]); 0 for a yaw that was given.
    gyro_error : float, rad/s
        The largest of scatter, misfit and `gyro_bias`; 0 for a yaw that was given.
    accelerometer_error : float, m/s^2
        The largest of scatter, misfit and `accelerometer_bias`.
    """

    initial: NavigationInitial
    sigma_tilt: float
    sigma_heading: float
    gyro_error: float
    accelerometer_error: float


def coarse_alignment(
    dtheta_b: ArrayLike,
    dvel_b: ArrayLike,
    dt: float,
    latitude: float,
    longitude: float,
    height: float = 0.0,
    earth: Earth = WGS84,
    *,
    psi: float | None = None,
    gyro_bias: float = 0.0,
    accelerometer_bias: float = 0.0,
    heading_limit: float = 6 * DEG,
    wobble: float = 0.3 * DEG,
) -> Alignment:
    """Return the attitude of a unit at rest: mean specific force and mean rate are gravity and the Earth's rate.

    The vertical is that of the specific force alone, the heading that of the rate across it (TRIAD, [Shuster]).

    Parameters
    ----------
    dtheta_b, dvel_b : array_like, shape (n, 3), rad, m/s
        Increments of the stretch, n at least 64.
    dt : float, s
    latitude, longitude, height : float, rad, m
    earth : Earth
    psi : float, rad, or None
        Yaw that is known from elsewhere (anticlockwise, minus the heading); then only the vertical is found. A gyro
        that does not resolve the Earth's rate needs it.
    gyro_bias, accelerometer_bias : float, rad/s, m/s^2
        Expected constant errors of each axis (1 sigma), as a data sheet gives them.
    heading_limit : float, rad
        Largest expected error of the heading that is accepted.
    wobble : float, rad
        Largest rocking that passes for rest, beyond white noise.

    Returns
    -------
    Alignment

    Raises
    ------
    InputError
        If an argument breaks a rule, the mean specific force is not gravity within 5 %, or the unit moves: its angle
        or velocity strays from a uniform course by more than five sigma of white noise and more than `wobble` makes.
        (Constant velocity is not seen.)
    ObservabilityError
        If the expected error of the heading exceeds the limit, or the place is within 0.001 rad of a pole.
    """
    dtheta, dvel, dt = _increments(dtheta_b, dvel_b, dt)
    place = _place(latitude, longitude, height, earth)
    require_scalar("wobble", wobble, minimum=0.0)
    accelerometer_error = require_scalar("accelerometer_bias", accelerometer_bias, minimum=0.0)
    gyro_error = require_scalar("gyro_bias", gyro_bias, minimum=0.0)
    up_n = -earth.gravity_n(place.latitude, place.height)
    g = float(np.linalg.norm(up_n))
    omega_b, f_b = dtheta.mean(axis=0) / dt, dvel.mean(axis=0) / dt
    f = _require_gravity(float(np.linalg.norm(f_b)), g)
    _require_rest("dtheta_b", dtheta, wobble, "rad")
    _require_rest("dvel_b", dvel, wobble * g * len(dvel) * dt / 4, "m/s")
    accelerometer_error = max(accelerometer_error, _scatter(dvel) / dt, abs(f - g))
    if psi is not None:
        q_nb = vectors.level(up_n, f_b, require_scalar("psi", psi))
        return Alignment(_at(place, q_nb), accelerometer_error / g, 0.0, 0.0, accelerometer_error)
    _require_turning(place, earth)
    omega_n = earth.omega_ie_n(place.latitude)
    q_nb = vectors.two_vectors(up_n, omega_n, f_b, omega_b)
    # East is made to fit; up and north show what the gyro errs by.
    misfit = float(np.linalg.norm(quat_rotate(q_nb, omega_b) - omega_n)) / math.sqrt(2)
    gyro_error = max(gyro_error, _scatter(dtheta) / dt, misfit)
    tilt = accelerometer_error / g
    return _expected(_at(place, q_nb), earth, tilt, gyro_error, accelerometer_error, heading_limit)


def inertial_alignment(
    dtheta_b: ArrayLike,
    dvel_b: ArrayLike,
    dt: float,
    latitude: float,
    longitude: float,
    height: float = 0.0,
    earth: Earth = WGS84,
    *,
    gyro_bias: float = 0.0,
    accelerometer_bias: float = 0.0,
    heading_limit: float = 6 * DEG,
) -> Alignment:
    """Return the attitude of a unit that stands or sways in place, from the turning of gravity in inertial space.

    The gyro carries the body's axes back to axes w that do not turn. There the specific force is summed up under
    weights W_k(t) and held against minus gravity at the place, in i: ``C_iw sum_t W_k dv_w = sum_t W_k dv_i``
    ([WuPan]), with C_iw the rotation of least squares (Davenport's q-method [Shuster], refined). The weights are five
    smooth windows, cos^4 over half the stretch: the velocity of a sway cancels within each, if that has several
    periods, where the plain sums of the usual method keep it.

    Parameters
    ----------
    dtheta_b, dvel_b, dt, latitude, longitude, height, earth, gyro_bias, accelerometer_bias, heading_limit
        As for `coarse_alignment`. Of an odd number of increments the first is left out.

    Returns
    -------
    Alignment

    Raises
    ------
    InputError
        If an argument breaks a rule, or the specific force is not gravity within 5 %.
    ObservabilityError
        As `coarse_alignment`; a base that travels ends here too.

    Notes
    -----
    Sway of 0.3 m and 5 deg with periods of 6 to 12 s leaves 3e-3 rad of heading after 60 s and 1e-6 rad after 300 s;
    plain sums leave 1.4 and 0.08 rad. In white noise of the accelerometers the heading scatters 1.6 times as much as
    with plain sums.
    """
    dtheta, dvel, dt = _increments(dtheta_b, dvel_b, dt)
    place = _place(latitude, longitude, height, earth)
    accelerometer_error = require_scalar("accelerometer_bias", accelerometer_bias, minimum=0.0)
    gyro_error = require_scalar("gyro_bias", gyro_bias, minimum=0.0)
    _require_turning(place, earth)
    v_w, q_wb = vectors.still_space(dtheta, dvel, dt)
    T = 2 * dt
    duration = (len(v_w) - 1) * T
    weights, centres = vectors.windows(len(v_w) - 1)
    in_w, in_i = weights @ np.diff(v_w, axis=0), vectors.force_sums(earth, place, weights, T)
    whitening = vectors.whitening(weights)
    q_iw, scale, covariance = vectors.least_squares_rotation(whitening @ in_i, whitening @ in_w)
    g = float(np.linalg.norm(earth.gravity_n(place.latitude, place.height)))
    f = _require_gravity(g / scale, g)
    q_in = quat_multiply(earth.q_ie(duration), earth.q_en(place.latitude, place.longitude))
    q_nb = quat_multiply(quat_conjugate(q_in), quat_multiply(q_iw, q_wb))
    C_in = matrix_from_quat(q_in)
    east, north, up = np.sqrt(np.diag(C_in.T @ covariance @ C_in))
    off = (in_i - scale * quat_rotate(q_iw, in_w)) / (weights.sum(axis=1, keepdims=True) * T)
    drift = abs(vectors.drift_about_north(earth, place, centres * duration, off))
    accelerometer_error = max(accelerometer_error, g * float(np.hypot(east, north)) / math.sqrt(2), abs(f - g))
    tilt = math.hypot(accelerometer_error / g, max(gyro_error, drift) * duration / 2)
    gyro_error = max(gyro_error, float(up) * _level_rate(place, earth), drift)
    return _expected(_at(place, q_nb), earth, tilt, gyro_error, accelerometer_error, heading_limit)


def _increments(dtheta_b: ArrayLike, dvel_b: ArrayLike, dt: float) -> tuple[Array, Array, float]:
    dtheta = require_array("dtheta_b", dtheta_b, (None, 3))
    dvel = require_array("dvel_b", dvel_b, (len(dtheta), 3))
    if len(dtheta) < LEAST:
        raise InputError(f"dtheta_b must have at least {LEAST} increments, got {len(dtheta)}")
    return dtheta, dvel, require_scalar("dt", dt, positive=True)


def _place(latitude: float, longitude: float, height: float, earth: Earth) -> NavigationInitial:
    require_instance("earth", earth, Earth)
    return NavigationInitial(latitude=latitude, longitude=longitude, height=height)


def _require_gravity(f: float, g: float) -> float:
    if abs(f / g - 1) > 0.05:
        raise InputError(
            f"dvel_b must hold the increments (m/s) of a unit that stays in place: its mean specific force is "
            f"{f:.6g} m/s^2, gravity there is {g:.6g} (another unit, rates instead of increments, or another dt?)"
        )
    return f


def _require_rest(name: str, increments: Array, allowed: float, unit: str) -> None:
    """Check that the sum of the increments keeps to a straight line, but for white noise and what is allowed."""
    away = np.abs(np.cumsum(increments - increments.mean(axis=0), axis=0)).max(axis=0)
    # Successive differences show the noise whatever the motion; its sum strays by half sigma sqrt(n) midway.
    noise = np.sqrt((np.diff(increments, axis=0) ** 2).mean(axis=0) / 2)
    limit = np.maximum(2.5 * noise * math.sqrt(len(increments)), allowed)
    if (away > limit).any():
        k = int(np.argmax(away / limit))
        raise InputError(
            f"{name} must be of a unit at rest: its sum along {'xyz'[k]} strays {away[k]:.3g} {unit} from a uniform "
            f"course, white noise and the wobble allow {limit[k]:.3g} {unit}; take a steadier stretch, or "
            "inertial_alignment for a base that sways"
        )


def _scatter(increments: Array) -> float:
    """Return the standard error of the mean of an axis, from the means of batches: right for slow noise too."""
    means = np.array([batch.mean(axis=0) for batch in np.array_split(increments, BATCHES)])
    return float(np.sqrt(means.var(axis=0, ddof=1).mean() / BATCHES))


def _level_rate(place: NavigationInitial, earth: Earth) -> float:
    return abs(earth.rate) * math.cos(place.latitude)


def _require_turning(place: NavigationInitial, earth: Earth) -> None:
    if _level_rate(place, earth) < 1e-3 * WGS84.rate:
        raise ObservabilityError(
            "the heading cannot be found where the Earth does not turn about north: latitude "
            f"{place.latitude / DEG:.6g} deg, rate {earth.rate:.6g} rad/s; coarse_alignment takes a known yaw as psi"
        )


def _at(place: NavigationInitial, q_nb: Array) -> NavigationInitial:
    q_nb = quat_normalize(q_nb)
    return NavigationInitial(q_nb, latitude=place.latitude, longitude=place.longitude, height=place.height)


def _expected(
    initial: NavigationInitial,
    earth: Earth,
    tilt: float,
    gyro_error: float,
    accelerometer_error: float,
    heading_limit: float,
) -> Alignment:
    """Return the alignment if its heading is good enough."""
    require_scalar("heading_limit", heading_limit, positive=True)
    heading = math.hypot(gyro_error / _level_rate(initial, earth), tilt * math.tan(initial.latitude))
    if heading > heading_limit:
        raise ObservabilityError(
            f"the heading cannot be found: expected error {heading / DEG:.3g} deg (1 sigma), heading_limit "
            f"{heading_limit / DEG:.3g} deg; rates err by {gyro_error / DEG_PER_H:.3g} deg/h (gyro or base), where the "
            f"Earth turns {_level_rate(initial, earth) / DEG_PER_H:.3g} deg/h about north; take a longer or steadier "
            "stretch, inertial_alignment for a base that sways, or give coarse_alignment a known yaw as psi"
        )
    return Alignment(initial, tilt, heading, gyro_error, accelerometer_error)
