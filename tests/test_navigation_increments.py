"""Sculling and scrolling of polynomial motions, and the kernels that sum them, one update or many at a time.

Truth: polynomials of rate and force integrated by numpy's; a constant rate and force in closed form, at 40 digits.
"""

import mpmath
import numpy as np
import pytest
from numpy.polynomial import Polynomial

from bench.solvers.attitude._coefficients import polynomial
from bench.solvers.navigation._coefficients import double_sum, scrolling, sculling
from bench.solvers.navigation._increment_kernels import BLOCK, block_integrals, body_integrals, rotation_terms


def tables(N):
    return tuple(np.array(table(N), dtype=float) for table in (polynomial, sculling, double_sum, scrolling))


def random_motion(N, seed):
    """Return a random rate and force, each three polynomials of degree N - 1, and their N increments in time 0..N."""
    rng = np.random.default_rng(seed)
    rate, force = ([Polynomial(rng.normal(size=N), [0, N], [0, 1]) for _ in range(3)] for _ in range(2))
    rate, force = ([part.convert() for part in vector] for vector in (rate, force))
    edges = np.arange(N + 1)
    increments = [np.column_stack([np.diff(part.integ()(edges)) for part in vector]) for vector in (rate, force)]
    return rate, force, np.hstack(increments)


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def integral(vector, end):
    return np.array([part.integ()(end) for part in vector])


@pytest.mark.parametrize("N", range(1, 9))
def test_polynomial_rate_and_force_are_exact_to_first_order_of_the_angle(N):
    rate, force, increments = random_motion(N, N)
    angle, velocity = ([part.integ() for part in vector] for vector in (rate, force))
    found = np.array(body_integrals(*tables(N), increments, 0)).reshape(3, 3)
    coning = integral(cross(angle, rate), N) / 2
    alternating = (integral(cross(angle, force), N) + integral(cross(velocity, rate), N)) / 2
    later = Polynomial([N, -1.0])  # the time that is left: int int f = int (N - t) f
    carried = integral([later * part for part in force], N) + integral([later * p for p in cross(angle, force)], N)
    expected = [increments[:, :3].sum(axis=0) + coning, increments[:, 3:].sum(axis=0) + alternating, carried / N]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


def test_the_coefficients_of_two_samples_are_the_well_known_ones():
    assert [[str(value) for value in row] for row in sculling(2)] == [["0", "2/3"], ["-2/3", "0"]]
    assert [str(value) for value in double_sum(2)] == ["5/6", "1/6"]
    assert [str(value) for value in scrolling(1)[0]] == ["1/6"]


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 0.1, 0.19999, 0.20001, 1.0, 3.0, 6.0])
def test_rotation_terms_of_a_constant_rate_and_force(angle):
    p = angle * np.array([0.6, 0.0, -0.8])
    u = np.array([1.0, 2.0, -0.5])
    once, twice = np.cross(p, u), np.cross(p, np.cross(p, u))
    with mpmath.workdps(40):
        x = mpmath.mpf(angle)
        if x:
            a = (1 - mpmath.cos(x)) / x**2, (x - mpmath.sin(x)) / x**3, (x**2 / 2 - 1 + mpmath.cos(x)) / x**4
        else:
            a = mpmath.mpf(1) / 2, mpmath.mpf(1) / 6, mpmath.mpf(1) / 24
        a1, a2, a3, rest = (float(value) for value in (*a, a[1] - mpmath.mpf(1) / 6))
    found = np.array(rotation_terms(*p, *u)).reshape(2, 3)
    np.testing.assert_allclose(found, [a1 * once + a2 * twice, rest * once + a3 * twice], rtol=0, atol=3e-15)


@pytest.mark.parametrize("exact", [False, True])
@pytest.mark.parametrize("N", [1, 2, 3, 8])
def test_a_block_of_updates_is_what_each_is_alone(N, exact):
    K, S, a, L = tables(N)
    increments = (
        np.random.default_rng(N).normal(size=(BLOCK * N + 5, 6)) * np.linspace(0.001, 0.5, BLOCK * N + 5)[:, None]
    )
    out = np.full((10, BLOCK), np.nan)
    count = BLOCK - 3
    block_integrals(S, a, L, exact, increments, 5, count, out)
    for u in range(count):
        p, v, s = np.array(body_integrals(K, S, a, L, increments, 5 + u * N)).reshape(3, 3)
        if exact:
            terms = np.array(rotation_terms(*p, *v)).reshape(2, 3)
            v, s = v + terms[0], s + terms[1]
        half = np.linalg.norm(p) / 2
        q = [np.cos(half), *(np.sin(half) / (2 * half) * p)]
        np.testing.assert_allclose(out[:, u], [*q, *v, *s], rtol=0, atol=1e-14)


def test_a_constant_added_to_the_sculling_table_is_the_rotation_to_first_order():
    K, S, a, L = tables(3)
    d = np.random.default_rng(1).normal(size=(3, 6))
    with_rotation, without = (np.array(body_integrals(K, table, a, L, d, 0)) for table in (S + 0.5, S))
    expected = np.zeros(9)
    expected[3:6] = np.cross(d[:, :3].sum(axis=0), d[:, 3:].sum(axis=0)) / 2
    np.testing.assert_allclose(with_rotation - without, expected, rtol=0, atol=1e-14)
