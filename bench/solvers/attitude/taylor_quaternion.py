"""Taylor quaternion: the quaternion's power series for a polynomial rate fitted to N increments."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array
from bench.references import XU, Source
from bench.rotation import quat_normalize
from bench.solvers.attitude import AttitudeSolver, require_samples
from bench.solvers.attitude._rate_fit import difference_tables
from bench.solvers.attitude._truncation import MOST_TERMS, first_left_out, require_terms, warn_if_truncated


@dataclass(frozen=True)
class TaylorQuaternion(AttitudeSolver):
    """Taylor quaternion: the quaternion's power series for a polynomial rate fitted to N increments.

    The rate over an update is the polynomial sum_m w_m u^m, u in [0, 1], that reproduces the N increments. Its
    attitude q(1) = sum_k q_k has q_0 = 1, q_{k+1} = 1/(2(k+1)) sum_m q_{k-m} o (0, w_m) (equations 5 to 9 of [Xu],
    as a recursion). Only the fit limits the accuracy, as long as the terms suffice; q is normalised in every update.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8.
    terms : int, optional
        Power after which the series is cut off, 1 to 300; 10 in [Xu]. By default every update takes as many terms as
        its increments need for rounding, at most 300.

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
    and K + 1 in the drift for odd K. The
    product of the updates is compensated for rounding.

    References
    ----------
    [Xu] Xu et al., Performance analysis of high-precision strapdown inertial navigation attitude algorithms, 2019.
    """

    name: ClassVar[str] = "taylor-quaternion"
    source: ClassVar[Source] = XU.at("equations 5 to 9")

    terms: int | None = None

    def __post_init__(self) -> None:
        require_samples(self)
        require_terms(self.terms)

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
        """Rounding, and the first term of exp(x), x = 0.05 rad, that is left out."""
        return 4e-16 + 2 * first_left_out(0.05, self._terms)

    @property
    def _terms(self) -> int:
        return MOST_TERMS if self.terms is None else self.terms

    def _constants(self) -> tuple[Any, ...]:
        factors = 0.5 / np.arange(1.0, self._terms + 1)
        return difference_tables(self.samples), factors, self.terms is None, False

    def _carry(self, q0: Array) -> Array:
        # q, what rounding took from it, the largest |w_m|^2, whether a warning was given
        return np.concatenate([quat_normalize(q0), np.zeros(4 + self.samples + 1)])

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
        from bench.solvers.attitude._taylor_kernels import taylor_quaternion

        tables, factors, adapt, centred = constants
        largest = carry[8:-1]
        taylor_quaternion(tables, factors, adapt, centred, dtheta, starts, offsets, largest, carry, out)
        if not carry[-1]:
            carry[-1] = warn_if_truncated(self.name, self._terms, largest, share=0.5, angle=2.0)
