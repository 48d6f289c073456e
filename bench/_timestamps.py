"""Timestamps of a recording: gaps, repeats, steps back and jitter are counted, and refused with the fix."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, InputError, require_array, require_scalar

RATE_TOLERANCE = 1e-3  # of a declared dt: ten times what a poor quartz drifts
GAP = 1.5  # dt; a longer interval lacks at least one sample
SHORT = 0.5  # dt; a shorter one holds a sample too many

Where = Callable[[int], str]


def check_times(
    t: ArrayLike,
    dt: float | None = None,
    *,
    source: str = "t",
    jitter: float = 0.1,
    longest_gap: float = 0.0,
    where: Where = "row {}".format,
) -> float:
    """Return the interval of regular times, s, or say all that is irregular.

    Parameters
    ----------
    t : array_like, shape (n,), s, n >= 2
    dt : float, s, optional
        Declared interval; the measured one must agree with it within 0.1 % (or, of few samples, within what jitter of
        the first and the last one can do), and it is returned. Without it the measured one is: the mean interval, or,
        where the times cannot tell them apart, that of the nearest rate with nine digits.
    source : str
        Name for the message.
    jitter : float
        Accepted deviation of one interval from dt, in dt; below 0.5.
    longest_gap : float, s
        Longest interval between two samples that is not an error although samples are missing in it.
    where : callable
        Names row k in messages, such as a file's line.

    Raises
    ------
    InputError
        If a time is not finite, the rate is wrong, or there are gaps (intervals above 1.5 dt), repeats (of a time),
        steps back, intervals below 0.5 dt or off by more than `jitter`; with counts, the first place, and the fix.
    """
    t = require_array("t", t, (None,))
    require_tolerances(jitter, longest_gap)
    if len(t) < 2:
        raise InputError(f"{source}: at least two samples are needed, got {len(t)}")
    step = np.diff(t)
    measured = _typical(step, source)
    if dt is not None:
        dt = require_scalar("dt", dt, positive=True)
        slack = max(RATE_TOLERANCE, 2 * jitter / len(step))  # both ends may be off
        if abs(measured / dt - 1) > slack:
            raise InputError(
                f"{source}: declared rate {1 / dt:.9g} Hz, but the times tell {1 / measured:.9g} Hz "
                f"(interval {measured:.9g} s); declare the true rate, or none to take that of the times, "
                "or mend the unit of the times"
            )
    _refuse_irregular(t, step, measured if dt is None else dt, source, jitter, longest_gap, where)
    return _measured(t, step, measured) if dt is None else dt


def require_tolerances(jitter: float, longest_gap: float) -> None:
    """Check what `check_times` is to admit.

    Raises
    ------
    InputError
        If `jitter` is negative or not below 0.5, or `longest_gap` is negative.
    """
    if require_scalar("jitter", jitter, minimum=0.0) >= SHORT:
        raise InputError(f"jitter must be below {SHORT:g} (of dt), got {jitter!r}")
    require_scalar("longest_gap", longest_gap, minimum=0.0)


def missing_samples(t: Array, dt: float) -> Array:
    """Return how many samples are missing after each one, shape (n - 1,)."""
    return np.where(np.diff(t) > GAP * dt, np.round(np.diff(t) / dt) - 1, 0).astype(np.intp)


def _typical(step: Array, source: str) -> float:
    """Return the mean of the intervals that are neither gaps nor repeats."""
    forward = step[step > 0]
    if not len(forward):
        raise InputError(f"{source}: times must increase, none of {len(step)} intervals does; check the time column")
    return float(forward[forward < 1.75 * np.median(forward)].mean())


def _measured(t: Array, step: Array, typical: float) -> float:
    dt = float(t[-1] - t[0]) / (len(step) + int(missing_samples(t, typical).sum()))
    rounded = 1.0 / float(f"{1.0 / dt:.9g}")
    resolution = 4 * np.finfo(float).eps * max(abs(t[0]), abs(t[-1]))
    return rounded if abs(rounded - dt) * len(t) <= resolution else dt


def _refuse_irregular(
    t: Array, step: Array, dt: float, source: str, jitter: float, longest_gap: float, where: Where
) -> None:
    resolution = 4 * np.finfo(float).eps * max(abs(t[0]), abs(t[-1]))
    gaps = (step > GAP * dt) & (step > longest_gap + resolution)
    missing = missing_samples(t, dt)
    # A gap to be filled must hold whole intervals.
    off = (step >= SHORT * dt) & ~gaps & (np.abs(step / (missing + 1) - dt) > jitter * dt + resolution)
    lost = int(missing[gaps].sum())
    found = [
        (step < 0, "steps back", "sort it by time, or cut it there"),
        (step == 0, "repeated times", "drop_repeats=True drops rows that are the same altogether"),
        (gaps, f"gaps ({lost} missing samples)", "longest_gap fills gaps up to so many seconds by interpolation"),
        ((step > 0) & (step < SHORT * dt), "intervals below 0.5 dt", "remove the surplus samples"),
        (off, f"intervals off by more than {jitter:g} dt", "jitter admits more (of dt, below 0.5)"),
    ]
    faults, fixes = [], []
    for mask, what, fix in found:
        if count := int(np.count_nonzero(mask)):
            k = int(np.argmax(mask))
            faults.append(f"{what}: {count}, first after {where(k)} (t = {float(t[k])!r} to {float(t[k + 1])!r} s)")
            fixes.append(fix)
    if faults:
        raise InputError(
            f"{source}: times are not regular at dt = {dt:.9g} s: {'; '.join(faults)}. Fix: {'; '.join(fixes)}"
        )
