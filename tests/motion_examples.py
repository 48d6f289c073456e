"""Examples of motions on the rotating Earth, for the laws that every motion must obey."""

from dataclasses import dataclass

import numpy as np

from bench import rotation as rot
from bench.earth import SPHERE, WGS84_NORMAL
from bench.motion import Motion
from bench.motion.earth_rest import EarthRest
from bench.motion.fast_vehicle import FastVehicle
from bench.motion.great_circle import GreatCircle
from bench.motion.logged_trajectory import LoggedTrajectory
from bench.motion.manoeuvres import Accelerate, Climb, Straight, Turn, Weave
from bench.motion.recorded_turntable import RecordedTurntable
from bench.motion.sinusoidal_velocity import SinusoidalVelocity
from bench.motion.vehicle import Vehicle
from bench.motion.waypoints import Waypoints
from bench.units import DEG


@dataclass(frozen=True)
class Example:
    """A motion, where it is defined, its fastest angular frequency (rad/s), and where it is only C4."""

    motion: Motion
    span: tuple[float, float] = (0.0, 60.0)
    fastest: float = 2.0
    knots: tuple[float, ...] = ()


SWING = {"swing": (0.2, 0.15, 0.3), "swing_frequency": (2.0, 1.4, 1.1), "swing_phase": (0.1, 2.0, 4.5)}
POLAR = GreatCircle(speed=3000.0, swing=(0.0, 0.0, 0.0))  # over the pole after 37 s
LOG_TIMES = np.sort(np.append(np.linspace(0.0, 60.0, 61), [0.3, 31.77]))  # uneven on purpose
MANOEUVRES = (
    Straight(2.0),
    Accelerate(10.0, 30.0),
    Turn(12.0, 200 * DEG, 5.0),
    Weave(18.0, 10 * DEG, 9.0, 6.0),
    Climb(14.0, -20 * DEG, 6.0),
    Accelerate(4.0, -50.0),
)


def logged():
    """A log of the polar flight, every other quaternion with the other sign."""
    log = POLAR.trajectory(LOG_TIMES)
    return LoggedTrajectory(LOG_TIMES, log.r_e, log.q_eb * (-1.0) ** np.arange(len(LOG_TIMES))[:, None])


def waypoints(**options):
    """A winding path through places about a kilometre apart."""
    t = LOG_TIMES[::3]
    return Waypoints(t, 0.8 + 2e-5 * t, 0.3 + 1e-4 * np.sin(0.2 * t), 500 + 50 * np.cos(0.3 * t), **options)


def polar_waypoints():
    log = POLAR.trajectory(LOG_TIMES)
    return Waypoints(LOG_TIMES, log.latitude, log.longitude, log.height, **SWING)


def geodetic_log():
    angles = 0.3 * np.sin(LOG_TIMES / 5), 0.1 * np.cos(LOG_TIMES / 4), 0.2 * np.sin(LOG_TIMES / 6)
    places = -0.5 + 1e-5 * LOG_TIMES, 3.1 + 1e-3 * LOG_TIMES, 1000 + LOG_TIMES  # over the date line
    return LoggedTrajectory.from_geodetic(LOG_TIMES, *places, rot.quat_from_euler(*angles), SPHERE)


def table_angles():
    return np.stack([0.2 * LOG_TIMES, 2 * np.sin(LOG_TIMES / 8), np.cos(LOG_TIMES / 5)], axis=1)


def earth_examples():
    return {
        "earth-rest": [
            Example(EarthRest()),
            Example(EarthRest(np.pi / 2, attitude=(1.0, 0.1, 0.2), sway=(1.0, 0.5, 2.0), **SWING)),
        ],
        "fast-vehicle": [
            Example(FastVehicle(), fastest=9.0),
            Example(FastVehicle(7000.0, weave=(100.0, 80.0, 60.0), earth=WGS84_NORMAL, **SWING), fastest=4.0),
        ],
        "sinusoidal-velocity": [
            Example(SinusoidalVelocity(), span=(3500.0, 3600.0)),
            Example(SinusoidalVelocity(mean=(200.0, 100.0, 0.0), amplitude=(5.0, 20.0, 3.0), follow=False, **SWING)),
            Example(
                SinusoidalVelocity(60.0, 89.9 * DEG, mean=(30.0, 0.0, 0.0), amplitude=(0.0, 3.0, 4.0), phase=(0, 1, 2))
            ),
        ],
        "vehicle": [
            Example(Vehicle(), span=(0.0, 300.0), fastest=16.0),
            Example(Vehicle(MANOEUVRES, speed=50.0, earth=SPHERE, **SWING), fastest=16.0),
            Example(Vehicle(MANOEUVRES, latitude=-1.5, speed=50.0, follow=False, **SWING), fastest=16.0),
        ],
        "great-circle": [
            Example(GreatCircle(), fastest=9.0),
            Example(GreatCircle(-0.2, 1.0, azimuth=-2.0, attitude=(0.3, -0.2, 0.1))),
        ],
        "recorded-turntable": [
            Example(RecordedTurntable(LOG_TIMES, table_angles()), fastest=20.0, knots=tuple(LOG_TIMES)),
        ],
        "waypoints": [
            Example(waypoints(), (0.0, 58.0), 20.0, tuple(LOG_TIMES[::3])),
            Example(polar_waypoints(), fastest=20.0, knots=tuple(LOG_TIMES)),
        ],
        "logged-trajectory": [
            Example(logged(), fastest=20.0, knots=tuple(LOG_TIMES)),
            Example(geodetic_log(), fastest=20.0, knots=tuple(LOG_TIMES)),
        ],
    }
