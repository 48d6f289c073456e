"""Any accelerometer array, from its geometry: the maximum-likelihood rate of every reading."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from bench.errors import Array
from bench.references import SKOG, Source
from bench.signals import Accelerometers
from bench.solvers.gyro_free import START, GyroFreeSolver
from bench.solvers.gyro_free._design import Observability, observability, require_motion, solver_design

__all__ = ["ArrayLeastSquares", "Observability", "observability"]


@dataclass(frozen=True)
class ArrayLeastSquares(GyroFreeSolver):
    """Any accelerometer array that determines f and alpha: least squares in all unknowns of a reading.

    What the geometry tells of the six products of two rates decides how the rate is found (see `observability`):
    from all products, with one sign from integrated alpha; from the squares, with three signs; or, where neither
    follows, by integrating alpha. The first two are refined to the maximum of the likelihood in omega with f and
    alpha free (Newton's method; a negative square becomes zero and the other rates are fitted anew), which reaches
    the Cramer-Rao bound of one reading where the rate is well above the root of the noise of its square. With omega
    known, [f, alpha] is linear least squares.

    Notes
    -----
    The products of an array that does not determine all three squares are not used for the rate, only kept out of
    alpha: those of Padgaonkar's nine give the rate only where all three rates differ from zero, and the squares of
    the paper's nine, mounted along other axes than the body's, only combinations. Such an array is integrated.
    Fourth order in dt.

    References
    ----------
    [Skog] Skog, Nilsson, Handel, Nehorai, Inertial sensor arrays, maximum likelihood, and Cramer-Rao bound, 2016.
    """

    name: ClassVar[str] = "array-least-squares"
    source: ClassVar[Source] = SKOG

    def _constants(self, accelerometers: Accelerometers) -> tuple[Any, ...]:
        mode = require_motion(accelerometers).mode
        design = solver_design(accelerometers, mode)
        rows = [design.M] if mode == "integral" else [design.M, design.B, design.S]
        return mode, np.concatenate(rows), design.K, design.G

    def _rates(
        self,
        constants: tuple[Any, ...],
        readings: Array,
        dt: float,
        started: bool,
        carry: Array,
        omega: Array,
        alpha: Array,
        f: Array,
    ) -> int:
        from bench.solvers.gyro_free import _array_kernels as kernels

        mode = {"integral": kernels.INTEGRAL, "squares": kernels.SQUARES, "rank-one": kernels.RANK_ONE}[constants[0]]
        matrix, K, G = constants[1:]
        parts = np.empty((len(readings), len(matrix)))
        kernels.apply(matrix, readings, parts)
        out = (omega, alpha, f)
        if started:
            return int(kernels.stream(mode, K, G, parts, 0, dt, self._fourth, carry, *out))
        first = START if self._fourth else 1
        negative = _begin(mode, K, G, parts[:first], dt, carry, out)
        return negative + int(kernels.stream(mode, K, G, parts, first, dt, self._fourth, carry, *out))


def _begin(
    mode: int, K: Array, G: Array, parts: Array, dt: float, carry: Array, out: tuple[Array, Array, Array]
) -> int:
    """Solve the first readings (four, or the only one that Euler steps need) together, by sweeps."""
    from bench.solvers.gyro_free import _array_kernels as kernels
    from bench.solvers.gyro_free._strapdown import accumulate

    fourth = len(parts) == START
    free, rest = np.tile(carry[0], (len(parts), 1)), np.empty(6)
    start = carry.copy()
    for _ in range(kernels.SWEEPS):
        negative = 0
        for k in range(len(parts)):
            negative += kernels.motion(mode, K, G, parts, k, free, k, rest, *out)
        before = free.copy()
        carry[:] = start
        accumulate(out[1][: len(parts)], dt, fourth, False, carry, free)
        if not np.abs(free - before).max() > 1e-15 * np.abs(free).max():
            break
    return negative
