"""First-order quaternion: q + q o (0, dtheta)/2 of every increment, never normalised inside."""

from dataclasses import dataclass
from math import atan
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array
from bench.references import LYU, Source
from bench.solvers.attitude import AttitudeSolver, require_samples


@dataclass(frozen=True)
class FirstOrderQuaternion(AttitudeSolver):
    """First-order quaternion: q + q o (0, dtheta)/2 of every increment, never normalised inside.

    The crudest quaternion algorithm, which comparisons like to take for the quaternion method. Its norm grows by
    sqrt(1 + |dtheta|^2/4) in every update. The attitude it gives is q/|q|, and as each update is linear in q that is
    the attitude of `picard` with order 1: an angle x per update is x^3/12 short. A navigation algorithm that takes its
    matrix from q without the division scales every velocity increment by |q|^2.

    Parameters
    ----------
    samples : int
        1.

    Raises
    ------
    InputError
        If `samples` is not 1.

    Notes
    -----
    Order 2 in dt (coning, both periodic and drift). The state's carry is q with its norm.

    References
    ----------
    [Lyu] Lyu, Cheng, Qiu: Dual-Euler full-attitude method, Aerospace Shanghai 2019(1), which does not say which
    quaternion algorithm it compares with.
    """

    name: ClassVar[str] = "first-order-quaternion"
    source: ClassVar[Source] = LYU.at("section 3.3, the quaternion method as it may have been")

    samples: int = 1

    def __post_init__(self) -> None:
        require_samples(self, 1, 1)

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
        """What 2 atan(x/2) lacks of the angle x = 0.1 rad, and rounding."""
        return 0.1 - 2 * atan(0.05) + 4e-16

    def _constants(self) -> tuple[Any, ...]:
        return ()

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
        from bench.solvers.attitude._euler_kernels import first_order_quaternion

        first_order_quaternion(dtheta, starts, carry, out)
