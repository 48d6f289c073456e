"""Quantisation: a pulse counter that carries its residue, or a converter that rounds every reading."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import Array, require_scalar
from bench.imu import ErrorModel, Stream
from bench.imu._options import require_one

State = tuple[float, Array | None]


@dataclass(frozen=True)
class Quantisation(ErrorModel):
    """Quantisation: counts of a quantum with carried residue, or every reading rounded to a step.

    With a `quantum` the sensor counts: it accumulates the integral (reading * dt for samples) and reports
    whole quanta to the nearest, keeping what is left over, so that the sum of all reports is always within one
    quantum of the true sum (half a quantum, with the residue zero at the start). With a `step` each reading is
    rounded by itself (for increments, the mean rate over the interval), and the errors accumulate.

    Attributes
    ----------
    quantum : float, rad or m/s, or None
        Angle or velocity of one pulse.
    step : float, rad/s or m/s^2, or None
        Step of the converter.
    random_phase : bool
        Whether the counter starts with a residue evenly distributed within half a quantum instead of zero.

    Raises
    ------
    InputError
        If both or neither are given, or a value is not positive.
    """

    name: ClassVar[str] = "quantisation"

    quantum: float | None = None
    step: float | None = None
    random_phase: bool = False

    def __post_init__(self) -> None:
        require_one("quantum", self.quantum, "step", self.step)
        given = "step" if self.quantum is None else "quantum"
        object.__setattr__(self, given, require_scalar(given, getattr(self, given), positive=True))

    def start(self, rng: np.random.Generator, stream: Stream) -> State:
        """Return one quantum in the signal's unit and the counter's residue in quanta (None for a converter)."""
        if self.step is not None:
            return self.step * stream.span, None
        assert self.quantum is not None  # __post_init__ refuses it
        unit = self.quantum if stream.kind == "increments" else self.quantum / stream.dt
        phase = rng.uniform(-0.5, 0.5, stream.channels)
        return unit, phase if self.random_phase else np.zeros(stream.channels)

    def advance(self, state: State, chunk: Array, specific_force: Array | None = None) -> tuple[State, Array]:
        """Round the signal to whole quanta or steps."""
        unit, residue = state
        counts = chunk / unit
        if residue is None:
            counts = np.rint(counts)
        else:
            from bench.imu._kernels import count

            residue = residue.copy()
            count(counts, residue)
        counts *= unit
        return (unit, residue), counts
