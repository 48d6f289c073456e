"""Noise models by their Allan deviation: allantools (overlapping estimator) against closed forms.

Samples go in as a frequency record, increments as a phase record (their running sum), so that the two kinds
are judged by one law. Every curve is the mean of the Allan variances of many independent channels, and its
standard error is taken from their spread: theory must lie within five of them, and they must be small.
"""

import warnings

import numpy as np
import pytest

from bench.imu import SensorErrors
from bench.imu.gauss_markov import GaussMarkov
from bench.imu.quantisation import Quantisation
from bench.imu.random_walk import RandomWalk
from bench.imu.white_noise import WhiteNoise

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # allantools' own imports
    import allantools

KINDS = ("samples", "increments")
RATE = 50.0


def allan_variance(errors, kind, taus):
    """Return mean and standard error over the channels of the overlapping Allan variance, (taus,) each."""
    curves = []
    for channel in errors.T:
        data = channel if kind == "samples" else np.concatenate([[0.0], np.cumsum(channel)])
        data_type = "freq" if kind == "samples" else "phase"
        found, deviation, _, _ = allantools.oadev(data, rate=RATE, data_type=data_type, taus=taus)
        np.testing.assert_allclose(found, taus)
        curves.append(deviation**2)
    return np.mean(curves, axis=0), np.std(curves, axis=0, ddof=1) / np.sqrt(len(curves))


def assert_allan(model, kind, theory, taus, *, n=20000, channels=60, within=0.05):
    errors = SensorErrors((model,)).apply(np.zeros((n, channels)), 1 / RATE, kind, seed=11)
    taus = np.array(taus)
    variance, error = allan_variance(errors, kind, taus)
    expected = theory(taus) ** 2
    assert (error < within * expected).all()  # so that the next line means something
    assert (np.abs(variance - expected) < 5 * error).all()


@pytest.mark.parametrize("kind", KINDS)
def test_white_noise_density(kind):
    assert_allan(WhiteNoise(density=0.3), kind, lambda T: 0.3 / np.sqrt(T), [0.02, 0.2, 2.0, 8.0])


@pytest.mark.parametrize("kind", KINDS)
def test_white_noise_of_readings(kind):
    model = WhiteNoise(sample_std=0.3)
    assert_allan(model, kind, lambda T: 0.3 / np.sqrt(RATE * T), [0.02, 0.2, 2.0, 8.0])


# Means over T of samples differ from the mean of the process by (dt/T)^2: samples are judged from 20 dt up.
@pytest.mark.parametrize(("kind", "taus"), [("samples", [0.4, 2.0, 8.0]), ("increments", [0.02, 0.2, 2.0, 8.0])])
def test_gauss_markov(kind, taus):
    sigma, tau = 0.3, 1.5

    def theory(T):
        u = T / tau
        return sigma * np.sqrt(2 / u * (1 - (3 - 4 * np.exp(-u) + np.exp(-2 * u)) / (2 * u)))

    assert_allan(GaussMarkov(std=sigma, tau=tau), kind, theory, taus)


@pytest.mark.parametrize(("kind", "taus"), [("samples", [0.4, 2.0, 8.0]), ("increments", [0.02, 0.2, 2.0, 8.0])])
def test_random_walk(kind, taus):
    assert_allan(RandomWalk(density=0.3), kind, lambda T: 0.3 * np.sqrt(T / 3), taus)


@pytest.mark.parametrize("kind", KINDS)
def test_counted_quanta(kind):
    quantum, n, channels = 1e-3, 20000, 40
    motion = np.random.default_rng(1).normal(scale=0.02, size=(n, channels))  # 20 quanta: an even residue
    motion *= RATE if kind == "samples" else 1.0
    counted = SensorErrors((Quantisation(quantum=quantum),)).apply(motion, 1 / RATE, kind, seed=2)
    taus = np.array([0.02, 0.2, 2.0])
    variance, error = allan_variance(counted - motion, kind, taus)
    # White phase of variance q^2/12: the Allan deviation is sqrt(3) (q / sqrt 12) / T = q / (2 T).
    expected = (quantum / (2 * taus)) ** 2
    assert (error < 0.02 * expected).all()
    assert (np.abs(variance - expected) < 5 * error).all()


def test_the_two_kinds_of_quantisation_differ_in_slope():
    n = 20000
    motion = np.random.default_rng(1).normal(scale=0.02, size=(n, 10))
    taus = np.array([0.02, 2.0])
    slopes = []
    for model in (Quantisation(quantum=1e-3), Quantisation(step=1e-3 * RATE)):
        error = SensorErrors((model,)).apply(motion, 1 / RATE, "increments", seed=2) - motion
        variance, _ = allan_variance(error, "increments", taus)
        slopes.append(np.log(variance[1] / variance[0]) / (2 * np.log(taus[1] / taus[0])))
    np.testing.assert_allclose(slopes, [-1.0, -0.5], rtol=0, atol=0.02)
