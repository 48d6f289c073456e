"""Gyro-free solvers: readings of an accelerometer array to angular rate, attitude, velocity, position.

An accelerometer at r that senses along d reads ``A = d . (f + alpha x r + omega x (omega x r))``, f the specific
force at the body origin. A solver of this kind finds omega, alpha and f of every reading; the integration to
attitude, velocity and position in the inertial frame is common to all of them.
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
    require_choice,
    require_integer,
    require_scalar,
)
from bench.references import Source
from bench.signals import Accelerometers, GyroFreeSolution, Initial, Readings

INTEGRATIONS = {"fourth-order": 4, "first-order": 1}  # option: order in dt
START = 4  # readings that fourth-order integration needs before it can begin
FIELDS = {"omega_ib_b": 3, "alpha_ib_b": 3, "f_b": 3, "q_ib": 4, "velocity": 3, "position": 3}


@dataclass(frozen=True, eq=False)
class GyroFreeState:
    """Where a gyro-free solver stands between two chunks; made by ``start`` and ``advance``.

    Attributes
    ----------
    constants : tuple
        What the solver derived from the array's geometry.
    channels : int
    dt : float, s
    gravity : ndarray, shape (3,), m/s^2
    pending : ndarray, shape (k, channels), m/s^2
        Readings that wait for the fourth one; none after it.
    started : bool
        Whether the first rows have been given out.
    carry : ndarray, shape (14, 3)
        Integrals and last samples, see ``_strapdown``; never written in place.
    attitude : ndarray, shape (4,)
        q_ib at the last row.
    """

    constants: tuple[Any, ...]
    channels: int
    dt: float
    gravity: Array
    pending: Array
    started: bool
    carry: Array
    attitude: Array


@dataclass(frozen=True)
class GyroFreeSolver(ABC):
    """Base of the gyro-free solvers: the contract, the loop over chunks and all checks.

    A solver declares ``name`` and ``source`` and defines `_constants` and `_rates`; it overrides nothing else.

    Parameters
    ----------
    integration : {"fourth-order", "first-order"}
        Fourth order: four-point running integrals, attitude from omega and alpha. First order: Euler steps
        throughout, as in simple simulations; at 2 rad/s on each axis, 100 Hz and 60 s it turns 1.2 degrees away.

    Raises
    ------
    UnknownNameError
        If there is no such integration.
    """

    name: ClassVar[str]
    source: ClassVar[Source]
    order: ClassVar[int] = INTEGRATIONS["fourth-order"]

    integration: str = "fourth-order"

    def __post_init__(self) -> None:
        require_choice("integration", self.integration, INTEGRATIONS)

    @abstractmethod
    def _constants(self, accelerometers: Accelerometers) -> tuple[Any, ...]:
        """Return what `_rates` needs of the geometry, or refuse the array."""

    @abstractmethod
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
        """Fill omega, alpha, f (n, 3) of the readings (n, m); return how many squared rates were negative.

        carry (4, 3) is that of `_strapdown.accumulate` for the integral of alpha; its first row starts as omega(0).
        """

    @property
    def _fourth(self) -> bool:
        return self.integration == "fourth-order"

    @final
    def start(self, accelerometers: Accelerometers, dt: float, initial: Initial) -> GyroFreeState:
        """Return the state before the first reading.

        Parameters
        ----------
        accelerometers : Accelerometers
            Geometry of the array.
        dt : float, s
            Interval between readings.
        initial : Initial
            State at the first reading.

        Raises
        ------
        InputError
            If dt is not positive, an argument is of another kind, or the solver is not for this array.
        ObservabilityError
            If the array does not determine the motion.
        """
        dt = require_scalar("dt", dt, positive=True)
        for label, value, kind in (("accelerometers", accelerometers, Accelerometers), ("initial", initial, Initial)):
            if not isinstance(value, kind):
                raise InputError(f"{label} must be a bench.{kind.__name__}, got {type(value).__name__}")
        carry = np.zeros((14, 3))
        carry[0], carry[4], carry[8] = initial.omega_ib_b, initial.velocity, initial.position
        return GyroFreeState(
            constants=self._constants(accelerometers),
            channels=len(accelerometers),
            dt=dt,
            gravity=initial.gravity.copy(),
            pending=np.empty((0, len(accelerometers))),
            started=False,
            carry=carry,
            attitude=initial.q_ib.copy(),
        )

    @final
    def advance(self, state: GyroFreeState, readings: ArrayLike) -> tuple[GyroFreeState, GyroFreeSolution]:
        """Return the next state and the rows that the chunk completes.

        Every reading completes one row, except that fourth-order integration gives out the first four rows
        together, with the fourth reading.

        Parameters
        ----------
        state : GyroFreeState
        readings : array_like, shape (n, m), m/s^2

        Raises
        ------
        InputError
            If the readings have another shape or are not finite.
        AccuracyError
            If the solution overflows.
        """
        block = _checked(readings, state.channels)
        if not state.started:
            block = np.concatenate([state.pending, block])
            if self._fourth and len(block) < START:
                return replace(state, pending=block), _empty(0)
        solution = _empty(len(block))
        return self._fill(state, block, solution)

    @final
    def finish(self, state: GyroFreeState) -> GyroFreeSolution:
        """Return the rows that are still held back: none, once the stream has had four readings.

        Raises
        ------
        InputError
            If the stream ended before the fourth reading.
        """
        if len(state.pending):
            raise _too_few(len(state.pending))
        return _empty(0)

    @final
    def solve(
        self,
        accelerometers: Accelerometers,
        readings: Readings | ArrayLike,
        dt: float,
        initial: Initial,
        chunk: int = 4096,
    ) -> GyroFreeSolution:
        """Return the solution at every reading.

        Parameters
        ----------
        accelerometers : Accelerometers
            Geometry of the array.
        readings : Readings or array_like, shape (n, m), m/s^2
            n >= 4 for fourth-order integration. Row k is at t0 + k dt.
        dt : float, s
        initial : Initial
            State at the first reading.
        chunk : int
            Readings per step of the loop; does not change the result.

        Returns
        -------
        GyroFreeSolution
            n rows; attitude, velocity and position of row 0 are the initial ones.

        Raises
        ------
        InputError
            If an argument has another shape, is not finite, or dt and readings.t disagree.
        ObservabilityError
            If the array does not determine the motion.
        AccuracyError
            If the solution overflows.
        """
        chunk = require_integer("chunk", chunk, minimum=1)
        state = self.start(accelerometers, dt, initial)
        if isinstance(readings, Readings):
            _check_times(readings.t, state.dt)
            readings = readings.accelerometers
        block = _checked(readings, state.channels)
        n = len(block)
        if self._fourth and n < START:
            raise _too_few(n)
        solution = _empty(n)
        negative, begin = 0, 0
        while begin < n:
            end = min(n, begin + (chunk if state.started else max(chunk, START)))
            rows = GyroFreeSolution(*(getattr(solution, name)[begin:end] for name in FIELDS))
            state, rows = self._fill(state, block[begin:end], rows, begin)
            negative, begin = negative + rows.negative_squares, end
        return replace(solution, negative_squares=negative)

    def _fill(
        self, state: GyroFreeState, block: Array, rows: GyroFreeSolution, offset: int = 0
    ) -> tuple[GyroFreeState, GyroFreeSolution]:
        """Write the solution of a checked block into `rows`."""
        from bench.solvers.gyro_free._strapdown import strapdown

        carry, attitude = state.carry.copy(), state.attitude.copy()
        omega, alpha, f = rows.omega_ib_b, rows.alpha_ib_b, rows.f_b
        negative = self._rates(state.constants, block, state.dt, state.started, carry[:4], omega, alpha, f)
        strapdown(
            *(omega, alpha, f, state.gravity, state.dt, self._fourth, state.started, carry, attitude),
            *(rows.q_ib, rows.velocity, rows.position),
        )
        # Whatever is not finite in any row is in the integrals by now.
        if not (np.isfinite(carry).all() and np.isfinite(attitude).all()):
            raise AccuracyError(f"{self.name} overflows{_where(rows, offset)}; the readings or dt are too large")
        next_state = replace(state, pending=state.pending[:0], started=True, carry=carry, attitude=attitude)
        return next_state, replace(rows, negative_squares=negative)


def _empty(n: int) -> GyroFreeSolution:
    """Return an unset solution in one piece of memory: large pieces are cheaper to get from the system."""
    buffer, begin = np.empty(n * sum(FIELDS.values())), 0
    fields: dict[str, Any] = {}
    for name, width in FIELDS.items():
        fields[name] = buffer[begin : begin + n * width].reshape(n, width)
        begin += n * width
    return GyroFreeSolution(**fields)


def _where(rows: GyroFreeSolution, offset: int) -> str:
    """Say which row is the first that is not finite."""
    finite = np.all([np.isfinite(getattr(rows, name)).all(axis=1) for name in FIELDS], axis=0)
    return "" if finite.all() else f" in row {offset + int(np.argmin(finite))}"


def _too_few(n: int) -> InputError:
    return InputError(f"readings must be at least {START} for fourth-order integration, got {n}")


def _checked(readings: ArrayLike, channels: int) -> Array:
    """Return finite, contiguous, writable readings (numba takes a read-only array for another type)."""
    block = require_array("readings", readings, (None, channels))
    return block if block.flags.writeable else block.copy()


def _check_times(t: Array, dt: float) -> None:
    """Refuse times that are not dt apart, within a millionth of dt and the rounding of t."""
    step = np.diff(t)
    wrong = np.abs(step - dt) > 1e-6 * dt + 4 * np.finfo(float).eps * np.abs(t[1:])
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InputError(
            f"dt = {dt:.9g} s and readings.t must agree, got readings.t[{k + 1}] - readings.t[{k}] = {step[k]:.9g} s"
        )
