"""Runge-Kutta DCM: one classical fourth-order step of the direction cosine matrix an update, on a fitted rate."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array, require_flag
from bench.references import XU, Source
from bench.rotation import matrix_from_quat, quat_normalize
from bench.solvers.attitude import AttitudeSolver, require_samples
from bench.solvers.attitude._rate_fit import runge_kutta_rates


@dataclass(frozen=True)
class RungeKuttaDcm(AttitudeSolver):
    """Runge-Kutta DCM: one classical fourth-order step of the direction cosine matrix an update, on a fitted rate.

    C' = C [omega x], with omega at the start, in the middle and at the end of the update from the polynomial that
    reproduces its N increments: held for N = 1, linear for N = 2. A constant rate is not integrated exactly: an angle
    x per update is x^5/120 short.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8; above 2 the step limits the accuracy.
    orthonormalise : bool
        Whether the running matrix is made orthonormal in every update.

    Raises
    ------
    InputError
        If an option is out of range.

    Notes
    -----
    Order 4 for N >= 2 and 2 for N = 1 (coning, both periodic and drift).

    References
    ----------
    [Xu] Xu et al., Performance analysis of high-precision strapdown inertial navigation attitude algorithms, 2019
    (the traditional algorithms it sets out from).
    """

    name: ClassVar[str] = "runge-kutta-dcm"
    source: ClassVar[Source] = XU.at("section 1.3, the traditional algorithm, on equation 10")

    samples: int = 2
    orthonormalise: bool = True

    def __post_init__(self) -> None:
        require_samples(self)
        require_flag("orthonormalise", self.orthonormalise)

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
        """x^5/120 of the angle x = 0.1 rad of an update, and a margin for what is not orthonormal."""
        return (1.01 if self.orthonormalise else 1.2) * 0.1**5 / 120

    def _constants(self) -> tuple[Any, ...]:
        return (runge_kutta_rates(self.samples),)

    def _carry(self, q0: Array) -> Array:
        return matrix_from_quat(quat_normalize(q0)).ravel()

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
        from bench.solvers.attitude._traditional_kernels import runge_kutta_matrix

        (rates,) = constants
        runge_kutta_matrix(rates, self.orthonormalise, dtheta, starts, carry, out)
