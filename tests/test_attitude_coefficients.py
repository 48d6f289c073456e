"""Coefficients of the rotation vector: the printed rationals, and independent checks of what they stand for.

Truth: the rationals printed in the literature (N = 2..6); mpmath quadrature at 40 digits of the products of increments
of explicit angle curves; and the defining equations, written here anew, in exact arithmetic for every N.
"""

import math
from fractions import Fraction
from itertools import combinations, pairwise

import mpmath
import numpy as np
import pytest

from bench.solvers.attitude import _coefficients as co
from bench.solvers.attitude._coefficients import SETS

ALL = range(1, 9)


def triangle(K):
    """The products (i, j), counted from 1, as printed."""
    return {(i + 1, j + 1): K[i][j] for i, j in combinations(range(len(K)), 2)}


def mirrored(N, denominator, printed):
    """Complete printed numerators by K_ij = K_{N+1-j,N+1-i}."""
    full = printed | {(N + 1 - j, N + 1 - i): value for (i, j), value in printed.items()}
    return {pair: Fraction(value, denominator) for pair, value in full.items()}


POLYNOMIAL = {
    2: mirrored(2, 3, {(1, 2): 2}),
    3: mirrored(3, 80, {(1, 2): 57, (1, 3): 33}),
    4: mirrored(4, 945, {(1, 2): 736, (1, 3): 334, (1, 4): 526, (2, 3): 654}),
}
OPTIMISED = {  # k_1, k_2, ...
    2: (3, [2]),
    3: (20, [27, 9]),
    4: (105, [214, 92, 54]),
    5: (504, [1375, 650, 525, 250]),
    6: (4620, [15797, 7834, 7296, 4558, 2315]),
}
EXACT = {
    2: mirrored(2, 3, {(1, 2): 2}),
    3: mirrored(3, 40, {(1, 2): 27, (1, 3): 18}),
    4: mirrored(4, 315, {(1, 2): 232, (1, 3): 138, (1, 4): 162, (2, 3): 178}),
    5: mirrored(5, 4032, {(1, 2): 3325, (1, 3): 1325, (1, 4): 2100, (1, 5): 2000, (2, 3): 2175, (2, 4): 2550}),
    6: mirrored(
        6,
        46200,
        {(1, 2): 42246, (1, 3): 6543, (1, 4): 30341, (1, 5): 22790, (1, 6): 23150}
        | {(2, 3): 28341, (2, 4): 32627, (2, 5): 12278, (3, 4): 16796},
    ),
}


@pytest.mark.parametrize("N", POLYNOMIAL)
def test_polynomial_coefficients_are_the_printed_ones(N):
    assert triangle(co.polynomial(N)) == POLYNOMIAL[N]


@pytest.mark.parametrize("N", OPTIMISED)
def test_coning_optimised_coefficients_are_the_printed_ones(N):
    denominator, k = OPTIMISED[N]
    printed = {(N - p, N): Fraction(value, denominator) for p, value in enumerate(k, 1)}
    found = triangle(co.coning_optimised(N))
    assert found == dict.fromkeys(found, Fraction(0)) | printed


@pytest.mark.parametrize("N", EXACT)
def test_coning_manoeuvre_exact_coefficients_are_the_printed_ones(N):
    assert triangle(co.coning_manoeuvre_exact(N)) == EXACT[N]


@pytest.mark.parametrize("make", SETS.values())
def test_one_sample_has_no_product_and_two_samples_one(make):
    assert make(1) == ((Fraction(0),),)
    assert triangle(make(2)) == {(1, 2): Fraction(2, 3)}


@pytest.mark.parametrize("N", ALL)
@pytest.mark.parametrize("make", [co.polynomial, co.coning_manoeuvre_exact])
def test_uncompressed_sets_do_not_care_which_way_time_runs(make, N):
    K = triangle(make(N))
    assert all(K[i, j] == K[N + 1 - j, N + 1 - i] for i, j in K)


@pytest.mark.parametrize("N", ALL)
def test_exact_set_has_the_coning_sums_of_the_optimised_one(N):
    assert co.coning_sums(co.coning_manoeuvre_exact(N)) == co.coning_sums(co.coning_optimised(N))
    assert co.coning_sums(co.coning_optimised(N)) == tuple(co.coning_optimised(N)[N - 1 - p][-1] for p in range(1, N))


@pytest.mark.parametrize("N", ALL)
def test_coning_equation_holds_to_the_power_it_must(N):
    # Taylor coefficients of both sides: equal up to lambda^(2N-1), and the next differs by the leading residual.
    k = co.coning_sums(co.coning_optimised(N))

    def gap(m):
        sine = Fraction((-1) ** ((m - 1) // 2), math.factorial(m))
        right = sum(kp * (4 * p**m - 2 * (p + 1) ** m - 2 * (p - 1) ** m) for p, kp in enumerate(k, 1))
        return sine * (-(N**m) - right)

    assert [gap(m) for m in range(3, 2 * N, 2)] == [0] * (N - 1)
    # The drift is a^2/2 times the gap.
    assert gap(2 * N + 1) / 2 == co.leading_coning_residual(N)


def manoeuvre_gap(K, m, n):
    """How much a motion theta = c_m tau^m + c_n tau^n misses of its second-order term."""
    N = len(K)
    d = [[Fraction(i**e - (i - 1) ** e) for i in range(1, N + 1)] for e in (m, n)]
    left = sum(K[i][j] * (d[0][i] * d[1][j] - d[1][i] * d[0][j]) for i, j in combinations(range(N), 2))
    return left - Fraction(n - m, 2 * (m + n)) * N ** (m + n)


@pytest.mark.parametrize("N", ALL)
def test_polynomial_set_is_exact_for_polynomial_motion(N):
    # A rate of degree N - 1: theta has powers to N. The powers themselves, not the Lagrange basis of the code.
    assert [manoeuvre_gap(co.polynomial(N), m, n) for m, n in combinations(range(1, N + 1), 2)] == [0] * math.comb(N, 2)


@pytest.mark.parametrize("N", range(3, 9))
def test_exact_set_is_exact_for_the_lowest_powers(N):
    # No sum stands in their way; they decide the order of the periodic error.
    K = co.coning_manoeuvre_exact(N)
    assert [manoeuvre_gap(K, m, n) for m, n in ((1, 2), (1, 3))] == [0, 0]
    if N >= 4:
        assert [manoeuvre_gap(K, m, n) for m, n in ((1, 4), (2, 3))] == [0, 0]


@pytest.mark.parametrize("N", [5, 7, 8])
def test_exact_set_follows_the_rule_of_consistency(N):
    # The rule, by ranks of explicit matrices: an equation holds if and only if adding it keeps the system soluble.
    K = co.coning_manoeuvre_exact(N)
    pairs = list(combinations(range(N), 2))
    rows = [[int(j - i == p) for i, j in pairs] + [co.coning_sums(K)[p - 1]] for p in range(1, N)]
    for i, j in pairs:
        twin = pairs.index((N - 1 - j, N - 1 - i))
        row = [0] * (len(pairs) + 1)
        row[pairs.index((i, j))] += 1
        row[twin] -= 1
        rows.append(row)
    for total in range(3, 2 * N):
        for m in range(1, (total + 1) // 2):
            n = total - m
            d = [[i**e - (i - 1) ** e for i in range(1, N + 1)] for e in (m, n)]
            row = [d[0][i] * d[1][j] - d[1][i] * d[0][j] for i, j in pairs]
            row.append(Fraction(n - m, 2 * (m + n)) * N**total)
            soluble = rank([r[:-1] for r in [*rows, row]]) == rank([*rows, row])
            assert soluble == (manoeuvre_gap(K, m, n) == 0)
            if soluble and rank([*rows, row]) > rank(rows):
                rows.append(row)


def rank(rows):
    """Rank in exact arithmetic modulo a large prime, by plain elimination."""
    prime = 2**61 - 1
    rows = [[Fraction(v).numerator * pow(Fraction(v).denominator, -1, prime) % prime for v in row] for row in rows]
    found = 0
    for column in range(len(rows[0])):
        pivot = next((r for r in range(found, len(rows)) if rows[r][column]), None)
        if pivot is None:
            continue
        rows[found], rows[pivot] = rows[pivot], rows[found]
        inverse = pow(rows[found][column], -1, prime)
        for r in range(found + 1, len(rows)):
            factor = rows[r][column] * inverse % prime
            if factor:
                rows[r] = [(a - factor * b) % prime for a, b in zip(rows[r], rows[found], strict=True)]
        found += 1
    return found


@pytest.mark.parametrize("N", [3, 6, 8])
def test_polynomial_set_against_quadrature(N):
    # 1/2 int theta x theta' of two plane curves that the increments determine, by mpmath at 40 digits.
    with mpmath.workdps(40):
        x = [mpmath.mpf(c) / 7 for c in (0, 3, -5, 2, 1, -1, 4, -2, 1)][: N + 1]
        y = [mpmath.mpf(c) / 9 for c in (0, -2, 1, 6, -3, 2, 1, -4, 2)][: N + 1]

        def curve(c, t):
            return sum(value * t**m for m, value in enumerate(c))

        def slope(c, t):
            return sum(m * value * t ** (m - 1) for m, value in enumerate(c) if m)

        def area(t):
            return (curve(x, t) * slope(y, t) - curve(y, t) * slope(x, t)) / 2

        truth = mpmath.quad(area, list(range(N + 1)))
        dx = [curve(x, i + 1) - curve(x, i) for i in range(N)]
        dy = [curve(y, i + 1) - curve(y, i) for i in range(N)]
        K = co.polynomial(N)
        found = sum(
            mpmath.mpf(K[i][j].numerator) / K[i][j].denominator * (dx[i] * dy[j] - dy[i] * dx[j])
            for i, j in combinations(range(N), 2)
        )
        assert abs(found - truth) < mpmath.mpf(10) ** -30 * abs(truth)


def residual_by_mpmath(K, lam, half_angle):
    """a^2/2 [N lam - sin N lam - sum k_p v_p] at 80 digits, from the pairs and not from their sums."""
    N = len(K)
    with mpmath.workdps(80):
        lam = mpmath.mpf(lam)
        total = N * lam - mpmath.sin(N * lam)
        for i, j in combinations(range(N), 2):
            p = j - i
            v = 4 * mpmath.sin(p * lam) - 2 * mpmath.sin((p + 1) * lam) - 2 * mpmath.sin((p - 1) * lam)
            total -= mpmath.mpf(K[i][j].numerator) / K[i][j].denominator * v
        return float(mpmath.mpf(half_angle) ** 2 / 2 * total)


@pytest.mark.parametrize("make", SETS.values())
@pytest.mark.parametrize("N", ALL)
def test_residual_keeps_its_digits_at_any_phase(N, make):
    lam = np.array([1e-3, 0.03, 0.3, 0.9999, 1.0, 2.0, 3.1])
    truth = [residual_by_mpmath(make(N), value, 0.01) for value in lam]
    # Ten digits, where the difference of sines in floating point would have none.
    np.testing.assert_allclose(co.coning_residual(make(N), lam, 0.01), truth, rtol=1e-10)


@pytest.mark.parametrize("N", ALL)
def test_leading_residual_is_the_limit(N):
    leading = float(co.leading_coning_residual(N)) * 0.01**2 * 1e-3 ** (2 * N + 1)
    # The next power is about N lambda^2/20 smaller.
    np.testing.assert_allclose(co.coning_residual(co.coning_optimised(N), 1e-3, 0.01), leading, rtol=1e-6)


def test_residual_falls_with_every_sample():
    lam = 0.3
    size = [abs(float(co.coning_residual(co.coning_optimised(N), lam, 1.0))) / N for N in ALL]
    assert all(later < 0.2 * earlier for earlier, later in pairwise(size))


def test_kernels_get_the_triangle_and_the_first_column_in_use():
    K, first = co.kernel_arguments(co.coning_optimised(3), 1.0)
    np.testing.assert_array_equal(K, [[1, 0, 0.45], [0, 1, 1.35], [0, 0, 1]])
    assert first == 2
    assert co.kernel_arguments(co.polynomial(3), 1.0)[1] == 1
    K, first = co.kernel_arguments(co.polynomial(1), 0.0)
    assert K == [[0.0]]
    assert first == 1
