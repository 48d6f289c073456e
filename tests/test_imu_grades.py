"""Sensor grades: a published number recovered from the simulated signal of each, by allantools or directly.

Expected values are written in the publications' own units, or are SI values printed elsewhere (NavToolkit's
documentation), never taken from the grade.
"""

import math
import warnings

import numpy as np
import pytest

from bench import UnknownNameError
from bench.imu.grades import grade, grades
from bench.references import Source

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # allantools' own imports
    import allantools

G = 9.80665
DEG = math.pi / 180


def rest(errors, n, channels, dt, kind="increments", seed=3):
    return errors.apply(np.zeros((n, channels)), dt, kind, seed=seed)


def random_walk_per_sqrt_h(errors, rate=10.0, tau=1.0, channels=60, n=12000):
    """Return the Allan deviation at tau, as a random walk per square root of an hour, and its relative error."""
    values = []
    for channel in rest(errors, n, channels, 1 / rate).T:
        phase = np.concatenate([[0.0], np.cumsum(channel)])
        _, deviation, _, _ = allantools.oadev(phase, rate=rate, data_type="phase", taus=[tau])
        values.append(deviation[0] ** 2 * tau * 3600)
    return math.sqrt(np.mean(values)), np.std(values) / math.sqrt(channels) / np.mean(values) / 2


def triad(errors, n, channels, dt, **keys):
    """As `rest`, for errors that need three channels: many trials side by side."""
    trials = [errors.apply(np.zeros((n, 3)), dt, "increments", seed=3, trial=k, **keys) for k in range(channels // 3)]
    return np.concatenate(trials, axis=1)


def assert_close(found, expected):
    value, error = found
    assert error < 0.01
    assert value == pytest.approx(expected, rel=5 * error)


def assert_std(values, expected):
    n = values.size
    assert abs(np.mean(values**2) / expected**2 - 1) < 5 * math.sqrt(2 / n)


def test_all_grades_are_documented():
    assert set(grades()) == {
        "navigation", "tactical", "industrial-mems", "xu", "wang", "zhao", "lyu", "qin-variance", "qin-density",
    }  # fmt: skip
    for name, item in grades().items():
        assert grade(name) is item
        assert isinstance(item.source, Source)
        assert item.summary
        assert item.stated or item.assumed
        for errors in (item.gyro, item.accelerometer):  # options that are per sensor: they serve any array
            assert errors.models == () or errors.start(3, 0.01, "samples", seed=1)
        item.accelerometer.start(9, 0.01, "samples", seed=1)


def test_an_unknown_grade_lists_the_valid_ones():
    with pytest.raises(UnknownNameError, match=r"unknown sensor grade 'tactial' .did you mean 'tactical'.*navigation"):
        grade("tactial")


def test_navigation():
    item = grade("navigation")
    assert_close(random_walk_per_sqrt_h(item.gyro), 0.002 * DEG)
    assert_close(random_walk_per_sqrt_h(item.gyro), 5.8178e-7 * 60)  # rad/sqrt(s), as NavToolkit prints it
    mean = rest(item.gyro, 1, 20000, 36000.0)[0] / 36000  # ten hours: the random walk is a fifth of the bias
    assert_std(mean, math.hypot(1.6968e-8, 5.8178e-7 / math.sqrt(36000)))
    assert_std(rest(item.accelerometer, 1, 20000, 1.0)[0], 2.4525e-4 * G / 9.81)  # NavToolkit takes g = 9.81
    spun = item.gyro.apply(np.full((1, 20000), 1000.0), 1.0, "increments", seed=1)
    assert_std(spun / 1000 - 1, 5e-6)


def test_tactical():
    item = grade("tactical")
    assert_close(random_walk_per_sqrt_h(item.gyro), 3.6361e-5 * 60)  # rad/sqrt(s), as NavToolkit prints it
    assert_close(random_walk_per_sqrt_h(item.accelerometer), 0.065 * 0.3048)
    assert_close(random_walk_per_sqrt_h(item.accelerometer), 3.302e-4 * 60)
    dt = 1e5  # so long that the bias is all there is
    assert_std(rest(item.gyro, 1, 20000, dt)[0] / dt, 4.8481e-6)
    assert_std(rest(item.accelerometer, 1, 20000, dt)[0] / dt, 9.81e-3 * G / 9.81)


def test_industrial_mems():
    item = grade("industrial-mems")
    assert_close(random_walk_per_sqrt_h(item.accelerometer), 0.008)
    noise = triad(item.gyro, 4000, 90, 0.1)
    values = [
        allantools.oadev(np.cumsum(channel), rate=10.0, data_type="phase", taus=[0.1])[1][0] ** 2 * 0.1 * 3600
        for channel in noise.T
    ]
    assert math.sqrt(np.mean(values)) / DEG == pytest.approx(0.09, rel=0.01)
    # The floor: Allan deviation of 0.8 deg/h, apart from the white noise, at 1893 s.
    floors = {item.gyro: (0.8 * DEG / 3600, 0.09 * DEG / 60), item.accelerometer: (3.2e-6 * G, 0.008 / 60)}
    for errors, (floor, walk) in floors.items():
        tau = 1893.0
        increments = triad(errors, 200, 300, tau / 10)
        found = [
            allantools.oadev(np.cumsum(c), rate=10 / tau, data_type="phase", taus=[tau])[1][0] ** 2
            for c in increments.T
        ]
        variance = np.mean(found) - walk**2 / tau
        assert math.sqrt(variance) == pytest.approx(floor, rel=0.03)  # 5 standard errors
    fast = item.gyro.apply(np.full((10, 3), 10.0), 0.01, "samples", seed=1)
    np.testing.assert_allclose(fast, 125 * DEG, rtol=1e-15)
    hard = item.accelerometer.apply(np.full((10, 9), -100.0), 0.01, "samples", seed=1)
    np.testing.assert_allclose(hard, -8 * G, rtol=1e-15)


def test_xu_counts_arc_seconds():
    item = grade("xu")
    x = np.random.default_rng(1).normal(scale=1e-3, size=(2000, 3))
    seconds = np.degrees(item.gyro.apply(x, 0.001, "increments", seed=1)) * 3600
    np.testing.assert_allclose(seconds, np.rint(seconds), rtol=0, atol=1e-9)
    left = np.cumsum(seconds, axis=0) - np.degrees(np.cumsum(x, axis=0)) * 3600
    assert 0.49 < np.abs(left).max() <= 0.5 + 1e-6
    assert item.accelerometer.models == ()


def test_wang_is_perfect():
    x = np.random.default_rng(1).normal(size=(20, 3))
    for errors in (grade("wang").gyro, grade("wang").accelerometer):
        np.testing.assert_array_equal(errors.apply(x, 0.01, "samples", seed=1), x)


def test_zhao_drifts():
    item = grade("zhao")
    hour = rest(item.gyro, 3600, 3, 1.0).sum(axis=0)
    np.testing.assert_allclose(np.degrees(hour), 0.005, rtol=1e-12)
    np.testing.assert_allclose(rest(item.accelerometer, 5, 3, 0.01, "samples"), 5e-5 * G, rtol=1e-12)


def test_lyu():
    item = grade("lyu")
    assert_close(random_walk_per_sqrt_h(item.gyro), 0.01 * DEG)
    assert_close(random_walk_per_sqrt_h(item.accelerometer), 0.05e-3 * G * 60)
    dt = 1e8
    assert_std(np.degrees(rest(item.gyro, 1, 20000, dt)[0]) / dt * 3600, 0.025)
    assert_std(rest(item.accelerometer, 1, 20000, dt)[0] / dt / G, 0.1e-3)


@pytest.mark.parametrize(("name", "variance"), [("qin-variance", 2e-10), ("qin-density", 2e-10 / 0.01)])
def test_qin(name, variance):
    item = grade(name)
    samples = rest(item.accelerometer, 6000, 900, 0.01, "samples")
    noise = samples - samples.mean(axis=0)
    assert abs((noise**2).sum() / (variance * 5999 * 900) - 1) < 5 * math.sqrt(2 / noise.size)
    # Biases are +-1.5e-5; the mean over 60 s is uncertain by 1.1e-5 with the density, where the signs blur.
    spread = math.sqrt(variance / 6000)
    assert_std(samples.mean(axis=0), math.hypot(1.5e-5, spread))
    if name == "qin-variance":
        assert np.abs(np.abs(samples.mean(axis=0)) - 1.5e-5).max() < 6 * spread
        assert 350 < (samples.mean(axis=0) > 0).sum() < 550
