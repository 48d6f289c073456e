"""Each error model alone: laws, statistics with stated confidence, kinds, chunks, bad input.

Statistics: fixed seeds, bounds of five standard deviations of the estimate (a chance of 6e-7 each, had the
seed been free). Truth: closed forms, mpmath, exact integers, scipy.signal.lsim.
"""

import math

import mpmath
import numpy as np
import pytest
from scipy import signal as scipy_signal
from scipy import stats

from bench import Accelerometers, InputError, UnknownNameError
from bench.imu import SensorErrors, Stream, error_models
from bench.imu.bandwidth import Bandwidth
from bench.imu.g_sensitivity import GSensitivity
from bench.imu.gauss_markov import ALLAN_PEAK, GaussMarkov, _own_variance
from bench.imu.misalignment import Misalignment
from bench.imu.mounting import Mounting
from bench.imu.quantisation import Quantisation
from bench.imu.random_walk import RandomWalk
from bench.imu.saturation import Saturation
from bench.imu.scale_factor import ScaleFactor
from bench.imu.turn_on_bias import TurnOnBias
from bench.imu.white_noise import WhiteNoise

KINDS = ("samples", "increments")
DT = 0.01
EPS = np.finfo(float).eps

MODELS = [
    Bandwidth(cutoff=20.0),
    GSensitivity(value=1e-4, std=1e-5),
    GaussMarkov(std=1e-3, tau=3.0),
    Misalignment(std=1e-3),
    Quantisation(quantum=1e-4, random_phase=True),
    Quantisation(step=1e-2),
    RandomWalk(density=1e-3),
    Saturation(limit=0.7),
    ScaleFactor(std=1e-3, quadratic_std=1e-2),
    TurnOnBias(value=1e-2, std=1e-3, random_sign=True),
    WhiteNoise(density=1e-3),
    WhiteNoise(sample_std=1e-3),
]


def model_id(model):
    return repr(model).split("(")[0] + ("-" + model.name)


def wave(n=300, kind="samples", channels=3):
    """A signal that crosses zero and the saturation limit."""
    t = DT * np.arange(n)
    rates = np.stack([np.sin((3.0 + k) * t + k) for k in range(channels)], axis=1)
    return np.ascontiguousarray(rates * (DT if kind == "increments" else 1.0))


def run(models, x, kind="samples", dt=DT, seed=1, **keys):
    return SensorErrors(tuple(models)).apply(x, dt, kind, seed=seed, **keys)


def many(model, n, kind, channels, dt=DT, seed=5):
    """What the model adds to zero, for many independent channels."""
    return run([model], np.zeros((n, channels)), kind, dt, seed)


def assert_covariance(x, expected):
    """Check the covariances of the rows' entries over many channels, x (n, channels), zero mean, normal."""
    found = x @ x.T / x.shape[1]
    variance = np.diag(expected)
    std = np.sqrt((np.outer(variance, variance) + expected**2) / x.shape[1])  # Wishart
    assert np.all(np.abs(found - expected) <= 5 * std)


# --- all models


def test_every_model_is_covered():
    assert {model.name for model in MODELS} == set(error_models())


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("model", MODELS, ids=model_id)
def test_any_chunking_gives_the_same_bits(model, kind):
    x, f = wave(kind=kind), wave(kind=kind)[:, ::-1].copy()
    errors = SensorErrors((model, model))
    whole = errors.apply(x, DT, kind, seed=3, specific_force=f)
    for size in (1, 7, 128):
        state = errors.start(3, DT, kind, seed=3)
        parts = []
        for k in range(0, len(x), size):
            state, part = errors.advance(state, x[k : k + size], f[k : k + size])
            parts.append(part)
        np.testing.assert_array_equal(np.concatenate(parts), whole)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("model", MODELS, ids=model_id)
def test_states_and_inputs_are_never_modified(model, kind):
    x, f = wave(kind=kind), wave(kind=kind)
    kept = x.copy(), f.copy()
    x.flags.writeable = f.flags.writeable = False  # read-only input is fine too
    errors = SensorErrors((model,))
    first = errors.start(3, DT, kind, seed=3)
    middle, a = errors.advance(first, x, f)
    _, b = errors.advance(first, x, f)
    _, c = errors.advance(middle, x, f)
    _, d = errors.advance(middle, x, f)
    np.testing.assert_array_equal(a, b)
    np.testing.assert_array_equal(c, d)
    np.testing.assert_array_equal(x, kept[0])
    np.testing.assert_array_equal(f, kept[1])
    assert a is not x
    assert not np.shares_memory(a, x)
    assert np.abs(a - x).max() > 0  # each of these models does something


@pytest.mark.parametrize("model", MODELS, ids=model_id)
def test_the_same_seed_gives_the_same_bits_and_another_does_not(model):
    x = wave()
    keys = {"specific_force": wave()}
    np.testing.assert_array_equal(run([model], x, seed=8, **keys), run([model], x, seed=8, **keys))
    if isinstance(model, Bandwidth | Saturation) or model == Quantisation(step=1e-2):
        return  # nothing random in them
    reference = run([model], x, seed=8, trial=1, sensor=1, **keys)
    for other in ({"seed": 9, "trial": 1, "sensor": 1}, {"seed": 8, "trial": 2, "sensor": 1}, {"seed": 8, "trial": 1}):
        assert np.abs(run([model], x, **other, **keys) - reference).max() > 0


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "off",
    [
        GSensitivity(),
        GaussMarkov(std=0.0, tau=1.0),
        Misalignment(),
        RandomWalk(density=0.0),
        Saturation(limit=1e9),
        ScaleFactor(),
        TurnOnBias(),
        WhiteNoise(density=0.0),
        WhiteNoise(sample_std=0.0),
    ],
    ids=model_id,
)
def test_a_model_that_is_off_changes_no_bit(off, kind):
    x = wave(kind=kind)
    np.testing.assert_array_equal(run([off], x, kind, specific_force=x), x)


def test_no_models_is_the_identity_on_a_copy():
    x = wave()
    reported = run([], x)
    np.testing.assert_array_equal(reported, x)
    assert not np.shares_memory(reported, x)


def test_a_model_added_at_the_end_changes_no_other_noise():
    x = np.zeros((50, 3))
    walk, noise = RandomWalk(density=1.0), WhiteNoise(density=1.0)
    alone = run([walk], x)
    # The difference of the two runs is the second model's noise alone, up to rounding of sums of order 1.
    np.testing.assert_allclose(run([walk, noise], x) - alone, run([TurnOnBias(), noise], x), atol=1e-13, rtol=0)
    np.testing.assert_array_equal(run([walk, TurnOnBias()], x), alone)


def test_each_model_draws_from_its_own_child_of_the_seed():
    keys = {"seed": 4, "trial": 7, "sensor": 2}
    state = SensorErrors((RandomWalk(density=1.0), WhiteNoise(sample_std=1.0))).start(3, DT, "samples", **keys)[1]
    for index, rng in enumerate((state[0].rng, state[1][0])):
        expected = np.random.default_rng(np.random.SeedSequence(4, spawn_key=(7, 2, index)))
        assert rng.bit_generator.state == expected.bit_generator.state
    twins = run([WhiteNoise(sample_std=1.0), WhiteNoise(sample_std=1.0)], np.zeros((10000, 1)))
    assert abs(twins.var() / 2 - 1) < 5 * math.sqrt(2 / 10000)  # 4 if the two were the same noise


def test_models_act_in_the_stated_order():
    x = np.ones((4, 1))
    clipped_last = run([ScaleFactor(value=1.0), Saturation(limit=1.5)], x)
    clipped_first = run([Saturation(limit=1.5), ScaleFactor(value=1.0)], x)
    assert (clipped_last == 1.5).all()
    assert (clipped_first == 2.0).all()


@pytest.mark.parametrize(
    "model",
    [
        Bandwidth(cutoff=20.0),
        GSensitivity(value=(1e-3, 2e-3, -1e-3)),
        Misalignment(std=1e-2),
        Quantisation(step=1e-3),
        Saturation(limit=(0.2, 0.3, 5.0)),
        ScaleFactor(value=1e-3, quadratic=(0.1, -0.2, 0.3), quadratic_std=0.1),
        TurnOnBias(value=0.1, std=0.01, random_sign=True),
        WhiteNoise(sample_std=1e-3),
    ],
    ids=model_id,
)
@pytest.mark.parametrize("dt", [1e-4, 0.5])
def test_a_constant_rate_reads_the_same_as_samples_and_as_increments(model, dt):
    rate = np.tile([0.25, -0.5, 1.0], (20, 1))
    samples = run([model], rate, "samples", dt, specific_force=rate)
    increments = run([model], rate * dt, "increments", dt, specific_force=rate * dt)
    # A few roundings of readings of order 1; the converter may not sit on a tie for this to hold (it does not).
    np.testing.assert_allclose(increments / dt, samples, rtol=0, atol=8 * EPS)


# --- turn-on bias


@pytest.mark.parametrize("kind", KINDS)
def test_turn_on_bias_is_constant_and_normal(kind):
    n = 20000
    bias = many(TurnOnBias(value=0.3, std=0.1), 3, kind, n) / (DT if kind == "increments" else 1.0)
    assert (bias == bias[0]).all()
    assert abs(bias[0].mean() - 0.3) < 5 * 0.1 / math.sqrt(n)
    assert abs(bias[0].var() / 0.01 - 1) < 5 * math.sqrt(2 / n)
    assert stats.kstest((bias[0] - 0.3) / 0.1, "norm").pvalue > 1e-6


def test_random_signs_are_even_and_keep_the_magnitude():
    n = 10000
    bias = many(TurnOnBias(value=1.5e-5, random_sign=True), 2, "samples", n)[0]
    assert (np.abs(bias) == 1.5e-5).all()
    assert abs((bias > 0).sum() - n / 2) < 5 * math.sqrt(n) / 2
    signs = bias[: n // 2] * bias[n // 2 :]  # neighbours are independent
    assert abs(np.sign(signs).sum()) < 5 * math.sqrt(n / 2)


def test_fixed_bias_per_channel():
    x = wave()
    np.testing.assert_array_equal(run([TurnOnBias(value=[1.0, -2.0, 0.0])], x), x + np.array([1.0, -2.0, 0.0]))


# --- white noise


@pytest.mark.parametrize("dt", [1e-3, 0.25])
@pytest.mark.parametrize(
    ("model", "kind", "power"),
    [
        (WhiteNoise(density=0.2), "samples", -0.5),
        (WhiteNoise(density=0.2), "increments", 0.5),
        (WhiteNoise(sample_std=0.2), "samples", 0.0),
        (WhiteNoise(sample_std=0.2), "increments", 1.0),
    ],
)
def test_white_noise_has_the_stated_deviation(model, kind, power, dt):
    noise = many(model, 200, kind, 200, dt)
    expected = 0.2 * dt**power
    n = noise.size
    # Chi-square bounds of the sum of squares at the five-sigma level, two-sided.
    low, high = stats.chi2.ppf([2.9e-7, 1 - 2.9e-7], n)
    assert low < (noise**2).sum() / expected**2 < high
    assert abs(noise.mean()) < 5 * expected / math.sqrt(n)
    for lagged in (noise[1:] * noise[:-1], noise[:, 1:] * noise[:, :-1]):  # in time, and between channels
        assert abs(lagged.mean()) < 5 * expected**2 / math.sqrt(lagged.size)


def test_a_density_accumulates_the_same_at_any_rate_and_a_sample_deviation_does_not():
    # Random walk after 1 s: N for a density; s sqrt(dt) for a deviation of readings.
    for dt in (0.1, 0.01):
        n = 20000
        walk = many(WhiteNoise(density=0.2), round(1 / dt), "increments", n, dt).sum(axis=0)
        assert abs(walk.var() / 0.2**2 - 1) < 5 * math.sqrt(2 / n)
        walk = many(WhiteNoise(sample_std=0.2), round(1 / dt), "increments", n, dt).sum(axis=0)
        assert abs(walk.var() / (0.2**2 * dt) - 1) < 5 * math.sqrt(2 / n)


# --- Gauss-Markov


@pytest.mark.parametrize("x", [1e-3, 0.7, 5.0])
def test_gauss_markov_samples_have_the_exponential_covariance(x):
    tau = DT / x
    b = many(GaussMarkov(std=0.3, tau=tau), 6, "samples", 20000)
    k = np.arange(6)
    assert_covariance(b, 0.09 * np.exp(-x * np.abs(k[:, None] - k)))


def gauss_markov_integral_covariance(n, sigma, tau, dt):
    """Covariance of the integrals over n adjoining intervals: the double integral of sigma^2 exp(-|t-s|/tau)."""
    with mpmath.workdps(50):
        x = mpmath.mpf(dt) / tau
        rise = 1 - mpmath.exp(-x)
        lags = [2 * (x - rise)] + [rise**2 * mpmath.exp(-(m - 1) * x) for m in range(1, n)]
        lags = np.array([float((sigma * mpmath.mpf(tau)) ** 2 * lag) for lag in lags])
    k = np.arange(n)
    return lags[np.abs(k[:, None] - k)]


def test_the_closed_form_of_the_integral_covariance_is_right():
    expected = gauss_markov_integral_covariance(2, 0.3, 0.5, 0.2)
    with mpmath.workdps(20):
        same = mpmath.quad(lambda t: 2 * mpmath.quad(lambda s: 0.09 * mpmath.exp((s - t) / 0.5), [0, t]), [0, 0.2])
        next_to = mpmath.quad(lambda t, s: 0.09 * mpmath.exp((s - t) / 0.5), [0.2, 0.4], [0, 0.2])
    assert expected[0, 0] == pytest.approx(float(same), rel=1e-12)
    assert expected[0, 1] == pytest.approx(float(next_to), rel=1e-12)


@pytest.mark.parametrize("x", [1e-9, 1e-3, 0.7, 5.0, 100.0])
def test_gauss_markov_increments_have_the_covariance_of_the_integral(x):
    tau = DT / x
    increments = many(GaussMarkov(std=0.3, tau=tau), 5, "increments", 20000)
    assert_covariance(increments, gauss_markov_integral_covariance(5, 0.3, tau, DT))


def test_integral_part_keeps_its_digits_for_short_steps():
    with mpmath.workdps(60):
        for x in np.geomspace(1e-9, 300.0, 60):
            exact = 2 * (mpmath.mpf(x) - 2 * mpmath.tanh(mpmath.mpf(x) / 2))
            # Relative error of a few roundings; the naive difference has none left at x = 1e-6.
            assert abs(_own_variance(float(x)) / exact - 1) < 2e-14


def test_gauss_markov_can_start_at_zero():
    model = GaussMarkov(std=0.3, tau=0.02, initial="zero")
    b = many(model, 5, "samples", 20000)
    assert (b[0] == 0).all()
    k = np.arange(1, 5)
    # cov = sigma^2 (e^-|t-s|/tau - e^-(t+s)/tau)
    expected = 0.09 * (np.exp(-0.5 * np.abs(k[:, None] - k)) - np.exp(-0.5 * (k[:, None] + k)))
    assert_covariance(b[1:], expected)


def test_gauss_markov_std_per_channel():
    b = many(GaussMarkov(std=(0.0,) * 5000 + (1.0,) * 5000, tau=1.0), 2, "increments", 10000)
    assert (b[:, :5000] == 0).all()
    assert abs((b[0, 5000:] / DT).var() - 1) < 5 * math.sqrt(2 / 5000) + DT


def test_allan_peak_constant():
    def allan(u):
        return mpmath.sqrt(2 / u * (1 - (3 - 4 * mpmath.exp(-u) + mpmath.exp(-2 * u)) / (2 * u)))

    top = max(allan(u) for u in mpmath.linspace(1.88, 1.90, 2001))
    assert float(top) == pytest.approx(ALLAN_PEAK, abs=5e-8)


# --- random walk


def test_random_walk_samples_have_the_covariance_of_brownian_motion():
    b = many(RandomWalk(density=0.3), 6, "samples", 20000)
    assert (b[0] == 0).all()
    k = np.arange(1, 6)
    assert_covariance(b[1:], 0.09 * DT * np.minimum(k[:, None], k))


def test_random_walk_increments_have_the_covariance_of_the_integral():
    increments = many(RandomWalk(density=0.3), 6, "increments", 20000)
    k = np.arange(6)
    # double integral of K^2 min(s, t): K^2 dt^3 (i + 1/3) on the diagonal, K^2 dt^3 (min(i, j) + 1/2) off it
    expected = np.minimum(k[:, None], k) + 0.5
    np.fill_diagonal(expected, k + 1 / 3)
    assert_covariance(increments, 0.09 * DT**3 * expected)


def test_integrated_walk_has_the_closed_form_variance():
    n = 20000
    angle = many(RandomWalk(density=0.3), 100, "increments", n).sum(axis=0)  # over 1 s
    assert abs(angle.var() / (0.09 / 3) - 1) < 5 * math.sqrt(2 / n)


def test_random_walk_is_the_limit_of_a_slow_gauss_markov_process():
    # Same normals, started at zero, tau = 1e7 steps: they part by t / tau of themselves.
    tau = 1e7 * DT
    slow = many(GaussMarkov(std=math.sqrt(tau / 2), tau=tau, initial="zero"), 50, "increments", 3)
    drawn_first = SensorErrors((GaussMarkov(std=1.0, tau=1.0),)).start(3, DT, "increments", seed=5)[1][0].rng
    z = drawn_first.standard_normal((50, 2, 3))
    step = math.sqrt(DT) * z[:, 0]
    b = np.cumsum(step, axis=0) - step
    walk = b * DT + DT * (step / 2 + math.sqrt(DT / 12) * z[:, 1])
    np.testing.assert_allclose(slow, walk, rtol=0, atol=1e-5 * np.abs(walk).max())


# --- scale factor, misalignment, g-sensitivity, saturation


def test_scale_factor_and_its_nonlinearity():
    x = wave()
    model = ScaleFactor(value=(1e-3, 0.0, -2e-3), quadratic=(0.0, 0.5, 0.25))
    expected = x + x * [1e-3, 0.0, -2e-3] + x**2 * [0.0, 0.5, 0.25]
    np.testing.assert_allclose(run([model], x), expected, rtol=0, atol=4 * EPS)
    np.testing.assert_allclose(run([model], x * DT, "increments"), expected * DT, rtol=0, atol=4 * EPS * DT)


def test_scale_factor_draws():
    n = 20000
    y = run(
        [ScaleFactor(value=0.1, std=0.02, quadratic=1.0, quadratic_std=0.3)], np.array([[1.0], [-1.0]]) * np.ones(n)
    )
    s, k = (y[0] - y[1]) / 2 - 1, (y[0] + y[1]) / 2
    for found, mean, std in ((s, 0.1, 0.02), (k, 1.0, 0.3)):
        assert abs(found.mean() - mean) < 5 * std / math.sqrt(n)
        assert abs(found.var() / std**2 - 1) < 5 * math.sqrt(2 / n)
    assert abs(np.corrcoef(s, k)[0, 1]) < 5 / math.sqrt(n)


def test_misalignment_senses_along_leaning_unit_axes():
    angles = np.array([[0, 1e-3, -2e-3], [3e-3, 0, 1e-3], [-1e-3, 2e-3, 0]])
    x = wave()
    axes = np.eye(3) + angles
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    np.testing.assert_allclose(run([Misalignment(angles=angles)], x), x @ axes.T, rtol=0, atol=4 * EPS)
    # A force along a leaning axis is read in full: leaning is not a scale error.
    along = run([Misalignment(angles=angles)], axes[1:2])
    assert along[0, 1] == pytest.approx(1.0, abs=4 * EPS)


def test_misalignment_draws_six_independent_angles():
    trials, std = 3000, 1e-3
    found = np.array([run([Misalignment(std=std)], np.eye(3), trial=k) for k in range(trials)])
    angles = found[:, ~np.eye(3, dtype=bool)] / std
    covariance = angles.T @ angles / trials
    assert np.all(np.abs(covariance - np.eye(6)) < 5 * np.sqrt((1 + np.eye(6)) / trials) + 1e-5)


@pytest.mark.parametrize("kind", KINDS)
def test_g_sensitivity_adds_the_force_of_the_same_kind(kind):
    G = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]) * 1e-4
    x, f = wave(kind=kind), 9.8 * wave(kind=kind)[::-1].copy()
    expected = x + f @ G.T
    np.testing.assert_allclose(run([GSensitivity(value=G)], x, kind, specific_force=f), expected, rtol=0, atol=1e-16)
    diagonal = run([GSensitivity(value=(1e-4, 0.0, 2e-4))], x, kind, specific_force=f)
    np.testing.assert_allclose(diagonal, x + f * [1e-4, 0, 2e-4], rtol=0, atol=1e-16)


def test_g_sensitivity_draws_nine_elements():
    trials = 2000
    zero = np.zeros((3, 3))
    G = np.array([run([GSensitivity(std=1e-3)], zero, trial=k, specific_force=np.eye(3)) for k in range(trials)])
    assert np.all(np.abs(G.var(axis=0) / 1e-6 - 1) < 5 * math.sqrt(2 / trials))


def test_saturation_clips_at_the_limit_of_the_kind():
    x = wave()
    np.testing.assert_array_equal(run([Saturation(limit=0.7)], x), np.clip(x, -0.7, 0.7))
    clipped = run([Saturation(limit=(0.7, 0.1, 9.0))], x * DT, "increments")
    np.testing.assert_array_equal(
        clipped, np.clip(x * DT, np.array([-0.7, -0.1, -9]) * DT, np.array([0.7, 0.1, 9]) * DT)
    )


# --- quantisation


@pytest.mark.parametrize("random_phase", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_counted_increments_sum_to_the_truth_within_one_quantum(kind, random_phase):
    quantum = math.pi / 648000  # 1 arcsec
    rng = np.random.default_rng(2)
    x = rng.normal(scale=7 * quantum, size=(200_000, 3)) + quantum * np.array([0.001, -3.3, 1e4])
    reading = x if kind == "increments" else x / DT
    counted = run([Quantisation(quantum=quantum, random_phase=random_phase)], reading, kind)
    counted = counted if kind == "increments" else counted * DT
    counts = np.rint(counted / quantum)
    np.testing.assert_allclose(counted, counts * quantum, rtol=4 * EPS, atol=0)  # whole pulses only
    # Every prefix, in extended precision: 200 000 readings of 1e4 quanta, roundings of 2e-12 quanta each.
    error = np.cumsum(counts.astype(np.longdouble), axis=0) - np.cumsum(x.astype(np.longdouble) / quantum, axis=0)
    assert np.abs(error).max() <= (1.0 if random_phase else 0.5) + 1e-8
    assert np.abs(error).max() > 0.49  # it does quantise


def test_the_counter_loses_nothing_in_an_hour_at_1_khz():
    # Dyadic readings: the exact sums are integers, so that a single lost bit would show.
    rng = np.random.default_rng(4)
    units = rng.integers(-(2**24), 2**24, size=(3_600_000, 1))  # of 2^-20 quantum
    counted = run([Quantisation(quantum=2.0**-16)], units * 2.0**-36, "increments", 1e-3)
    counts = (counted * 2.0**16).astype(np.int64)
    left = np.cumsum(units, axis=0) - (np.cumsum(counts, axis=0) << 20)
    assert 0.99 * 2**19 < np.abs(left).max() <= 2**19  # half a quantum


def test_the_counters_phase_is_even():
    n = 20000
    tiny = run([Quantisation(quantum=1.0, random_phase=True)], np.full((1, n), 0.25), "increments")
    # 0.25 quanta on top of a residue even in [-1/2, 1/2) passes half a quantum in a quarter of the cases.
    assert abs(tiny.sum() - n / 4) < 5 * math.sqrt(n * 3 / 16)


def test_the_converter_rounds_every_reading_by_itself():
    x = wave()
    np.testing.assert_array_equal(run([Quantisation(step=0.25)], x), np.rint(x / 0.25) * 0.25)
    below_half = np.full((1000, 1), 0.1 * DT)
    assert (run([Quantisation(step=0.25)], below_half, "increments") == 0).all()  # and so loses the slow axis


# --- bandwidth


@pytest.mark.parametrize("cutoff", [1e-3, 0.3, 7.0, 200.0])
def test_lag_of_samples_is_exact_for_linear_interpolation(cutoff):
    tau = 1 / (2 * math.pi * cutoff)
    x = np.random.default_rng(3).normal(size=(400, 1))
    t = DT * np.arange(len(x))
    system = scipy_signal.StateSpace([[-1 / tau]], [[1 / tau]], [[1.0]], [[0.0]])
    _, expected, _ = scipy_signal.lsim(system, x[:, 0], t, X0=x[0], interp=True)
    # lsim's matrix exponentials are good to about 1e-12.
    np.testing.assert_allclose(run([Bandwidth(cutoff=cutoff)], x)[:, 0], expected, rtol=0, atol=1e-11)


@pytest.mark.parametrize("cutoff", [1e-3, 0.3, 7.0, 200.0])
def test_lag_of_increments_is_exact_for_a_held_rate(cutoff):
    tau = 1 / (2 * math.pi * cutoff)
    rate = np.random.default_rng(3).normal(size=400)
    t = DT * np.arange(len(rate) + 1)
    held = np.append(rate, 0.0)
    system = scipy_signal.StateSpace([[-1 / tau, 0], [1, 0]], [[1 / tau], [0]], [[0.0, 1.0]], [[0.0]])
    _, integral, _ = scipy_signal.lsim(system, held, t, X0=[rate[0], 0.0], interp=False)
    reported = run([Bandwidth(cutoff=cutoff)], rate[:, None] * DT, "increments")
    np.testing.assert_allclose(reported[:, 0], np.diff(integral), rtol=0, atol=1e-12)


def test_lag_at_the_cut_off_is_3_db_and_45_degrees():
    cutoff, dt = 5.0, 1e-4
    t = dt * np.arange(20000)
    y = run([Bandwidth(cutoff=cutoff)], np.sin(2 * math.pi * cutoff * t)[:, None], dt=dt)[:, 0]
    settled = t > 1.0  # 31 time constants
    expected = np.sin(2 * math.pi * cutoff * t - math.pi / 4) / math.sqrt(2)
    # Linear interpolation of the sine: (omega dt)^2 / 12 = 8e-7.
    np.testing.assert_allclose(y[settled], expected[settled], rtol=0, atol=2e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_a_constant_passes_the_lag_to_the_last_bit(kind):
    x = np.tile([0.1, -math.pi, 1e-9], (1000, 1))
    np.testing.assert_array_equal(run([Bandwidth(cutoff=3.0)], x, kind), x)


def test_lagged_increments_keep_their_integral():
    pulse = np.zeros((4000, 1))
    pulse[10:50] = 1e-3
    lagged = run([Bandwidth(cutoff=3.0)], pulse, "increments")
    # 40 s are 740 time constants after the pulse.
    assert lagged.sum() == pytest.approx(pulse.sum(), abs=1e-15)
    assert lagged[10] < 0.2e-3


# --- mounting


def array(m=400):
    direction = np.random.default_rng(6).normal(size=(m, 3))
    direction[:3] = np.eye(3)
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    return Accelerometers(tuple(f"a{k}" for k in range(m)), np.ones((m, 3)), direction)


def test_mounting_shifts_positions_and_tilts_axes():
    nominal = array(20000)
    drawn = Mounting(position_std=1e-3, direction_std=2e-3).draw(nominal, np.random.default_rng(7))
    assert drawn.names == nominal.names
    shift = drawn.position - nominal.position
    n = shift.size
    assert abs(shift.var() / 1e-6 - 1) < 5 * math.sqrt(2 / n)
    np.testing.assert_allclose(np.linalg.norm(drawn.direction, axis=1), 1.0, rtol=0, atol=4 * EPS)
    # Tilt from the cross product: two normal components perpendicular to the axis, none along it.
    tilt = np.cross(nominal.direction, drawn.direction)
    squares = (tilt**2).sum(axis=1) / (2e-3) ** 2  # chi-square with two degrees, up to sin^2 x = x^2 (1 - 4e-6)
    assert abs(squares.mean() - 2) < 5 * 2 / math.sqrt(len(squares)) + 1e-4
    fixed = Accelerometers(nominal.names, nominal.position, np.tile([0.0, 0.6, 0.8], (20000, 1)))
    tilt = np.cross(fixed.direction, Mounting(direction_std=2e-3).draw(fixed, np.random.default_rng(8)).direction)
    expected = (2e-3) ** 2 * (np.eye(3) - np.outer([0, 0.6, 0.8], [0, 0.6, 0.8]))  # the same in every direction
    np.testing.assert_allclose(tilt.T @ tilt / 20000, expected, rtol=0, atol=5 * (2e-3) ** 2 * math.sqrt(2 / 20000))


def test_one_mounting_error_leaves_the_other_as_it_was():
    nominal = array()
    both = Mounting(1e-3, 2e-3).draw(nominal, np.random.default_rng(7))
    shifted = Mounting(position_std=1e-3).draw(nominal, np.random.default_rng(7))
    tilted = Mounting(direction_std=2e-3).draw(nominal, np.random.default_rng(7))
    np.testing.assert_array_equal(shifted.position, both.position)
    np.testing.assert_array_equal(shifted.direction, nominal.direction)
    np.testing.assert_array_equal(tilted.direction, both.direction)
    np.testing.assert_array_equal(tilted.position, nominal.position)


def test_mounting_refuses_bad_input():
    with pytest.raises(InputError, match="direction_std must be a number >= 0, got -1"):
        Mounting(direction_std=-1.0)
    with pytest.raises(InputError, match="position_std must be"):
        Mounting(position_std=math.nan)
    with pytest.raises(InputError, match="accelerometers must be an Accelerometers record, got 3"):
        Mounting().draw(3, np.random.default_rng(0))


# --- bad input


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: WhiteNoise(), "exactly one of density and sample_std, got density=None"),
        (lambda: WhiteNoise(density=1.0, sample_std=2.0), "exactly one of density and sample_std"),
        (lambda: WhiteNoise(density=-1.0), "density must be a number >= 0, got -1"),
        (lambda: WhiteNoise(sample_std=math.nan), "sample_std must be finite"),
        (lambda: Quantisation(), "exactly one of quantum and step"),
        (lambda: Quantisation(quantum=1.0, step=1.0), "exactly one of quantum and step"),
        (lambda: Quantisation(quantum=0.0), "quantum must be a positive number, got 0.0"),
        (lambda: Quantisation(step=-1.0), "step must be a positive number, got -1.0"),
        (lambda: Bandwidth(cutoff=0.0), "cutoff must be a positive number, got 0.0"),
        (lambda: Saturation(limit=(1.0, 0.0)), "limit must be a positive number, got 0.0"),
        (lambda: GaussMarkov(std=1.0, tau=0.0), "tau must be a positive number, got 0.0"),
        (lambda: GaussMarkov(std=-1.0, tau=1.0), "std must be a number >= 0, got -1"),
        (lambda: GaussMarkov(std=1.0, tau=1.0, initial="cold"), "unknown initial 'cold'"),
        (lambda: RandomWalk(density="x"), "density must be a number >= 0, got 'x'"),
        (lambda: TurnOnBias(value=math.inf), "value must be finite"),
        (lambda: TurnOnBias(std=(0.1, -0.1)), "std must be a number >= 0, got -0.1"),
        (lambda: ScaleFactor(quadratic_std=-1.0), "quadratic_std must be a number >= 0, got -1"),
        (lambda: Misalignment(angles=np.ones((3, 3))), "angles must have a zero diagonal"),
        (lambda: Misalignment(angles=np.zeros(3)), r"angles must have shape \(3, 3\)"),
        (lambda: GSensitivity(value=np.zeros((2, 2))), r"value must have shape \(3, 3\)"),
        (lambda: GSensitivity(value=(1.0, 2.0)), r"value must have shape \(3,\)"),
        (lambda: SensorErrors((3,)), "models must hold error models, got 3"),
        (lambda: SensorErrors(WhiteNoise), "models must hold error models"),
        (lambda: Stream(0, DT, "samples"), "channels must be an integer >= 1, got 0"),
    ],
)
def test_bad_options_are_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "increment"}, "unknown kind 'increment'.*did you mean 'increments'"),
        ({"dt": 0.0}, "dt must be a positive number, got 0.0"),
        ({"dt": -0.1}, "dt must be a positive number, got -0.1"),
        ({"dt": math.inf}, "dt must be finite"),
        ({"seed": -1}, "seed must be an integer >= 0, got -1"),
        ({"seed": 1.5}, "seed must be an integer"),
        ({"trial": -1}, "trial must be an integer >= 0, got -1"),
        ({"sensor": "gyro"}, "sensor must be an integer >= 0, got 'gyro'"),
        ({"signal": np.zeros(3)}, r"signal must have shape \(n, n\), got \(3,\)"),
        ({"signal": np.zeros((0, 3))}, "signal must not be empty"),
        ({"signal": [[1.0, math.nan]]}, r"signal must be finite, got nan at \[0, 1\]"),
        ({"signal": [["a", "b"]]}, "signal must be an array of real numbers"),
    ],
)
def test_bad_signals_are_refused(change, message):
    arguments = {"signal": np.zeros((4, 3)), "dt": DT, "kind": "samples", "seed": 1} | change
    with pytest.raises(InputError, match=message):
        SensorErrors((WhiteNoise(density=1.0),)).apply(**arguments)


def test_an_unknown_kind_lists_the_valid_ones():
    with pytest.raises(UnknownNameError, match="valid: increments, samples"):
        run([], wave(), "counts")


@pytest.mark.parametrize(
    ("model", "channels", "keys", "message"),
    [
        (Misalignment(), 9, {}, "misalignment needs 3 channels .*, got 9"),
        (GSensitivity(), 9, {}, "g-sensitivity needs 3 channels .*, got 9"),
        (GSensitivity(), 3, {}, "specific_force must be given for g-sensitivity, got None"),
        (
            GSensitivity(),
            3,
            {"specific_force": np.zeros((4, 2))},
            r"specific_force must have shape \(4, 3\), got \(4, 2\)",
        ),
        (
            GSensitivity(),
            3,
            {"specific_force": np.zeros((5, 3))},
            r"specific_force must have shape \(4, 3\), got \(5, 3\)",
        ),
        (GSensitivity(), 3, {"specific_force": np.full((4, 3), math.nan)}, "specific_force must be finite"),
        (TurnOnBias(value=(1.0, 2.0)), 3, {}, r"value must have one value per channel \(3\), got 2"),
    ],
)
def test_what_does_not_fit_the_channels_is_refused(model, channels, keys, message):
    with pytest.raises(InputError, match=message):
        run([model], np.zeros((4, channels)), **keys)


def test_a_later_chunk_must_fit_too():
    errors = SensorErrors((WhiteNoise(density=1.0),))
    state = errors.start(3, DT, "samples", seed=1)
    state, _ = errors.advance(state, np.zeros((4, 3)))
    with pytest.raises(InputError, match=r"signal must have shape \(n, 3\), got \(4, 2\)"):
        errors.advance(state, np.zeros((4, 2)))


def test_a_result_that_is_not_finite_is_refused():
    with np.errstate(over="ignore"), pytest.raises(InputError, match="reported signal must be finite"):
        run([ScaleFactor(value=1e300)], np.full((2, 1), 1e300))
