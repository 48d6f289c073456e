"""Coning: the standard test of attitude algorithms, with closed forms for attitude, rate and increments."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import Array, InputError, require_array, require_integer, require_scalar
from bench.motion import STANDARD, Motion
from bench.motion._options import ORIGIN, STILL, Vector, as_vector, set_options
from bench.motion._waves import columns, sincos
from bench.references import XU, Source
from bench.signals import Kinematics
from bench.units import DEG


@dataclass(frozen=True)
class Coning(Motion):
    """Coning: the body z axis runs round a cone, and the body never turns about it relative to the cone.

    With half angle a and angular frequency w (Eq. 14 of [Xu]),
    q = [cos(a/2), sin(a/2) sin wt, sin(a/2) cos wt, 0] and
    omega = [w sin a cos wt, -w sin a sin wt, 2 w sin^2(a/2)].
    The mean rate about z is what an algorithm without coning correction takes for a turn.

    Parameters
    ----------
    half_angle : float, rad
        Of the cone, 0 to pi.
    angular_frequency : float, rad/s
        Turns of the axis round the cone, > 0.
    position : tuple of 3 floats, m
        Of the body origin, at rest, in i.
    gravity : tuple of 3 floats, m/s^2
        Gravitational acceleration, in i.

    Raises
    ------
    InputError
        If an option is not finite, out of range, or has another shape.
    """

    name: ClassVar[str] = "coning"
    source: ClassVar[Source] = XU.at("Eq. 14")

    half_angle: float = 5 * DEG
    angular_frequency: float = 4 * math.pi
    position: Vector = ORIGIN
    gravity: Vector = STANDARD

    def __post_init__(self) -> None:
        half_angle = require_scalar("half_angle", self.half_angle, minimum=0.0)
        if half_angle > math.pi:
            raise InputError(f"half_angle must be at most pi rad, got {half_angle!r} (degrees?)")
        set_options(
            self,
            half_angle=half_angle,
            angular_frequency=require_scalar("angular_frequency", self.angular_frequency, positive=True),
            position=as_vector("position", self.position),
            gravity=as_vector("gravity", self.gravity),
        )

    def kinematics(self, t: Array) -> Kinematics:
        """Return the true kinematics at times t, shape (n,), s."""
        w, a = self.angular_frequency, self.half_angle
        sine, cosine = sincos(w, require_array("t", t, (None,)))
        half = math.sin(0.5 * a)
        rate = w * math.sin(a)
        return Kinematics(
            position=np.array(self.position),
            velocity=STILL,
            acceleration=STILL,
            q_ib=columns(math.cos(0.5 * a), half * sine, half * cosine, 0.0),
            omega_ib_b=columns(rate * cosine, -rate * sine, 2 * w * half * half),
            alpha_ib_b=columns(-rate * w * sine, -rate * w * cosine, 0.0),
            gravity=np.array(self.gravity),
        )

    def increments(self, rate: float, n: int, t0: float = 0.0) -> Array:
        """Return the integral of omega_ib_b over each of n intervals of 1/rate from t0, shape (n, 3), rad.

        Closed form: [2 sin a sin(wh/2) cos(w t_m), -2 sin a sin(wh/2) sin(w t_m), 2 w h sin^2(a/2)] with
        h the interval and t_m its midpoint.

        Raises
        ------
        InputError
            If rate is not positive, n is not a positive integer, or t0 is not finite.
        """
        h = 1.0 / require_scalar("rate", rate, positive=True)
        middles = require_scalar("t0", t0) + (np.arange(require_integer("n", n, minimum=1)) + 0.5) / rate
        w, a = self.angular_frequency, self.half_angle
        sine, cosine = sincos(w, np.asarray(middles, dtype=np.float64))
        swing = 2 * math.sin(a) * math.sin(0.5 * w * h)
        return columns(swing * cosine, -swing * sine, 2 * w * h * math.sin(0.5 * a) ** 2)
