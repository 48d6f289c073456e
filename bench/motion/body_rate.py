"""Body rate: a motion given by any smooth function of time for the body rate, its attitude solved to rounding."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from bench.errors import AccuracyError, Array, InputError, require_array, require_scalar
from bench.motion import STANDARD, Motion
from bench.motion._options import (
    IDENTITY,
    STILL,
    Quaternion,
    Span,
    Vector,
    as_quaternion,
    as_span,
    as_vector,
    require_within,
    set_options,
)
from bench.signals import Kinematics

if TYPE_CHECKING:
    from bench.motion._rate_solution import RateSolution


@dataclass(frozen=True)
class BodyRate(Motion):
    """Body rate: the attitude follows from omega(t), for which there is seldom a closed form.

    q' = 1/2 q o (0, omega) is solved once, when it is first needed, on Chebyshev segments that resolve
    the rate to rounding (see ``_rate_solution``); solved attitudes are good to a few 1e-15 rad a minute.
    The functions are called with any number of times at once and must return one row each.

    Parameters
    ----------
    rate : callable, (n,) s -> (n, 3) rad/s
        omega_ib_b: continuous, smooth but for isolated kinks, and without features shorter than about
        a tenth of `longest_segment`, which sampling could miss.
    span : (start, end), s
        Where the motion is defined.
    q_ib : tuple of 4 floats
        Attitude at the start of the span, b to i, wxyz, unit.
    alpha : callable, (n,) s -> (n, 3) rad/s^2, optional
        Derivative of the rate. Without it the derivative of the fitted rate is used, good to about 1e-12 relative.
    translation : callable, (n,) s -> three arrays (n, 3), optional
        Position, velocity and acceleration of the body origin in i: m, m/s, m/s^2. Without it: at rest at the origin.
    gravity : tuple of 3 floats, m/s^2
        Gravitational acceleration, in i.
    tolerance : float, rad
        Largest admissible `error_estimate`.
    longest_segment : float, s
        The adaptive segments start from this length.

    Raises
    ------
    InputError
        If an option breaks a rule; in use, if a function returns another shape or a non-finite value, or if
        a time lies outside the span.
    AccuracyError
        In use, if the rate is not smooth enough for the tolerance.
    """

    name: ClassVar[str] = "body-rate"

    rate: Callable[[Array], Array]
    span: Span
    q_ib: Quaternion = IDENTITY
    alpha: Callable[[Array], Array] | None = None
    translation: Callable[[Array], tuple[Array, Array, Array]] | None = None
    gravity: Vector = STANDARD
    tolerance: float = 1e-11
    longest_segment: float = 0.25

    def __post_init__(self) -> None:
        if not callable(self.rate):
            raise InputError(f"rate must be a function of times, got {self.rate!r}")
        for name in ("alpha", "translation"):
            if not (getattr(self, name) is None or callable(getattr(self, name))):
                raise InputError(f"{name} must be a function of times or None, got {getattr(self, name)!r}")
        set_options(
            self,
            span=as_span("span", self.span),
            q_ib=as_quaternion("q_ib", self.q_ib),
            gravity=as_vector("gravity", self.gravity),
            tolerance=require_scalar("tolerance", self.tolerance, positive=True),
            longest_segment=require_scalar("longest_segment", self.longest_segment, positive=True),
        )

    @cached_property
    def _solution(self) -> "RateSolution":
        from bench.motion._rate_solution import solve

        solution = solve(self.rate, self.span, np.array(self.q_ib), self.longest_segment)
        if solution.error_estimate > self.tolerance:
            raise AccuracyError(
                f"the attitude from rate(t) is known to {solution.error_estimate:.1g} rad only, "
                f"tolerance is {self.tolerance:g} rad (noise in the rate, or features shorter than "
                f"{self.longest_segment / 10:.1g} s? try a smaller longest_segment)"
            )
        return solution

    @property
    def error_estimate(self) -> float:
        """Estimated error of the attitude over the span, rad: the difference to a solution at twice the resolution."""
        return self._solution.error_estimate

    def kinematics(self, t: Array) -> Kinematics:
        """Return the true kinematics at times t, shape (n,), s."""
        t = require_within(t, self.span)
        shape = (len(t), 3)
        position, velocity, acceleration = (STILL,) * 3 if self.translation is None else self.translation(t)
        alpha = self._solution.alpha_ib_b(t) if self.alpha is None else self.alpha(t)
        return Kinematics(
            position=position,
            velocity=velocity,
            acceleration=acceleration,
            q_ib=self._solution.q_ib(t),
            omega_ib_b=require_array("rate(t)", self.rate(t), shape),
            alpha_ib_b=require_array("alpha(t)", alpha, shape),
            gravity=np.array(self.gravity),
        )
