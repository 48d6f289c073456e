"""Navigation solvers: angle and velocity increments of a strapdown IMU to attitude, velocity and position on the Earth.

A solver takes the increments ``dtheta_b`` and ``dvel_b`` (the integrals of omega_ib_b and of the specific force f_b, in
the turning body axes, over each of n equal intervals), N at a time, and gives attitude, velocity and position at every
update, ``T = N dt`` apart. Whatever frame it works in, it reports in the Earth frame e (see ``bench.trajectory``).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any, ClassVar, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bench.earth import WGS84, Earth
from bench.errors import (
    AccuracyError,
    Array,
    InputError,
    require_array,
    require_choice,
    require_integer,
    require_scalar,
)
from bench.references import Source
from bench.rotation import quat_multiply, quat_rotate
from bench.trajectory import NavigationInitial, Trajectory

HEIGHTS = ("free", "held")
COLUMNS = 10  # q_eb (4), v_e (3), r_e (3)


@dataclass(frozen=True, eq=False)
class NavigationState:
    """Where a navigation solver stands between two chunks; made by ``start`` and ``advance``.

    Attributes
    ----------
    solver : NavigationSolver
        Whose state it is: no other can go on with it.
    constants : tuple
        What the solver computed from its options, the Earth and dt.
    earth : Earth
    dt : float, s
    kept : ndarray, shape (k, 6), rad and m/s
        Increments (dtheta_b, dvel_b) that do not fill an update yet.
    updates : int
        Updates done.
    carry : ndarray
        The running state as the solver keeps it; never written in place.
    """

    solver: "NavigationSolver"
    constants: tuple[Any, ...]
    earth: Earth
    dt: float
    kept: Array
    updates: int
    carry: Array


@dataclass(frozen=True)
class NavigationSolver(ABC):
    """Base of the navigation solvers: the contract, the loop over chunks and all checks.

    A solver declares ``name`` and ``source`` and defines `_constants`, `_carry` and `_update`; it may define
    `_check_options` and the fact `order_periodic`; it overrides nothing else.

    Parameters
    ----------
    samples : int
        N, increments per update.
    height : {"free", "held"}
        Whether the height is integrated (unstable: errors grow e-fold in about 10 minutes), or kept at its
        initial value with the upward velocity zero, as for ships and vehicles with another height sensor.

    Raises
    ------
    InputError
        If an option is out of range.
    """

    name: ClassVar[str]
    source: ClassVar[Source]
    max_samples: ClassVar[int] = 8

    samples: int = 2
    height: str = "free"

    def __post_init__(self) -> None:
        if require_integer("samples", self.samples, minimum=1) > self.max_samples:
            raise InputError(f"samples must be an integer from 1 to {self.max_samples}, got {self.samples}")
        require_choice("height", self.height, HEIGHTS)
        self._check_options()

    def _check_options(self) -> None:  # noqa: B027 - a solver without further options has nothing to check
        """Check the options that a solver adds."""

    @property
    def order_periodic(self) -> int | None:
        """Lowest of the orders in dt of attitude, velocity and position on a smooth motion with attitude swing.

        None where there is no slope to state.
        """
        return None

    @abstractmethod
    def _constants(self, earth: Earth, dt: float) -> tuple[Any, ...]:
        """Return coefficients and tables for `_update` (float64 arrays and numbers)."""

    @abstractmethod
    def _carry(self, earth: Earth, dt: float, initial: NavigationInitial, row: Array) -> Array:
        """Return the running state at the start; row (10,) is the initial q_eb, v_e, r_e."""

    @abstractmethod
    def _update(
        self,
        constants: tuple[Any, ...],
        increments: Array,
        first: int,
        carry: Array,
        out: Array,
    ) -> None:
        """Do len(out) updates of N increments each.

        increments (u N, 6) holds dtheta_b and dvel_b; fill out (u, 10) with q_eb (unit), v_e, r_e after each update and
        leave the running state in carry. Update k of the chunk is number first + k of the run, counted from 0:
        it ends at t = (first + k + 1) N dt, the time to take the Earth's turn from.
        """

    @final
    def start(
        self,
        dt: float,
        initial: NavigationInitial,
        earth: Earth = WGS84,
    ) -> NavigationState:
        """Return the state before the first increment.

        Parameters
        ----------
        dt : float, s
            Length of one interval.
        initial : NavigationInitial
            At the start of the first interval.
        earth : Earth

        Raises
        ------
        InputError
            If dt is not positive, or initial or earth is something else.
        """
        dt = require_scalar("dt", dt, positive=True)
        _require_instance("initial", initial, NavigationInitial)
        _require_instance("earth", earth, Earth)
        row = _first_row(initial, earth)
        return NavigationState(
            self, self._constants(earth, dt), earth, dt, np.empty((0, 6)), 0, self._carry(earth, dt, initial, row)
        )

    @final
    def advance(
        self, state: NavigationState, dtheta_b: ArrayLike, dvel_b: ArrayLike
    ) -> tuple[NavigationState, Trajectory | None]:
        """Return the next state and the trajectory at the updates that the chunk completes (None: it completes none).

        Parameters
        ----------
        state : NavigationState
        dtheta_b, dvel_b : array_like, shape (n, 3), rad, m/s
            Any number of increments; the rest waits in the state.

        Raises
        ------
        InputError
            If the increments have another shape or are not finite.
        AccuracyError
            If the solution is no longer finite.
        """
        if not isinstance(state, NavigationState) or state.solver != self:
            owner = getattr(state, "solver", state)
            raise InputError(f"state must come from start or advance of {self!r}, got that of {owner!r}")
        if np.shape(dtheta_b) == np.shape(dvel_b) == (0, 3):  # a live stream has such chunks
            return state, None
        block = _joined(dtheta_b, dvel_b)
        if len(state.kept):
            block = np.concatenate([state.kept, block])
        done = state.updates
        out = np.empty((len(block) // self.samples, COLUMNS))
        state, _ = self._advance(state, block, out)
        if not len(out):
            return state, None
        return state, self._solution(state, done + 1, [out[:, :4].copy(), out[:, 4:7].copy(), out[:, 7:].copy()])

    @final
    def solve(
        self,
        dtheta_b: ArrayLike,
        dvel_b: ArrayLike,
        dt: float,
        initial: NavigationInitial,
        earth: Earth = WGS84,
        chunk: int = 16384,
    ) -> Trajectory:
        """Return attitude, velocity and position at the start and at every update.

        Parameters
        ----------
        dtheta_b : array_like, shape (n, 3), rad
            Integral of omega_ib_b over each of n equal intervals; n a multiple of `samples`.
        dvel_b : array_like, shape (n, 3), m/s
            Integral of the specific force f_b over the same intervals, in the turning body axes.
        dt : float, s
        initial : NavigationInitial
        earth : Earth
            Whose rotation, gravitation and ellipsoid the solver uses.
        chunk : int
            Increments per step of the loop; does not change the result.

        Returns
        -------
        Trajectory, n // samples + 1 rows
            At t = 0, T, 2 T, ...; the first row is `initial`.

        Raises
        ------
        InputError
            If an argument has another shape, is not finite, or n is not a multiple of `samples`.
        AccuracyError
            If the solution is no longer finite.
        """
        chunk = require_integer("chunk", chunk, minimum=1)
        state = self.start(dt, initial, earth)
        dtheta = require_array("dtheta_b", dtheta_b, (None, 3), finite=False)
        dvel = require_array("dvel_b", dvel_b, (len(dtheta), 3), finite=False)
        n, N = len(dtheta), self.samples
        if n % N:
            raise InputError(f"dtheta_b must have a multiple of samples = {N} increments, got {n}")
        step = min(max(chunk // N, 1) * N, n)
        # The two buffers stay in the processor's cache; only what is returned is written to fresh memory.
        buffer, out = np.empty((step, 6)), np.empty((step // N, COLUMNS))
        columns = [np.empty((n // N + 1, width)) for width in (4, 3, 3)]
        _scatter(_first_row(initial, earth)[None], columns, 0)
        for begin in range(0, n, step):
            block = buffer[: min(step, n - begin)]
            _rows(block[:, :3])[:], _rows(block[:, 3:])[:] = (
                _rows(dtheta[begin : begin + step]),
                _rows(dvel[begin : begin + step]),
            )
            if not np.isfinite(block).all():  # say where
                require_array("dtheta_b", dtheta, (None, 3))
                require_array("dvel_b", dvel, (None, 3))
            state, rows = self._advance(state, block, out[: len(block) // N])
            _scatter(rows, columns, begin // N + 1)
        return self._solution(state, 0, columns)

    def _solution(self, state: NavigationState, first: int, columns: list[Array]) -> Trajectory:
        """Return attitude, velocity and position at the updates from number `first` on."""
        t = np.arange(first, first + len(columns[0]), dtype=np.float64) * (self.samples * state.dt)
        try:
            return Trajectory(state.earth, t, *columns)
        except InputError as error:  # not of the caller's making
            raise AccuracyError(f"{self.name} diverges, the increments are too large for it: {error}") from error

    def _advance(self, state: NavigationState, block: Array, out: Array) -> tuple[NavigationState, Array]:
        """Do all updates that the block fills and write them to out."""
        N, done = self.samples, state.updates
        count = len(out)
        carry = state.carry
        if count:
            carry = carry.copy()
            self._update(state.constants, np.ascontiguousarray(block[: count * N]), done, carry, out)
            if not np.isfinite(out).all():
                k = done + int(np.argmin(np.isfinite(out).all(axis=1)))
                raise AccuracyError(f"{self.name} diverges at update {k}: the increments are too large for it")
        return replace(state, kept=block[count * N :].copy(), updates=done + count, carry=carry), out


def _require_instance(name: str, value: object, cls: type) -> None:
    if not isinstance(value, cls):
        raise InputError(f"{name} must be of type {cls.__name__}, got {type(value).__name__}")


def _joined(dtheta_b: ArrayLike, dvel_b: ArrayLike) -> Array:
    dtheta = require_array("dtheta_b", dtheta_b, (None, 3))
    return np.concatenate([dtheta, require_array("dvel_b", dvel_b, (len(dtheta), 3))], axis=1)


def _first_row(initial: NavigationInitial, earth: Earth) -> Array:
    q_en = earth.q_en(initial.latitude, initial.longitude)
    q_eb = quat_multiply(q_en, initial.q_nb)
    r_e = earth.position(initial.latitude, initial.longitude, initial.height)
    return np.concatenate([q_eb / np.linalg.norm(q_eb), quat_rotate(q_en, initial.v_n), r_e])


def _rows(array: Array) -> NDArray[np.void]:
    """Return the rows as single items, which NumPy copies several times faster than short rows of numbers."""
    return array.view(f"V{8 * array.shape[1]}")[:, 0]


def _scatter(rows: Array, columns: list[Array], begin: int) -> None:
    first = 0
    for column in columns:
        last = first + column.shape[1]
        _rows(column[begin : begin + len(rows)])[:] = _rows(rows[:, first:last])
        first = last
