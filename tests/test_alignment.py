"""Alignment: ideal data to rounding, sway to a stated bound, expected errors against those made, refusals.

Truth: the increments of a body fixed to the Earth, which are constant and written down with scipy's rotations; MuJoCo's
increments of a swaying body.
"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import bench
from bench import _alignment_vectors as vectors
from bench.alignment import Alignment, coarse_alignment, inertial_alignment
from bench.earth import SPHERE, WGS84, WGS84_NORMAL
from bench.errors import InputError, ObservabilityError
from bench.evaluation import attitude_error
from bench.motion.earth_rest import EarthRest
from bench.rotation import euler_from_quat
from bench.trajectory import navigation_errors
from bench.units import DEG, DEG_PER_H, MICRO_G

METHODS = [coarse_alignment, inertial_alignment]
RATE, DURATION = 100.0, 60.0
DT, N = 1 / RATE, int(RATE * DURATION)
PLACE = (0.7, 2.0, 100.0)  # latitude, longitude, height
EAST, NORTH, UP = np.eye(3)
ATTITUDE = (0.6, -0.1, 0.2)  # psi, P, R


def attitude(psi, P, R):
    """Return q_nb (wxyz) of Rz(psi) Rx(P) Ry(R), by scipy."""
    return np.roll(Rotation.from_euler("ZXY", [psi, P, R]).as_quat(), 1)


def at_rest(angles=ATTITUDE, latitude=PLACE[0], height=PLACE[2], earth=WGS84, n=N):
    """Return dtheta_b, dvel_b of a body fixed to the Earth: rate and specific force are constant in its axes."""
    turn = Rotation.from_euler("ZXY", angles).inv()
    omega_n = earth.rate * np.array([0.0, np.cos(latitude), np.sin(latitude)])
    f_b = turn.apply(-earth.gravity_n(latitude, height))
    return np.tile(turn.apply(omega_n) * DT, (n, 1)), np.tile(f_b * DT, (n, 1))


def error(found, truth):
    """Return the error of the attitude in n, east, north, up."""
    return attitude_error(found.initial.q_nb[None], np.reshape(truth, (1, 4)))[0]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("earth", [WGS84, WGS84_NORMAL, SPHERE])
@pytest.mark.parametrize(
    ("angles", "latitude", "height"),
    [
        ((0.0, 0.0, 0.0), 0.0, 0.0),
        (ATTITUDE, 0.7, 1000.0),
        ((-2.5, 1.4, -0.3), -1.2, -50.0),
        ((3.0, 0.2, 3.0), 1.5, 9000.0),
    ],
)
def test_ideal_data_at_rest_give_the_attitude_to_rounding(method, earth, angles, latitude, height):
    dtheta, dvel = at_rest(angles, latitude, height, earth)
    found = method(dtheta, dvel, DT, latitude, 2.0, height, earth)
    # 1e-15 of gravity; the heading of the coarse one is 1e-15 of the Earth's rate times a few from summing. In inertial
    # space gravity turns by omega_ie T cos L, 4e-3 cos L, so rounding counts 230 / cos L times as much, and the sum of
    # the specific force is rounded as a whole.
    away = error(found, attitude(*angles))
    assert np.abs(away[:2]).max() < 1e-12 / np.cos(latitude)
    assert abs(away[2]) < (1e-11 if method is coarse_alignment else 2e-10) / np.cos(latitude)
    assert found.initial.v_n.tolist() == [0.0, 0.0, 0.0]
    assert (found.initial.latitude, found.initial.longitude, found.initial.height) == (latitude, 2.0, height)
    assert found.sigma_tilt < 1e-10
    assert found.sigma_heading < 1e-9


@pytest.fixture(scope="module")
def rig():
    return bench.Rig.load("imu", threads=1)


def swaying(**change):
    """Return a ship at her berth: 5 deg and 0.3 m, periods of 6 to 12 s."""
    return EarthRest(attitude=ATTITUDE, swing=(0.03, 0.08, 0.05), sway=(0.3, 0.2, 0.1), **change)


def test_mujoco_at_rest(rig):
    motion = EarthRest(attitude=ATTITUDE)
    made = rig.increments(motion, RATE, DURATION)
    place = motion.latitude, motion.longitude, motion.height, motion.earth
    for method in METHODS:
        found = method(made.dtheta_b, made.dvel, made.dt, *place)
        assert np.abs(error(found, attitude(*ATTITUDE))).max() < 1e-10  # as above
    # The solution goes on from the end of the stretch, and stays there: 1 um of the free height grows in 60 s.
    estimate = bench.solver("navigation", "navigation-frame").solve(
        made.dtheta_b, made.dvel, made.dt, found.initial, motion.earth
    )
    assert np.abs(navigation_errors(estimate, motion.trajectory(estimate.t)).position).max() < 1e-6


@pytest.mark.parametrize(("duration", "tilt", "heading"), [(60.0, 3e-5, 6e-3), (240.0, 2e-7, 2e-5)])
def test_inertial_alignment_lets_the_base_sway(rig, duration, tilt, heading):
    motion = swaying()
    made = rig.increments(motion, 50.0, duration)
    found = inertial_alignment(made.dtheta_b, made.dvel, made.dt, motion.latitude, motion.longitude, motion.height)
    # The bounds hold what the windows leave of the sway, which falls steeply with the number of periods in half the
    # stretch. The attitude is that at the end of the stretch, deep in the sway.
    truth = motion.trajectory(np.array([duration])).q_nb
    away = error(found, truth)
    assert np.abs(away[:2]).max() < tilt
    assert abs(away[2]) < heading
    assert abs(away[2]) < 5 * found.sigma_heading < 5 * 2 * heading  # and it is expected
    with pytest.raises(
        InputError, match=r"must be of a unit at rest: its sum along .* or inertial_alignment for a base"
    ):
        coarse_alignment(made.dtheta_b, made.dvel, made.dt, motion.latitude, motion.longitude, motion.height)


def test_odd_numbers_of_increments_lose_the_first():
    dtheta, dvel = at_rest()
    even = inertial_alignment(dtheta, dvel, DT, *PLACE).initial.q_nb
    odd = inertial_alignment(np.vstack([dtheta[:1], dtheta]), np.vstack([dvel[:1], dvel]), DT, *PLACE).initial.q_nb
    np.testing.assert_array_equal(even, odd)


# --- expected errors


def noisy(seed, gyro_white=0.0, gyro_bias=0.0, white=0.0, bias=0.0):
    """Return increments at rest with white noise, per sqrt(Hz), and a constant error of normal distribution."""
    rng = np.random.default_rng(seed)
    dtheta, dvel = at_rest()
    dtheta = dtheta + gyro_white * np.sqrt(DT) * rng.normal(size=(N, 3)) + gyro_bias * DT * rng.normal(size=3)
    return dtheta, dvel + white * np.sqrt(DT) * rng.normal(size=(N, 3)) + bias * DT * rng.normal(size=3)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "noise",
    [
        {"gyro_white": 3e-7, "white": 1e-6},
        {"gyro_bias": 0.05 * DEG_PER_H, "bias": 50 * MICRO_G},
        {"white": 3e-4},
    ],
    ids=["white", "biases", "accelerometer noise"],
)
def test_expected_errors_are_those_that_are_made(method, noise):
    truth, trials = attitude(*ATTITUDE), 40
    found = [method(*noisy(seed, **noise), DT, *PLACE, heading_limit=10.0) for seed in range(trials)]
    made = np.array([error(one, truth) for one in found])
    expected = np.array([[one.sigma_tilt, one.sigma_heading] for one in found])
    rms = [np.sqrt((values**2).mean()) for values in (made[:, :2], made[:, 2])]
    # An RMS of 40 trials is known to 11 %, sigmas with few degrees of freedom are rougher; the largest of several
    # causes is taken, and all as if they were independent: rather too large than too small.
    ratio = np.sqrt((expected**2).mean(axis=0)) / rms
    assert (ratio > 0.6).all()
    assert (ratio < 3.0).all()


def test_a_gyro_bias_towards_the_east_is_not_seen_and_goes_into_the_heading():
    dtheta, dvel = at_rest((0.0, 0.0, 0.0))  # body axes are east, north, up
    bias = 0.01 * DEG_PER_H
    off = bias / (WGS84.rate * np.cos(PLACE[0]))  # 8.7e-4 rad, to second order
    for method in METHODS:
        found = method(dtheta + bias * DT * EAST, dvel, DT, *PLACE, gyro_bias=bias)
        assert abs(abs(error(found, [1.0, 0, 0, 0])[2]) - off) < 2e-3 * off
        assert found.sigma_heading == pytest.approx(off, rel=1e-6)
        assert found.gyro_error == bias
    # The level part of the rate, taken for north, leans to the body's right: its front seems to point left of north.
    assert error(coarse_alignment(dtheta + bias * DT * EAST, dvel, DT, *PLACE), [1.0, 0, 0, 0])[2] > 0


@pytest.mark.parametrize("method", METHODS)
def test_an_accelerometer_bias_across_the_vertical_tilts(method):
    dtheta, dvel = at_rest((0.0, 0.0, 0.0))
    bias = 100 * MICRO_G
    found = method(dtheta, dvel + bias * DT * NORTH, DT, *PLACE, accelerometer_bias=bias)
    g = float(WGS84.normal_gravity(PLACE[0], PLACE[2]))
    # A force to the front looks like the nose up: +bias/g about east.
    assert error(found, [1.0, 0, 0, 0])[0] == pytest.approx(bias / g, rel=1e-4)
    assert found.sigma_tilt == pytest.approx(bias / g, rel=1e-4)
    assert found.accelerometer_error == bias


# --- what cannot be found, or is not at rest


def mems():
    """Return increments at rest of a gyro with 20 deg/h of bias and 0.2 deg/sqrt(h), and 1 mg of the accelerometers."""
    return noisy(7, gyro_white=0.2 * DEG / 60, gyro_bias=20 * DEG_PER_H, white=5e-4, bias=1000 * MICRO_G)


@pytest.mark.parametrize("method", METHODS)
def test_a_gyro_that_does_not_see_the_earth_turn_is_refused(method):
    with pytest.raises(
        ObservabilityError, match=r"heading cannot be found: expected error .* the Earth turns 11\.5 deg/h"
    ):
        method(*mems(), DT, *PLACE)


def test_with_a_yaw_from_elsewhere_the_vertical_is_found():
    found = coarse_alignment(*mems(), DT, *PLACE, psi=ATTITUDE[0])
    assert isinstance(found, Alignment)
    assert euler_from_quat(found.initial.q_nb)[0] == pytest.approx(ATTITUDE[0], abs=1e-5)  # n's z is not quite plumb
    assert np.abs(error(found, attitude(*ATTITUDE))).max() < 3e-3  # 1 mg, three sigma
    assert (found.sigma_heading, found.gyro_error) == (0.0, 0.0)
    assert 1e-4 < found.sigma_tilt < 3e-3
    exact = coarse_alignment(*at_rest(earth=WGS84_NORMAL), DT, *PLACE, WGS84_NORMAL, psi=ATTITUDE[0])
    assert np.abs(error(exact, attitude(*ATTITUDE))).max() < 1e-7  # the plumb line is 1e-7 rad off at 100 m


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("latitude", [np.pi / 2, -np.pi / 2, np.pi / 2 - 5e-4])
def test_at_the_poles_there_is_no_heading(method, latitude):
    dtheta, dvel = at_rest(latitude=latitude)
    with pytest.raises(ObservabilityError, match="heading cannot be found where the Earth does not turn about north"):
        method(dtheta, dvel, DT, latitude, 0.0)
    found = coarse_alignment(dtheta, dvel, DT, latitude, 0.0, PLACE[2], psi=ATTITUDE[0])
    assert np.abs(error(found, attitude(*ATTITUDE))).max() < 1e-6


def test_a_base_that_moves_is_refused():
    dtheta, dvel = at_rest()
    start = np.where(np.arange(N) < N // 2, 0.0, 1.0 * DT)[:, None] * [0.0, 1.0, 0.0]  # 1 m/s^2 half of the time
    with pytest.raises(InputError, match=r"dvel_b must be of a unit at rest: its sum along y strays 15 m/s"):
        coarse_alignment(dtheta, dvel + start, DT, *PLACE)
    with pytest.raises(ObservabilityError, match="heading cannot be found: expected error"):
        inertial_alignment(dtheta, dvel + start, DT, *PLACE)
    for method in METHODS:  # on a turntable
        with pytest.raises(ObservabilityError, match="heading cannot be found: expected error"):
            method(dtheta + 0.1 * DEG * DT * UP, dvel, DT, *PLACE)
    # White noise alone is no motion, whatever its size.
    noise = 1e-3 * np.random.default_rng(1).normal(size=(N, 3))
    coarse_alignment(dtheta + noise, dvel, DT, *PLACE, psi=0.0)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"dvel_b": np.full((N, 3), 5.66)},
            r"dvel_b must hold the increments .* force is 980.341 m/s\^2, gravity there is 9.80",
        ),
        ({"dtheta_b": np.zeros((63, 3)), "dvel_b": np.zeros((63, 3))}, "at least 64 increments, got 63"),
        ({"dvel_b": np.zeros((N - 1, 3))}, r"dvel_b must have shape \(6000, 3\), got \(5999, 3\)"),
        ({"dtheta_b": np.full((N, 3), np.nan)}, "dtheta_b must be finite"),
        ({"dt": 0.0}, "dt must be a positive number"),
        ({"latitude": 45.0}, r"latitude must be within .*\(degrees\?\)"),
        ({"longitude": 126.0}, r"longitude must be within .*\(degrees\?\)"),
        ({"height": None}, "height must be a number"),
        ({"earth": "wgs84"}, "earth must be an Earth, got 'wgs84'"),
        ({"gyro_bias": -1.0}, "gyro_bias must be a number >= 0"),
        ({"accelerometer_bias": np.nan}, "accelerometer_bias must be finite"),
        ({"heading_limit": 0.0}, "heading_limit must be a positive number"),
    ],
)
def test_bad_arguments_are_refused(method, change, message):
    dtheta, dvel = at_rest()
    good = {"dtheta_b": dtheta, "dvel_b": dvel, "dt": DT, "latitude": 0.7, "longitude": 2.0, "height": 100.0}
    with pytest.raises(InputError, match=message):
        method(**(good | change))


def test_bad_options_of_the_coarse_alignment_are_refused():
    with pytest.raises(InputError, match="wobble must be a number >= 0"):
        coarse_alignment(*at_rest(), DT, *PLACE, wobble=-1.0)
    with pytest.raises(InputError, match="psi must be a number, got 'north'"):
        coarse_alignment(*at_rest(), DT, *PLACE, psi="north")


# --- the rotation of least squares


def test_least_squares_rotation_is_scipys():
    rng = np.random.default_rng(2)
    for spread in (1.0, 1e-2):
        b = [0.0, 0.0, 5.0] + spread * rng.normal(size=(6, 3))
        a = 1.01 * Rotation.from_rotvec([0.5, -1.0, 2.0]).apply(b) + 1e-3 * spread * rng.normal(size=(6, 3))
        q, scale, covariance = vectors.least_squares_rotation(a, b)
        other, _ = Rotation.align_vectors(a, b, weights=np.ones(6))
        # align_vectors knows no scale: with the scale of least squares the rotation is the same.
        assert (Rotation.from_quat(np.roll(q, -1)) * other.inv()).magnitude() < 1e-9
        assert scale == pytest.approx(1.01, abs=1e-3)
        assert (np.linalg.eigvalsh(covariance) > 0).all()


def test_windows_are_smooth_and_can_be_made_orthonormal():
    weights, centres = vectors.windows(1000)
    assert weights @ np.arange(1000) / weights.sum(axis=1) / 1000 == pytest.approx(centres, abs=1e-3)
    white = vectors.whitening(weights) @ weights
    np.testing.assert_allclose(white @ white.T, np.eye(vectors.WINDOWS), rtol=0, atol=1e-12)
    # What a period of a tenth of a window leaves: 1e-4 of the sum, where a plain window may leave 1/(10 pi).
    wave = np.cos(2 * np.pi * np.arange(1000) / 50 + 0.3)
    assert np.abs(weights @ wave / weights.sum(axis=1)).max() < 1e-4
