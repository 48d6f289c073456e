"""White noise, given as a density or as the standard deviation of a reading, never both."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import Array
from bench.imu import ErrorModel, Stream
from bench.imu._options import fork, require_one, set_numbers

State = tuple[np.random.Generator, Array]


@dataclass(frozen=True)
class WhiteNoise(ErrorModel):
    """White noise: independent normal errors, given as a density or as the standard deviation of a reading.

    With a density N (two-sided, so N^2 is the variance of the mean over one second) a sample has the standard
    deviation N / sqrt(dt), that of an ideal sensor averaging over dt, and an increment N sqrt(dt): what
    accumulates does not depend on the rate. With `sample_std` s a sample has the standard deviation s, and an
    increment s dt (the mean over its interval has s), at whatever rate: what accumulates does depend on it.
    The two differ by a factor sqrt(dt); published "variances" must be read with care.

    Attributes
    ----------
    density : float or tuple of float, (rad/s)/sqrt(Hz) or (m/s^2)/sqrt(Hz), or None
        Angle or velocity random walk N (the same number in rad/sqrt(s) or (m/s)/sqrt(s)).
    sample_std : float or tuple of float, rad/s or m/s^2, or None
        Standard deviation of one reading, for either kind stated per second.

    Raises
    ------
    InputError
        If both or neither are given, or a value is negative or not finite.
    """

    name: ClassVar[str] = "white-noise"

    density: float | tuple[float, ...] | None = None
    sample_std: float | tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        require_one("density", self.density, "sample_std", self.sample_std)
        set_numbers(self, "sample_std" if self.density is None else "density", minimum=0.0)

    def start(self, rng: np.random.Generator, stream: Stream) -> State:
        """Compute the standard deviation of a reading, in the signal's unit."""
        if self.density is not None:
            std = stream.spread("density", self.density) / math.sqrt(stream.dt)
        else:
            assert self.sample_std is not None  # __post_init__ refuses it
            std = stream.spread("sample_std", self.sample_std)
        return rng, std * stream.span

    def advance(self, state: State, chunk: Array, specific_force: Array | None = None) -> tuple[State, Array]:
        """Add the noise."""
        before, std = state
        rng = fork(before)
        noise = rng.standard_normal(chunk.shape)
        noise *= std
        noise += chunk
        return (rng, std), noise
