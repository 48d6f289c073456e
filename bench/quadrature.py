"""Exact increments: Gauss-Legendre quadrature of readings inside every sampling interval, with a residual.

Knows nothing of MuJoCo: it is given a function that evaluates readings at times.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from bench.errors import AccuracyError, Array, Indices

NODE_COUNTS = (4, 6, 8, 12, 16, 24, 32)
CHECK_EVERY = 64  # the residual is measured on every 64th interval and the last one, ...
CHECK_LEAST = 64  # ... on at least so many, ...
ROUGHER = 8.0  # ... and wherever the readings are so many times rougher than on any of those
BLOCK = 16384  # checked intervals at a time, so that memory stays flat

Times = Callable[[int, int], Array]  # (start, stop) -> times of these items, (k,)
Consume = Callable[[int, int, Array], None]  # (start, stop, readings (k, channels))
Evaluate = Callable[[int, int, Times, Consume], None]  # (number of items, items per block, times, consume)


@dataclass(frozen=True, eq=False)
class _Sums:
    """Integrals over some intervals, (k, channels), and what tells how rough the readings are there, (k,) each."""

    integrals: Array
    roughness: Array  # the highest Legendre coefficient that the nodes see, times the length of the interval
    span: Array  # from the first node to the last, largest over the channels


@dataclass(frozen=True, eq=False)
class Quadrature:
    """Integrals of readings over equal intervals; number k is from t0 + k / rate to t0 + (k + 1) / rate.

    Attributes
    ----------
    evaluate : Evaluate
    rate : float, Hz
    t0 : float, s
    channels : int
    rows : int
        Readings per block.
    """

    evaluate: Evaluate
    rate: float
    t0: float
    channels: int
    rows: int

    def chunks(self, n: int, chunk: int, tolerance: float, every: int) -> Iterator[tuple[Indices, Array, float, int]]:
        """Yield numbers, integrals (k, channels), residual and nodes of n intervals, `chunk` at a time.

        The node count is that which serves the checked intervals of the whole run, so the integrals do not
        depend on the chunk; rougher intervals get more nodes, each for itself.

        Raises
        ------
        AccuracyError
            If no node count reaches the tolerance.
        """
        every = min(every, max(1, n // CHECK_LEAST))
        nodes, residual, roughest = self._choose_nodes(np.append(np.arange(0, n - 1, every), n - 1), tolerance)
        for start in range(0, n, chunk):
            index = np.arange(start, min(start + chunk, n))
            sums = self._integrate(index, nodes)
            rough = index[sums.roughness > ROUGHER * roughest]
            for k in rough:  # few, and each for itself: how they are cut into chunks must not matter
                more, worst, _ = self._choose_nodes(np.array([k]), tolerance)
                sums.integrals[k - start] = self._integrate(np.array([k]), more).integrals[0]
                residual = max(residual, worst)
            yield index, sums.integrals, residual, nodes

    def _choose_nodes(self, index: Indices, tolerance: float) -> tuple[int, float, float]:
        """Return the node count that meets the tolerance in the given intervals, the residual and the roughness."""
        for nodes in NODE_COUNTS:
            residual, excess, roughest = 0.0, -np.inf, 0.0
            for start in range(0, len(index), BLOCK):
                part = index[start : start + BLOCK]
                coarse, fine = self._integrate(part, nodes), self._integrate(part, nodes + 1)
                difference = float(np.abs(coarse.integrals - fine.integrals).max())
                # A node is misplaced by the rounding of t, and its reading errs by the slope times that.
                misplaced = 2 * np.finfo(float).eps * (abs(self.t0) + (part[-1] + 1) / self.rate)
                largest = max(1.0, float(np.abs(fine.integrals).max()))
                allowed = tolerance * largest + misplaced * float(coarse.span.max())
                residual, excess = max(residual, difference), max(excess, difference - allowed)
                roughest = max(roughest, float(coarse.roughness.max()))
            if excess <= 0:
                return nodes, residual, roughest
        raise AccuracyError(
            f"increments at rate {self.rate:g} Hz: {NODE_COUNTS[-1]} quadrature nodes leave a residual of "
            f"{residual:.2e} (rad, m/s), above tolerance {tolerance:g}; the motion is not smooth within one interval: "
            "raise the rate or the tolerance, or put the corners of the motion on interval borders"
        )

    def _integrate(self, index: Indices, nodes: int) -> _Sums:
        """Return the integrals over the intervals with the given numbers."""
        abscissa, weight = np.polynomial.legendre.leggauss(nodes)
        highest = np.polynomial.legendre.Legendre.basis(nodes - 1)(abscissa) * weight * (nodes - 0.5) / self.rate
        abscissa, weight = 0.5 * (abscissa + 1.0), 0.5 * weight / self.rate
        n = len(index)
        sums = _Sums(np.empty((n, self.channels)), np.empty(n), np.empty(n))

        def times(start: int, stop: int) -> Array:
            return (self.t0 + (index[start:stop, None] + abscissa) / self.rate).ravel()

        def consume(start: int, stop: int, readings: Array) -> None:
            values = readings.reshape(stop - start, nodes, self.channels)
            sums.integrals[start:stop] = _weighted_sum(values, weight)
            sums.roughness[start:stop] = np.abs(_weighted_sum(values, highest)).max(axis=1)
            sums.span[start:stop] = np.abs(values[:, -1] - values[:, 0]).max(axis=1)

        self.evaluate(n, self.rows // nodes, times, consume)
        return sums


def _weighted_sum(values: Array, weight: Array) -> Array:
    """Sum (k, nodes, channels) over the nodes; in a fixed order, so that the bits do not depend on the block."""
    total = weight[0] * values[:, 0]
    for k in range(1, len(weight)):
        total += weight[k] * values[:, k]
    return total
