"""The damping filters against textbook matrices: plain Kalman filters with Van Loan's discretisation and inverses.

Nothing of the code under test is in the reference but F itself, which has its own test.
"""

import math
from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad_vec
from scipy.linalg import expm

import bench
from bench.error_simulation import reference_velocity
from bench.solvers.damping import DampingModel, error_states
from bench.solvers.damping.error_model import error_matrix
from tests.damping_cases import KNOWN, NAMES, plain_filter, ship

ROWS = 181
HARD = DampingModel(tau_f=200.0, tau_g=100.0, velocity_noise=1e-3, attitude_noise=1e-5, gyro_drift=1e-6)


@cache
def expected(model, options):
    """Return the plain filters' result, computed once."""
    ins, v_ref = inputs()
    return plain_filter(ins, v_ref, model, **dict(options))


@cache
def inputs():
    ins = ship(ROWS - 1, turn=0.3, sway=0.1)
    return ins, reference_velocity(ins, error=(-0.3, -0.2), noise=0.05, seed=3)


@pytest.fixture(scope="module", params=[KNOWN, HARD], ids=["published", "hard"])
def case(request):
    return request.param, *inputs()


def agree(x, sigma, x_expected, P):
    """Within 1e-6 of the standard deviations, and those to 1e-4: the series and Simpson's rule at 1 s."""
    std = np.sqrt(np.diagonal(P, axis1=1, axis2=2))
    np.testing.assert_allclose(sigma, std, rtol=1e-4)
    np.testing.assert_allclose(x / std, x_expected / std, rtol=0, atol=1e-4)


def test_filter_1(case):
    model, ins, v_ref = case
    solution = bench.solver("damping", "velocity-error", model=model, covariance_every=50).solve(ins, v_ref)
    (x, P), _ = expected(model, (("T", 5),))
    agree(solution.x, solution.sigma, x, P)
    std = np.sqrt(np.diagonal(P, axis1=1, axis2=2))[::50]
    correlation = P[::50] / std[:, :, None] / std[:, None]
    np.testing.assert_allclose(solution.covariance / std[:, :, None] / std[:, None], correlation, rtol=0, atol=1e-4)


def test_filter_2_behind_filter_1(case):
    model, ins, v_ref = case
    solution = bench.solver("damping", "velocity-change", model=model).solve(ins, v_ref)
    first, second = expected(model, (("T", 5),))
    agree(solution.x, solution.sigma, *second)
    agree(solution.parts[0].x, solution.parts[0].sigma, *first)
    assert np.flatnonzero(solution.used).tolist() == list(range(5, ROWS, 5))


def test_r2_read_as_a_velocity(case):
    model, ins, v_ref = case
    options = {"interval": 3.0, "change_noise": 0.002, "r2_reading": "velocity"}
    solution = bench.solver("damping", "velocity-change", model=model, **options).solve(ins, v_ref)
    _, second = expected(model, (("T", 3), ("r2", 2 * 0.002**2 / 9)))
    agree(solution.x, solution.sigma, *second)


def test_15_states(case):
    model, ins, v_ref = case
    solution = bench.solver("damping", "bias-augmented", model=model, reference_bias=0.4).solve(ins, v_ref)
    (x, P), _ = expected(model, (("augmented", 0.4),))
    agree(solution.x, solution.sigma, x, P)


@pytest.mark.parametrize("mean", ["cumulative", "window"])
def test_fusion(case, mean):
    model, ins, v_ref = case
    options = {"gamma_start": 60.0, "gamma_delay": 60.0, "gamma_rate": 0.05, "mean": mean, "window": 40.0}
    solution = bench.solver("damping", "double-filter", model=model, **options).solve(ins, v_ref)
    (x1, P1), (x2, P2) = expected(model, (("T", 5),))
    p1, p2 = (np.diagonal(P, axis1=1, axis2=2) for P in (P1, P2))
    x, sigma, share = (np.empty_like(x1) for _ in range(3))
    for k in range(ROWS):
        rows = slice(0 if mean == "cumulative" else max(0, k - 39), k + 1)
        Xbar = (x1[rows] - x2[rows]).mean(axis=0)
        gamma = 1 / (1 + math.exp(-0.05 * (k - 120)))
        first = np.linalg.inv(np.diag(p1[k] + gamma * Xbar**2))
        second = np.linalg.inv(np.diag(p2[k]))
        P_g = np.linalg.inv(first + second)
        x[k], sigma[k] = P_g @ (first @ x1[k] + second @ x2[k]), np.sqrt(np.diag(P_g))
        share[k] = np.diag(P_g @ first)
        assert solution.gamma[k] == pytest.approx(gamma, rel=1e-12)
    agree(solution.x, solution.sigma, x, sigma[:, :, None] ** 2 * np.eye(13))
    np.testing.assert_allclose(solution.weight, share, rtol=1e-3)


def test_the_measurement_matrix_of_filter_2_is_the_published_integral():
    """(1/T) int F_(1:2) Phi(t, t2) dt by quadrature; it keeps the latitude's column and has none for the longitude."""
    ins, T = ship(10), 5.0
    F = error_matrix(ins.v_n[:1], ins.latitude[:1], ins.q_nb[:1], ins.f_n[1:2], tau_f=3600.0, tau_g=3600.0)[0]
    integral = quad_vec(lambda t: F[:2] @ expm(F * (t - T)), 0.0, T, epsabs=0, epsrel=1e-13)[0] / T
    closed = (np.eye(13) - np.linalg.inv(expm(F * T)))[:2] / T
    np.testing.assert_allclose(closed, integral, rtol=1e-6, atol=1e-16 / T)
    assert (closed[:, 3] == 0).all()
    assert abs(closed[1, 2]) > 1e-6


def test_nis_and_innovation_are_those_of_the_textbook(case):
    model, ins, v_ref = case
    solution = bench.solver("damping", "velocity-error", model=model).solve(ins, v_ref)
    std = model.initial_std
    S = std[0] ** 2 + model.reference_noise**2
    z = ins.v_n[0, :2] - v_ref[0]
    np.testing.assert_allclose(solution.innovation[0], z, rtol=1e-14)
    assert solution.nis[0] == pytest.approx((z @ z) / S, rel=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_the_corrected_trajectory_has_the_estimated_errors_taken_out(name):
    from bench.error_simulation import disturbed

    truth = ship(200, sway=0.1)
    x = np.tile([0.3, -0.2, 1e-5, -2e-5, 2e-4, -1e-4, 2e-3] + [0.0] * 6, (len(truth), 1))
    ins = disturbed(truth, x)
    solution = bench.solver("damping", name).solve(ins, truth.v_n[:, :2])
    remaining = error_states(solution.corrected(ins), truth.trajectory())
    # The errors that remain are those of the estimate, but for products of angles of 2e-3 rad.
    tolerance = np.array([1e-12] * 2 + [1e-9] * 2 + [4e-6] * 3)
    assert (np.abs(remaining - (x - solution.x[:, :13])[:, :7]) < tolerance).all()
    np.testing.assert_allclose(error_states(ins, truth.trajectory()), x[:, :7], rtol=1e-9, atol=1e-15)
