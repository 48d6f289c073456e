"""Polynomial exact: the motion of fitted polynomials of rate and specific force, integrated to rounding."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import polynomial as power_series

from bench.earth import Earth
from bench.errors import AccuracyError, Array, InputError, require_integer
from bench.references import WANG, Source
from bench.rotation import cross
from bench.solvers.attitude._rate_fit import difference_tables
from bench.solvers.navigation import NavigationSolver
from bench.trajectory import NavigationInitial

MOST_TERMS = 300  # of the power series: noise makes the high coefficients of the fit large, and needs many
NODES = 4  # of gravitation in an update
LONGEST = 12  # increments
MOTION, HISTORY = 20, 28  # in the running state: after the motion the attitude and its rounding, then past increments


@dataclass(frozen=True)
class PolynomialExact(NavigationSolver):
    """Polynomial exact: the motion of fitted polynomials of rate and specific force, integrated to rounding.

    Rate and force over an update are the polynomials that reproduce the increments of a window. The series of
    C' = C [omega x] and of c = C f over -1 <= u <= 1 follow by recursion, and f adds sum c_k (1 + (-1)^k)/(k + 1) to
    the velocity and the like to the position; gravitation is taken at four Gauss nodes of the path, in two sweeps.
    All is in i, sums are compensated for rounding: only the fit limits the accuracy. A reference for the others.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8.
    height : {"free", "held"}
        As for every navigation solver.
    window : int, optional
        W, increments the polynomials are fitted to, the update's own and those before: N to 12, by default N + 2.
        At the start, where there are fewer, the update's own. On smooth motions two borrowed increments make the
        error some 100 times smaller; noise and steps are amplified, as by any fit of high degree.

    Raises
    ------
    InputError
        If an option is out of range.
    AccuracyError
        In use, if the rate over an update turns so far, or noise makes its polynomial so large, that a power series
        would lose its digits: 16 rad an update, or noise of some 0.02 rad an increment for N = 6.

    Notes
    -----
    Order N + 1 for odd N and N + 2 for even N with W = N; W or W + 1, the odd one, in a longer window, where even
    higher orders mix in.

    References
    ----------
    [Wang] Wang, Chen, Zeng, Rotation vector and dual quaternion strapdown algorithms in the inertial frame (the
    frame, and the split of the velocity; the series are those of the attitude solver `TaylorQuaternion`).
    """

    name: ClassVar[str] = "polynomial-exact"
    source: ClassVar[Source] = WANG.at("section 3, velocity and position by series to rounding")

    samples: int = 6
    window: int | None = None

    def _check_options(self) -> None:
        if self.window is None:
            return
        if require_integer("window", self.window, minimum=self.samples) > LONGEST:
            raise InputError(f"window must be an integer from samples = {self.samples} to {LONGEST}, got {self.window}")

    @property
    def _borrowed(self) -> int:
        return 2 if self.window is None else self.window - self.samples

    @property
    def order_periodic(self) -> int | None:
        """N + 1 or N + 2, the even one, with W = N; None for a longer window."""
        return None if self._borrowed else self.samples + 2 - self.samples % 2

    def _constants(self, earth: Earth, dt: float) -> tuple[Any, ...]:
        N, W = self.samples, self.samples + self._borrowed
        roots, weights = np.polynomial.legendre.leggauss(NODES)
        nodes, weights = 0.5 * (1 + roots), 0.5 * weights
        fits = difference_tables(N, centred=True), difference_tables(N, W, centred=True)[self._borrowed :]
        factor = 1 / np.arange(1.0, MOST_TERMS + 1)
        sums = _force_weights(roots, 0.5 * N * dt, MOST_TERMS + W)
        mean = np.stack([weights, weights * (1 - nodes)])
        return fits, factor, sums, earth.parameters, N * dt, nodes, mean, _double_integrals(nodes)

    def _carry(self, earth: Earth, dt: float, initial: NavigationInitial, row: Array) -> Array:
        q, v_e, r = row[:4], row[4:7], row[7:]
        v = v_e + cross(earth.omega_ie, r)
        motion = np.concatenate([q, v, np.zeros(3), r, np.zeros(3), earth.gravitation(r), [initial.height]])
        return np.concatenate([motion, q, np.zeros(4), np.zeros(6 * self._borrowed)])

    def _update(self, constants: tuple[Any, ...], increments: Array, first: int, carry: Array, out: Array) -> None:
        N, B = self.samples, self._borrowed
        past = carry[HISTORY:].reshape(B, 6)
        block = np.concatenate([past, increments])
        past[:] = block[len(block) - B :]
        alone = min(max(-(-B // N) - first, 0), len(out))  # updates before which there are not B increments
        (own, wide), *rest = constants
        if alone:
            self._integrate(own, rest, block[B : B + N * alone], first, carry, out[:alone])
        if alone < len(out):
            self._integrate(wide, rest, block[N * alone :], first + alone, carry, out[alone:])

    def _integrate(self, fit: Array, constants: list[Any], block: Array, first: int, carry: Array, out: Array) -> None:
        from bench.solvers.navigation._polynomial_kernels import body_series, integrate

        factor, sums, p, T, nodes, mean, double = constants
        dtheta, dvel = block[:, :3].copy(), block[:, 3:].copy()
        starts, attitude = np.arange(len(out)) * self.samples, carry[MOTION:HISTORY]
        integrals, q_ib = np.empty((len(out), len(sums), 3)), np.empty((len(out), 4))
        done = body_series(fit, factor, sums, dtheta, dvel, starts, attitude, integrals, q_ib)
        if done < len(out):
            raise AccuracyError(
                f"{self.name}: the increments of update {first + done} turn too far or too irregularly for a power "
                f"series: take fewer samples or a shorter window"
            )
        holds = self.height == "held"
        integrate(p, T, nodes, mean, double, holds, q_ib, integrals, first, carry, out)


def _force_weights(roots: Array, half: float, terms: int) -> Array:
    """Return the weights of c_k, f = sum_k c_k x^k over -1 <= x <= 1, in its integrals, shape (2 + n, terms).

    The integral over the update; its double integral over the update, and from the start to the n roots, which is
    ``half`` times the integral of (x - s) s^k over -1..x.
    """
    k = np.arange(terms)
    even = (-1.0) ** k
    x = np.append(1.0, roots)[:, None]
    double = x ** (k + 2) / ((k + 1) * (k + 2)) + even * (x / (k + 1) + 1 / (k + 2))
    return np.concatenate([((1 + even) / (k + 1))[None], half * double])


def _double_integrals(nodes: Array) -> Array:
    """Return B: the double integral of a function from 0 to node i is sum_j B_ij times its value at node j."""
    powers = np.linalg.inv(power_series.polyvander(nodes, len(nodes) - 1))  # of the functions 1 at one node
    return np.array([power_series.polyval(nodes, power_series.polyint(column, 2)) for column in powers.T]).T
