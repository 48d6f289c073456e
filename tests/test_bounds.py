"""The Cramer-Rao bound against closed forms, a complex-step Jacobian, mpmath, and a Monte Carlo of the estimator."""

import mpmath
import numpy as np
import pytest

import bench
from bench.bounds import array_information, cramer_rao_std
from tests.gyro_free_cases import array, cube, nine, padgaonkar, readings, rotated, tetrahedron, triads

S = 3e-3  # m/s^2


@pytest.mark.parametrize("omega", [(2, 2, 2), (2, 0, 0), (0.3, -1.0, 4.0)])
def test_triads_with_centroid_zero_have_the_closed_form_of_skog(omega):
    # Sum of r r' over the tetrahedron's four corners (+-l, +-l, +-l) is 4 l^2 I, so rho = 4 l^2.
    arm, w = 0.13, np.array(omega, dtype=float)
    expected = 4 * arm**2 / S**2 * (2 * w @ w * np.eye(3) + 6 * np.outer(w, w))
    np.testing.assert_allclose(array_information(tetrahedron(arm), w, S), expected, rtol=1e-12, atol=1e-9)


def test_the_body_origin_does_not_matter():
    # f at another origin is another nuisance with the same span.
    there = tetrahedron()
    moved = bench.Accelerometers(there.names, there.position + np.array([5.0, -3.0, 2.0]), there.direction)
    w = np.array([1.0, 2.0, -0.5])
    # Positions of 5 m hold 1e-15 m, 1e-14 of the arm.
    np.testing.assert_allclose(array_information(moved, w, S), array_information(there, w, S), rtol=1e-12)


def test_nine_accelerometers_at_two_rad_per_second():
    # var omega_i^2 = 3/8 s^2/l^2 and d(omega^2) = 2 omega d(omega): std = sqrt(3/8) / (2 * 2) s/l = 0.153 s/l.
    std = cramer_rao_std(nine(0.1), (2, 2, 2), S)
    np.testing.assert_allclose(std, np.sqrt(3 / 8) / 4 * S / 0.1, rtol=1e-12)
    np.testing.assert_allclose(std * 0.1 / S, 0.153, atol=5e-4)


def test_an_axis_without_information_gets_infinity():
    std = cramer_rao_std(nine(), [(2, 0, 0), (0, 0, 0), (2, 2, 2)], S)
    assert np.isfinite(std[0, 0])
    assert np.isinf(std[0, 1:]).all()
    assert np.isinf(std[1]).all()
    assert np.isfinite(std[2]).all()
    # The cube is solved for f and alpha exactly: nothing is left for the rate.
    assert np.isinf(cramer_rao_std(cube(), (2, 1, 3), S)).all()


def test_an_unseen_direction_across_the_axes_takes_both_axes_with_it():
    # The nine at (2, 0, 0), turned by 45 degrees about z: z and one direction between x and y are lost.
    C = np.array([[1, -1, 0], [1, 1, 0], [0, 0, np.sqrt(2)]]) / np.sqrt(2)
    assert np.isinf(cramer_rao_std(rotated(nine(), C), C @ [2.0, 0, 0], S)).all()


def test_a_gyro_adds_its_information_and_bounds_every_axis():
    plain = array_information(nine(), (2, 0, 0), S)
    np.testing.assert_allclose(
        array_information(nine(), (2, 0, 0), S, 0.1) - plain, 100 * np.eye(3), rtol=1e-9, atol=1e-9
    )
    std = cramer_rao_std(nine(), (2, 0, 0), S, [0.1, 0.1])  # two triads
    np.testing.assert_allclose(std[1:], 0.1 / np.sqrt(2), rtol=1e-9)


def test_one_std_per_channel_weighs_the_channels():
    # A channel with enormous noise is as good as absent.
    full = tetrahedron()
    stds = np.full(12, S)
    stds[-1] = 1e6 * S
    without = bench.Accelerometers(full.names[:-1], full.position[:-1], full.direction[:-1])
    w = (1.0, 2.0, 3.0)
    np.testing.assert_allclose(array_information(full, w, stds), array_information(without, w, S), rtol=1e-9)


def test_rows_of_rates_are_those_of_single_rates():
    w = np.random.default_rng(1).normal(size=(5, 3))
    rows = array_information(padgaonkar(), w, S)
    assert rows.shape == (5, 3, 3)
    for row, single in zip(rows, w, strict=True):
        np.testing.assert_allclose(row, array_information(padgaonkar(), single, S), rtol=1e-13, atol=1e-9)


def test_information_is_that_of_a_complex_step_jacobian_projected_in_fifty_digits():
    rng = np.random.default_rng(5)
    there = array(rng.normal(size=(11, 3)), rng.normal(size=(11, 3)))
    w = rng.normal(size=3)
    r, d = there.position, there.direction
    step = 1e-30
    J = np.empty((11, 3))
    for i in range(3):
        moved = w.astype(complex)
        moved[i] += 1j * step
        J[:, i] = (d * np.cross(moved, np.cross(moved, r))).sum(axis=1).imag / step
    with mpmath.workdps(50):
        H, Jm = mpmath.matrix(np.hstack([d, np.cross(r, d)]).tolist()), mpmath.matrix(J.tolist())
        information = Jm.T * Jm - (Jm.T * H) * mpmath.inverse(H.T * H) * (H.T * Jm)
        expected = np.array(information.tolist(), dtype=float) / S**2
    np.testing.assert_allclose(array_information(there, w, S), expected, rtol=1e-11)


@pytest.mark.parametrize("make", [nine, tetrahedron])
def test_array_least_squares_reaches_the_bound(make):
    # 40 000 trials: the sample variance of normal errors is within 4 sqrt(2/n) = 2.9 %, and the estimator's own
    # bias at this noise (s/l = 1e-3 rad^2/s^2 against 8 rad^2/s^2) is far below. A tenth worse would be found.
    n, s, there = 40_000, 1e-4, make()
    w = np.array([2.0, -1.5, 1.0])
    rng = np.random.default_rng(7)
    clean = readings(there, w[None], np.array([[0.5, -1.0, 2.0]]), np.array([[1.0, 2.0, 9.0]]))
    noisy = clean + s * rng.standard_normal((n, len(there)))
    # Rate of every row stands alone; a tiny dt keeps the integral of alpha, which only gives the signs, at omega(0).
    solution = bench.solver("gyro-free", "array-least-squares").solve(
        there, noisy, 1e-9, bench.Initial(omega_ib_b=w, gravity=(0, 0, 0))
    )
    ratio = (solution.omega_ib_b - w).var(axis=0) / cramer_rao_std(there, w, s) ** 2
    np.testing.assert_allclose(ratio, 1.0, atol=4 * np.sqrt(2 / n))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"accelerometer_std": 0.0}, "accelerometer_std must be positive, got .*0.0"),
        ({"accelerometer_std": [1.0, 2.0]}, "accelerometer_std must be one number or 9"),
        ({"accelerometer_std": np.nan}, "accelerometer_std must be finite"),
        ({"gyro_std": -1.0}, "gyro_std must be positive, got .*-1.0"),
        ({"omega": (1, 2)}, r"omega must have shape \(n, 3\)"),
        ({"omega": (1, np.inf, 2)}, "omega must be finite"),
    ],
)
def test_bad_input_is_named(change, message):
    arguments = {"omega": (1, 2, 3), "accelerometer_std": S, **change}
    for function in (array_information, cramer_rao_std):
        with pytest.raises(bench.InputError, match=message):
            function(nine(), **arguments)


def test_a_single_triad_knows_nothing_of_the_rate():
    assert np.isinf(cramer_rao_std(triads([[0.1, 0.2, 0.3]]), (1, 2, 3), S)).all()
