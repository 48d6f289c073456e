"""Logged trajectory: a smooth motion on the Earth through recorded positions and attitudes."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from bench.earth import WGS84, Earth
from bench.errors import Array, require_array, require_instance, require_unit_quaternion
from bench.motion._earth_motion import EarthFixed, EarthMotion
from bench.motion._earth_options import check_earth
from bench.motion._options import require_within, set_options
from bench.motion._spline_curve import continuous, quintic, require_knots, turning
from bench.trajectory import Trajectory

if TYPE_CHECKING:
    from scipy.interpolate import BSpline


@dataclass(frozen=True, eq=False)
class LoggedTrajectory(EarthMotion):
    """Logged trajectory: interpolating quintics through the positions and the sign-continuous quaternions, both in e.

    As the `Spline` motion, but on the Earth: C4, so that the acceleration is C2 and the angular rate C3; poles are
    ordinary points. Velocity is that of the curve, not that of a log. A spline interpolates: noise in the poses
    goes, amplified, into rate and acceleration; the rounding of a position in e, 1e-9 m, alone makes 1e-4 m/s^2 of a
    log at 100 Hz. Between two poses the curve is a polynomial: exact increments want poses on borders of intervals.

    Parameters
    ----------
    t : array_like, shape (n,), s
        Times of the poses, strictly increasing, n >= 6; they are the motion's span.
    r_e : array_like, shape (n, 3), m
        Positions from the centre of the Earth, in e.
    q_eb : array_like, shape (n, 4)
        Attitudes, b to e, wxyz, unit, either sign, less than 90 degrees from one to the next.
    earth : Earth

    Raises
    ------
    InputError
        If an array has another shape or is not finite, the times do not increase, there are fewer than 6, a
        quaternion is not unit, or consecutive attitudes lie too far apart; in use, if a time lies outside the span.
    """

    name: ClassVar[str] = "logged-trajectory"

    t: Array
    r_e: Array
    q_eb: Array
    earth: Earth = WGS84

    def __post_init__(self) -> None:
        check_earth(self.earth)
        t = require_knots("t", self.t)  # copies: the caller may go on using the arrays
        r_e = require_array("r_e", self.r_e, (len(t), 3)).copy()
        q_eb = continuous("q_eb", t, require_unit_quaternion("q_eb", self.q_eb, (len(t), 4)))
        set_options(self, t=t, r_e=r_e, q_eb=q_eb)

    @classmethod
    def of(cls, trajectory: Trajectory) -> "LoggedTrajectory":
        """Return the motion through a trajectory, an estimate or a reference."""
        require_instance("trajectory", trajectory, Trajectory)
        return cls(trajectory.t, trajectory.r_e, trajectory.q_eb, trajectory.earth)

    @classmethod
    def from_geodetic(
        cls,
        t: ArrayLike,
        latitude: ArrayLike,
        longitude: ArrayLike,
        height: ArrayLike,
        q_nb: ArrayLike,
        earth: Earth = WGS84,
    ) -> "LoggedTrajectory":
        """Return the motion through geodetic positions (rad, rad, m) with attitudes b to n (east-north-up)."""
        check_earth(earth)
        v_n = np.zeros((len(require_knots("t", np.asarray(t))), 3))  # not used: the curve has its own
        return cls.of(Trajectory.from_geodetic(earth, t, q_nb, v_n, latitude, longitude, height))

    @cached_property
    def _splines(self) -> "tuple[BSpline, ...]":
        """The spline through (position minus the first one, quaternion) in seven columns, and its two derivatives."""
        # The distance from the centre of the Earth would cost the derivatives digits.
        return quintic(self.t, np.hstack([self.r_e - self.r_e[0], self.q_eb]), 2)

    def earth_fixed(self, t: Array) -> EarthFixed:
        """Return the motion relative to e at times t, shape (n,), s."""
        t = require_within(t, (float(self.t[0]), float(self.t[-1])))
        value, first, second = (spline(t) for spline in self._splines)
        q_eb, omega_eb_b, alpha_eb_b = turning(value[:, 3:], first[:, 3:], second[:, 3:])
        position = self.r_e[0] + value[:, :3]
        return EarthFixed(position, first[:, :3].copy(), second[:, :3].copy(), q_eb, omega_eb_b, alpha_eb_b)
