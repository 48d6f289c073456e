"""Measured orders of the attitude solvers: the fitted slope is the declared order within 0.2.

Motion: coning with a half angle of 20 degrees at 1 Hz for 6 s, in closed form (attitude and increments), N samples
an update, 5 to 256 updates a second. Periodic error: RMS of the error with its linear drift removed; drift: slope of
the yaw error. Of the steps whose errors are above rounding the eight finest are used, and
log error = p log h + c + b h^2 is fitted: the last term is what the error holds of the next order.
A second motion, the large-angle manoeuvre, has the periodic orders too; truth there is the reference solution of the
motion, which its own tests hold against mpmath.
"""

import math

import mpmath
import numpy as np
import pytest

import bench
from bench.evaluation import attitude_error
from bench.motion.coning import Coning
from bench.motion.savage_manoeuvre import SavageManoeuvre
from bench.solvers import solvers
from tests.attitude_cases import variants, window
from tests.solver_cases import label

CYCLES = 6
UPDATES = np.array([*range(5, 17), 18, 20, 24, 28, 32, 40, 48, 64, 80, 96, 128, 192, 256])  # a second
CONING = Coning(math.radians(20), 2 * math.pi)
ROUNDING = 1.1e-16  # rad an update; they add up as a random walk
FINEST = 8


def measurable():
    """Return the solvers that declare orders, over all options that change them."""
    found = []
    for name in sorted(solvers("attitude")):
        found += [s for s in variants(name) if s.order_periodic is not None and getattr(s, "terms", None) is None]
    return found


def coning_errors(solver, updates):
    """Return the periodic error, rad, and the drift, rad/s, with some updates a second."""
    N, rate = solver.samples, float(updates * solver.samples)
    truth = CONING.kinematics(np.arange(CYCLES * updates + 1) / updates).q_ib
    dtheta = CONING.increments(rate, CYCLES * updates * N)
    error = attitude_error(solver.solve(dtheta, 1 / rate, truth[0]), truth)
    t = np.arange(len(error)) / updates
    edge = -(-window(solver) // N) if sum(solver.borrowed) else 0  # the ends use one-sided windows
    error, t = error[edge : len(error) - edge], t[edge : len(t) - edge]
    drift, start = np.polyfit(t, error, 1)
    periodic = error - (t[:, None] * drift + start)
    return math.sqrt((periodic**2).sum(axis=1).mean()), abs(drift[2])


def fitted_order(updates, errors, floor):
    """Return the order and the steps it is fitted to; None if fewer than four lie above the floor."""
    above = errors > floor
    end = len(errors) if above.all() else int(np.argmin(above))
    if end < 4:
        return None
    used = slice(max(0, end - FINEST), end)
    u, e = updates[used].astype(float), errors[used]
    terms = np.stack([np.ones(len(u)), -np.log(u), u**-2.0], axis=1)
    return np.linalg.lstsq(terms, np.log(e), rcond=None)[0][1], u


@pytest.mark.parametrize("solver", measurable(), ids=label)
def test_orders_on_coning_are_the_declared_ones(solver):
    errors = np.array([coning_errors(solver, u) for u in UPDATES])
    walk = 15 * ROUNDING * np.sqrt(CYCLES * UPDATES)
    for kind, column, floor, declared in (
        ("periodic", 0, walk, solver.order_periodic),
        ("drift", 1, 0.3 * walk, solver.order_drift),
    ):
        if declared is None:
            continue
        fit = fitted_order(UPDATES, errors[:, column], floor)
        if fit is None:
            assert declared >= 10, f"{kind}: no slope to fit, errors {errors[:, column]}"
        else:
            order, used = fit
            assert abs(order - declared) < 0.2, f"{kind}: fitted {order:.2f} over {used} updates/s, not {declared}"


MANOEUVRE_UPDATES = np.array([24, 30, 36, 42, 48, 60, 72, 84, 96, 120, 144, 192, 240, 300, 384, 480, 600])  # in 1.2 s


@pytest.mark.parametrize(
    "solver", [s for s in measurable() if s.samples in (2, 3, 4, 5) and not sum(s.borrowed)], ids=label
)
def test_periodic_orders_hold_on_the_manoeuvre(solver):
    motion, errors = SavageManoeuvre(), []
    for updates in MANOEUVRE_UPDATES:
        rate = float(updates * solver.samples) / 1.2
        truth = motion.kinematics(1.2 * np.arange(updates + 1) / updates).q_ib
        q = solver.solve(motion.increments(rate, updates * solver.samples), 1 / rate, truth[0])
        errors.append(np.linalg.norm(attitude_error(q, truth), axis=1).max())
    order, used = fitted_order(MANOEUVRE_UPDATES, np.array(errors), 15 * ROUNDING * np.sqrt(MANOEUVRE_UPDATES))
    assert abs(order - solver.order_periodic) < 0.2, f"fitted {order:.2f} over {used} updates in 1.2 s"


PRINTED = {  # k_p of the coning-optimised sets, as printed (Miller, Lee, Ignagni)
    2: ["2/3"],
    3: ["9/20", "27/20"],
    4: ["54/105", "92/105", "214/105"],
    5: ["250/504", "525/504", "650/504", "1375/504"],
    6: ["2315/4620", "4558/4620", "7296/4620", "7834/4620", "15797/4620"],
}


def theoretical_drift(N, lam, half_angle):
    """Return |drift| per update on a small cone, rad: a^2/2 [N lam - sin N lam - sum k_p (...)] at 50 digits."""
    with mpmath.workdps(50):
        lam, total = mpmath.mpf(lam), mpmath.mpf(0)
        for p, k in enumerate(reversed(PRINTED[N]), 1):
            top, bottom = map(mpmath.mpf, k.split("/"))
            v = 4 * mpmath.sin(p * lam) - 2 * mpmath.sin((p + 1) * lam) - 2 * mpmath.sin((p - 1) * lam)
            total += top / bottom * v
        return abs(float(mpmath.mpf(half_angle) ** 2 / 2 * (N * lam - mpmath.sin(N * lam) - total)))


@pytest.mark.parametrize("coefficients", ["coning-optimised", "coning-manoeuvre-exact"])
@pytest.mark.parametrize("lam", [0.3, 0.6, 1.0])
@pytest.mark.parametrize("N", sorted(PRINTED))
def test_coning_optimised_drift_is_the_theoretical_residual(N, lam, coefficients):
    # A cone so small that the a^4 terms of all orders in h stay below 3 %, as long as the residual is above rounding.
    half_angle, updates = 1e-4, 2000
    expected = theoretical_drift(N, lam, half_angle)
    if expected < 1e-15:  # a slope over 2000 updates is good to some 1e-17 rad an update
        assert N >= 4
        assert lam < 0.5
        return
    coning = Coning(half_angle, lam)  # sampled once a second
    truth = coning.kinematics(np.arange(updates + 1.0) * N).q_ib
    solver = bench.solver("attitude", "rotation-vector", samples=N, coefficients=coefficients)
    error = attitude_error(solver.solve(coning.increments(1.0, updates * N), 1.0, truth[0]), truth)
    drift = abs(np.polyfit(np.arange(updates + 1), error[:, 2], 1)[0])
    assert abs(drift - expected) < 0.03 * expected, f"drift {drift:.4g} rad per update, theory {expected:.4g}"
