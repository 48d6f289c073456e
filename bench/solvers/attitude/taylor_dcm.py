"""Taylor DCM: the direction cosine matrix's power series for a polynomial rate fitted to N increments."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array, require_flag
from bench.references import XU, Source
from bench.rotation import matrix_from_quat, quat_normalize
from bench.solvers.attitude import AttitudeSolver, require_samples
from bench.solvers.attitude._rate_fit import difference_tables
from bench.solvers.attitude._truncation import MOST_TERMS, first_left_out, require_terms, warn_if_truncated


@dataclass(frozen=True)
class TaylorDcm(AttitudeSolver):
    """Taylor DCM: the direction cosine matrix's power series for a polynomial rate fitted to N increments.

    The rate over an update is the polynomial sum_m w_m u^m, u in [0, 1], that reproduces the N increments. The matrix
    of the update is C(1) = sum_k C_k, C_0 = I, C_{k+1} = 1/(k+1) sum_m C_{k-m} [w_m x]. Equations 11 and 13 of [Xu]
    have the rate on the wrong side of C, and 13 lacks the factorials of the rate's derivatives; this is what they mean.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8.
    terms : int, optional
        Power after which the series is cut off, 1 to 300; 10 in [Xu]. By default every update takes as many terms as
        its increments need for rounding, at most 300.
    orthonormalise : bool
        Whether the running matrix is made orthonormal in every update; False as in [Xu].

    Raises
    ------
    InputError
        If an option is out of range.

    Warns
    -----
    BenchWarning
        Once a solve, if the increments need more terms: the estimate follows from sum |w_m|, and is in the message.

    Notes
    -----
    Order N + 1 for odd and N + 2 for even N (coning, both periodic and drift), but with K = `terms` not more than K,
    and K + 1 in the drift for odd K.

    References
    ----------
    [Xu] Xu et al., Performance analysis of high-precision strapdown inertial navigation attitude algorithms, 2019.
    """

    name: ClassVar[str] = "taylor-dcm"
    source: ClassVar[Source] = XU.at("equations 10 to 13")

    terms: int | None = None
    orthonormalise: bool = True

    def __post_init__(self) -> None:
        require_samples(self)
        require_terms(self.terms)
        require_flag("orthonormalise", self.orthonormalise)

    @property
    def order_periodic(self) -> int:
        """N + 1 or N + 2, the even one; limited by the terms."""
        return min(self.samples + 2 - self.samples % 2, self._terms)

    @property
    def order_drift(self) -> int:
        """N + 1 or N + 2, the even one; limited by the terms, to an even order too."""
        return min(self.samples + 2 - self.samples % 2, self._terms + self._terms % 2)

    @property
    def constant_rate_tolerance(self) -> float:
        """Rounding, and the first term of exp(0.1 rad) that is left out."""
        return 4e-16 + first_left_out(0.1, self._terms)

    @property
    def _terms(self) -> int:
        return MOST_TERMS if self.terms is None else self.terms

    def _constants(self) -> tuple[Any, ...]:
        factors = 1.0 / np.arange(1.0, self._terms + 1)
        return difference_tables(self.samples), factors, self.terms is None

    def _carry(self, q0: Array) -> Array:
        # C row by row, the largest |w_m|^2, whether a warning was given
        return np.concatenate([matrix_from_quat(quat_normalize(q0)).ravel(), np.zeros(self.samples + 1)])

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
        from bench.solvers.attitude._taylor_kernels import taylor_matrix

        tables, factors, adapt = constants
        largest = carry[9:-1]
        taylor_matrix(tables, factors, adapt, self.orthonormalise, dtheta, starts, offsets, largest, carry, out)
        if not carry[-1]:
            carry[-1] = warn_if_truncated(self.name, self._terms, largest, share=1.0, angle=1.0)
