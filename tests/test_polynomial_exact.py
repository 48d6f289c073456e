"""Polynomial exact: against an independent integration, its tables, its window, and how accurate a reference it is.

Truth: SciPy's DOP853 on the equations of motion with a gravitation written here, SciPy's quadrature for the tables,
MuJoCo's increments of closed-form motions else.
"""

import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.spatial.transform import Rotation

import bench
from bench.earth import WGS84
from bench.motion.sinusoidal_velocity import SinusoidalVelocity
from bench.solvers.navigation.polynomial_exact import _double_integrals, _force_weights
from bench.trajectory import NavigationInitial
from tests.inertial_cases import (
    EMPTY,
    HARD,
    LEVEL,
    RATE,
    SWING,
    OverThePole,
    at_rest,
    flown,
    in_empty_space,
    largest,
    sensed,
)

NAME = "polynomial-exact"
DT = 0.05


def polynomial_motion(N, scale, seed):
    """Return coefficients of rate (N, 3), rad/s, and force (N, 3), m/s^2, as powers of t, for 2 N intervals of DT."""
    rng = np.random.default_rng(seed)
    powers = (2 * N * DT) ** -np.arange(float(N))[:, None]
    return scale * powers * rng.normal(size=(N, 3)), 10 * powers * rng.normal(size=(N, 3))


def increments_of(coefficients, n):
    """Return the integrals over n intervals, exact for these polynomials, right to rounding of each increment."""
    roots, weights = np.polynomial.legendre.leggauss(5)
    t = DT * (np.arange(n)[:, None] + 0.5 * (1 + roots))
    values = np.polynomial.polynomial.polyval(t, coefficients)  # (3, n, 5)
    return np.ascontiguousarray((0.5 * DT * values @ weights).T)


def attraction(r):
    """Return the gravitation of a point mass and J2 at r (3,), in axes about the Earth's; its potential's gradient."""
    a, GM, J2 = WGS84.semi_major_axis, WGS84.GM, WGS84.J2
    s2, size = (r[2] / np.linalg.norm(r)) ** 2, np.linalg.norm(r)
    factor = 1.5 * J2 * (a / size) ** 2
    return -GM / size**3 * r * (1 + factor * (np.array([1.0, 1.0, 3.0]) - 5 * s2))


def integrated(rate, force, initial, t):
    """Return q_eb (as Rotation), v_e, r_e at times t by DOP853 in i, position and velocity relative to a straight line.

    At 6.4e6 m absolute positions would cost the integrator its tolerance.
    """
    q_en = Rotation.from_quat(WGS84.q_en(initial.latitude, initial.longitude), scalar_first=True)
    q0 = q_en * Rotation.from_quat(initial.q_nb, scalar_first=True)
    r0 = WGS84.position(initial.latitude, initial.longitude, initial.height)
    spin = np.array([0.0, 0.0, WGS84.rate])
    v0 = q_en.apply(initial.v_n) + np.cross(spin, r0)
    k = np.arange(len(rate))

    def derivative(time, y):
        q = np.concatenate([[1.0], np.zeros(3)]) + y[:4]
        w, f = time**k @ rate, time**k @ force
        turn = 0.5 * np.array([-(q[1:] @ w), *(q[0] * w + np.cross(q[1:], w))])
        now = q0 * Rotation.from_quat(q, scalar_first=True)
        return np.concatenate([turn, now.apply(f) + attraction(r0 + v0 * time + y[7:]), y[4:7]])

    found = solve_ivp(derivative, (0, t[-1]), np.zeros(10), "DOP853", t, rtol=3e-14, atol=1e-14, max_step=DT / 4)
    assert found.success
    y = found.y.T
    q_ei = Rotation.from_rotvec(-spin * t[:, None])
    q_ib = q0 * Rotation.from_quat(y[:, :4] + [1.0, 0, 0, 0], scalar_first=True)
    r_e = q_ei.apply(r0 + v0 * t[:, None] + y[:, 7:])
    return q_ei * q_ib, q_ei.apply(v0 + y[:, 4:7]) - np.cross(spin, r_e), r_e


@pytest.mark.parametrize("latitude", [0.7, math.pi / 2])
@pytest.mark.parametrize(("N", "scale"), [(1, 1.0), (2, 3.0), (6, 0.3), (6, 2.0), (8, 1.0)])
def test_polynomials_of_rate_and_force_against_an_ode_solver(N, scale, latitude):
    rate, force = polynomial_motion(N, scale, seed=N)
    q_nb = Rotation.from_euler("zxy", [2.0, 0.3, -0.4]).as_quat(scalar_first=True)
    initial = NavigationInitial(q_nb, [2000.0, -6000.0, 300.0], latitude=latitude, longitude=1.0, height=2e4)
    dtheta, dvel = increments_of(rate, 2 * N), increments_of(force, 2 * N)
    found = bench.solver("navigation", NAME, samples=N, window=N).solve(dtheta, dvel, DT, initial)
    q_eb, v_e, r_e = integrated(rate, force, initial, found.t)
    assert (Rotation.from_quat(found.q_eb, scalar_first=True) * q_eb.inv()).magnitude().max() < 2e-14
    # Roundings of 6000 m/s and 6.4e6 m, and the tolerance of the integrator.
    np.testing.assert_allclose(found.v_e, v_e, rtol=0, atol=5e-12)
    np.testing.assert_allclose(found.r_e, r_e, rtol=0, atol=4e-9)


def test_weights_of_the_force_against_quadrature():
    roots, half = np.array([-0.7, 0.2]), 0.3
    weights = _force_weights(roots, half, 8)
    for k in range(8):
        assert weights[0, k] == pytest.approx(quad(lambda s, k=k: s**k, -1, 1)[0], abs=1e-14)
        for row, x in enumerate((1.0, *roots), 1):
            double = half * quad(lambda s, k=k, x=x: (x - s) * s**k, -1, x)[0]
            assert weights[row, k] == pytest.approx(double, abs=1e-14)


def test_double_integrals_of_the_nodes():
    nodes = np.array([0.1, 0.5, 0.8])
    table = _double_integrals(nodes)
    for power in range(3):  # the double integral of s^p is s^(p+2)/((p+1)(p+2))
        np.testing.assert_allclose(table @ nodes**power, nodes ** (power + 2) / ((power + 1) * (power + 2)), atol=1e-15)


def test_100_seconds_at_3000_m_per_s_with_10_degrees_at_1_hz():
    attitude, velocity, position = largest(flown(SWING, 100.0, NAME), SWING)
    assert attitude.max() < 3e-12
    assert velocity.max() < 1e-9
    assert position.max() < 3e-8
    # Even without the borrowed increments it is below a micrometre on each axis.
    attitude, velocity, position = largest(flown(SWING, 100.0, NAME, window=6), SWING)
    assert attitude.max() < 1e-10
    assert velocity.max() < 1e-7
    assert position.max() < 1e-6


@pytest.mark.parametrize(("motion", "N"), [(LEVEL, 2), (LEVEL, 6), (HARD, 8)])
def test_rounding_is_reached(motion, N):
    attitude, velocity, position = largest(flown(motion, 20.0, NAME, samples=N), motion)
    assert attitude.max() < 1e-14
    assert velocity.max() < 2e-11  # with 3400 m/s one rounding is 5e-13
    assert position.max() < 5e-9  # a few roundings at 6.4e6 m, of truth too


@pytest.mark.parametrize("options", [{}, {"height": "held"}])
def test_an_hour_at_rest(options):
    motion, dtheta, dvel, dt = at_rest(1.0)
    estimate = bench.solver("navigation", NAME, **options).solve(dtheta, dvel, dt, motion.navigation_initial())
    attitude, velocity, position = largest(estimate, motion)
    assert attitude.max() < 1e-11 * math.pi / 180
    assert velocity.max() < 1e-8
    assert position.max() < 1e-5


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "attitude_deg", "horizontal", "vertical"),
    [(NAME, 1e-11, 1e-7, 2e-6), ("inertial-frame", 1e-9, 1e-4, 1e-3), ("dual-quaternion", 1e-9, 1e-3, 1e-2)],
)
def test_an_hour_of_sinusoidal_velocity(name, attitude_deg, horizontal, vertical):
    # The height is free: an error in it grows e-fold in 570 s, 280 times in the hour.
    motion = SinusoidalVelocity()
    attitude, _, position = largest(flown(motion, 3600.0, name), motion)
    assert attitude.max() < math.radians(attitude_deg)
    assert position[:2].max() < horizontal
    assert position[2] < vertical


def test_over_the_pole():
    motion = OverThePole()
    for error, bound in zip(largest(flown(motion, 10.0, NAME), motion), (1e-14, 2e-11, 5e-9), strict=True):
        assert error.max() < bound


def test_a_held_height_stays():
    estimate = flown(SWING, 20.0, NAME, height="held")
    assert np.abs(estimate.height - SWING.height).max() < 1e-8
    assert np.abs(estimate.v_n[:, 2]).max() < 1e-11
    assert largest(estimate, SWING)[2].max() < 1e-7


def flown_increments(n):
    found = sensed(SWING, 20.0)
    return found.dtheta_b[:n], found.dvel[:n]


@pytest.mark.parametrize(("N", "window"), [(1, 5), (3, 8), (6, None)])
def test_increments_one_at_a_time_give_the_same_bits(N, window):
    increments = flown_increments(120)
    solver = bench.solver("navigation", NAME, samples=N, window=window)
    whole = solver.solve(*increments, 1 / RATE, SWING.navigation_initial())
    state, rows = solver.start(1 / RATE, SWING.navigation_initial()), []
    for dtheta, dvel in zip(*increments, strict=True):
        state, part = solver.advance(state, dtheta[None], dvel[None])
        rows += [] if part is None else [part]
    for name in ("q_eb", "v_e", "r_e"):
        np.testing.assert_array_equal(np.concatenate([getattr(part, name) for part in rows]), getattr(whole, name)[1:])


def test_borrowed_increments_pay():
    coarse, fine = (largest(flown(SWING, 20.0, NAME, samples=4, window=W), SWING) for W in (4, 6))
    for a, b in zip(coarse, fine, strict=True):
        assert b.max() < 0.05 * a.max()


@pytest.mark.parametrize("window", [5, 13, 6.0])
def test_a_wrong_window_is_named(window):
    with pytest.raises(bench.InputError, match="window must be an integer"):
        bench.solver("navigation", NAME, window=window)


def test_no_order_is_stated_for_a_longer_window():
    assert [bench.solver("navigation", NAME, samples=N, window=N).order_periodic for N in (1, 2, 5, 6)] == [2, 4, 6, 8]
    assert bench.solver("navigation", NAME).order_periodic is None


def test_noise_takes_more_terms_and_costs_no_digits():
    rng = np.random.default_rng(4)
    dtheta = rng.normal(scale=3e-3, size=(120, 3))  # 0.3 rad/s at 100 Hz; the coefficients are 100 times larger
    found = bench.solver("navigation", NAME, window=6).solve(dtheta, 0 * dtheta, 1 / RATE, in_empty_space(), EMPTY)
    other = bench.solver("attitude", "functional-iteration", samples=6)  # Chebyshev series
    np.testing.assert_allclose(found.q_eb, other.solve(dtheta, 1 / RATE, [1.0, 0, 0, 0]), rtol=0, atol=3e-15)


def test_increments_too_irregular_for_a_series_are_an_error():
    dtheta, dvel = (part.copy() for part in flown_increments(60))
    dtheta[38] += 0.2  # of update 6, a jump of 20 rad/s for one interval
    with pytest.raises(bench.AccuracyError, match="increments of update 6 turn too far or too irregularly"):
        bench.solver("navigation", NAME).solve(dtheta, dvel, 1 / RATE, SWING.navigation_initial())
    bench.solver("navigation", NAME, samples=2).solve(dtheta, dvel, 1 / RATE, SWING.navigation_initial())
