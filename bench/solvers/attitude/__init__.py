"""Attitude solvers: angle increments of a gyro to attitude.

A solver takes the increments ``dtheta_b`` (the integral of omega_ib_b over each of n equal intervals), N at a time,
and gives the attitude at every update, ``T = N dt`` apart. It may look at a window of W >= N increments round the N of
an update; then it is late by the increments that it borrows from the future, and at both ends of a stream it uses the
first or the last W increments.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any, ClassVar, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bench.errors import (
    AccuracyError,
    Array,
    InputError,
    require_array,
    require_integer,
    require_scalar,
    require_unit_quaternion,
)
from bench.references import Source

MAX_SAMPLES = 8


@dataclass(frozen=True, eq=False)
class AttitudeState:
    """Where an attitude solver stands between two chunks; made by ``start`` and ``advance``.

    Attributes
    ----------
    solver : AttitudeSolver
        Whose state it is: no other can go on with it.
    constants : tuple
        What the solver computed from its options.
    dt : float, s
    kept : ndarray, shape (k, 3), rad
        The latest increments, as far back as a window may reach.
    first : int
        Number of the increment ``kept[0]``, counted from the start of the stream.
    updates : int
        Updates done.
    carry : ndarray
        The running attitude as the solver keeps it (see `AttitudeSolver._carry`); never written in place.
    """

    solver: "AttitudeSolver"
    constants: tuple[Any, ...]
    dt: float
    kept: Array
    first: int
    updates: int
    carry: Array


@dataclass(frozen=True)
class AttitudeSolver(ABC):
    """Base of the attitude solvers: the contract, the loop over chunks and all checks.

    A solver declares ``name`` and ``source``, defines `_constants` and `_update`, and may define `_carry` and the
    facts `borrowed`, `order_periodic`, `order_drift`, `constant_rate_tolerance`; it overrides nothing else.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8 unless the solver says otherwise.

    Raises
    ------
    InputError
        If `samples` is out of range.
    """

    name: ClassVar[str]
    source: ClassVar[Source]

    samples: int = 3

    @abstractmethod
    def _constants(self) -> tuple[Any, ...]:
        """Return coefficients and tables for `_update`, from the options alone (float64 arrays and numbers)."""

    @abstractmethod
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
        """Do len(out) updates: fill out (u, 4) with unit q and leave the running attitude in carry.

        Update k has the window ``dtheta[starts[k] : starts[k] + W]``; its N own increments begin ``offsets[k]``
        behind the start of the window. Without borrowing W = N, starts = 0, N, 2N, ... and offsets = 0.
        """

    def _carry(self, q0: Array) -> Array:
        """Return the running attitude as the solver keeps it: q unless it says otherwise."""
        return q0.copy()

    @property
    def borrowed(self) -> tuple[int, int]:
        """Increments of the window before and after the N of an update."""
        return 0, 0

    @property
    def latency(self) -> int:
        """Increments by which the attitude is late: those borrowed from the future."""
        return self.borrowed[1]

    @property
    @abstractmethod
    def order_periodic(self) -> int | None:
        """Order in dt of the oscillating error on a smooth motion; None where there is no slope to state."""

    @property
    @abstractmethod
    def order_drift(self) -> int | None:
        """Order in dt of the rectified error (drift) on coning; None where there is no slope to state."""

    @property
    def constant_rate_tolerance(self) -> float:
        """Largest error per update at a constant rate of 0.1 rad per update, rad; rounding for most."""
        return 4e-16

    @final
    def start(self, dt: float, q0: ArrayLike) -> AttitudeState:
        """Return the state before the first increment.

        Parameters
        ----------
        dt : float, s
            Length of one interval.
        q0 : array_like, shape (4,)
            Attitude at the start of the first interval, b to i, wxyz, unit.

        Raises
        ------
        InputError
            If dt is not positive or q0 is not a unit quaternion.
        """
        dt = require_scalar("dt", dt, positive=True)
        q0 = require_unit_quaternion("q0", q0)
        return AttitudeState(self, self._constants(), dt, np.empty((0, 3)), 0, 0, self._carry(q0))

    @final
    def advance(self, state: AttitudeState, dtheta_b: ArrayLike) -> tuple[AttitudeState, Array]:
        """Return the next state and the attitudes of the updates that the chunk completes, shape (u, 4).

        Parameters
        ----------
        state : AttitudeState
        dtheta_b : array_like, shape (n, 3), rad
            Any number of increments; the rest waits in the state.

        Raises
        ------
        InputError
            If the increments have another shape or are not finite.
        AccuracyError
            If the attitude is no longer finite.
        """
        self._require_own(state)
        if np.shape(dtheta_b) == (0, 3):  # a live stream has such chunks
            return state, np.empty((0, 4))
        chunk = require_array("dtheta_b", dtheta_b, (None, 3))
        if len(state.kept):
            chunk = np.concatenate([state.kept, chunk])
        return self._advance(state, chunk, last=False)

    @final
    def finish(self, state: AttitudeState) -> Array:
        """Return the attitudes that were held back for want of later increments, shape (u, 4).

        Raises
        ------
        InputError
            If increments are left over that do not fill an update, or the stream was shorter than one window.
        """
        if total := state.first + len(state.kept):
            self._check_length(total)
        return self._advance(state, state.kept, last=True)[1]

    def _require_own(self, state: AttitudeState) -> None:
        if not isinstance(state, AttitudeState) or state.solver != self:
            owner = getattr(state, "solver", state)
            raise InputError(f"state must come from start or advance of {self!r}, got that of {owner!r}")

    @final
    def solve(self, dtheta_b: ArrayLike, dt: float, q0: ArrayLike, chunk: int = 16384) -> Array:
        """Return the attitude at every update.

        Parameters
        ----------
        dtheta_b : array_like, shape (n, 3), rad
            Integral of omega_ib_b over each of n equal intervals; n a multiple of `samples`.
        dt : float, s
        q0 : array_like, shape (4,)
            Attitude at the start, b to i, wxyz, unit.
        chunk : int
            Increments per step of the loop; does not change the result.

        Returns
        -------
        ndarray, shape (n // samples + 1, 4)
            q_ib, wxyz, unit; the first row is q0.

        Raises
        ------
        InputError
            If an argument has another shape, is not finite, n is not a multiple of `samples`, or smaller than the
            window.
        AccuracyError
            If the attitude is no longer finite.
        """
        chunk = require_integer("chunk", chunk, minimum=1)
        state = self.start(dt, q0)
        dtheta = require_array("dtheta_b", dtheta_b, (None, 3), finite=False)
        n = len(dtheta)
        self._check_length(n)
        q = np.empty((n // self.samples + 1, 4))
        q[0] = require_unit_quaternion("q0", q0)
        for end in range(chunk, n + chunk, chunk):
            # A view that begins where the kept increments do, instead of a copy of them and the chunk.
            block = dtheta[state.first : end]
            if not np.isfinite(block).all():
                require_array("dtheta_b", dtheta, (None, 3))  # says where
            state, _ = self._advance(state, block, last=end >= n, rows=q[1:])
        return q

    @property
    def _window(self) -> int:
        return self.samples + sum(self.borrowed)

    def _check_length(self, n: int) -> None:
        if n % self.samples:
            raise InputError(f"dtheta_b must have a multiple of samples = {self.samples} increments, got {n}")
        if n < self._window:
            raise InputError(f"{self.name} needs at least {self._window} increments (its window), got {n}")

    def _advance(
        self, state: AttitudeState, block: Array, *, last: bool, rows: Array | None = None
    ) -> tuple[AttitudeState, Array]:
        """Do all updates whose window lies in the block; with `last`, the remaining ones with the last window.

        The block begins with the increment `state.first`; update k is written to rows[k] if rows are given.
        """
        N, W, (before, _) = self.samples, self._window, self.borrowed
        self._require_own(state)
        total = state.first + len(block)
        # A window starts `before` increments ahead of its update, but not before the stream.
        ready = total // N if last else 0 if total < W else (total - W + before) // N + 1
        done, ready = state.updates, max(ready, state.updates)
        out = np.empty((ready - done, 4)) if rows is None else rows[done:ready]
        carry = state.carry
        if len(out):
            carry = carry.copy()
            block = block if block.flags.writeable else block.copy()  # a read-only array is another type to numba
            own = np.arange(N * done, N * ready, N) - state.first
            starts = own if W == N else np.clip(own - before, -state.first, total - W - state.first)
            self._update(state.constants, block, starts, own - starts, state.dt, carry, out)
            if not np.isfinite(out).all():
                k = done + int(np.argmin(np.isfinite(out).all(axis=1)))
                raise AccuracyError(
                    f"{self.name} diverges at update {k}: the increments are too large or too irregular for it"
                )
        # The next update may look back `before` increments, and the last ones as far as a whole window.
        first = max(min(N * ready - before, total - W), state.first)
        kept = block[first - state.first :].copy()
        return replace(state, kept=kept, first=first, updates=ready, carry=carry), out


def require_samples(solver: AttitudeSolver, minimum: int = 1, maximum: int = MAX_SAMPLES) -> None:
    """Check `samples` of a solver.

    Raises
    ------
    InputError
        If it is not an integer in the range.
    """
    if require_integer("samples", solver.samples, minimum=minimum) > maximum:
        raise InputError(f"samples must be an integer from {minimum} to {maximum}, got {solver.samples}")
