"""Earth rest: the body stands at a place on the rotating Earth, or sways there like a moored ship."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.earth import WGS84, Earth
from bench.errors import Array, require_array
from bench.motion._earth_motion import EarthFixed, EarthMotion
from bench.motion._earth_options import check_place
from bench.motion._euler_rates import SWING_OPTIONS, harmonic, set_vectors, swing_rates
from bench.motion._options import ORIGIN, Vector
from bench.motion._waves import columns
from bench.rotation import quat_from_rotvec, quat_multiply, quat_normalize, quat_rotate
from bench.units import DEG


@dataclass(frozen=True)
class EarthRest(EarthMotion):
    """Earth rest: standing at a geodetic place, poles included; attitude and place may swing harmonically about it.

    Attitude and displacement refer to n at the place itself, which does not move; n at the displaced body, in which
    `trajectory` reports, is turned from it by the displacement over the Earth's radius.

    Parameters
    ----------
    latitude, longitude : float, rad
        Geodetic; at a pole the longitude says where n's axes point.
    height : float, m
        Above the ellipsoid.
    attitude : tuple of 3 floats, rad
        Mean yaw psi, pitch P, roll R.
    swing : tuple of 3 floats, rad
        Amplitudes of psi, P, R: each is mean + swing sin(swing_frequency t + swing_phase).
    swing_frequency, swing_phase : tuple of 3 floats, rad/s, rad
    sway : tuple of 3 floats, m
        Amplitudes of the displacement to the right (sway), forward (surge) and up (heave), along axes level at the
        place and turned by the mean yaw.
    sway_frequency, sway_phase : tuple of 3 floats, rad/s, rad
    earth : Earth

    Raises
    ------
    InputError
        If an option is not finite or out of range.
    """

    name: ClassVar[str] = "earth-rest"

    latitude: float = 45 * DEG
    longitude: float = 126 * DEG
    height: float = 0.0
    attitude: Vector = ORIGIN
    swing: Vector = ORIGIN
    swing_frequency: Vector = (2 * math.pi / 12, 2 * math.pi / 8, 2 * math.pi / 10)
    swing_phase: Vector = ORIGIN
    sway: Vector = ORIGIN
    sway_frequency: Vector = (2 * math.pi / 7, 2 * math.pi / 6, 2 * math.pi / 8)
    sway_phase: Vector = ORIGIN
    earth: Earth = WGS84

    def __post_init__(self) -> None:
        check_place(self.earth, self.latitude, self.longitude, self.height)
        set_vectors(self, "sway", "sway_frequency", "sway_phase", *SWING_OPTIONS)

    def earth_fixed(self, t: Array) -> EarthFixed:
        """Return the motion relative to e at times t, shape (n,), s."""
        t = require_array("t", t, (None,))
        q_en = self.earth.q_en(self.latitude, self.longitude)
        q_nb, omega_nb_b, alpha_nb_b = swing_rates(self, t)
        # The level axes of the displacement: n turned by the mean yaw.
        q_el = quat_multiply(q_en, quat_from_rotvec(np.array([0.0, 0.0, self.attitude[0]])))
        jets = [harmonic(self.sway[k], self.sway_frequency[k], self.sway_phase[k], t) for k in range(3)]
        displacement, velocity, acceleration = (quat_rotate(q_el, columns(*parts)) for parts in zip(*jets, strict=True))
        return EarthFixed(
            r_e=self.earth.position(self.latitude, self.longitude, self.height) + displacement,
            v_e=velocity,
            a_e=acceleration,
            q_eb=quat_normalize(quat_multiply(q_en, q_nb)),
            omega_eb_b=omega_nb_b,
            alpha_eb_b=alpha_nb_b,
        )
