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
        from bench.motion._earth_motion_kernels import inertial

        t = require_array("t", t, (None,))
        now = self.earth_fixed(t)
        motion = now.q_eb, now.omega_eb_b, now.alpha_eb_b, now.r_e, now.v_e, now.a_e
        G_e = self.earth.gravitation(now.r_e)
        return Kinematics(*inertial(self.earth.rate, self.earth.q_ie(t), *motion, G_e))

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

    Not for paths through a pole, where the longitude jumps.
    """
    from bench.motion._earth_motion_kernels import from_geodetic

    path = columns(*latitude, *longitude, *height)
    r_e = earth.position(latitude[0], longitude[0], height[0])
    return EarthFixed(r_e, *from_geodetic(earth.parameters, path, q_nb, omega_nb_b, alpha_nb_b))


def from_velocity(
    earth: Earth, place: Array, v_n: Array, dv_n: Array, q_nb: Array, omega_nb_b: Array, alpha_nb_b: Array
) -> EarthFixed:
    """Return the Earth-fixed motion of places (latitude, longitude, height) passed with v_n and v_n' (m/s, m/s^2).

    Not for paths through a pole.
    """
    from bench.motion._earth_motion_kernels import from_velocity

    r_e = earth.position(*place.T)
    return EarthFixed(r_e, *from_velocity(earth.parameters, place, v_n, dv_n, q_nb, omega_nb_b, alpha_nb_b))
