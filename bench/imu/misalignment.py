"""Misalignment of the three sensing axes of a triad or a gyro, each its own way (non-orthogonal)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, InputError, require_array, require_scalar
from bench.imu import ErrorModel, Stream
from bench.imu._linear import transform

Matrix = tuple[tuple[float, ...], ...]
NONE: Matrix = ((0.0, 0.0, 0.0),) * 3


@dataclass(frozen=True)
class Misalignment(ErrorModel):
    """Misalignment: channel i senses along the unit vector of e_i + sum_j M_ij e_j instead of e_i.

    M_ij is the small angle (its tangent) by which axis i leans towards axis j. Right for increments as far as
    the axes are fixed in the body. Channels of a single-axis array do not see the cross-axis force; their
    mounting errors are in `bench.imu.mounting`.

    Attributes
    ----------
    angles : array_like, shape (3, 3), rad
        Fixed part of M; zero diagonal.
    std : float, rad
        Standard deviation of the normal part of the six off-diagonal angles.

    Raises
    ------
    InputError
        If a value is not finite, the diagonal is not zero, `std` is negative, or (at the start) there are not
        three channels.
    """

    name: ClassVar[str] = "misalignment"

    angles: ArrayLike = NONE
    std: float = 0.0

    def __post_init__(self) -> None:
        angles = require_array("angles", self.angles, (3, 3))
        if np.diagonal(angles).any():
            raise InputError(f"angles must have a zero diagonal, got {np.diagonal(angles).tolist()}")
        object.__setattr__(self, "angles", tuple(map(tuple, angles.tolist())))
        object.__setattr__(self, "std", require_scalar("std", self.std, minimum=0.0))

    def start(self, rng: np.random.Generator, stream: Stream) -> Array:
        """Draw the sensing axes, one a row, shape (3, 3)."""
        if stream.channels != 3:
            raise InputError(f"misalignment needs 3 channels (x, y, z), got {stream.channels}")
        lean = np.asarray(self.angles) + self.std * rng.standard_normal((3, 3))
        np.fill_diagonal(lean, 1.0)
        return lean / np.linalg.norm(lean, axis=1, keepdims=True)

    def advance(self, state: Array, chunk: Array, specific_force: Array | None = None) -> tuple[Array, Array]:
        """Sense along the leaning axes."""
        return state, transform(state, chunk)
