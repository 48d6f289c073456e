"""Hybrid: the exact turn of a polynomial rate, its second-order part replaced by the coning-exact one."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array
from bench.references import SONG, Source
from bench.solvers.attitude import AttitudeSolver, require_samples
from bench.solvers.attitude._coefficients import coning_manoeuvre_exact, kernel_arguments, polynomial
from bench.solvers.attitude._rate_fit import rate_matrix


@dataclass(frozen=True)
class Hybrid(AttitudeSolver):
    """Hybrid: the exact turn of a polynomial rate, its second-order part replaced by the coning-exact one.

    phi = log(q_poly) + sum_{i<j} (K^c_ij - K^a_ij) dtheta_i x dtheta_j: q_poly is the exact attitude of the
    polynomial rate through the N increments (a power series to rounding), K^a what it holds of second order, K^c the
    coning-manoeuvre-exact coefficients of [Song]. It has the third and higher orders that a rotation vector lacks,
    and on coning the small drift that a polynomial lacks.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8. For N = 1 and 2 the correction is zero: the exact polynomial alone.

    Raises
    ------
    InputError
        If `samples` is out of range.
    AccuracyError
        In use, if the rate turns so far within one increment (about 20 rad) that a power series loses its digits.

    References
    ----------
    [Song] Song, Wu, Pan, Approach to recovering maneuver accuracy in classical coning algorithms, 2013.
    """

    name: ClassVar[str] = "hybrid"
    source: ClassVar[Source] = SONG.at("its coefficients, in the exact turn of the fitted polynomial")

    def __post_init__(self) -> None:
        require_samples(self)

    @property
    def order_periodic(self) -> int:
        """N + 1 or N + 2, the even one: that of the polynomial."""
        return self.samples + 2 - self.samples % 2

    @property
    def order_drift(self) -> int:
        """As the periodic order."""
        return self.order_periodic

    def _constants(self) -> tuple[Any, ...]:
        N = self.samples
        pairs = zip(coning_manoeuvre_exact(N), polynomial(N), strict=True)
        change = tuple(tuple(c - a for c, a in zip(*rows, strict=True)) for rows in pairs)
        return *kernel_arguments(change, weight=0.0), np.array([rate_matrix(1, N, j) for j in range(N)])

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
        from bench.solvers.attitude._rotation_vector_kernels import add_polynomial_turns, rotation_vectors, turn

        K, first, tables = constants
        rotation_vectors(K, first, dtheta, starts, out)
        add_polynomial_turns(tables, dtheta, starts, out)
        turn(carry, out)
