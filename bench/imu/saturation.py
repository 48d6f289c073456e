"""Saturation: the end of the measuring range."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import Array
from bench.imu import ErrorModel, Stream
from bench.imu._options import set_numbers


@dataclass(frozen=True)
class Saturation(ErrorModel):
    """Saturation: readings end at +-limit, increments at +-limit * dt.

    An interval during which the rate passes the limit only for a part reads too much: the increment does not
    tell how long that was.

    Attributes
    ----------
    limit : float or tuple of float, rad/s or m/s^2
        One for all channels or one each.

    Raises
    ------
    InputError
        If `limit` is not positive and finite.
    """

    name: ClassVar[str] = "saturation"

    limit: float | tuple[float, ...]

    def __post_init__(self) -> None:
        set_numbers(self, "limit", positive=True)

    def start(self, rng: np.random.Generator, stream: Stream) -> Array:
        """Return the limits in the signal's unit."""
        return stream.spread("limit", self.limit) * stream.span

    def advance(self, state: Array, chunk: Array, specific_force: Array | None = None) -> tuple[Array, Array]:
        """Clip the signal."""
        return state, np.clip(chunk, -state, state)
