"""Times of files: in a unit of their own, or nanoseconds in integers too long for a float."""

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array

NANOSECOND = 1e-9  # s
BILLION = 1_000_000_000
EXACT = 2**53  # floats hold smaller integers exactly


def seconds(ticks: NDArray[np.int64], epoch_ns: int | None = None) -> tuple[Array, int]:
    """Return nanoseconds as t, s, and the epoch (ns) that was subtracted.

    Without a given one it is 0 if all are below 2^53 ns (104 days), otherwise the first time without its fraction of
    a second.
    """
    if epoch_ns is None:
        epoch_ns = 0 if np.abs(ticks).max() < EXACT else int(ticks[0]) // BILLION * BILLION
    return (ticks - epoch_ns) / BILLION, epoch_ns


def nanoseconds(t: Array, epoch_ns: int) -> NDArray[np.int64]:
    """Return t, s, as integers, rounded to 1 ns."""
    return np.round(t * BILLION).astype(np.int64) + epoch_ns
