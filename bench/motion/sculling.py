"""Sculling: the standard test of velocity algorithms, an angular and a linear oscillation in phase."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import Array, InputError, require_array, require_choice, require_scalar
from bench.motion import STANDARD, Motion
from bench.motion._options import IDENTITY, ORIGIN, Quaternion, Vector, as_quaternion, as_vector, set_options
from bench.motion._waves import columns, sincos
from bench.rotation import quat_multiply, quat_rotate
from bench.signals import Kinematics
from bench.units import DEG

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True)
class Sculling(Motion):
    """Sculling: angular oscillation about one body axis, in phase with a linear one along another.

    With the angular axis k and the linear axis l, u = angular_frequency t,
    q = q_ib o exp(A sin(u) k / 2) and position = p + D sin(u) C_ib l, where C_ib is the mean attitude.
    The body does not go anywhere, yet its specific force without gravity has the mean
    D w^2 J1(A) k x l in b, about A D w^2 / 2: the rectified acceleration that an algorithm which sums
    up body-frame velocity increments without sculling correction takes for a motion.

    Parameters
    ----------
    angle_amplitude : float, rad
        A, >= 0.
    linear_amplitude : float, m
        D, >= 0.
    angular_frequency : float, rad/s
        w, of both oscillations, > 0.
    angular_axis, linear_axis : {"x", "y", "z"}
        Body axes k and l; two different ones.
    q_ib : tuple of 4 floats
        Mean attitude, b to i, wxyz, unit.
    position : tuple of 3 floats, m
        Mean position p of the body origin, in i.
    gravity : tuple of 3 floats, m/s^2
        Gravitational acceleration, in i.

    Raises
    ------
    InputError
        If an option is not finite, out of range, has another shape, or the two axes are the same.
    """

    name: ClassVar[str] = "sculling"

    angle_amplitude: float = 1 * DEG
    linear_amplitude: float = 0.01
    angular_frequency: float = 20 * math.pi
    angular_axis: str = "x"
    linear_axis: str = "y"
    q_ib: Quaternion = IDENTITY
    position: Vector = ORIGIN
    gravity: Vector = STANDARD

    def __post_init__(self) -> None:
        set_options(
            self,
            angle_amplitude=require_scalar("angle_amplitude", self.angle_amplitude, minimum=0.0),
            linear_amplitude=require_scalar("linear_amplitude", self.linear_amplitude, minimum=0.0),
            angular_frequency=require_scalar("angular_frequency", self.angular_frequency, positive=True),
            angular_axis=require_choice("angular_axis", self.angular_axis, AXES),
            linear_axis=require_choice("linear_axis", self.linear_axis, AXES),
            q_ib=as_quaternion("q_ib", self.q_ib),
            position=as_vector("position", self.position),
            gravity=as_vector("gravity", self.gravity),
        )
        if self.angular_axis == self.linear_axis:
            raise InputError(f"linear_axis must differ from angular_axis, got {self.linear_axis!r} for both")

    def kinematics(self, t: Array) -> Kinematics:
        """Return the true kinematics at times t, shape (n,), s."""
        w, axis = self.angular_frequency, np.array(AXES[self.angular_axis])
        sine, cosine = sincos(w, require_array("t", t, (None,)))
        half = 0.5 * self.angle_amplitude * sine
        half_sine = np.sin(half)
        swing = columns(np.cos(half), *(component * half_sine for component in axis))
        path = self.linear_amplitude * quat_rotate(self.q_ib, AXES[self.linear_axis])
        rate = self.angle_amplitude * w
        return Kinematics(
            position=np.array(self.position) + sine[:, None] * path,
            velocity=cosine[:, None] * (w * path),
            acceleration=sine[:, None] * (-w * w * path),
            q_ib=quat_multiply(self.q_ib, swing),
            omega_ib_b=cosine[:, None] * (rate * axis),
            alpha_ib_b=sine[:, None] * (-w * rate * axis),
            gravity=np.array(self.gravity),
        )
