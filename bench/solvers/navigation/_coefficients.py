"""Coefficients of the sculling and scrolling compensation with N samples, in exact rational arithmetic.

Angular rate and specific force are the polynomials of degree N - 1 that reproduce the N increments; times are in
samples, an update is 0..N, A_i is the fitted integral of increment i (see ``bench.solvers.attitude._rate_fit``).

References
----------
[Savage2] Savage: Strapdown inertial navigation integration algorithm design part 2: velocity and position algorithms,
J. Guidance, Control, and Dynamics 21(2), 1998.
[Roscoe] Roscoe: Equivalency between strapdown inertial navigation coning and sculling integrals/algorithms,
J. Guidance, Control, and Dynamics 24(2), 2001.
"""

from fractions import Fraction
from functools import cache

from bench.solvers.attitude._coefficients import Matrix, Row, polynomial
from bench.solvers.attitude._rate_fit import Polynomial, angle_polynomials


@cache
def sculling(N: int) -> Matrix:
    """Return S with the sculling integral ``1/2 int (alpha x f + u x omega) = sum_ij S_ij dtheta_i x dvel_j``.

    Antisymmetric, and above the diagonal the coning coefficients: the integral is what ``1/2 int alpha x omega``
    becomes to first order if every increment dtheta_i is replaced by dtheta_i + eps dvel_i ([Roscoe]).
    """
    K = polynomial(N)
    return tuple(tuple(K[i][j] - K[j][i] for j in range(N)) for i in range(N))


@cache
def double_sum(N: int) -> Row:
    """Return a with ``int int f = T sum_j a_j dvel_j``: how far each increment carries by the end of the update."""
    return tuple(_integral(A, (Fraction(1),), N) / N for A in angle_polynomials(N))


@cache
def scrolling(N: int) -> Matrix:
    """Return L with ``int int alpha x f = T sum_ij L_ij dtheta_i x dvel_j``, rotation and scrolling in one.

    The double integral is that of (T - t) alpha x f over the update ([Savage2], section on position).
    """
    A = angle_polynomials(N)
    left = (Fraction(N), Fraction(-1))  # N - tau
    rates = [tuple(power * c for power, c in enumerate(angle))[1:] for angle in A]
    return tuple(tuple(_integral(_product(left, A[i]), rates[j], N) / N for j in range(N)) for i in range(N))


def _product(p: Polynomial, q: Polynomial) -> Polynomial:
    found = [Fraction(0)] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
        for j, b in enumerate(q):
            found[i + j] += a * b
    return tuple(found)


def _integral(p: Polynomial, q: Polynomial, N: int) -> Fraction:
    """Return the integral of p q over 0..N."""
    return sum((c * Fraction(N) ** (k + 1) / (k + 1) for k, c in enumerate(_product(p, q))), Fraction(0))
