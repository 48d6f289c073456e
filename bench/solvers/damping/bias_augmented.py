"""Bias augmented: filter 1 with the error of the reference velocity as two states more."""

import math
from dataclasses import dataclass
from typing import ClassVar

from bench.errors import Array, InputError, require_scalar
from bench.references import ZHAO, Source
from bench.solvers.damping import DampingFilter, DampingSolution, DampingState
from bench.solvers.damping._samples import InsSamples
from bench.solvers.damping._serial import Carry, run, start


@dataclass(frozen=True)
class BiasAugmented(DampingFilter):
    """Bias augmented: velocity-error with 15 states, the last two the error of the reference velocity.

    What one would do today instead of two filters: Z = v_INS - v_ref, H = [I 0 -I], and the error of the reference is a
    constant or a slow first-order Markov process. It is told apart from the INS's errors by their oscillations.

    Parameters
    ----------
    reference_bias : float, m/s
        Standard deviation of the error of the reference velocity, east and north, m/s.
    reference_tau : float, s
        Correlation time of that error, s; infinite for a constant.
    model : DampingModel
    gate : float or None
    covariance_every : int

    Raises
    ------
    InputError
        If an option is out of range.
    """

    name: ClassVar[str] = "bias-augmented"
    source: ClassVar[Source] = ZHAO.at("section 2, filter 1, augmented here")

    reference_bias: float = 0.5
    reference_tau: float = math.inf

    def _check_options(self) -> None:
        require_scalar("reference_bias", self.reference_bias, positive=True)
        if not self.reference_tau > 0:
            raise InputError(f"reference_tau must be positive, or infinite for a constant, got {self.reference_tau!r}")

    def _start(self, dt: float) -> Carry:
        return start(self.model, extra=(self.reference_bias, 1.0 / self.reference_tau))

    def _run(self, state: DampingState, ins: InsSamples, v_ref: Array) -> tuple[Carry, DampingSolution]:
        carry, (solution,) = run(self, state, state.carry, ins, v_ref)
        return carry, solution
