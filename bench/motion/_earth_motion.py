"""What motions on the rotating Earth share: exact inertial kinematics from Earth-fixed or geodetic ones."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import final

import numpy as np

from bench.earth import Earth
from bench.errors import Array, require_array
from bench.motion import Motion
from bench.motion._euler_rates import Jet
from bench.motion._waves import columns
from bench.rotation import cross, quat_conjugate, quat_multiply, quat_normalize, quat_rotate
from bench.signals import Kinematics
from bench.trajectory import NavigationInitial, Trajectory


@dataclass(frozen=True, eq=False)
class EarthFixed:
    """Motion of b relative to the Earth frame e at n times.

    Attributes
    ----------
    r_e, v_e, a_e : ndarray, shape (n, 3), m, m/s, m/s^2
        Position in e and its first two derivatives there.
    q_eb : ndarray, shape (n, 4)
    omega_eb_b, alpha_eb_b : ndarray, shape (n, 3), rad/s, rad/s^2
        Angular rate of b relative to e and its derivative, in b.
    """

    r_e: Array
    v_e: Array
    a_e: Array
    q_eb: Array
    omega_eb_b: Array
    alpha_eb_b: Array


class EarthMotion(Motion):
    """A motion relative to the rotating Earth; i agrees with e at t = 0.

    A motion of this kind defines `earth` and `earth_fixed`, nothing else.
    """

    earth: Earth

    @abstractmethod
    def earth_fixed(self, t: Array) -> EarthFixed:
        """Return the motion relative to e at times t, shape (n,), s."""

    @final
    def kinematics(self, t: Array) -> Kinematics:
        """Return the true kinematics in i at times t, shape (n,), s: Coriolis and centrifugal terms in closed form."""
        t = require_array("t", t, (None,))
        now = self.earth_fixed(t)
        q_ie, omega_e = self.earth.q_ie(t), self.earth.omega_ie
        turning = cross(omega_e, now.r_e)
        acceleration = now.a_e + 2 * cross(omega_e, now.v_e) + cross(omega_e, turning)
        omega_ie_b = quat_rotate(quat_conjugate(now.q_eb), omega_e)
        return Kinematics(
            position=quat_rotate(q_ie, now.r_e),
            velocity=quat_rotate(q_ie, now.v_e + turning),
            acceleration=quat_rotate(q_ie, acceleration),
            q_ib=quat_normalize(quat_multiply(q_ie, now.q_eb)),
            omega_ib_b=now.omega_eb_b + omega_ie_b,
            alpha_ib_b=now.alpha_eb_b - cross(now.omega_eb_b, omega_ie_b),
            gravity=quat_rotate(q_ie, self.earth.gravitation(now.r_e)),
        )

    @final
    def trajectory(self, t: Array) -> Trajectory:
        """Return the true attitude, velocity and position on the Earth at times t, shape (n,), s."""
        t = require_array("t", t, (None,))
        now = self.earth_fixed(t)
        return Trajectory(self.earth, t, now.q_eb, now.v_e, now.r_e)

    @final
    def navigation_initial(self, t0: float = 0.0) -> NavigationInitial:
        """Return the true state at t0, as navigation solvers are told it."""
        return self.trajectory(np.array([float(t0)])).initial()


def from_geodetic(
    earth: Earth, latitude: Jet, longitude: Jet, height: Jet, q_nb: Array, omega_nb_b: Array, alpha_nb_b: Array
) -> EarthFixed:
    """Return the Earth-fixed motion of a geodetic path (rad, m, with derivatives) and an attitude relative to n.

    v_n = [(R_N + h) cosL lambda', (R_M + h) L', h'], a_n = v_n' + omega_en x v_n, omega_en = [-L', lambda' cosL,
    lambda' sinL]. Not for paths through a pole, where the longitude jumps.
    """
    (L, dL, ddL), (lon, dlon, ddlon), (h, dh, ddh) = latitude, longitude, height
    s, c = np.sin(L), np.cos(L)
    R_M, R_N = earth.radii(L)
    # d(R_N cosL)/dL = -R_M sinL, and dR_M/dL = 3 R_M e^2 sinL cosL / (1 - e^2 sin^2 L).
    e2 = earth.eccentricity_squared
    dR_M = 3 * R_M * e2 * s * c / (1 - e2 * s * s) * dL
    arm, darm = (R_N + h) * c, -(R_M + h) * s * dL + dh * c
    v_n = columns(arm * dlon, (R_M + h) * dL, dh)
    dv_n = columns(darm * dlon + arm * ddlon, (dR_M + dh) * dL + (R_M + h) * ddL, ddh)
    omega_en = columns(-dL, dlon * c, dlon * s)
    domega_en = columns(-ddL, ddlon * c - dlon * s * dL, ddlon * s + dlon * c * dL)
    q_en = earth.q_en(L, lon)
    q_bn = quat_conjugate(q_nb)
    omega_en_b = quat_rotate(q_bn, omega_en)
    return EarthFixed(
        r_e=earth.position(L, lon, h),
        v_e=quat_rotate(q_en, v_n),
        a_e=quat_rotate(q_en, dv_n + cross(omega_en, v_n)),
        q_eb=quat_normalize(quat_multiply(q_en, q_nb)),
        omega_eb_b=omega_nb_b + omega_en_b,
        alpha_eb_b=alpha_nb_b + quat_rotate(q_bn, domega_en) - cross(omega_nb_b, omega_en_b),
    )
