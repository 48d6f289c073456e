"""Velocity change: filter 2, blind to a constant error of the reference velocity."""

from dataclasses import dataclass, replace
from typing import ClassVar

from bench.errors import Array
from bench.references import ZHAO, Source
from bench.solvers.damping import DampingFilter, DampingSolution, DampingState
from bench.solvers.damping._change_options import change_variance, check_change, steps_of
from bench.solvers.damping._samples import InsSamples
from bench.solvers.damping._serial import Carry, run, start


@dataclass(frozen=True)
class VelocityChange(DampingFilter):
    """Velocity change: a Kalman filter on the change of the velocity error over T, smoothed by filter 1.

    Z = (1/T) int (B C_c f - A) dt - (v_s(t2) - v_s(t1))/T with v_s = v_INS - dv_1, filter 1's estimate, and
    H = (1/T) int F_(1:2) Phi(t, t2) dt = (1/T) [I - Phi(t2, t1)^-1]_(1:2), since Phi' = F Phi (Eq. 2). A constant error
    of the reference drops out; the price is that what changes slowly is seen slowly. Smoothed noise is not white and
    depends on filter 1's errors, so that the covariance is not to be believed literally.

    Parameters
    ----------
    interval : float, s
        T over which it takes the change of the velocity error: 1 to 15 s, a whole number of samples.
    change_noise : float, m/s^2 or m/s
        Noise of that change, m/s^2 or m/s: R2 is made of it as `r2_reading` says.
    r2_reading : {"acceleration", "velocity"}
        R2 is printed in (m/s)^2, but Z is an acceleration: "acceleration" takes `change_noise` as m/s^2;
        "velocity" takes it as m/s, the noise of each of the two velocities, R2 = 2 change_noise^2/T^2.
    model : DampingModel
    gate : float or None
    covariance_every : int

    Raises
    ------
    InputError
        If an option is out of range, or the interval is not a whole number of samples (at the start).
    """

    name: ClassVar[str] = "velocity-change"
    source: ClassVar[Source] = ZHAO.at("section 1, Eq. 2, and section 2, filter 2")

    interval: float = 5.0
    change_noise: float = 0.001
    r2_reading: str = "acceleration"

    def _check_options(self) -> None:
        check_change(self.interval, self.change_noise, self.r2_reading)

    def _start(self, dt: float) -> Carry:
        steps_of(self.interval, dt)
        return start(self.model, filters=2)

    def _run(self, state: DampingState, ins: InsSamples, v_ref: Array) -> tuple[Carry, DampingSolution]:
        variance = change_variance(self.interval, self.change_noise, self.r2_reading)
        steps = steps_of(self.interval, state.dt)
        carry, (first, second) = run(self, state, state.carry, ins, v_ref, steps, variance)
        return carry, replace(second, parts=(first,))
