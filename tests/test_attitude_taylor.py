"""The rate fit and the Taylor solvers: quaternion, DCM and windowed.

Truth: polynomials in exact fractions; mpmath's odefun at 22 digits; the closed form of coning; `BodyRate`, itself
tested against mpmath; the end attitude printed in the paper.
"""

import dataclasses
import warnings
from fractions import Fraction

import mpmath
import numpy as np
import pytest

import bench
from bench.errors import AccuracyError, BenchWarning, InputError
from bench.motion.body_rate import BodyRate
from bench.motion.coning import Coning
from bench.rotation import euler_from_quat, quat_conjugate, quat_multiply, rotvec_from_quat
from bench.solvers.attitude._rate_fit import (
    difference_tables,
    rate_fractions,
    rate_matrix,
    runge_kutta_rates,
)
from bench.solvers.attitude.taylor_dcm import TaylorDcm
from bench.solvers.attitude.taylor_quaternion import TaylorQuaternion
from bench.solvers.attitude.windowed_taylor import WindowedTaylor
from bench.units import DEG

ARCSEC = DEG / 3600
ONE = [1.0, 0, 0, 0]


def error(q, truth):
    """Angle between attitudes, rad."""
    return np.linalg.norm(rotvec_from_quat(quat_multiply(q, quat_conjugate(truth))), axis=-1)


def coning_error(solver, half_angle_deg, hertz, seconds, rate=100):
    motion = Coning(half_angle_deg * DEG, 2 * np.pi * hertz)
    n = round(seconds * rate) // solver.samples * solver.samples
    q = solver.solve(motion.increments(rate, n), 1 / rate, motion.kinematics(np.zeros(1)).q_ib[0])
    return error(q, motion.kinematics(np.arange(0, n + 1, solver.samples) / rate).q_ib)


def quantised(increments, quantum=ARCSEC):
    """A pulse counter that carries its residue."""
    counts = np.rint(np.cumsum(increments, axis=0) / quantum)
    return quantum * np.diff(counts, axis=0, prepend=0.0)


def polynomial_motion(degree, seed=1, span=2.0):
    """A polynomial rate of some rad/s, its exact integral over intervals, and its attitude."""
    c = np.random.default_rng(seed).normal(scale=1.5, size=(degree + 1, 3))
    integral = np.concatenate([np.zeros((1, 3)), c / np.arange(1, degree + 2)[:, None]])
    motion = BodyRate(lambda t: np.polynomial.polynomial.polyval(t, c).T, (0.0, span))

    def increments(n):
        return np.diff(np.polynomial.polynomial.polyval(np.linspace(0, span, n + 1), integral).T, axis=0)

    return c, increments, motion


# --- the fit ---------------------------------------------------------------------------------------------------------


def test_three_samples_have_the_printed_matrix():
    printed = [["11/6", "-7/6", "1/3"], ["-2", "3", "-1"], ["1/2", "-1", "1/2"]]  # in sample units
    scaled = [[Fraction(x) * 3 ** (m + 1) for x in row] for m, row in enumerate(printed)]
    assert [list(row) for row in rate_fractions(3)] == scaled
    np.testing.assert_array_equal(rate_matrix(3), np.array(scaled, dtype=float))


@pytest.mark.parametrize(("samples", "window", "offset"), [(1, 1, 0), (3, 3, 0), (8, 8, 0), (4, 12, 4), (2, 7, 5)])
def test_the_fit_reproduces_polynomials_exactly(samples, window, offset):
    # The rate sum_m c_m u^m, u from the start of the update in updates, has increments in closed form.
    c = [Fraction(3 * m - 4, m + 2) for m in range(window)]

    def integral(i):
        u = Fraction(i - offset, samples)
        return sum(x * u ** (m + 1) / (m + 1) for m, x in enumerate(c))

    increments = [integral(i + 1) - integral(i) for i in range(window)]
    fitted = [
        sum(a * b for a, b in zip(row, increments, strict=True)) for row in rate_fractions(samples, window, offset)
    ]
    assert fitted == c


@pytest.mark.parametrize(("samples", "window", "offset"), [(3, 3, 0), (4, 12, 8), (2, 9, 3)])
def test_differences_give_the_same_fit(samples, window, offset):
    dtheta = np.random.default_rng(0).normal(size=window)
    differences = [np.diff(dtheta, j)[0] for j in range(window)]
    w = rate_matrix(samples, window, offset) @ dtheta
    plain, centred = (difference_tables(samples, window, centred=c) for c in (False, True))
    tolerance = 1e-12 * np.abs(rate_matrix(samples, window, offset)).max()
    np.testing.assert_allclose(plain[offset] @ differences, w, rtol=0, atol=tolerance)
    # The same rate at points of the update, from its start and from its middle.
    for u in (0.0, 0.3, 1.0):
        rate = np.polynomial.polynomial.polyval(u, w)
        half = np.polynomial.polynomial.polyval(2 * u - 1, centred[offset] @ differences)
        np.testing.assert_allclose(2 * half, rate, rtol=0, atol=tolerance)
    assert np.array_equal(plain, np.triu(plain))


def test_the_matrices_are_the_callers_own():
    rate_matrix(3)[0, 0] = 7.0
    difference_tables(3)[0, 0, 0] = 7.0
    assert rate_matrix(3)[0, 0] == 5.5
    assert difference_tables(3)[0, 0, 0] == 3.0


def test_runge_kutta_takes_the_classical_two_sample_rates():
    np.testing.assert_array_equal(runge_kutta_rates(2), [[3, -1], [1, 1], [-1, 3]])
    np.testing.assert_array_equal(runge_kutta_rates(1), np.ones((3, 1)))


# --- the series ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("samples", [3, 6])
def test_one_update_solves_the_fitted_polynomial(samples):
    c, increments, _ = polynomial_motion(samples - 1, seed=samples, span=1.0)

    def slope(t, y):
        x = [sum(mpmath.mpf(v) * t**m for m, v in enumerate(column)) / 2 for column in c.T]
        return [
            -y[1] * x[0] - y[2] * x[1] - y[3] * x[2],
            y[0] * x[0] + y[2] * x[2] - y[3] * x[1],
            y[0] * x[1] - y[1] * x[2] + y[3] * x[0],
            y[0] * x[2] + y[1] * x[1] - y[2] * x[0],
        ]

    with mpmath.workdps(22):
        truth = np.array([float(v) for v in mpmath.odefun(slope, 0, [1, 0, 0, 0])(1)])
    # Each update turns by some rad; the terms of the series are larger than one and cancel in part.
    for solver in (TaylorQuaternion(samples), TaylorDcm(samples), WindowedTaylor(samples, samples)):
        assert error(solver.solve(increments(samples), 1 / samples, ONE)[1], truth) < 1e-13


def manoeuvre():
    """Savage's large-angle manoeuvre: integrated rate and rate."""
    c = np.array(
        [[0, -1.1, 0.45, -0.6, 1.1, -0.1], [0, -0.5, 1.0, -0.3, 0.7, -0.2], [0, 0.3, -1.2, 2.0, -0.9, 0.4]], dtype=float
    ).T
    sine, cosine, w = np.array([0.2, -0.5, 0.8]), np.array([0.3, 0.6, -0.9]), 2.6 * np.pi
    polynomial, derivative = np.polynomial.polynomial.polyval, np.polynomial.polynomial.polyder

    def alpha(t):
        t = np.asarray(t)
        return polynomial(t, c).T + np.sin(w * t)[:, None] * sine + (1 - np.cos(w * t))[:, None] * cosine

    def rate(t):
        t = np.asarray(t)
        return polynomial(t, derivative(c)).T + w * (np.cos(w * t)[:, None] * sine + np.sin(w * t)[:, None] * cosine)

    return alpha, rate


@pytest.mark.parametrize(
    "solver", [TaylorQuaternion(5), TaylorDcm(6), TaylorDcm(6, orthonormalise=False), WindowedTaylor(2, 8)]
)
def test_the_manoeuvre_ends_where_the_paper_says(solver):
    alpha, rate = manoeuvre()
    q = solver.solve(np.diff(alpha(np.arange(1201) / 1000), axis=0), 1e-3, ONE)
    psi, P, R = np.degrees(euler_from_quat(q[-1]))
    np.testing.assert_allclose(
        [P, R, psi], [31.53552599, -160.58123171, 13.32385593], rtol=0, atol=0.6e-8
    )  # as printed
    truth = BodyRate(rate, (0.0, 1.2)).kinematics(np.arange(0, 1201, solver.samples) / 1000).q_ib
    # The differences of alpha carry 2e-16 rad each, 1200 of them; the fit's own error at 1 kHz is below that.
    assert error(q, truth).max() < 2e-13


@pytest.mark.parametrize(
    "solver",
    [*map(TaylorQuaternion, range(1, 7)), TaylorDcm(3), TaylorDcm(5), TaylorDcm(4, terms=3), WindowedTaylor(4, 6)],
    ids=str,
)
def test_drift_on_wide_coning_falls_with_the_declared_order(solver):
    # 60 degrees, 4 turns, 12 to 32 updates a turn: errors of 1e-1 to 1e-12 rad, far above rounding.
    updates = np.array([12, 16, 24, 32])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", BenchWarning)  # the one with three terms
        errors = [coning_error(solver, 60, 1, 4, rate=u * solver.samples)[-1] for u in updates]
    slope = -np.polyfit(np.log(updates), np.log(errors), 1)[0]
    assert abs(slope - solver.order_drift) < 0.2


@pytest.mark.parametrize(
    ("solver", "case", "bound"),
    [
        (WindowedTaylor(4, 12), (90, 2, 1), 5e-14),
        (WindowedTaylor(2, 12), (90, 2, 1), 5e-14),
        (WindowedTaylor(4, 8), (90, 2, 1), 1e-11),
        (WindowedTaylor(4, 12), (10, 1, 60), 2e-14),
        (WindowedTaylor(4, 12, causal=True), (10, 1, 60), 2e-14),
        (WindowedTaylor(4, 12), (1, 2, 6), 1e-15),
    ],
)
def test_a_window_reaches_rounding(solver, case, bound):
    # 5e-14 rad is 1e-8 arcsec; what remains is the rounding of the increments, not of thousands of products.
    assert coning_error(solver, *case).max() < bound


@pytest.mark.parametrize("causal", [False, True])
@pytest.mark.parametrize(("samples", "window"), [(1, 5), (2, 6), (4, 8), (3, 3), (5, 11)])
def test_a_polynomial_rate_is_solved_exactly_at_both_ends_too(samples, window, causal):
    _, increments, motion = polynomial_motion(window - 1, seed=window, span=1.0)
    n = 60
    solver = WindowedTaylor(samples, window, causal=causal)
    q = solver.solve(increments(n), 1 / n, ONE)
    truth = motion.kinematics(np.arange(0, n + 1, samples) / n).q_ib
    # Roundings of the increments (differences of an integral of some rad) are amplified by the fit at the ends.
    assert error(q, truth).max() < 3e-14
    # One sample more in the rate's degree is not: the case above is not exact by accident.
    _, increments, motion = polynomial_motion(window + 2, seed=window, span=1.0)
    q = solver.solve(increments(n), 1 / n, ONE)
    assert error(q, motion.kinematics(np.arange(0, n + 1, samples) / n).q_ib).max() > 3e-14 or window > 6


def test_a_long_product_keeps_its_digits():
    # A constant turn of 1e-4 rad, 2^20 times: plain products would lose about 1e-13 rad.
    n = 2**20
    q = TaylorQuaternion(1).solve(np.tile([0.0, 0.0, 1e-4], (n, 1)), 1e-3, ONE)
    half = mpmath.mpf(1e-4) * n / 2
    truth = np.array([float(mpmath.cos(half)), 0, 0, float(mpmath.sin(half))])
    assert min(error(q[-1], truth), error(-q[-1], truth)) < 5e-15
    assert np.abs(np.linalg.norm(q, axis=1) - 1).max() < 1e-15


def test_only_the_papers_matrix_loses_its_orthogonality():
    # Two terms leave a matrix that is not orthonormal; the returned quaternion is unit all the same.
    increments = Coning(5 * DEG, 4 * np.pi).increments(100, 300)
    norms = []
    for orthonormalise in (True, False):
        solver = TaylorDcm(3, terms=2, orthonormalise=orthonormalise)
        with pytest.warns(BenchWarning, match="terms = 2 is too low"):
            state, q = solver.advance(solver.start(0.01, ONE), increments)
        C = state.carry[:9].reshape(3, 3)
        norms.append(np.abs(C @ C.T - np.eye(3)).max())
        np.testing.assert_allclose(np.linalg.norm(q, axis=1), 1, rtol=0, atol=1e-15)
    # Every update adds 1e-4 or so; one step of Newton's squares it, otherwise a hundred of them add up.
    assert norms[0] < 1e-6
    assert norms[1] > 1e3 * norms[0]


# --- truncation ------------------------------------------------------------------------------------------------------


def noisy(samples, rate=100, n=2400):
    return quantised(Coning(5 * DEG, 4 * np.pi).increments(rate, n // samples * samples))


@pytest.mark.parametrize("solver", [TaylorQuaternion, TaylorDcm])
@pytest.mark.parametrize("samples", [5, 6])
def test_too_few_terms_for_the_data_are_said_once_with_an_estimate(solver, samples):
    increments = noisy(samples)
    with pytest.warns(BenchWarning) as caught:
        q = solver(samples, terms=10).solve(increments, 0.01, ONE, chunk=100)
    assert len(caught) == 1
    message = str(caught[0].message)
    assert f"{solver.name}: terms = 10 is too low" in message
    assert caught[0].filename == __file__
    needed = int(message.split("about ")[1].split()[0])
    assert 10 < needed <= 30
    full = solver(samples, terms=150).solve(increments, 0.01, ONE)
    assert error(q, full)[1:].max() > 1e-9  # the warning was true
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        enough = solver(samples, terms=needed + 4).solve(increments, 0.01, ONE)
    assert error(enough, full).max() < 400 * 1e-10  # 1e-10 rad an update at the most


@pytest.mark.parametrize("solver", [TaylorQuaternion, TaylorDcm, WindowedTaylor])
@pytest.mark.parametrize("samples", range(1, 9))
@pytest.mark.filterwarnings("error")
def test_the_default_suffices(solver, samples):
    chosen = solver(samples, 12 - samples % 2) if solver is WindowedTaylor else solver(samples)
    for increments in (
        noisy(samples),
        noisy(samples, 1000),
        Coning(np.pi / 2, 4 * np.pi).increments(100, 24 * samples),
    ):
        fixed = dataclasses.replace(chosen, terms=250)
        difference = error(chosen.solve(increments, 0.01, ONE), fixed.solve(increments, 0.01, ONE))
        assert difference.max() < 1e-14  # roundings only


def test_a_window_says_so_too():
    with pytest.warns(BenchWarning, match=r"windowed-taylor: terms = 6 is too low.*about \d+ terms are needed"):
        WindowedTaylor(4, 12, terms=6).solve(noisy(4), 0.01, ONE)


def test_data_that_no_series_can_follow_are_said():
    with pytest.warns(BenchWarning, match="terms = 300 is too low.*more than 500 terms are needed"):
        TaylorQuaternion(3).solve(np.random.default_rng(0).normal(scale=20.0, size=(3, 3)), 0.01, ONE)


@pytest.mark.parametrize("solver", [TaylorQuaternion(3), TaylorDcm(3), TaylorDcm(3, 1, False), WindowedTaylor(2, 6)])
@pytest.mark.parametrize("size", [1e100, 1e155, 1e300])
def test_an_overflow_is_an_error_or_said_but_never_a_nan(solver, size):
    increments = np.full((24, 3), size)
    increments[::2] *= -1
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            q = solver.solve(increments, 0.01, ONE)
        except AccuracyError as found:
            assert solver.name in str(found)  # noqa: PT017
        else:
            np.testing.assert_allclose(np.linalg.norm(q, axis=1), 1, rtol=0, atol=1e-12)
            assert "is too low" in str(caught[0].message)


# --- streams and options ---------------------------------------------------------------------------------------------

STREAMS = [
    TaylorQuaternion(1),
    TaylorQuaternion(3),
    TaylorQuaternion(6),
    TaylorDcm(4),
    TaylorDcm(3, orthonormalise=False),
    WindowedTaylor(2, 8),
    WindowedTaylor(4, 12),
    WindowedTaylor(4, 12, causal=True),
    WindowedTaylor(3, 8, causal=True),
    WindowedTaylor(1, 9),
]


@pytest.mark.parametrize("solver", STREAMS, ids=str)
@pytest.mark.parametrize("chunk", [1, 5, 100])
def test_any_chunking_gives_the_same_bits(solver, chunk):
    increments = np.random.default_rng(2).normal(scale=1e-3, size=(240, 3))
    whole = solver.solve(increments, 0.01, ONE, chunk=10**6)
    np.testing.assert_array_equal(solver.solve(increments, 0.01, ONE, chunk=chunk), whole)
    state, rows = solver.start(0.01, ONE), []
    for begin in range(0, len(increments), chunk):
        state, q = solver.advance(state, increments[begin : begin + chunk])
        rows.append(q)
    rows.append(solver.finish(state))
    np.testing.assert_array_equal(np.concatenate(rows), whole[1:])


def test_lanes_do_not_change_bits_around_their_number():
    increments = np.random.default_rng(5).normal(scale=1e-3, size=(3 * 130, 3))
    whole = TaylorQuaternion(3).solve(increments, 0.01, ONE)
    for updates in (1, 31, 32, 33, 64, 65):
        np.testing.assert_array_equal(
            TaylorQuaternion(3).solve(increments[: 3 * updates], 0.01, ONE), whole[: updates + 1]
        )


@pytest.mark.parametrize(("causal", "latency"), [(False, 4), (True, 0)])
def test_a_window_is_late_by_what_it_borrows_from_the_future(causal, latency):
    solver = WindowedTaylor(4, 12, causal=causal)
    assert solver.latency == latency
    increments = np.random.default_rng(3).normal(scale=1e-3, size=(40, 3))
    state, rows = solver.start(0.01, ONE), 0
    for k in range(40):
        state, q = solver.advance(state, increments[k : k + 1])
        rows += len(q)
        assert rows == (0 if k < 11 else (k + 1 - latency) // 4)
    assert len(solver.finish(state)) == latency // 4


def test_the_causal_window_does_not_see_the_future():
    increments = np.random.default_rng(4).normal(scale=1e-3, size=(48, 3))
    changed = increments.copy()
    changed[24:] = 0.0
    for causal, same in ((True, 6), (False, 5)):
        solver = WindowedTaylor(4, 12, causal=causal)
        a, b = solver.solve(increments, 0.01, ONE), solver.solve(changed, 0.01, ONE)
        np.testing.assert_array_equal(a[: same + 1], b[: same + 1])
        assert error(a[same + 1], b[same + 1]) > 1e-9


@pytest.mark.parametrize("causal", [False, True])
def test_a_stream_shorter_than_the_window_is_refused(causal):
    solver = WindowedTaylor(4, 12, causal=causal)
    with pytest.raises(InputError, match=r"at least 12 increments \(its window\), got 8"):
        solver.solve(np.zeros((8, 3)), 0.01, ONE)
    state, q = solver.advance(solver.start(0.01, ONE), np.zeros((8, 3)))
    assert len(q) == 0
    with pytest.raises(InputError, match=r"at least 12 increments \(its window\), got 8"):
        solver.finish(state)
    np.testing.assert_array_equal(solver.solve(np.zeros((12, 3)), 0.01, ONE), np.tile(ONE, (4, 1)))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: TaylorQuaternion(0), "samples must be an integer >= 1, got 0"),
        (lambda: TaylorQuaternion(9), "samples must be an integer from 1 to 8, got 9"),
        (lambda: TaylorQuaternion(3, terms=0), "terms must be an integer >= 1, got 0"),
        (lambda: TaylorQuaternion(3, terms=301), "terms must be an integer from 1 to 300, got 301"),
        (lambda: TaylorDcm(3, terms=2.5), "terms must be an integer >= 1, got 2.5"),
        (lambda: TaylorDcm(3, orthonormalise="no"), "orthonormalise must be True or False, got 'no'"),
        (lambda: WindowedTaylor(4, 3), "window must be an integer >= 4, got 3"),
        (lambda: WindowedTaylor(4, 18), "window must be an integer from samples = 4 to 16, got 18"),
        (lambda: WindowedTaylor(4, 11), "window - samples must be even unless causal, got window = 11, samples = 4"),
        (lambda: WindowedTaylor(4, 12, causal=1), "causal must be True or False, got 1"),
        (lambda: WindowedTaylor(9, 12), "samples must be an integer from 1 to 8, got 9"),
    ],
)
def test_bad_options_are_named(make, message):
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize(
    ("solver", "orders"),
    [
        *[(TaylorQuaternion(n), (k, k)) for n, k in zip(range(1, 9), (2, 4, 4, 6, 6, 8, 8, 10), strict=True)],
        (TaylorDcm(6), (8, 8)),
        (TaylorDcm(6, terms=3), (3, 4)),
        (TaylorQuaternion(6, terms=4), (4, 4)),
        (WindowedTaylor(4, 8), (10, 10)),
        (WindowedTaylor(3, 7), (8, 8)),
        (WindowedTaylor(2, 6, causal=True), (7, 8)),
        (WindowedTaylor(2, 5, causal=True), (6, 6)),
        (WindowedTaylor(4, 4, causal=True), (6, 6)),
    ],
    ids=str,
)
def test_orders_are_declared(solver, orders):
    assert (solver.order_periodic, solver.order_drift) == orders


@pytest.mark.parametrize(
    ("name", "turn"), [("taylor-dcm", 13.0), ("taylor-quaternion", 30.0), ("windowed-taylor", 90.0)]
)
def test_an_update_that_turns_too_far_for_a_power_series_is_refused(name, turn):
    """exp(S) roundings: the terms of the series grow before they cancel, and no number of them helps."""
    solver = bench.solver("attitude", name, samples=2)
    with pytest.raises(AccuracyError, match="turns too far for a power series"):
        solver.solve(np.tile([turn * 1.5, 0.0, 0.0], (24, 1)), 0.01, [1, 0, 0, 0])


def test_rounding_of_a_far_turn_is_warned_of():
    with pytest.warns(BenchWarning, match=r"rounding of the series may reach .* rad in an update: take fewer samples"):
        bench.solver("attitude", "taylor-dcm", samples=1).solve(np.tile([20.0, 0, 0], (3, 1)), 0.01, [1, 0, 0, 0])


def test_a_state_belongs_to_its_solver_and_an_empty_chunk_changes_nothing():
    three, four = (bench.solver("attitude", "taylor-quaternion", samples=n) for n in (3, 4))
    state = three.start(0.01, [1, 0, 0, 0])
    with pytest.raises(InputError, match=r"state must come from start or advance of TaylorQuaternion\(samples=4"):
        four.advance(state, np.zeros((4, 3)))
    same, rows = three.advance(state, np.empty((0, 3)))
    assert same is state
    assert rows.shape == (0, 4)
