"""Turn-on bias: a constant that differs from one switching-on to the next."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import Array
from bench.imu import ErrorModel, Stream
from bench.imu._options import set_numbers


@dataclass(frozen=True)
class TurnOnBias(ErrorModel):
    """Turn-on bias: bias = (+-)value + std * normal, drawn once per channel; increments get bias * dt.

    Attributes
    ----------
    value : float or tuple of float, rad/s or m/s^2
        Fixed part, one for all channels or one each.
    std : float or tuple of float, rad/s or m/s^2
        Standard deviation of the normal part.
    random_sign : bool
        Whether each channel's fixed part gets a random sign, + and - equally likely.

    Raises
    ------
    InputError
        If a value is not finite or `std` is negative.
    """

    name: ClassVar[str] = "turn-on-bias"

    value: float | tuple[float, ...] = 0.0
    std: float | tuple[float, ...] = 0.0
    random_sign: bool = False

    def __post_init__(self) -> None:
        set_numbers(self, "value")
        set_numbers(self, "std", minimum=0.0)

    def start(self, rng: np.random.Generator, stream: Stream) -> Array:
        """Draw the bias, in the signal's unit."""
        value, std = stream.spread("value", self.value), stream.spread("std", self.std)
        sign = rng.choice((-1.0, 1.0), stream.channels)  # drawn in any case: the option changes no other draw
        bias = (sign if self.random_sign else 1.0) * value + std * rng.standard_normal(stream.channels)
        return bias * stream.span

    def advance(self, state: Array, chunk: Array, specific_force: Array | None = None) -> tuple[Array, Array]:
        """Add the bias."""
        return state, chunk + state
