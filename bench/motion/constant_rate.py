"""Constant rate: the body turns at a constant body rate and moves uniformly."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import Array, require_array
from bench.motion import STANDARD, Motion
from bench.motion._options import IDENTITY, ORIGIN, STILL, Quaternion, Vector, as_quaternion, as_vector, set_options
from bench.motion._waves import turn
from bench.signals import Kinematics


@dataclass(frozen=True)
class ConstantRate(Motion):
    """Constant rate: q = q_ib o exp(omega t / 2), position = p + v t.

    Parameters
    ----------
    omega_ib_b : tuple of 3 floats, rad/s
        Angular rate, in b.
    q_ib : tuple of 4 floats
        Attitude at t = 0, b to i, wxyz, unit.
    velocity, position : tuple of 3 floats, m/s, m
        Of the body origin at t = 0, in i.
    gravity : tuple of 3 floats, m/s^2
        Gravitational acceleration, in i.

    Raises
    ------
    InputError
        If an option is not finite, has another shape, or q_ib is not unit.
    """

    name: ClassVar[str] = "constant-rate"

    omega_ib_b: Vector = (0.0, 0.0, 1.0)
    q_ib: Quaternion = IDENTITY
    velocity: Vector = ORIGIN
    position: Vector = ORIGIN
    gravity: Vector = STANDARD

    def __post_init__(self) -> None:
        set_options(
            self,
            omega_ib_b=as_vector("omega_ib_b", self.omega_ib_b),
            q_ib=as_quaternion("q_ib", self.q_ib),
            velocity=as_vector("velocity", self.velocity),
            position=as_vector("position", self.position),
            gravity=as_vector("gravity", self.gravity),
        )

    def kinematics(self, t: Array) -> Kinematics:
        """Return the true kinematics at times t, shape (n,), s."""
        t = require_array("t", t, (None,))
        return Kinematics(
            position=np.array(self.position) + t[:, None] * np.array(self.velocity),
            velocity=np.array(self.velocity),
            acceleration=STILL,
            q_ib=turn(self.omega_ib_b, self.q_ib, t),
            omega_ib_b=np.array(self.omega_ib_b),
            alpha_ib_b=STILL,
            gravity=np.array(self.gravity),
        )
