"""Inertial frame: exact where it must be, its options, a held height, the poles, an hour at rest.

Truth: closed forms for a constant rate and force in empty space, MuJoCo's increments of closed-form motions else.
"""

import numpy as np
import pytest

import bench
from bench.earth import SPHERE, WGS84_NORMAL
from bench.motion.fast_vehicle import FastVehicle
from tests.inertial_cases import (
    EMPTY,
    LEVEL,
    RATE,
    SWING,
    WEAVE,
    OverThePole,
    apart,
    at_rest,
    constant_screw,
    flown,
    in_empty_space,
    largest,
)

NAME = "inertial-frame"


@pytest.mark.parametrize("position", ["scrolling", "trapezoid"])
@pytest.mark.parametrize("samples", [1, 2, 3, 8])
@pytest.mark.parametrize("rate", [0.02, 1.0, 40.0])  # series and closed forms of the coefficients, rad/s
def test_a_constant_rate_and_force_are_exact(samples, position, rate):
    dtheta, dvel, q, v, r = constant_screw(rate * np.array([0.6, 0.0, -0.8]), [3.0, 9.0, -5.0], 240, 0.01)
    solver = bench.solver("navigation", NAME, samples=samples, position=position)
    found = solver.solve(dtheta, dvel, 0.01, in_empty_space(), EMPTY)
    np.testing.assert_allclose(found.q_eb, q[::samples], rtol=0, atol=1e-14)
    np.testing.assert_allclose(found.v_e, v[::samples], rtol=0, atol=2e-13)  # v = 20 m/s, 240 roundings
    moved = found.r_e - [EMPTY.semi_major_axis, 0, 0]
    if position == "scrolling":
        np.testing.assert_allclose(moved, r[::samples], rtol=0, atol=2e-9)  # one rounding at 6.4e6 m
    else:
        change = np.linalg.norm(np.diff(v[::samples], axis=0), axis=1).max()
        error = np.abs(moved - r[::samples]).max()
        assert error < samples * 0.01 * change / 4  # of an update's displacement, all over


def test_first_order_rotation_is_what_is_printed():
    # One update of two samples: v = u + 1/2 d x u + 2/3 (d1 x u2 + u1 x d2), displacement by the trapezoid T v/2.
    rng = np.random.default_rng(0)
    d, u = rng.normal(size=(2, 2, 3))
    solver = bench.solver("navigation", NAME, rotation="first-order", position="trapezoid")
    found = solver.solve(d, u, 0.5, in_empty_space(), EMPTY)
    sculling = 2 / 3 * (np.cross(d[0], u[1]) + np.cross(u[0], d[1]))
    expected = u.sum(axis=0) + 0.5 * np.cross(d.sum(axis=0), u.sum(axis=0)) + sculling
    np.testing.assert_allclose(found.v_e[1], expected, rtol=1e-14)
    np.testing.assert_allclose(found.r_e[1] - found.r_e[0], expected / 2, rtol=0, atol=2e-9)


@pytest.mark.parametrize("earth", [LEVEL.earth, WGS84_NORMAL, SPHERE], ids=lambda earth: earth.name)
def test_a_level_flight_at_3000_m_per_s(earth):
    motion = FastVehicle(swing=(0.0, 0.0, 0.0), earth=earth)
    attitude, velocity, position = largest(flown(motion, 20.0, NAME), motion)
    assert attitude.max() < 1e-13
    # Gravitation half-way for its mean: T^2/24 v^2/r^2 g = 4e-11 m/s^2, and as much for the force.
    assert velocity.max() < 2e-9
    assert position.max() < 1e-7


def test_an_acceleration_of_13_g():
    attitude, velocity, position = largest(flown(WEAVE, 20.0, NAME), WEAVE)
    assert attitude.max() < 1e-13
    assert velocity.max() < 5e-8
    assert position.max() < 1e-5
    # T^2/12 of the change of the acceleration, 250 m/s^2: the trapezoid's error.
    trapezoid = largest(flown(WEAVE, 20.0, NAME, position="trapezoid"), WEAVE)[2].max()
    assert 1e-3 < trapezoid < 0.02**2 / 12 * 500


def test_more_samples_and_exact_rotation_help_under_attitude_motion():
    errors = {N: largest(flown(SWING, 20.0, NAME, samples=N), SWING) for N in (1, 2)}
    printed = largest(flown(SWING, 20.0, NAME, rotation="first-order"), SWING)
    assert errors[2][0].max() < 2e-6  # 10 deg, 1 Hz: coning of two samples, 1.5 arcsec in 100 s
    assert errors[1][0].max() > 50 * errors[2][0].max()
    np.testing.assert_array_equal(printed[0], errors[2][0])
    assert 10 < printed[1].max() / errors[2][1].max() < 200


@pytest.mark.parametrize("options", [{}, {"samples": 1}, {"rotation": "first-order", "position": "trapezoid"}])
def test_an_hour_at_rest(options):
    motion, dtheta, dvel, dt = at_rest(1.0)
    estimate = bench.solver("navigation", NAME, **options).solve(dtheta, dvel, dt, motion.navigation_initial())
    attitude, velocity, position = largest(estimate, motion)
    assert attitude.max() < 1e-8 * np.pi / 180
    assert velocity.max() < 1e-6
    assert position[:2].max() < 1e-3
    assert position[2] < 1e-2


def test_a_held_height_stays():
    motion, dtheta, dvel, dt = at_rest(0.25)
    biased = dvel + np.array([0.0, 0.0, 1e-3]) * dt  # a vertical error: 4e2 m in 15 minutes if free
    solver = bench.solver("navigation", NAME, height="held")
    estimate = solver.solve(dtheta, biased, dt, motion.navigation_initial())
    assert np.abs(estimate.height - 100.0).max() < 1e-8
    assert np.abs(estimate.v_n[:, 2]).max() < 1e-12
    free = bench.solver("navigation", NAME).solve(dtheta, biased, dt, motion.navigation_initial())
    assert np.abs(free.height - 100.0).max() > 100.0


def test_a_held_height_does_not_disturb_a_level_flight():
    free, held = (flown(LEVEL, 20.0, NAME, height=height) for height in ("free", "held"))
    assert np.abs(held.height - LEVEL.height).max() < 1e-8
    assert max(largest(held, LEVEL)[2][:2]) < 1e-5
    assert apart(free, held)[2] < 1e-5


def test_over_the_pole():
    motion = OverThePole()
    attitude, velocity, position = largest(flown(motion, 10.0, NAME, samples=4), motion)
    assert attitude.max() < 1e-12
    assert velocity.max() < 1e-6
    assert position.max() < 1e-5


@pytest.mark.parametrize(("option", "value"), [("rotation", "none"), ("position", "simpson"), ("samples", 9)])
def test_wrong_options_are_named(option, value):
    with pytest.raises(bench.InputError, match=option):
        bench.solver("navigation", NAME, **{option: value})


def test_increments_beyond_all_bounds_are_an_error():
    motion = LEVEL
    dtheta = np.full((4, 3), 1e-3)
    with pytest.raises(bench.AccuracyError, match="inertial-frame diverges at update 0"):
        bench.solver("navigation", NAME).solve(dtheta, np.full((4, 3), 1e308), 1 / RATE, motion.navigation_initial())
