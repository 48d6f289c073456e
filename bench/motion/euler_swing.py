"""Euler swing: yaw, pitch and roll each swing harmonically, as a ship or a test table does."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import Array, require_array
from bench.motion import STANDARD, Motion
from bench.motion._euler_rates import Jet, euler_rates, harmonic
from bench.motion._options import ORIGIN, STILL, Vector, as_vector, set_options
from bench.signals import Kinematics
from bench.units import DEG


@dataclass(frozen=True)
class EulerSwing(Motion):
    """Euler swing: each of yaw psi, pitch P, roll R is offset + amplitude sin(angular_frequency t + phase).

    C_ib = Rz(psi) Rx(P) Ry(R) (3-1-2). The body rate, in which the Euler rates mix, is
    omega = (cR P' - sR cP psi', R' + sP psi', sR P' + cR cP psi'), and alpha its derivative in closed form.
    Nothing is singular at P = 90 deg: the angles are prescribed, not found.

    Parameters
    ----------
    amplitude, offset, phase : tuple of 3 floats, rad
        Of psi, P, R.
    angular_frequency : tuple of 3 floats, rad/s
        Of psi, P, R.
    velocity, position : tuple of 3 floats, m/s, m
        Uniform motion of the body origin; position at t = 0; in i.
    gravity : tuple of 3 floats, m/s^2
        Gravitational acceleration, in i.

    Raises
    ------
    InputError
        If an option is not finite or has another shape.
    """

    name: ClassVar[str] = "euler-swing"

    amplitude: Vector = (3 * DEG, 5 * DEG, 8 * DEG)
    angular_frequency: Vector = (2 * math.pi / 12, 2 * math.pi / 8, 2 * math.pi / 10)
    phase: Vector = ORIGIN
    offset: Vector = ORIGIN
    velocity: Vector = ORIGIN
    position: Vector = ORIGIN
    gravity: Vector = STANDARD

    def __post_init__(self) -> None:
        vectors = ("amplitude", "angular_frequency", "phase", "offset", "velocity", "position", "gravity")
        set_options(self, **{name: as_vector(name, getattr(self, name)) for name in vectors})

    def _angle(self, k: int, t: Array) -> Jet:
        """Return angle k of (psi, P, R) and its first two derivatives, each shape (n,)."""
        return harmonic(self.amplitude[k], self.angular_frequency[k], self.phase[k], t, self.offset[k])

    def kinematics(self, t: Array) -> Kinematics:
        """Return the true kinematics at times t, shape (n,), s."""
        t = require_array("t", t, (None,))
        q_ib, omega_ib_b, alpha_ib_b = euler_rates(*(self._angle(k, t) for k in range(3)))
        return Kinematics(
            position=np.array(self.position) + t[:, None] * np.array(self.velocity),
            velocity=np.array(self.velocity),
            acceleration=STILL,
            q_ib=q_ib,
            omega_ib_b=omega_ib_b,
            alpha_ib_b=alpha_ib_b,
            gravity=np.array(self.gravity),
        )
