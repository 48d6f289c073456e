"""Dual Euler: forward and reverse Euler angles integrated by turns, each far from where it is singular."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bench.errors import Array
from bench.euler_angles import HYSTERESIS, DualAngles, require_hysteresis, thresholds, track
from bench.references import LYU, Source
from bench.rotation import wrap
from bench.solvers.attitude import AttitudeSolver, require_samples
from bench.solvers.attitude._rate_fit import difference_tables


def running_angles(q0: Array) -> Array:
    """Return the state of the kernels at an attitude: the active angles (3), the attitude (4) and the side."""
    start = track(q0[np.newaxis])
    active = start.forward[0]
    if start.flag[0] < 0:  # as `bench.euler_angle_kernels` has them: yaw, middle, inner
        psi_r, P_r, R_r = start.reverse[0]
        active = np.array([wrap(psi_r + math.pi / 2), R_r, -P_r])
    return np.concatenate([active, q0, start.flag])


@dataclass(frozen=True)
class DualEuler(AttitudeSolver):
    """Dual Euler: forward and reverse Euler angles integrated by turns, each far from where it is singular.

    Forward, C = Rz(psi) Rx(P) Ry(R): P' = wx cR + wz sR, psi' = (wz cR - wx sR)/cP, R' = wy - tanP (wz cR - wx sR).
    Reverse, C = Rz(psi_r) Ry(R_r) Rx(P_r): P_r' = wx + tanR_r (wy sP_r + wz cP_r), R_r' = wy cP_r - wz sP_r,
    psi_r' = (wy sP_r + wz cP_r)/cR_r. The reverse set is integrated where |P| is between 45 and 135 degrees; where it
    is, |R_r| <= 45 degrees whatever R is, and 1/cos <= 1.56 with the hysteresis. The rate over an update is the
    polynomial that reproduces its N increments; the angles over the update are their power series, with as many terms
    as rounding needs. No angle is held and nothing has to be normalised.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8.
    hysteresis : float, rad
        The reverse set takes over beyond |P| = 45 deg + hysteresis, the forward set below 45 deg - hysteresis; at
        135 deg likewise.

    Raises
    ------
    InputError
        If an option is out of range.

    Notes
    -----
    Order N + 1 for odd and N + 2 for even N, that of the fitted rate. `angles` gives the angles and the flag.

    References
    ----------
    [Lyu] Lyu, Cheng, Qiu: Dual-Euler full-attitude method, Aerospace Shanghai 2019(1).
    """

    name: ClassVar[str] = "dual-euler"
    source: ClassVar[Source] = LYU.at("sections 1 and 2, figure 3")

    samples: int = 4
    hysteresis: float = HYSTERESIS

    def __post_init__(self) -> None:
        require_samples(self)
        require_hysteresis(self.hysteresis)

    @property
    def order_periodic(self) -> int:
        """N + 1 or N + 2, the even one."""
        return self.samples + 2 - self.samples % 2

    @property
    def order_drift(self) -> int:
        """The same as the periodic order."""
        return self.order_periodic

    @property
    def constant_rate_tolerance(self) -> float:
        """What a series leaves out, and rounding of three angles of up to pi."""
        return 2e-15

    def _constants(self) -> tuple[Any, ...]:
        return difference_tables(self.samples)[0], *thresholds(self.hysteresis)

    def _carry(self, q0: Array) -> Array:
        return running_angles(q0)

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
        from bench.solvers.attitude._euler_kernels import dual_euler

        tables, enter, leave = constants
        dual_euler(tables, enter, leave, dtheta, starts, carry, out)

    def angles(self, q: ArrayLike) -> DualAngles:
        """Return both sets of Euler angles and the flag along a solution of this solver, shape (n, 4).

        The flag is the one that the solver went by: it follows from the attitude at every update alone. The active
        angles are those that were integrated, to rounding.
        """
        return track(q, self.hysteresis)
