"""Dual quaternion: attitude and thrust velocity as one screw motion, gravitational velocity as another."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from bench.earth import Earth
from bench.errors import Array, require_choice
from bench.references import WU_DUAL, Source
from bench.rotation import cross, quat_multiply
from bench.solvers.attitude._coefficients import polynomial
from bench.solvers.navigation import NavigationSolver
from bench.solvers.navigation._coefficients import double_sum, scrolling, sculling
from bench.trajectory import NavigationInitial

POSITIONS = ("scrolling", "trapezoid")


@dataclass(frozen=True)
class DualQuaternion(NavigationSolver):
    """Dual quaternion: attitude and thrust velocity as one screw motion, gravitational velocity as another.

    q + eps q_d with q_d = 1/2 v_t o q_ib obeys 2 q' = q o (omega_ib + eps f_b): an update multiplies it by the
    exponential of the screw sigma + eps sigma', which are the sums with coning and sculling of `InertialFrame`. The
    exponential turns f exactly for constant rate and force: no rotation compensation is added. The gravitational
    velocity v_g is the dual part of a frame parallel to e, of twist omega_ie + eps G(r half-way);
    ``v_e = C_ei (v_t + v_g) - omega_ie x r_e``. After every update the dual quaternions are made unit.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8.
    height : {"free", "held"}
        As for every navigation solver; a held height changes v_g.
    position : {"scrolling", "trapezoid"}
        The displacement by double integrals of the increments, or from the velocities before and after an update, as
        in `InertialFrame`.

    Raises
    ------
    InputError
        If an option is out of range.

    Notes
    -----
    Order 4 in dt for N >= 2; 2 for N = 1 and in the position by the trapezoid. v_t and v_g grow to g t and cancel in
    their sum, and every product rounds q_d: after an hour that is 1e-6 m/s.

    References
    ----------
    [Wang] Wang, Chen, Zeng, Rotation vector and dual quaternion strapdown algorithms in the inertial frame, section 2.
    [WuDual] Wu, Hu, Hu, Li, Lian, Strapdown inertial navigation system algorithms based on dual quaternions, IEEE
    Trans. Aerospace and Electronic Systems 41(1), 2005.
    """

    name: ClassVar[str] = "dual-quaternion"
    source: ClassVar[Source] = WU_DUAL

    position: str = "scrolling"

    def _check_options(self) -> None:
        require_choice("position", self.position, POSITIONS)

    @property
    def order_periodic(self) -> int:
        """4, or 2 where a part is of second order only: the lowest of attitude, velocity and position."""
        return 4 if self.samples > 1 and self.position == "scrolling" else 2

    def _constants(self, earth: Earth, dt: float) -> tuple[Any, ...]:
        N = self.samples
        K, S, a, L = (np.array(table(N), dtype=np.float64) for table in (polynomial, sculling, double_sum, scrolling))
        quarter = 0.25 * earth.rate * N * dt
        return earth.parameters, N * dt, np.array([np.cos(quarter), np.sin(quarter)]), K, S, a, L

    def _carry(self, earth: Earth, dt: float, initial: NavigationInitial, row: Array) -> Array:
        q, v_e, r = row[:4], row[4:7], row[7:]
        v_t = v_e + cross(earth.omega_ie, r)
        dual = 0.5 * quat_multiply(np.append(0.0, v_t), q)
        change = self.samples * dt * earth.gravitation(r)
        return np.concatenate([q, dual, np.zeros(4), r, np.zeros(3), change, [initial.height]])

    def _update(self, constants: tuple[Any, ...], increments: Array, first: int, carry: Array, out: Array) -> None:
        from bench.solvers.navigation._dual_quaternion_kernels import dual_quaternion

        p, T, quarter, K, S, a, L = constants
        scrolls, holds = self.position == "scrolling", self.height == "held"
        dual_quaternion(p, T, quarter, K, S, a, L, scrolls, holds, increments, first, carry, out)
