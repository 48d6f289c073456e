"""Sinusoidal velocity: each component of v_n is a constant plus a sine; a long test of navigation solvers."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from bench.earth import WGS84, Earth
from bench.errors import Array, require_flag, require_scalar
from bench.motion._earth_motion import EarthFixed, EarthMotion, from_velocity
from bench.motion._earth_options import check_place
from bench.motion._euler_rates import SWING_OPTIONS, harmonic, set_vectors, swing_rates
from bench.motion._follow import compose, follow_in_n
from bench.motion._options import ORIGIN, Vector, require_within
from bench.motion._waves import columns
from bench.units import DEG

if TYPE_CHECKING:
    from bench.motion._geodetic_path import GeodeticPath


@dataclass(frozen=True)
class SinusoidalVelocity(EarthMotion):
    """Sinusoidal velocity: v_n = mean + amplitude sin(frequency t + phase), east, north, up, each with its own.

    Velocity, acceleration, attitude and rates are closed forms; the place is solved from the velocity to rounding,
    once, when it is first needed. The defaults are the hour with which the package pyins tests its own strapdown
    integration (`generate_sine_velocity_motion`).

    Parameters
    ----------
    duration : float, s
        The motion is defined from 0 to here.
    latitude, longitude, height : float, rad, rad, m
        Geodetic, at t = 0.
    mean, amplitude : tuple of 3 floats, m/s
        Of the velocity relative to the Earth, east, north, up.
    frequency, phase : tuple of 3 floats, rad/s, rad
    follow : bool
        Whether the attitude follows the velocity: y along it, x level. It must then neither vanish nor be vertical.
    attitude : tuple of 3 floats, rad
        Mean yaw psi, pitch P, roll R; from n, or from the direction of travel if `follow`.
    swing : tuple of 3 floats, rad
        Amplitudes of psi, P, R: each is mean + swing sin(swing_frequency t + swing_phase).
    swing_frequency, swing_phase : tuple of 3 floats, rad/s, rad
    earth : Earth

    Raises
    ------
    InputError
        If an option is not finite or out of range; in use, if a time lies outside the duration, the path comes within
        1e-6 rad of a pole, or there is no direction of travel to follow.
    AccuracyError
        In use, if a frequency is too high for the path to be solved.
    """

    name: ClassVar[str] = "sinusoidal-velocity"

    duration: float = 3600.0
    latitude: float = 55 * DEG
    longitude: float = 37 * DEG
    height: float = 1500.0
    mean: Vector = (-3.0, 5.0, -0.2)
    amplitude: Vector = (1.0, 1.0, -1.0)
    frequency: Vector = (2 * math.pi / 60, 2 * math.pi / 60, 2 * math.pi / 60)
    phase: Vector = (math.pi / 2, 0.0, 0.0)
    follow: bool = True
    attitude: Vector = ORIGIN
    swing: Vector = ORIGIN
    swing_frequency: Vector = (2 * math.pi / 12, 2 * math.pi / 8, 2 * math.pi / 10)
    swing_phase: Vector = ORIGIN
    earth: Earth = WGS84

    def __post_init__(self) -> None:
        require_scalar("duration", self.duration, positive=True)
        check_place(self.earth, self.latitude, self.longitude, self.height, poles=False)
        set_vectors(self, "mean", "amplitude", "frequency", "phase", *SWING_OPTIONS)
        require_flag("follow", self.follow)

    def _velocity(self, t: Array) -> tuple[Array, Array, Array]:
        """Return v_n and the first two derivatives of its components, each (n, 3)."""
        options = zip(self.amplitude, self.frequency, self.phase, self.mean, strict=True)
        jets = [harmonic(amplitude, w, phase, t, mean) for amplitude, w, phase, mean in options]
        value, first, second = (columns(*parts) for parts in zip(*jets, strict=True))
        return value, first, second

    @cached_property
    def _path(self) -> "GeodeticPath":
        from bench.motion._geodetic_path import solve

        # A segment of this length holds at most 8 rad of the fastest sine, which its polynomials resolve.
        longest = min(8 / max(abs(w) for w in self.frequency) if any(self.frequency) else math.inf, 60.0)
        corners = np.array([0.0, self.duration])
        place = self.latitude, self.longitude, self.height
        return solve(lambda t: self._velocity(t)[0], corners, place, self.earth, longest)

    def earth_fixed(self, t: Array) -> EarthFixed:
        """Return the motion relative to e at times t, shape (n,), s."""
        t = require_within(t, (0.0, self.duration))
        v_n, dv_n, ddv_n = self._velocity(t)
        turning = swing_rates(self, t)
        if self.follow:
            turning = compose(follow_in_n(t, v_n, dv_n, ddv_n), turning)
        return from_velocity(self.earth, self._path.places(t), v_n, dv_n, *turning)
