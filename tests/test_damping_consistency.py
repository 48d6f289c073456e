"""Consistency of the damping filters over Monte Carlo, and soundness of their covariances over 48 h.

Truth is drawn from the filters' own model, so that a filter whose assumptions hold must have NEES and NIS within the
chi-square bounds. Where they do not hold by design, that is asserted too: it is a finding, not a failure.
"""

import numpy as np
import pytest
from scipy.linalg import solve
from scipy.stats import chi2

import bench
from bench.error_simulation import ErrorSimulation, disturbed, reference_velocity
from bench.errors import InputError
from bench.evaluation import chi_square_bounds, nees
from tests.damping_cases import KNOWN, NAMES, ship

TRIALS, EVERY, LEVEL = 16, 600, 0.999  # a false alarm in 1000 per time, of which there are 4


@pytest.fixture(scope="module")
def drawn():
    truth = ship(3 * EVERY, turn=0.2)
    simulation = ErrorSimulation(KNOWN, trials=TRIALS, seed=11)
    return truth, simulation.advance(simulation.start(), truth)[1]


def consistency(drawn, name, spread, part=None, **options):
    """Return mean NEES at each kept time, and mean NIS, with reference errors of standard deviation `spread`."""
    truth, x = drawn
    damping = bench.solver("damping", name, covariance_every=EVERY, **options)
    values, nis = [], []
    for trial in range(TRIALS):
        error = spread * np.random.default_rng(trial).standard_normal(2)
        v_ref = reference_velocity(truth, error=error, noise=KNOWN.reference_noise, seed=12, trial=trial)
        solution = damping.solve(disturbed(truth, x[:, trial]), v_ref)
        rows = solution.covariance_rows
        true = np.concatenate([x[rows, trial], np.tile(error, (len(rows), 1))], axis=1)[:, : solution.x.shape[1]]
        values.append(nees(solution.x[rows] - true, solution.covariance))
        nis.append(solution.nis[solution.used])
    return np.mean(values, axis=0), np.mean(nis), np.size(nis)


def within(value, degrees, trials):
    low, high = chi_square_bounds(degrees, trials, LEVEL)
    return (low < value).all() and (value < high).all()


def test_velocity_error_is_consistent_without_a_constant_reference_error(drawn):
    mean, nis, count = consistency(drawn, "velocity-error", 0.0)
    assert within(mean, 13, TRIALS)
    assert within(np.array([nis]), 2, count)


def test_bias_augmented_is_consistent_with_one(drawn):
    mean, nis, count = consistency(drawn, "bias-augmented", 0.3, reference_bias=0.3)
    assert within(mean, 15, TRIALS)
    assert within(np.array([nis]), 2, count)


def test_velocity_error_is_inconsistent_with_one_and_its_nis_does_not_say_so(drawn):
    mean, nis, _ = consistency(drawn, "velocity-error", 0.3)
    assert (mean[1:] > 100 * chi_square_bounds(13, TRIALS, LEVEL)[1]).all()
    assert nis < 2.2


def test_velocity_change_claims_more_error_than_it_makes(drawn):
    """R2 read as (0.001 m/s^2)^2 is far above the smoothed noise: the innovations show it, the states less so."""
    mean, nis, _ = consistency(drawn, "velocity-change", 0.0)
    assert nis < 1.0
    # With a constant error of the reference, filter 1 first swings to it: that change is taken for the INS's.
    with_error, _, _ = consistency(drawn, "velocity-change", 0.3)
    assert (np.maximum(mean, with_error) < 2 * chi_square_bounds(13, TRIALS, LEVEL)[1]).all()


def test_the_fusion_claims_less_error_than_it_makes(drawn):
    """It fuses two estimates of the same measurements as if they were independent."""
    mean, _, _ = consistency(drawn, "double-filter", 0.0)
    assert (mean[1:] > chi_square_bounds(13, TRIALS, LEVEL)[1]).all()
    assert (mean[1:] < 13 * 4).all()


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_covariances_stay_symmetric_and_positive_over_48_hours(name):
    ins = ship(48 * 3600, v_E=3.0, v_N=2.0, sway=0.1)
    v_ref = reference_velocity(ins, noise=0.05, seed=1)
    solution = bench.solver("damping", name, covariance_every=1800).solve(ins, v_ref)
    P = solution.covariance
    assert len(P) == 97
    np.testing.assert_array_equal(P, np.swapaxes(P, 1, 2))
    std = np.sqrt(np.diagonal(P, axis1=1, axis2=2))
    # Correlations of 1 - 1e-6 occur (tilt against accelerometer bias); rounding makes 1e-12 of them.
    assert np.linalg.eigvalsh(P / std[:, :, None] / std[:, None]).min() > 1e-10
    assert (solution.sigma > 0).all()


def test_memory_is_flat_over_chunks():
    """The state after hours is as large as after minutes."""
    ins = ship(3600)
    v_ref = reference_velocity(ins, noise=0.05, seed=1)
    damping = bench.solver("damping", "double-filter", mean="window", window=60.0)
    state, sizes = damping.start(), []
    for begin in range(0, 3600, 600):
        state, _ = damping.advance(state, ins[begin : begin + 600], v_ref[begin : begin + 600])
        sizes.append(sum(part.nbytes for part in (*state.carry.carry, state.carry.state, state.carry.box)))
    assert len(set(sizes)) == 1


def test_nees_is_the_quadratic_form():
    rng = np.random.default_rng(1)
    scale = np.array([1.0, 1e-6, 1e4])
    root = rng.standard_normal((7, 3, 3)) * scale[:, None]
    P = root @ np.swapaxes(root, 1, 2)
    e = rng.standard_normal((7, 3)) * scale
    expected = [a @ solve(B / scale / scale[:, None], a) for a, B in zip(e / scale, P, strict=True)]
    np.testing.assert_allclose(nees(e, P), expected, rtol=1e-8)


def test_chi_square_bounds_are_quantiles_of_the_mean():
    low, high = chi_square_bounds(13, 50, 0.95)
    assert chi2.cdf([low * 50, high * 50], 650) == pytest.approx([0.025, 0.975], rel=1e-9)
    means = np.random.default_rng(2).chisquare(13, (20_000, 50)).mean(axis=1)
    assert ((low < means) & (means < high)).mean() == pytest.approx(0.95, abs=4 * np.sqrt(0.95 * 0.05 / 20_000))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: nees(np.zeros((2, 3)), np.zeros((2, 2, 2))), r"covariance must have shape \(2, 3, 3\)"),
        (lambda: nees(np.zeros((1, 2)), np.diag([1.0, 0.0])[None]), "positive definite, got a variance of 0"),
        (lambda: nees(np.zeros((1, 2)), [[[1.0, 2.0], [2.0, 1.0]]]), "positive definite, one is not"),
        (lambda: nees(np.zeros((1, 2)), [[[1.0, 0.5], [0.0, 1.0]]]), "covariance must be symmetric"),
        (lambda: chi_square_bounds(0), "degrees must be an integer >= 1"),
        (lambda: chi_square_bounds(3, level=1.0), "level must be between 0 and 1"),
    ],
)
def test_bad_input(call, message):
    with pytest.raises(InputError, match=message):
        call()
