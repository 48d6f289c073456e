"""Waypoints: a smooth path through geodetic places at given times, the attitude following the direction of travel."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

from bench.earth import WGS84, Earth, require_latitude
from bench.errors import Array, require_array
from bench.motion._earth_motion import EarthFixed, EarthMotion
from bench.motion._earth_options import check_earth
from bench.motion._euler_rates import SWING_OPTIONS, set_vectors, swing_rates
from bench.motion._follow import compose, follow_in_e
from bench.motion._options import ORIGIN, Vector, require_within, set_options
from bench.motion._spline_curve import quintic, require_knots

if TYPE_CHECKING:
    from scipy.interpolate import BSpline


@dataclass(frozen=True, eq=False)
class Waypoints(EarthMotion):
    """Waypoints: an interpolating quintic through the places in e, and an attitude that follows its velocity.

    The path is C4 and poles are ordinary points. Between places D apart on a steady course it leaves the arc round
    the Earth by D^6 / (15360 R^5), R the Earth's radius: 0.1 mm for 500 km (more next to the ends); at sharp corners
    it swings out, as every spline does. The velocity must neither vanish nor be vertical. For attitudes of one's own at
    the waypoints see `LoggedTrajectory.from_geodetic`.

    Parameters
    ----------
    t : array_like, shape (n,), s
        Times of the waypoints, strictly increasing, n >= 6; they are the motion's span.
    latitude, longitude, height : array_like, shape (n,), rad, rad, m
        Geodetic.
    attitude : tuple of 3 floats, rad
        Mean yaw psi, pitch P, roll R from the frame with y along the velocity and x level.
    swing : tuple of 3 floats, rad
        Amplitudes of psi, P, R: each is mean + swing sin(swing_frequency t + swing_phase).
    swing_frequency, swing_phase : tuple of 3 floats, rad/s, rad
    earth : Earth

    Raises
    ------
    InputError
        If an option has another shape, is not finite or out of range, the times do not increase, or there are fewer
        than 6; in use, if a time lies outside the span or there is no direction of travel.
    """

    name: ClassVar[str] = "waypoints"

    t: Array
    latitude: Array
    longitude: Array
    height: Array
    attitude: Vector = ORIGIN
    swing: Vector = ORIGIN
    swing_frequency: Vector = (1.0, 1.0, 1.0)
    swing_phase: Vector = ORIGIN
    earth: Earth = WGS84

    def __post_init__(self) -> None:
        check_earth(self.earth)
        t = require_knots("t", self.t)  # copies: the caller may go on using the arrays
        for name in ("latitude", "longitude", "height"):
            set_options(self, **{name: require_array(name, getattr(self, name), (len(t),)).copy()})
        require_latitude(self.latitude)
        set_options(self, t=t)
        set_vectors(self, *SWING_OPTIONS)

    @cached_property
    def _places(self) -> Array:
        return self.earth.position(self.latitude, self.longitude, self.height)

    @cached_property
    def _splines(self) -> "tuple[BSpline, ...]":
        """The spline through the places minus the first one, and its three derivatives."""
        # The distance from the centre of the Earth would cost the derivatives digits.
        return quintic(self.t, self._places - self._places[0], 3)

    def earth_fixed(self, t: Array) -> EarthFixed:
        """Return the motion relative to e at times t, shape (n,), s."""
        t = require_within(t, (float(self.t[0]), float(self.t[-1])))
        r_e, v_e, a_e, j_e = (spline(t) for spline in self._splines)
        r_e = self._places[0] + r_e
        turning = compose(follow_in_e(t, self.earth, r_e, v_e, a_e, j_e), swing_rates(self, t))
        return EarthFixed(r_e, v_e, a_e, *turning)
