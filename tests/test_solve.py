"""Solving a recording. Truth: a unit that stands, in closed form; an added bias; rotations of scipy."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import bench
from bench.earth import SPHERE
from bench.errors import InputError, UnknownNameError
from bench.recording import Recording
from bench.solve import find_solver, solve_recording, without_bias
from bench.solvers.attitude import AttitudeSolver
from bench.trajectory import Trajectory
from bench.units import ARCSEC
from tests.recorded_cases import LATITUDE, OMEGA_B, as_rates, initial, standing, truth

INS = bench.solver("navigation", "navigation-frame", samples=2)
ATTITUDE = bench.solver("attitude", "rotation-vector", samples=3)


def rotation(q):
    return Rotation.from_quat(np.roll(q, -1, axis=-1))


def test_a_unit_that_stands_stays_where_it_is():
    solution = solve_recording(standing(), INS, initial())
    found, true = solution.trajectory, truth(solution.trajectory.t)
    np.testing.assert_allclose(found.r_e, true.r_e, atol=1e-6)  # m; 10 s, a micro-g would make 0.5 mm
    np.testing.assert_allclose(found.v_e, 0, atol=1e-7)
    assert (rotation(found.q_eb) * rotation(true.q_eb).inv()).magnitude().max() < 1e-6 * ARCSEC
    assert (solution.used, solution.left_over, solution.attitude_only, solution.comparison) == (1000, 0, False, None)


def test_the_same_bits_as_the_solver_itself():
    recording = standing()
    solution = solve_recording(recording, INS, initial())
    alone = INS.solve(recording.angular, recording.specific, recording.dt, initial())
    np.testing.assert_array_equal(solution.trajectory.r_e, alone.r_e)
    np.testing.assert_array_equal(solution.trajectory.q_eb, alone.q_eb)


def test_an_attitude_solver_turns_with_the_earth():
    solution = solve_recording(standing(), ATTITUDE, initial())
    found = solution.trajectory
    assert solution.attitude_only
    assert (rotation(found.q_nb) * rotation(truth(found.t).q_nb).inv()).magnitude().max() < 1e-8 * ARCSEC
    np.testing.assert_array_equal(found.v_e, np.zeros((len(found), 3)))
    np.testing.assert_allclose(found.latitude, LATITUDE, rtol=1e-15)
    # On an Earth that does not turn at all the standing unit would turn by what its gyro sees.
    still = replace(SPHERE, rate=0.0)
    q = solve_recording(standing(), ATTITUDE, initial(), still).trajectory.q_eb
    turned = (rotation(q[0]).inv() * rotation(q[-1])).as_rotvec()
    np.testing.assert_allclose(turned, OMEGA_B * 9.99, rtol=1e-9)


def test_times_are_the_recordings_and_leftovers_are_counted():
    plain = standing(101)
    stamps = plain.t + 0.002 * np.sin(np.arange(101))  # jitter of the clock
    recording = Recording(stamps, plain.angular, plain.specific, "increments", jitter=0.4)
    solution = solve_recording(recording, ATTITUDE, initial())
    assert (solution.used, solution.left_over) == (99, 2)
    np.testing.assert_array_equal(solution.trajectory.t, np.append(recording.start, stamps[2:99:3]))


def test_biases_are_taken_off():
    gyro, accelerometer = np.array([1e-4, -2e-4, 3e-4]), np.array([0.01, 0.02, -0.03])
    plain = standing()
    biased = Recording(
        plain.t, plain.angular + gyro * plain.dt, plain.specific + accelerometer * plain.dt, "increments", plain.dt
    )
    mended = solve_recording(biased, INS, initial(), gyro_bias=gyro, accelerometer_bias=accelerometer)
    np.testing.assert_allclose(mended.trajectory.r_e, truth(mended.trajectory.t).r_e, atol=1e-6)
    wrong = solve_recording(biased, INS, initial()).trajectory
    assert np.linalg.norm(wrong.r_e[-1] - wrong.r_e[0]) > 0.5 * 0.03 * 10**2  # m
    assert without_bias(plain, np.zeros(3), np.zeros(3)) is plain


def test_rates_need_a_rule():
    rates = as_rates(standing())
    found = solve_recording(rates, INS, initial(), rule="trapezoid").trajectory
    np.testing.assert_allclose(found.r_e, truth(found.t).r_e, atol=1e-6)
    with pytest.raises(InputError, match="rule must say how to integrate the rates"):
        solve_recording(rates, INS, initial())
    with pytest.raises(InputError, match="rule must not be given"):
        solve_recording(standing(), INS, initial(), rule="spline")


def test_errors_against_a_reference():
    true = truth(50.0 + np.arange(0, 11))
    east = rotation(true.q_en[0]).as_matrix()[:, 0]
    reference = Trajectory(true.earth, true.t, true.q_eb, true.v_e, true.r_e - 3.0 * east)
    comparison = solve_recording(standing(), INS, initial(), reference=reference).comparison
    np.testing.assert_allclose(comparison.errors.position, np.tile([3.0, 0, 0], (11, 1)), atol=2e-6)
    assert comparison.matched == 11


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"recording": None}, "recording must be a Recording, got None"),
        (
            {"solver": "navigation-frame"},
            "solver must be a NavigationSolver or an AttitudeSolver, got 'navigation-frame'",
        ),
        ({"initial": (1, 2)}, "initial must be"),
        ({"earth": "wgs84"}, "earth must be an Earth, got 'wgs84'"),
        ({"gyro_bias": 1e-5}, r"gyro_bias must have shape \(3,\)"),
        ({"accelerometer_bias": [np.nan, 0, 0]}, "accelerometer_bias must be finite"),
        ({"recording": standing(2), "solver": ATTITUDE}, "at least samples = 3 increments, got 2"),
        ({"reference": truth(np.array([0.0, 1.0]))}, "reference must overlap the solution"),
    ],
)
def test_bad_input_is_named(change, message):
    arguments = {"recording": standing(10), "solver": INS, "initial": initial(), **change}
    with pytest.raises(InputError, match=message):
        solve_recording(**arguments)


def test_solvers_are_found_by_name():
    assert find_solver("rotation-vector") == ("attitude", type(ATTITUDE))
    assert find_solver("navigation/navigation-frame") == ("navigation", type(INS))
    with pytest.raises(UnknownNameError, match=r"unknown solver 'navigation-fram' \(did you mean 'navigation-frame'"):
        find_solver("navigation-fram")
    with pytest.raises(UnknownNameError, match="unknown solver 'gyro-free/nine-accelerometer'"):
        find_solver("gyro-free/nine-accelerometer")


def test_a_name_of_both_kinds_must_say_which(monkeypatch):
    import bench.solve

    class Twin(AttitudeSolver):
        pass

    monkeypatch.setattr(bench.solve, "solvers", lambda kind: {"twin": Twin})
    with pytest.raises(InputError, match="navigation/twin or attitude/twin, got 'twin'"):
        find_solver("twin")
    assert find_solver("attitude/twin") == ("attitude", Twin)
