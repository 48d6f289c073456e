"""Fast vehicle: a level flight at constant speed round the Earth with attitude swing and manoeuvres, in closed form."""

import math
from dataclasses import dataclass
from typing import ClassVar

from bench.earth import WGS84, Earth
from bench.errors import Array, require_array, require_scalar
from bench.motion._earth_motion import EarthFixed, EarthMotion, from_geodetic
from bench.motion._earth_options import check_off_poles, check_place
from bench.motion._euler_rates import SWING_OPTIONS, Jet, harmonic, set_vectors, swing_rates
from bench.motion._options import Vector
from bench.references import WANG, Source
from bench.units import DEG


@dataclass(frozen=True)
class FastVehicle(EarthMotion):
    """Fast vehicle: latitude, longitude, height, yaw, pitch and roll each linear in time plus a sine.

    The motion of section 1 of [Wang]: analytic L(t), lambda(t), h(t), psi(t), P(t), R(t). The uniform part has the
    given speed along the given azimuth at the start; each sine has its amplitude, angular frequency and phase.

    Parameters
    ----------
    speed : float, m/s
        Of the uniform part, at t = 0.
    azimuth : float, rad
        Direction of the uniform part at t = 0, clockwise from north.
    latitude, longitude : float, rad
        Of the uniform part at t = 0.
    height, climb : float, m, m/s
        Of the uniform part.
    weave : tuple of 3 floats, m
        Amplitudes of the manoeuvre east, north, up (east and north as arcs at the starting latitude).
    weave_frequency, weave_phase : tuple of 3 floats, rad/s, rad
    attitude : tuple of 3 floats, rad
        Mean yaw psi, pitch P, roll R.
    swing : tuple of 3 floats, rad
        Amplitudes of psi, P, R.
    swing_frequency, swing_phase : tuple of 3 floats, rad/s, rad
        With equal phases there is nearly no coning; the defaults are a third of a turn apart.
    earth : Earth

    Raises
    ------
    InputError
        If an option is not finite or out of range; in use, if the path comes within 1e-6 rad of a pole.
    """

    name: ClassVar[str] = "fast-vehicle"
    source: ClassVar[Source] = WANG

    speed: float = 3000.0
    azimuth: float = 45 * DEG
    latitude: float = 45 * DEG
    longitude: float = 126 * DEG
    height: float = 20000.0
    climb: float = 0.0
    weave: Vector = (0.0, 0.0, 0.0)
    weave_frequency: Vector = (2 * math.pi / 20, 2 * math.pi / 16, 2 * math.pi / 12)
    weave_phase: Vector = (0.0, 2 * math.pi / 3, 4 * math.pi / 3)
    attitude: Vector = (-45 * DEG, 0.0, 0.0)
    swing: Vector = (10 * DEG, 10 * DEG, 10 * DEG)
    swing_frequency: Vector = (2 * math.pi, 2 * math.pi, 2 * math.pi)
    swing_phase: Vector = (0.0, 2 * math.pi / 3, 4 * math.pi / 3)
    earth: Earth = WGS84

    def __post_init__(self) -> None:
        check_place(self.earth, self.latitude, self.longitude, self.height, poles=False)
        for name in ("speed", "azimuth", "climb"):
            require_scalar(name, getattr(self, name))
        set_vectors(self, "weave", "weave_frequency", "weave_phase", *SWING_OPTIONS)

    def earth_fixed(self, t: Array) -> EarthFixed:
        """Return the motion relative to e at times t, shape (n,), s."""
        t = require_array("t", t, (None,))
        R_M, R_N = (float(radius) + self.height for radius in self.earth.radii(self.latitude))
        arm = R_N * math.cos(self.latitude)
        north = self.speed * math.cos(self.azimuth) / R_M
        east = self.speed * math.sin(self.azimuth) / arm
        latitude = self._weave(1, self.latitude, north, R_M, t)
        check_off_poles("latitude of the path", latitude[0])
        longitude = self._weave(0, self.longitude, east, arm, t)
        height = self._weave(2, self.height, self.climb, 1.0, t)
        return from_geodetic(self.earth, latitude, longitude, height, *swing_rates(self, t))

    def _weave(self, axis: int, start: float, rate: float, scale: float, t: Array) -> Jet:
        amplitude = self.weave[axis] / scale
        value, first, second = harmonic(amplitude, self.weave_frequency[axis], self.weave_phase[axis], t)
        return start + rate * t + value, rate + first, second
