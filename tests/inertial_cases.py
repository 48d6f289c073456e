"""Motions, increments and errors for the tests of the navigation solvers that work in the inertial frame."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

import bench
from bench.earth import WGS84, Earth
from bench.motion._earth_motion import EarthFixed, EarthMotion
from bench.motion.fast_vehicle import FastVehicle
from bench.rotation import quat_from_rotvec, quat_multiply
from bench.trajectory import NavigationInitial, navigation_errors

LEVEL = FastVehicle(swing=(0.0, 0.0, 0.0))
SWING = FastVehicle()
WEAVE = FastVehicle(weave=(1000.0, 600.0, 400.0), swing=(0.0, 0.0, 0.0))
HARD = FastVehicle(weave=(1000.0, 600.0, 400.0))
RATE = 100.0
EMPTY = Earth("empty", 6.4e6, 0.0, 1e-290, 0.0, 0.0, "j2", WGS84.source)  # neither turns nor attracts


@dataclass(frozen=True)
class OverThePole(EarthMotion):
    """A straight line in e through the axis, 20 km above the pole, with a body that turns at a constant rate in e."""

    speed: float = 3000.0
    half_way: float = 5.0  # s, at the pole
    rate: tuple = (0.3, -0.2, 0.5)  # rad/s, in b
    earth: Earth = WGS84

    def earth_fixed(self, t):
        t = np.asarray(t, dtype=float)
        direction = np.array([0.6, 0.8, 0.0])
        above = np.array([0.0, 0.0, self.earth.semi_minor_axis + 20000.0])
        r_e = above + self.speed * (t - self.half_way)[:, None] * direction
        rows = np.ones((len(t), 1))
        q = quat_multiply(np.array([0.5, 0.5, -0.5, 0.5]), quat_from_rotvec(t[:, None] * np.array(self.rate)))
        return EarthFixed(
            r_e, rows * self.speed * direction, rows * np.zeros(3), q, rows * np.array(self.rate), rows * np.zeros(3)
        )


@lru_cache(maxsize=16)
def sensed(motion, duration, rate=RATE):
    """Return MuJoCo's increments of a motion; do not write into them."""
    return bench.Rig.load("imu", threads=1).increments(motion, rate, duration)


def flown(motion, duration, name, rate=RATE, **options):
    """Return the estimate of a solver from MuJoCo's increments, over as many whole updates as there are."""
    increments, solver = sensed(motion, duration, rate), bench.solver("navigation", name, **options)
    n = len(increments) // solver.samples * solver.samples
    initial = motion.navigation_initial()
    return solver.solve(increments.dtheta_b[:n], increments.dvel[:n], increments.dt, initial, motion.earth)


def largest(estimate, motion):
    """Return the largest errors of an estimate: attitude, rad, velocity, m/s, and position, m, east, north, up."""
    found = navigation_errors(estimate, motion.trajectory(estimate.t))
    return tuple(np.abs(part).max(axis=0) for part in (found.attitude, found.velocity, found.position))


def apart(a, b):
    """Return the largest differences of two estimates: attitude, rad, velocity, m/s, position, m."""
    found = navigation_errors(a, b)
    return tuple(np.linalg.norm(part, axis=1).max() for part in (found.attitude, found.velocity, found.position))


def at_rest(hours, height=100.0):
    """Return a motion at rest on the Earth and its increments at 100 Hz: all equal, and so from MuJoCo's first ones."""
    motion = FastVehicle(speed=0.0, height=height, attitude=(0.7, 0.1, -0.2), swing=(0.0, 0.0, 0.0))
    first, n = sensed(motion, 0.1), int(hours * 3600 * RATE)
    dtheta, dvel = (np.tile(part.mean(axis=0), (n, 1)) for part in (first.dtheta_b, first.dvel))
    return motion, dtheta, dvel, 1 / RATE


def constant_screw(omega, f, n, dt):
    """Return increments of a constant rate and a constant force in the body, and its attitude, velocity, position.

    In i, from rest at the origin at the ends of the n intervals; the closed forms of Rodrigues in s = |omega| t.
    """
    omega, f = np.asarray(omega, dtype=float), np.asarray(f, dtype=float)
    t = np.arange(n + 1)[:, None] * dt
    w = np.linalg.norm(omega)
    s, axis = w * t, omega / w
    once = np.cross(axis, f)
    twice = np.cross(axis, once)
    velocity = f * t + (1 - np.cos(s)) / w * once + (t - np.sin(s) / w) * twice
    position = f * t**2 / 2 + (t - np.sin(s) / w) / w * once + (t**2 / 2 - (1 - np.cos(s)) / w**2) * twice
    q = np.concatenate([np.cos(s / 2), np.sin(s / 2) * axis], axis=1)
    return np.tile(omega * dt, (n, 1)), np.tile(f * dt, (n, 1)), q, velocity, position


def in_empty_space():
    """Return the initial state of `constant_screw` on `EMPTY`: at (a, 0, 0), n's axes there, body along those of i."""
    q_en = EMPTY.q_en(0.0, 0.0)
    return NavigationInitial(q_en * [1.0, -1.0, -1.0, -1.0], latitude=0.0, longitude=0.0)
