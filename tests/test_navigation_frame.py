"""The conventional strapdown INS in the navigation frame: errors on known motions, options, poles, cost.

Truth: motions on the Earth in closed form with MuJoCo's increments; a constant rate and force in empty space.
"""

import math

import numpy as np
import pytest

import bench
from bench.earth import SPHERE, WGS84, WGS84_NORMAL
from bench.evaluation import attitude_error
from bench.motion.fast_vehicle import FastVehicle
from bench.motion.great_circle import GreatCircle
from bench.motion.sinusoidal_velocity import SinusoidalVelocity
from bench.operation_count import counting
from bench.rotation import quat_rotate
from bench.solvers.navigation.navigation_frame import NavigationFrame
from bench.units import DEG
from tests.inertial_cases import (
    EMPTY,
    HARD,
    LEVEL,
    SWING,
    WEAVE,
    apart,
    at_rest,
    constant_screw,
    flown,
    in_empty_space,
    largest,
)
from tests.navigation_cases import swaying

NAME = "navigation-frame"
AZIMUTHS = ["north", "wander"]


@pytest.mark.parametrize("azimuth", AZIMUTHS)
@pytest.mark.parametrize("position", ["scrolling", "trapezoid"])
@pytest.mark.parametrize("rate", [0.02, 1.0, 40.0])  # series and closed forms of the coefficients, rad/s
def test_a_constant_rate_and_force_are_exact(rate, position, azimuth):
    dtheta, dvel, q, v, r = constant_screw(rate * np.array([0.6, 0.0, -0.8]), [3.0, 9.0, -5.0], 240, 0.01)
    solver = NavigationFrame(2, position=position, azimuth=azimuth)
    found = solver.solve(dtheta, dvel, 0.01, in_empty_space(), EMPTY)
    np.testing.assert_allclose(found.q_eb, q[::2], rtol=0, atol=1e-14)
    np.testing.assert_allclose(found.v_e, v[::2], rtol=0, atol=5e-13)  # v = 20 m/s, 240 roundings
    # A rounding of n's frame is 1e-9 m, in each of 120 updates.
    tolerance = 1e-7 if position == "scrolling" else 2 * 0.01 * np.abs(np.diff(v[::2], axis=0)).max() / 2
    np.testing.assert_allclose(found.r_e - found.r_e[0], r[::2], rtol=0, atol=tolerance)


@pytest.mark.parametrize(
    "options",
    [{}, {"azimuth": "wander"}, {"rotation": "first-order", "position": "trapezoid"}, {"samples": 1}, {"samples": 6}],
)
def test_an_hour_at_rest(options):
    motion, dtheta, dvel, dt = at_rest(1.0)
    estimate = NavigationFrame(**options).solve(dtheta, dvel, dt, motion.navigation_initial())
    attitude, velocity, position = largest(estimate, motion)
    assert attitude.max() < 1e-8 * DEG
    assert velocity.max() < 1e-6
    assert position[:2].max() < 1e-3
    assert position[2] < 1e-2
    if options.get("rotation") != "first-order":  # that leaves (omega_ie T)^2 g / 6 = 4e-12 m/s^2
        assert position.max() < 2e-5


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "horizontal", "vertical"),
    [
        ({}, 1e-4, 1e-5),
        ({"azimuth": "wander"}, 1e-4, 1e-5),
        ({"samples": 4}, 1e-4, 1e-4),
        ({"position": "trapezoid"}, 2e-4, 5e-3),
    ],
)
def test_an_hour_of_sinusoidal_velocity(options, horizontal, vertical):
    # The height is free: an error in it grows e-fold in 570 s, 280 times in the hour.
    motion = SinusoidalVelocity()
    attitude, _, position = largest(flown(motion, 3600.0, NAME, **options), motion)
    assert attitude.max() < 1e-9 * DEG
    assert position[:2].max() < horizontal
    assert position[2] < vertical


@pytest.mark.parametrize("azimuth", AZIMUTHS)
@pytest.mark.parametrize("earth", [WGS84, WGS84_NORMAL, SPHERE], ids=lambda earth: earth.name)
def test_a_level_flight_at_7_km_per_s(earth, azimuth):
    # What the terms of the navigation frame leave, with hardly any attitude motion: 1e-9 m/s^2.
    motion = FastVehicle(7000.0, swing=(0.0, 0.0, 0.0), earth=earth)
    attitude, velocity, position = largest(flown(motion, 20.0, NAME, azimuth=azimuth), motion)
    assert attitude.max() < 1e-12
    assert velocity.max() < 3e-8
    assert position.max() < 4e-6


@pytest.mark.parametrize("azimuth", AZIMUTHS)
def test_scrolling_pays_where_the_acceleration_changes(azimuth):
    fine, coarse = (
        largest(flown(WEAVE, 20.0, NAME, azimuth=azimuth, position=position), WEAVE)[2].max()
        for position in ("scrolling", "trapezoid")
    )
    assert fine < 0.05 * coarse


def test_more_samples_and_exact_rotation_help_under_attitude_motion():
    errors = {N: largest(flown(SWING, 20.0, NAME, samples=N), SWING) for N in (1, 2)}
    assert errors[1][0].max() > 500 * errors[2][0].max()
    printed = largest(flown(SWING, 20.0, NAME, samples=2, rotation="first-order"), SWING)
    np.testing.assert_allclose(printed[0], errors[2][0], rtol=1e-6)
    assert 10 < printed[1].max() / errors[2][1].max() < 200


def test_both_azimuths_agree():
    """They differ in the order of roundings, and in the second order of n's turn: gravity half-way."""
    attitude, velocity, position = apart(*(flown(HARD, 20.0, NAME, azimuth=azimuth) for azimuth in AZIMUTHS))
    assert attitude < 1e-12
    assert velocity < 1e-6
    assert position < 2e-5


@pytest.mark.parametrize("azimuth", AZIMUTHS)
def test_a_held_height_does_not_disturb_a_level_flight(azimuth):
    free, held = (flown(LEVEL, 20.0, NAME, height=height, azimuth=azimuth) for height in ("free", "held"))
    assert np.abs(held.height - LEVEL.height).max() < 1e-8
    assert np.abs(held.v_n[:, 2]).max() < 1e-11  # of 3 km/s
    assert max(largest(held, LEVEL)[2][:2]) < 1e-5
    assert apart(free, held)[2] < 1e-5


def test_a_free_height_is_unstable_and_a_held_one_is_not():
    motion, dtheta, dvel, dt = at_rest(0.25)
    biased = dvel + np.array([0.0, 0.0, 1e-3]) * dt
    free, held = (
        NavigationFrame(height=height).solve(dtheta, biased, dt, motion.navigation_initial())
        for height in ("free", "held")
    )
    a, rate = 1e-3 * math.cos(0.1) * math.cos(0.2), math.sqrt(2 * 9.81 / 6.37e6)  # upward, and of the growth
    assert free.height[-1] - 100.0 == pytest.approx(a / rate**2 * (math.cosh(rate * 900.0) - 1), rel=0.01)
    assert np.abs(held.height - 100.0).max() < 1e-8


@pytest.mark.parametrize("azimuth", AZIMUTHS)
@pytest.mark.parametrize("every", [2, 5])
def test_n_is_compensated_every_kth_update(every, azimuth):
    options = {"samples": 2, "azimuth": azimuth}
    late, prompt = (flown(SWING, 4.0, NAME, compensate_every=k, **options) for k in (every, 1))
    lag = attitude_error(late.q_eb, prompt.q_eb)
    k = np.arange(len(late)) % every
    # In between the attitude stays behind by the turn of n since, up to 8 arcsec at 3 km/s with k = 5; the rest is
    # what the velocity makes of it: n is reached 2e-8 rad too late.
    if azimuth == "north":
        v, earth = prompt.v_n, prompt.earth
        omega = earth.omega_ie_n(prompt.latitude) + earth.omega_en_n(prompt.latitude, prompt.height, v)
        expected = quat_rotate(prompt.q_en, omega) * (0.02 * k)[:, None]
        np.testing.assert_allclose(lag, expected, rtol=0, atol=5e-8)
    assert np.abs(lag[k == 0]).max() < 5e-8
    assert np.linalg.norm(lag[k == every - 1], axis=1).min() > (every - 1) * 0.02 * 4.5e-4
    # And so the specific force is resolved in axes that are late by half of that on average.
    mean = np.linalg.norm(prompt.v_n[-1] - late.v_n[-1]) / 4.0
    assert mean > 0.5 * 9.8 * 4.5e-4 * 0.02 * (every - 1) / 2


def test_north_passes_a_pole_at_some_distance_and_says_when_it_is_too_close():
    over = GreatCircle(latitude=89.9 * DEG, azimuth=0.0, speed=3000.0)  # 11 km from the pole
    with pytest.raises(
        bench.AccuracyError, match=r"changes its longitude too fast in update .* pole: use azimuth='wander'"
    ):
        flown(over, 5.0, NAME, azimuth="north")
    attitude, _, position = largest(flown(over, 5.0, NAME, azimuth="wander"), over)
    assert attitude.max() < 1e-12
    assert position.max() < 1e-7
    past = GreatCircle(latitude=89.8 * DEG, azimuth=60 * DEG, speed=3000.0)  # 19 km at the closest: 3 mrad an update
    attitude, _, position = largest(flown(past, 8.0, NAME, azimuth="north"), past)
    assert attitude.max() < 1e-12
    assert position.max() < 1e-4


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("rotation", "second-order", "valid: exact, first-order"),
        ("position", "rectangle", "valid: scrolling, trapezoid"),
        ("azimuth", "south", "valid: north, wander"),
        ("compensate_every", 0, "compensate_every must be an integer >= 1, got 0"),
        ("compensate_every", 2.0, "compensate_every must be an integer >= 1, got 2.0"),
    ],
)
def test_wrong_options_are_named(option, value, message):
    with pytest.raises(bench.InputError, match=message):
        bench.solver("navigation", NAME, **{option: value})


@pytest.mark.parametrize("azimuth", AZIMUTHS)
def test_no_trigonometric_function_is_evaluated(azimuth):
    solver, (dtheta, dvel) = NavigationFrame(azimuth=azimuth), swaying(80)
    start = LEVEL.navigation_initial()
    expected = solver.solve(dtheta, dvel, 0.01, start)
    state = solver.start(0.01, start)
    with counting() as tally:
        _, found = solver.advance(state, dtheta, dvel)
    np.testing.assert_allclose(found.r_e, expected.r_e[1:], rtol=0, atol=1e-8)  # compiled, it may round otherwise
    per_update = tally.operations.scaled(1 / 40)
    assert per_update.trigonometric == 0
    assert 500 < per_update.total < 1000


def test_the_attitude_error_of_n_alone_does_not_depend_on_speed():
    """n's turn is compensated at every update: 7 km/s costs no attitude, here within 10 % of the error at 3 km/s."""
    fast = FastVehicle(7000.0)
    slow_error, fast_error = (
        np.linalg.norm(attitude_error(e.q_eb, m.trajectory(e.t).q_eb), axis=1).max()
        for m in (SWING, fast)
        for e in (flown(m, 10.0, NAME, samples=2),)
    )
    assert fast_error == pytest.approx(slow_error, rel=0.1)
