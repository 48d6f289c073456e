"""The driven three-axis turntable: MuJoCo's dynamics turn a commanded profile into the motion that the axes make.

Servos, bearings and inertias decide what the table does with its commands. What it does is the truth: the recorded
axis angles become a motion (`RecordedTurntable`) that a rig senses exactly. The dynamics are those of a table in a
laboratory at rest, without the torques of the Earth's rotation, a millionth of the bearings' friction; the recorded
motion then turns with the Earth.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from mujoco import rollout

from bench.earth import WGS84, Earth
from bench.errors import (
    AccuracyError,
    Array,
    InputError,
    require_array,
    require_instance,
    require_integer,
    require_scalar,
)
from bench.mjcf import compile_model
from bench.motion._options import ORIGIN, Vector, as_vector, set_options
from bench.motion.recorded_turntable import RecordedTurntable
from bench.units import DEG

AXES = ("heading", "pitch", "roll")  # joints, from the outer one to the inner one
PIECE = 50_000  # steps in memory at a time
LONGEST_STEP = 2e-3  # s, for rates of up to 1 deg/s
TONES = 16  # of the fluctuation of each rate
SLOWEST, FASTEST = 0.02, 0.5  # Hz, of these tones: what a hand on a dial does


@dataclass(frozen=True)
class Profile:
    """What the axes are told to do: rest, then a constant rate to and fro between limits, with small fluctuations.

    Parameters
    ----------
    rate : tuple of 3 floats, rad/s
        Of psi, P, R once moving; the first move is towards + for a positive rate, 0 keeps an axis at rest.
    limit : tuple of 3 floats, rad
        The angles at which an axis turns back, +- limit, at once: the commanded rate jumps.
    start : tuple of 3 floats, rad
        Angles at rest, within the limits of the axes that move.
    rest : float, s
        Time at rest before moving.
    fluctuation : tuple of 3 floats, rad/s
        RMS of the fluctuation of each rate while moving, as from manual operation: a sum of tones between 0.02 and
        0.5 Hz.
    seed : int
        Of the tones' frequencies and phases.

    Raises
    ------
    InputError
        If an option is not finite or out of range.
    """

    rate: Vector = (0.0, 0.015 * DEG, 0.0)
    limit: Vector = (90 * DEG, 90 * DEG, 90 * DEG)
    start: Vector = ORIGIN
    rest: float = 60.0
    fluctuation: Vector = (0.0, 0.0005 * DEG, 0.0)
    seed: int = 0

    def __post_init__(self) -> None:
        vectors = ("rate", "limit", "start", "fluctuation")
        set_options(self, **{name: as_vector(name, getattr(self, name)) for name in vectors})
        require_scalar("rest", self.rest, minimum=0.0)
        require_integer("seed", self.seed, minimum=0)
        for k, axis in enumerate(AXES):
            require_scalar(f"limit of {axis}", self.limit[k], positive=True)
            require_scalar(f"fluctuation of {axis}", self.fluctuation[k], minimum=0.0)
            if self.rate[k] and abs(self.start[k]) > self.limit[k]:
                raise InputError(f"start of {axis} must be within +-{self.limit[k]!r} rad, got {self.start[k]!r}")

    def angles(self, t: Array) -> Array:
        """Return the commanded psi, P, R at times t (n,), s; shape (n, 3), rad."""
        moving = np.maximum(require_array("t", t, (None,)) - self.rest, 0.0)
        out = np.empty((len(moving), 3))
        for k, (rate, limit, start) in enumerate(zip(self.rate, self.limit, self.start, strict=True)):
            way = np.sign(rate) * start + abs(rate) * moving + limit  # unrolled: from -limit up, and back, ...
            out[:, k] = np.sign(rate) * (limit - np.abs(2 * limit - way % (4 * limit))) if rate else start
            out[:, k] += self._fluctuation(k, moving)
        return out

    @property
    def longest_step(self) -> float:
        """Step of the dynamics, s, whose half changes the angles by less than a microradian."""
        fastest = max(abs(rate) for rate in self.rate)
        return LONGEST_STEP * min(1.0, math.sqrt(1 * DEG / fastest) if fastest else 1.0)

    def _fluctuation(self, k: int, moving: Array) -> Array | float:
        """Return the integral of the rate's fluctuation over the time since the axis began to move, rad."""
        if not self.fluctuation[k]:
            return 0.0
        rng = np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(k,)))
        w = 2 * np.pi * SLOWEST * (FASTEST / SLOWEST) ** rng.random(TONES)
        phase = rng.uniform(0, 2 * np.pi, TONES)
        amplitude = self.fluctuation[k] * np.sqrt(2 / TONES) / w
        total = np.zeros(len(moving))
        for a, f, p in zip(amplitude, w, phase, strict=True):
            total += a * (np.sin(f * moving + p) - np.sin(p))
        return total


@dataclass(frozen=True, eq=False)
class TableRecording:
    """What a driven table did.

    Attributes
    ----------
    t : ndarray, shape (n,), s
        Equally spaced, from 0.
    angles : ndarray, shape (n, 3), rad
        psi, P, R of the axes: the truth.
    rates : ndarray, shape (n, 3), rad/s
        Their derivatives, as the dynamics have them.
    command : ndarray, shape (n, 3), rad
        What the servos were told.
    """

    t: Array
    angles: Array
    rates: Array
    command: Array

    def __len__(self) -> int:
        return len(self.t)

    def motion(
        self, latitude: float = 32.06 * DEG, longitude: float = 118.8 * DEG, height: float = 0.0, earth: Earth = WGS84
    ) -> RecordedTurntable:
        """Return the recorded axis angles as the motion of a table that stands at a geodetic place, rad and m."""
        return RecordedTurntable(self.t, self.angles, latitude, longitude, height, earth)

    def encoder(self, resolution: float = 0.0001 * DEG) -> Array:
        """Return the angles as the encoders give them, to the nearest multiple of the resolution, shape (n, 3), rad."""
        resolution = require_scalar("resolution", resolution, positive=True)
        return resolution * np.round(self.angles / resolution)


class Turntable:
    """A three-axis table of an MJCF model, driven by its servos.

    Parameters
    ----------
    model : str, Path or mujoco.MjSpec
        As for `Rig.load`: three hinge joints in a chain, named heading, pitch and roll, each with an actuator that is
        told its angle.

    Raises
    ------
    InputError
        If the model does not compile or has other joints or actuators.
    """

    def __init__(self, model: "str | Path | mujoco.MjSpec" = "turntable"):
        self.model = compile_model(model)
        self._dynamics = compile_model(model)
        names = tuple(self.model.joint(k).name for k in range(self.model.njnt))
        if names != AXES or (self.model.jnt_type != mujoco.mjtJoint.mjJNT_HINGE).any():
            raise InputError(f"model must have three hinge joints {', '.join(AXES)}, got {', '.join(names) or 'none'}")
        if self.model.nu != 3 or tuple(self.model.actuator_trnid[:, 0]) != (0, 1, 2):
            raise InputError(f"model must have one actuator for each joint, in order, got {self.model.nu}")
        option = self._dynamics.opt
        # What cannot go on shall be seen, not reset; sensors are read elsewhere; islands only cost time.
        flags = mujoco.mjtDisableBit
        option.disableflags |= flags.mjDSBL_AUTORESET | flags.mjDSBL_SENSOR | flags.mjDSBL_ISLAND

    def drive(
        self, profile: Profile, duration: float, *, rate: float = 100.0, step: float | None = None, settle: float = 5.0
    ) -> TableRecording:
        """Return the motion that the axes make of a commanded profile.

        Fourth-order Runge-Kutta steps; the command of a step is that of its middle, and the whole is of second order in
        the step, because of that and of the reversals, where the rate of the command and the friction jump.

        Parameters
        ----------
        profile : Profile
        duration : float, s
        rate : float, Hz
            Of the records; the record interval is a whole number of steps, the duration of record intervals.
        step : float, s, optional
            Of the dynamics. By default 2 ms for rates of up to 1 deg/s and shorter with the root of the rate beyond:
            half of it changes the angles by less than 1 microradian.
        settle : float, s
            Time at the commanded start before t = 0, for the table to sink into its servos.

        Raises
        ------
        InputError
            If an argument breaks a rule.
        AccuracyError
            If the dynamics are not stable at this step.
        """
        require_instance("profile", profile, Profile)
        rate = require_scalar("rate", rate, positive=True)
        if step is None:
            every = math.ceil(1.0 / (rate * profile.longest_step) - 1e-9)
            step = 1.0 / (rate * every)
        else:
            every = _whole("1 / rate", 1.0 / rate, "steps", require_scalar("step", step, positive=True))
        records = _whole(
            "duration", require_scalar("duration", duration, positive=True), "record intervals", every * step
        )
        before = round(require_scalar("settle", settle, minimum=0.0) / step)
        self._dynamics.opt.timestep = step
        out = np.zeros((records + 1, 6))
        out[0, :3] = profile.angles(np.zeros(1))[0]  # what is recorded without settling
        for first, states in self._run(profile, -before, records * every, step):
            done = np.arange(first + 1, first + 1 + len(states))  # steps behind each state
            kept = (done >= 0) & (done % every == 0)
            out[done[kept] // every] = states[kept]
        t = np.arange(records + 1) / rate
        return TableRecording(t, out[:, :3].copy(), out[:, 3:].copy(), profile.angles(t))

    def _run(self, profile: Profile, first: int, last: int, step: float) -> Iterator[tuple[int, Array]]:
        """Yield the number of the first step and angles and rates behind each (k, 6), piece by piece."""
        data = mujoco.MjData(self._dynamics)
        data.qpos[:] = profile.angles(np.array([first * step]))[0]
        kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
        state = np.empty((1, mujoco.mj_stateSize(self._dynamics, kind)))
        mujoco.mj_getState(self._dynamics, data, state[0], kind)
        buffer = np.empty((1, PIECE, state.shape[1]))
        with rollout.Rollout(nthread=0) as run:
            for begin in range(first, last, PIECE):
                steps = np.arange(begin, min(begin + PIECE, last), dtype=np.float64)
                command = profile.angles((steps + 0.5) * step)[np.newaxis]
                states = buffer[:, : len(steps)]
                warm = data.qacc_warmstart[np.newaxis].copy()  # as if there were no pieces
                run.rollout(self._dynamics, data, state, command, initial_warmstart=warm, state=states)
                state = states[:, -1].copy()
                found = states[0, :, 1:7]
                if not np.isfinite(found).all() or np.abs(found[:, :3]).max() > 1e3:
                    raise AccuracyError(f"the table's dynamics are not stable at a step of {step:g} s")
                yield begin, found


def _whole(name: str, value: float, of: str, unit: float) -> int:
    """Return value / unit as an integer.

    Raises
    ------
    InputError
        If it is not one within rounding, or is zero.
    """
    n = round(value / unit)
    if n < 1 or abs(value / unit - n) > 1e-9 * n:
        raise InputError(f"{name} must be a whole number of {of} of {unit!r} s, got {value!r} s")
    return n
