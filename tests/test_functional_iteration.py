"""Functional iteration: its fit, its series, that the three forms agree, where they converge, what it warns of.

Truth: printed rationals and NumPy's polynomials for the fit, mpmath's Taylor series for the attitude of a fitted
rate, SciPy's Rotation at a constant rate, the closed form of coning.
"""

import math
import warnings

import mpmath
import numpy as np
import pytest
from numpy.polynomial import chebyshev
from scipy.spatial.transform import Rotation

import bench
from bench.motion.coning import Coning
from bench.solvers.attitude._chebyshev import BORTZ_TERMS, bortz_series, rate_fit
from tests.attitude_cases import swinging

IDENTITY = [1.0, 0.0, 0.0, 0.0]
FORMS = ["quaternion", "rodrigues", "rotation-vector"]


def iteration(form="quaternion", samples=8, **options):
    return bench.solver("attitude", "functional-iteration", samples=samples, form=form, **options)


def angle(q, rotation):
    return (Rotation.from_quat(q, scalar_first=True) * rotation.inv()).magnitude()


@pytest.mark.parametrize("N", range(1, 9))
def test_the_fitted_rate_reproduces_the_increments(N):
    series = rate_fit(N) * np.where(np.arange(N) == 0, 1, 2)[:, None]  # full coefficients, a column an increment
    ends = -1 + 2 * np.arange(N + 1) / N
    angles = chebyshev.chebval(ends, chebyshev.chebint(series, lbnd=-1)).T
    # Coefficients of up to 200 are rounded once.
    np.testing.assert_allclose(np.diff(angles, axis=0), np.eye(N), rtol=0, atol=2e-13)


def test_the_fit_of_two_increments_is_a_straight_line():
    # w = (T/2) omega: (d1 + d2)/2 in the mean, and 2 (d2 - d1) x/2 of slope, kept as its half.
    np.testing.assert_array_equal(rate_fit(2), [[0.5, 0.5], [-0.5, 0.5]])


def test_the_series_of_bortz_against_mpmath():
    series = bortz_series()
    np.testing.assert_allclose(series[:4], [1 / 12, 1 / 720, 1 / 30240, 1 / 1209600], rtol=1e-15)
    assert len(series) == BORTZ_TERMS
    for x in (0.1, 1.0, 3.0):
        with mpmath.workdps(40):
            y = mpmath.mpf(x)
            expected = float((1 - y / 2 * mpmath.cot(y / 2)) / y**2)
        np.testing.assert_allclose(np.polynomial.polynomial.polyval(x * x, series), expected, rtol=1e-15)


def exact_turn(dtheta):
    """Return the attitude after one update of the polynomial rate through the increments, by mpmath, wxyz."""
    N = len(dtheta)
    with mpmath.workdps(120):  # the terms rise to 1e40 before they fall
        total, rows, right = [mpmath.mpf(0)] * 3, [], []
        for k in range(N):  # sum of a_m k^(m+1)/(m+1) = S_k, k = 1..N
            total = [s + mpmath.mpf(float(d)) for s, d in zip(total, dtheta[k], strict=True)]
            rows.append([mpmath.mpf(k + 1) ** (m + 1) / (m + 1) for m in range(N)])
            right.append(total)
        a = [mpmath.lu_solve(mpmath.matrix(rows), mpmath.matrix([sums[c] for sums in right])) for c in range(3)]
        w = [[a[c][m] * mpmath.mpf(N) ** (m + 1) for c in range(3)] for m in range(N)]
        q = [[mpmath.mpf(1), mpmath.mpf(0), mpmath.mpf(0), mpmath.mpf(0)]]
        for k in range(600):
            new = [mpmath.mpf(0)] * 4
            for m in range(min(k, N - 1) + 1):
                s, x, y, z = q[k - m]
                a1, b1, c1 = w[m]
                turned = (-x * a1 - y * b1 - z * c1, s * a1 + y * c1 - z * b1, s * b1 + z * a1 - x * c1)
                turned = (*turned, s * c1 + x * b1 - y * a1)
                new = [n + t for n, t in zip(new, turned, strict=True)]
            q.append([n / (2 * (k + 1)) for n in new])
        assert max(abs(part) for part in q[-1]) < 1e-30
        return np.array([float(sum(row[i] for row in q)) for i in range(4)])


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("N", [1, 2, 3, 5, 8])
def test_an_update_is_the_exact_attitude_of_the_fitted_rate(N, form):
    rng = np.random.default_rng(N)
    for turned in (1e-5, 0.1, 0.8):  # rad an update, about; with noise, so that all coefficients of the fit matter
        dtheta = turned / N * (np.array([0.5, -0.3, 0.6]) + 0.0003 * rng.normal(size=(N, 3)))
        q = iteration(form, N).solve(dtheta, 0.01, IDENTITY)[1]
        np.testing.assert_allclose(q, exact_turn(dtheta), rtol=0, atol=1e-15)


@pytest.mark.parametrize("N", range(1, 9))
def test_the_three_forms_agree_for_the_same_fit(N):
    dtheta = swinging(8 * 105, seed=N)
    by_quaternion = Rotation.from_quat(iteration("quaternion", N).solve(dtheta, 0.01, IDENTITY), scalar_first=True)
    for form in FORMS[1:]:
        q = iteration(form, N).solve(dtheta, 0.01, IDENTITY)
        assert angle(q, by_quaternion).max() < 3e-15 * math.sqrt(len(q)), form  # a random walk of roundings


@pytest.mark.parametrize(("form", "turns"), [("quaternion", 17.9), ("rodrigues", 3.0), ("rotation-vector", 1.99)])
def test_it_converges_up_to_the_stated_angle(form, turns):
    for S in np.linspace(0.05, turns, 30):
        phi = S * np.array([0.6, 0.0, 0.8])
        q = iteration(form, 4).solve(np.tile(phi / 4, (4, 1)), 0.01, IDENTITY)[1]
        # Roundings: e^(S/2) in the sum of the quaternion, and those of the Rodrigues vector by its slope.
        slope = 1 / math.cos(S / 2) ** 2 if form == "rodrigues" else 1
        assert angle(q, Rotation.from_rotvec(phi)) < 5e-16 * (1 + slope + math.exp(S / 2)), S


@pytest.mark.parametrize(
    ("form", "S", "message"),
    [
        ("rodrigues", 3.12, "'rodrigues' does not converge to rounding: .* S = .* = 3.12 rad"),
        ("rodrigues", math.pi, "'rodrigues' needs S < 3.14159 rad in every update, but .* = 3.14159 rad"),
        ("rodrigues", 3.2, "'rodrigues' needs S < 3.14159 rad in every update, but .* = 3.2 rad"),
        ("rotation-vector", 2.0, "'rotation-vector' needs S < 2 rad in every update, but .* = 2 rad"),
        ("quaternion", 18.5, "'quaternion' needs S < 18 rad in every update, but .* = 18.5 rad"),
    ],
)
def test_an_update_that_turns_too_far_is_an_error(form, S, message):
    dtheta = np.tile(S / 4 * np.array([0.0, 1.0, 0.0]), (4, 1))
    gentle = swinging(400)
    for stream in (dtheta, np.concatenate([gentle, dtheta, gentle])):
        with pytest.raises(bench.AccuracyError, match=f"functional-iteration in the form {message}"):
            iteration(form, 4).solve(stream, 0.01, IDENTITY)


def test_coning_of_90_degrees():
    coning = Coning(math.pi / 2, 4 * math.pi)
    truth = coning.kinematics(np.arange(26) * 0.04).q_ib
    q = iteration(samples=4).solve(coning.increments(100.0, 100), 0.01, truth[0])
    error = angle(q, Rotation.from_quat(truth, scalar_first=True)).max()
    # The limit of the fit, which other implementations of it have too: 5e-7 rad.
    assert 4e-7 < error < 6e-7


@pytest.mark.parametrize("form", FORMS)
def test_fixed_iterations_approach_the_converged_attitude(form):
    dtheta = swinging(16)
    converged = Rotation.from_quat(iteration(form).solve(dtheta, 0.01, IDENTITY), scalar_first=True)
    errors = []
    for iterations in range(1, 14):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", bench.errors.BenchWarning)
            q = iteration(form, iterations=iterations).solve(dtheta, 0.01, IDENTITY)
        errors.append(angle(q, converged).max())
    assert errors[0] > 1e-4
    assert errors[-1] < 1e-15
    falling = np.array(errors)[: int(np.argmax(np.array(errors) < 1e-14)) + 1]
    assert (falling[2:] < 0.2 * falling[:-2]).all()  # S = 0.4 rad: every two at least that


@pytest.mark.parametrize("form", FORMS)
def test_too_few_iterations_are_warned_of_with_the_error(form):
    dtheta = swinging(80)
    converged = Rotation.from_quat(iteration(form).solve(dtheta, 0.01, IDENTITY), scalar_first=True)
    message = "iterations = 4 is too few .* still changes an update by"
    with pytest.warns(bench.errors.BenchWarning, match=message) as caught:
        q = iteration(form, iterations=4).solve(dtheta, 0.01, IDENTITY, chunk=8)
    assert len(caught) == 1
    stated = float(str(caught[0].message).partition("update by ")[2].split()[0])
    first = angle(q[1], converged[1])  # the error of an update, which the last change exceeds by about 2 n/S = 40
    assert first < stated < 1e3 * first


def test_no_fixed_iterations_no_order():
    assert iteration(iterations=5).order_periodic is None
    assert iteration(iterations=5).order_drift is None


@pytest.mark.parametrize("iterations", [0, -1, 2.5, "many"])
def test_wrong_iterations_are_named(iterations):
    with pytest.raises(bench.InputError, match="iterations must be an integer >= 1, got"):
        iteration(iterations=iterations)
