"""Measured orders of the navigation solvers: the lowest fitted slope is the declared order within 0.2.

Motion: a level flight at 200 m/s that weaves by some ten metres and swings by some 20 degrees, at 0.5 to 1.1 Hz, for
6 s. Truth: its closed form; increments: MuJoCo's at 1200 Hz, summed over 2 to 240 intervals. Errors: RMS over the
flight of attitude, velocity and position. Of the updates (7 to 250 ms) whose errors are above rounding the eight
shortest are used, and log error = p log T + c + b T^2 is fitted: the last term is what the error holds of the next
order. An error that is above rounding in few updates only is of a higher order than those of the others.
"""

from dataclasses import fields
from functools import cache

import numpy as np
import pytest

from bench.motion.fast_vehicle import FastVehicle
from bench.solvers import solvers
from bench.trajectory import navigation_errors
from tests.inertial_cases import sensed
from tests.navigation_cases import all_variants
from tests.solver_cases import label

MOTION = FastVehicle(
    speed=200.0,
    height=3000.0,
    weave=(30.0, 20.0, 10.0),
    weave_frequency=(3.0, 4.0, 5.0),
    swing=(0.5, 0.3, 0.4),
    swing_frequency=(5.0, 6.0, 7.0),
)
DURATION, RATE = 6.0, 1200.0
SUMMED = [
    2,
    3,
    4,
    5,
    6,
    8,
    10,
    12,
    15,
    16,
    20,
    24,
    25,
    30,
    36,
    40,
    48,
    50,
    60,
    72,
    75,
    80,
    90,
    96,
    100,
    120,
    144,
    150,
    180,
    240,
]
SHORTEST, LONGEST = 0.006, 0.25  # s, of an update
ROUNDING = np.array([1e-12, 3e-9, 3e-7])  # rad, m/s, m: 30 times what roundings add up to
FEWEST, FINEST = 6, 8


def measurable():
    """Return the solvers with a free height that declare an order; a window is that of the update's own increments."""
    found = [s for s in all_variants((1, 2, 3, 4, 8)) if s.height == "free"]
    for cls in solvers("navigation").values():
        if "window" in {field.name for field in fields(cls)}:
            found += [cls(samples=N, window=N) for N in (1, 2, 3, 4)]
    # From order 10 the errors fall to rounding within a factor of two in T.
    return [s for s in dict.fromkeys(found) if s.order_periodic is not None and s.order_periodic < 10]


@cache
def summed(count, n):
    """Return n increments, each the sum of `count` of MuJoCo's."""
    increments = sensed(MOTION, DURATION, RATE)
    parts = increments.dtheta_b, increments.dvel
    return tuple(part[: n * count].reshape(n, count, 3).sum(axis=1) for part in parts)


@cache
def truth(step, rows):
    return MOTION.trajectory(np.arange(rows) * step)


def rms_errors(solver, count):
    n = int(DURATION * RATE) // (count * solver.samples) * solver.samples
    estimate = solver.solve(*summed(count, n), count / RATE, MOTION.navigation_initial(), MOTION.earth)
    errors = navigation_errors(estimate, truth(count * solver.samples / RATE, len(estimate)))
    return [np.sqrt((part**2).sum(axis=1).mean()) for part in (errors.attitude, errors.velocity, errors.position)]


def fitted_order(T, errors, rounding):
    """Return the slope at small steps, None if there are too few of them above rounding."""
    used = np.flatnonzero(errors > rounding)[:FINEST]
    if len(used) < FEWEST:
        return None
    terms = np.stack([np.log(T[used]), np.ones(len(used)), T[used] ** 2], axis=1)
    return float(np.linalg.lstsq(terms, np.log(errors[used]), rcond=None)[0][0])


@pytest.mark.parametrize("solver", measurable(), ids=label)
def test_the_lowest_order_is_the_declared_one(solver):
    steps = [(count, count * solver.samples / RATE) for count in SUMMED]
    steps = [(count, T) for count, T in steps if SHORTEST < T < LONGEST]
    errors = np.array([rms_errors(solver, count) for count, _ in steps])
    T = np.array([T for _, T in steps])
    orders = [fitted_order(T, errors[:, k], ROUNDING[k]) for k in range(3)]
    lowest = min(order for order in orders if order is not None)
    assert abs(lowest - solver.order_periodic) < 0.2, f"attitude, velocity, position: {orders}"
