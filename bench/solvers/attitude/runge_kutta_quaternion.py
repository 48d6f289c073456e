"""Runge-Kutta quaternion: one classical fourth-order step an update, on the rate fitted to its increments."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array
from bench.references import XU, Source
from bench.rotation import quat_normalize
from bench.solvers.attitude import AttitudeSolver, require_samples
from bench.solvers.attitude._rate_fit import runge_kutta_rates


@dataclass(frozen=True)
class RungeKuttaQuaternion(AttitudeSolver):
    """Runge-Kutta quaternion: one classical fourth-order step an update, on the rate fitted to its increments.

    q' = 1/2 q o (0, omega), with omega at the start, in the middle and at the end of the update from the polynomial
    that reproduces its N increments: held for N = 1, linear in the classical two-sample algorithm (3 d1 - d2, d1 + d2,
    3 d2 - d1, divided by the update's length). q is normalised in every update. A constant rate is not integrated
    exactly: an angle x per update is x^5/1920 short.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8; above 2 the step limits the accuracy.

    Raises
    ------
    InputError
        If `samples` is out of range.

    Notes
    -----
    Order 4 for N >= 2 and 2 for N = 1 (coning, both periodic and drift).

    References
    ----------
    [Xu] Xu et al., Performance analysis of high-precision strapdown inertial navigation attitude algorithms, 2019
    (the traditional algorithms it sets out from).
    """

    name: ClassVar[str] = "runge-kutta-quaternion"
    source: ClassVar[Source] = XU.at("section 1.2, the traditional algorithm, on equation 5")

    samples: int = 2

    def __post_init__(self) -> None:
        require_samples(self)

    @property
    def order_periodic(self) -> int:
        """4, or 2 with the rate held."""
        return 2 if self.samples == 1 else 4

    @property
    def order_drift(self) -> int:
        """The same as the periodic order."""
        return self.order_periodic

    @property
    def constant_rate_tolerance(self) -> float:
        """x^5/1920 of the angle x = 0.1 rad of an update, with a margin for higher powers and rounding."""
        return 1.01 * 0.1**5 / 1920

    def _constants(self) -> tuple[Any, ...]:
        return (runge_kutta_rates(self.samples),)

    def _carry(self, q0: Array) -> Array:
        return np.concatenate([quat_normalize(q0), np.zeros(4)])  # q, and what rounding took from it

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
        from bench.solvers.attitude._traditional_kernels import runge_kutta_quaternion

        (rates,) = constants
        runge_kutta_quaternion(rates, dtheta, starts, carry, out)
