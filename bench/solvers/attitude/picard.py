"""Picard: the one-sample quaternion of the increment, its exponential cut off after a few of Picard's iterations."""

from dataclasses import dataclass
from math import atan2
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array, InputError, require_integer
from bench.references import XU, Source
from bench.rotation import quat_normalize
from bench.solvers.attitude import AttitudeSolver, require_samples

HIGHEST = 4


@dataclass(frozen=True)
class Picard(AttitudeSolver):
    """Picard: the one-sample quaternion of the increment, its exponential cut off after a few of Picard's iterations.

    With the rate held over one interval, q' = 1/2 q o (0, omega) is solved by exp(dtheta/2), whose terms up to the
    given power are kept: first order (1, dtheta/2), second (1 - s/8, dtheta/2), third (1 - s/8, (1/2 - s/48) dtheta),
    fourth (1 - s/8 + s^2/384, (1/2 - s/48) dtheta), s = |dtheta|^2. q is normalised in every update. This is the
    traditional quaternion algorithm, the one-sample rotation vector in essence: it knows no coning.

    Parameters
    ----------
    samples : int
        1.
    order : int
        Picard's iterations, 1 to 4.

    Raises
    ------
    InputError
        If an option is out of range.

    Notes
    -----
    Order 2 in dt (coning, both periodic and drift), whatever the order of the exponential.

    References
    ----------
    [Xu] Xu et al., Performance analysis of high-precision strapdown inertial navigation attitude algorithms, 2019
    (the traditional quaternion algorithm it sets out from).
    """

    name: ClassVar[str] = "picard"
    source: ClassVar[Source] = XU.at("section 1.2, the traditional algorithm, on equation 5")

    samples: int = 1
    order: int = HIGHEST

    def __post_init__(self) -> None:
        require_samples(self, 1, 1)
        if require_integer("order", self.order, minimum=1) > HIGHEST:
            raise InputError(f"order must be an integer from 1 to {HIGHEST}, got {self.order}")

    @property
    def order_periodic(self) -> int:
        """2: the rate is held."""
        return 2

    @property
    def order_drift(self) -> int:
        """2: the coning of an interval is not seen."""
        return 2

    @property
    def constant_rate_tolerance(self) -> float:
        """What the cut exponential lacks of an angle of 0.1 rad, and rounding."""
        cosine, sine = self._constants()
        square = 0.1**2
        angle = 2 * atan2(0.1 * (sine[0] + square * sine[1]), 1 + square * (cosine[0] + square * cosine[1]))
        return abs(angle - 0.1) + 4e-16

    def _constants(self) -> tuple[Any, ...]:
        keep = np.arange(1, HIGHEST + 1) <= self.order
        cosine = np.array([-1 / 8 * keep[1], 1 / 384 * keep[3]])
        sine = np.array([1 / 2, -1 / 48 * keep[2]])
        return cosine, sine

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
        from bench.solvers.attitude._traditional_kernels import picard

        cosine, sine = constants
        picard(cosine, sine, dtheta, starts, carry, out)
