"""Rest: the body stands still in the inertial frame; its sensors feel gravity alone."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import Array, require_array
from bench.motion import STANDARD, Motion
from bench.motion._options import IDENTITY, ORIGIN, STILL, Quaternion, Vector, as_quaternion, as_vector, set_options
from bench.signals import Kinematics


@dataclass(frozen=True)
class Rest(Motion):
    """Rest: fixed attitude and position.

    Parameters
    ----------
    q_ib : tuple of 4 floats
        Attitude, b to i, wxyz, unit.
    position : tuple of 3 floats, m
        Of the body origin, in i.
    gravity : tuple of 3 floats, m/s^2
        Gravitational acceleration, in i.

    Raises
    ------
    InputError
        If an option is not finite, has another shape, or q_ib is not unit.
    """

    name: ClassVar[str] = "rest"

    q_ib: Quaternion = IDENTITY
    position: Vector = ORIGIN
    gravity: Vector = STANDARD

    def __post_init__(self) -> None:
        set_options(
            self,
            q_ib=as_quaternion("q_ib", self.q_ib),
            position=as_vector("position", self.position),
            gravity=as_vector("gravity", self.gravity),
        )

    def kinematics(self, t: Array) -> Kinematics:
        """Return the true kinematics at times t, shape (n,), s."""
        t = require_array("t", t, (None,))
        return Kinematics(
            position=np.repeat([self.position], len(t), axis=0),
            velocity=STILL,
            acceleration=STILL,
            q_ib=np.array(self.q_ib),
            omega_ib_b=STILL,
            alpha_ib_b=STILL,
            gravity=np.array(self.gravity),
        )
