"""Spline: a smooth motion through recorded poses or waypoints, with the exact derivatives of the curve."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from bench.errors import Array, InputError, require_array, require_times, require_unit_quaternion
from bench.motion import STANDARD, Motion
from bench.motion._options import IDENTITY, ORIGIN, Vector, as_vector, require_within, set_options
from bench.rotation import quat_conjugate, quat_multiply
from bench.signals import Kinematics
from bench.units import DEG

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

DEGREE = 5
LARGEST_TURN = 90 * DEG  # between two poses; beyond it the way round is anybody's guess


@dataclass(frozen=True, eq=False)
class Spline(Motion):
    """Spline: interpolating quintics through the positions and through the sign-continuous quaternions.

    With s the quintic through the components, q = s/|s|, omega = 2 Im(s* o s')/|s|^2 and alpha its
    derivative, all in closed form. The splines are C4, so the acceleration is C2 and the angular rate C3.
    A spline interpolates: noise in the poses goes, amplified, into rate and acceleration.

    Parameters
    ----------
    t : array_like, shape (n,), s
        Times of the poses, strictly increasing, n >= 6; they are the motion's span.
    position : array_like, shape (n, 3), m, optional
        Of the body origin, in i. Without it: at rest at the origin.
    q_ib : array_like, shape (n, 4), optional
        Attitudes, b to i, wxyz, unit, either sign, less than 90 degrees from one to the next. Without it: identity.
    gravity : tuple of 3 floats, m/s^2
        Gravitational acceleration, in i.

    Raises
    ------
    InputError
        If an array has another shape or is not finite, the times do not increase, there are fewer than 6, a
        quaternion is not unit, or consecutive attitudes lie too far apart; in use, if a time lies outside the span.
    """

    name: ClassVar[str] = "spline"

    t: Array
    position: Array | None = None
    q_ib: Array | None = None
    gravity: Vector = STANDARD

    def __post_init__(self) -> None:
        t = require_times("t", self.t).copy()  # copies: the caller may go on using the arrays
        if len(t) < DEGREE + 1:
            raise InputError(f"t must hold at least {DEGREE + 1} times for a quintic spline, got {len(t)}")
        position = None if self.position is None else require_array("position", self.position, (len(t), 3)).copy()
        q_ib = None if self.q_ib is None else _continuous(t, require_unit_quaternion("q_ib", self.q_ib, (len(t), 4)))
        set_options(self, t=t, position=position, q_ib=q_ib, gravity=as_vector("gravity", self.gravity))

    @cached_property
    def _splines(self) -> "tuple[BSpline, BSpline, BSpline]":
        """The spline through (position, quaternion), one after the other in seven columns, and its two derivatives."""
        from scipy.interpolate import make_interp_spline

        n = len(self.t)
        position = np.repeat([ORIGIN], n, axis=0) if self.position is None else self.position
        q_ib = np.repeat([IDENTITY], n, axis=0) if self.q_ib is None else self.q_ib
        spline = make_interp_spline(self.t, np.hstack([position, q_ib]), k=DEGREE)
        return spline, spline.derivative(), spline.derivative(2)

    def kinematics(self, t: Array) -> Kinematics:
        """Return the true kinematics at times t, shape (n,), s."""
        t = require_within(t, (float(self.t[0]), float(self.t[-1])))
        value, first, second = (spline(t) for spline in self._splines)
        s, ds, dds = value[:, 3:], first[:, 3:], second[:, 3:]
        square = (s * s).sum(axis=1, keepdims=True)
        dsquare = 2 * (s * ds).sum(axis=1, keepdims=True)
        conjugate = quat_conjugate(s)
        omega = (2 / square) * quat_multiply(conjugate, ds)[:, 1:]
        # Im(s* o s') has the derivative Im(s* o s''), as s'* o s' is a number.
        alpha = (2 / square) * quat_multiply(conjugate, dds)[:, 1:] - (dsquare / square) * omega
        return Kinematics(
            position=value[:, :3],
            velocity=first[:, :3],
            acceleration=second[:, :3],
            q_ib=s / np.sqrt(square),
            omega_ib_b=omega,
            alpha_ib_b=alpha,
            gravity=np.array(self.gravity),
        )


def _continuous(t: Array, q: Array) -> Array:
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
            f"q_ib must turn by at most {LARGEST_TURN / DEG:g} deg from one pose to the next, got "
            f"{turn[k] / DEG:.4g} deg from t = {t[k]} to {t[k + 1]} s"
        )
    return q * np.cumprod(np.append(1.0, np.where(cosine < 0, -1.0, 1.0)))[:, None]
