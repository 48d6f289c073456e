"""Trajectories on the Earth: round trips, the inertial view, errors in hand-made cases. Truth: hand, scipy, pymap3d."""

import numpy as np
import pymap3d
import pytest
from scipy.spatial.transform import Rotation

from bench.earth import WGS84
from bench.errors import InputError
from bench.rotation import quat_from_euler, quat_from_rotvec, quat_multiply
from bench.signals import Kinematics
from bench.trajectory import NavigationInitial, Trajectory, navigation_errors

RNG = np.random.default_rng(4)
LATITUDES = np.array([0.0, 0.8, -1.2, 1.5, np.pi / 2 - 1e-7, np.pi / 2, -np.pi / 2])
n = len(LATITUDES)
T = np.arange(n) / 10
LONGITUDES = RNG.uniform(-3.1, 3.1, n)
HEIGHTS = RNG.uniform(-1e3, 1e5, n)
Q_NB = quat_from_euler(*RNG.uniform(-1.5, 1.5, (3, n)))
V_N = RNG.normal(size=(n, 3)) * 100


def geodetic_trajectory(**change):
    fields = {"t": T, "q_nb": Q_NB, "v_n": V_N, "latitude": LATITUDES, "longitude": LONGITUDES, "height": HEIGHTS}
    return Trajectory.from_geodetic(WGS84, **(fields | change))


def scipy_rotation(q):
    return Rotation.from_quat(np.roll(q, -1, axis=-1))


def up_to_sign(q):
    return q * np.sign(q[..., :1])


def test_geodetic_and_navigation_frame_views_give_back_what_went_in():
    path = geodetic_trajectory()
    # At a pole too: the double next to pi/2 is 4e-10 m from the axis, and that keeps the longitude.
    np.testing.assert_allclose(path.latitude, LATITUDES, rtol=0, atol=2.3e-16)  # a unit in the last place
    np.testing.assert_allclose(path.height, HEIGHTS, rtol=0, atol=1e-9)
    arc = (path.longitude - LONGITUDES) * np.cos(LATITUDES) * 6.4e6
    np.testing.assert_allclose(arc, 0.0, rtol=0, atol=2e-9)
    np.testing.assert_allclose(up_to_sign(path.q_nb), up_to_sign(Q_NB), rtol=0, atol=3e-15)
    np.testing.assert_allclose(path.v_n, V_N, rtol=0, atol=1e-12)  # 100 m/s and a few 1e-15 rad
    assert len(path) == n


def test_earth_frame_is_that_of_pymap3d():
    path = geodetic_trajectory()
    degrees = {"deg": False}
    v_e = np.stack(pymap3d.enu2uvw(*V_N.T, LATITUDES, LONGITUDES, **degrees), axis=-1)
    np.testing.assert_allclose(path.v_e, v_e, rtol=0, atol=1e-12)
    body_y = scipy_rotation(Q_NB).apply([0.0, 1.0, 0.0])
    along = np.stack(pymap3d.enu2uvw(*body_y.T, LATITUDES, LONGITUDES, **degrees), axis=-1)
    np.testing.assert_allclose(scipy_rotation(path.q_eb).apply([0.0, 1.0, 0.0]), along, rtol=0, atol=2e-15)


def test_longitude_at_the_pole_says_where_the_axes_point():
    # Level, y axis north, at the north pole: north is away from the meridian of the longitude.
    path = Trajectory.from_geodetic(WGS84, [0.0], [[1.0, 0, 0, 0]], [[0.0, 5.0, 0]], [np.pi / 2], [0.0], [0.0])
    np.testing.assert_allclose(path.v_e, [[-5.0, 0.0, 0.0]], rtol=0, atol=1e-15)
    # On the axis itself the longitude is 0, and the attitude follows: nothing turns by itself.
    on_axis = Trajectory(WGS84, path.t, path.q_eb, path.v_e, [[0.0, 0.0, WGS84.semi_minor_axis]])
    assert (on_axis.latitude[0], on_axis.longitude[0]) == (np.pi / 2, 0.0)
    np.testing.assert_allclose(on_axis.v_n, [[0.0, 5.0, 0.0]], rtol=0, atol=1e-15)


def test_initial_is_one_row():
    path = geodetic_trajectory()
    initial = path.initial(2)
    assert (initial.latitude, initial.height) == (path.latitude[2], path.height[2])
    np.testing.assert_array_equal(initial.q_nb, path.q_nb[2])
    np.testing.assert_array_equal(initial.v_n, path.v_n[2])
    default = NavigationInitial(latitude=0.1, longitude=-0.2)
    assert (default.q_nb.tolist(), default.v_n.tolist(), default.height) == ([1.0, 0, 0, 0], [0.0, 0, 0], 0.0)


def test_of_undoes_the_rotation_of_the_earth():
    # A body that drives at a constant v_e, written down in i by hand (scipy rotations about z).
    t = np.array([0.0, 1.0, 600.0, 86164.0])
    v_e = np.array([10.0, -20.0, 5.0])
    r_e = WGS84.position(0.7, 2.0, 50.0) + t[:, None] * v_e
    turn = Rotation.from_rotvec(np.outer(WGS84.rate * t, [0, 0, 1]))
    q_eb = quat_from_rotvec([0.3, -1.0, 0.5])
    q_ib = np.roll((turn * scipy_rotation(q_eb)).as_quat(), 1, axis=-1)
    zero = np.zeros((1, 3))
    truth = Kinematics(
        position=turn.apply(r_e),
        velocity=turn.apply(v_e + np.cross([0, 0, WGS84.rate], r_e)),
        acceleration=zero,
        q_ib=q_ib,
        omega_ib_b=zero,
        alpha_ib_b=zero,
        gravity=zero,
    )
    path = Trajectory.of(truth, t, WGS84)
    np.testing.assert_allclose(path.r_e, r_e, rtol=0, atol=1e-8)  # the roundings of an angle of up to 2 pi at 6.4e6 m
    np.testing.assert_allclose(path.v_e, np.tile(v_e, (4, 1)), rtol=0, atol=1e-11)
    np.testing.assert_allclose(up_to_sign(path.q_eb), np.tile(q_eb, (4, 1)), rtol=0, atol=2e-15)


EQUATOR = {"latitude": [0.0], "longitude": [0.0], "height": [0.0]}  # there east, north, up are y, z, x of e
LEVEL = [[1.0, 0.0, 0.0, 0.0]]


def test_errors_are_estimate_minus_truth_in_east_north_up():
    truth = Trajectory.from_geodetic(WGS84, [0.0], LEVEL, [[0.0, 0.0, 0.0]], **EQUATOR)
    off = np.array([3.0, 1.0, 2.0])
    estimate = Trajectory(WGS84, [0.0], truth.q_eb, truth.v_e + 1e-3 * off, truth.r_e + 10 * off)
    errors = navigation_errors(estimate, truth)
    np.testing.assert_allclose(errors.position, [[10.0, 20.0, 30.0]], rtol=0, atol=1e-8)
    np.testing.assert_allclose(errors.velocity, [[1e-3, 2e-3, 3e-3]], rtol=0, atol=1e-18)
    np.testing.assert_array_equal(errors.attitude, 0.0)
    assert errors.t.tolist() == [0.0]


def test_attitude_error_is_the_rotation_from_truth_to_estimate_in_the_true_axes():
    truth = geodetic_trajectory()
    phi = RNG.normal(size=(n, 3)) * 1e-3
    estimate = geodetic_trajectory(q_nb=quat_multiply(quat_from_rotvec(phi), Q_NB))
    np.testing.assert_allclose(navigation_errors(estimate, truth).attitude, phi, rtol=0, atol=5e-15)
    # An estimate that yaws 1 mrad too far anticlockwise: +1 mrad up.
    level = Trajectory.from_geodetic(WGS84, [0.0], LEVEL, [[0.0, 0.0, 0.0]], **EQUATOR)
    yawed = Trajectory.from_geodetic(WGS84, [0.0], [quat_from_euler(1e-3, 0, 0)], [[0.0, 0.0, 0.0]], **EQUATOR)
    np.testing.assert_allclose(navigation_errors(yawed, level).attitude, [[0.0, 0.0, 1e-3]], rtol=0, atol=1e-15)


def test_position_errors_do_not_leak_into_the_attitude():
    truth = geodetic_trajectory(latitude=np.full(n, 1.5))
    estimate = Trajectory(WGS84, T, truth.q_eb, truth.v_e, truth.r_e + np.full(3, 100.0))
    assert np.abs(estimate.q_nb - truth.q_nb).max() > 1e-5  # near a pole the axes of n turn fast
    assert np.abs(navigation_errors(estimate, truth).attitude).max() < 1e-15


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_errors_over_the_pole_are_smooth(sign):
    # Two steps to either side of the axis: the longitude jumps by pi, the distance between the two paths does not.
    b = WGS84.semi_minor_axis
    x = np.array([[-2.0], [-1.0], [1.0], [2.0]])
    r_e = np.concatenate([x, np.zeros((4, 1)), np.full((4, 1), sign * b)], axis=1)
    truth = Trajectory(WGS84, np.arange(4.0), np.tile(LEVEL, (4, 1)), np.zeros((4, 3)), r_e)
    estimate = Trajectory(WGS84, truth.t, truth.q_eb, truth.v_e, r_e + 1e-3 * np.eye(3)[0])
    errors = navigation_errors(estimate, truth)
    np.testing.assert_allclose(np.linalg.norm(errors.position, axis=1), 1e-3, rtol=0, atol=1e-9)
    np.testing.assert_allclose(errors.attitude, 0.0, rtol=0, atol=1e-15)


# --- bad input


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: NavigationInitial(latitude=45.0, longitude=0.0), r"latitude must be within .*, got 45 \(degrees\?\)"),
        (lambda: NavigationInitial(latitude=0.1, longitude=126.0), r"longitude must be within .*\(degrees\?\)"),
        (lambda: NavigationInitial(latitude=[0.1], longitude=0.0), "latitude must be a number"),
        (lambda: NavigationInitial(latitude=0.1, longitude=0.0, height=np.nan), "height must be finite"),
        (lambda: NavigationInitial((1.0, 0.1, 0, 0), latitude=0.1, longitude=0.0), "q_nb must be unit quaternions"),
        (lambda: NavigationInitial(v_n=(1.0, 2.0), latitude=0.1, longitude=0.0), r"v_n must have shape \(3,\)"),
        (lambda: geodetic_trajectory(latitude=np.degrees(LATITUDES)), r"latitude must be within .*degrees"),
        (lambda: geodetic_trajectory(height=HEIGHTS[:2]), r"height must have shape \(7,\), got \(2,\)"),
        (lambda: geodetic_trajectory(q_nb=2 * Q_NB), "q_nb must be unit quaternions"),
        (lambda: geodetic_trajectory(v_n=V_N[:, :2]), r"v_n must have shape \(7, 3\)"),
        (lambda: Trajectory("wgs84", [0.0], LEVEL, [[0.0] * 3], [[7e6, 0, 0]]), "earth must be an Earth, got 'wgs84'"),
        (lambda: Trajectory(WGS84, [], LEVEL, [[0.0] * 3], [[7e6, 0, 0]]), "t must not be empty"),
        (lambda: Trajectory(WGS84, [0.0], LEVEL, [[0.0] * 3], [[np.inf, 0, 0]]), "r_e must be finite"),
        (lambda: Trajectory(WGS84, [0.0], LEVEL, [[0.0] * 3], [[1.0, 0, 0]]).height, "r_e must be at least"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(InputError, match=message):
        call()


def test_errors_of_different_trajectories_are_refused():
    path = geodetic_trajectory()
    with pytest.raises(InputError, match="same length, got 7 and 1"):
        navigation_errors(path, Trajectory.from_geodetic(WGS84, [0.0], LEVEL, [[0.0] * 3], **EQUATOR))
    with pytest.raises(InputError, match=r"same times, they differ by up to 0\.5 s"):
        navigation_errors(path, geodetic_trajectory(t=T + 0.5))


def test_inertial_truth_needs_a_row_for_each_time():
    zero = np.zeros((2, 3))
    truth = Kinematics(zero + 7e6, zero, zero, [[1.0, 0, 0, 0]], zero, zero, zero)
    with pytest.raises(InputError, match="kinematics must have 1 or 3 rows, got 2"):
        Trajectory.of(truth, [0.0, 1.0, 2.0], WGS84)
