"""Spline: a smooth motion through recorded poses or waypoints, with the exact derivatives of the curve."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from bench.errors import Array, require_array, require_unit_quaternion
from bench.motion import STANDARD, Motion
from bench.motion._options import IDENTITY, ORIGIN, Vector, as_vector, require_within, set_options
from bench.motion._spline_curve import continuous, quintic, require_knots, turning
from bench.signals import Kinematics

if TYPE_CHECKING:
    from scipy.interpolate import BSpline


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
        t = require_knots("t", self.t)  # copies: the caller may go on using the arrays
        position = None if self.position is None else require_array("position", self.position, (len(t), 3)).copy()
        q_ib = self.q_ib
        if q_ib is not None:
            q_ib = continuous("q_ib", t, require_unit_quaternion("q_ib", q_ib, (len(t), 4)))
        set_options(self, t=t, position=position, q_ib=q_ib, gravity=as_vector("gravity", self.gravity))

    @cached_property
    def _splines(self) -> "tuple[BSpline, ...]":
        """The spline through (position, quaternion), one after the other in seven columns, and its two derivatives."""
        n = len(self.t)
        position = np.repeat([ORIGIN], n, axis=0) if self.position is None else self.position
        q_ib = np.repeat([IDENTITY], n, axis=0) if self.q_ib is None else self.q_ib
        return quintic(self.t, np.hstack([position, q_ib]), 2)

    def kinematics(self, t: Array) -> Kinematics:
        """Return the true kinematics at times t, shape (n,), s."""
        t = require_within(t, (float(self.t[0]), float(self.t[-1])))
        value, first, second = (spline(t) for spline in self._splines)
        q_ib, omega_ib_b, alpha_ib_b = turning(value[:, 3:], first[:, 3:], second[:, 3:])
        return Kinematics(
            position=value[:, :3],
            velocity=first[:, :3],
            acceleration=second[:, :3],
            q_ib=q_ib,
            omega_ib_b=omega_ib_b,
            alpha_ib_b=alpha_ib_b,
            gravity=np.array(self.gravity),
        )
