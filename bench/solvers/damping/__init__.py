"""Damping filters: an external velocity bounds the errors of a free-running INS, estimated from outside of it.

The INS runs free (output correction): a navigation solver with ``height="held"``, sampled once a second. A filter
takes those samples and the external reference velocity, and estimates the errors of the INS in 13 states (15 with the
error of the reference).

For a recording that `bench.solve.solve_recording` solved, `bench.damp.damp` does it all: samples, external velocity at
their times, filter, and the corrected trajectory at all times of the solution. For a Trajectory of one's own, take a
row about every second (`bench.interpolation.sampled`; all rows of a solution at 100 Hz cost a hundred times as much for
nothing)::

    t = np.arange(trajectory.t[0], trajectory.t[-1], 1.0)
    ins = InsSamples.of(sampled(trajectory, t))            # of the free INS, every second
    solution = bench.solver("damping", "double-filter").solve(ins, v_ref)  # v_ref (len(t), 2), m/s, east and north
    damped = solution.corrected(ins)                       # a Trajectory, every second
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any, ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import (
    AccuracyError,
    Array,
    InputError,
    require_array,
    require_instance,
    require_integer,
    require_scalar,
)
from bench.references import Source
from bench.solvers.damping._model import PUBLISHED, DampingModel
from bench.solvers.damping._samples import STEP_TOLERANCE, InsSamples, error_states
from bench.solvers.damping._solution import STATES, DampingSolution

__all__ = ["STATES", "DampingFilter", "DampingModel", "DampingSolution", "DampingState", "InsSamples", "error_states"]

LONGEST_STEP = 20.0  # s; see bench.solvers.damping.error_model for what the series lacks
STEPS_PER_TAU = 10  # at least, for the same reason


@dataclass(frozen=True, eq=False)
class DampingState:
    """Where a damping filter stands between two chunks; made by ``start`` and ``advance``.

    Attributes
    ----------
    filter : DampingFilter
        Whose state it is: no other can go on with it.
    dt : float, s
        Step of the samples.
    rows : int
        Samples seen.
    last : InsSamples or None
        The last sample.
    carry : Any
        Estimates, covariances and sums as the filter keeps them; never written in place.
    """

    filter: "DampingFilter"
    dt: float
    rows: int
    last: InsSamples | None
    carry: Any


@dataclass(frozen=True)
class DampingFilter(ABC):
    """Base of the damping filters: the contract and all checks.

    A filter declares ``name`` and ``source`` and defines `_start` and `_run`; it overrides nothing else.

    Parameters
    ----------
    model : DampingModel
        What the filter believes of errors and noises.
    gate : float or None
        Probability, between 0 and 1 such as 0.999, with which a measurement that obeys the model is used; one whose
        innovation is too large (chi-square of 2 degrees) is left out. None uses all.
    covariance_every : int
        Keep the full covariance at every so many-th sample, beginning with the first, in the solution in Python
        (tables have the standard deviations); 0 keeps none.

    Raises
    ------
    InputError
        If an option is out of range.
    """

    name: ClassVar[str]
    source: ClassVar[Source]

    model: DampingModel = PUBLISHED
    gate: float | None = None
    covariance_every: int = 0

    def __post_init__(self) -> None:
        require_instance("model", self.model, DampingModel)
        if self.gate is not None and not 0.0 < require_scalar("gate", self.gate) < 1.0:
            raise InputError(f"gate must be a probability between 0 and 1, or None, got {self.gate!r}")
        require_integer("covariance_every", self.covariance_every, minimum=0)
        self._check_options()

    def _check_options(self) -> None:  # noqa: B027 (no option to check is the rule)
        """Check the options that a filter adds."""

    @property
    def threshold(self) -> float:
        """Largest normalised innovation squared that passes the gate: chi-square of 2 degrees is exponential."""
        return np.inf if self.gate is None else float(-2.0 * np.log1p(-self.gate))

    @abstractmethod
    def _start(self, dt: float) -> Any:
        """Return the carry before the first sample."""

    @abstractmethod
    def _run(self, state: DampingState, ins: InsSamples, v_ref: Array) -> tuple[Any, DampingSolution]:
        """Return the next carry and the solution at the rows of ins; ``state.last`` is the sample before, or None."""

    @final
    def start(self, dt: float = 1.0) -> DampingState:
        """Return the state before the first sample.

        Parameters
        ----------
        dt : float, s
            Step of the samples, at most a tenth of either correlation time and 20 s.

        Raises
        ------
        InputError
            If dt is not positive or longer than 20 s, or a correlation time is shorter than ten steps.
        """
        dt = require_scalar("dt", dt, positive=True)
        if dt > LONGEST_STEP:
            raise InputError(f"dt must be at most {LONGEST_STEP:g} s, got {dt!r}")
        for name in ("tau_f", "tau_g"):
            tau = getattr(self.model, name)
            if tau < STEPS_PER_TAU * dt:
                raise InputError(
                    f"{name} must be at least {STEPS_PER_TAU} steps of the filter, {STEPS_PER_TAU * dt:g} s at steps "
                    f"of {dt:g} s, got {tau:g} s"
                )
        return DampingState(self, dt, 0, None, self._start(dt))

    @final
    def advance(self, state: DampingState, ins: InsSamples, v_ref: ArrayLike) -> tuple[DampingState, DampingSolution]:
        """Return the next state and the solution at the samples of a chunk.

        Parameters
        ----------
        state : DampingState
        ins : InsSamples
            The free INS at the next m times. The first of the run has a measurement, but no interval before it.
        v_ref : array_like, shape (m, 2), m/s
            External velocity, east and north, at the same times; a row of NaN where there is none.

        Raises
        ------
        InputError
            If the state is another filter's, times do not follow each other, or v_ref has another shape or infinities.
        AccuracyError
            If the estimate is no longer finite.
        """
        if not isinstance(state, DampingState) or state.filter != self:
            owner = getattr(state, "filter", state)
            got = f"that of {owner!r}" if isinstance(owner, DampingFilter) else type(owner).__name__
            raise InputError(f"state must come from start or advance of {self!r}, got {got}")
        if not isinstance(ins, InsSamples):
            raise InputError(f"ins must be InsSamples, got {type(ins).__name__}")
        _check_times(state, ins)
        v_ref = require_array("v_ref", v_ref, (len(ins), 2), finite=False)
        if np.isinf(v_ref).any() or (np.isnan(v_ref[:, 0]) != np.isnan(v_ref[:, 1])).any():
            raise InputError("v_ref must be finite, or NaN both east and north where there is no reference")
        carry, solution = self._run(state, ins, v_ref)
        for part in (solution, *solution.parts):
            finite = (np.isfinite(part.x) & np.isfinite(part.sigma)).all(axis=1)
            if not finite.all():
                raise AccuracyError(f"{self.name} diverges at t = {part.t[int(np.argmin(finite))]:g} s")
        return replace(state, rows=state.rows + len(ins), last=ins[-1:], carry=carry), solution

    @final
    def solve(self, ins: InsSamples, v_ref: ArrayLike) -> DampingSolution:
        """Return the estimated errors of a whole run, as `start` and `advance`.

        Raises
        ------
        InputError, AccuracyError
            As `start` and `advance`; also if there is one sample only.
        """
        if not isinstance(ins, InsSamples) or len(ins) < 2:
            got = f"{len(ins)} row" if isinstance(ins, InsSamples) else type(ins).__name__
            raise InputError(f"ins must be InsSamples of at least 2 rows, got {got}")
        dt = float(ins.t[-1] - ins.t[0]) / (len(ins) - 1)
        return self.advance(self.start(dt), ins, v_ref)[1]


def _check_times(state: DampingState, ins: InsSamples) -> None:
    t = ins.t if state.last is None else np.concatenate([state.last.t, ins.t])
    if len(t) > 1 and (gap := np.abs(np.diff(t) - state.dt).max()) > STEP_TOLERANCE:
        raise InputError(f"ins must go on in steps of dt = {state.dt:g} s, a step differs by {gap:g} s")
