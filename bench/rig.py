"""The rig: MuJoCo moves the instrumented body of an MJCF model and says what its sensors feel.

Time is the batch axis: sample k of a prescribed motion is row k of a
`mujoco.batch.Batch`. Each row is given the attitude, the angular rate and the
generalised force that yields the prescribed acceleration; `forward` computes the
sensors. Nothing is stepped, so nothing accumulates. The only file that imports
mujoco for sensing.
"""

import queue
import threading
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import mujoco
import numpy as np
from mujoco.batch import Batch

from bench.campaign import cpu_count
from bench.errors import (
    Array,
    Indices,
    InputError,
    require_integer,
    require_scalar,
    require_times,
)
from bench.mjcf import compile_model, instrument, sensing_model
from bench.motion import Motion
from bench.quadrature import CHECK_EVERY, Consume, Quadrature, Times
from bench.signals import Accelerometers, Increments, Kinematics, Readings

ROWS = 2048  # rows of one Batch: fits the cache, and any length is served by a few Batches
HUGE = 1e10  # mjMAXVAL: beyond it MuJoCo silently resets the row and the sensors read zero


class _Workspace:
    """One Batch with one thread, and its bound arrays."""

    def __init__(self, model: mujoco.MjModel, columns: Indices, gyro: bool):
        self.batch = Batch(model, nsim=ROWS, nthread=1)
        self.qpos, self.qvel = self.batch.bind("qpos"), self.batch.bind("qvel")
        self.force, self.sensors = self.batch.bind("qfrc_applied"), self.batch.bind("sensordata")
        self.gravity = self.batch.expand("opt.gravity")
        self.columns, self.gyro = columns, gyro
        self.rows = np.arange(ROWS)
        # Specific force does not depend on where the body is or how fast it translates; at the origin the
        # lever arms keep all their digits, whatever the distance from the centre of the Earth.
        self.qpos[:, :3] = 0.0
        self.qvel[:, :3] = 0.0

    def read(self, truth: Kinematics, accelerometers: Array, gyro: Array | None) -> None:
        """Fill (k, m) accelerometer and (k, 3) gyro readings of k <= ROWS rows of kinematics."""
        k = len(truth)
        force = truth.acceleration - truth.gravity
        for name, value in (
            ("omega_ib_b", truth.omega_ib_b),
            ("alpha_ib_b", truth.alpha_ib_b),
            ("acceleration - gravity", force),
        ):
            if max(value.max(), -value.min()) >= HUGE:
                raise InputError(f"{name} must stay below {HUGE:g} (SI), got {np.abs(value).max():g}")
        self.qpos[:k, 3:] = truth.q_ib
        self.qvel[:k, 3:] = truth.omega_ib_b
        self.force[:k, :3] = force  # unit mass and unit isotropic inertia: force is acceleration
        self.force[:k, 3:] = truth.alpha_ib_b
        self.gravity[:k] = truth.gravity
        self.batch.forward(self.rows[:k])
        np.take(self.sensors[:k], self.columns, axis=1, out=accelerometers, mode="clip")
        if gyro is not None:
            gyro[:] = self.sensors[:k, -3:]


class Rig:
    """An instrumented rigid body from an MJCF file, sensed by MuJoCo along a prescribed motion.

    An ``<accelerometer>`` with ``user="1"`` is one channel along its site's z axis; without it, a triad of three
    channels along the site's x, y, z. A ``<gyro>`` gives the angular rate, resolved in body axes. Channels stand
    in the order of the sensors. The body's mass, joints, geoms and contacts do not matter: its motion is
    prescribed. Readings are ideal; errors are the business of ``bench.imu``.

    Make one with `Rig.load`.
    """

    def __init__(self, model: mujoco.MjModel, *, threads: int | None = None):
        self.model = model  # the whole model as drawn, for recordings
        self._instrument = instrument(model)
        self._threads = cpu_count() if threads is None else require_integer("threads", threads, minimum=1)
        self._prepare()

    def _prepare(self) -> None:
        self._sensing = sensing_model(self._instrument)
        self._columns = self._instrument.columns
        self._workspaces: queue.SimpleQueue[_Workspace] = queue.SimpleQueue()
        self._motion_lock = threading.Lock()

    @classmethod
    def load(cls, model: "str | Path | mujoco.MjSpec", *, threads: int | None = None) -> "Rig":
        """Return the rig of a model.

        Parameters
        ----------
        model : str, Path or mujoco.MjSpec
            A name in ``models/``, a path to an MJCF file, or an MjSpec.
        threads : int, optional
            Threads that evaluate; the default is the number of CPUs this process may use. The readings do not
            depend on it.

        Raises
        ------
        UnknownNameError
            If there is neither such a model nor such a file.
        InputError
            If the MJCF does not parse, has no accelerometer and no gyro, or its sensors sit on several bodies
            or on the world.
        """
        return cls(compile_model(model), threads=threads)

    @property
    def accelerometers(self) -> Accelerometers:
        """Geometry of the accelerometer channels, in the body frame."""
        return self._instrument.accelerometers

    @property
    def has_gyro(self) -> bool:
        """Whether the rig carries a gyro."""
        return self._instrument.has_gyro

    def remount(self, accelerometers: Accelerometers) -> "Rig":
        """Return the rig with its accelerometer channels moved and turned, each as one single-axis sensor.

        This is how mounting errors of an array are simulated: MuJoCo senses with the true geometry, the solver
        is told the nominal one.

        Raises
        ------
        InputError
            If the number of channels differs.
        """
        rig = object.__new__(Rig)
        rig.model, rig._threads = self.model, self._threads
        rig._instrument = self._instrument.remounted(accelerometers)
        rig._prepare()
        return rig

    def __getstate__(self) -> dict[str, object]:
        # A Batch does not pickle; the receiving process makes its own.
        return {"model": self.model, "_instrument": self._instrument, "_threads": self._threads}

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)
        self._prepare()

    def sample(self, motion: Motion, t: Array) -> Readings:
        """Return the instantaneous readings at times t, shape (n,), s, strictly increasing.

        Raises
        ------
        InputError
            If t is empty, not finite or unsorted, or the motion's kinematics are not usable.
        """
        _require_motion(motion)
        t = require_times("t", t).copy()
        accelerometers = np.empty((len(t), len(self.accelerometers)))
        gyro = np.empty((len(t), 3)) if self.has_gyro else None

        def keep(start: int, stop: int, readings: Array) -> None:
            accelerometers[start:stop] = readings[:, : accelerometers.shape[1]]
            if gyro is not None:
                gyro[start:stop] = readings[:, accelerometers.shape[1] :]

        # A copy for the motion, which may do with it as it likes.
        self._evaluate(motion, len(t), ROWS, lambda start, stop: t[start:stop].copy(), keep)
        return Readings(t, accelerometers, gyro)

    def increments(
        self,
        motion: Motion,
        rate: float,
        duration: float,
        t0: float = 0.0,
        *,
        tolerance: float = 1e-12,
        check_every: int = CHECK_EVERY,
    ) -> Increments:
        """Return the exact integrals of the readings over every sampling interval.

        Gauss-Legendre quadrature of MuJoCo's readings inside each interval. Two node counts are compared on every
        `check_every`-th interval and the last one, and the count is raised until they agree; so it is in any other
        interval where the readings are much rougher than in those. What happens between the nodes of an
        unchecked interval and touches none of them stays unseen: `check_every=1` for motions with short events.

        Parameters
        ----------
        motion : Motion
        rate : float, Hz
            Intervals per second.
        duration : float, s
            A whole number of intervals.
        t0 : float, s
            Start of the first interval.
        tolerance : float
            Largest residual, rad and m/s, relative to increments that exceed 1; the rounding of t is allowed for.
        check_every : int
            1 checks every interval, for motions with corners.

        Raises
        ------
        InputError
            If rate or duration is not positive, or the duration is not a whole number of intervals.
        AccuracyError
            If 33 nodes do not reach the tolerance: the motion is not smooth on the scale of one interval.
        """
        (whole,) = self.stream(motion, rate, duration, t0, chunk=None, tolerance=tolerance, check_every=check_every)
        return whole

    def stream(
        self,
        motion: Motion,
        rate: float,
        duration: float,
        t0: float = 0.0,
        *,
        chunk: int | None = 16384,
        tolerance: float = 1e-12,
        check_every: int = CHECK_EVERY,
    ) -> Iterator[Increments]:
        """Return an iterator over the increments in chunks of `chunk` intervals (None: all in one).

        The same bits as `increments`, in memory that does not depend on the duration. The residual is that of
        the whole run, measured first. Parameters and errors as in `increments`; input is checked at once.
        """
        _require_motion(motion)
        rate = require_scalar("rate", rate, positive=True)
        n = whole_intervals(rate, require_scalar("duration", duration, positive=True))
        t0 = require_scalar("t0", t0)
        tolerance = require_scalar("tolerance", tolerance, positive=True)
        chunk = n if chunk is None else require_integer("chunk", chunk, minimum=1)
        every = require_integer("check_every", check_every, minimum=1)
        return self._stream(motion, rate, n, t0, chunk, tolerance, every)

    def _stream(
        self, motion: Motion, rate: float, n: int, t0: float, chunk: int, tolerance: float, every: int
    ) -> Iterator[Increments]:
        m = len(self.accelerometers)
        rule = Quadrature(partial(self._evaluate, motion), rate, t0, m + 3 * self.has_gyro, ROWS)
        for index, sums, residual, nodes in rule.chunks(n, chunk, tolerance, every):
            dvel = np.ascontiguousarray(sums[:, :m])
            dtheta_b = np.ascontiguousarray(sums[:, m:]) if self.has_gyro else None
            yield Increments(1.0 / rate, t0 + (index + 1) / rate, dvel, dtheta_b, residual, nodes)

    def _evaluate(self, motion: Motion, n: int, size: int, times: Times, consume: Consume) -> None:
        """Read blocks of items start..stop of 0..n at times(start, stop); give the (k, m + 3) readings to consume."""
        m = len(self.accelerometers)

        def block(workspace: _Workspace, start: int, stop: int) -> None:
            t = times(start, stop)
            readings = np.empty((len(t), m + 3 * self.has_gyro))
            truth = self._kinematics(motion, t)
            workspace.read(truth, readings[:, :m], readings[:, m:] if self.has_gyro else None)
            consume(start, stop, readings)

        self._in_blocks(block, n, size)

    def _kinematics(self, motion: Motion, t: Array) -> Kinematics:
        # The lock spares a user's motion from having to be thread-safe; MuJoCo runs beside it.
        with self._motion_lock:
            truth = motion.kinematics(t)
        if not isinstance(truth, Kinematics):
            raise InputError(f"motion.kinematics must return bench.Kinematics, got {type(truth).__name__}")
        return truth.repeated(len(t))

    def _in_blocks(self, block: Callable[[_Workspace, int, int], None], n: int, size: int) -> None:
        """Run block(workspace, start, stop) over 0..n; threads pull blocks, each with its own Batch."""
        starts = iter(range(0, n, size))
        lock = threading.Lock()

        def abandon() -> None:
            with lock:
                deque(starts, maxlen=0)

        def pull() -> None:
            try:
                workspace = self._workspaces.get_nowait()
            except queue.Empty:
                workspace = _Workspace(self._sensing, self._columns, self.has_gyro)
            try:
                while True:
                    with lock:
                        start = next(starts, None)
                    if start is None:
                        return
                    block(workspace, start, min(start + size, n))
            except BaseException:
                abandon()
                raise
            finally:
                self._workspaces.put(workspace)

        workers = min(self._threads, -(-n // size))
        if workers == 1:
            pull()
            return
        with ThreadPoolExecutor(workers, thread_name_prefix="rig") as pool:
            futures = [pool.submit(pull) for _ in range(workers)]
            try:
                for future in futures:
                    future.result()
            except BaseException:  # Ctrl-C too: do not finish the run before saying so
                abandon()
                raise


def whole_intervals(rate: float, duration: float) -> int:
    """Return rate * duration as an integer.

    Raises
    ------
    InputError
        If it is not one within rounding, or is zero.
    """
    n = round(rate * duration)
    if n < 1 or abs(rate * duration - n) > 1e-9 * max(n, 1):
        raise InputError(
            f"duration must be a whole number of intervals, got duration {duration!r} s at rate {rate!r} Hz "
            f"= {rate * duration!r} intervals"
        )
    return n


def _require_motion(motion: object) -> None:
    if not isinstance(motion, Motion):
        raise InputError(f"motion must be a bench.Motion, got {motion!r}")
