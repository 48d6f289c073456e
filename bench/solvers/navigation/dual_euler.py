"""Dual Euler: a strapdown INS whose attitude is integrated as forward and reverse Euler angles by turns."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from bench.earth import Earth
from bench.errors import AccuracyError, Array, require_choice
from bench.euler_angles import HYSTERESIS, DualAngles, require_hysteresis, thresholds, track
from bench.references import LYU, Source
from bench.solvers.attitude._rate_fit import difference_tables
from bench.solvers.attitude.dual_euler import running_angles
from bench.solvers.navigation import NavigationSolver
from bench.solvers.navigation.navigation_frame import AZIMUTHS, NavigationFrame
from bench.trajectory import NavigationInitial, Trajectory

ANGLES = 8  # of the running state, behind those of the navigation frame


@dataclass(frozen=True)
class DualEuler(NavigationSolver):
    """Dual Euler: a strapdown INS whose attitude is integrated as forward and reverse Euler angles by turns.

    The angles of b against n follow the differential equations of the attitude solver `dual-euler`, with the rate
    ``omega_nb = omega_ib - C_bn omega_in``, C_bn at every moment of the update and not held; omega_ib is the polynomial
    that reproduces its N increments. Everything else, gravity, velocity and position, is that of `navigation-frame`
    with its defaults: what the two differ by is the attitude algorithm.

    Parameters
    ----------
    samples, height
        As for every navigation solver.
    azimuth : {"north", "wander"}
        As for `navigation-frame`; the angles that are integrated are against n, whose azimuth may wander.
    hysteresis : float, rad
        As for the attitude solver `dual-euler`.

    Raises
    ------
    InputError
        If an option is out of range.
    AccuracyError
        In use, as for `navigation-frame`.

    Notes
    -----
    Order 4 in dt for N >= 2, as `navigation-frame`; the attitude is of order N + 1 for odd and N + 2 for even N.
    `angles` gives the angles and the flag.

    References
    ----------
    [Lyu] Lyu, Cheng, Qiu: Dual-Euler full-attitude method, Aerospace Shanghai 2019(1).
    """

    name: ClassVar[str] = "dual-euler"
    source: ClassVar[Source] = LYU.at("sections 1, 2 and 3.3")

    azimuth: str = "north"
    hysteresis: float = HYSTERESIS

    def _check_options(self) -> None:
        require_choice("azimuth", self.azimuth, AZIMUTHS)
        require_hysteresis(self.hysteresis)

    @property
    def order_periodic(self) -> int | None:
        """That of `navigation-frame`."""
        return self._navigation_frame.order_periodic

    @property
    def _navigation_frame(self) -> NavigationFrame:
        """The solver that does all but the attitude."""
        return NavigationFrame(self.samples, self.height, azimuth=self.azimuth)

    def _constants(self, earth: Earth, dt: float) -> tuple[Any, ...]:
        tables = difference_tables(self.samples)[0]
        return self._navigation_frame._constants(earth, dt), (tables, *thresholds(self.hysteresis))

    def _carry(self, earth: Earth, dt: float, initial: NavigationInitial, row: Array) -> Array:
        frame = self._navigation_frame._carry(earth, dt, initial, row)
        return np.concatenate([frame, running_angles(initial.q_nb)])

    def _update(self, constants: tuple[Any, ...], increments: Array, first: int, carry: Array, out: Array) -> None:
        from bench.solvers.navigation._dual_euler_kernels import navigate

        north, holds = self.azimuth == "north", self.height == "held"
        (p, S, a, L, T), (tables, enter, leave) = constants
        state, angles = carry[:-ANGLES], carry[-ANGLES:]
        done = navigate(p, S, a, L, T, north, holds, tables, enter, leave, increments, first, state, angles, out)
        if done < len(out):
            raise AccuracyError(
                f"{self.name} changes its longitude too fast in update {first + done}, next to a pole: "
                "use azimuth='wander'"
            )

    def angles(self, estimate: Trajectory) -> DualAngles:
        """Return both sets of Euler angles against north, and the flag, along a solution of this solver."""
        return track(estimate.q_nb, self.hysteresis)
