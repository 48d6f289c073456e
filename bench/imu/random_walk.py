"""Rate random walk of a gyro, acceleration random walk of an accelerometer."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import Array
from bench.imu import ErrorModel, Stream
from bench.imu._drift import DriftState, add_drift
from bench.imu._options import set_numbers


@dataclass(frozen=True)
class RandomWalk(ErrorModel):
    """Rate or acceleration random walk: a bias that is the integral of white noise, zero at the start.

    Both kinds follow the exact law of the continuous process: sample k is b(t_k), increment k its integral
    from t_k to t_k + dt, drawn jointly with b(t_k + dt): b(dt) = b + K sqrt(dt) z0, and the integral is
    b dt + K dt^1.5 (z0 / 2 + z1 / sqrt(12)). The Allan deviation is K sqrt(T / 3).

    Attributes
    ----------
    density : float or tuple of float, (rad/s)/sqrt(s) or (m/s^2)/sqrt(s)
        K, one for all channels or one each; the same number as (rad/s^2)/sqrt(Hz), two-sided.

    Raises
    ------
    InputError
        If `density` is negative or not finite.
    """

    name: ClassVar[str] = "random-walk"

    density: float | tuple[float, ...]

    def __post_init__(self) -> None:
        set_numbers(self, "density", minimum=0.0)

    def start(self, rng: np.random.Generator, stream: Stream) -> DriftState:
        """Start at zero and compute the law of one step."""
        step = stream.spread("density", self.density) * math.sqrt(stream.dt)
        return DriftState(
            rng=rng,
            bias=np.zeros(stream.channels),
            normals=2 if stream.kind == "increments" else 1,
            decay=1.0,
            gain=step,
            mean=stream.dt,
            ahead=step * stream.dt / 2.0,
            own=step * stream.dt / math.sqrt(12.0),
        )

    def advance(self, state: DriftState, chunk: Array, specific_force: Array | None = None) -> tuple[DriftState, Array]:
        """Add the walk."""
        return add_drift(state, chunk)
