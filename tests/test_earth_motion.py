"""Motions on the rotating Earth in closed form: MuJoCo's readings and all kinematics against 40-digit derivatives of
the geodetic path and the attitude matrices (tests/earth_motion_reference.py), at 7 km/s, over poles, after an hour.
"""

import math

import mpmath as mp
import numpy as np
import pytest

import bench
from bench import rotation as rot
from bench.earth import SPHERE, WGS84, WGS84_NORMAL
from bench.errors import InputError
from bench.motion.earth_rest import EarthRest
from bench.motion.fast_vehicle import FastVehicle
from bench.motion.great_circle import GreatCircle
from bench.trajectory import Trajectory
from bench.units import DEG
from tests import earth_motion_reference as ref

EPS = float(np.finfo(float).eps)
SWING = {"swing": (0.2, 0.15, 0.3), "swing_frequency": (6.3, 5.1, 4.2), "swing_phase": (0.1, 2.0, 4.5)}


@pytest.fixture(scope="module")
def rig():
    return bench.Rig.load("imu", threads=1)


def swing_of(motion):
    """C of the motion's swing as a function of time."""
    angles = [
        ref.sine(motion.attitude[k], 0.0, motion.swing[k], motion.swing_frequency[k], motion.swing_phase[k])
        for k in range(3)
    ]
    return lambda t: ref.C_nb(*(angle(t) for angle in angles))


def fast_vehicle_truth(motion):
    """r_e and C_eb of a `FastVehicle` as functions of time, from its definition."""
    L0, lon0, h0 = (ref.exact(x) for x in (motion.latitude, motion.longitude, motion.height))
    w2 = 1 - ref.E2 * mp.sin(L0) ** 2
    north = ref.A * (1 - ref.E2) / w2 ** mp.mpf("1.5") + h0
    east = (ref.A / mp.sqrt(w2) + h0) * mp.cos(L0)
    speed, azimuth = ref.exact(motion.speed), ref.exact(motion.azimuth)
    rates = speed * mp.sin(azimuth) / east, speed * mp.cos(azimuth) / north, ref.exact(motion.climb)
    waves = [
        (lambda t, k=k: mp.sin(ref.exact(motion.weave_frequency[k]) * t + ref.exact(motion.weave_phase[k])))
        for k in range(3)
    ]
    weave = [ref.exact(x) for x in motion.weave]

    def place(t):
        return (
            L0 + rates[1] * t + weave[1] / north * waves[1](t),
            lon0 + rates[0] * t + weave[0] / east * waves[0](t),
            h0 + rates[2] * t + weave[2] * waves[2](t),
        )

    swing = swing_of(motion)
    return lambda t: ref.position_e(*place(t)), lambda t: ref.C_en(*place(t)[:2]) * swing(t)


def earth_rest_truth(motion):
    L, lon, h = (ref.exact(x) for x in (motion.latitude, motion.longitude, motion.height))
    sway = [ref.sine(0.0, 0.0, motion.sway[k], motion.sway_frequency[k], motion.sway_phase[k]) for k in range(3)]
    level = ref.C_en(L, lon) * ref.about("z", ref.exact(motion.attitude[0]))
    swing = swing_of(motion)
    return (
        lambda t: ref.position_e(L, lon, h) + level * mp.matrix([wave(t) for wave in sway]),
        lambda t: ref.C_en(L, lon) * swing(t),
    )


def great_circle_truth(motion):
    """The circle in the plane of the start and its course; away from the Earth's centre is up."""
    L, lon, h = (ref.exact(x) for x in (motion.latitude, motion.longitude, motion.height))
    start, azimuth = ref.position_e(L, lon, h), ref.exact(motion.azimuth)
    course = ref.C_en(L, lon) * mp.matrix([mp.sin(azimuth), mp.cos(azimuth), 0])
    radius = mp.norm(start)
    up = start / radius
    ahead = course - up * (course.T * up)[0]
    ahead = ahead / mp.norm(ahead)
    right = mp.matrix(
        [ahead[1] * up[2] - ahead[2] * up[1], ahead[2] * up[0] - ahead[0] * up[2], ahead[0] * up[1] - ahead[1] * up[0]]
    )
    rate, swing = ref.exact(motion.speed) / radius, swing_of(motion)

    def axes(t):
        c, s = mp.cos(rate * t), mp.sin(rate * t)
        forward, away = ahead * c - up * s, up * c + ahead * s
        return mp.matrix([[right[k], forward[k], away[k]] for k in range(3)])

    return lambda t: radius * (up * mp.cos(rate * t) + ahead * mp.sin(rate * t)), lambda t: axes(t) * swing(t)


WEAVE = {"weave": (40.0, 60.0, 25.0), "weave_frequency": (1.1, 0.7, 1.3), "weave_phase": (0.4, -1.0, 2.0)}
CASES = {
    "orbital-speed": (FastVehicle(7000.0, longitude=0.3, **SWING), fast_vehicle_truth, (0.0, 37.3, 100.0)),
    "orbital-manoeuvre": (FastVehicle(7000.0, -2.0, climb=30.0, **WEAVE), fast_vehicle_truth, (0.0, 11.1, 99.9)),
    "an-hour-east": (FastVehicle(300.0, 90 * DEG, **WEAVE, **SWING), fast_vehicle_truth, (3599.99,)),
    "high": (FastVehicle(3000.0, height=3.5e7), fast_vehicle_truth, (50.0,)),
    "rest": (EarthRest(attitude=(0.5, -0.2, 0.3), height=1234.5), earth_rest_truth, (0.0, 3600.0)),
    "moored": (
        EarthRest(-0.6, -1.2, attitude=(2.0, 0.01, -0.02), sway=(0.5, 0.3, 1.0), **SWING),
        earth_rest_truth,
        (0.0, 3600.1),
    ),
    "on-the-pole": (EarthRest(math.pi / 2, 1.0, sway=(0.5, 0.3, 1.0), **SWING), earth_rest_truth, (12.3,)),
    "over-the-pole": (GreatCircle(speed=7000.0, **SWING), great_circle_truth, (0.0, 15.96, 600.0)),
    "round-the-earth": (GreatCircle(-0.3, 2.0, 5e5, 1.0, speed=7600.0), great_circle_truth, (3600.0,)),
}
POINTS = [pytest.param(*case[:2], t, id=f"{name}-{t:g}s") for name, case in CASES.items() for t in case[2]]


@pytest.mark.parametrize(("motion", "functions", "t"), POINTS)
def test_kinematics_and_mujoco_against_forty_digits(rig, motion, functions, t):
    """Specific force to 1e-12 of the gravitation that it is the small difference to, at any place and speed.

    Positions to 2e-9 m at 6.4e6 m, one rounding of a coordinate (and those of the longitude), and two roundings of the
    path's length; velocities to a few roundings; rates to 4 roundings of the largest, angular accelerations to 16.
    """
    truth = ref.inertial(*functions(motion), t)
    mine, readings = motion.kinematics([t]), rig.sample(motion, np.array([t]))
    far = np.linalg.norm(truth["position"]) / 6.4e6
    travelled = np.linalg.norm(motion.trajectory([t]).v_e) * t
    fast = np.linalg.norm(truth["velocity"])
    strong = max(np.linalg.norm(truth["gravity"]), np.linalg.norm(truth["f_b"]))
    turning = 1e-3 + np.linalg.norm(truth["omega_ib_b"])
    bending = 1e-5 + np.linalg.norm(truth["alpha_ib_b"])
    for value, name, tolerance in (
        (mine.position, "position", 2e-9 * far + 2 * EPS * travelled),
        (mine.velocity, "velocity", 12 * EPS * fast),
        (mine.acceleration, "acceleration", 1e-14 * strong * (1 + fast / 1000)),
        (mine.gravity, "gravity", 8 * EPS * strong),
        (rot.matrix_from_quat(mine.q_ib), "C_ib", 8 * EPS),
        (mine.omega_ib_b, "omega_ib_b", 4 * EPS * turning),
        (mine.alpha_ib_b, "alpha_ib_b", 16 * EPS * bending),
        (readings.accelerometers, "f_b", 1e-12 * strong),
        (readings.gyro, "omega_ib_b", 4 * EPS * turning),
    ):
        np.testing.assert_allclose(value[0], truth[name], rtol=0, atol=tolerance, err_msg=name)


@pytest.mark.parametrize("latitude", [0.0, 0.7, -1.3, math.pi / 2, -math.pi / 2])
def test_at_rest_one_feels_gravity_and_the_turning_earth(rig, latitude):
    """f_b = -g and omega = omega_ie in body axes, at all times alike; g by hand from the potential's derivative."""
    motion = EarthRest(latitude, 0.4, 250.0, attitude=(1.0, -0.4, 0.2))
    with mp.workdps(ref.DIGITS):
        r = ref.position_e(*map(ref.exact, (latitude, 0.4, 250.0)))
        g = ref.gravitation(r) + ref.RATE**2 * mp.matrix([r[0], r[1], 0])
        C = ref.C_en(*map(ref.exact, (latitude, 0.4))) * ref.C_nb(*map(ref.exact, motion.attitude))
        f_b, omega = ref.floats(-C.T * g), ref.floats(C.T * mp.matrix([0, 0, ref.RATE]))
    t = np.linspace(0.0, 86400.0, 25)
    readings = rig.sample(motion, t)
    np.testing.assert_allclose(readings.accelerometers, np.tile(f_b, (25, 1)), rtol=0, atol=2e-14)  # 10 roundings of g
    np.testing.assert_allclose(readings.gyro, np.tile(omega, (25, 1)), rtol=0, atol=8 * EPS * 7.3e-5)


def test_increments_at_rest_are_rate_times_interval(rig):
    motion = EarthRest(0.8, attitude=(0.3, 0.1, -0.2))
    inc, now = rig.increments(motion, 100.0, 10.0), rig.sample(motion, np.array([5.0]))
    np.testing.assert_allclose(inc.dtheta_b, np.tile(now.gyro / 100, (1000, 1)), rtol=0, atol=1e-21)
    np.testing.assert_allclose(inc.dvel, np.tile(now.accelerometers / 100, (1000, 1)), rtol=0, atol=1e-16)


@pytest.mark.parametrize("earth", [WGS84, WGS84_NORMAL, SPHERE], ids=lambda earth: earth.name)
def test_the_earth_is_an_option(earth):
    """The gravitation is that of the motion's own Earth, in i, and the frames agree at t = 0."""
    motion = FastVehicle(earth=earth)
    now = motion.kinematics([0.0])
    np.testing.assert_allclose(now.position[0], earth.position(0.25 * math.pi, 126 * DEG, 20000.0), rtol=0, atol=2e-9)
    np.testing.assert_allclose(now.gravity, earth.gravitation(now.position), rtol=0, atol=1e-14)


@pytest.mark.parametrize("motion", [case[0] for case in CASES.values()], ids=list(CASES))
def test_trajectory_is_the_inertial_motion_seen_from_the_earth(motion):
    """`Trajectory.of` goes back from i to e; 2e-8 m and 1e-11 m/s are the roundings of the way there and back."""
    t = np.linspace(0.0, 500.0, 11)
    there, back = motion.trajectory(t), Trajectory.of(motion.kinematics(t), t, motion.earth)
    np.testing.assert_allclose(back.r_e, there.r_e, rtol=0, atol=2e-8 * np.abs(there.r_e).max() / 6.4e6)
    np.testing.assert_allclose(back.v_e, there.v_e, rtol=0, atol=1e-11)
    np.testing.assert_allclose(np.abs((back.q_eb * there.q_eb).sum(axis=1)), 1.0, rtol=0, atol=8 * EPS)


def test_navigation_initial_is_the_place_and_the_motion_there():
    """The speed and azimuth of the fast vehicle, and the attitude it was given."""
    motion = FastVehicle(250.0, 30 * DEG, height=9000.0, swing=(0.0, 0.0, 0.0), attitude=(0.5, 0.1, -0.2))
    initial = motion.navigation_initial()
    np.testing.assert_allclose(
        initial.v_n, 250 * np.array([math.sin(30 * DEG), math.cos(30 * DEG), 0.0]), rtol=0, atol=1e-12
    )
    np.testing.assert_allclose(initial.q_nb, rot.quat_from_euler(0.5, 0.1, -0.2), rtol=0, atol=8 * EPS)
    assert initial.latitude == pytest.approx(45 * DEG, abs=4 * EPS)
    assert initial.longitude == pytest.approx(126 * DEG, abs=4 * EPS)
    assert initial.height == pytest.approx(9000.0, abs=2e-9)


def test_great_circle_leads_over_the_pole():
    """From 89 deg at 300 m/s the pole comes after 373 s; the longitude jumps by pi there, the attitude does not."""
    motion = GreatCircle()
    tr = motion.trajectory(np.linspace(0.0, 740.0, 3001))
    k = int(np.argmax(tr.latitude))
    assert tr.latitude[k] > math.pi / 2 - 1e-5
    assert tr.longitude[0] == pytest.approx(126 * DEG, abs=1e-12)
    assert tr.longitude[-1] == pytest.approx(-54 * DEG, abs=1e-9)
    turn = 2 * np.arccos(np.clip(np.abs((tr.q_eb[1:] * tr.q_eb[:-1]).sum(axis=1)), 0, 1))
    assert turn.max() < 1e-4
    np.testing.assert_allclose(np.linalg.norm(tr.r_e, axis=1), np.linalg.norm(tr.r_e[0]), rtol=4 * EPS)


def test_motions_on_the_earth_are_values():
    assert EarthRest() == EarthRest(45 * DEG)
    assert hash(GreatCircle(attitude=np.array([1.0, 2.0, 3.0]))) == hash(GreatCircle(attitude=(1, 2, 3)))
    assert FastVehicle() != FastVehicle(earth=SPHERE)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: EarthRest(latitude=45.0), r"latitude must be within \+-pi/2 rad, got 45 \(degrees\?\)"),
        (lambda: EarthRest(longitude=126.0), r"longitude must be within \+-2 pi rad, got 126.0"),
        (lambda: EarthRest(height=math.nan), "height must be finite"),
        (lambda: EarthRest(earth="wgs84"), "earth must be an Earth, got 'wgs84'"),
        (lambda: EarthRest(swing=1.0), r"swing must have shape \(3,\)"),
        (lambda: EarthRest(sway=(0, math.inf, 0)), r"sway must be finite, got inf at \[1\]"),
        (lambda: FastVehicle(latitude=math.pi / 2), "latitude must stay 1e-06 rad away from the poles, got 1.57"),
        (lambda: FastVehicle(speed="fast"), "speed must be a number, got 'fast'"),
        (lambda: FastVehicle(weave_phase=(0, 0)), r"weave_phase must have shape \(3,\), got \(2,\)"),
        (lambda: FastVehicle(azimuth=0.0).kinematics([2000.0]), "latitude of the path must stay 1e-06 rad away"),
        (lambda: GreatCircle(azimuth=math.inf), "azimuth must be finite"),
        (lambda: GreatCircle(earth=None), "earth must be an Earth, got None"),
    ],
)
def test_bad_options_are_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()
