"""The driven turntable: model, commanded profile, dynamics and their step, the recorded motion and what a rig senses.

Truth: SciPy's Rotation for the axes; the closed-form response of a linear servo; MuJoCo itself at half the step; the
Earth's rate and gravity at the place.
"""

import math
from itertools import pairwise

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import bench
from bench import turntable
from bench.earth import WGS84
from bench.euler_angles import track
from bench.mjcf import models_dir
from bench.motion.recorded_turntable import RecordedTurntable
from bench.turntable import Profile, TableRecording, Turntable
from bench.units import DEG

# All three axes at different rates, with reversals in all, at rates and limits that bring many of them.
BUSY = Profile(
    rate=(3 * DEG, 5 * DEG, -7 * DEG),
    limit=(4 * DEG, 7 * DEG, 8 * DEG),
    rest=0.5,
    fluctuation=(0.05 * DEG, 0.05 * DEG, 0.05 * DEG),
)


@pytest.fixture(scope="module")
def table():
    return Turntable()


@pytest.fixture(scope="module")
def busy(table):
    return table.drive(BUSY, 8.0, settle=1.0)


def test_the_joints_are_the_euler_angles_of_the_unit(table):
    data = mujoco.MjData(table.model)
    for angles in np.random.default_rng(0).uniform(-math.pi, math.pi, (20, 3)):
        data.qpos[:] = angles
        mujoco.mj_forward(table.model, data)
        expected = Rotation.from_euler("ZXY", angles).as_matrix()
        np.testing.assert_allclose(data.body("inner").xmat.reshape(3, 3), expected, rtol=0, atol=1e-15 * 4)
        np.testing.assert_allclose(data.site("A1").xpos, 0, rtol=0, atol=1e-15)
        np.testing.assert_allclose(data.sensor("pitch encoder").data, angles[1:2], rtol=0, atol=0)


def test_the_frames_do_not_touch_each_other(table):
    """Every geom of a frame stays inside the sphere that the next one leaves free, at any angle."""
    model = table.model

    def reach(name):
        of = model.geom_bodyid == model.body(name).id
        centre = np.linalg.norm(model.geom_pos[of], axis=1)
        return centre, model.geom_rbound[of], model.geom_pos[of]

    centre, bound, _ = reach("inner")
    assert (centre + bound).max() < 0.25
    # The fork's uprights stand outside the sphere of the middle frame, its beam and the pedestal below it.
    centre, bound, _ = reach("middle")
    assert centre.max() + 0.05 < 0.36
    _, _, position = reach("outer")
    assert (np.hypot(position[:, 0], position[:, 2]) > 0.3).all()


def test_a_profile_rests_then_swings_between_its_limits():
    profile = Profile((0.0, 0.15 * DEG, 0.0), (90 * DEG,) * 3, rest=100.0, fluctuation=(0, 0, 0))
    t = np.array([0.0, 100.0, 400.0, 700.0, 1000.0, 1900.0, 2500.0])
    expected = np.array([0, 0, 45, 90, 45, -90, 0]) * DEG
    np.testing.assert_allclose(profile.angles(t)[:, 1], expected, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(profile.angles(t)[:, [0, 2]], 0)


def test_as_stated_the_table_never_reaches_a_pole():
    """0.015 deg/s for 2500 s are 37.5 deg at most."""
    profile = Profile(rest=0.0, fluctuation=(0.0, 0.0, 0.0))
    assert profile.angles(np.array([2500.0]))[0, 1] == pytest.approx(37.5 * DEG)


def test_a_negative_rate_moves_down_first_and_a_start_is_kept():
    profile = Profile((-1.0, 1.0, 0.0), (2.0, 2.0, 2.0), (0.5, -1.5, 3.0), rest=1.0, fluctuation=(0, 0, 0))
    np.testing.assert_allclose(profile.angles(np.array([0.0, 2.0])), [[0.5, -1.5, 3.0], [-0.5, -0.5, 3.0]], atol=1e-15)
    np.testing.assert_allclose(profile.angles(np.array([4.5]))[0, 0], -1.0, atol=1e-15)  # -2 at 3.5 s, then up


def test_fluctuations_have_the_stated_size_and_seed():
    t = np.linspace(0, 5000, 500001)
    options = {"rate": (0.0, 0.0, 0.1), "limit": (1.0, 1.0, 1e6), "rest": 10.0}
    quiet = Profile(**options, fluctuation=(0, 0, 0)).angles(t)
    noisy = Profile(**options, fluctuation=(0.0, 0.003, 0.001), seed=4).angles(t) - quiet
    assert (noisy[t <= 10] == 0).all()
    rms = np.sqrt((np.gradient(noisy, t, axis=0)[2000:] ** 2).mean(axis=0))
    np.testing.assert_allclose(rms, [0.0, 0.003, 0.001], rtol=0.05)  # tones beat over 5000 s
    again = Profile(**options, fluctuation=(0.0, 0.003, 0.001), seed=4).angles(t[:100])
    np.testing.assert_array_equal(again - quiet[:100], noisy[:100])
    other = Profile(**options, fluctuation=(0.0, 0.003, 0.001), seed=5).angles(t[:5000]) - quiet[:5000]
    assert np.abs(other - noisy[:5000]).max() > 1e-5


def test_without_friction_a_servo_answers_a_ramp_as_in_closed_form():
    """J q'' + (d + kv) q' + kp (q - command) = 0 about the pitch axis, integrated by SciPy."""
    spec = mujoco.MjSpec.from_file(str(models_dir() / "turntable.xml"))
    spec.option.gravity = [0, 0, 0]
    for joint in spec.joints:
        joint.frictionloss = 0.0
    table = Turntable(spec)
    found = table.drive(Profile((0, 2 * DEG, 0), rest=0.2, fluctuation=(0, 0, 0)), 1.0, rate=1000.0, settle=0.0)
    # The balanced pitch axis alone: the inner frame rides on it.
    J = 0.1 + 0.5 + 14 * (0.0001**2 + 0.0002**2) + 0.12 + 8 * 0.0001**2
    response = solve_ivp(
        lambda t, y: [y[1], (1800 * (2 * DEG * max(t - 0.2, 0) - y[0]) - (50 + 0.6) * y[1]) / J],
        (0, 1),
        [0, 0],
        t_eval=found.t,
        rtol=1e-10,
        atol=1e-14,
        max_step=0.002,
    )
    # 2nd order in 1 ms of a servo of 50 rad/s: (0.05)^2 / 24 of the corner's 2 deg/s x 20 ms.
    np.testing.assert_allclose(found.angles[:, 1], response.y[0], rtol=0, atol=2e-7)
    np.testing.assert_allclose(found.angles[:, [0, 2]], 0, rtol=0, atol=1e-7)


def test_half_the_step_changes_the_angles_by_less_than_a_microradian(table):
    """Reversals in all axes, corners of the profile and the start included; the error falls with the square."""
    steps = (1e-2 / 7, 1e-2 / 14, 1e-2 / 28)
    angles = [table.drive(BUSY, 8.0, step=step, settle=1.0).angles for step in steps]
    coarse, fine = (np.abs(a - b).max(axis=0) for a, b in pairwise(angles))
    assert (fine < 1e-6).all()
    assert (fine < coarse / 2).all()


@pytest.mark.parametrize("rate", [0.015, 0.15, 1.0, 5.0, 20.0])
def test_the_step_is_chosen_so_that_half_of_it_changes_less_than_a_microradian(table, rate):
    """A rest, a start and a reversal at each rate, not aligned with the steps."""
    start = 90 - 1.5123 * rate
    profile = Profile((0, rate * DEG, 0), start=(0, start * DEG, 0), rest=0.5 + 1e-2 / 3, fluctuation=(0, 1e-5, 0))
    chosen = table.drive(profile, 4.0, settle=1.0)
    step = 0.01 / math.ceil(0.01 / profile.longest_step)
    assert step == pytest.approx(min(2e-3, 2e-3 / math.sqrt(rate)), rel=0.15)
    np.testing.assert_array_equal(table.drive(profile, 4.0, step=step, settle=1.0).angles, chosen.angles)
    halved = table.drive(profile, 4.0, step=step / 2, settle=1.0)
    assert np.abs(halved.angles - chosen.angles).max() < 1e-6
    assert np.abs(chosen.command[:, 1]).max() > 90 * DEG - 0.02 * rate * DEG - 1e-4


def test_the_axes_follow_their_commands_reverse_and_are_slowed_by_friction(busy):
    lag = np.abs(busy.angles - busy.command).max(axis=0)
    assert (lag < 0.5 * DEG).all()
    assert (lag > 0.03 * DEG).all()
    for k in range(3):
        assert (np.diff(np.sign(busy.rates[60:, k])) != 0).sum() >= 3


def test_friction_holds_a_table_at_rest(table):
    still = table.drive(Profile(rest=100.0, start=(1.0, 0.7, -2.0)), 5.0)
    assert np.ptp(still.angles, axis=0).max() < 1e-7  # 0.02 arcsec
    np.testing.assert_allclose(still.angles[0], [1.0, 0.7, -2.0], rtol=0, atol=1e-4)


def test_pieces_do_not_matter(table, busy, monkeypatch):
    monkeypatch.setattr(turntable, "PIECE", 777)
    again = table.drive(BUSY, 8.0, settle=1.0)
    for name in ("t", "angles", "rates", "command"):
        np.testing.assert_array_equal(getattr(again, name), getattr(busy, name))


def test_records_are_where_and_when_they_are_said_to_be(table):
    coarse, dense = (table.drive(BUSY, 1.0, rate=rate, step=5e-4, settle=1.0) for rate in (100.0, 1000.0))
    assert len(coarse) == 101
    assert len(dense) == 1001
    np.testing.assert_array_equal(dense.angles[::10], coarse.angles)
    np.testing.assert_array_equal(coarse.command, BUSY.angles(coarse.t))
    # The rates are the derivatives of the angles, up to their jumps within a record interval.
    slope = (dense.angles[2:] - dense.angles[:-2]) / 0.002
    assert np.abs(dense.rates).max() > 5 * DEG
    np.testing.assert_allclose(slope, dense.rates[1:-1], rtol=0, atol=5e-3)
    assert np.abs(slope - dense.rates[1:-1]).mean() < 1e-4


def test_encoders_round(busy):
    read = busy.encoder()
    np.testing.assert_allclose(read, busy.angles, rtol=0, atol=0.5001 * 0.0001 * DEG)
    np.testing.assert_allclose(read / (0.0001 * DEG), np.round(read / (0.0001 * DEG)), rtol=0, atol=1e-6)
    assert np.abs(read - busy.angles).max() > 0.4 * 0.0001 * DEG


def test_the_motion_is_the_recording_on_the_turning_earth(busy):
    motion = busy.motion()
    truth = motion.trajectory(busy.t)
    place = [32.06 * DEG, 118.8 * DEG, 0.0]
    for found, value in zip((truth.latitude, truth.longitude, truth.height), place, strict=True):
        np.testing.assert_allclose(found, value, rtol=0, atol=2e-9)
    expected = Rotation.from_euler("ZXY", busy.angles)
    turned = Rotation.from_quat(truth.q_nb, scalar_first=True) * expected.inv()
    assert turned.magnitude().max() < 1e-14 * 10
    np.testing.assert_allclose(track(truth.q_nb).forward, busy.angles, rtol=0, atol=1e-13)
    # After six hours it stands a quarter turn further in the inertial frame.
    far = RecordedTurntable(busy.t + 21600, busy.angles)
    one, other = (m.kinematics(np.array([t])).position[0] for m, t in ((motion, 0.0), (far, 21600.0)))
    turn = Rotation.from_rotvec([0, 0, WGS84.rate * 21600])
    np.testing.assert_allclose(other, turn.apply(one), rtol=1e-14)


def test_a_rig_at_rest_senses_the_earth():
    angles = np.array([0.4, 1.2, -0.7])
    motion = RecordedTurntable(np.arange(7.0), np.tile(angles, (7, 1)))
    read = bench.Rig.load("turntable", threads=1).sample(motion, np.array([0.5, 3.0]))
    C_bn = Rotation.from_euler("ZXY", angles).inv()
    L = 32.06 * DEG
    rate = C_bn.apply([0.0, WGS84.rate * math.cos(L), WGS84.rate * math.sin(L)])
    np.testing.assert_allclose(read.gyro, [rate, rate], rtol=0, atol=1e-15)  # the spline's rounding, differentiated
    gravity = np.linalg.norm(WGS84.gravity(WGS84.position(L, 118.8 * DEG, 0.0)))
    np.testing.assert_allclose(np.linalg.norm(read.accelerometers, axis=1), gravity, rtol=1e-14)
    # The plumb line of a J2 field leaves the ellipsoid's normal by arcseconds at most.
    np.testing.assert_allclose(read.accelerometers[0] / gravity, C_bn.apply([0, 0, 1]), rtol=0, atol=2e-5)


def test_a_solver_finds_the_angles_of_the_table(busy):
    """Dynamics, spline, sensing and integration in one chain, over all reversals, each within one update."""
    motion = busy.motion()
    increments = bench.Rig.load("turntable", threads=1).increments(motion, 100.0, 8.0)
    truth = motion.kinematics(busy.t[::4]).q_ib
    q = bench.solver("attitude", "dual-euler").solve(increments.dtheta_b, increments.dt, truth[0])
    turned = Rotation.from_quat(q, scalar_first=True) * Rotation.from_quat(truth, scalar_first=True).inv()
    assert turned.magnitude().max() < 5e-8  # 0.01 arcsec


def linear(name):
    spec = mujoco.MjSpec.from_file(str(models_dir() / "turntable.xml"))
    if name == "actuator":
        spec.delete(spec.actuators[1])
    else:
        spec.joint("roll").name = "lean"
    return spec


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda t: Turntable("imu"), "three hinge joints heading, pitch, roll, got free"),
        (lambda t: Turntable("turntabel"), "unknown model 'turntabel'.*did you mean 'turntable'"),
        (lambda t: Turntable(linear("joint")), "three hinge joints heading, pitch, roll, got heading, pitch, lean"),
        (lambda t: Turntable(linear("actuator")), "one actuator for each joint, in order, got 2"),
        (lambda t: t.drive(None, 1.0), "profile must be a Profile, got None"),
        (lambda t: t.drive(Profile(), -1.0), "duration must be a positive number, got -1.0"),
        (lambda t: t.drive(Profile(), 1.005), "duration must be a whole number of record intervals of 0.01 s"),
        (
            lambda t: t.drive(Profile(), 1.0, rate=300.0, step=1e-3),
            "1 / rate must be a whole number of steps of 0.001 s",
        ),
        (lambda t: t.drive(Profile(), 1.0, settle=-1.0), "settle must be a number >= 0, got -1.0"),
        (lambda t: t.drive(Profile(), 1.0, step=0.0), "step must be a positive number, got 0.0"),
        (lambda t: Profile(rest=-1.0), "rest must be a number >= 0, got -1.0"),
        (lambda t: Profile(seed=-1), "seed must be an integer >= 0, got -1"),
        (lambda t: Profile(limit=(0, 1, 1)), "limit of heading must be a positive number, got 0.0"),
        (lambda t: Profile(fluctuation=(0, 0, -1)), "fluctuation of roll must be a number >= 0, got -1.0"),
        (lambda t: Profile((0, 1, 0), (1, 1, 1), (0, 2, 0)), "start of pitch must be within .*1.0 rad, got 2.0"),
        (lambda t: Profile(rate=(0, 1)), r"rate must have shape \(3,\)"),
        (lambda t: TableRecording(*np.zeros((4, 8, 3))).encoder(0.0), "resolution must be a positive number, got 0.0"),
        (lambda t: RecordedTurntable(np.arange(7.0), np.zeros((6, 3))), r"angles must have shape \(7, 3\)"),
        (lambda t: RecordedTurntable(np.arange(5.0), np.zeros((5, 3))), "at least 6 times"),
        (
            lambda t: RecordedTurntable(np.arange(7.0), np.zeros((7, 3))).kinematics([7.0]),
            r"t must lie in the motion's span \[0.0, 6.0\] s, got t\[0\] = 7.0",
        ),
        (lambda t: RecordedTurntable(np.arange(7.0), np.zeros((7, 3)), latitude=32.06), "latitude must be within"),
    ],
)
def test_bad_input_is_named(table, call, message):
    with pytest.raises(bench.InputError, match=message):
        call(table)


def test_a_step_that_is_too_long_is_an_error(table, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # MuJoCo logs what goes wrong
    with pytest.raises(bench.AccuracyError, match=r"not stable at a step of 0\.1 s"):
        table.drive(BUSY, 60.0, rate=10.0, step=0.1)
