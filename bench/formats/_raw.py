"""The contents of an IMU file before they are a recording: windows, repeats, gaps, and values in another unit."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench._timestamps import missing_samples
from bench.errors import Array, InputError

FASTEST = 100.0  # rad/s; the widest gyros on the market end at 70 rad/s (4000 deg/s): rather degrees
STRONGEST = 500.0  # m/s^2, as median: rather rates taken for increments
WEAKEST = 1.5  # m/s^2, as median: rather multiples of g, or increments taken for rates


@dataclass(frozen=True, eq=False)
class RawImu:
    """Contents of a file in SI, along the sensor's axes, unchecked; made by a format's `_read_imu`.

    Attributes
    ----------
    t : ndarray, shape (n,), s
    values : ndarray, shape (n, 6)
        Angular, specific; rad, m/s (increments) or rad/s, m/s^2 (rates).
    kind : {"increments", "rates"}
    where : callable
        Names row k in messages: its line in the file.
    epoch_ns : int, ns
    dt : float, s, or None
        If the file says it.
    """

    t: Array
    values: Array
    kind: str
    where: Callable[[int], str] = "row {}".format
    epoch_ns: int = 0
    dt: float | None = None


def within(raw: RawImu, source: str, start: float | None, stop: float | None) -> RawImu:
    """Return the rows with start <= t <= stop.

    Raises
    ------
    InputError
        If less than two are there.
    """
    if len(raw.t) < 2:
        raise InputError(f"{source}: must hold two samples at least, got {len(raw.t)}")
    low, high = -np.inf if start is None else start, np.inf if stop is None else stop
    inside = (raw.t >= low) & (raw.t <= high)
    if np.count_nonzero(inside) < 2:
        raise InputError(
            f"{source}: start and stop must enclose two samples (t from {raw.t.min()} to {raw.t.max()} s), "
            f"got {start!r} and {stop!r}"
        )
    return raw if inside.all() else _kept(raw, inside)


def _kept(raw: RawImu, keep: NDArray[np.bool_]) -> RawImu:
    rows = np.flatnonzero(keep)
    return RawImu(raw.t[rows], raw.values[rows], raw.kind, lambda k: raw.where(int(rows[k])), raw.epoch_ns, raw.dt)


def without_repeats(raw: RawImu) -> RawImu:
    """Return the rows that are not the same as the row before, time and values."""
    same = (np.diff(raw.t) == 0) & (np.diff(raw.values, axis=0) == 0).all(axis=1)
    return _kept(raw, np.append(True, ~same)) if same.any() else raw


def filled(raw: RawImu, dt: float) -> tuple[Array, Array]:
    """Return times and values with the samples that are missing in gaps, by linear interpolation."""
    missing = missing_samples(raw.t, dt)
    if not missing.any():
        return raw.t, raw.values
    # Sample number of each row; t is interpolated too, so that a gap's own jitter is spread over it.
    number = np.append(0, np.cumsum(missing + 1))
    every = np.arange(number[-1] + 1)
    t = np.interp(every, number, raw.t)
    return t, np.stack([np.interp(every, number, column) for column in raw.values.T], axis=1)


def require_plausible(raw: RawImu, dt: float, source: str) -> None:
    """Check that the values can be what they are declared to be.

    Raises
    ------
    InputError
        If rates above `FASTEST`, or a median specific force outside `WEAKEST` to `STRONGEST`, suggest another unit.
    """
    span = dt if raw.kind == "increments" else 1.0
    angular = np.sqrt((raw.values[:, :3] ** 2).sum(axis=1)) / span
    k = int(np.argmax(angular))
    unless = "if it is so, range_check=False reads it"
    if angular[k] > FASTEST:
        raise InputError(
            f"{source}: angular rate of {angular[k]:.4g} rad/s at {raw.where(k)}, above {FASTEST:g} rad/s; "
            f"it looks like degrees or like rates declared as increments; {unless}"
        )
    force = float(np.median(np.sqrt((raw.values[:, 3:] ** 2).sum(axis=1)))) / span
    if not WEAKEST <= force <= STRONGEST:
        suspect = (
            "multiples of g, or increments declared as rates"
            if force < WEAKEST
            else "rates declared as increments, or another unit"
        )
        raise InputError(
            f"{source}: median specific force of {force:.4g} m/s^2, outside {WEAKEST:g} to {STRONGEST:g} m/s^2; "
            f"it looks like {suspect}; {unless}"
        )
