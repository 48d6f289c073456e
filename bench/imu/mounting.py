"""Mounting errors of an accelerometer array: where the sensors really sit and which way they really point."""

from dataclasses import dataclass

import numpy as np

from bench.errors import Array, InputError, require_scalar
from bench.signals import Accelerometers


def _perpendicular(direction: Array) -> tuple[Array, Array]:
    """Return two unit vectors that make a triad with each direction, each of shape (m, 3)."""
    aside = np.eye(3)[np.argmin(np.abs(direction), axis=1)]
    first = np.cross(direction, aside)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.cross(direction, first)


@dataclass(frozen=True)
class Mounting:
    """Mounting errors: positions shift and sensing axes tilt, each independently.

    A channel of an array reads the force along its own axis only, so these errors cannot be made from its
    reading: the motion is sensed again with the perturbed geometry, while the solver keeps the nominal one.

    Attributes
    ----------
    position_std : float, m
        Standard deviation of each component of a sensor's position.
    direction_std : float, rad
        Standard deviation of an axis' tilt about each of two directions perpendicular to it.

    Raises
    ------
    InputError
        If a value is negative or not finite.
    """

    position_std: float = 0.0
    direction_std: float = 0.0

    def __post_init__(self) -> None:
        for name in ("position_std", "direction_std"):
            object.__setattr__(self, name, require_scalar(name, getattr(self, name), minimum=0.0))

    def draw(self, accelerometers: Accelerometers, rng: np.random.Generator) -> Accelerometers:
        """Return the geometry as it was really mounted.

        Both errors are always drawn: turning one off leaves the other as it was.

        Raises
        ------
        InputError
            If `accelerometers` is not an Accelerometers record.
        """
        if not isinstance(accelerometers, Accelerometers):
            raise InputError(f"accelerometers must be an Accelerometers record, got {accelerometers!r}")
        m = len(accelerometers)
        shift = self.position_std * rng.standard_normal((m, 3))
        tilt = self.direction_std * rng.standard_normal((m, 2))
        direction = accelerometers.direction
        first, second = _perpendicular(direction)
        lean = tilt[:, :1] * first + tilt[:, 1:] * second
        angle = np.hypot(tilt[:, :1], tilt[:, 1:])
        turned = np.cos(angle) * direction + np.sinc(angle / np.pi) * lean
        turned /= np.linalg.norm(turned, axis=1, keepdims=True)
        if self.direction_std == 0.0:
            turned = direction.copy()
        return Accelerometers(accelerometers.names, accelerometers.position + shift, turned)
