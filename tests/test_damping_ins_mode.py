"""The fast simulation of errors against an INS that the rig feeds: what the damping filters correct is the latter."""

import math
import tracemalloc

import numpy as np
import pytest

import bench
from bench.earth import SPHERE
from bench.error_simulation import ErrorSimulation, disturbed, reference_velocity
from bench.experiments._damping_runs import damp, free_ins
from bench.experiments._damping_trials import Options, ship
from bench.imu import SensorErrors
from bench.imu.turn_on_bias import TurnOnBias
from bench.motion.sinusoidal_velocity import SinusoidalVelocity
from bench.rotation import quat_conjugate, quat_from_rotvec, quat_multiply, quat_rotate
from bench.solvers.damping import DampingModel, InsSamples, error_states
from bench.trajectory import NavigationInitial
from bench.units import ARCMIN, ARCSEC, DEG_PER_H, MICRO_G
from tests.damping_cases import NAMES

RATE, DURATION = 20.0, 2400.0
X0 = np.array(
    [0.1, 0.1, 2 * ARCSEC, 2 * ARCSEC, 0.7 * ARCMIN, 0.7 * ARCMIN, 7.7 * ARCMIN]
    + [50 * MICRO_G] * 3
    + [-0.005 * DEG_PER_H] * 3
)
CONSTANT = DampingModel(tau_f=1e12, tau_g=1e12, accelerometer_drift=0, gyro_drift=0, velocity_noise=0, attitude_noise=0)
MOTION = SinusoidalVelocity(
    duration=DURATION, latitude=math.radians(45), height=0.0, mean=(10.0, 8.0, 0.0), amplitude=(2.0, -1.0, 0.0),
    frequency=(2 * math.pi / 600,) * 3, follow=False, attitude=(0.4, 0.0, 0.0), swing=(0.02, 0.03, 0.05),
    swing_frequency=(0.3, 0.5, 0.4), earth=SPHERE,
)  # fmt: skip


@pytest.fixture(scope="module")
def run():
    """Return true samples and those of the INS, once a second, with the published sensor and initial errors."""
    increments = bench.Rig.load("imu", threads=1).increments(MOTION, RATE, DURATION)
    gyro = SensorErrors((TurnOnBias(value=0.005 * DEG_PER_H),))
    accelerometer = SensorErrors((TurnOnBias(value=50 * MICRO_G),))
    dtheta = gyro.apply(increments.dtheta_b, increments.dt, "increments", seed=1)
    dvel = accelerometer.apply(increments.dvel, increments.dt, "increments", seed=1)
    start = MOTION.navigation_initial()
    initial = NavigationInitial(
        quat_multiply(quat_from_rotvec(-X0[4:7]), start.q_nb),
        start.v_n + np.array([X0[0], X0[1], 0.0]),
        latitude=start.latitude + X0[2],
        longitude=start.longitude + X0[3],
        height=start.height,
    )
    solver = bench.solver("navigation", "navigation-frame", samples=2, height="held")
    estimate = solver.solve(dtheta, dvel, increments.dt, initial, SPHERE)
    ins = InsSamples.of(estimate[:: round(RATE / 2)])
    return InsSamples.of(MOTION.trajectory(ins.t)), ins


def test_the_samples_specific_force_is_what_the_accelerometers_feel(run):
    """Truth: the mean of C_nb f_b over each second from the motion's own kinematics, 20 points of the midpoint rule."""
    truth, _ = run
    t = (np.arange(40 * 20) + 0.5) / 20
    kinematics = MOTION.kinematics(t)
    f_i = kinematics.acceleration - kinematics.gravity
    trajectory = MOTION.trajectory(t)
    f_b = quat_rotate(quat_conjugate(kinematics.q_ib), f_i)
    f_n = quat_rotate(trajectory.q_nb, f_b).reshape(40, 20, 3).mean(axis=1)
    # The trapezoidal rule on the Coriolis terms: 1.5e-4 1/s * v''/12; v'' = 2 (2 pi/600)^2 m/s^3.
    np.testing.assert_allclose(truth.f_n[1:41], f_n, rtol=0, atol=2e-7)


def test_the_error_simulation_agrees_with_the_ins(run):
    truth, ins = run
    simulation = ErrorSimulation(CONSTANT, trials=1)
    _, x = simulation.advance(simulation.start(X0), truth)
    expected = error_states(ins, truth.trajectory())
    largest = np.abs(expected).max(axis=0)
    # Left out: products of three angles of 2e-3 rad, 1e-8 of a turn rate or of g each, summed over 2400 s.
    np.testing.assert_allclose(x[:, 0, :7] / largest, expected / largest, rtol=0, atol=1e-5)
    assert largest[2] * SPHERE.semi_major_axis > 300.0  # metres: the INS does drift


@pytest.mark.parametrize("name", NAMES)
def test_the_filters_correct_both_alike(run, name):
    truth, ins = run
    simulation = ErrorSimulation(CONSTANT, trials=1)
    _, x = simulation.advance(simulation.start(X0), truth)
    v_ref = reference_velocity(truth, error=(-0.3, -0.3), noise=0.05, seed=2)
    damping = bench.solver("damping", name)
    of_ins, of_model = (damping.solve(samples, v_ref) for samples in (ins, disturbed(truth, x[:, 0])))
    # A thousandth of the claimed standard deviation, and 1e-5 of the INS's errors, as above.
    tolerance = 1e-3 * of_ins.sigma[:, :13] + 1e-5 * np.abs(x[:, 0])
    assert (np.abs(of_ins.x - of_model.x)[:, :7] < tolerance[:, :7]).all()
    free, damped = (np.abs(error_states(s, truth.trajectory())[-1, :2]).max() for s in (ins, of_ins.corrected(ins)))
    assert damped < 0.5 < free if name != "velocity-change" else damped < free


def test_the_simulation_has_the_same_trials_in_any_company_and_chunks(run):
    truth, _ = run
    many, two = ErrorSimulation(trials=4, seed=5), ErrorSimulation(trials=2, seed=5)
    _, x = many.advance(many.start(), truth[:60])
    state, first = two.advance(two.start(), truth[:1])
    state, second = two.advance(state, truth[1:30])
    _, third = two.advance(state, truth[30:60])
    np.testing.assert_array_equal(np.concatenate([first, second, third]), x[:, :2])


def test_the_simulations_noise_is_the_models(run):
    """Of 400 trials at rest: variances of Van Loan's Q_d after 30 s, within four standard deviations of a variance."""
    from bench.solvers.damping.error_model import discretise, error_matrix

    truth, _ = run
    model = DampingModel(tau_f=100.0, tau_g=100.0)
    simulation = ErrorSimulation(model, trials=400, seed=6)
    _, x = simulation.advance(simulation.start(np.zeros(13)), truth[:31])
    F = error_matrix(
        truth.v_n[15:16], truth.latitude[:1], truth.q_nb[15:16], truth.f_n[15:16], tau_f=100.0, tau_g=100.0
    )
    _, Q_d = discretise(F[0], np.diag(model.density), 30.0)
    ratio = x[-1].var(axis=0) / np.diag(Q_d)
    assert np.abs(ratio - 1).max() < 4 * math.sqrt(2 / 400)


def test_memory_stays_flat_as_a_run_gets_longer():
    """INS, rig and all filters, hour by hour: six hours more cost 0.1 MB each at most, for the table of the path.

    What the samples and solutions of one hour take is the peak, 15 MB.
    """

    def peak(hours):
        options = Options(duration=hours)
        tracemalloc.start()
        for chunk in damp(options, free_ins(ship(options), 2.0, hours * 3600.0, options.initial, 0), 0, (-0.3,)):
            assert np.isfinite(chunk[0].solutions["fusion"].x).all()
        found = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return found

    peak(0.5)  # compiles
    assert peak(9.0) - peak(3.0) < 6 * 1e5


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda truth: ErrorSimulation(trials=0), "trials must be an integer >= 1"),
        (lambda truth: ErrorSimulation(seed=-1), "seed must be an integer >= 0"),
        (lambda truth: ErrorSimulation("exact"), "model must be a DampingModel"),
        (lambda truth: ErrorSimulation(trials=2).start(np.zeros(12)), r"initial must have shape \(13,\)"),
        (lambda truth: disturbed(truth, np.zeros((5, 13))), "x must have shape"),
        (lambda truth: reference_velocity(truth, noise=-1.0, seed=1), "noise must be a number >= 0"),
        (lambda truth: error_states(truth[:5], truth.trajectory()), "must have the same times"),
    ],
)
def test_bad_input(run, call, message):
    with pytest.raises(bench.InputError, match=message):
        call(run[0])
