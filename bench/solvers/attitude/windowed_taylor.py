"""Windowed Taylor: a Taylor quaternion whose rate is fitted to a window longer than the update."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array, InputError, require_flag, require_integer
from bench.references import XU, Source
from bench.rotation import quat_normalize
from bench.solvers.attitude import AttitudeSolver, require_samples
from bench.solvers.attitude._rate_fit import difference_tables
from bench.solvers.attitude._truncation import MOST_TERMS, first_left_out, require_terms, warn_if_truncated

LONGEST = 16  # increments; beyond, the ends of a stream amplify the roundings of the increments


@dataclass(frozen=True)
class WindowedTaylor(AttitudeSolver):
    """Windowed Taylor: a Taylor quaternion whose rate is fitted to a window longer than the update.

    The rate is the polynomial of degree W - 1 that reproduces the W increments of a window with the update's N in its
    middle, integrated over these N by the recursion of `TaylorQuaternion`, but from the middle of the update to both
    sides, where the coefficients are smallest. On smooth motions every two increments
    borrowed gain two orders; noise and steps of the rate are amplified, as by any fit of high degree.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8.
    window : int
        W, increments the rate is fitted to, N to 16.
    causal : bool
        Borrow from the past only: no latency, but larger errors. Only the first window is then waited for.
    terms : int, optional
        Power after which the series is cut off, 1 to 300. By default every update takes as many terms as
        its increments need for rounding, at most 300.

    Raises
    ------
    InputError
        If an option is out of range, or window - samples is odd and not all of it can be borrowed from the past.

    Warns
    -----
    BenchWarning
        Once a solve, if the increments need more terms.

    Notes
    -----
    Order W + 2 for even W and W + 1 otherwise; causal, W + 1 in the periodic error (coning). Both ends of a stream
    use the first or last W increments, with larger errors in these few updates. Exact for a rate that is a polynomial
    of degree W - 1.

    References
    ----------
    [Xu] Xu et al., Performance analysis of high-precision strapdown inertial navigation attitude algorithms, 2019
    (the series; it is fitted to N increments there).
    """

    name: ClassVar[str] = "windowed-taylor"
    source: ClassVar[Source] = XU.at("equations 5 to 9, the rate fitted to a longer window")

    samples: int = 4
    window: int = 12
    causal: bool = False
    terms: int | None = None

    def __post_init__(self) -> None:
        require_samples(self)
        require_flag("causal", self.causal)
        require_terms(self.terms)
        if require_integer("window", self.window, minimum=self.samples) > LONGEST:
            raise InputError(f"window must be an integer from samples = {self.samples} to {LONGEST}, got {self.window}")
        if not self.causal and (self.window - self.samples) % 2:
            raise InputError(
                f"window - samples must be even unless causal, got window = {self.window}, samples = {self.samples}"
            )

    @property
    def borrowed(self) -> tuple[int, int]:
        """Half of the surplus before and half after the update; all of it before if causal."""
        surplus = self.window - self.samples
        return (surplus, 0) if self.causal else (surplus // 2, surplus // 2)

    @property
    def order_periodic(self) -> int:
        """W + 1, and one more for an even window in the middle; limited by the terms."""
        central = self.window % 2 == 0 and self.borrowed[0] == self.borrowed[1]
        return min(self.window + 1 + central, self._terms)

    @property
    def order_drift(self) -> int:
        """W + 1 or W + 2, the even one; limited by the terms, to an even order too."""
        terms = self._terms
        return min(self.window + 2 - self.window % 2, terms + terms % 2)

    @property
    def constant_rate_tolerance(self) -> float:
        """Rounding, in the fit too, and the first term of exp(x), x = 0.05 rad, that is left out."""
        return 1e-15 + 2 * first_left_out(0.05, self._terms)

    @property
    def _terms(self) -> int:
        return MOST_TERMS if self.terms is None else self.terms

    def _constants(self) -> tuple[Any, ...]:
        factors = 0.5 / np.arange(1.0, self._terms + 1)
        return difference_tables(self.samples, self.window, centred=True), factors, self.terms is None, True

    def _carry(self, q0: Array) -> Array:
        # q, what rounding took from it, the largest |w_m|^2, whether a warning was given
        return np.concatenate([quat_normalize(q0), np.zeros(4 + self.window + 1)])

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
            carry[-1] = warn_if_truncated(self.name, self._terms, largest, share=0.5, angle=4.0)
