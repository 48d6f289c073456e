"""The traditional baselines: Runge-Kutta 4 of quaternion and DCM, one-sample Picard.

Truth: closed forms of the constant rate and of coning; a Runge-Kutta step written with matrices in this file.
"""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from bench.errors import AccuracyError, InputError
from bench.motion.coning import Coning
from bench.rotation import matrix_from_quat, quat_conjugate, quat_multiply, rotvec_from_quat
from bench.solvers.attitude.picard import Picard
from bench.solvers.attitude.runge_kutta_dcm import RungeKuttaDcm
from bench.solvers.attitude.runge_kutta_quaternion import RungeKuttaQuaternion
from bench.units import DEG

ONE = [1.0, 0, 0, 0]
SOLVERS = [
    *(RungeKuttaQuaternion(n) for n in (1, 2, 3, 6)),
    *(RungeKuttaDcm(n) for n in (1, 2, 3)),
    RungeKuttaDcm(2, orthonormalise=False),
    *(Picard(order=k) for k in (1, 2, 3, 4)),
]


def error(q, truth):
    return np.linalg.norm(rotvec_from_quat(quat_multiply(q, quat_conjugate(truth))), axis=-1)


def skew(w):
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def right_product(w):
    """The matrix R with R q = q o (0, w)/2."""
    x, y, z = 0.5 * np.asarray(w)
    return np.array([[0, -x, -y, -z], [x, 0, z, -y], [y, -z, 0, x], [z, y, -x, 0]])


def step(derivative, y, rates):
    """One classical Runge-Kutta step of length 1 with the rates at its start, middle and end."""
    k1 = derivative(y, rates[0])
    k2 = derivative(y + k1 / 2, rates[1])
    k3 = derivative(y + k2 / 2, rates[1])
    k4 = derivative(y + k3, rates[2])
    return y + (k1 + 2 * k2 + 2 * k3 + k4) / 6


def classical_rates(d):
    """The rates of one (held) or two (linear) increments."""
    return [d[0]] * 3 if len(d) == 1 else [3 * d[0] - d[1], d[0] + d[1], 3 * d[1] - d[0]]


@pytest.mark.parametrize("samples", [1, 2])
def test_it_is_the_classical_algorithm(samples):
    dtheta = np.random.default_rng(samples).normal(scale=0.05, size=(6 * samples, 3))
    q, C = np.array(ONE), np.eye(3)
    for d in dtheta.reshape(6, samples, 3):
        q = step(lambda y, w: right_product(w) @ y, q, classical_rates(d))
        q /= np.linalg.norm(q)
        C = step(lambda y, w: y @ skew(w), C, classical_rates(d))
    solved = RungeKuttaQuaternion(samples).solve(dtheta, 0.01, ONE)[-1]
    np.testing.assert_allclose(solved, q, rtol=0, atol=1e-15)
    solver = RungeKuttaDcm(samples, orthonormalise=False)
    state, rows = solver.advance(solver.start(0.01, ONE), dtheta)
    np.testing.assert_allclose(state.carry[:9].reshape(3, 3), C, rtol=0, atol=2e-15)
    # The quaternion is that of the matrix as far as it is a rotation.
    np.testing.assert_allclose(matrix_from_quat(rows[-1]), C, rtol=0, atol=2 * np.abs(C.T @ C - np.eye(3)).max())


@pytest.mark.parametrize("solver", SOLVERS, ids=str)
def test_a_constant_rate_has_the_declared_error(solver):
    # 0.1 rad an update; all errors of one axis add up.
    axis = np.array([2.0, -3.0, 6.0]) / 7
    updates = 50
    q = solver.solve(np.tile(0.1 / solver.samples * axis, (updates * solver.samples, 1)), 0.01, ONE)
    half = 0.05 * updates
    truth = np.array([math.cos(half), *(math.sin(half) * axis)])
    found = min(error(q[-1], truth), error(-q[-1], truth)) / updates
    assert found <= solver.constant_rate_tolerance
    assert found > 0.75 * solver.constant_rate_tolerance  # and no less honest


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_picard_keeps_the_terms_of_its_order(order):
    # The powers of the increment's matrix are summed by themselves, and all of them by SciPy.
    dtheta = np.array([[0.3, -0.2, 0.4]])
    R = right_product(dtheta[0])
    q = sum(np.linalg.matrix_power(R, k) / math.factorial(k) for k in range(order + 1)) @ ONE
    solved = Picard(order=order).solve(dtheta, 0.01, ONE)[1]
    np.testing.assert_allclose(solved, q / np.linalg.norm(q), rtol=0, atol=3e-16)
    left = np.linalg.norm(R, 2) ** (order + 1) / math.factorial(order + 1)
    assert 0.1 * left < np.linalg.norm(solved - expm(R) @ ONE) < 1.5 * left


@pytest.mark.parametrize("solver", SOLVERS, ids=str)
def test_drift_on_coning_falls_with_the_declared_order(solver):
    # 5 degrees, 4 turns, 16 to 48 updates a turn: errors of 1e-3 to 1e-8 rad.
    motion, updates, errors = Coning(5 * DEG, 2 * np.pi), np.array([16, 24, 32, 48]), []
    for u in updates:
        rate = float(u * solver.samples)
        n = int(4 * rate)
        times = np.arange(0, n + 1, solver.samples) / rate
        truth = motion.kinematics(times).q_ib
        vector = rotvec_from_quat(
            quat_multiply(solver.solve(motion.increments(rate, n), 1 / rate, truth[0]), quat_conjugate(truth))
        )
        trend = times[:, None] / times[-1] * vector[-1]
        errors.append([np.abs(vector - trend).max(), np.linalg.norm(vector[-1])])
    slopes = -np.polyfit(np.log(updates), np.log(errors), 1)[0]
    np.testing.assert_allclose(slopes, [solver.order_periodic, solver.order_drift], rtol=0, atol=0.2)


@pytest.mark.parametrize("solver", SOLVERS, ids=str)
@pytest.mark.parametrize("chunk", [1, 5, 1000])
def test_any_chunking_gives_the_same_bits(solver, chunk):
    increments = np.random.default_rng(2).normal(scale=1e-2, size=(240, 3))
    whole = solver.solve(increments, 0.01, ONE, chunk=10**6)
    np.testing.assert_array_equal(solver.solve(increments, 0.01, ONE, chunk=chunk), whole)


def test_the_matrix_stays_orthonormal_if_asked():
    increments = np.random.default_rng(3).normal(scale=0.1, size=(400, 3))
    found = []
    for orthonormalise in (True, False):
        solver = RungeKuttaDcm(2, orthonormalise=orthonormalise)
        state, q = solver.advance(solver.start(0.01, ONE), increments)
        C = state.carry.reshape(3, 3)
        found.append(np.abs(C @ C.T - np.eye(3)).max())
        np.testing.assert_allclose(np.linalg.norm(q, axis=1), 1, rtol=0, atol=1e-15)
    # About 0.3 rad an update: 1e-4 or so is lost in each, or its square.
    assert found[0] < 1e-5
    assert found[1] > 1e-3


@pytest.mark.parametrize("solver", SOLVERS, ids=str)
@pytest.mark.parametrize("size", [1e70, 1e155, 1e300])
def test_an_overflow_is_an_error_not_a_nan(solver, size):
    increments = np.full((24, 3), size)
    increments[::2] *= -1
    try:
        q = solver.solve(increments, 0.01, ONE)
    except AccuracyError as found:
        assert solver.name in str(found)  # noqa: PT017
    else:
        np.testing.assert_allclose(np.linalg.norm(q, axis=1), 1, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: RungeKuttaQuaternion(0), "samples must be an integer >= 1, got 0"),
        (lambda: RungeKuttaDcm(9), "samples must be an integer from 1 to 8, got 9"),
        (lambda: RungeKuttaDcm(2, orthonormalise=None), "orthonormalise must be True or False, got None"),
        (lambda: Picard(2), "samples must be an integer from 1 to 1, got 2"),
        (lambda: Picard(order=0), "order must be an integer >= 1, got 0"),
        (lambda: Picard(order=5), "order must be an integer from 1 to 4, got 5"),
    ],
)
def test_bad_options_are_named(make, message):
    with pytest.raises(InputError, match=message):
        make()
