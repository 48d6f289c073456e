"""Inertial frame: attitude by the rotation vector, thrust and gravitational velocity, and position, all in i."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from bench.earth import Earth
from bench.errors import Array, require_choice
from bench.references import WANG, Source
from bench.rotation import cross
from bench.solvers.attitude._coefficients import polynomial
from bench.solvers.navigation import NavigationSolver
from bench.solvers.navigation._coefficients import double_sum, scrolling, sculling
from bench.trajectory import NavigationInitial

ROTATIONS = ("exact", "first-order")
POSITIONS = ("scrolling", "trapezoid")


@dataclass(frozen=True)
class InertialFrame(NavigationSolver):
    """Inertial frame: attitude by the rotation vector, thrust and gravitational velocity, and position, all in i.

    Nothing turns but the body: no Coriolis term, no compensation of a turning n, no singular latitude. With the
    rotation vector sigma = sum d_i + sum_{i<j} K_ij d_i x d_j of the angle increments d, and
    sigma' = sum u_i + sum_{i<j} K_ij (d_i x u_j + u_i x d_j) of the velocity increments u (K of the fitted polynomials,
    2/3 for N = 2), an update is ``v_t += C_ib (sigma' + rotation)``, ``v_g += T G(r half-way)``,
    ``q_ib <- q_ib o exp(sigma/2)``; then ``v_e = C_ei (v_t + v_g) - omega_ie x r_e``.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8.
    height : {"free", "held"}
        As for every navigation solver; a held height changes v_g.
    rotation : {"exact", "first-order"}
        Compensation of the turn of the body within an update: exact for constant rate and force,
        (1 - cos s)/s^2 sigma x sigma' + (1 - sin s/s)/s^2 sigma x (sigma x sigma'), s = |sigma|; or
        (sum d) x (sum u)/2 as in [Wang], under attitude motion some 20 to 30 times worse in velocity.
    position : {"scrolling", "trapezoid"}
        The displacement by double integrals of the increments, of the same order as the velocity ([Savage2]), or
        from the velocities before and after an update, which errs by T^2/12 times the change of the acceleration.

    Raises
    ------
    InputError
        If an option is out of range.

    Notes
    -----
    Order 4 in dt for N >= 2, limited by the missing third order of sigma and sigma'; 2 for N = 1, in the position by
    the trapezoid, and in velocity and position with first-order rotation. G is held in e over an update, as in
    `DualQuaternion`, with which the exact rotation agrees to rounding.

    References
    ----------
    [Wang] Wang, Chen, Zeng, Rotation vector and dual quaternion strapdown algorithms in the inertial frame, section 3.
    [Savage2] Savage, Strapdown inertial navigation integration algorithm design part 2: velocity and position
    algorithms, J. Guidance, Control, and Dynamics 21(2), 1998.
    """

    name: ClassVar[str] = "inertial-frame"
    source: ClassVar[Source] = WANG.at("section 3")

    rotation: str = "exact"
    position: str = "scrolling"

    def _check_options(self) -> None:
        require_choice("rotation", self.rotation, ROTATIONS)
        require_choice("position", self.position, POSITIONS)

    @property
    def order_periodic(self) -> int:
        """4, or 2 where a part is of second order only: the lowest of attitude, velocity and position."""
        best = self.samples > 1 and self.rotation == "exact" and self.position == "scrolling"
        return 4 if best else 2

    def _constants(self, earth: Earth, dt: float) -> tuple[Any, ...]:
        N = self.samples
        K, S, a, L = (np.array(table(N), dtype=np.float64) for table in (polynomial, sculling, double_sum, scrolling))
        if self.rotation == "first-order":
            S += 0.5  # of sum_ij d_i x u_j = d x u
        fade = np.sinc(0.5 * earth.rate * N * dt / np.pi)
        return earth.parameters, N * dt, float(fade), K, S, a, L

    def _carry(self, earth: Earth, dt: float, initial: NavigationInitial, row: Array) -> Array:
        q, v_e, r = row[:4], row[4:7], row[7:]
        v_t = v_e + cross(earth.omega_ie, r)
        return np.concatenate([q, v_t, np.zeros(3), r, np.zeros(3), earth.gravitation(r), [initial.height]])

    def _update(self, constants: tuple[Any, ...], increments: Array, first: int, carry: Array, out: Array) -> None:
        from bench.solvers.navigation._inertial_frame_kernels import inertial_frame

        p, T, fade, K, S, a, L = constants
        exact, scrolls, holds = self.rotation == "exact", self.position == "scrolling", self.height == "held"
        inertial_frame(p, T, fade, K, S, a, L, exact, scrolls, holds, increments, first, carry, out)
