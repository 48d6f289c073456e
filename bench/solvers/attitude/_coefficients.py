"""Coefficients of the rotation-vector algorithms in exact rational arithmetic, and their error on coning.

Every set is an upper triangle K of N x N fractions for
``phi = sum_i dtheta_i + sum_{i<j} K_ij dtheta_i x dtheta_j``. Inside, times are in samples: an update is 0..N.
"""

import math
from collections.abc import Iterable, Iterator
from fractions import Fraction
from functools import cache
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array
from bench.solvers.attitude._rate_fit import angle_polynomials

Pair = tuple[int, int]
Row = tuple[Fraction, ...]
Matrix = tuple[Row, ...]

_SERIES = 30  # terms of the residual: at lambda = 1, N = 8 the next one is 1e-30 of the first


def _area(N: int, m: int, n: int) -> Fraction:
    """Return half the integral of tau^m (tau^n)' - tau^n (tau^m)' over 0..N."""
    return Fraction(n - m, 2 * (m + n)) * N ** (m + n)


@cache
def polynomial(N: int) -> Matrix:
    """Return K that is exact for the second-order term of the fitted polynomial: all products, no optimisation.

    K_ij = 1/2 integral of A_i A_j' - A_j A_i' over the update, theta = sum_i A_i dtheta_i; Eq. 4 of [Xu] for N = 3.
    """
    A = angle_polynomials(N)
    powers = list(combinations(range(1, N + 1), 2))  # A_i(0) = 0
    triangle = {
        (i, j): sum((_area(N, m, n) * (A[i][m] * A[j][n] - A[i][n] * A[j][m]) for m, n in powers), Fraction(0))
        for i, j in combinations(range(N), 2)
    }
    return _upper(N, triangle)


@cache
def coning_optimised(N: int) -> Matrix:
    """Return K with products with the last increment only, of the least error on small and slow coning.

    K_{N-p,N} = k_p from the powers lambda^3..lambda^(2N-1) of ``N lambda - sin N lambda = sum_p k_p v_p(lambda)``,
    ``v_p = 4 sin p lambda - 2 sin (p+1) lambda - 2 sin (p-1) lambda``: what coning of a small half angle a turns,
    and a^2/2 v_p the product of two increments p apart ([Miller], [Lee], [Ignagni]).
    """
    equations = (([_v(p, m) for p in range(1, N)], Fraction(N**m)) for m in range(3, 2 * N, 2))
    k = _solve_in_turn(equations, N - 1)
    return _upper(N, {(N - 1 - p, N - 1): k[p - 1] for p in range(1, N)})


@cache
def coning_manoeuvre_exact(N: int) -> Matrix:
    """Return K that errs on coning as `coning_optimised`, and on polynomial motion as little as then possible.

    After [Song]: ``sum_{j-i=p} K_ij = k_p``, symmetry under reversal of time, and then for theta = sum c_m tau^m
    the equations ``sum_{i<j} K_ij [d_m(i) d_n(j) - d_n(i) d_m(j)] = (n-m)/(2(m+n)) N^(m+n)`` with
    ``d_m(i) = i^m - (i-1)^m``, one at a time, m + n rising, then m rising; an equation that contradicts those
    accepted before is left out.
    """
    pairs = list(combinations(range(N), 2))
    mirrored = [min(pair, (N - 1 - pair[1], N - 1 - pair[0])) for pair in pairs]
    unknowns = sorted(set(mirrored))
    K = _solve_in_turn(_song_equations(N, pairs, [unknowns.index(pair) for pair in mirrored]), len(unknowns))
    return _upper(N, {pair: K[unknowns.index(twin)] for pair, twin in zip(pairs, mirrored, strict=True)})


SETS = {
    "polynomial": polynomial,
    "coning-optimised": coning_optimised,
    "coning-manoeuvre-exact": coning_manoeuvre_exact,
}


def kernel_arguments(K: Matrix, weight: float) -> tuple[Array, int]:
    """Return K with the weight of the increments themselves on its diagonal, and its first column with a product."""
    array = np.array(K, dtype=np.float64)
    used = np.flatnonzero(array.any(axis=0))
    return array + weight * np.eye(len(K)), int(used[0]) if len(used) else len(K)


def coning_sums(K: Matrix) -> Row:
    """Return sum_{j-i=p} K_ij for p = 1..N-1: all that coning sees of K."""
    N = len(K)
    return tuple(sum((K[i][i + p] for i in range(N - p)), Fraction(0)) for p in range(1, N))


def coning_residual(K: Matrix, lam: ArrayLike, half_angle: float) -> Array:
    """Return the drift per update on a small cone, computed minus true, about the axis of the mean rate, rad.

    ``a^2/2 [N lambda - sin N lambda - sum_p k_p v_p(lambda)]`` with k_p the `coning_sums`.

    Parameters
    ----------
    K : Matrix
    lam : array_like, rad
        Phase of the coning per sample, Omega h.
    half_angle : float, rad
        a; what is left out is of order a^4.
    """
    lam = np.asarray(lam, dtype=np.float64)
    N, sums = len(K), coning_sums(K)
    steps = np.arange(1, N)
    v = [4 * np.sin(p * lam) - 2 * np.sin((p + 1) * lam) - 2 * np.sin((p - 1) * lam) for p in steps]
    direct = N * lam - np.sin(N * lam) - sum(float(k) * one for k, one in zip(sums, v, strict=True))
    # The difference loses all digits for small lambda; there the series, whose first powers cancel exactly.
    series = np.zeros_like(lam)
    for r in range(_SERIES, 0, -1):
        m = 2 * r + 1
        term = (N**m - sum(k * _v(p, m) for p, k in enumerate(sums, 1))) * (-1) ** (r + 1) / math.factorial(m)
        series = series * lam**2 + float(term)
    return np.asarray(0.5 * half_angle**2 * np.where(np.abs(lam) < 1, series * lam**3, direct))


def leading_coning_residual(N: int) -> Fraction:
    """Return c: the drift of the coning-optimised sets is c a^2 lambda^(2N+1) per update for small lambda.

    c = N N! / (2^(N+1) 1 3 5 ... (2N+1)).
    """
    return Fraction(N * math.factorial(N), 2 ** (N + 1) * math.prod(range(1, 2 * N + 2, 2)))


def _v(p: int, m: int) -> Fraction:
    """Return the coefficient of lambda^m (m odd, >= 3) in v_p, over that in -sin lambda."""
    return Fraction(2 * (p + 1) ** m + 2 * (p - 1) ** m - 4 * p**m)


def _song_equations(N: int, pairs: list[Pair], column: list[int]) -> Iterator[tuple[list[Fraction], Fraction]]:
    """Yield the equations of `coning_manoeuvre_exact` in turn; column: which unknown stands for a pair."""
    count = max(column, default=-1) + 1

    def gather(factor: dict[Pair, Fraction]) -> list[Fraction]:
        row = [Fraction(0)] * count
        for pair, unknown in zip(pairs, column, strict=True):
            row[unknown] += factor.get(pair, Fraction(0))
        return row

    for p, k in enumerate(coning_sums(coning_optimised(N)), 1):
        yield gather({(i, i + p): Fraction(1) for i in range(N - p)}), k
    for total in range(3, 2 * N):
        for m in range(1, (total + 1) // 2):
            n = total - m
            dm, dn = ([Fraction(i**e - (i - 1) ** e) for i in range(1, N + 1)] for e in (m, n))
            yield gather({(i, j): dm[i] * dn[j] - dn[i] * dm[j] for i, j in pairs}), _area(N, m, n)


def _solve_in_turn(equations: Iterable[tuple[list[Fraction], Fraction]], unknowns: int) -> Row:
    """Solve linear equations taken one at a time; one that follows from or contradicts the earlier ones is skipped."""
    solved: dict[int, list[Fraction]] = {}  # pivot: row with 1 there and 0 at the other pivots
    for coefficients, right in equations:
        row = [*coefficients, right]
        for pivot, known in solved.items():
            row = _eliminate(row, pivot, known)
        pivot = next((k for k in range(unknowns) if row[k]), -1)
        if pivot < 0:
            continue
        row = [value / row[pivot] for value in row]
        solved = {k: _eliminate(known, pivot, row) for k, known in solved.items()} | {pivot: row}
        if len(solved) == unknowns:
            break
    return tuple(solved[k][-1] for k in range(unknowns))


def _eliminate(row: list[Fraction], pivot: int, known: list[Fraction]) -> list[Fraction]:
    factor = row[pivot]
    return [a - factor * b for a, b in zip(row, known, strict=True)] if factor else row


def _upper(N: int, triangle: dict[Pair, Fraction]) -> Matrix:
    return tuple(tuple(triangle.get((i, j), Fraction(0)) for j in range(N)) for i in range(N))
