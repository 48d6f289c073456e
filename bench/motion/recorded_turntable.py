"""Recorded turntable: the recorded axis angles of a three-axis table that stands on the rotating Earth."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from bench.earth import WGS84, Earth
from bench.errors import Array, require_array
from bench.motion._earth_motion import EarthFixed, EarthMotion
from bench.motion._earth_options import check_place
from bench.motion._euler_rates import euler_rates
from bench.motion._options import require_within, set_options
from bench.motion._spline_curve import quintic, require_knots
from bench.rotation import quat_multiply, quat_normalize
from bench.units import DEG

if TYPE_CHECKING:
    from scipy.interpolate import BSpline


@dataclass(frozen=True, eq=False)
class RecordedTurntable(EarthMotion):
    """Recorded turntable: the recorded axis angles of a three-axis table that stands on the rotating Earth.

    The axes meet in one point, where the body is: it turns and does not move. Its attitude is
    C_nb = Rz(psi) Rx(P) Ry(R), the outer axis turning psi = -heading, the middle one the pitch, the inner one the roll.
    Through each angle goes an interpolating quintic, so that rates and their derivatives are exact derivatives of the
    angles; it is C4, and polynomial between two records.

    Parameters
    ----------
    t : array_like, shape (n,), s
        Times of the records, strictly increasing, n >= 6; they are the motion's span.
    angles : array_like, shape (n, 3), rad
        psi, P, R of the outer, middle and inner axis, continuous (not wrapped).
    latitude, longitude : float, rad
        Geodetic, of the table.
    height : float, m
        Above the ellipsoid.
    earth : Earth

    Raises
    ------
    InputError
        If an option has another shape, is not finite or out of range, the times do not increase, or there are fewer
        than 6; in use, if a time lies outside the span.
    """

    name: ClassVar[str] = "recorded-turntable"

    t: Array
    angles: Array
    latitude: float = 32.06 * DEG
    longitude: float = 118.8 * DEG
    height: float = 0.0
    earth: Earth = WGS84

    def __post_init__(self) -> None:
        check_place(self.earth, self.latitude, self.longitude, self.height)
        t = require_knots("t", self.t)  # copies: the caller may go on using the arrays
        set_options(self, t=t, angles=require_array("angles", self.angles, (len(t), 3)).copy())

    @cached_property
    def _splines(self) -> "tuple[BSpline, ...]":
        """The spline through the angles and its first two derivatives."""
        return quintic(self.t, self.angles, 2)

    def earth_fixed(self, t: Array) -> EarthFixed:
        """Return the motion relative to e at times t, shape (n,), s."""
        t = require_within(t, (float(self.t[0]), float(self.t[-1])))
        value, first, second = (spline(t) for spline in self._splines)
        q_nb, omega_nb_b, alpha_nb_b = euler_rates(*((value[:, k], first[:, k], second[:, k]) for k in range(3)))
        q_en = self.earth.q_en(self.latitude, self.longitude)
        return EarthFixed(
            r_e=np.tile(self.earth.position(self.latitude, self.longitude, self.height), (len(t), 1)),
            v_e=np.zeros((len(t), 3)),
            a_e=np.zeros((len(t), 3)),
            q_eb=quat_normalize(quat_multiply(q_en, q_nb)),
            omega_eb_b=omega_nb_b,
            alpha_eb_b=alpha_nb_b,
        )
