"""Rotation vector and hybrid: values, drift on coning, limits.

Truth: mpmath at 30 digits for single updates; the closed form of coning (`bench.motion.coning`, tested by itself);
the theoretical residual of the coning-optimised sets.
"""

import itertools
import math

import mpmath
import numpy as np
import pytest

import bench
from bench.errors import AccuracyError, InputError, UnknownNameError
from bench.motion.coning import Coning
from bench.rotation import quat_conjugate, quat_multiply, rotvec_from_quat
from bench.solvers.attitude._coefficients import SETS, coning_optimised, coning_residual
from bench.units import DEG

SAMPLES = range(1, 9)
IDENTITY = [1.0, 0.0, 0.0, 0.0]


def make(name, samples, **options):
    return bench.solver("attitude", name, samples=samples, **options)


ALL = [("rotation-vector", {"coefficients": name}) for name in SETS] + [("hybrid", {})]


def increments(n, size=0.02, seed=5):
    return np.random.default_rng(seed).normal(scale=size, size=(n, 3))


def error(q, truth):
    """Rotation vector, in the outer frame, that takes the truth to q."""
    return rotvec_from_quat(quat_multiply(q, quat_conjugate(truth)))


def mp_cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def mp_multiply(p, q):
    v = mp_cross(p[1:], q[1:])
    w = p[0] * q[0] - sum(a * b for a, b in zip(p[1:], q[1:], strict=True))
    return [w] + [p[0] * q[1 + i] + q[0] * p[1 + i] + v[i] for i in range(3)]


def mp_turn(phi):
    angle = mpmath.sqrt(sum(c * c for c in phi))
    return [mpmath.cos(angle / 2)] + [mpmath.sin(angle / 2) / angle * c for c in phi]


def mp_products(K, d):
    """Sum of K_ij d_i x d_j over i < j, written out."""
    total = [mpmath.mpf(0)] * 3
    for i, j in itertools.combinations(range(len(d)), 2):
        k = mpmath.mpf(K[i][j].numerator) / K[i][j].denominator
        total = [t + k * c for t, c in zip(total, mp_cross(d[i], d[j]), strict=True)]
    return total


def mp_polynomial_turn(d):
    """Attitude of the polynomial rate through the increments d, by 30-digit integration of q' = q o omega/2."""
    N = len(d)
    # The rate's coefficients from the increments: int_{i-1}^i sum_m c_m tau^m = d_i, a linear system.
    V = mpmath.matrix(N, N)
    for i, m in itertools.product(range(N), range(N)):
        V[i, m] = (mpmath.mpf(i + 1) ** (m + 1) - mpmath.mpf(i) ** (m + 1)) / (m + 1)
    c = [list(mpmath.lu_solve(V, mpmath.matrix([row[axis] for row in d]))) for axis in range(3)]

    def rate(t, q):
        return mp_multiply(q, [0] + [sum(k * t**m for m, k in enumerate(row)) / 2 for row in c])

    return mpmath.odefun(rate, 0, [mpmath.mpf(1), 0, 0, 0])(N)


@pytest.mark.parametrize("coefficients", SETS)
@pytest.mark.parametrize("N", SAMPLES)
def test_updates_against_mpmath(N, coefficients):
    dtheta = increments(4 * N)
    q = make("rotation-vector", N, coefficients=coefficients).solve(dtheta, 0.01, IDENTITY)
    with mpmath.workdps(30):
        truth = [mpmath.mpf(c) for c in IDENTITY]
        for k in range(4):
            d = [[mpmath.mpf(c) for c in row] for row in dtheta[k * N : (k + 1) * N]]
            phi = [sum(c) + p for c, p in zip(zip(*d, strict=True), mp_products(SETS[coefficients](N), d), strict=True)]
            truth = mp_multiply(truth, mp_turn(phi))
            # A handful of roundings an update.
            np.testing.assert_allclose(q[k + 1], [float(c) for c in truth], rtol=0, atol=1e-15)


@pytest.mark.parametrize("N", [1, 3, 5])
def test_hybrid_updates_against_mpmath(N):
    # Two updates of unequal increments, 0.1 rad each: every order counts.
    dtheta = increments(2 * N, size=0.1)
    q = make("hybrid", N).solve(dtheta, 0.01, IDENTITY)
    with mpmath.workdps(30):
        truth = [mpmath.mpf(c) for c in IDENTITY]
        for k in range(2):
            d = [[mpmath.mpf(c) for c in row] for row in dtheta[k * N : (k + 1) * N]]
            p = mp_polynomial_turn(d)
            sine = mpmath.sqrt(sum(c * c for c in p[1:]))
            phi = [2 * mpmath.atan2(sine, p[0]) / sine * c for c in p[1:]]
            added, removed = (mp_products(SETS[name](N), d) for name in ("coning-manoeuvre-exact", "polynomial"))
            phi = [c + a - r for c, a, r in zip(phi, added, removed, strict=True)]
            truth = mp_multiply(truth, mp_turn(phi))
            # A few roundings for each of the N series and products.
            np.testing.assert_allclose(q[k + 1], [float(c) for c in truth], rtol=0, atol=3e-15)


@pytest.mark.parametrize("N", [1, 2])
def test_three_sets_are_one_for_one_and_two_samples(N):
    dtheta = increments(100 * N)
    one, two, three = (make("rotation-vector", N, coefficients=name).solve(dtheta, 0.01, IDENTITY) for name in SETS)
    np.testing.assert_array_equal(one, two)
    np.testing.assert_array_equal(one, three)


def test_three_sets_are_three_from_there():
    dtheta = increments(300, size=0.1)
    ends = [make("rotation-vector", 3, coefficients=name).solve(dtheta, 0.01, IDENTITY)[-1] for name in SETS]
    for a, b in itertools.combinations(ends, 2):
        assert np.linalg.norm(error(a, b)) > 1e-4  # rad


def drift(solver, cone, rate, updates):
    """Mean turn per update about the axis of the cone, rad, from whole periods."""
    N = solver.samples
    times = np.array([0.0, N * updates / rate])
    truth = cone.kinematics(times).q_ib
    q = solver.solve(cone.increments(rate, N * updates), 1 / rate, truth[0])
    return error(q[-1], truth[-1])[2] / updates


@pytest.mark.parametrize("coefficients", ["coning-optimised", "coning-manoeuvre-exact"])
@pytest.mark.parametrize("N", SAMPLES)
def test_drift_on_small_coning_is_the_theoretical_residual(N, coefficients):
    # Half angle 0.01 degrees: what theory leaves out (a^4) is 1e-8 of the drift's scale a^2. The phase per sample
    # lets the drift of every N stand out from the roundings, 1e-17 rad an update, a thousand times.
    half_angle, lam = 0.01 * DEG, 0.3 if N <= 3 else 0.25 * N - 0.3
    per_turn = round(2 * math.pi * 20 / lam)  # samples in 20 turns of the cone; then N * updates make whole turns
    lam = 2 * math.pi * 20 / per_turn
    cone = Coning(half_angle=half_angle, angular_frequency=100 * lam)
    found = drift(make("rotation-vector", N, coefficients=coefficients), cone, 100.0, 20 * per_turn)
    theory = float(coning_residual(coning_optimised(N), lam, half_angle))
    assert abs(theory) > 1e-14
    np.testing.assert_allclose(found, theory, rtol=0.03)


@pytest.mark.parametrize("N", SAMPLES)
def test_drift_of_the_polynomial_set_follows_the_same_theory(N):
    half_angle, lam = 0.01 * DEG, 2 * math.pi / 16
    cone = Coning(half_angle=half_angle, angular_frequency=100 * lam)
    found = drift(make("rotation-vector", N, coefficients="polynomial"), cone, 100.0, 3200)
    theory = float(coning_residual(SETS["polynomial"](N), lam, half_angle))
    np.testing.assert_allclose(found, theory, rtol=0.03)


def test_leading_term_is_enough_for_slow_coning():
    # N = 3 at lambda = 0.1: a^2 lambda^7 3 3!/(2^4 1 3 5 7), to 1 %.
    half_angle, lam = 0.05 * DEG, 0.1
    np.testing.assert_allclose(
        coning_residual(coning_optimised(3), lam, half_angle), half_angle**2 * lam**7 * 18 / (16 * 105), rtol=0.01
    )


@pytest.mark.parametrize("N", range(3, 9))
def test_hybrid_leaves_both_parents_behind(N):
    # 10 degrees, 1 Hz, 100 Hz, 6 s: large enough for the third order, fast enough for the coning residual.
    cone = Coning(half_angle=10 * DEG, angular_frequency=2 * math.pi)
    n = 600 // N * N
    t = np.arange(n // N + 1) * N / 100
    truth = cone.kinematics(t).q_ib

    def largest(solver):
        return np.linalg.norm(error(solver.solve(cone.increments(100.0, n), 0.01, truth[0]), truth), axis=1).max()

    parents = [largest(make("rotation-vector", N, coefficients=name)) for name in SETS]
    assert largest(make("hybrid", N)) < min(parents) / (1.5 if N == 3 else 50)


@pytest.mark.parametrize(("name", "options"), ALL)
def test_large_angles_and_rest(name, options):
    # A constant rate of 5 rad an update: all products vanish, and the exponential must be the long one.
    solver = make(name, 3, **options)
    turn = np.array([3.0, -4.0, 0.0]) / 3
    q = solver.solve(np.tile(turn, (3, 1)), 0.01, IDENTITY)
    np.testing.assert_allclose(q[1], [math.cos(2.5), 0.6 * math.sin(2.5), -0.8 * math.sin(2.5), 0], rtol=0, atol=3e-15)
    np.testing.assert_array_equal(solver.solve(np.zeros((30, 3)), 0.01, IDENTITY), np.tile(IDENTITY, (11, 1)))


@pytest.mark.parametrize(("name", "options"), ALL)
@pytest.mark.parametrize("N", [1, 3, 8])
def test_any_chunking_gives_the_same_bits(name, options, N):
    solver = make(name, N, **options)
    dtheta = increments(130 * N)  # more than two blocks of the kernel
    whole = solver.solve(dtheta, 0.01, IDENTITY)
    for chunk in (1, 7, 129 * N):
        np.testing.assert_array_equal(solver.solve(dtheta, 0.01, IDENTITY, chunk=chunk), whole)
    state, rows = solver.start(0.01, IDENTITY), []
    for piece in np.array_split(dtheta, 11):
        state, q = solver.advance(state, piece)
        rows.append(q)
    np.testing.assert_array_equal(np.concatenate([*rows, solver.finish(state)]), whole[1:])


def test_a_slightly_wrong_norm_of_q0_is_mended():
    q0 = np.array([0.6, 0.0, 0.8, 0.0]) * (1 + 9e-10)
    q = make("rotation-vector", 3).solve(increments(30), 0.01, q0)
    np.testing.assert_allclose(np.linalg.norm(q[1:], axis=1), 1.0, rtol=0, atol=1e-15)


def test_norm_stays_one_over_a_long_run():
    q = make("rotation-vector", 1).solve(increments(100_000, size=0.3), 0.01, IDENTITY)
    np.testing.assert_allclose(np.linalg.norm(q, axis=1), 1.0, rtol=0, atol=1e-15)


@pytest.mark.parametrize(("name", "options"), ALL)
def test_nonsense_is_refused(name, options):
    for samples in (0, 9, 2.5):
        with pytest.raises(InputError, match=rf"samples.*{samples}"):
            make(name, samples, **options)
    solver = make(name, 4, **options)
    with pytest.raises(InputError, match="multiple of samples = 4 increments, got 10"):
        solver.solve(np.zeros((10, 3)), 0.01, IDENTITY)
    for wrong in (np.nan, np.inf):
        dtheta = np.zeros((40_000, 3))
        dtheta[30_001, 2] = wrong
        with pytest.raises(InputError, match=rf"dtheta_b must be finite, got {wrong} at \[30001, 2\]"):
            solver.solve(dtheta, 0.01, IDENTITY)
    huge = np.concatenate([np.zeros((4, 3)), [[1e200], [-1e200], [1e200], [1e200]] * np.ones(3)])
    # NumPy would warn of the overflow where the kernels are not compiled.
    with np.errstate(all="ignore"), pytest.raises(AccuracyError, match="update 1: the increments are too large"):
        solver.solve(huge, 0.01, IDENTITY)


def test_unknown_coefficients_are_refused_with_the_choices():
    with pytest.raises(UnknownNameError, match=r"coefficients 'coning'.*coning-manoeuvre-exact.*polynomial"):
        make("rotation-vector", 3, coefficients="coning")


def test_hybrid_refuses_rates_whose_series_loses_its_digits():
    dtheta = np.tile([0.0, 0.0, 40.0], (3, 1))
    with pytest.raises(AccuracyError, match="hybrid diverges at update 0"):
        make("hybrid", 3).solve(dtheta, 0.01, IDENTITY)
