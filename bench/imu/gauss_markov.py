"""Bias instability as a first-order Gauss-Markov process (Ornstein-Uhlenbeck)."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import Array, require_choice, require_scalar
from bench.imu import ErrorModel, Stream
from bench.imu._drift import DriftState, add_drift
from bench.imu._options import set_numbers

# The Allan deviation of a process of std 1 peaks with this value, at 1.893 correlation times.
ALLAN_PEAK = 0.6173643


def _own_variance(x: float) -> float:
    """Return 2 (x - 2 tanh(x/2)), free of cancellation for small x > 0."""
    if x > 1.0:
        return 2.0 * (x - 2.0 * math.tanh(0.5 * x))
    square = 0.25 * x * x
    fraction = 19.0  # tanh y = y / (1 + y^2 / (3 + y^2 / (5 + ...))), at rounding for y <= 1/2
    for odd in range(17, 1, -2):
        fraction = odd + square / fraction
    return x * x * x / (2.0 * (fraction + square))


@dataclass(frozen=True)
class GaussMarkov(ErrorModel):
    """Bias instability: b' = -b/tau + noise, with standard deviation sigma and correlation exp(-|t|/tau).

    Both kinds follow the exact law of the continuous process at any rate. Sample k is b(t_k). Increment k is
    the integral of b from t_k to t_k + dt, drawn jointly with b(t_k + dt): with x = dt/tau, in units of sigma
    and tau, b(dt) = e^-x b + sqrt(1 - e^-2x) z0 and the integral is
    (1 - e^-x) b + (1 - e^-x) sqrt(tanh(x/2)) z0 + sqrt(2 (x - 2 tanh(x/2))) z1   (after [Gillespie]).

    Attributes
    ----------
    std : float or tuple of float, rad/s or m/s^2
        sigma, one for all channels or one each.
    tau : float, s
        Correlation time.
    initial : {"stationary", "zero"}
        Whether b starts with its stationary law or at 0 (as after a calibration).

    Raises
    ------
    InputError
        If `std` is negative, `tau` is not positive, or `initial` is unknown.

    References
    ----------
    [Gillespie] D. T. Gillespie, Exact numerical simulation of the Ornstein-Uhlenbeck process and its integral,
    Physical Review E 54(2), 1996.
    """

    name: ClassVar[str] = "gauss-markov"

    std: float | tuple[float, ...]
    tau: float
    initial: str = "stationary"

    def __post_init__(self) -> None:
        set_numbers(self, "std", minimum=0.0)
        object.__setattr__(self, "tau", require_scalar("tau", self.tau, positive=True))
        require_choice("initial", self.initial, ("stationary", "zero"))

    def start(self, rng: np.random.Generator, stream: Stream) -> DriftState:
        """Draw the first bias and compute the law of one step."""
        std = stream.spread("std", self.std)
        bias = std * rng.standard_normal(stream.channels)
        if self.initial == "zero":
            bias = np.zeros(stream.channels)
        x = stream.dt / self.tau
        rise = -math.expm1(-x)
        return DriftState(
            rng=rng,
            bias=bias,
            normals=2 if stream.kind == "increments" else 1,
            decay=math.exp(-x),
            gain=std * math.sqrt(-math.expm1(-2.0 * x)),
            mean=self.tau * rise,
            ahead=std * self.tau * rise * math.sqrt(math.tanh(0.5 * x)),
            own=std * self.tau * math.sqrt(_own_variance(x)),
        )

    def advance(self, state: DriftState, chunk: Array, specific_force: Array | None = None) -> tuple[DriftState, Array]:
        """Add the bias."""
        return add_drift(state, chunk)
