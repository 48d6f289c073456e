"""First-order quaternion: the crudest strapdown INS, as comparisons with "the quaternion method" may have it."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from bench.earth import Earth
from bench.errors import Array, InputError, require_choice
from bench.references import LYU, Source
from bench.solvers.navigation import NavigationSolver
from bench.trajectory import NavigationInitial

MOMENTS = {"start": -1, "middle": 0, "end": 1}
NEAR_POLE = 1e-6  # rad


@dataclass(frozen=True)
class FirstOrderQuaternion(NavigationSolver):
    """First-order quaternion: the crudest strapdown INS, as comparisons with "the quaternion method" may have it.

    ``q_nb += 1/2 (q_nb o dtheta - zeta o q_nb)``, ``zeta = T omega_in``; ``v_n += q_nb o dvel o q_nb* +
    T (g - (2 omega_ie + omega_en) x v_n)``; latitude and longitude from the mean of the velocities at both ends. The
    norm of q_nb grows by ``sqrt(1 + |dtheta - zeta|^2/4)`` in every update unless it is normalised, and scales the
    specific force by its square. Its worst error is another: a body that turns at omega during the update has its
    specific force resolved half an update too early or too late, off by ``omega T/2 x f``.

    Parameters
    ----------
    samples : int
        1.
    height
        As for every navigation solver.
    resolved : {"start", "middle", "end"}
        Which attitude resolves the velocity increment of an update: that at its start, that at its end, or half-way
        (the first-order rotation compensation 1/2 dtheta x dvel), which removes the worst error.
    normalised : bool
        Whether q_nb is normalised at every update.

    Raises
    ------
    InputError
        If an option is out of range; in use, if it starts within 1e-6 rad of a pole.

    Notes
    -----
    Order 1 in dt; 2 with `resolved` "middle" and `normalised`, but for omega_in, gravity and Coriolis acceleration,
    which are those at the start of an update: of order 1, but small.

    References
    ----------
    [Lyu] Lyu, Cheng, Qiu: Dual-Euler full-attitude method, Aerospace Shanghai 2019(1), which does not say which
    quaternion algorithm it compares with.
    """

    name: ClassVar[str] = "first-order-quaternion"
    source: ClassVar[Source] = LYU.at("section 3.3, the quaternion method as it may have been")
    max_samples: ClassVar[int] = 1

    samples: int = 1
    resolved: str = "start"
    normalised: bool = False

    def _check_options(self) -> None:
        require_choice("resolved", self.resolved, MOMENTS)
        if not isinstance(self.normalised, bool):
            raise InputError(f"normalised must be True or False, got {self.normalised!r}")

    @property
    def order_periodic(self) -> int:
        """1, or 2 where both the norm and the time of the force are mended."""
        return 2 if self.resolved == "middle" and self.normalised else 1

    def _constants(self, earth: Earth, dt: float) -> tuple[Any, ...]:
        return earth.parameters, dt

    def _carry(self, earth: Earth, dt: float, initial: NavigationInitial, row: Array) -> Array:
        if abs(initial.latitude) > np.pi / 2 - NEAR_POLE:
            raise InputError(f"{self.name} must start {NEAR_POLE:g} rad away from the poles, got {initial.latitude!r}")
        v = initial.v_n * [1.0, 1.0, 0.0 if self.height == "held" else 1.0]
        return np.concatenate([initial.q_nb, v, [initial.latitude, initial.longitude, initial.height]])

    def _update(self, constants: tuple[Any, ...], increments: Array, first: int, carry: Array, out: Array) -> None:
        from bench.solvers.navigation._first_order_quaternion_kernels import navigate

        parameters, T = constants
        moment, holds = MOMENTS[self.resolved], self.height == "held"
        navigate(parameters, T, moment, self.normalised, holds, increments, carry, out)
