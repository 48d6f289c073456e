"""Attitude, velocity and position on the Earth over time: what navigation solvers give, truth and references alike.

Stored in the Earth frame e, which has no singular point; latitude, longitude, height and everything in the
navigation frame n (east-north-up) are views of it.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from bench.earth import Earth, require_latitude
from bench.errors import Array, InputError, require_array, require_instance, require_scalar, require_unit_quaternion
from bench.rotation import cross, quat_conjugate, quat_multiply, quat_normalize, quat_rotate
from bench.signals import Kinematics


@dataclass(frozen=True, eq=False)
class NavigationInitial:
    """What a navigation solver must be told before the first increment.

    Attributes
    ----------
    q_nb : ndarray, shape (4,)
        Attitude, b to n (east-north-up at the position), wxyz, unit.
    v_n : ndarray, shape (3,), m/s
        Velocity relative to the Earth, east, north, up.
    latitude, longitude : float, rad
        Geodetic; at a pole the longitude says where n's axes point.
    height : float, m
        Above the ellipsoid.

    Raises
    ------
    InputError
        If a value has another shape, is not finite, or the latitude exceeds pi/2.
    """

    q_nb: Array
    v_n: Array
    latitude: float
    longitude: float
    height: float

    def __init__(
        self,
        q_nb: ArrayLike = (1.0, 0.0, 0.0, 0.0),
        v_n: ArrayLike = (0.0, 0.0, 0.0),
        *,
        latitude: float,
        longitude: float,
        height: float = 0.0,
    ):
        latitude = float(require_latitude(require_scalar("latitude", latitude)))
        longitude = require_scalar("longitude", longitude)
        if abs(longitude) > 2 * np.pi:
            raise InputError(f"longitude must be within +-2 pi rad, got {longitude!r} (degrees?)")
        set_field = object.__setattr__
        set_field(self, "q_nb", require_unit_quaternion("q_nb", q_nb))
        set_field(self, "v_n", require_array("v_n", v_n, (3,)))
        set_field(self, "latitude", latitude)
        set_field(self, "longitude", longitude)
        set_field(self, "height", require_scalar("height", height))


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Attitude, velocity and position on the Earth at n times.

    Attributes
    ----------
    earth : Earth
    t : ndarray, shape (n,), s
    q_eb : ndarray, shape (n, 4)
        Attitude, b to e, wxyz, unit.
    v_e : ndarray, shape (n, 3), m/s
        Velocity relative to the Earth, in e.
    r_e : ndarray, shape (n, 3), m
        Position from the centre of the Earth, in e.

    Raises
    ------
    InputError
        If a field has another shape or is not finite, or a quaternion is not unit.
    """

    earth: Earth
    t: Array
    q_eb: Array
    v_e: Array
    r_e: Array

    def __post_init__(self) -> None:
        require_instance("earth", self.earth, Earth)
        t = require_array("t", self.t, (None,))
        object.__setattr__(self, "t", t)
        object.__setattr__(self, "q_eb", require_unit_quaternion("q_eb", self.q_eb, (len(t), 4)))
        for name in ("v_e", "r_e"):
            object.__setattr__(self, name, require_array(name, getattr(self, name), (len(t), 3)))

    def __getitem__(self, rows: slice) -> "Trajectory":
        """Return some of the rows, such as ``trajectory[:100]``."""
        return Trajectory(self.earth, self.t[rows], self.q_eb[rows], self.v_e[rows], self.r_e[rows])

    def __len__(self) -> int:
        return len(self.t)

    @classmethod
    def of(cls, truth: Kinematics, t: ArrayLike, earth: Earth) -> "Trajectory":
        """Return the trajectory of true kinematics in the inertial frame that agrees with e at t = 0.

        Raises
        ------
        InputError
            If there are not as many rows as times, or one row that is meant for all.
        """
        t = require_array("t", t, (None,))
        truth = truth.repeated(len(t))
        q_ei = quat_conjugate(earth.q_ie(t))
        r_e = quat_rotate(q_ei, truth.position)
        v_e = quat_rotate(q_ei, truth.velocity) - cross(earth.omega_ie, r_e)
        return cls(earth, t, quat_normalize(quat_multiply(q_ei, truth.q_ib)), v_e, r_e)

    @classmethod
    def from_geodetic(
        cls,
        earth: Earth,
        t: ArrayLike,
        q_nb: ArrayLike,
        v_n: ArrayLike,
        latitude: ArrayLike,
        longitude: ArrayLike,
        height: ArrayLike,
    ) -> "Trajectory":
        """Return the trajectory of geodetic positions (rad, m) with attitude and velocity in n (east-north-up)."""
        t = require_array("t", t, (None,))
        latitude, longitude, height = (
            require_array(name, value, (len(t),))
            for name, value in (("latitude", latitude), ("longitude", longitude), ("height", height))
        )
        q_en = earth.q_en(latitude, longitude)
        q_eb = quat_normalize(quat_multiply(q_en, require_unit_quaternion("q_nb", q_nb, (len(t), 4))))
        v_e = quat_rotate(q_en, require_array("v_n", v_n, (len(t), 3)))
        return cls(earth, t, q_eb, v_e, earth.position(latitude, longitude, height))

    @cached_property
    def _geodetic(self) -> tuple[Array, Array, Array]:
        return self.earth.geodetic(self.r_e)

    @property
    def latitude(self) -> Array:
        """Geodetic latitude, shape (n,), rad."""
        return self._geodetic[0]

    @property
    def longitude(self) -> Array:
        """Longitude, shape (n,), rad, in (-pi, pi]."""
        return self._geodetic[1]

    @property
    def height(self) -> Array:
        """Height above the ellipsoid, shape (n,), m."""
        return self._geodetic[2]

    @cached_property
    def q_en(self) -> Array:
        """Attitude of n (east-north-up) in e, shape (n, 4)."""
        return self.earth.q_en(self.latitude, self.longitude)

    @cached_property
    def q_nb(self) -> Array:
        """Attitude, b to n, shape (n, 4)."""
        return quat_normalize(quat_multiply(quat_conjugate(self.q_en), self.q_eb))

    @cached_property
    def v_n(self) -> Array:
        """Velocity relative to the Earth in n (east, north, up), shape (n, 3), m/s."""
        return quat_rotate(quat_conjugate(self.q_en), self.v_e)

    def initial(self, row: int = 0) -> NavigationInitial:
        """Return one row as what a navigation solver is told at the start."""
        return NavigationInitial(
            self.q_nb[row],
            self.v_n[row],
            latitude=float(self.latitude[row]),
            longitude=float(self.longitude[row]),
            height=float(self.height[row]),
        )


@dataclass(frozen=True, eq=False)
class NavigationErrors:
    """Estimate minus truth at n times, in the true n frame (east, north, up).

    Attributes
    ----------
    t : ndarray, shape (n,), s
    attitude : ndarray, shape (n, 3), rad
        Rotation vector of q_eb_est o q_eb_true*, resolved in n: it holds no part of the position error.
    velocity : ndarray, shape (n, 3), m/s
        C_ne (v_e_est - v_e_true).
    position : ndarray, shape (n, 3), m
        C_ne (r_e_est - r_e_true).
    """

    t: Array
    attitude: Array
    velocity: Array
    position: Array


def navigation_errors(estimate: Trajectory, truth: Trajectory) -> NavigationErrors:
    """Return the errors of an estimate against truth at the same times.

    Raises
    ------
    InputError
        If the Earth models or the lengths differ, or the times differ by more than 1e-6 s.
    """
    from bench.evaluation import attitude_error

    if estimate.earth != truth.earth:
        names = f"{estimate.earth.name} and {truth.earth.name}"
        raise InputError(f"estimate and truth must be on the same Earth, got {names}")
    if len(estimate) != len(truth):
        raise InputError(f"estimate and truth must have the same length, got {len(estimate)} and {len(truth)}")
    if (gap := np.abs(estimate.t - truth.t).max()) > 1e-6:
        raise InputError(f"estimate and truth must have the same times, they differ by up to {gap:g} s")
    q_ne = quat_conjugate(truth.q_en)
    return NavigationErrors(
        truth.t,
        quat_rotate(q_ne, attitude_error(estimate.q_eb, truth.q_eb)),
        quat_rotate(q_ne, estimate.v_e - truth.v_e),
        quat_rotate(q_ne, estimate.r_e - truth.r_e),
    )
