"""What Gauss-Markov bias and random walk share: a drifting bias, read at an instant or over an interval."""

from typing import NamedTuple

import numpy as np

from bench.errors import Array
from bench.imu._options import fork


class DriftState(NamedTuple):
    """A bias before the next step, and its law; gains have shape (channels,), unit normals are z0 and z1.

    b(t + dt) = decay b + gain z0, and for increments the integral over dt is mean b + ahead z0 + own z1.
    """

    rng: np.random.Generator
    bias: Array
    normals: int
    decay: float
    gain: Array
    mean: float
    ahead: Array
    own: Array


def add_drift(state: DriftState, chunk: Array) -> tuple[DriftState, Array]:
    """Return the next state, and the chunk with the drifting bias added."""
    from bench.imu._kernels import correlated

    rng, bias = fork(state.rng), state.bias.copy()
    # Drawn reading by reading, so that any chunking takes the same numbers.
    normals = rng.standard_normal((len(chunk), state.normals, chunk.shape[1]))
    reading = correlated(normals, bias, state.decay, state.gain, state.mean, state.ahead, state.own)
    reading += chunk
    return state._replace(rng=rng, bias=bias), reading
