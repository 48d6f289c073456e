"""Circular: the body origin runs round a circle ever faster while the body turns at a constant rate."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import Array, require_array, require_scalar
from bench.motion import STANDARD, Motion
from bench.motion._options import IDENTITY, STILL, Quaternion, Vector, as_quaternion, as_vector, set_options
from bench.motion._waves import columns, turn
from bench.references import QIN, Source
from bench.signals import Kinematics


@dataclass(frozen=True)
class Circular(Motion):
    """Circular: anticlockwise in the xy plane of i from (radius, 0, 0), the body turning at its own constant rate.

    The angle on the circle is u = angular_rate t + angular_acceleration t^2 / 2; the attitude is
    q_ib o exp(omega t / 2), independent of it. The defaults are the conditions of [Qin], section 2.

    Parameters
    ----------
    radius : float, m
        Of the circle about the origin of i, > 0.
    angular_rate : float, rad/s
        On the circle, at t = 0.
    angular_acceleration : float, rad/s^2
        On the circle, constant.
    omega_ib_b : tuple of 3 floats, rad/s
        Angular rate of the body, in b, constant.
    q_ib : tuple of 4 floats
        Attitude at t = 0, b to i, wxyz, unit.
    gravity : tuple of 3 floats, m/s^2
        Gravitational acceleration, in i.

    Raises
    ------
    InputError
        If an option is not finite, has another shape, the radius is not positive, or q_ib is not unit.
    """

    name: ClassVar[str] = "circular"
    source: ClassVar[Source] = QIN.at("section 2")

    radius: float = 10.0
    angular_rate: float = 0.0
    angular_acceleration: float = 0.01
    omega_ib_b: Vector = (2.0, 2.0, 2.0)
    q_ib: Quaternion = IDENTITY
    gravity: Vector = STANDARD

    def __post_init__(self) -> None:
        set_options(
            self,
            radius=require_scalar("radius", self.radius, positive=True),
            angular_rate=require_scalar("angular_rate", self.angular_rate),
            angular_acceleration=require_scalar("angular_acceleration", self.angular_acceleration),
            omega_ib_b=as_vector("omega_ib_b", self.omega_ib_b),
            q_ib=as_quaternion("q_ib", self.q_ib),
            gravity=as_vector("gravity", self.gravity),
        )

    def kinematics(self, t: Array) -> Kinematics:
        """Return the true kinematics at times t, shape (n,), s."""
        t = require_array("t", t, (None,))
        rate = self.angular_rate + self.angular_acceleration * t
        angle = (self.angular_rate + 0.5 * self.angular_acceleration * t) * t
        x, y = self.radius * np.cos(angle), self.radius * np.sin(angle)
        square, gain = rate * rate, self.angular_acceleration
        return Kinematics(
            position=columns(x, y, 0.0),
            velocity=columns(-rate * y, rate * x, 0.0),
            acceleration=columns(-square * x - gain * y, gain * x - square * y, 0.0),
            q_ib=turn(self.omega_ib_b, self.q_ib, t),
            omega_ib_b=np.array(self.omega_ib_b),
            alpha_ib_b=STILL,
            gravity=np.array(self.gravity),
        )
