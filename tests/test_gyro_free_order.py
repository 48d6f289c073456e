"""Measured order of the gyro-free solvers: the fitted slope is the declared order within 0.2.

Truth is SciPy's DOP853 on q' = q o omega/2, v' = C f + g, p' = v with rtol 1e-13, from a hand-written motion.
Range: 25 to 200 Hz for a motion of up to 4 rad/s at 0.2 to 0.6 Hz; above, the rounding of the roots shows.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import bench
from bench.solvers import solvers
from bench.solvers.gyro_free import INTEGRATIONS
from tests.gyro_free_cases import GRAVITY, Wave, fitting

DURATION = 8.0
STEPS = DURATION / np.array([200, 400, 800, 1600])
WAVE = Wave(2, mean=1.6, swing=0.4)  # no rate crosses zero: a root there costs half the digits


@pytest.fixture(scope="module")
def truth():
    initial = WAVE.initial()

    def rates(t, y):
        q = y[:4] / np.linalg.norm(y[:4])
        w, x, yy, z = q
        a, b, c = WAVE.omega(t)
        dq = 0.5 * np.array(
            [-x * a - yy * b - z * c, w * a + yy * c - z * b, w * b + z * a - x * c, w * c + x * b - yy * a]
        )
        return np.concatenate([dq, Rotation.from_quat(q, scalar_first=True).apply(WAVE.f(t)) + GRAVITY, y[4:7]])

    start = np.concatenate([initial.q_ib, initial.velocity, initial.position])
    end = solve_ivp(rates, (0, DURATION), start, method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    return Rotation.from_quat(end[:4], scalar_first=True), end[4:7], end[7:]


@pytest.mark.parametrize("integration", sorted(INTEGRATIONS))
@pytest.mark.parametrize("name", sorted(solvers("gyro-free")))
def test_fitted_order_is_the_declared_one(name, integration, truth):
    attitude, velocity, position = truth
    there = fitting(name)
    errors = []
    for dt in STEPS:
        t = dt * np.arange(round(DURATION / dt) + 1)
        solver = bench.solver("gyro-free", name, integration=integration)
        end = solver.solve(there, WAVE.readings(there, t), dt, WAVE.initial())
        errors.append(
            [
                (Rotation.from_quat(end.q_ib[-1], scalar_first=True) * attitude.inv()).magnitude(),
                np.linalg.norm(end.velocity[-1] - velocity),
                np.linalg.norm(end.position[-1] - position),
            ]
        )
    declared = INTEGRATIONS[integration]
    steps, errors = (STEPS, np.array(errors)) if declared == 4 else (STEPS[1:], np.array(errors)[1:])
    slopes = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert np.abs(slopes - declared).max() < 0.2, f"slopes {slopes}, errors {errors}"
