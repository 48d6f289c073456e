"""Speed of INS and damping filter together, alone and beside the feedback filter of python-ins on the same data."""

import math
import time

import numpy as np
import pytest

import bench
from bench.earth import SPHERE, WGS84
from bench.imu import SensorErrors
from bench.imu.turn_on_bias import TurnOnBias
from bench.motion.sinusoidal_velocity import SinusoidalVelocity
from bench.rotation import matrix_from_quat, quat_from_rotvec, quat_multiply
from bench.solvers.damping import DampingModel, InsSamples, error_states
from bench.trajectory import NavigationInitial
from bench.units import ARCMIN, DEG, DEG_PER_H, MICRO_G
from tests.benchmarks.test_attitude_speed import PATIENCE, REFERENCE, reference

RATE, SECONDS = 100, 200
TILT, HEADING, NOISE = 0.7 * ARCMIN, 7.7 * ARCMIN, 0.05
WHITE = 1e-4  # (m/s^2)/sqrt(Hz)
MODEL = DampingModel(
    tau_f=1e7, tau_g=1e7, accelerometer_drift=0.0, gyro_drift=0.0, velocity_noise=WHITE, attitude_noise=1e-8
)


def flight(earth, seconds):
    """Return motion, increments with sensor errors, and the erroneous start."""
    motion = SinusoidalVelocity(
        duration=float(seconds), latitude=45 * DEG, height=0.0, mean=(10.0, 8.0, 0.0), amplitude=(2.0, -1.0, 0.0),
        frequency=(0.05, 0.03, 0.0), phase=(0.0, 0.0, 0.0), follow=False, attitude=(0.4, 0.02, -0.01), earth=earth,
    )  # fmt: skip
    increments = bench.Rig.load("imu", threads=1).increments(motion, RATE, seconds)
    gyro = SensorErrors((TurnOnBias(value=0.005 * DEG_PER_H),))
    accelerometer = SensorErrors((TurnOnBias(value=50 * MICRO_G),))
    dtheta = gyro.apply(increments.dtheta_b, increments.dt, "increments", seed=1)
    dvel = accelerometer.apply(increments.dvel, increments.dt, "increments", seed=1)
    start = motion.navigation_initial()
    initial = NavigationInitial(
        quat_multiply(quat_from_rotvec([-TILT, -TILT, -HEADING]), start.q_nb),
        start.v_n + np.array([0.1, 0.1, 0.0]),
        latitude=start.latitude,
        longitude=start.longitude,
        height=start.height,
    )
    return motion, dtheta, dvel, initial


def damped(earth, dtheta, dvel, initial, v_ref, name):
    """Return samples of the INS and the filter's solution: all that a user calls."""
    solver = bench.solver("navigation", "navigation-frame", samples=2, height="held")
    estimate = solver.solve(dtheta, dvel, 1 / RATE, initial, earth)
    ins = InsSamples.of(estimate[:: RATE // 2])
    return ins, bench.solver("damping", name, model=MODEL).solve(ins, v_ref)


def reference_of(motion, seconds):
    true = motion.trajectory(np.arange(seconds + 1.0))
    noise = NOISE * np.random.default_rng(3).standard_normal((seconds + 1, 2))
    return true, true.v_n[:, :2] + noise


def timed(call):
    """Return the processor time of a call, s, which others on the same machine hardly change, and its result."""
    begin = time.process_time()
    result = call()
    return time.process_time() - begin, result


@pytest.mark.slow
@pytest.mark.parametrize("name", ["velocity-error", "double-filter", "bias-augmented"])
def test_ins_samples_per_second_of_one_core(name):
    """At least 3 M INS samples a second at 100 Hz with an update a second."""
    seconds, floor = 600, 3e6
    motion, dtheta, dvel, initial = flight(SPHERE, SECONDS)
    _, v_ref = reference_of(motion, SECONDS)
    repeats = seconds // SECONDS  # what the numbers are does not matter for the speed
    dtheta, dvel = np.tile(dtheta, (repeats, 1)), np.tile(dvel, (repeats, 1))
    v_ref = np.concatenate([v_ref[:1], np.tile(v_ref[1:], (repeats, 1))])
    n = len(dtheta)
    damped(SPHERE, dtheta[: 10 * RATE], dvel[: 10 * RATE], initial, v_ref[:11], name)  # compiles
    reference(dtheta[:1])
    best, unit, tries, end = math.inf, math.inf, 0, time.perf_counter() + PATIENCE
    while tries < 10 or (n / best < floor and time.perf_counter() < end):
        best = min(best, timed(lambda: damped(SPHERE, dtheta, dvel, initial, v_ref, name))[0])
        unit = min(unit, timed(lambda: reference(dtheta))[0])
        tries += 1
    print(f"{name}: {n / best / 1e6:.1f} M INS samples/s, best of {tries}")
    assert n / best > floor * min(1.0, REFERENCE / (unit / n))


def in_pyins(dtheta, dvel, initial, v_ref):
    """Return a call of the peer's filter on the same data: north-east-down, forward-right-down, degrees."""
    filters, sensors = pytest.importorskip("pyins.filters"), pytest.importorskip("pyins.inertial_sensor")
    import pandas as pd
    from pyins.measurements import NedVelocity
    from scipy.spatial.transform import Rotation

    swap = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    t = (1 + np.arange(len(dtheta))) / RATE
    columns = ["theta_x", "theta_y", "theta_z", "dv_x", "dv_y", "dv_z"]
    increments = pd.DataFrame(np.hstack([dtheta @ swap, dvel @ swap]), index=t, columns=columns)
    increments.insert(0, "dt", 1 / RATE)
    rph = Rotation.from_matrix(swap @ matrix_from_quat(initial.q_nb) @ swap).as_euler("xyz", degrees=True)
    place = [math.degrees(initial.latitude), math.degrees(initial.longitude), initial.height]
    names = ["lat", "lon", "alt", "VN", "VE", "VD", "roll", "pitch", "heading"]
    pva = pd.Series([*place, *(swap @ initial.v_n), *rph], index=names, name=0.0)
    seconds = np.arange(1.0, len(v_ref))
    velocity = pd.DataFrame({"VN": v_ref[1:, 1], "VE": v_ref[1:, 0], "VD": 0.0}, index=seconds)

    def call():
        return filters.run_feedback_filter(
            pva,
            position_sd=60.0,
            velocity_sd=0.1,
            level_sd=math.degrees(TILT),
            azimuth_sd=math.degrees(HEADING),
            increments=increments,
            gyro_model=sensors.EstimationModel(bias_sd=0.005 * DEG_PER_H, noise=1e-8),
            accel_model=sensors.EstimationModel(bias_sd=50 * MICRO_G, noise=WHITE),
            measurements=[NedVelocity(velocity, NOISE)],
            time_step=1.0,
            with_altitude=False,
        )

    return call


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::FutureWarning")
def test_more_than_a_hundred_times_faster_than_pyins_and_no_less_accurate():
    duration = 60
    motion, dtheta, dvel, initial = flight(WGS84, duration)
    true, v_ref = reference_of(motion, duration)
    peer = in_pyins(dtheta, dvel, initial, v_ref)
    damped(WGS84, dtheta, dvel, initial, v_ref, "velocity-error")
    ours = theirs = math.inf
    for _ in range(2):
        seconds, (ins, solution) = timed(lambda: damped(WGS84, dtheta, dvel, initial, v_ref, "velocity-error"))
        ours = min(ours, seconds)
        seconds, result = timed(peer)
        theirs = min(theirs, seconds)
    late = slice(duration // 2, None)
    error = error_states(solution.corrected(ins), true)[late, :2]
    rows = result.trajectory.loc[np.arange(duration // 2, duration + 1.0)]
    peer_error = rows[["VE", "VN"]].to_numpy() - true.v_n[late, :2]
    rms, peer_rms = (float(np.sqrt((e**2).mean())) for e in (error, peer_error))
    print(f"pyins {theirs:.2f} s, ours {ours:.4f} s: {theirs / ours:.0f} times; rms {rms:.4f} and {peer_rms:.4f} m/s")
    assert theirs > 100 * ours
    assert rms < 1.05 * peer_rms
