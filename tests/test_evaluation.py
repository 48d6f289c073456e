"""Errors and statistics against SciPy and closed forms."""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid
from scipy.spatial.transform import Rotation
from scipy.stats import percentileofscore

import bench
from bench.evaluation import (
    attitude_error,
    euler_error,
    integrated_rate_error,
    percentile_of,
    percentiles,
    rms,
    vector_error,
)

RNG = np.random.default_rng(3)


def wxyz(rotation):
    return rotation.as_quat(scalar_first=True)


def test_attitude_error_is_the_rotation_in_n_from_true_to_estimate():
    true = Rotation.random(50, rng=RNG)
    error = RNG.normal(scale=0.5, size=(50, 3))
    estimate = Rotation.from_rotvec(error) * true
    np.testing.assert_allclose(attitude_error(wxyz(estimate), wxyz(true)), error, rtol=0, atol=1e-14)  # rad
    np.testing.assert_allclose(attitude_error(-wxyz(estimate), wxyz(true)), error, rtol=0, atol=1e-14)


def test_euler_error_is_wrapped():
    # Yaw from 179 to -179 degrees is an error of 2 degrees; SciPy's intrinsic "ZXY" is the bench's sequence.
    true = Rotation.from_euler("ZXY", [[179, 10, -170]], degrees=True)
    estimate = Rotation.from_euler("ZXY", [[-179, 9, 175]], degrees=True)
    np.testing.assert_allclose(np.degrees(euler_error(wxyz(estimate), wxyz(true))), [[2, -1, -15]], rtol=0, atol=1e-10)


def test_integrated_rate_error_is_the_trapezoidal_integral():
    est, true = RNG.normal(size=(2, 30, 3))
    expected = cumulative_trapezoid(est - true, dx=0.01, axis=0, initial=0)
    np.testing.assert_allclose(integrated_rate_error(est, true, 0.01), expected, rtol=0, atol=1e-15)


def test_vector_error():
    np.testing.assert_array_equal(vector_error([[1, 2, 3]], [[0, 4, 3]]), [[1, -2, 0]])


def test_rms_over_trials_survives_extremes():
    np.testing.assert_allclose(rms([[3.0, 0.0], [4.0, 0.0]]), [np.sqrt(12.5), 0.0], rtol=1e-15)
    np.testing.assert_allclose(rms([3e200, 4e200]), np.sqrt(12.5) * 1e200, rtol=1e-15)


def test_percentiles_are_along_trials():
    values = np.arange(101.0)[:, None] * [1.0, 10.0]
    np.testing.assert_allclose(percentiles(values, [5, 50, 95]), [[5, 50], [50, 500], [95, 950]], rtol=1e-14)
    np.testing.assert_allclose(percentiles(values, 50), [50, 500], rtol=1e-14)


def test_percentile_of_agrees_with_scipy():
    samples = RNG.integers(0, 20, 200).astype(float)
    for published in (-1.0, 0.0, 7.0, 7.5, 30.0):
        expected = percentileofscore(samples, published, kind="mean") / 100
        np.testing.assert_allclose(percentile_of(published, samples), expected, rtol=0, atol=1e-12)
    many = np.stack([samples, 2 * samples], axis=1)
    np.testing.assert_array_equal(
        percentile_of([7.0, 7.0], many), [percentile_of(7.0, samples), percentile_of(3.5, samples)]
    )


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: attitude_error([[1, 0, 0, 0]], [[1, 0, 0, 0]] * 2), "q_est and q_true must have the same shape"),
        (lambda: attitude_error([[2, 0, 0, 0]], [[1, 0, 0, 0]]), "q_est must be unit quaternions .*2.0"),
        (lambda: euler_error([[1, 0, 0, 0]], [[1, 0, 0]]), "q_true must have shape"),
        (lambda: integrated_rate_error([[1, 0, 0]], [[1, 0, 0]], 0), "dt must be a positive number, got 0"),
        (lambda: integrated_rate_error([[1, 0, np.nan]], [[1, 0, 0]], 1), "omega_est must be finite"),
        (lambda: vector_error([[1, 0, 0]], [[1, 0, 0]] * 2), "estimate and truth must have the same shape"),
        (lambda: percentiles([1.0, 2.0], [50, 101]), "levels must be percentages .*101"),
        (lambda: percentiles([], 50), "values must not be empty"),
        (lambda: rms([1.0, np.inf]), "values must be finite"),
        (lambda: percentile_of([1.0, 2.0], [[1.0], [2.0]]), r"published must have shape \(1,\)"),
        (lambda: percentile_of(1.0, []), "samples must not be empty"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(bench.InputError, match=message):
        call()
