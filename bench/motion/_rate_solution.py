"""Attitude from a smooth body rate, to rounding: q' = 1/2 q o (0, omega) on short Chebyshev segments.

The rate is sampled at Chebyshev points of segments that are halved until its
coefficients have decayed to rounding. On each segment q = 1 + 1/2 int q o omega
is iterated to convergence (it converges for every rate, as (S/2)^n/n! with S the
angle turned through), all segments at once. The segments are then chained by a
scan of depth log2(m), so that few roundings enter any knot.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from bench.errors import AccuracyError, Array
from bench.motion._chebyshev import DEGREE, EPS, FIT, INTEGRAL, Function, evaluate_segments, sample
from bench.rotation import quat_conjugate, quat_multiply, quat_normalize

LARGEST_ANGLE = 1.0  # rad turned within a segment: the iteration converges in about 14 rounds
LARGEST_ROUNDS = 30
SHORTEST = 2.0**-40  # of the span; a rate that still needs shorter segments has a jump
LARGEST_COUNT = 65536  # of segments beyond four times the first ones; a rate that needs more is noise
NEGLIGIBLE_ANGLE = 2.0**-56  # rad; what a segment may leave unresolved whatever its rate


@dataclass(frozen=True, eq=False)
class RateSolution:
    """The solved attitude: m segments of Chebyshev series.

    Attributes
    ----------
    breaks : ndarray, shape (m + 1,), s
    attitude : ndarray, shape (m, DEGREE + 1, 4)
        Coefficients of q_ib on each segment.
    acceleration : ndarray, shape (m, DEGREE + 1, 4), rad/s^2
        Coefficients of (0, derivative of the fitted rate).
    error_estimate : float, rad
        Largest difference to the solution with every segment halved, at the ends and middles of the segments.
    """

    breaks: Array
    attitude: Array
    acceleration: Array
    error_estimate: float

    def q_ib(self, t: Array) -> Array:
        """Return the attitude at times t, shape (n, 4)."""
        return quat_normalize(evaluate_segments(self.breaks, self.attitude, t))

    def alpha_ib_b(self, t: Array) -> Array:
        """Return the derivative of the fitted rate at times t, shape (n, 3), rad/s^2."""
        return evaluate_segments(self.breaks, self.acceleration, t)[:, 1:]


def solve(rate: Function, span: tuple[float, float], q_ib: Array, longest: float) -> RateSolution:
    """Return the attitude over the span from q_ib at its start.

    Raises
    ------
    AccuracyError
        If the rate cannot be resolved: it jumps, or is noisy.
    InputError
        If rate(t) is not finite or has another shape than (n, 3).
    """
    breaks, values = _segments(rate, span, longest)
    steps = _steps(values, np.diff(breaks))
    starts = _chain(q_ib, steps[:, -1])
    attitude = FIT @ quat_multiply(starts[:-1, None], steps)

    halved = np.sort(np.concatenate([breaks, breaks[:-1] + 0.5 * np.diff(breaks)]))
    finer = _chain(q_ib, _steps(sample("rate(t)", rate, halved[:-1], halved[1:])[0], np.diff(halved))[:, -1])
    coarser = np.empty_like(finer)
    coarser[::2] = starts
    coarser[1::2] = quat_multiply(starts[:-1], quat_normalize(steps[:, DEGREE // 2]))
    difference = 2 * np.linalg.norm(quat_multiply(quat_conjugate(coarser), finer)[:, 1:], axis=1)
    return RateSolution(breaks, attitude, _acceleration(values, np.diff(breaks)), float(difference.max()))


def _segments(rate: Function, span: tuple[float, float], longest: float) -> tuple[Array, Array]:
    """Return breaks (m + 1,) and the rate at the nodes (m, DEGREE + 1, 3) of segments that resolve it."""
    pieces = int(np.ceil((span[1] - span[0]) / longest))
    breaks = span[0] + (span[1] - span[0]) * (np.arange(pieces + 1) / pieces)
    breaks[-1] = span[1]
    start, end = breaks[:-1], breaks[1:]
    starts, resolved = [], []
    while len(start):
        values, derivative = sample("rate(t)", rate, start, end)
        length = end - start
        largest = np.abs(values).max(axis=(1, 2))
        tail = np.abs(FIT[-3:] @ values).max(axis=(1, 2))
        # Rounding of the rate itself, and of the time in it, is not the fit's to resolve.
        slope = np.abs(derivative).max(axis=(1, 2)) * (2 / length)
        rounding = 8 * EPS * (largest + slope * np.maximum(np.abs(start), np.abs(end)))
        fine = (tail <= rounding) | (tail * length <= NEGLIGIBLE_ANGLE)
        fine &= largest * length <= LARGEST_ANGLE
        starts.append(start[fine])
        resolved.append(values[fine])
        start, end = start[~fine], end[~fine]
        too_many = 2 * len(start) + sum(map(len, starts)) > LARGEST_COUNT + 4 * pieces
        if len(start) and (too_many or (end - start).min() <= SHORTEST * (span[1] - span[0])):
            raise AccuracyError(
                f"rate(t) is not smooth enough near t = {start[0]:.17g} s: a polynomial of degree {DEGREE} over "
                f"{end[0] - start[0]:.1g} s still misses it by {tail[~fine][0]:.1g} rad/s "
                "(a jump, noise, or a huge rate?)"
            )
        middle = start + 0.5 * (end - start)
        start, end = np.concatenate([start, middle]), np.concatenate([middle, end])
    order = np.argsort(np.concatenate(starts))
    return np.append(np.concatenate(starts)[order], span[1]), np.concatenate(resolved)[order]


def _steps(values: Array, length: Array) -> Array:
    """Return the quaternion from the start of each segment to each node, shape (m, DEGREE + 1, 4)."""
    quarter = np.zeros((*values.shape[:2], 4))
    quarter[:, :, 1:] = values * (0.25 * length)[:, None, None]  # dq/dx = (length/2) 1/2 q o omega
    change = np.zeros_like(quarter)  # q - 1, which is small and so carries smaller roundings
    for _ in range(LARGEST_ROUNDS):
        previous = change
        change = INTEGRAL @ (quarter + quat_multiply(change, quarter))
        if np.abs(change - previous).max() <= EPS:
            break
    change[:, :, 0] += 1.0
    return change


def _chain(first: Array, steps: Array) -> Array:
    """Return the quaternions at all breaks, shape (m + 1, 4): the running products of the steps, from `first`."""
    product = quat_normalize(np.concatenate([[first], steps]))
    shift = 1
    while shift < len(product):
        product[shift:] = quat_normalize(quat_multiply(product[:-shift], product[shift:]))
        shift *= 2
    return product


def _acceleration(values: Array, length: Array) -> Array:
    """Return the Chebyshev coefficients of (0, time derivative of the rate), shape (m, DEGREE + 1, 4)."""
    rate = FIT @ values
    # Coefficients at rounding would be multiplied by the square of their degree: leave out the tail of them.
    floor = 2 * EPS * np.abs(values).max(axis=(1, 2))
    heard = np.abs(rate).max(axis=2) > floor[:, None]
    rate[~np.logical_or.accumulate(heard[:, ::-1], axis=1)[:, ::-1]] = 0.0
    derivative = np.zeros((*rate.shape[:2], 4))
    derivative[:, :-1, 1:] = chebyshev.chebder(rate, axis=1)
    return derivative * (2 / length)[:, None, None]
