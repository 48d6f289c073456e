"""g-sensitivity of a gyro: a rate error in proportion to the specific force."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, InputError, require_array, require_scalar
from bench.imu import ErrorModel, Stream
from bench.imu._linear import transform


@dataclass(frozen=True)
class GSensitivity(ErrorModel):
    """g-sensitivity: omega becomes omega + G f, f the specific force at the gyro, of the signal's own kind.

    Increments of angle take increments of velocity with the same G.

    Attributes
    ----------
    value : float, or array_like of shape (3,) or (3, 3), (rad/s)/(m/s^2)
        Fixed part of G: a number or three stand on the diagonal (each axis feels its own force).
    std : float, (rad/s)/(m/s^2)
        Standard deviation of the normal part of all nine elements.

    Raises
    ------
    InputError
        If a value has another shape or is not finite, `std` is negative, there are not three channels, or the
        specific force is not given.
    """

    name: ClassVar[str] = "g-sensitivity"

    value: ArrayLike = 0.0
    std: float = 0.0

    def __post_init__(self) -> None:
        rank = np.ndim(self.value)
        if rank == 0:
            matrix = require_scalar("value", self.value) * np.eye(3)
        else:
            matrix = require_array("value", self.value, (3,) if rank == 1 else (3, 3))
            matrix = np.diag(matrix) if rank == 1 else matrix
        object.__setattr__(self, "value", tuple(map(tuple, matrix.tolist())))
        object.__setattr__(self, "std", require_scalar("std", self.std, minimum=0.0))

    def start(self, rng: np.random.Generator, stream: Stream) -> Array:
        """Draw the matrix G."""
        if stream.channels != 3:
            raise InputError(f"g-sensitivity needs 3 channels (a gyro), got {stream.channels}")
        return np.asarray(self.value) + self.std * rng.standard_normal((3, 3))

    def advance(self, state: Array, chunk: Array, specific_force: Array | None = None) -> tuple[Array, Array]:
        """Add G f."""
        if specific_force is None:
            raise InputError("specific_force must be given for g-sensitivity, got None")
        return state, chunk + transform(state, specific_force)
