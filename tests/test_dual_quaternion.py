"""Dual quaternion: its exponential, its laws, and that it is the exactly compensated inertial-frame algorithm.

Truth: mpmath's power series for the exponential, the inertial-frame solver for the equality, MuJoCo's increments of
closed-form motions else.
"""

import math

import mpmath
import numpy as np
import pytest

import bench
from bench.rotation import quat_conjugate, quat_from_rotvec, quat_multiply
from bench.solvers.navigation._dual_quaternion_kernels import dual_exponential, dual_part, translation, unit
from tests.inertial_cases import HARD, LEVEL, SWING, OverThePole, apart, at_rest, flown, largest

NAME = "dual-quaternion"


def hamilton(p, q):
    w, x, y, z = p
    a, b, c, d = q
    return (
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b,
        w * d + x * c - y * b + z * a,
    )


def exponential_by_series(sigma, dual):
    """Return exp((sigma + eps dual)/2), eight numbers, as the sum of its powers."""
    with mpmath.workdps(40):
        half = [(mpmath.mpf(0), *(mpmath.mpf(float(x)) / 2 for x in part)) for part in (sigma, dual)]
        zero, one = (mpmath.mpf(0),) * 4, (mpmath.mpf(1), *(mpmath.mpf(0),) * 3)
        term, total = (one, zero), [one, zero]
        for k in range(1, 60):
            first, second = hamilton(term[1], half[0]), hamilton(term[0], half[1])
            real = tuple(x / k for x in hamilton(term[0], half[0]))
            term = real, tuple((a + b) / k for a, b in zip(first, second, strict=True))
            total = [tuple(a + b for a, b in zip(*pair, strict=True)) for pair in zip(total, term, strict=True)]
        return np.array([float(x) for part in total for x in part])


@pytest.mark.parametrize("s", [0.0, 1e-9, 1e-3, 0.1, 0.1999, 0.2001, 1.0, 3.0, 6.0])
def test_the_exponential_of_a_screw(s):
    sigma, dual = s * np.array([2 / 3, -1 / 3, 2 / 3]), np.array([3.0, -9.0, 5.0])
    # Just above the series' end cos(s/2)/2 - a is known to 1e-16, and is divided by s^2.
    np.testing.assert_allclose(
        dual_exponential(*sigma, *dual), exponential_by_series(sigma, dual), rtol=0, atol=2e-15 if s < 1 else 4e-15
    )


def test_products_and_translation():
    rng = np.random.default_rng(1)
    p, q = quat_from_rotvec(rng.normal(size=(2, 3)))
    v, w = rng.normal(size=(2, 3))
    dual = [0.5 * quat_multiply(np.append(0, x), y) for x, y in ((v, p), (w, q))]
    np.testing.assert_allclose(translation(*p, *dual[0]), v, atol=1e-15)
    # One displacement after the other: v and, in the axes turned by p, w.
    moved = translation(*quat_multiply(p, q), *dual_part(*p, *dual[0], *q, *dual[1]))
    turned = quat_multiply(quat_multiply(p, np.append(0, w)), quat_conjugate(p))[1:]
    np.testing.assert_allclose(moved, v + turned, atol=2e-15)


def test_a_nearly_unit_dual_quaternion_is_made_unit():
    rng = np.random.default_rng(2)
    q, d = quat_from_rotvec(rng.normal(size=3)), rng.normal(size=4)
    made = np.array(unit(*(q * (1 + 1e-9)), *d))
    assert abs(np.linalg.norm(made[:4]) - 1) < 3e-16
    assert abs(made[:4] @ made[4:]) < 1e-15
    np.testing.assert_allclose(translation(*made), translation(*q, *d), atol=1e-8)  # changed by the excess only


@pytest.mark.parametrize(
    "options",
    [{}, {"samples": 1}, {"samples": 5}, {"position": "trapezoid"}, {"height": "held"}],
    ids=lambda options: "-".join(map(str, options.values())) or "default",
)
def test_it_is_the_exactly_compensated_inertial_frame_algorithm(options):
    dual, exact = (flown(HARD, 20.0, name, **options) for name in (NAME, "inertial-frame"))
    attitude, velocity, position = apart(dual, exact)
    # Both round v_t, 3000 m/s, and q_d some ten times in each of 1000 updates: 4e-13 m/s, as a random walk.
    assert attitude < 1e-14
    assert velocity < 3e-10
    assert position < 1e-8
    printed = flown(HARD, 20.0, "inertial-frame", rotation="first-order", **options)
    assert apart(dual, printed)[1] > 1e-3


@pytest.mark.parametrize(("motion", "bounds"), [(LEVEL, (1e-13, 2e-9, 1e-7)), (SWING, (2e-6, 3e-3, 3e-2))])
def test_errors(motion, bounds):
    for error, bound in zip(largest(flown(motion, 20.0, NAME), motion), bounds, strict=True):
        assert error.max() < bound


@pytest.mark.parametrize("options", [{}, {"samples": 1}, {"height": "held"}])
def test_an_hour_at_rest(options):
    motion, dtheta, dvel, dt = at_rest(1.0)
    estimate = bench.solver("navigation", NAME, **options).solve(dtheta, dvel, dt, motion.navigation_initial())
    attitude, velocity, position = largest(estimate, motion)
    assert attitude.max() < 1e-8 * math.pi / 180
    assert velocity.max() < 1e-5
    assert position[:2].max() < 1e-3
    assert position[2] < 1e-2


def test_the_running_dual_quaternion_stays_unit():
    motion, dtheta, dvel, dt = at_rest(0.5)
    solver = bench.solver("navigation", NAME)
    state, _ = solver.advance(solver.start(dt, motion.navigation_initial()), dtheta, dvel)
    q, d = state.carry[:4], state.carry[4:8]
    assert abs(np.linalg.norm(q) - 1) < 5e-16
    assert np.linalg.norm(d) > 5000  # v_t = g t
    assert abs(q @ d) < 1e-15 * np.linalg.norm(d)


def test_over_the_pole():
    motion = OverThePole()
    for error, bound in zip(largest(flown(motion, 10.0, NAME), motion), (1e-12, 1e-6, 1e-5), strict=True):
        assert error.max() < bound


@pytest.mark.parametrize(("option", "value"), [("position", "simpson"), ("samples", 0), ("rotation", "exact")])
def test_wrong_options_are_named(option, value):
    with pytest.raises(bench.InputError, match=option):
        bench.solver("navigation", NAME, **{option: value})
