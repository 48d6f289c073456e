"""The three gyro-free solvers on their arrays: exactness, zero crossings, noise, geometry, observability.

Truth: hand-written motions and ``A = d . (f + alpha x r + omega x (omega x r))`` in numpy; noise variances from
the papers' formulas with chi-square bounds; trigonometric integrals in closed form.
"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

import bench
from bench.solvers.gyro_free.array_least_squares import observability
from tests.gyro_free_cases import (
    E,
    Wave,
    array,
    cube,
    nine,
    padgaonkar,
    readings,
    rotated,
    tetrahedron,
    triads,
)

DT = 0.01
T = DT * np.arange(2001)


def solve(name, there, A, initial, dt=DT, **options):
    return bench.solver("gyro-free", name, **options).solve(there, A, dt, initial)


def subset(there, keep):
    return bench.Accelerometers(tuple(there.names[k] for k in keep), there.position[keep], there.direction[keep])


def ten():
    """The nine and one more channel that sees the product of the rates about x and y."""
    there = nine()
    return array([*there.position, [0.1, 0.1, 0.0]], [*there.direction, [1, 1, 0]])


def scattered(m=15):
    rng = np.random.default_rng(4)
    return array(rng.normal(scale=0.3, size=(m, 3)) + np.array([0.5, 0.2, -1.0]), rng.normal(size=(m, 3)))


# Rates are 1 to 3 rad/s. Where they are roots, they hold to the rounding of the readings (1e-14 m/s^2) over the
# arm and the rate; where they are integrals, to the truncation (19/720 h^5 d4 alpha per step, 1e-8 over 20 s).
EXACT = [
    ("nine-accelerometer", nine, 1e-12),
    ("nine-accelerometer", lambda: nine(0.37), 1e-12),
    ("array-least-squares", nine, 1e-12),
    ("array-least-squares", ten, 1e-12),
    ("array-least-squares", tetrahedron, 1e-12),
    ("array-least-squares", scattered, 1e-11),
    ("six-accelerometer", cube, 1e-7),
    ("six-accelerometer", lambda: cube(-1, 0.37), 1e-7),
    ("array-least-squares", cube, 1e-7),
    ("array-least-squares", padgaonkar, 1e-7),
]


@pytest.mark.parametrize(("name", "make", "tolerance"), EXACT)
def test_noise_free_readings_give_rate_and_force_back(name, make, tolerance):
    wave, there = Wave(5, mean=2.0, swing=0.4), make()
    solution = solve(name, there, wave.readings(there, T), wave.initial())
    assert solution.negative_squares == 0
    np.testing.assert_allclose(solution.omega_ib_b, wave.omega(T), rtol=0, atol=tolerance)
    np.testing.assert_allclose(solution.alpha_ib_b, wave.alpha(T), rtol=0, atol=max(tolerance, 1e-11))
    np.testing.assert_allclose(solution.f_b, wave.f(T), rtol=0, atol=max(tolerance, 1e-12))


@pytest.mark.parametrize(("name", "make"), [("nine-accelerometer", nine), ("array-least-squares", nine)])
def test_signs_follow_through_zero_crossings(name, make):
    t = np.arange(4001) * DT
    wave, there = Wave(8, mean=0.1, swing=1.5, frequency=3.0), make()
    omega = wave.omega(t)
    assert (np.diff(np.sign(omega), axis=0) != 0).sum() > 30  # the motion does what this test is about
    solution = solve(name, there, wave.readings(there, t), wave.initial())
    # At a crossing the error of a square, 1e-14 m/s^2 over 0.1 m, is 3e-7 rad/s in the root.
    np.testing.assert_allclose(solution.omega_ib_b, omega, rtol=0, atol=1e-6)


def test_all_products_leave_one_sign_and_no_trouble_at_crossings():
    t = np.arange(4001) * DT
    wave, there = Wave(8, mean=0.1, swing=1.5, frequency=3.0), tetrahedron()
    omega = wave.omega(t)
    assert np.linalg.norm(omega, axis=1).min() > 0.05  # single rates cross zero, never all together
    solution = solve("array-least-squares", there, wave.readings(there, t), wave.initial())
    np.testing.assert_allclose(solution.omega_ib_b, omega, rtol=0, atol=1e-11)


def test_a_swing_through_rest_changes_the_sign_of_the_whole_rate():
    # omega = a sin t u: all three rates vanish together, so the sign comes from integrated alpha alone.
    t, u = np.arange(2001) * DT, np.array([1.0, -2.0, 0.5])
    omega, alpha = np.sin(t)[:, None] * u, np.cos(t)[:, None] * u
    for there in (tetrahedron(), nine()):
        A = readings(there, omega, alpha, np.zeros_like(omega))
        solution = solve("array-least-squares", there, A, bench.Initial(gravity=(0, 0, 0)))
        np.testing.assert_allclose(solution.omega_ib_b, omega, rtol=0, atol=1e-6)


@pytest.mark.parametrize(("name", "make"), [("nine-accelerometer", nine), ("six-accelerometer", cube)])
def test_closed_form_and_least_squares_agree(name, make):
    wave, there = Wave(6, mean=2.0, swing=0.3), make()
    A = wave.readings(there, T)
    closed, general = (solve(n, there, A, wave.initial()) for n in (name, "array-least-squares"))
    # Both are the same equations, so only rounding differs: 1e-14 m/s^2 over the arm, integrated twice for 20 s.
    for field, atol in (("omega_ib_b", 1e-11), ("alpha_ib_b", 1e-11), ("f_b", 1e-11), ("q_ib", 1e-10)):
        np.testing.assert_allclose(getattr(closed, field), getattr(general, field), rtol=0, atol=atol)
    np.testing.assert_allclose(closed.position, general.position, rtol=0, atol=1e-8)


def test_channels_of_the_cube_may_stand_in_any_order():
    wave, there = Wave(6, mean=2.0, swing=0.3), cube()
    order = np.array([3, 0, 5, 1, 4, 2])
    A = wave.readings(there, T)
    plain = solve("six-accelerometer", there, A, wave.initial())
    mixed = solve("six-accelerometer", subset(there, order), A[:, order], wave.initial())
    np.testing.assert_array_equal(plain.position, mixed.position)


@pytest.mark.parametrize("make", [nine, cube, padgaonkar, tetrahedron])
def test_turning_the_array_turns_what_it_finds(make):
    wave, there = Wave(7, mean=2.0, swing=0.3), make()
    C = Rotation.from_rotvec([0.4, -0.9, 0.3])
    A = wave.readings(there, T)  # just what the turned array reads in the turned motion
    initial = wave.initial()
    expected = solve("array-least-squares", there, A, initial)
    turned_initial = bench.Initial(omega_ib_b=C.apply(initial.omega_ib_b), gravity=initial.gravity)
    found = solve("array-least-squares", rotated(there, C.as_matrix()), A, turned_initial)
    # Measured or integrated (the turned nine no longer has the squares of single axes), the rate is the same
    # vector; 1e-7 is the truncation of the integrated one.
    np.testing.assert_allclose(found.omega_ib_b, C.apply(expected.omega_ib_b), rtol=0, atol=1e-7)
    np.testing.assert_allclose(found.f_b, C.apply(expected.f_b), rtol=0, atol=1e-7)


def variance_bounds(n):
    """Bounds of sample variance over true variance that a correct estimator leaves once in 10^5."""
    return chi2.ppf([5e-6, 1 - 5e-6], n - 1) / (n - 1)


def noisy_solution(name, there, omega, s=1e-4, n=20_000):
    rng = np.random.default_rng(11)
    clean = readings(there, omega[None], np.zeros((1, 3)), np.array([[1.0, 2.0, 9.0]]))
    # A tiny dt: every row stands alone, the integral of alpha stays at omega(0).
    A = clean + s * rng.standard_normal((n, len(there)))
    return solve(name, there, A, bench.Initial(omega_ib_b=omega, gravity=(0, 0, 0)), dt=1e-12)


def test_noise_of_the_nine_is_that_of_the_paper():
    s, arm, n = 1e-4, 0.1, 20_000
    solution = noisy_solution("nine-accelerometer", nine(arm), np.array([2.0, -1.0, 3.0]), s, n)
    low, high = variance_bounds(n)
    for values, variance in (
        (solution.f_b, s**2 / 2),
        (solution.omega_ib_b**2, 3 / 8 * s**2 / arm**2),
        (solution.alpha_ib_b, s**2 / arm**2),
    ):
        ratio = values.var(axis=0, ddof=1) / variance
        assert ((low < ratio) & (ratio < high)).all(), ratio


def test_noise_of_the_six_is_that_of_the_paper():
    s, arm, n = 1e-4, 0.1, 20_000
    solution = noisy_solution("six-accelerometer", cube(1, arm), np.array([2.0, -1.0, 3.0]), s, n)
    low, high = variance_bounds(n)
    for values, variance in ((solution.f_b, s**2 / 2), (solution.alpha_ib_b, s**2 / (2 * arm**2))):
        ratio = values.var(axis=0, ddof=1) / variance
        assert ((low < ratio) & (ratio < high)).all(), ratio


def test_negative_squares_are_counted_and_taken_as_zero():
    # At rest a square is negative half the time.
    n = 20_000
    solution = noisy_solution("nine-accelerometer", nine(), np.zeros(3), n=n)
    assert abs(solution.negative_squares / (3 * n) - 0.5) < 4 * 0.5 / np.sqrt(3 * n / 2)
    assert (solution.omega_ib_b == 0).sum() == solution.negative_squares


def test_a_negative_square_also_informs_the_other_rates():
    # The errors of the squares are correlated, so least squares under omega_x^2 >= 0 moves the others: SciPy's
    # nonnegative least squares on the readings is the truth.
    from scipy.optimize import nnls

    there, s = nine(), 0.05
    clean = readings(there, np.array([[0.0, 1.5, 2.0]]), np.zeros((1, 3)), np.zeros((1, 3)))
    A = clean + s * np.random.default_rng(2).standard_normal((50, 9))
    solution = solve(
        "array-least-squares", there, A, bench.Initial(omega_ib_b=[0, 1.5, 2.0], gravity=(0, 0, 0)), dt=1e-12
    )
    assert 10 < solution.negative_squares < 40
    r, d = there.position, there.direction
    squares = np.stack([(d * np.cross(e, np.cross(e, r))).sum(axis=1) for e in E], axis=1)
    H = np.hstack([d, np.cross(r, d)])
    P = np.eye(9) - H @ np.linalg.pinv(H)
    for row, omega in zip(A, solution.omega_ib_b, strict=True):
        expected, _ = nnls(P @ squares, P @ row)
        np.testing.assert_allclose(omega**2, expected, rtol=0, atol=1e-12)  # roundings of 1e-14 m/s^2 over 0.1 m


def test_constant_alpha_bias_makes_the_six_drift_as_t_and_the_nine_not():
    n, there6, there9 = 6001, cube(), nine()
    omega = np.tile([2.0, 2.0, 2.0], (n, 1))
    still = np.zeros((n, 3))
    bias = 1.5e-5
    start = bench.Initial(omega_ib_b=omega[0], gravity=(0, 0, 0))
    # D_j - S_k grows by 2 bias where face +e_j reads bias more and -e_j bias less: alpha by 2 bias / (2 sqrt(2) l).
    push = np.array([0, 0, bias, -bias, 0, 0])  # D_y enters alpha_x
    six = solve("six-accelerometer", there6, readings(there6, omega, still, still) + push, start)
    expected = 2 * bias / (2 * np.sqrt(2) * 0.1) * 60.0
    np.testing.assert_allclose(six.omega_ib_b[-1] - 2.0, [expected, 0, 0], rtol=1e-6, atol=1e-10)
    biased = solve("nine-accelerometer", there9, readings(there9, omega, still, still) + bias, start)
    # (4): the squares shift by at most 2 bias / (4 l), the rate by that over 2 omega, at any time.
    assert np.abs(biased.omega_ib_b[-1] - 2.0).max() < 1.01 * 2 * bias / (4 * 0.1) / 4


def test_gravity_is_in_the_loop():
    # A body that lies still on a table reads -g and goes nowhere; told of no gravity, it rises at 9.8 m/s^2.
    there, f = cube(), np.tile([0, 0, 9.8], (101, 1))
    A = readings(there, 0 * f, 0 * f, f)
    still = solve("six-accelerometer", there, A, bench.Initial(gravity=(0, 0, -9.8)))
    rising = solve("six-accelerometer", there, A, bench.Initial(gravity=(0, 0, 0)))
    np.testing.assert_allclose(still.position[-1], 0, rtol=0, atol=1e-12)
    np.testing.assert_allclose(rising.position[-1], [0, 0, 4.9], rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("make", "rank", "motion_rank", "mode", "unobservable"),
    [
        (nine, 9, 6, "squares", ("w_x w_y", "w_x w_z", "w_y w_z")),
        (ten, 10, 6, "squares", ("w_x w_z", "w_y w_z")),
        (tetrahedron, 12, 6, "rank-one", ()),
        (scattered, 12, 6, "rank-one", ()),
        (padgaonkar, 9, 6, "integral", ("w_x^2", "w_y^2", "w_z^2")),
        (
            cube,
            6,
            6,
            "integral",
            ("w_x^2", "w_y^2", "w_z^2", "w_x w_y - 0.1 f_z", "w_x w_z - 0.1 f_y", "w_y w_z - 0.1 f_x"),
        ),
    ],
)
def test_observability_follows_from_the_geometry(make, rank, motion_rank, mode, unobservable):
    found = observability(make())
    assert (found.rank, found.motion_rank, found.mode, found.unobservable) == (rank, motion_rank, mode, unobservable)
    assert 1 <= found.condition < 20
    assert f"rank {rank} of 12" in str(found)
    # In these arrays an unknown is lost exactly if it has a part in a direction that is.
    words = " ".join(unobservable)
    assert all((name in words) != (name in found.estimable) for name in ("f_x", "w_x^2", "w_x w_z", "alpha_y"))


@pytest.mark.parametrize(
    ("there", "message"),
    [
        (triads([[0, 0, 0]]), "rank 3, not 6; these changes leave every reading as it is: alpha_x; alpha_y; alpha_z$"),
        (
            triads([[0.1, 0.2, 0]]),
            r"alpha_x - 0.2 f_z; alpha_y \+ 0.1 f_z; alpha_z \+ 0.2 f_x - 0.1 f_y$",
        ),
        (triads([[0.1, 0, 0], [0.2, 0, 0], [-0.5, 0, 0]]), "rank 5, not 6; .* as it is: alpha_x$"),
        (
            array(0.1 * np.array([*E, *-E]), [*E, *E]),
            "6 accelerometers .* rank 3, not 6; .*: alpha_x; alpha_y; alpha_z$",
        ),
        (array([[0.1, 0, 0]], [[0, 1, 0]]), "1 accelerometers do not determine f and alpha"),
        (subset(cube(), [0, 1, 2, 3, 4]), "rank 5, not 6"),
    ],
)
def test_an_array_that_cannot_do_it_says_what_is_lost(there, message):
    assert observability(there).mode == "none"
    with pytest.raises(bench.ObservabilityError, match=message):
        bench.solver("gyro-free", "array-least-squares").start(there, DT, bench.Initial(gravity=(0, 0, 0)))


def moved(there, k, **change):
    position, direction = there.position.copy(), there.direction.copy()
    if "position" in change:
        position[k] += change["position"]
    if "direction" in change:
        direction[k] = change["direction"]
    return bench.Accelerometers(there.names, position, direction)


@pytest.mark.parametrize(
    ("name", "there", "message"),
    [
        ("nine-accelerometer", cube(), "needs 9 channels, got 6; see array-least-squares"),
        ("nine-accelerometer", moved(nine(), 6, position=[0, 0, 1e-3]), r"channel 7 \('A7'\).*array-least-squares"),
        ("nine-accelerometer", moved(nine(), 0, position=[1e-3, 0, 0]), r"channel 1 \('A1'\)"),
        ("nine-accelerometer", moved(nine(), 4, direction=[0, 1, 0]), r"channel 5 \('A5'\).*got .* along \[0. 1. 0.\]"),
        ("nine-accelerometer", subset(nine(), [1, 0, *range(2, 9)]), r"channel 1 \('A2'\)"),
        ("nine-accelerometer", triads(np.zeros((3, 3))), "arm length > 0, got 0.0 m"),
        ("six-accelerometer", nine(), "needs 6 channels, got 9; see array-least-squares"),
        ("six-accelerometer", moved(cube(), 3, position=[0, 1e-3, 0]), r"nearest is channel 4 \('A4'\)"),
        ("six-accelerometer", moved(cube(), 2, direction=E[0]), r"channel 3 \('A3'\) along .*array-least-squares"),
        ("six-accelerometer", triads(np.zeros((2, 3))), "arm length > 0, got 0.0 m"),
    ],
)
def test_another_geometry_is_refused_by_the_closed_forms(name, there, message):
    with pytest.raises(bench.InputError, match=message):
        bench.solver("gyro-free", name).start(there, DT, bench.Initial(gravity=(0, 0, 0)))
