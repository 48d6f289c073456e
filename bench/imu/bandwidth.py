"""Bandwidth: a first-order lag."""

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from bench.errors import Array, require_scalar
from bench.imu import ErrorModel, Stream


def _phi2(h: float) -> float:
    """Return (e^-h - 1 + h) / h^2, free of cancellation for small h > 0."""
    if h > 0.5:
        return (math.expm1(-h) + h) / (h * h)
    term = total = 0.5
    for k in range(3, 18):  # sum of (-h)^(k-2) / k!
        term *= -h / k
        total += term
    return total


@dataclass(frozen=True)
class LagState:
    """The lag before the next reading; `lagged` is None before the first, which it starts in balance with."""

    kind: str
    rise: float  # 1 - e^-h, h = dt / tau
    weight: float  # of the present sample, or of what an increment is behind
    lagged: Array | None = None
    previous: Array | None = None


@dataclass(frozen=True)
class Bandwidth(ErrorModel):
    """Bandwidth: tau y' = x - y with tau = 1 / (2 pi cutoff), started in balance with the first reading.

    Exact for samples of an input that is linear between them, and for increments of an input that is constant
    over each interval. The gain for a constant input is exactly 1, so increments keep their integral.

    Attributes
    ----------
    cutoff : float, Hz
        Where the amplitude is 1/sqrt(2).

    Raises
    ------
    InputError
        If `cutoff` is not positive and finite.
    """

    name: ClassVar[str] = "bandwidth"

    cutoff: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "cutoff", require_scalar("cutoff", self.cutoff, positive=True))

    def start(self, rng: np.random.Generator, stream: Stream) -> LagState:
        """Compute the weights of one step."""
        h = 2.0 * math.pi * self.cutoff * stream.dt
        rise = -math.expm1(-h)
        return LagState(stream.kind, rise, h * _phi2(h) if stream.kind == "samples" else rise / h)

    def advance(self, state: LagState, chunk: Array, specific_force: Array | None = None) -> tuple[LagState, Array]:
        """Lag the signal."""
        from bench.imu._kernels import lag_increments, lag_samples

        signal = chunk.copy()
        lagged = (chunk[0] if state.lagged is None else state.lagged).copy()
        if state.kind == "increments":
            lag_increments(signal, lagged, state.rise, state.weight)
            return replace(state, lagged=lagged), signal
        previous = (chunk[0] if state.previous is None else state.previous).copy()
        lag_samples(signal, lagged, previous, state.rise - state.weight, state.weight)
        return replace(state, lagged=lagged, previous=previous), signal
