"""Vehicle: a drive or a flight over the Earth, put together from manoeuvres."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from bench.earth import WGS84, Earth
from bench.errors import Array, InputError, require_flag, require_scalar
from bench.motion._earth_motion import EarthFixed, EarthMotion, from_velocity
from bench.motion._earth_options import check_place
from bench.motion._euler_rates import SWING_OPTIONS, Jet, euler_rates, set_vectors, swing_rates
from bench.motion._follow import compose
from bench.motion._options import ORIGIN, Vector, require_within, set_options
from bench.motion._waves import columns
from bench.motion.manoeuvres import Accelerate, Climb, Manoeuvre, Straight, Turn, Weave
from bench.units import DEG, STANDARD_GRAVITY

if TYPE_CHECKING:
    from bench.motion._geodetic_path import GeodeticPath

QUANTITIES = ("speed", "yaw", "path_angle")
SHORT_FLIGHT: tuple[Manoeuvre, ...] = (
    Straight(10.0),
    Accelerate(20.0, 40.0),
    Climb(60.0, 8 * DEG),
    Turn(40.0, 90 * DEG),
    Weave(40.0, 8 * DEG, 10.0),
    Turn(60.0, -180 * DEG),
    Climb(30.0, -5 * DEG),
    Accelerate(20.0, -30.0),
    Straight(20.0),
)


@dataclass(frozen=True)
class Vehicle(EarthMotion):
    """Vehicle: manoeuvres one after the other, from a given place, speed and heading on.

    Speed s, yaw psi and path angle gamma are closed forms of time, and so v_n = s (-sin psi cos gamma,
    cos psi cos gamma, sin gamma), acceleration, attitude and rates; the place is solved from the velocity to rounding,
    once, when it is first needed. Where manoeuvres and their ramps meet, the eighth derivative of velocity and roll
    jumps, which exact increments do not notice from about 20 intervals a ramp on; with fewer, let manoeuvres and ramps
    last whole intervals.

    Parameters
    ----------
    segments : tuple of Manoeuvre
        `Straight`, `Accelerate`, `Climb`, `Turn`, `Weave` of ``bench.motion.manoeuvres``, or your own.
    latitude, longitude, height : float, rad, rad, m
        Geodetic, at t = 0.
    speed : float, m/s
        Relative to the Earth, at t = 0.
    heading : float, rad
        At t = 0, clockwise from north.
    follow : bool
        Whether the attitude follows the path: yaw and pitch are those of the velocity, and the roll banks into turns
        until nothing pulls sideways, tan R = -s cos gamma psi' / 9.80665 m/s^2. Otherwise the attitude is given.
    attitude : tuple of 3 floats, rad
        Mean yaw psi, pitch P, roll R; from the attitude of the path if `follow`, else from n.
    swing : tuple of 3 floats, rad
        Amplitudes of psi, P, R: each is mean + swing sin(swing_frequency t + swing_phase).
    swing_frequency, swing_phase : tuple of 3 floats, rad/s, rad
    earth : Earth

    Raises
    ------
    InputError
        If an option is not finite or out of range; in use, if a time lies beyond the last manoeuvre, or the path
        comes within 1e-6 rad of a pole.
    """

    name: ClassVar[str] = "vehicle"

    segments: tuple[Manoeuvre, ...] = SHORT_FLIGHT
    latitude: float = 45 * DEG
    longitude: float = 126 * DEG
    height: float = 500.0
    speed: float = 60.0
    heading: float = 30 * DEG
    follow: bool = True
    attitude: Vector = ORIGIN
    swing: Vector = ORIGIN
    swing_frequency: Vector = (2 * math.pi / 3, 2 * math.pi / 2, 2 * math.pi / 2)
    swing_phase: Vector = (0.0, 2 * math.pi / 3, 4 * math.pi / 3)
    earth: Earth = WGS84

    def __post_init__(self) -> None:
        segments = tuple(self.segments) if isinstance(self.segments, (tuple, list)) else (self.segments,)
        wrong = [segment for segment in segments if not isinstance(segment, Manoeuvre)]
        if wrong or not segments:
            raise InputError(f"segments must be one or more manoeuvres, got {wrong[0] if wrong else segments!r}")
        set_options(self, segments=segments)
        check_place(self.earth, self.latitude, self.longitude, self.height, poles=False)
        for name in ("speed", "heading"):
            require_scalar(name, getattr(self, name))
        require_flag("follow", self.follow)
        set_vectors(self, *SWING_OPTIONS)

    @cached_property
    def borders(self) -> Array:
        """Start of each manoeuvre and end of the last one, shape (m + 1,), s."""
        return np.cumsum([0.0, *(segment.duration for segment in self.segments)])

    @property
    def duration(self) -> float:
        """End of the last manoeuvre, s."""
        return float(self.borders[-1])

    @cached_property
    def _starts(self) -> Array:
        """Speed, yaw and path angle at the start of each manoeuvre, shape (m + 1, 3)."""
        starts = np.array([[self.speed, -self.heading, 0.0]]).repeat(len(self.segments) + 1, axis=0)
        for k, segment in enumerate(self.segments):
            starts[k + 1 :, QUANTITIES.index(segment.quantity)] += segment.total
        return starts

    @cached_property
    def _path(self) -> "GeodeticPath":
        from bench.motion._geodetic_path import solve

        inner = [start + np.array(part.corners) for start, part in zip(self.borders, self.segments, strict=False)]
        corners = np.unique(np.concatenate([self.borders, *inner]))
        corners = corners[np.append(np.diff(corners) > 1e-9, True)]  # one and the same but for rounding
        place = self.latitude, self.longitude, self.height
        return solve(lambda t: _velocity(*self._profile(t))[0], corners, place, self.earth, 60.0)

    def _profile(self, t: Array) -> tuple[Array, Array, Array]:
        """Return speed, yaw and path angle, each with three derivatives, (4, n)."""
        index = np.searchsorted(self.borders[1:-1], t, side="right")
        profile = np.zeros((3, 4, len(t)))
        profile[:, 0] = self._starts[index].T
        for k in np.unique(index):
            here, segment = index == k, self.segments[k]
            change = segment.change(t[here] - self.borders[k])
            profile[QUANTITIES.index(segment.quantity), :, here] += np.stack(change, axis=1)
        speed, yaw, path_angle = profile
        return speed, yaw, path_angle

    def earth_fixed(self, t: Array) -> EarthFixed:
        """Return the motion relative to e at times t, shape (n,), s."""
        t = require_within(t, (0.0, self.duration))
        profile = self._profile(t)
        v_n, dv_n, level_speed = _velocity(*profile)
        turning = swing_rates(self, t)
        if self.follow:
            _, yaw, path_angle = profile
            roll = _bank(level_speed, yaw)
            turning = compose(euler_rates(tuple(yaw[:3]), tuple(path_angle[:3]), roll), turning)
        return from_velocity(self.earth, self._path.places(t), v_n, dv_n, *turning)


def _velocity(speed: Array, yaw: Array, path_angle: Array) -> tuple[Array, Array, Jet]:
    """Return v_n and its derivative, each (n, 3), and the level part of the speed with two derivatives."""
    s, ds, dds, _ = speed
    _, dpsi, _, _ = yaw
    _, dgamma, ddgamma, _ = path_angle
    (sine, cosine), (lift, level) = ((np.sin(angle), np.cos(angle)) for angle in (yaw[0], path_angle[0]))
    h, dh, up, dup = s * level, ds * level - s * lift * dgamma, s * lift, ds * lift + s * level * dgamma
    ddh = dds * level - 2 * ds * lift * dgamma - s * (level * dgamma**2 + lift * ddgamma)
    v_n = columns(-h * sine, h * cosine, up)
    dv_n = columns(-dh * sine - h * dpsi * cosine, dh * cosine - h * dpsi * sine, dup)
    return v_n, dv_n, (h, dh, ddh)


def _bank(level_speed: Jet, yaw: Array) -> Jet:
    """Return the roll of a coordinated turn, tan R = -h psi' / g, with two derivatives; h is the level speed."""
    h, dh, ddh = level_speed
    _, first, second, third = yaw / -STANDARD_GRAVITY
    k, dk, ddk = h * first, dh * first + h * second, ddh * first + 2 * dh * second + h * third
    slope = 1 / (1 + k * k)
    return np.arctan(k), dk * slope, (ddk - 2 * k * dk * dk * slope) * slope
