"""Sensor error models: what the sensors feel becomes what they report.

A signal comes as chunks (n, k) of one of two kinds: "samples" (instantaneous, rad/s or
m/s^2) or "increments" (integrals over dt, rad or m/s). Options are always stated per
second (rad/s, m/s^2), so that one model means the same sensor for either kind and at
any rate; each file says how. One file per family, found by discovery::

    errors = SensorErrors((TurnOnBias(std=1 * DEG_PER_H), WhiteNoise(density=0.1 * DEG_PER_SQRT_H)))
    reported = errors.apply(readings.gyro, dt, "samples", seed=1, trial=7)
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, InputError, require_array, require_choice, require_integer, require_scalar
from bench.registry import discover

KINDS = ("samples", "increments")


@dataclass(frozen=True)
class Stream:
    """What a model must know of the signal before the first chunk.

    Attributes
    ----------
    channels : int
    dt : float, s
        Time between samples, or length of one increment's interval.
    kind : {"samples", "increments"}

    Raises
    ------
    InputError
        If `channels` is not positive, `dt` is not positive and finite, or `kind` is unknown.
    """

    channels: int
    dt: float
    kind: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "channels", require_integer("channels", self.channels, minimum=1))
        object.__setattr__(self, "dt", require_scalar("dt", self.dt, positive=True))
        require_choice("kind", self.kind, KINDS)

    @property
    def span(self) -> float:
        """Return what turns a value per second into one of this signal: dt for increments, 1 for samples."""
        return self.dt if self.kind == "increments" else 1.0

    def spread(self, name: str, value: float | tuple[float, ...]) -> Array:
        """Return an option as one value per channel, shape (channels,); InputError if their number differs."""
        if isinstance(value, tuple) and len(value) != self.channels:
            raise InputError(f"{name} must have one value per channel ({self.channels}), got {len(value)}")
        return np.array(np.broadcast_to(np.asarray(value, dtype=float), (self.channels,)))


class ErrorModel(ABC):
    """One family of sensor errors: a frozen dataclass of options.

    State is passed, never stored: neither the model, nor a state, nor a chunk is ever modified, so that the
    same state and chunk always give the same result, and any chunking of a signal gives the same bits.
    """

    name: ClassVar[str]

    @abstractmethod
    def start(self, rng: np.random.Generator, stream: Stream) -> Any:
        """Return the state before the first reading; the generator belongs to the state from now on.

        Raises
        ------
        InputError
            If an option does not fit the number of channels.
        """

    @abstractmethod
    def advance(self, state: Any, chunk: Array, specific_force: Array | None = None) -> tuple[Any, Array]:
        """Return the next state and the chunk with this error, shape (n, channels).

        Parameters
        ----------
        state
            From `start` or the previous `advance`.
        chunk : ndarray, shape (n, channels), C-contiguous, finite
        specific_force : ndarray, shape (n, 3), m/s^2 (samples) or m/s (increments), optional
            At the sensor, of the same kind as the chunk; only g-sensitivity needs it.
        """


@dataclass(frozen=True)
class SensorErrors:
    """Error models in the order in which they act; none at all is a perfect sensor.

    Model number i draws from ``SeedSequence(seed, spawn_key=(trial, sensor, i))``: adding a model at the end
    changes no other's noise, and a trial has the same bits alone or in a campaign.

    Attributes
    ----------
    models : tuple of ErrorModel

    Raises
    ------
    InputError
        If an item is not an error model.
    """

    models: tuple[ErrorModel, ...] = ()

    def __post_init__(self) -> None:
        models = tuple(self.models) if isinstance(self.models, Iterable) else (self.models,)
        for model in models:
            if not isinstance(model, ErrorModel):
                raise InputError(f"models must hold error models, got {model!r}")
        object.__setattr__(self, "models", models)

    def start(self, channels: int, dt: float, kind: str, *, seed: int, trial: int = 0, sensor: int = 0) -> Any:
        """Return the state before the first reading of one sensor in one trial.

        Parameters
        ----------
        channels : int
        dt : float, s
        kind : {"samples", "increments"}
        seed, trial, sensor : int, >= 0

        Raises
        ------
        InputError
            If an argument breaks its rule, or a model's options do not fit the number of channels.
        """
        stream = Stream(channels, dt, kind)
        key = (require_integer("trial", trial, minimum=0), require_integer("sensor", sensor, minimum=0))
        seed = require_integer("seed", seed, minimum=0)
        states = []
        for index, model in enumerate(self.models):
            sequence = np.random.SeedSequence(seed, spawn_key=(*key, index))
            states.append(model.start(np.random.default_rng(sequence), stream))
        return stream, tuple(states)

    def advance(self, state: Any, chunk: ArrayLike, specific_force: ArrayLike | None = None) -> tuple[Any, Array]:
        """Return the next state and what the sensor reports, shape (n, channels).

        Raises
        ------
        InputError
            If the chunk or the specific force has a wrong shape or is not finite, if a model needs the
            specific force and it is missing, or if the result is not finite.
        """
        stream, states = state
        signal = require_array("signal", chunk, (None, stream.channels))
        if specific_force is not None:
            specific_force = require_array("specific_force", specific_force, (len(signal), 3))
        reported, after = signal, []
        for model, before in zip(self.models, states, strict=True):
            following, reported = model.advance(before, reported, specific_force)
            after.append(following)
        if reported is signal:
            return state, signal.copy()
        return (stream, tuple(after)), require_array("reported signal", reported, (None, stream.channels))

    def apply(
        self,
        signal: ArrayLike,
        dt: float,
        kind: str,
        *,
        seed: int,
        trial: int = 0,
        sensor: int = 0,
        specific_force: ArrayLike | None = None,
    ) -> Array:
        """Return what the sensor reports of a whole signal, shape (n, k), as `start` and `advance`.

        Raises
        ------
        InputError
            As `start` and `advance`.
        """
        signal = require_array("signal", signal, (None, None))
        state = self.start(signal.shape[1], dt, kind, seed=seed, trial=trial, sensor=sensor)
        return self.advance(state, signal, specific_force)[1]


def error_models() -> dict[str, type[ErrorModel]]:
    """Return the error model classes, by name."""
    return discover("bench.imu", ErrorModel)
