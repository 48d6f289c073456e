"""Velocity error: filter 1, which takes the reference velocity at its word."""

from dataclasses import dataclass
from typing import ClassVar

from bench.errors import Array
from bench.references import ZHAO, Source
from bench.solvers.damping import DampingFilter, DampingSolution, DampingState
from bench.solvers.damping._samples import InsSamples
from bench.solvers.damping._serial import Carry, run, start


@dataclass(frozen=True)
class VelocityError(DampingFilter):
    """Velocity error: a Kalman filter on INS minus reference velocity at every sample.

    Z = v_INS - v_ref, H = [I 0] (Eq. 3). It settles at once, but a constant error of the reference becomes an error of
    the velocity, and position and attitude drift in proportion to it: the filter is consistent without such an error
    only.

    Parameters
    ----------
    model : DampingModel
    gate : float or None
    covariance_every : int

    Raises
    ------
    InputError
        If an option is out of range.
    """

    name: ClassVar[str] = "velocity-error"
    source: ClassVar[Source] = ZHAO.at("section 2, filter 1")

    def _start(self, dt: float) -> Carry:
        return start(self.model)

    def _run(self, state: DampingState, ins: InsSamples, v_ref: Array) -> tuple[Carry, DampingSolution]:
        carry, (solution,) = run(self, state, state.carry, ins, v_ref)
        return carry, solution
