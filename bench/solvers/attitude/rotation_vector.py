"""Rotation vector: sum of the increments plus products of pairs, with polynomial or coning-optimised coefficients."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array, require_choice
from bench.references import XU, Source
from bench.solvers.attitude import AttitudeSolver, require_samples
from bench.solvers.attitude._coefficients import SETS, kernel_arguments


@dataclass(frozen=True)
class RotationVector(AttitudeSolver):
    """Rotation vector: phi = sum dtheta_i + sum_{i<j} K_ij dtheta_i x dtheta_j, then q o exp(phi/2).

    The second-order solution of Bortz's equation (Eq. 4 of [Xu] for N = 3); K is computed in rational arithmetic.
    The third-order term is missing: at large angles per update no choice of K helps.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8.
    coefficients : {"polynomial", "coning-optimised", "coning-manoeuvre-exact"}
        polynomial: all products, exact to second order for a rate that is a polynomial of degree N - 1.
        coning-optimised: products with the last increment only, for the least drift on coning of a small half
        angle ([Miller], [Lee], [Ignagni]); on other motion of third order only.
        coning-manoeuvre-exact: all products, the same drift on coning, and the polynomial's accuracy on smooth
        motion as far as the two agree [Song].
        For N = 1 and 2 the three are one.

    Raises
    ------
    InputError
        If `samples` is out of range or there is no such set of coefficients.

    Notes
    -----
    The coning-optimised drift (that of all sets with these sums) is of order 2N while the cone is small enough for
    the missing third-order term; at any given half angle that term prevails as dt goes to 0: 4 with compressed
    products and for N = 3, where the drift changes sign in between, else 6. These last orders are declared; the
    slope is clean on coning of 30 degrees and more with less than 0.1 rad of phase an update.

    References
    ----------
    [Xu] Xu et al., Performance analysis of high-precision strapdown inertial navigation attitude algorithms, 2019.
    [Miller] Miller, A new strapdown attitude algorithm, 1983.
    [Lee] Lee et al., Extension of strapdown attitude algorithm for high-frequency base motion, 1990.
    [Ignagni] Ignagni, Efficient class of optimized coning compensation algorithms, 1996.
    [Song] Song, Wu, Pan, Approach to recovering maneuver accuracy in classical coning algorithms, 2013.
    """

    name: ClassVar[str] = "rotation-vector"
    source: ClassVar[Source] = XU.at("Eq. 4")

    coefficients: str = "polynomial"

    def __post_init__(self) -> None:
        require_samples(self)
        require_choice("coefficients", self.coefficients, SETS)

    @property
    def order_periodic(self) -> int:
        """2 for N = 1, 4 from there; 3 with compressed products."""
        if self.samples <= 2:
            return 2 * self.samples
        return 3 if self.coefficients == "coning-optimised" else 4

    @property
    def order_drift(self) -> int:
        """2 for N = 1, 4 to N = 3 and with compressed products, else 6: all limited by the missing third order."""
        if self.samples <= 2:
            return 2 * self.samples
        return 4 if self.samples == 3 or self.coefficients == "coning-optimised" else 6

    def _constants(self) -> tuple[Any, ...]:
        return kernel_arguments(SETS[self.coefficients](self.samples), weight=1.0)

    def _update(
        self,
        constants: tuple[Any, ...],
        dtheta: Array,
        starts: NDArray[np.int64],
        offsets: NDArray[np.int64],
        dt: float,
        carry: Array,
        out: Array,
    ) -> None:
        from bench.solvers.attitude._rotation_vector_kernels import rotation_vectors, turn

        K, first = constants
        rotation_vectors(K, first, dtheta, starts, out)
        turn(carry, out)
