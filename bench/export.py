"""Simulated recordings in the formats of real ones, so that the truth of the bench feeds other tools."""

import tempfile
from pathlib import Path

import numpy as np

from bench.errors import Array, InputError, require_choice, require_integer, require_scalar
from bench.formats import Format
from bench.imu.grades import Grade
from bench.imu.grades import grade as grade_named
from bench.motion import motions
from bench.motion._earth_motion import EarthMotion
from bench.recording import Recording
from bench.rig import Rig, whole_intervals
from bench.signals import Increments, Readings

KINDS = ("increments", "rates", "mean-rates")
REHEARSED = 8  # intervals that show whether everything can be written, before long work
GYRO, ACCELEROMETER = 0, 1  # numbers of the sensors, for their noise


def earth_motions() -> dict[str, type[EarthMotion]]:
    """Return the motions on the Earth, by name."""
    return {name: cls for name, cls in motions().items() if issubclass(cls, EarthMotion)}


def simulate(
    motion: EarthMotion,
    rate: float,
    duration: float,
    *,
    kind: str = "increments",
    grade: str | None = None,
    seed: int | None = None,
) -> Recording:
    """Return what a gyro and an accelerometer triad report along a motion, from t = 0.

    Parameters
    ----------
    motion : EarthMotion
    rate : float, Hz
    duration : float, s
        A whole number of intervals.
    kind : {"increments", "rates", "mean-rates"}
        Exact increments; samples of the rates at both ends of every interval; or increments divided by the interval.
    grade : str, optional
        Name of the sensors' grade; None is perfect.
    seed : int, optional
        Of the sensors' errors; needed with a grade, and out of place without.

    Raises
    ------
    InputError
        If an argument breaks a rule.
    AccuracyError
        If the motion is not smooth on the scale of one interval.
    """
    if not isinstance(motion, EarthMotion):
        raise InputError(f"motion must be a motion on the Earth, got {motion!r}")
    require_choice("kind", kind, KINDS)
    if (grade is None) != (seed is None):
        raise InputError(f"seed and grade must be given together, got grade {grade!r} and seed {seed!r}")
    chosen = None if grade is None else grade_named(grade)
    rate = require_scalar("rate", rate, positive=True)
    n = whole_intervals(rate, require_scalar("duration", duration, positive=True))
    rig, source = Rig.load("imu"), f"simulated {motion.name}"
    if kind == "rates":
        readings = rig.sample(motion, np.arange(n + 1) / rate)
        return Recording.from_readings(_with_errors_sampled(readings, 1 / rate, chosen, seed), 1 / rate, source)
    made = Recording.from_increments(_with_errors(rig.increments(motion, rate, duration), chosen, seed), source)
    return made if kind == "increments" else made.as_mean_rates()


def export(
    motion: EarthMotion,
    path: str | Path,
    fmt: Format,
    rate: float,
    duration: float,
    *,
    kind: str = "increments",
    grade: str | None = None,
    seed: int | None = None,
    reference: str | Path | None = None,
    reference_every: int = 1,
    force: bool = False,
) -> Recording:
    """Write a simulated recording, and the true trajectory if there is a file for it; return the recording.

    Parameters
    ----------
    motion, rate, duration, kind, grade, seed
        As for `simulate`.
    path : path
        The recording.
    fmt : Format
        Of both files.
    reference : path, optional
        The truth at the start and at the end of every interval.
    reference_every : int
        Only every so many-th row of it, from the start on.
    force : bool
        Overwrite the files.

    Raises
    ------
    InputError
        If an argument breaks a rule, the format cannot hold such data, or a file exists and `force` is False;
        nothing is written then.
    AccuracyError
        As `simulate`.
    OutputError
        If a file cannot be written.
    """
    require_integer("reference_every", reference_every, minimum=1)
    targets = [Path(path), *([] if reference is None else [Path(reference)])]
    if len(set(targets)) < len(targets):
        raise InputError(f"reference must be another file than the recording, got {str(path)!r} for both")
    for target in targets:
        if target.exists() and not force:
            raise InputError(f"{str(target)!r} exists: choose another name, or force to overwrite it")
    n = whole_intervals(
        require_scalar("rate", rate, positive=True), require_scalar("duration", duration, positive=True)
    )
    few = min(n, REHEARSED)
    with tempfile.TemporaryDirectory() as folder:
        rehearsal = simulate(motion, rate, few / rate, kind=kind, grade=grade, seed=seed)
        trials = [Path(folder) / target.name for target in targets]
        _write(motion, rehearsal, fmt, trials, np.arange(few + 1) / rate, force=True)
    recording = simulate(motion, rate, duration, kind=kind, grade=grade, seed=seed)
    _write(motion, recording, fmt, targets, np.arange(0, n + 1, reference_every) / rate, force=force)
    return recording


def _write(
    motion: EarthMotion, recording: Recording, fmt: Format, targets: list[Path], t: Array, *, force: bool
) -> None:
    fmt.write_imu(targets[0], recording, initial=motion.navigation_initial(0.0), force=force)
    for target in targets[1:]:
        fmt.write_reference(target, motion.trajectory(t), force=force)


def _with_errors(made: Increments, grade: Grade | None, seed: int | None) -> Increments:
    if grade is None or seed is None or made.dtheta_b is None:
        return made
    gyro = grade.gyro.apply(made.dtheta_b, made.dt, "increments", seed=seed, sensor=GYRO, specific_force=made.dvel)
    dvel = grade.accelerometer.apply(made.dvel, made.dt, "increments", seed=seed, sensor=ACCELEROMETER)
    return Increments(made.dt, made.t, dvel, gyro, made.residual, made.nodes)


def _with_errors_sampled(made: Readings, dt: float, grade: Grade | None, seed: int | None) -> Readings:
    if grade is None or seed is None or made.gyro is None:
        return made
    force = made.accelerometers
    gyro = grade.gyro.apply(made.gyro, dt, "samples", seed=seed, sensor=GYRO, specific_force=force)
    return Readings(made.t, grade.accelerometer.apply(force, dt, "samples", seed=seed, sensor=ACCELEROMETER), gyro)
