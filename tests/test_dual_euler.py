"""Dual Euler, forward Euler and the first-order quaternion: through both poles, over the switch, at the singular point.

Truth: attitudes prescribed by angles (closed form), increments by Gauss-Legendre quadrature of their closed-form rates;
an independent integrator (SciPy's DOP853) of the printed differential equations.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import bench
from bench.euler_angles import quat_from_reverse, track
from bench.motion.coning import Coning
from bench.motion.euler_swing import EulerSwing
from bench.rotation import quat_conjugate, quat_from_euler, quat_multiply, rotvec_from_quat
from bench.solvers.attitude.dual_euler import DualEuler
from bench.solvers.attitude.euler import Euler
from bench.solvers.attitude.first_order_quaternion import FirstOrderQuaternion
from bench.solvers.attitude.picard import Picard
from bench.units import DEG

RATE = 100.0  # Hz
ONE = [1.0, 0.0, 0.0, 0.0]


def increments(motion, n, rate=RATE):
    """Integrals of the true rate, eight Gauss-Legendre nodes an interval."""
    node, weight = np.polynomial.legendre.leggauss(8)
    t = (np.arange(n)[:, None] + 0.5 * (node + 1)) / rate
    omega = motion.kinematics(t.ravel()).omega_ib_b.reshape(n, len(node), 3)
    return (omega * (0.5 / rate * weight)[:, None]).sum(axis=1)


def error(q, truth):
    return np.linalg.norm(rotvec_from_quat(quat_multiply(q, quat_conjugate(truth))), axis=-1)


def through_both_poles(seed):
    """A swing whose pitch passes +90 and -90 deg in every period, with yaw and roll of any size."""
    rng = np.random.default_rng(seed)
    amplitude = rng.uniform([0.5, 100 * DEG, 0.5], [3.0, 250 * DEG, 3.0])
    period = rng.uniform(8.0, 30.0, 3)
    offset = rng.uniform(-3, 3, 3) * [1, 0, 1]
    return EulerSwing(amplitude, 2 * math.pi / period, rng.uniform(0, 2 * math.pi, 3), offset)


@pytest.mark.parametrize("seed", range(8))
def test_paths_through_both_poles_stay_within_a_nanoradian(seed):
    motion, n = through_both_poles(seed), 6000
    truth = motion.kinematics(np.arange(0, n + 1, 4) / RATE).q_ib
    pitch = np.arcsin(2 * (truth[:, 0] * truth[:, 1] + truth[:, 2] * truth[:, 3]))
    assert pitch.max() > 89 * DEG
    assert pitch.min() < -89 * DEG
    solver = DualEuler()
    q = solver.solve(increments(motion, n), 1 / RATE, truth[0])
    assert error(q, truth).max() < 1e-9
    assert (np.diff(solver.angles(q).flag) != 0).sum() >= 8


@pytest.mark.parametrize("samples", [1, 2, 4])
def test_switching_never_loses_more_than_rounding(samples):
    """The borders of the switch move, the attitude does not: 2000 updates, with and without dozens of switches."""
    motion, n = through_both_poles(0), 8000
    dtheta, q0 = increments(motion, n), motion.kinematics(np.zeros(1)).q_ib[0]
    solvers = [DualEuler(samples, hysteresis * DEG) for hysteresis in (0, 1, 5, 20)]
    found = [solver.solve(dtheta, 1 / RATE, q0) for solver in solvers]
    switches = [np.flatnonzero(np.diff(s.angles(q).flag)) for s, q in zip(solvers, found, strict=True)]
    assert all(len(rows) >= 8 for rows in switches)
    assert not np.array_equal(switches[0], switches[-1])
    for q in found[1:]:
        assert error(q, found[0]).max() < 1e-13  # random walk of 2000 to 8000 roundings of 3e-16


def test_the_switch_to_and_fro_in_every_update_loses_no_more_than_rounding():
    """Pitch 45 +- 0.2 deg without hysteresis against 5 degrees of it, which never switches."""
    motion = EulerSwing((0.1, 0.2 * DEG, 0.1), (3.0, 40.0, 5.0), offset=(1.0, 45 * DEG, -2.0))
    dtheta, q0 = increments(motion, 20000), motion.kinematics(np.zeros(1)).q_ib[0]
    busy, calm = DualEuler(1, 0.0), DualEuler(1)
    q = busy.solve(dtheta, 1 / RATE, q0)
    assert (np.diff(busy.angles(q).flag) != 0).sum() > 2000
    assert error(q, calm.solve(dtheta, 1 / RATE, q0)).max() < 3e-13


def printed(t, y, omega):
    """Equations (6) and (12) to (15): psi, P, R and psi_r, P_r, R_r, in the convention of this project."""
    _, P, R, _, P_r, R_r = y
    wx, wy, wz = omega(t)
    across = wz * math.cos(R) - wx * math.sin(R)
    level = wy * math.sin(P_r) + wz * math.cos(P_r)
    return [
        across / math.cos(P),
        wx * math.cos(R) + wz * math.sin(R),
        wy - math.tan(P) * across,
        level / math.cos(R_r),
        wx + math.tan(R_r) * level,
        wy * math.cos(P_r) - wz * math.sin(P_r),
    ]


def test_the_angles_are_those_of_the_printed_equations():
    """Both sets integrated by SciPy from the same rate, where both are regular."""
    motion = EulerSwing((0.5, 0.4, 0.3), (1.0, 1.7, 2.3), (0.2, 0.5, 1.0), (0.7, 0.6, -0.4))
    q0 = motion.kinematics(np.zeros(1)).q_ib[0]
    start = track([q0])
    solution = solve_ivp(
        printed,
        (0, 3),
        [*start.forward[0], *start.reverse[0]],
        method="DOP853",
        t_eval=np.arange(0, 76) / 25,
        rtol=1e-13,
        atol=1e-13,
        args=(lambda t: motion.kinematics(np.array([t])).omega_ib_b[0],),
    )
    solver = DualEuler()
    found = solver.angles(solver.solve(increments(motion, 300), 1 / RATE, q0))
    np.testing.assert_allclose(np.hstack([found.forward, found.reverse]), solution.y.T, rtol=0, atol=2e-10)


def test_the_flag_is_the_one_the_solver_went_by():
    motion, n = through_both_poles(3), 4000
    solver, q0 = DualEuler(), motion.kinematics(np.zeros(1)).q_ib[0]
    state, rows, sides = solver.start(1 / RATE, q0), [q0], []
    sides.append(state.carry[7])
    for block in np.split(increments(motion, n), n // 4):
        state, q = solver.advance(state, block)
        rows.append(q[0])
        sides.append(state.carry[7])
        yaw, middle, inner = state.carry[:3]
        of_angles = (
            quat_from_euler(yaw, middle, inner)
            if sides[-1] > 0
            else quat_from_reverse(yaw - math.pi / 2, -inner, middle)
        )
        assert error(of_angles[np.newaxis], q)[0] < 1e-15  # the angles are the attitude
        assert abs(middle) < 51 * DEG
    np.testing.assert_array_equal(solver.angles(np.array(rows)).flag, sides)
    assert set(sides) == {1.0, -1.0}


def test_large_increments_are_cut_into_steps():
    """A turn of up to 3 rad in an update, at a constant rate, needs several power series."""
    turn = np.array([2.0, -3.0, 6.0]) / 7 * 3.0
    q = DualEuler(2).solve(np.tile(turn / 2, (40, 1)), 0.01, ONE)
    half = 1.5 * np.arange(21)
    truth = np.column_stack([np.cos(half), np.sin(half)[:, None] * turn / 3.0])
    assert error(q, truth).max() < 1e-13


PITCHING = EulerSwing((0.0, 100 * DEG, 0.0), (0.0, 2 * math.pi / 8, 0.0), offset=(0.3, 0.0, 0.4))


@pytest.mark.parametrize("miss", [1e-1, 1e-3, 1e-6])
def test_forward_angles_pass_beside_a_pole_by_halving_the_updates(miss):
    """The swing is tilted, so that it misses the pole."""
    tilt = np.array([math.cos(miss / 2), 0.0, math.sin(miss / 2), 0.0])
    truth = quat_multiply(tilt, PITCHING.kinematics(np.arange(0, 1201, 4) / RATE).q_ib)
    assert error(Euler().solve(increments(PITCHING, 1200), 1 / RATE, truth[0]), truth).max() < 1e-9


def test_forward_angles_fail_at_the_pole_and_say_so():
    """On the meridian itself yaw and roll jump by half a turn in no time."""
    dtheta = increments(PITCHING, 400) + np.array([1e-9, 0, 2e-9])
    truth = PITCHING.kinematics(np.zeros(1)).q_ib[0]
    with pytest.raises(bench.AccuracyError, match=r"euler fails in update \d+, at pitch (89\.9|90\.0).* dual-euler"):
        Euler(halvings=12).solve(dtheta, 1 / RATE, truth)
    DualEuler().solve(dtheta, 1 / RATE, truth)


def test_a_fixed_step_comes_out_of_the_pole_wrong():
    miss = 1e-3
    tilt = np.array([math.cos(miss / 2), 0.0, math.sin(miss / 2), 0.0])
    truth = quat_multiply(tilt, PITCHING.kinematics(np.arange(0, 401, 4) / RATE).q_ib)
    dtheta = increments(PITCHING, 400)
    fixed = error(Euler(halvings=0).solve(dtheta, 1 / RATE, truth[0]), truth)
    pole = np.argmax(np.abs(2 * (truth[:, 0] * truth[:, 1] + truth[:, 2] * truth[:, 3])) > math.cos(0.2))
    assert fixed[: pole - 1].max() < 1e-9
    assert fixed[-1] > 1 * DEG
    assert error(DualEuler().solve(dtheta, 1 / RATE, truth[0]), truth).max() < 1e-9


def test_first_order_quaternion_grows_and_is_picard_s_first_order():
    dtheta = np.random.default_rng(0).normal(scale=0.05, size=(500, 3))
    solver = FirstOrderQuaternion()
    state, q = solver.advance(solver.start(0.01, ONE), dtheta)
    expected = np.sqrt(np.prod(1 + (dtheta**2).sum(axis=1) / 4))
    assert np.linalg.norm(state.carry) == pytest.approx(expected, rel=1e-13)
    assert expected > 1.3
    assert error(q, Picard(order=1).solve(dtheta, 0.01, ONE)[1:]).max() < 1e-13


def test_first_order_quaternion_halts_half_a_turn_round_z():
    q = FirstOrderQuaternion().solve(np.zeros((3, 3)), 0.01, [0.0, 0.0, 0.0, 1.0])
    np.testing.assert_array_equal(q, [[0.0, 0.0, 0.0, 1.0]] * 4)


def test_dual_euler_is_no_worse_than_the_quaternion_on_coning():
    """The same fitted rate, so the same error to rounding: the angles add none."""
    motion, n = Coning(20 * DEG, 4 * math.pi), 4000
    q0, dtheta = motion.kinematics(np.zeros(1)).q_ib[0], motion.increments(RATE, n)
    quaternion = bench.solver("attitude", "taylor-quaternion", samples=4).solve(dtheta, 1 / RATE, q0)
    assert error(DualEuler().solve(dtheta, 1 / RATE, q0), quaternion).max() < 1e-13


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: DualEuler(4, -1.0), "hysteresis must be a number >= 0, got -1.0"),
        (lambda: DualEuler(4, 0.8), "hysteresis must be below pi/4 rad, got 0.8"),
        (lambda: Euler(halvings=61), "halvings must be an integer from 0 to 60, got 61"),
        (lambda: Euler(halvings=-1), "halvings must be an integer >= 0, got -1"),
        (lambda: FirstOrderQuaternion(2), "samples must be an integer from 1 to 1, got 2"),
    ],
)
def test_bad_options_are_named(make, message):
    with pytest.raises(bench.InputError, match=message):
        make()
