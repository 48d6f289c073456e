"""Navigation frame: the conventional strapdown INS, with attitude, velocity and position in local level axes."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from bench.earth import Earth
from bench.errors import AccuracyError, Array, require_choice, require_integer
from bench.references import WANG, Source
from bench.solvers.navigation import NavigationSolver
from bench.solvers.navigation._coefficients import double_sum, scrolling, sculling
from bench.solvers.navigation.inertial_frame import POSITIONS, ROTATIONS
from bench.trajectory import NavigationInitial

AZIMUTHS = ("north", "wander")


@dataclass(frozen=True)
class NavigationFrame(NavigationSolver):
    """Navigation frame: the conventional strapdown INS, with attitude, velocity and position in local level axes.

    From the rotation vector phi, the integral u of the specific force and its double integral over an update (N
    samples; coning, sculling and scrolling from the fitted polynomials), in the axes n at the start of the update:
    ``v += C_nb u + T g - omega_ie x R``, R the displacement, then turned by ``-zeta``; ``q_nb <- exp(-zeta/2) o q_nb o
    exp(phi/2)``, ``zeta = T omega_in``. Gravity (with its horizontal part), the radii of curvature and omega_ie are
    those half-way, at the place that velocity and this update's specific force lead to.

    Parameters
    ----------
    samples, height
        As for every navigation solver.
    rotation : {"exact", "first-order"}
        Compensation of the turn of the body axes within an update: exact for a constant rate and force, or
        1/2 dtheta x dvel of the summed increments, which makes the velocity some ten to hundred times worse under
        attitude motion.
    position : {"scrolling", "trapezoid"}
        The displacement from the increments by a double integral of the same order as the velocity ([Savage2]), or
        from the velocity at both ends of an update; the latter errs by T^2/12 times the change of the acceleration.
    azimuth : {"north", "wander"}
        "north": latitude and longitude (as cos and sin of their halves: no trigonometric function is evaluated), n
        points north. "wander": the attitude of n in e as a quaternion, n does not turn about the vertical relative to
        the Earth; works everywhere, over the poles too.
    compensate_every : int
        k: the turn of n is summed and applied to the attitude at every k-th update only, as in codes that save
        operations; in between attitude and velocity make do with axes that lag behind.

    Raises
    ------
    InputError
        If an option is out of range.
    AccuracyError
        In use, with azimuth "north", within 6 m of a pole or where an update changes the longitude by more than
        10 mrad (at 3 km/s and 0.02 s: within 6 km): the gravity half-way would be taken at the wrong place.

    Notes
    -----
    Order 4 in dt for N >= 2, limited by the missing third order of the rotation vector and of u; 2 for N = 1, with
    first-order rotation, and in the position with the trapezoid. The terms of the navigation frame are of order 2,
    but small: about 1e-9 m/s^2 at 7 km/s and T = 0.02 s. In [Wang]'s form ``(I - 1/2 [zeta x]) C_nb u`` and
    ``-(2 omega_ie + omega_en) x v`` are those of this one to the second order of zeta.

    References
    ----------
    [Savage1] Savage, Strapdown inertial navigation integration algorithm design, part 1: attitude algorithms,
    J. Guidance, Control, and Dynamics 21(1), 1998.
    [Savage2] The same, part 2: velocity and position algorithms, 21(2), 1998.
    [Wang] Wang, Chen, Zeng, Rotation vector and dual quaternion strapdown algorithms in the inertial frame, section 1.
    """

    name: ClassVar[str] = "navigation-frame"
    source: ClassVar[Source] = WANG.at("section 1, conventional algorithm")

    rotation: str = "exact"
    position: str = "scrolling"
    azimuth: str = "north"
    compensate_every: int = 1

    def _check_options(self) -> None:
        require_choice("rotation", self.rotation, ROTATIONS)
        require_choice("position", self.position, POSITIONS)
        require_choice("azimuth", self.azimuth, AZIMUTHS)
        require_integer("compensate_every", self.compensate_every, minimum=1)

    @property
    def order_periodic(self) -> int | None:
        """4, or 2 where a part is of second order only; None where n is compensated late: an error of its own."""
        if self.compensate_every > 1:
            return None
        return 2 if self.samples == 1 or (self.rotation, self.position) != ("exact", "scrolling") else 4

    def _constants(self, earth: Earth, dt: float) -> tuple[Any, ...]:
        N = self.samples
        S, a, L = (np.array(table(N), dtype=np.float64) for table in (sculling, double_sum, scrolling))
        if self.rotation == "first-order":
            S += 0.5  # of sum_ij d_i x v_j = d x v
        return earth.parameters, S, a, L, N * dt

    def _carry(self, earth: Earth, dt: float, initial: NavigationInitial, row: Array) -> Array:
        from bench.solvers.navigation._navigation_frame_kernels import place

        latitude, height = initial.latitude, initial.height
        north, up, *curvature = place(earth.parameters, math.cos(latitude), math.sin(latitude), height)
        halves = np.array([0.5 * initial.longitude + math.pi / 4, math.pi / 4 - 0.5 * latitude])
        pairs = np.stack([np.cos(halves), np.sin(halves)], axis=1).ravel()
        frame = pairs if self.azimuth == "north" else earth.q_en(latitude, initial.longitude)
        v = initial.v_n * [1.0, 1.0, 0.0 if self.height == "held" else 1.0]
        return np.concatenate([initial.q_nb, frame, v, [height, 0.0, north, up], curvature, [1.0, 0.0, 0.0, 0.0]])

    def _update(self, constants: tuple[Any, ...], increments: Array, first: int, carry: Array, out: Array) -> None:
        from bench.solvers.navigation._navigation_frame_kernels import navigate

        exact, scrolls = self.rotation == "exact", self.position == "scrolling"
        north, holds = self.azimuth == "north", self.height == "held"
        every = self.compensate_every
        p, S, a, L, T = constants
        done = navigate(p, S, a, L, T, exact, scrolls, north, holds, every, increments, first, carry, out)
        if done < len(out):
            raise AccuracyError(
                f"{self.name} changes its longitude too fast in update {first + done}, next to a pole: "
                "use azimuth='wander'"
            )
