"""Savage's manoeuvre: large angles about all axes at once, given by the integral of the body rate."""

import math
from dataclasses import dataclass
from functools import cached_property, partial
from typing import ClassVar

import numpy as np

from bench.errors import Array, require_array, require_integer, require_scalar
from bench.motion import STANDARD, Motion
from bench.motion._options import (
    IDENTITY,
    ORIGIN,
    STILL,
    Quaternion,
    Vector,
    as_quaternion,
    as_vector,
    require_within,
    set_options,
)
from bench.motion.body_rate import BodyRate
from bench.references import SAVAGE, Source
from bench.signals import Kinematics

SPAN = (0.0, 1.2)  # s
FREQUENCY = 2.6 * math.pi  # rad/s
# rad; rows: x, y, z; columns: t, t^2, ... t^5, sin wt, 1 - cos wt
TABLE = np.array(
    [
        [-1.1, 0.45, -0.6, 1.1, -0.1, 0.2, 0.3],
        [-0.5, 1.0, -0.3, 0.7, -0.2, -0.5, 0.6],
        [0.3, -1.2, 2.0, -0.9, 0.4, 0.8, -0.9],
    ]
)


def _combine(columns: list[Array]) -> Array:
    """Return the combination of the seven functions, (n,) each, on each axis, shape (n, 3)."""
    terms = np.stack(columns, axis=1)
    # Summed in a fixed order: a product of matrices may give other bits for another number of rows.
    total = terms[:, :1] * TABLE[:, 0]
    for k in range(1, TABLE.shape[1]):
        total += terms[:, k : k + 1] * TABLE[:, k]
    return total


def _rate(t: Array) -> Array:
    w = FREQUENCY
    powers = [np.ones_like(t), 2 * t, 3 * t**2, 4 * t**3, 5 * t**4]
    return _combine([*powers, w * np.cos(w * t), w * np.sin(w * t)])


def _alpha(t: Array) -> Array:
    w = FREQUENCY
    powers = [np.zeros_like(t), np.full_like(t, 2.0), 6 * t, 12 * t**2, 20 * t**3]
    return _combine([*powers, -w * w * np.sin(w * t), w * w * np.cos(w * t)])


def _at_rest(position: Vector, t: Array) -> tuple[Array, Array, Array]:
    return np.array(position), STILL, STILL


@dataclass(frozen=True)
class SavageManoeuvre(Motion):
    """Savage's manoeuvre: large angles about all axes at once, given by the integral of the body rate.

    For 1.2 s the integral of omega_ib_b is a polynomial of degree 5 plus sines and cosines of 2.6 pi t on each axis
    ([Savage], Eq. 15 of [Xu]), up to 685 deg/s. Increments have a closed form; the attitude has none and is solved
    to rounding, see `BodyRate`.

    Parameters
    ----------
    q_ib : tuple of 4 floats
        Attitude at t = 0, b to i, wxyz, unit.
    position : tuple of 3 floats, m
        Of the body origin, at rest, in i.
    gravity : tuple of 3 floats, m/s^2
        Gravitational acceleration, in i.

    Raises
    ------
    InputError
        If an option is not finite or has another shape; in use, if a time lies outside 0 to 1.2 s.

    References
    ----------
    [Savage] Savage, A unified mathematical framework for strapdown algorithm design, 2006.
    [Xu] Xu et al., Performance analysis of high-precision strapdown inertial navigation attitude algorithms, 2019.
    """

    name: ClassVar[str] = "savage-manoeuvre"
    source: ClassVar[Source] = SAVAGE

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

    @cached_property
    def _body(self) -> BodyRate:
        stay = partial(_at_rest, self.position)
        return BodyRate(_rate, SPAN, self.q_ib, alpha=_alpha, translation=stay, gravity=self.gravity)

    @property
    def error_estimate(self) -> float:
        """Estimated error of the attitude, rad (see `BodyRate`)."""
        return self._body.error_estimate

    def kinematics(self, t: Array) -> Kinematics:
        """Return the true kinematics at times t, shape (n,), s, from 0 to 1.2."""
        return self._body.kinematics(require_array("t", t, (None,)))

    def increments(self, rate: float, n: int, t0: float = 0.0) -> Array:
        """Return the integral of omega_ib_b over each of n intervals of 1/rate from t0, shape (n, 3), rad.

        In closed form, from the middle m and the length h of each interval, so that small increments keep their
        digits.

        Raises
        ------
        InputError
            If rate is not positive, n is not a positive integer, or the intervals leave the span of 1.2 s.
        """
        h = 1.0 / require_scalar("rate", rate, positive=True)
        start = require_scalar("t0", t0)
        m = start + (np.arange(require_integer("n", n, minimum=1)) + 0.5) / rate
        require_within(np.array([start, start + n / rate]), SPAN)
        w, square, quarter = FREQUENCY, m * m, 0.25 * h * h
        powers = [
            np.full_like(m, h),
            2 * h * m,
            h * (3 * square + quarter),
            4 * h * m * (square + quarter),
            h * (5 * square * square + 10 * square * quarter + quarter * quarter),
        ]
        swing = 2 * math.sin(0.5 * w * h)
        return _combine([*powers, swing * np.cos(w * m), swing * np.sin(w * m)])
