"""Functional iteration: the attitude over an update as the fixed point of an integral, in Chebyshev series."""

import math
import warnings
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bench.errors import AccuracyError, Array, BenchWarning, require_choice, require_integer
from bench.references import WU_YAN, Source
from bench.solvers.attitude import AttitudeSolver, require_samples

# The angle S that an update must not reach; for the quaternion, so that e^(S/2) roundings are below 1e-12.
FORMS = {"quaternion": 18.0, "rodrigues": math.pi, "rotation-vector": 2.0}  # rad
TOLERANCE = 1e-12  # rad; a larger change in the last of a fixed number of iterations is worth a warning


@dataclass(frozen=True)
class FunctionalIteration(AttitudeSolver):
    """Functional iteration: y <- y(0) + integral of y'(y, omega), omega being a polynomial fitted to N increments.

    With w = (T/2) omega on -1 <= x <= 1, as products and integrals of Chebyshev series:
    quaternion q <- 1 + int 1/2 q o w [WuYan];
    Rodrigues vector g <- int w + 1/2 g x w + 1/4 (g . w) g [Wu];
    rotation vector phi <- int w + 1/2 phi x w + f(phi) phi x (phi x w) [Yan], f by its power series.
    The forms agree to rounding: only the fit limits the accuracy. Products are cut off at degree 128, and
    where the coefficients have fallen to 2^-60: that is to rounding, or an error says so.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8.
    form : {"quaternion", "rodrigues", "rotation-vector"}
        With S = int |omega| dt over an update: the quaternion converges for every rate, as (S/2)^n/n!, with
        e^(S/2) roundings; S < 18 rad is admitted. The Rodrigues vector converges for S < pi, to rounding with
        series of this degree for S < 3.05 rad. The rotation vector is admitted for S < 2 rad, where it agrees
        with the others to 1e-14 rad an update; at 3 rad it is 1e-10 off.
    iterations : int, optional
        Fixed number; without it as many as lead to rounding.

    Raises
    ------
    InputError
        If an option breaks a rule.
    AccuracyError
        In use, if an update turns too far for the form.

    Warns
    -----
    BenchWarning
        Once a solve, if the last of a fixed number of iterations still changes an update by more than 1e-12 rad.

    Notes
    -----
    Order N + 1 for odd N, N + 2 for even N, that of the fit; none is stated for a fixed number of iterations.

    References
    ----------
    [Wu] Wu, RodFIter: attitude reconstruction from inertial measurement by functional iteration, IEEE Trans.
    Aerospace and Electronic Systems 54(5), 2018.
    [WuYan] Wu, Yan, Attitude reconstruction from inertial measurements: QuatFIter and its comparison with RodFIter,
    IEEE Trans. Aerospace and Electronic Systems 55(6), 2019.
    [Yan] Yan, Weng, Yang, Qin, An accurate numerical solution for strapdown attitude algorithm based on Picard
    iteration, J. Astronautics 38(12), 2017.
    """

    name: ClassVar[str] = "functional-iteration"
    source: ClassVar[Source] = WU_YAN

    samples: int = 8
    form: str = "quaternion"
    iterations: int | None = None

    def __post_init__(self) -> None:
        require_samples(self)
        require_choice("form", self.form, FORMS)
        if self.iterations is not None:
            require_integer("iterations", self.iterations, minimum=1)

    @property
    def order_periodic(self) -> int | None:
        """N + 1 rounded up to even, the order of the fit."""
        return None if self.iterations else 2 * (self.samples // 2) + 2

    @property
    def order_drift(self) -> int | None:
        """As the periodic one."""
        return self.order_periodic

    def _constants(self) -> tuple[Any, ...]:
        from bench.solvers.attitude._chebyshev import bortz_series, rate_fit

        return rate_fit(self.samples), bortz_series()

    def _carry(self, q0: Array) -> Array:
        return np.append(q0, 0.0)  # whether a warning was given

    def _update(
        self,
        constants: tuple[Any, ...],
        dtheta: Array,
        starts: NDArray[np.int64],
        offsets: NDArray[np.int64],
        dt: float,
        carry: Array,
        out: Array,
    ) -> None:
        fit, series = constants
        form, limit, rounds = list(FORMS).index(self.form), FORMS[self.form], self.iterations or 0
        if self.form == "quaternion":
            from bench.solvers.attitude._chebyshev_kernels import functional_iteration

            done, angle, change = functional_iteration(fit, limit, rounds, dtheta, starts, carry, out)
        else:
            from bench.solvers.attitude._chebyshev_vector_kernels import vector_iteration

            done, angle, change = vector_iteration(form, fit, series, limit, rounds, dtheta, starts, carry, out)
        if not done:
            raise AccuracyError(self._no_result(angle, limit))
        if rounds and change > TOLERANCE and not carry[4]:
            carry[4] = 1.0
            warnings.warn(
                f"{self.name}: iterations = {rounds} is too few for these increments: the last one still changes "
                f"an update by {change:.1g} rad",
                BenchWarning,
                stacklevel=2,
            )

    def _no_result(self, angle: float, limit: float) -> str:
        turned = f"an update turns through S = sum |dtheta_b| = {angle:.6g} rad"
        if not angle < limit:
            return f"{self.name} in the form {self.form!r} needs S < {limit:.6g} rad in every update, but {turned}"
        return f"{self.name} in the form {self.form!r} does not converge to rounding: {turned}"
