"""Great circle: level flight at constant speed round the Earth's centre, over a pole if one likes, in closed form."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.earth import WGS84, Earth
from bench.errors import Array, require_array, require_scalar
from bench.motion._earth_motion import EarthFixed, EarthMotion
from bench.motion._earth_options import check_place
from bench.motion._euler_rates import SWING_OPTIONS, set_vectors, swing_rates
from bench.motion._follow import compose
from bench.motion._options import ORIGIN, Vector
from bench.motion._waves import columns, sincos
from bench.rotation import quat_from_matrix, quat_multiply, quat_rotate
from bench.units import DEG


@dataclass(frozen=True)
class GreatCircle(EarthMotion):
    """Great circle: a circle round the Earth's centre, fixed in e, at constant speed; the attitude follows it.

    The distance from the centre is constant, the height above an ellipsoid is not: it grows by up to 21 km towards
    the poles. Nothing is singular at a pole; azimuth 0 leads exactly over it.

    Parameters
    ----------
    latitude, longitude, height : float, rad, rad, m
        Geodetic, at t = 0; at a pole the longitude says where n's axes point.
    azimuth : float, rad
        Direction of travel at t = 0, clockwise from north.
    speed : float, m/s
        Relative to the Earth.
    attitude : tuple of 3 floats, rad
        Mean yaw psi, pitch P, roll R from the frame with y along the circle and z away from the Earth's centre.
    swing : tuple of 3 floats, rad
        Amplitudes of psi, P, R: each is mean + swing sin(swing_frequency t + swing_phase).
    swing_frequency, swing_phase : tuple of 3 floats, rad/s, rad
    earth : Earth

    Raises
    ------
    InputError
        If an option is not finite or out of range.
    """

    name: ClassVar[str] = "great-circle"

    latitude: float = 89 * DEG
    longitude: float = 126 * DEG
    height: float = 10000.0
    azimuth: float = 0.0
    speed: float = 300.0
    attitude: Vector = ORIGIN
    swing: Vector = ORIGIN
    swing_frequency: Vector = (2 * math.pi, 2 * math.pi, 2 * math.pi)
    swing_phase: Vector = (0.0, 2 * math.pi / 3, 4 * math.pi / 3)
    earth: Earth = WGS84

    def __post_init__(self) -> None:
        check_place(self.earth, self.latitude, self.longitude, self.height)
        for name in ("azimuth", "speed"):
            require_scalar(name, getattr(self, name))
        set_vectors(self, *SWING_OPTIONS)

    def earth_fixed(self, t: Array) -> EarthFixed:
        """Return the motion relative to e at times t, shape (n,), s."""
        t = require_array("t", t, (None,))
        start = self.earth.position(self.latitude, self.longitude, self.height)
        radius = float(np.linalg.norm(start))
        up = start / radius
        course = np.array([math.sin(self.azimuth), math.cos(self.azimuth), 0.0])
        ahead = quat_rotate(self.earth.q_en(self.latitude, self.longitude), course)
        right = np.cross(ahead, up)  # the horizon is that of the centre, up to 0.2 deg from that of the ellipsoid
        right /= np.linalg.norm(right)
        ahead = np.cross(up, right)
        q_start = quat_from_matrix(np.column_stack([right, ahead, up]))

        rate = self.speed / radius
        sine, cosine = sincos(0.5 * rate, t)
        still = np.zeros((len(t), 3))
        circling = quat_multiply(q_start, columns(cosine, -sine, 0.0, 0.0)), still - [rate, 0.0, 0.0], still
        sine, cosine = (part[:, None] for part in sincos(rate, t))
        away, forward = cosine * up + sine * ahead, cosine * ahead - sine * up
        return EarthFixed(
            radius * away,
            self.speed * forward,
            (-self.speed * rate) * away,
            *compose(circling, swing_rates(self, t)),
        )
