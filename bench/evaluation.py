"""Estimates against truth: errors of attitude, rate, velocity and position, and their statistics over trials."""

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, InputError, require_array, require_integer, require_scalar, require_unit_quaternion
from bench.rotation import euler_from_quat, quat_conjugate, quat_multiply, rotvec_from_quat, wrap


def _same_length(names: tuple[str, str], a: Array, b: Array) -> None:
    if a.shape != b.shape:
        raise InputError(f"{names[0]} and {names[1]} must have the same shape, got {a.shape} and {b.shape}")


def _pair(names: tuple[str, str], width: int, a: ArrayLike, b: ArrayLike) -> tuple[Array, Array]:
    check = require_unit_quaternion if width == 4 else require_array
    first, second = check(names[0], a, (None, width)), check(names[1], b, (None, width))
    _same_length(names, first, second)
    return first, second


def attitude_error(q_est: ArrayLike, q_true: ArrayLike) -> Array:
    """Return the rotation that takes the true attitude to the estimate, as a rotation vector.

    Parameters
    ----------
    q_est, q_true : array_like, shape (n, 4)
        Unit quaternions wxyz, b to n (or to i).

    Returns
    -------
    ndarray, shape (n, 3), rad
        Rotation vector of q_est o q_true*, in n; its length is the angle, at most pi.

    Raises
    ------
    InputError
        If the shapes differ or a quaternion is not unit.
    """
    q_est, q_true = _pair(("q_est", "q_true"), 4, q_est, q_true)
    return rotvec_from_quat(quat_multiply(q_est, quat_conjugate(q_true)))


def euler_error(q_est: ArrayLike, q_true: ArrayLike) -> Array:
    """Return estimated minus true yaw, pitch and roll, each wrapped to (-pi, pi], shape (n, 3), rad.

    Near pitch +-90 degrees yaw and roll are not defined apart, and their errors are large where `attitude_error`
    is small.

    Raises
    ------
    InputError
        If the shapes differ or a quaternion is not unit.
    """
    q_est, q_true = _pair(("q_est", "q_true"), 4, q_est, q_true)
    return wrap(np.stack(euler_from_quat(q_est), axis=1) - np.stack(euler_from_quat(q_true), axis=1))


def integrated_rate_error(omega_est: ArrayLike, omega_true: ArrayLike, dt: float) -> Array:
    """Return the integral of the rate error on each body axis from the first sample (trapezoidal).

    It is an attitude error only as long as the body hardly turns; papers report it as one.

    Parameters
    ----------
    omega_est, omega_true : array_like, shape (n, 3), rad/s
    dt : float, s

    Returns
    -------
    ndarray, shape (n, 3), rad

    Raises
    ------
    InputError
        If the shapes differ or dt is not positive.
    """
    dt = require_scalar("dt", dt, positive=True)
    omega_est, omega_true = _pair(("omega_est", "omega_true"), 3, omega_est, omega_true)
    error = omega_est - omega_true
    integral = np.zeros_like(error)
    np.cumsum(0.5 * dt * (error[1:] + error[:-1]), axis=0, out=integral[1:])
    return integral


def vector_error(estimate: ArrayLike, truth: ArrayLike) -> Array:
    """Return estimate - truth of velocities or positions, shape (n, 3).

    Raises
    ------
    InputError
        If the shapes differ.
    """
    estimate, truth = _pair(("estimate", "truth"), 3, estimate, truth)
    return estimate - truth


def _numbers(name: str, value: ArrayLike) -> Array:
    return require_array(name, np.atleast_1d(np.asarray(value)), (None,) * max(1, np.ndim(value)))


def rms(values: ArrayLike) -> Array:
    """Return the root mean square over the first axis; shape (n, ...) to (...).

    Raises
    ------
    InputError
        If there are no values or one is not finite.
    """
    values = _numbers("values", values)
    # Scaled, so that the squares of extreme values neither overflow nor vanish.
    largest = np.abs(values).max(axis=0)
    scale = np.where(largest > 0, largest, 1.0)
    return scale * np.sqrt(((values / scale) ** 2).mean(axis=0))


def percentiles(values: ArrayLike, levels: ArrayLike) -> Array:
    """Return percentiles over the first axis (trials), linear between order statistics.

    Parameters
    ----------
    values : array_like, shape (trials, ...)
    levels : array_like, shape (k,) or float
        In percent, 0 to 100.

    Returns
    -------
    ndarray, shape (k, ...), or (...) for one level

    Raises
    ------
    InputError
        If a level is outside 0 to 100, or there are no values or one is not finite.
    """
    checked = _numbers("levels", levels)
    if (checked < 0).any() or (checked > 100).any():
        raise InputError(f"levels must be percentages from 0 to 100, got {levels!r}")
    return np.asarray(np.percentile(_numbers("values", values), checked.reshape(np.shape(levels)), axis=0))


def percentile_of(published: ArrayLike, samples: ArrayLike) -> Array:
    """Return where a published number stands among samples: the fraction below, those equal counting half.

    Parameters
    ----------
    published : array_like, shape (...)
    samples : array_like, shape (trials, ...)

    Returns
    -------
    ndarray, shape (...)
        From 0 (below all samples) to 1 (above all).

    Raises
    ------
    InputError
        If the shapes do not fit, or there are no samples or one is not finite.
    """
    samples = _numbers("samples", samples)
    value = _numbers("published", published).reshape(np.shape(published))
    if value.shape != samples.shape[1:]:
        raise InputError(f"published must have shape {samples.shape[1:]} like one sample, got {value.shape}")
    return np.asarray((samples < value).mean(axis=0) + 0.5 * (samples == value).mean(axis=0))


def nees(errors: ArrayLike, covariance: ArrayLike) -> Array:
    """Return e^T P^-1 e of each row: the errors squared, normalised by the covariance that an estimator claims.

    Of a consistent estimator with normal errors it is chi-square of k degrees, its mean k. With an innovation and its
    predicted covariance it is the NIS.

    Parameters
    ----------
    errors : array_like, shape (n, k)
    covariance : array_like, shape (n, k, k)
        Symmetric, positive definite.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    InputError
        If the shapes do not fit, a value is not finite, or a covariance is not symmetric and positive definite.
    """
    errors = require_array("errors", errors, (None, None))
    n, k = errors.shape
    P = require_array("covariance", covariance, (n, k, k))
    # In units of the standard deviations, since the states' own units differ by many powers of ten.
    variance = np.diagonal(P, axis1=1, axis2=2)
    if not (variance > 0).all():
        raise InputError(f"covariance must be positive definite, got a variance of {variance.min():g}")
    scale = np.sqrt(variance)
    correlation = P / (scale[:, :, None] * scale[:, None, :])
    if (skew := np.abs(correlation - np.swapaxes(correlation, 1, 2)).max()) > 1e-9:
        raise InputError(f"covariance must be symmetric, correlations differ by {skew:g}")
    try:
        root = np.linalg.cholesky(correlation)
    except np.linalg.LinAlgError:
        raise InputError("covariance must be positive definite, one is not") from None
    white = np.linalg.solve(root, (errors / scale)[:, :, None])[:, :, 0]
    return np.asarray((white * white).sum(axis=1))


def chi_square_bounds(degrees: int, trials: int = 1, level: float = 0.95) -> tuple[float, float]:
    """Return the two-sided bounds of a mean of NEES or NIS over independent trials, if the estimator is consistent.

    Parameters
    ----------
    degrees : int
        Of one value: the number of states or of measured components.
    trials : int
        Independent values in the mean; those along one run are not.
    level : float
        Probability of lying between the bounds, half of the rest on either side.

    Raises
    ------
    InputError
        If a number is below 1, or the level is not between 0 and 1.
    """
    from scipy.stats import chi2

    total = require_integer("degrees", degrees, minimum=1) * require_integer("trials", trials, minimum=1)
    if not 0.0 < require_scalar("level", level) < 1.0:
        raise InputError(f"level must be between 0 and 1, got {level!r}")
    return float(chi2.ppf(0.5 * (1 - level), total)) / trials, float(chi2.ppf(0.5 * (1 + level), total)) / trials
