"""Chebyshev fit of the rate to increments, and the power series in Bortz's equation, in exact rational arithmetic.

A series is kept by the halves of its coefficients, A_0 = a_0 and A_k = a_k / 2: with T_k = (z^k + z^-k)/2 it is
sum A_k z^k over k from -d to d, A_-k = A_k, and products and integrals need no special cases at low degrees.
"""

from fractions import Fraction
from functools import cache
from math import comb, factorial

import numpy as np

from bench.errors import Array
from bench.solvers.attitude._rate_fit import rate_fractions

BORTZ_TERMS = 48


@cache
def _chebyshev_fit(N: int) -> tuple[tuple[Fraction, ...], ...]:
    # u = (1 + x)/2 = (z^1/2 + z^-1/2)^2 / 4: the half coefficient of z^k in u^m is (2m over m+k) / 4^m.
    powers = rate_fractions(N)
    fit = [[Fraction(0)] * N for _ in range(N)]
    for m, row in enumerate(powers):
        for k in range(m + 1):
            share = Fraction(comb(2 * m, m + k), 2 * 4**m)
            fit[k] = [known + share * power for known, power in zip(fit[k], row, strict=True)]
    return tuple(map(tuple, fit))


def rate_fit(N: int) -> Array:
    """Return F: w_k = sum_i F[k, i] dtheta_i, the half coefficients of the fitted rate, shape (N, N).

    w(x) = (T/2) omega, -1 <= x <= 1, rad: the polynomial of degree N - 1 that reproduces the N increments.
    """
    return np.array([[float(c) for c in row] for row in _chebyshev_fit(N)])


@cache
def _bortz_fractions() -> tuple[Fraction, ...]:
    # In powers of x^2, with y = x/2: y cot y from (y cot y) (sin y / y) = cos y, one power after the other.
    powers = range(BORTZ_TERMS + 1)
    sine = [Fraction((-1) ** k, 4**k * factorial(2 * k + 1)) for k in powers]
    cot: list[Fraction] = []
    for k in powers:
        known = sum((c * sine[k - j] for j, c in enumerate(cot)), Fraction(0))
        cot.append(Fraction((-1) ** k, 4**k * factorial(2 * k)) - known)
    return tuple(-c for c in cot[1:])


def bortz_series() -> Array:
    """Return the coefficients of s^0, s^1, ... in (1 - (x/2) cot(x/2))/x^2, s = x^2 < (2 pi)^2: 1/12, 1/720, ..."""
    return np.array([float(c) for c in _bortz_fractions()])
