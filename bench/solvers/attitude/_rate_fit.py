"""The polynomial angular rate that reproduces given increments, fitted in exact rational arithmetic.

The integral of the rate is interpolated through the cumulated increments S_0 = 0, S_1, ..., S_W at tau = 0, 1, ..., W
(tau in samples) with Lagrange's polynomials L_k: theta(tau) = sum_i A_i(tau) dtheta_i, A_i = sum_{k >= i} L_k. The
rate A_i' has degree W - 1 and every increment of the window is reproduced exactly.
"""

from fractions import Fraction
from functools import cache
from math import comb, factorial

import numpy as np

from bench.errors import Array

Polynomial = tuple[Fraction, ...]  # ascending powers


def _times(p: list[Fraction], root: int) -> list[Fraction]:
    """Return p(tau) (tau - root)."""
    return [low - root * high for low, high in zip([Fraction(0), *p], [*p, Fraction(0)], strict=True)]


@cache
def _lagrange(window: int) -> tuple[Polynomial, ...]:
    """Return L_0 ... L_W, one at their own and zero at the other points 0 ... W."""
    found = []
    for k in range(window + 1):
        p = [Fraction(1)]
        for other in range(window + 1):
            if other != k:
                p = _times(p, other)
        scale = (-1) ** (window - k) * factorial(k) * factorial(window - k)
        found.append(tuple(c / scale for c in p))
    return tuple(found)


@cache
def angle_polynomials(window: int) -> tuple[Polynomial, ...]:
    """Return A_1 ... A_W in tau: theta(tau) = sum_i A_i(tau) dtheta_i, degree W, for a window of W increments."""
    basis = _lagrange(window)
    return tuple(
        tuple(sum(column, Fraction(0)) for column in zip(*basis[i:], strict=True)) for i in range(1, window + 1)
    )


@cache
def rate_fractions(samples: int, window: int | None = None, offset: int = 0) -> tuple[Polynomial, ...]:
    """Return `rate_matrix` as exact fractions, row by row."""
    return _rate(samples if window is None else window, Fraction(samples), Fraction(offset))


@cache
def _rate(window: int, scale: Fraction, origin: Fraction) -> tuple[Polynomial, ...]:
    """Return the rate's coefficients in u, tau = origin + scale u, as sums over the increments of the window."""
    rows = [[Fraction(0)] * window for _ in range(window)]
    for i, angle in enumerate(angle_polynomials(window)):
        rate = [power * c for power, c in enumerate(angle)][1:]
        for power, c in enumerate(rate):  # c (origin + scale u)^power, and dtau = scale du
            for m in range(power + 1):
                rows[m][i] += c * comb(power, m) * origin ** (power - m) * scale ** (m + 1)
    return tuple(map(tuple, rows))


@cache
def _rounded(samples: int, window: int | None, offset: int) -> Array:
    return np.array([[float(c) for c in row] for row in rate_fractions(samples, window, offset)])


def rate_matrix(samples: int, window: int | None = None, offset: int = 0) -> Array:
    """Return M with w_m = sum_i M[m, i] dtheta_i, where the rate over an update is sum_m w_m u^m.

    Parameters
    ----------
    samples : int
        N, increments of the update: u runs from 0 to 1 over them, and w_m is in rad per update.
    window : int, optional
        W >= N, increments through which the rate is fitted; N by default.
    offset : int
        Increments of the window before the first of the update's own.

    Returns
    -------
    ndarray, shape (W, W)
        The exact rationals, rounded once; yours to change.
    """
    return _rounded(samples, window, offset).copy()


@cache
def _differences(window: int, scale: Fraction, origin: Fraction) -> Array:
    # dtheta_i = sum_j comb(i - 1, j) D^j
    rows = _rate(window, scale, origin)
    return np.array([[float(sum(c * comb(i, j) for i, c in enumerate(row))) for j in range(window)] for row in rows])


def difference_tables(samples: int, window: int | None = None, *, centred: bool = False) -> Array:
    """Return G with w_m = sum_{j >= m} G[offset, m, j] D^j, D^j the forward differences of the window.

    The same fit as `rate_matrix`, with D^0 = dtheta_1, D^1 = dtheta_2 - dtheta_1, and so on. The large entries meet
    the small high differences here, whereas with `rate_matrix` large products cancel: in a window of 12 that costs
    two to three digits.

    Parameters
    ----------
    samples, window
        As `rate_matrix`.
    centred : bool
        Whether u runs from -1 to 1 over the update, and w_m is in rad per half update: the high coefficients are
        2^(m+1) times smaller.

    Returns
    -------
    ndarray, shape (W - N + 1, W, W)
        For all offsets 0 ... W - N; upper triangular.
    """
    window = samples if window is None else window
    scale, shift = (Fraction(samples, 2), Fraction(samples, 2)) if centred else (Fraction(samples), Fraction(0))
    return np.array([_differences(window, scale, offset + shift) for offset in range(window - samples + 1)])


def runge_kutta_rates(samples: int) -> Array:
    """Return the rates at u = 0, 1/2, 1 as sums over the N increments of an update, rad per update, shape (3, N)."""
    points = [Fraction(0), Fraction(1, 2), Fraction(1)]
    columns = zip(*rate_fractions(samples), strict=True)
    return np.array([[float(sum(c * u**m for m, c in enumerate(p))) for u in points] for p in columns]).T.copy()
