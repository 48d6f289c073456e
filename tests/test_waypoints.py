"""Motions on the Earth through given places and poses: what the curve must pass, how near it comes to the motion it
samples, the attitude that follows it by hand-made normals, and what a log gives back through MuJoCo.
"""

import math

import numpy as np
import pytest

import bench
from bench import rotation as rot
from bench.earth import SPHERE, WGS84
from bench.errors import InputError
from bench.motion.great_circle import GreatCircle
from bench.motion.logged_trajectory import LoggedTrajectory
from bench.motion.vehicle import Vehicle
from bench.motion.waypoints import Waypoints
from bench.trajectory import Trajectory
from bench.units import DEG
from tests.motion_examples import LOG_TIMES, POLAR, logged, polar_waypoints, waypoints

EPS = float(np.finfo(float).eps)
EIGHT = np.arange(8.0)


def angle_between(p, q):
    return 2 * np.linalg.norm(rot.quat_multiply(rot.quat_conjugate(p), q)[:, 1:], axis=1)


# Waypoints


def test_the_path_passes_its_waypoints():
    motion = waypoints()
    r_e = WGS84.position(motion.latitude, motion.longitude, motion.height)
    np.testing.assert_allclose(motion.trajectory(motion.t).r_e, r_e, rtol=0, atol=2e-9)  # two roundings at 6.4e6 m


def test_between_distant_waypoints_the_path_stays_on_the_arc():
    """500 km apart on a great circle of a sphere: D^6/(15360 R^5) = 0.1 mm, the error of an interpolating quintic on
    even knots (max |B_6(x) - B_6| / 6! = 1/15360) whose sixth derivative is R (v/R)^6; far from the ends.
    """
    circle = GreatCircle(10 * DEG, 20 * DEG, 0.0, azimuth=0.7, speed=250.0, earth=SPHERE)
    t = np.arange(60) * 2000.0
    log = circle.trajectory(t)
    motion = Waypoints(t, log.latitude, log.longitude, log.height, earth=SPHERE)
    between = np.linspace(t[20], t[-20], 1001)
    off = np.linalg.norm(motion.trajectory(between).r_e - circle.trajectory(between).r_e, axis=1).max()
    expected = (250.0 * 2000.0) ** 6 / 15360 / 6371000.0**5
    assert 0.95 * expected < off < 1.05 * expected
    assert expected < 1.1e-4


@pytest.mark.parametrize("motion", [waypoints(), polar_waypoints()], ids=["winding", "polar"])
def test_the_attitude_follows_the_velocity(motion):
    """y along the velocity; x at right angles to it and to the normal of the ellipsoid, which is the gradient of
    (x^2 + y^2)/a^2 + z^2/b^2 for the footpoint; z upwards. Without the swing, to a few roundings.
    """
    still = Waypoints(motion.t, motion.latitude, motion.longitude, motion.height)
    t = np.linspace(0.0, motion.t[-1], 300)
    tr = still.trajectory(t)
    C = rot.matrix_from_quat(tr.q_eb)
    foot = WGS84.position(tr.latitude, tr.longitude, 0.0)
    normal = foot / np.array([6378137.0, 6378137.0, 6378137.0 * (1 - 1 / 298.257223563)]) ** 2
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    speed = np.linalg.norm(tr.v_e, axis=1, keepdims=True)
    np.testing.assert_allclose(C[:, :, 1], tr.v_e / speed, rtol=0, atol=16 * EPS)
    np.testing.assert_allclose((C[:, :, 0] * normal).sum(axis=1), 0, rtol=0, atol=16 * EPS)
    assert ((C[:, :, 2] * normal).sum(axis=1) > 0.9).all()


def test_over_the_pole_the_attitude_goes_on():
    """The polar flight follows a circle round the Earth's centre, the waypoints' attitude the ellipsoid: the pitch
    between them is the difference of geodetic and geocentric vertical, at most 1.2e-4 rad within 1 deg of the pole.
    """
    log = POLAR.trajectory(LOG_TIMES)
    motion = Waypoints(LOG_TIMES, log.latitude, log.longitude, log.height)
    t = np.linspace(1.0, 59.0, 500)
    assert angle_between(motion.trajectory(t).q_eb, POLAR.trajectory(t).q_eb).max() < 1.3e-4
    assert np.abs(motion.kinematics(t).omega_ib_b - POLAR.kinematics(t).omega_ib_b).max() < 1e-5


def test_the_swing_turns_the_body_from_its_course():
    motion = waypoints(attitude=(0.3, -0.1, 0.2))
    t = np.linspace(0.0, 50.0, 20)
    between = rot.quat_multiply(rot.quat_conjugate(waypoints().trajectory(t).q_eb), motion.trajectory(t).q_eb)
    np.testing.assert_allclose(np.abs(between @ rot.quat_from_euler(0.3, -0.1, 0.2)), 1, rtol=0, atol=8 * EPS)


# Logged trajectories


def test_the_curve_passes_its_poses():
    motion, log = logged(), POLAR.trajectory(LOG_TIMES)
    again = motion.trajectory(LOG_TIMES)
    np.testing.assert_allclose(again.r_e, log.r_e, rtol=0, atol=2e-9)
    assert angle_between(again.q_eb, log.q_eb).max() < 1e-14


def test_a_log_of_a_drive_feels_like_the_drive():
    """Poses of a weave with a period of 10 s: specific force and rate through MuJoCo come with the fourth and fifth
    power of the spacing at least, until a rounding of a position, 1e-9 m, over the square of the spacing is left.
    """
    drive, rig = Vehicle(), bench.Rig.load("imu", threads=1)
    t = np.linspace(135.0, 165.0, 301) + 0.0137
    truth, errors = rig.sample(drive, t), []
    for step in (0.5, 0.25, 0.01):
        log = drive.trajectory(120.0 + step * np.arange(round(60 / step) + 1))
        readings = rig.sample(LoggedTrajectory.of(log), t)
        force = np.abs(readings.accelerometers - truth.accelerometers).max()
        errors.append((force, np.abs(readings.gyro - truth.gyro).max()))
    orders = np.log2(np.array(errors[0]) / errors[1])
    assert orders[0] > 3.5
    assert orders[1] > 4.5
    assert errors[0][0] < 2e-3
    assert errors[2][0] < 20 * 1e-9 / 0.01**2
    assert errors[2][1] < 1e-12


def test_a_log_may_be_geodetic():
    """The same motion from latitude, longitude, height and attitude to n as from a trajectory; over the date line."""
    circle = GreatCircle(10 * DEG, math.pi - 1e-4, azimuth=1.0)
    t = np.linspace(0.0, 20.0, 41)
    log = circle.trajectory(t)
    assert np.ptp(log.longitude) > 6
    geodetic = LoggedTrajectory.from_geodetic(t, log.latitude, log.longitude, log.height, log.q_nb)
    between = np.linspace(0.3, 19.7, 100)
    np.testing.assert_allclose(
        geodetic.trajectory(between).r_e, LoggedTrajectory.of(log).trajectory(between).r_e, rtol=0, atol=5e-9
    )
    np.testing.assert_allclose(geodetic.trajectory(between).r_e, circle.trajectory(between).r_e, rtol=0, atol=5e-9)
    assert geodetic.earth is WGS84


def test_logs_and_waypoints_keep_their_own_copies():
    log = POLAR.trajectory(LOG_TIMES)
    t, r_e, height = LOG_TIMES.copy(), log.r_e.copy(), log.height.copy()
    motions = [LoggedTrajectory(t, r_e, log.q_eb), Waypoints(t, log.latitude, log.longitude, height)]
    before = [motion.kinematics([30.5]).position for motion in motions]
    t[:], r_e[:], height[:] = 0, 0, 0
    for motion, position in zip(motions, before, strict=True):
        np.testing.assert_array_equal(motion.kinematics([30.5]).position, position)


TUMBLE = rot.quat_from_rotvec(EIGHT[:, None] * np.array([0.0, 0.0, 100 * DEG]))
STILL = np.tile([6.4e6, 0.0, 0.0], (8, 1))
FLAT = np.zeros(8)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Waypoints(EIGHT[:5], FLAT[:5], FLAT[:5], FLAT[:5]), "t must hold at least 6 times .* got 5"),
        (lambda: Waypoints(EIGHT[::-1], FLAT, FLAT, FLAT), r"t must increase strictly, got t\[0\] = 7.0"),
        (lambda: Waypoints(EIGHT, FLAT[:7], FLAT, FLAT), r"latitude must have shape \(8,\), got \(7,\)"),
        (lambda: Waypoints(EIGHT, FLAT + 45, FLAT, FLAT), r"latitude must be within \+-pi/2 rad, got 45 \(degrees"),
        (lambda: Waypoints(EIGHT, FLAT, FLAT, FLAT, earth=1), "earth must be an Earth, got 1"),
        (lambda: Waypoints(EIGHT, FLAT, FLAT, FLAT, swing=(1, 2)), r"swing must have shape \(3,\), got \(2,\)"),
        (lambda: Waypoints(EIGHT, FLAT, FLAT, FLAT).kinematics([1.0]), "velocity that vanishes or is vertical"),
        (lambda: LoggedTrajectory(EIGHT, STILL[:7], TUMBLE), r"r_e must have shape \(8, 3\), got \(7, 3\)"),
        (lambda: LoggedTrajectory(EIGHT, STILL, np.ones((8, 4))), "q_eb must be unit quaternions"),
        (lambda: LoggedTrajectory(EIGHT, STILL, TUMBLE), "q_eb must turn by at most 90 deg .* 100 deg from t = 0.0"),
        (lambda: LoggedTrajectory.of(STILL), "trajectory must be a Trajectory"),
        (lambda: LoggedTrajectory.from_geodetic(EIGHT, FLAT, FLAT, FLAT, TUMBLE, "wgs84"), "earth must be an Earth"),
    ],
)
def test_bad_input_is_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize("motion", [waypoints(), logged()], ids=["waypoints", "logged"])
def test_times_outside_are_refused(motion):
    with pytest.raises(InputError, match=r"t must lie in the motion's span \[0.0, (58|60).0\] s, got t\[1\] = 60.1"):
        motion.kinematics([3.0, 60.1])


def test_a_solvers_trajectory_may_be_flown_again():
    """Any `Trajectory` will do, on its own Earth."""
    log = Trajectory(SPHERE, EIGHT, np.tile([1.0, 0, 0, 0], (8, 1)), np.zeros((8, 3)), STILL)
    motion = LoggedTrajectory.of(log)
    assert motion.earth is SPHERE
    np.testing.assert_allclose(motion.trajectory([3.3]).v_e, 0.0, rtol=0, atol=1e-9)
