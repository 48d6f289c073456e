"""Speed of the navigation solvers through `solve`, checks included, and beside the peer package python-ins (pyins).

Both get MuJoCo's increments at 100 Hz of the same motion, the hour of sinusoidal velocity with which pyins tests itself
(600 s of it), and each the gravitation that it believes in, so that its error is that of its algorithm: ours the J2
field, pyins Somigliana's gravity with its own dependence on height, less the centrifugal acceleration. Axes are turned
from RFU and ENU to its FRD and NED. pyins takes one increment an update, with coning and sculling from it and the one
before; ours takes two. Timed on our side: `solve`; on theirs the whole of `compute_increments_from_imu` and
`Integrator.integrate`, and the compiled loop `integrate` alone, without any preparation or output. Times are those
of the processor, so that other work on the machine costs cache and memory only.
"""

import math
import time
from dataclasses import replace

import numpy as np
import pytest

import bench
from bench.motion import Motion
from bench.motion.fast_vehicle import FastVehicle
from bench.motion.sinusoidal_velocity import SinusoidalVelocity
from bench.rotation import (
    matrix_from_quat,
    quat_conjugate,
    quat_from_matrix,
    quat_multiply,
    quat_rotate,
    rotvec_from_quat,
)
from bench.solvers.navigation.navigation_frame import NavigationFrame
from bench.trajectory import navigation_errors
from tests.benchmarks.test_attitude_speed import PATIENCE, REFERENCE, reference
from tests.inertial_cases import RATE, sensed

AXES = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])  # RFU to FRD, ENU to NED, and back
SECONDS = 600.0
pytestmark = pytest.mark.filterwarnings("ignore:The copy keyword is deprecated")  # in pyins, by pandas


def timed(call):
    begin = time.thread_time()
    call()
    return time.thread_time() - begin


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "options", "n", "floor"),
    [
        ("navigation-frame", {"samples": 2}, 240_000, 8e6),
        ("navigation-frame", {"samples": 2, "azimuth": "wander"}, 240_000, 6e6),
        ("navigation-frame", {"samples": 4}, 240_000, 11e6),
        ("navigation-frame", {"samples": 8}, 240_000, 12e6),
        ("inertial-frame", {"samples": 2}, 240_000, 6e6),
        ("dual-quaternion", {"samples": 2}, 120_000, 4e6),
        ("polynomial-exact", {"samples": 6}, 24_000, 0.5e6),
    ],
    ids=lambda value: "-".join(f"{k}={v}" for k, v in value.items()) if isinstance(value, dict) else None,
)
def test_increments_per_second_of_one_core(name, options, n, floor):
    solver, motion = bench.solver("navigation", name, **options), FastVehicle(30.0, height=100.0)
    some, start = sensed(motion, 24.0), motion.navigation_initial()
    dtheta, dvel = (np.resize(part, (n, 3)) for part in (some.dtheta_b, some.dvel))
    solver.solve(dtheta[:240], dvel[:240], 0.01, start)  # compiles
    reference(dtheta[:1])
    best, unit, tries, end = math.inf, math.inf, 0, time.perf_counter() + PATIENCE
    while tries < 20 or (n / best < floor and time.perf_counter() < end):
        best = min(best, timed(lambda: solver.solve(dtheta, dvel, 0.01, start)))
        unit = min(unit, timed(lambda: reference(dtheta)))
        tries += 1
    print(f"{name}: {n / best / 1e6:.1f} M increments/s, {best / unit:.1f} times the reference, best of {tries}")
    # A core that is slower than the reference allows, or shared just now, is asked for as much less.
    assert n / best > floor * min(1.0, REFERENCE / (unit / n))


class PeerGravity(Motion):
    """A motion on the Earth in the gravitation that pyins believes in."""

    def __init__(self, motion):
        self.motion = motion

    def kinematics(self, t):
        from pyins.earth import gravitation_ecef

        lla = geodetic_degrees(self.motion.trajectory(t))
        return replace(self.motion.kinematics(t), gravity=quat_rotate(self.motion.earth.q_ie(t), gravitation_ecef(lla)))


def geodetic_degrees(trajectory):
    return np.column_stack([np.degrees(trajectory.latitude), np.degrees(trajectory.longitude), trajectory.height])


class Peer:
    """pyins, fed with our increments."""

    def __init__(self, increments, truth):
        import pandas as pd
        from pyins import _numba_integrate, strapdown, transform, util

        self.strapdown, self.util, self.kernel = strapdown, util, _numba_integrate.integrate
        rows = np.hstack([increments.dtheta_b @ AXES, increments.dvel @ AXES])
        rows = np.vstack([rows[:1], rows])  # pyins wants one before the first
        self.imu = pd.DataFrame(rows, index=pd.Index(truth.t, name="time"), columns=util.GYRO_COLS + util.ACCEL_COLS)
        self.truth, self.C = truth, AXES @ matrix_from_quat(truth.q_nb) @ AXES
        first = [geodetic_degrees(truth)[0], truth.v_n[0] @ AXES, transform.mat_to_rph(self.C[:1])[0]]
        self.start = pd.Series(np.concatenate(first), index=util.LLA_COLS + util.VEL_COLS + util.RPH_COLS)
        steps = strapdown.compute_increments_from_imu(self.imu, "increment")
        theta, dv = (np.ascontiguousarray(steps[columns]) for columns in (util.THETA_COLS, util.DV_COLS))
        n = len(theta)
        lla, velocity, mat = np.empty((n + 1, 3)), np.empty((n + 1, 3)), np.empty((n + 1, 3, 3))
        lla[0], velocity[0], mat[0] = first[0], first[1], self.C[0]
        self.arguments = np.asarray(steps.dt), lla, velocity, mat, theta, dv, 0, True

    def solve(self):
        steps = self.strapdown.compute_increments_from_imu(self.imu, "increment")
        return self.strapdown.Integrator(self.start).integrate(steps)

    def loop(self):
        self.kernel(*self.arguments)

    def errors(self):
        """Return the largest errors: attitude, rad, and position east, north, up, m."""
        from pyins import transform

        found, truth = self.solve(), self.truth
        r = truth.earth.position(np.radians(found.lat), np.radians(found.lon), found.alt.to_numpy())
        position = quat_rotate(quat_conjugate(truth.q_en), r - truth.r_e)
        q_eb = quat_from_matrix(AXES @ transform.mat_from_rph(found[self.util.RPH_COLS]) @ AXES)
        attitude = rotvec_from_quat(quat_multiply(q_eb, quat_conjugate(truth.q_nb)))  # the frames are apart by 1e-9 rad
        return np.linalg.norm(attitude, axis=1).max(), np.abs(position).max(axis=0)


@pytest.fixture(scope="module")
def peer():
    pytest.importorskip("pyins", reason="the peer package python-ins is not installed")
    motion = SinusoidalVelocity()
    increments = bench.Rig.load("imu").increments(PeerGravity(motion), RATE, SECONDS)
    return Peer(increments, motion.trajectory(np.arange(len(increments) + 1) / RATE))


@pytest.fixture(scope="module")
def ours():
    return SinusoidalVelocity(), sensed(SinusoidalVelocity(), SECONDS)


def solved(ours):
    motion, increments = ours
    return NavigationFrame(2).solve(increments.dtheta_b, increments.dvel, 1 / RATE, motion.navigation_initial())


@pytest.mark.slow
def test_it_is_more_accurate_than_pyins(peer, ours):
    estimate = solved(ours)
    found = navigation_errors(estimate, ours[0].trajectory(estimate.t))
    attitude, position = np.linalg.norm(found.attitude, axis=1).max(), np.abs(found.position).max(axis=0)
    their_attitude, their_position = peer.errors()
    print(f"attitude {attitude:.1e} rad, pyins {their_attitude:.1e}; position {position} m, pyins {their_position}")
    # Sums that pass for pyins' own test in an hour, 0.1 m and 3 m, are in ten minutes:
    assert 1e-4 < their_position.max() < 0.1, "pyins is not fed as it wants to be"
    assert position.max() < 0.01 * their_position.max()
    assert attitude < 0.01 * their_attitude


@pytest.mark.slow
def test_it_is_faster_than_pyins(peer, ours):
    peer.solve()
    peer.loop()
    solved(ours)  # all is compiled now
    best = np.full(3, math.inf)
    calls = (lambda: solved(ours), peer.loop, peer.solve)
    end = time.perf_counter() + PATIENCE
    for tries in range(1000):
        if tries >= 5 and ((best[1] > 2 * best[0] and best[2] > 5 * best[0]) or time.perf_counter() > end):
            break
        best = np.minimum(best, [timed(call) for call in calls])
    mine, loop, whole = SECONDS * RATE / best / 1e6
    print(f"ours {mine:.2f}, pyins' loop alone {loop:.2f}, pyins {whole:.3f} M increments/s")
    assert mine > 2 * loop
    assert mine > 5 * whole
