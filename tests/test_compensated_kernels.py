"""Compensated arithmetic against exact fractions and mpmath."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest

from bench import _compensated_kernels as kernels

RNG = np.random.default_rng(5)
PAIRS = RNG.normal(size=(200, 2)) * 10.0 ** RNG.integers(-8, 9, (200, 2))


def test_sum_and_product_lose_nothing():
    for a, b in PAIRS:
        assert sum(map(Fraction, kernels.two_sum(a, b))) == Fraction(a) + Fraction(b)
        assert sum(map(Fraction, kernels.two_product(a, b))) == Fraction(a) * Fraction(b)


def test_root_has_twice_the_digits():
    for a, _ in PAIRS:
        high, low = abs(a), abs(a) * 1e-17
        with mpmath.workdps(50):
            truth = mpmath.sqrt(mpmath.mpf(high) + mpmath.mpf(low))
            root, rest = kernels.two_root(high, low)
            assert abs((mpmath.mpf(root) + mpmath.mpf(rest)) / truth - 1) < 1e-30
    assert kernels.two_root(0.0, 0.0) == (0.0, 0.0)


@pytest.mark.parametrize("scale", [1e-300, 1e-9, 1.0, 6.27])
def test_sine_and_cosine_are_right_to_2e_18(scale):
    for angle in scale * np.concatenate([RNG.uniform(-1, 1, 300), [0.0, 1.0, -1.0, 0.25 + 1 / 128]]):
        sine, sine_low, cosine, cosine_low = kernels.two_sincos(angle)
        with mpmath.workdps(50):
            exact = mpmath.mpf(float(angle))
            assert abs(mpmath.mpf(sine) + mpmath.mpf(sine_low) - mpmath.sin(exact)) < 2e-18
            assert abs(mpmath.mpf(cosine) + mpmath.mpf(cosine_low) - mpmath.cos(exact)) < 2e-18


def test_sine_and_cosine_of_large_angles_are_those_of_doubles():
    for angle in (6.3, -100.0, 1e6):
        np.testing.assert_allclose(
            kernels.two_sincos(angle), [np.sin(angle), 0.0, np.cos(angle), 0.0], rtol=0, atol=3e-16
        )
