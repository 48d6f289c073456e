"""Scale factor error and its nonlinearity."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import Array
from bench.imu import ErrorModel, Stream
from bench.imu._options import set_numbers

State = tuple[Array, Array]


@dataclass(frozen=True)
class ScaleFactor(ErrorModel):
    """Scale factor: x becomes (1 + s) x + k x^2, s and k drawn once per channel.

    For increments the quadratic term is k times the square of the mean rate over the interval, times dt; that
    is the integral of k x^2 up to the variance of x within the interval, which the increment does not tell.

    Attributes
    ----------
    value, std : float or tuple of float
        s = value + std * normal, a ratio (``300 * PPM``), one for all channels or one each.
    quadratic, quadratic_std : float or tuple of float, 1/(rad/s) or 1/(m/s^2)
        k = quadratic + quadratic_std * normal.

    Raises
    ------
    InputError
        If a value is not finite, or a standard deviation is negative.
    """

    name: ClassVar[str] = "scale-factor"

    value: float | tuple[float, ...] = 0.0
    std: float | tuple[float, ...] = 0.0
    quadratic: float | tuple[float, ...] = 0.0
    quadratic_std: float | tuple[float, ...] = 0.0

    def __post_init__(self) -> None:
        set_numbers(self, "value", "quadratic")
        set_numbers(self, "std", "quadratic_std", minimum=0.0)

    def start(self, rng: np.random.Generator, stream: Stream) -> State:
        """Draw the two factors of each channel."""
        z = rng.standard_normal((2, stream.channels))
        linear = stream.spread("value", self.value) + stream.spread("std", self.std) * z[0]
        k = stream.spread("quadratic", self.quadratic) + stream.spread("quadratic_std", self.quadratic_std) * z[1]
        return linear, k / stream.span  # (x/dt)^2 dt = x^2 / dt

    def advance(self, state: State, chunk: Array, specific_force: Array | None = None) -> tuple[State, Array]:
        """Scale the signal."""
        linear, quadratic = state
        return state, chunk + (linear + quadratic * chunk) * chunk
