"""Interpolating quintics through positions and attitudes, with their exact derivatives: what recorded motions share."""

from typing import TYPE_CHECKING

import numpy as np

from bench.errors import Array, InputError, require_times
from bench.rotation import quat_conjugate, quat_multiply
from bench.units import DEG

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

DEGREE = 5
LARGEST_TURN = 90 * DEG  # between two poses; beyond it the way round is anybody's guess


def require_knots(name: str, t: Array) -> Array:
    """Return a copy of strictly increasing times, enough for a quintic.

    Raises
    ------
    InputError
        As `require_times`, or if there are fewer than 6.
    """
    t = require_times(name, t).copy()
    if len(t) < DEGREE + 1:
        raise InputError(f"{name} must hold at least {DEGREE + 1} times for a quintic spline, got {len(t)}")
    return t


def quintic(t: Array, rows: Array, derivatives: int) -> "tuple[BSpline, ...]":
    """Return the spline through the rows (n, k) and its first derivatives, as many as asked for."""
    from scipy.interpolate import make_interp_spline

    spline = make_interp_spline(t, rows, k=DEGREE)
    return spline, *(spline.derivative(order) for order in range(1, derivatives + 1))


def turning(s: Array, ds: Array, dds: Array) -> tuple[Array, Array, Array]:
    """Return q = s/|s|, its body rate and the derivative of that, from a curve of quaternions and its derivatives.

    omega = 2 Im(s* o s')/|s|^2.
    """
    square = (s * s).sum(axis=1, keepdims=True)
    dsquare = 2 * (s * ds).sum(axis=1, keepdims=True)
    conjugate = quat_conjugate(s)
    omega = (2 / square) * quat_multiply(conjugate, ds)[:, 1:]
    # Im(s* o s') has the derivative Im(s* o s''), as s'* o s' is a number.
    alpha = (2 / square) * quat_multiply(conjugate, dds)[:, 1:] - (dsquare / square) * omega
    return s / np.sqrt(square), omega, alpha


def continuous(name: str, t: Array, q: Array) -> Array:
    """Return the quaternions with signs such that neighbours are close, shape (n, 4).

    Raises
    ------
    InputError
        If two consecutive attitudes are more than `LARGEST_TURN` apart.
    """
    cosine = (q[1:] * q[:-1]).sum(axis=1)
    turn = 2 * np.arccos(np.clip(np.abs(cosine), 0.0, 1.0))
    if (turn > LARGEST_TURN).any():
        k = int(np.argmax(turn > LARGEST_TURN))
        raise InputError(
            f"{name} must turn by at most {LARGEST_TURN / DEG:g} deg from one pose to the next, got "
            f"{turn[k] / DEG:.4g} deg from t = {t[k]} to {t[k + 1]} s"
        )
    return q * np.cumprod(np.append(1.0, np.where(cosine < 0, -1.0, 1.0)))[:, None]
