"""What is attainable: the Cramer-Rao bound of the angular rate from one reading of an accelerometer array."""

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, InputError, require_array
from bench.rotation import cross
from bench.signals import Accelerometers

_NO_INFORMATION = 1e-12  # relative to the information that f and alpha known would leave: rounding is 1e-16


def _stds(name: str, value: ArrayLike, count: int | None) -> Array:
    """Return positive standard deviations, one number standing for all channels."""
    stds = require_array(name, np.atleast_1d(np.asarray(value)), (None,))
    if (stds <= 0).any():
        raise InputError(f"{name} must be positive, got {stds[stds <= 0][0]!r}")
    if count is not None and len(stds) not in (1, count):
        raise InputError(f"{name} must be one number or {count}, one per channel, got {len(stds)}")
    return stds


def _rows(omega: ArrayLike) -> Array:
    array = np.asarray(omega)
    return require_array("omega", array[np.newaxis] if array.ndim == 1 else array, (None, 3))


def _information(accelerometers: Accelerometers, omega: Array, accelerometer_std: ArrayLike) -> tuple[Array, Array]:
    """Return J'P J / s^2, and the trace of J'J / s^2 as its scale, for rows of omega."""
    s = _stds("accelerometer_std", accelerometer_std, len(accelerometers))[:, np.newaxis]
    d = accelerometers.direction
    # About the centroid P removes the same columns, and keeps more digits.
    r = accelerometers.position - accelerometers.position.mean(axis=0)
    w = omega[:, np.newaxis]
    # d . (-[omega x r]x - [omega]x [r]x) as a row vector.
    J = (-cross(d, cross(w, r)) - cross(cross(d, w), r)) / s
    radius = np.sqrt((r * r).sum(axis=1).mean()) or 1.0
    U, singular, _ = np.linalg.svd(np.hstack([d, cross(r, d) / radius]) / s, full_matrices=False)
    U = U[:, singular > 1e-9 * singular[0]]
    projected = J - U @ (U.T @ J)
    return np.swapaxes(projected, -1, -2) @ projected, (J * J).sum(axis=(-1, -2))


def array_information(
    accelerometers: Accelerometers,
    omega: ArrayLike,
    accelerometer_std: ArrayLike,
    gyro_std: ArrayLike | None = None,
) -> Array:
    """Return the Fisher information on the rate from one reading, f and alpha being unknown.

    I = J'P J / s^2 + sum of 1/s_g^2, with J the derivative of the readings with respect to omega and P the
    projector off what f and alpha can explain.

    Parameters
    ----------
    accelerometers : Accelerometers
    omega : array_like, shape (3,) or (n, 3), rad/s
        True rate, in b.
    accelerometer_std : float or array_like, shape (m,), m/s^2
        Standard deviation of the noise of one reading; one number or one per channel.
    gyro_std : float or array_like, shape (g,), rad/s, optional
        One for each gyro triad that is read as well.

    Returns
    -------
    ndarray, shape (3, 3) or (n, 3, 3), s^2/rad^2

    Raises
    ------
    InputError
        If an argument has another shape, or a standard deviation is not positive.

    References
    ----------
    [Skog] Skog, Nilsson, Handel, Nehorai, Inertial sensor arrays, maximum likelihood, and Cramer-Rao bound, 2016.
    """
    information, _ = _information(accelerometers, _rows(omega), accelerometer_std)
    information = information + _gyro_information(gyro_std) * np.eye(3)
    return information if np.ndim(omega) == 2 else information[0]


def _gyro_information(gyro_std: ArrayLike | None) -> float:
    return 0.0 if gyro_std is None else float((_stds("gyro_std", gyro_std, None) ** -2.0).sum())


def cramer_rao_std(
    accelerometers: Accelerometers,
    omega: ArrayLike,
    accelerometer_std: ArrayLike,
    gyro_std: ArrayLike | None = None,
) -> Array:
    """Return the least standard deviation of each rate that an unbiased estimate from one reading can have.

    Parameters are those of `array_information`. An axis on which there is no information (its rate cannot be told
    to first order, as a zero rate from its square) gets infinity; the others get what the pseudo-inverse says.

    Returns
    -------
    ndarray, shape (3,) or (n, 3), rad/s

    Raises
    ------
    InputError
        As `array_information`.
    """
    information, scale = _information(accelerometers, _rows(omega), accelerometer_std)
    gyro = _gyro_information(gyro_std)
    values, vectors = np.linalg.eigh(information + gyro * np.eye(3))
    seen = values > _NO_INFORMATION * (scale + gyro)[:, np.newaxis]
    inverse = np.where(seen, 1.0 / np.where(seen, values, 1.0), 0.0)
    variance = (vectors**2 * inverse[:, np.newaxis]).sum(axis=-1)
    # An axis that leans on an unseen direction by more than rounding is lost.
    lost = (vectors**2 * ~seen[:, np.newaxis]).sum(axis=-1) > 1e-12
    std = np.where(lost, np.inf, np.sqrt(variance))
    return std if np.ndim(omega) == 2 else std[0]
