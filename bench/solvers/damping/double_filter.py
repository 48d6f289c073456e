"""Double filter: filters 1 and 2 in series and their fusion."""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, require_choice, require_scalar
from bench.references import ZHAO, Source
from bench.solvers.damping import DampingFilter, DampingSolution, DampingState
from bench.solvers.damping._change_options import change_variance, check_change, steps_of
from bench.solvers.damping._samples import InsSamples
from bench.solvers.damping._serial import Carry, run, start

MEANS = ("cumulative", "window")


class FusionCarry(NamedTuple):
    """Carry of the two filters, and of the mean difference between them.

    `state` (14,) is the sum of the differences and their number, `box` (w, 13) the last of them (none if cumulative).
    """

    carry: Carry
    state: Array
    box: Array


@dataclass(frozen=True)
class DoubleFilter(DampingFilter):
    """Double filter: velocity-error and velocity-change in series, fused state by state.

    P_g = (1/p1' + 1/p2)^-1, X_g = P_g (X1/p1' + X2/p2) on the diagonals, with p1' = p1 + gamma Xbar^2, Xbar the mean of
    X1 - X2 and gamma = 1/(1 + exp(-a (t - t0 - tm))), which distrusts filter 1 later on (Eqs. 8 to 10; beta on P22 in
    Eq. 10 is a slip). The two are fused as if independent, which they are not. With the defaults the solution's `parts`
    are what `velocity-error` and `velocity-change` give.

    Parameters
    ----------
    interval : float, s
        T over which filter 2 takes the change of the velocity error: 1 to 15 s, a whole number of samples.
    change_noise : float, m/s^2 or m/s
        Noise of that change, m/s^2 or m/s: R2 is made of it as `r2_reading` says.
    r2_reading : {"acceleration", "velocity"}
        "acceleration" takes `change_noise` as m/s^2; "velocity" takes it as m/s, the noise of each of the two
        velocities whose difference is taken. See `velocity-change`.
    gamma_rate : float, 1/s
        a, 1/s: how steeply the distrust in filter 1 grows about its middle.
    gamma_start : float, s
        t0, s since the start of the run; the distrust is half of its final one at t0 + tm.
    gamma_delay : float, s
        tm, s, counted from t0.
    mean : {"cumulative", "window"}
        "cumulative" takes Xbar as the mean since the start, "window" as that over the last `window` seconds.
    window : float, s
        Length of that window, s; of no effect if `mean` is "cumulative".
    model : DampingModel
    gate : float or None
    covariance_every : int

    Raises
    ------
    InputError
        If an option is out of range.
    """

    name: ClassVar[str] = "double-filter"
    source: ClassVar[Source] = ZHAO.at("section 2, Eqs. 7 to 10")

    interval: float = 5.0
    change_noise: float = 0.001
    r2_reading: str = "acceleration"
    gamma_rate: float = 5e-4
    gamma_start: float = 2.5 * 3600.0
    gamma_delay: float = 4.0 * 3600.0
    mean: str = "cumulative"
    window: float = 3600.0

    def _check_options(self) -> None:
        check_change(self.interval, self.change_noise, self.r2_reading)
        require_scalar("gamma_rate", self.gamma_rate, positive=True)
        require_scalar("gamma_start", self.gamma_start, minimum=0.0)
        require_scalar("gamma_delay", self.gamma_delay, minimum=0.0)
        require_choice("mean", self.mean, MEANS)
        require_scalar("window", self.window, positive=True)

    def gamma(self, t: ArrayLike) -> Array:
        """Return gamma at times t, s, since the start of the run."""
        power = np.clip(self.gamma_rate * (self.gamma_start + self.gamma_delay - np.asarray(t)), -700.0, 700.0)
        return np.asarray(1.0 / (1.0 + np.exp(power)))

    def _start(self, dt: float) -> FusionCarry:
        steps_of(self.interval, dt)
        length = max(1, round(self.window / dt)) if self.mean == "window" else 0
        return FusionCarry(start(self.model, filters=2), np.zeros(14), np.zeros((length, 13)))

    def _run(self, state: DampingState, ins: InsSamples, v_ref: Array) -> tuple[FusionCarry, DampingSolution]:
        from bench.solvers.damping._filter_kernels import fuse

        before: FusionCarry = state.carry
        variance = change_variance(self.interval, self.change_noise, self.r2_reading)
        steps = steps_of(self.interval, state.dt)
        carry, (first, second) = run(self, state, before.carry, ins, v_ref, steps, variance)
        sums, box = before.state.copy(), before.box.copy()
        gamma = self.gamma((state.rows + np.arange(len(ins))) * state.dt)
        x, sigma, weight = (np.empty_like(first.x) for _ in range(3))
        fuse(first.x, first.sigma, second.x, second.sigma, gamma, box, sums, x, sigma, weight)
        rows = first.covariance_rows
        none = np.full(len(ins), np.nan)
        solution = DampingSolution(
            ins.t,
            x,
            sigma,
            innovation=np.stack([none, none], axis=1),
            nis=none,
            used=first.used | second.used,
            covariance=sigma[rows, :, None] ** 2 * np.eye(13),
            covariance_rows=rows,
            gamma=gamma,
            weight=weight,
            parts=(first, second),
        )
        return FusionCarry(carry, sums, box), solution
