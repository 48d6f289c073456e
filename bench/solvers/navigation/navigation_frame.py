"""Navigation frame: the conventional strapdown INS, attitude and velocity in the local level frame n."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from bench.earth import Earth
from bench.errors import AccuracyError, Array, require_choice, require_integer
from bench.references import WANG, Source
from bench.rotation import quat_conjugate, quat_rotate
from bench.solvers.navigation import NavigationSolver
from bench.solvers.navigation._coefficients import double_sum, scrolling, sculling
from bench.trajectory import NavigationInitial


@dataclass(frozen=True)
class NavigationFrame(NavigationSolver):
    """Navigation frame: x."""

    name: ClassVar[str] = "navigation-frame"
    source: ClassVar[Source] = WANG

    rotation: str = "exact"
    position: str = "scrolling"
    azimuth: str = "north"
    compensate_every: int = 1

    def _check_options(self) -> None:
        require_choice("rotation", self.rotation, ("first-order", "exact"))
        require_choice("position", self.position, ("trapezoid", "scrolling"))
        require_choice("azimuth", self.azimuth, ("north", "wander"))
        require_integer("compensate_every", self.compensate_every, minimum=1)

    def _constants(self, earth: Earth, dt: float) -> tuple[Any, ...]:
        N = self.samples
        S = np.array(sculling(N), dtype=np.float64)
        if self.rotation == "first-order":
            S += 0.5
        a, L = (np.array(table(N), dtype=np.float64) for table in (double_sum, scrolling))
        return earth.parameters, S, a, L, N * dt

    def _carry(self, earth: Earth, dt: float, initial: NavigationInitial, row: Array) -> Array:
        q_en = earth.q_en(initial.latitude, initial.longitude)
        half = 0.5 * initial.longitude + np.pi / 4
        tilt = np.pi / 4 - 0.5 * initial.latitude
        frame = [np.cos(half), np.sin(half), np.cos(tilt), np.sin(tilt)] if self.azimuth == "north" else q_en
        R_M, R_N = earth.radii(initial.latitude)
        e2 = earth.eccentricity_squared
        across = 1 / (R_N + initial.height)
        w2 = 1 - e2 * np.sin(initial.latitude) ** 2
        c = across * R_N * e2 / (R_N * (1 - e2) + initial.height * w2)
        v = initial.v_n * ([1, 1, 0] if self.height == "held" else [1, 1, 1])
        g = quat_rotate(quat_conjugate(q_en), earth.gravity(row[7:]))
        return np.concatenate([initial.q_nb, frame, v, [initial.height], g, [across, c], np.zeros(3)])

    def _update(self, constants: tuple[Any, ...], increments: Array, first: int, carry: Array, out: Array) -> None:
        from bench.solvers.navigation._navigation_frame_kernels import navigate

        done = navigate(
            *constants,
            self.rotation == "exact",
            self.position == "scrolling",
            self.azimuth == "north",
            self.height == "held",
            self.compensate_every,
            increments,
            first,
            carry,
            out,
        )
        if done < len(out):
            raise AccuracyError(f"{self.name} comes too close to a pole at update {first + done}: use azimuth='wander'")
