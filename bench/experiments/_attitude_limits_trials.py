"""The trials of `attitude-limits`: options, grid and streams, and what one solver does to them."""

import math
import warnings
from dataclasses import dataclass

import numpy as np

from bench.campaign import Item
from bench.errors import AccuracyError, Array, BenchWarning, InputError, require_integer
from bench.evaluation import attitude_error
from bench.experiments._attitude_limits_solvers import Variant, variants
from bench.motion.coning import Coning
from bench.rotation import quat_normalize
from bench.solvers.attitude import MAX_SAMPLES
from bench.table import Table
from bench.units import DEG, HZ

LOWEST, HIGHEST = 0.002, 0.45  # relative frequencies
HALF_ANGLES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 45.0, 90.0)  # deg
LOST = 1.0  # rad; beyond, an error says nothing and no drift can be fitted
COLUMNS = (
    *("stream", "solver", "label", "code", "samples", "latency", "half_angle_deg", "relative_frequency", "updates"),
    *("error_rad", "drift_rad_per_cycle", "angle_per_update_rad", "status"),
)


@dataclass(frozen=True)
class Stream:
    """A coning motion that goes through the MuJoCo rig at a sampling rate of 100 Hz."""

    half_angle_deg: float
    frequency_hz: float
    duration: float

    @property
    def name(self) -> str:
        """The stream in words, unique."""
        return f"{self.half_angle_deg:g} deg, {self.frequency_hz:g} Hz, {self.duration:g} s"


STREAM_RATE = 100.0  # Hz
STREAMS = (Stream(1.0, 2.0, 6.0), Stream(10.0, 1.0, 60.0), Stream(90.0, 2.0, 1.0))


@dataclass(frozen=True)
class Options:
    """Options of the experiment.

    Attributes
    ----------
    frequencies : int
        Points of the map between 0.002 and 0.45 of the sampling frequency.
    half_angles : int
        Points of the map from 0.1 to 90 degrees, 2 to 10.
    cycles : int
        Coning cycles of every point of the map.
    max_samples : int
        Largest N, 1 to 8; the claims need 8.
    """

    frequencies: int = 19
    half_angles: int = len(HALF_ANGLES)
    cycles: int = 20
    max_samples: int = MAX_SAMPLES

    def __post_init__(self) -> None:
        require_integer("frequencies", self.frequencies, minimum=2)
        if require_integer("half_angles", self.half_angles, minimum=2) > len(HALF_ANGLES):
            raise InputError(f"half_angles must be an integer from 2 to {len(HALF_ANGLES)}, got {self.half_angles}")
        require_integer("cycles", self.cycles, minimum=4)
        if require_integer("max_samples", self.max_samples, minimum=1) > MAX_SAMPLES:
            raise InputError(f"max_samples must be an integer from 1 to {MAX_SAMPLES}, got {self.max_samples}")

    @property
    def relative_frequencies(self) -> Array:
        """Coning frequency over sampling frequency."""
        return np.geomspace(LOWEST, HIGHEST, self.frequencies)

    @property
    def half_angles_deg(self) -> Array:
        """Half angles of the cone, deg."""
        chosen = np.rint(np.linspace(0, len(HALF_ANGLES) - 1, self.half_angles)).astype(int)
        return np.array(HALF_ANGLES)[chosen]


@dataclass(frozen=True)
class MapWork:
    """The whole map for one solver."""

    options: Options
    variant: Variant


@dataclass(frozen=True)
class StreamWork:
    """One stream for all solvers."""

    options: Options
    stream: Stream


def items(options: Options, seed: int) -> list[Item]:
    """Return one item per stream and per variant of every solver; nothing is random."""
    streams = [Item(f"stream-{k}", StreamWork(options, stream)) for k, stream in enumerate(STREAMS)]
    chosen = variants(options.max_samples)
    return streams + [Item(f"map-{k:03d}", MapWork(options, variant)) for k, variant in enumerate(chosen)]


def measure(work: MapWork | StreamWork) -> Table:
    """Return one row per cell of the map, or per solver of a stream."""
    rows = map_rows(work) if isinstance(work, MapWork) else stream_rows(work)
    return Table.from_rows(COLUMNS, rows, "Error on coning")


def map_rows(work: MapWork) -> list[tuple[object, ...]]:
    """Return the rows of one solver: coning of 1 Hz, increments in closed form."""
    options, variant = work.options, work.variant
    N, rows = variant.samples, []
    window = N + sum(variant.build().borrowed)
    for frequency in options.relative_frequencies:
        rate = 1.0 / frequency
        n = N * math.ceil(max(options.cycles * rate, window) / N)
        for half_angle in options.half_angles_deg:
            motion = Coning(half_angle=half_angle * DEG, angular_frequency=HZ)
            found = trial(variant, motion, motion.increments(rate, n), rate)
            rows.append(("", *_who(variant), half_angle, frequency, *found))
    return rows


def stream_rows(work: StreamWork) -> list[tuple[object, ...]]:
    """Return the rows of one stream: increments from the rig, as many as fill updates."""
    from bench.rig import Rig

    stream = work.stream
    motion = Coning(half_angle=stream.half_angle_deg * DEG, angular_frequency=stream.frequency_hz * HZ)
    increments = Rig.load("imu", threads=1).increments(motion, STREAM_RATE, stream.duration, tolerance=1e-14)
    assert increments.dtheta_b is not None  # this rig has a gyro
    rows = []
    for variant in variants(work.options.max_samples):
        whole = len(increments) // variant.samples * variant.samples
        found = trial(variant, motion, increments.dtheta_b[:whole], STREAM_RATE)
        relative = stream.frequency_hz / STREAM_RATE
        rows.append((stream.name, *_who(variant), stream.half_angle_deg, relative, *found))
    return rows


def _who(variant: Variant) -> tuple[object, ...]:
    return variant.name, variant.label, variant.code, variant.samples, variant.build().latency


def trial(variant: Variant, motion: Coning, dtheta: Array, rate: float) -> tuple[object, ...]:
    """Return updates, largest error, drift, angle per update and status of one solver on one coning.

    The status is ok; warned (the solver says that its series is too short); lost (the error exceeds 1 rad, and the
    drift is not fitted); or refused (the solver raises: the increments are beyond its convergence).
    """
    N = variant.samples
    updates = len(dtheta) // N
    t = N * np.arange(updates + 1) / rate
    truth = motion.kinematics(t).q_ib
    angle = float(np.sqrt((dtheta**2).sum(axis=1)).reshape(updates, N).sum(axis=1).max())
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", BenchWarning)
        try:
            q = variant.build().solve(dtheta, 1.0 / rate, quat_normalize(truth[0]))
        except AccuracyError:
            return updates, math.nan, math.nan, angle, "refused"
    error = attitude_error(q, truth)
    largest = float(np.sqrt((error**2).sum(axis=1)).max())
    if largest > LOST:
        return updates, largest, math.nan, angle, "lost"
    warned = any(issubclass(w.category, BenchWarning) for w in caught)
    cycles = t * motion.angular_frequency / HZ
    return updates, largest, drift(cycles, error), angle, "warned" if warned else "ok"


def drift(t: Array, error: Array) -> float:
    """Return the length of the slope of the error, shape (n, 3), in time.

    The fit of the straight line is weighted with Hann's window: oscillations of many periods average out.
    """
    weight = np.sin(np.pi * (np.arange(len(t)) + 0.5) / len(t)) ** 2
    centred = t - weight @ t / weight.sum()
    return float(np.linalg.norm((weight * centred) @ error) / ((weight * centred) @ centred))
