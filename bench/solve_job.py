"""The job behind ``strapbench solve``: a file with a recording in, a folder with solution, figures and report out."""

import hashlib
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from bench._damp_report import damped_sentence
from bench.aiding import VelocityAiding, VelocityFile
from bench.damp import STEP, Damped, damp, require_held_height
from bench.earth import WGS84, Earth
from bench.errors import BenchWarning, InputError, require_array
from bench.formats import Format
from bench.jit import is_compiled
from bench.output import RunFolder
from bench.recording import Recording
from bench.runner import COMPILING, Reporter
from bench.solve import KINDS, ORIGIN, Solution, solve_recording, without_bias
from bench.solvers.attitude import AttitudeSolver
from bench.solvers.damping import DampingFilter
from bench.solvers.navigation import NavigationSolver
from bench.starts import Beginning, Given, Start
from bench.starts.reference import StartReference
from bench.trajectory import Trajectory
from bench.units import DEG_PER_H, MICRO_G

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class SolveJob:
    """What is solved, and how.

    Attributes
    ----------
    imu : Path
        The recording.
    format : Format
    solver : NavigationSolver or AttitudeSolver
    start : Start
        How the initial state is found.
    earth : Earth
    rule : str, optional
        How rates are integrated; needed for rates, refused for increments.
    gyro_bias_deg_per_h, accelerometer_bias_micro_g : tuple of 3 floats, deg/h, 1e-6 * 9.80665 m/s^2
        Subtracted; right, forward, up.
    reference : Path, optional
    reference_format : Format, optional
        The default is `format`.
    interpolate : bool
        Compare at all rows of the reference, not only at those at times of the solution.
    aiding : Path, optional
        External velocity for the filter.
    aiding_format : VelocityFile, optional
        How to read it; needed with it.
    filter : DampingFilter, optional
        Damps the solution, which must be of a navigation solver of held height; needs `aiding`.
    """

    imu: Path
    format: Format
    solver: NavigationSolver | AttitudeSolver
    start: Start
    earth: Earth = WGS84
    rule: str | None = None
    gyro_bias_deg_per_h: Vector = ORIGIN
    accelerometer_bias_micro_g: Vector = ORIGIN
    reference: Path | None = None
    reference_format: Format | None = None
    interpolate: bool = True
    aiding: Path | None = None
    aiding_format: VelocityFile | None = None
    filter: DampingFilter | None = None

    def __post_init__(self) -> None:
        self._check_damping()
        for name in ("gyro_bias_deg_per_h", "accelerometer_bias_micro_g"):
            require_array(name, getattr(self, name), (3,))
        if self.reference is None:
            if self.reference_format is not None:
                raise InputError(f"reference_format needs a reference, got {self.reference_format.name!r} without one")
            if isinstance(self.start, StartReference):
                raise InputError("initial 'reference' needs a reference, got none")

    def _check_damping(self) -> None:
        if (self.aiding is None) != (self.filter is None):
            given = "the velocity alone" if self.filter is None else f"filter {self.filter.name!r} alone"
            raise InputError(f"aiding and filter must be given together: a velocity, and what uses it; got {given}")
        if (self.aiding is None) != (self.aiding_format is None):
            raise InputError("aiding and aiding_format must be given together: columns and units must be declared")
        if self.filter is not None:
            require_held_height(self.solver)
            self.filter.start(STEP)  # its options must fit the step

    @property
    def title(self) -> str:
        """Of reports and recordings."""
        return f"{self.imu.name}, {self.solver.name}" + (f" and {self.filter.name}" if self.filter else "")

    def inputs(self) -> dict[str, Any]:
        """Return what determines the result, as plain data; files by their contents."""
        judge = self.reference_format or self.format
        return {
            "recording": {**_file(self.imu), "format": _options(self.format)},
            "reference": self.reference and {**_file(self.reference), "format": _options(judge)},
            "solver": {"kind": KINDS[isinstance(self.solver, AttitudeSolver)], **_options(self.solver)},
            "aiding": self.aiding and {**_file(self.aiding), "format": vars(self.aiding_format)},
            "filter": self.filter and _options(self.filter),
            "initial": _options(self.start),
            "interpolate": self.interpolate,
            "earth": self.earth.name,
            "rule": self.rule,
            "gyro_bias_deg_per_h": list(self.gyro_bias_deg_per_h),
            "accelerometer_bias_micro_g": list(self.accelerometer_bias_micro_g),
            "strapbench": version("strapbench"),
        }


@dataclass(frozen=True, eq=False)
class SolveOutcome:
    """What became of a job.

    Attributes
    ----------
    job : SolveJob
    inputs : dict
        What determines the result, as plain data; files by their contents.
    recording : Recording
        As read.
    beginning : Beginning
    solution : Solution
    damped : Damped or None
        If there is a filter.
    warnings : tuple of str
        What is doubtful in the files, and in how the velocity fits the solution.
    files : dict of str to Path
        What was written, by kind.
    """

    job: SolveJob
    inputs: dict[str, Any]
    recording: Recording
    beginning: Beginning
    solution: Solution
    damped: Damped | None = None
    warnings: tuple[str, ...] = ()
    files: dict[str, Path] = field(default_factory=dict)

    @property
    def timing(self) -> dict[str, Any]:
        """What the check of the times found."""
        made = self.recording
        return {
            "samples": len(made),
            "kind": made.kind,
            "rate_hz": 1.0 / made.dt,
            "dt_s": made.dt,
            "first_s": float(made.t[0]),
            "last_s": float(made.t[-1]),
            "epoch_ns": made.epoch_ns,
            "largest_deviation_of_an_interval": float(np.abs(np.diff(made.t) / made.dt - 1).max()),
        }

    @property
    def counts(self) -> dict[str, int]:
        """How many increments were skipped before the start, solved, and left over at the end; rows compared."""
        counts = {"skipped": self.beginning.skipped, "solved": self.solution.used, "left_over": self.solution.left_over}
        comparison = self.solution.comparison
        if comparison is not None:
            n = len(comparison.reference)
            counts |= {"compared": n, "interpolated": n - comparison.matched}
        return counts

    @property
    def summary(self) -> str:
        """One paragraph: what was solved and what was not."""
        counts, made = self.counts, self.solution
        t = made.trajectory.t
        text = (
            f"`{made.solver.name}` solved {counts['solved']} increments, {t[0]:.6f} to {t[-1]:.6f} s "
            f"({t[-1] - t[0]:.6g} s), from: {self.beginning.note}."
        )
        if counts["skipped"]:
            text += f" {counts['skipped']} increments before the start were not solved."
        if counts["left_over"]:
            text += (
                f" {counts['left_over']} at the end were left over: they do not fill an update of "
                f"{made.solver.samples}."
            )
        if made.comparison is not None:
            text += (
                f" It was compared with {counts['compared']} rows of the reference, and interpolated for "
                f"{counts['interpolated']} of them."
            )
        if made.attitude_only:
            text += " Only attitude was solved; east-north-up is that of the place of the start."
        if self.damped is not None:
            text += damped_sentence(self.damped)
        return text + "".join(f" Warning: {doubt}." for doubt in self.warnings)


def run_job(
    job: SolveJob,
    out: str | Path | None = None,
    *,
    force: bool = False,
    record: bool = True,
    reporter: Reporter | None = None,
) -> SolveOutcome:
    """Read, solve, and write tables, figures, recording and report.

    Parameters
    ----------
    job : SolveJob
    out : path, optional
        Folder, as of `bench.run`; None writes nothing.
    force : bool
        Overwrite the finished run in `out`.
    record : bool
        Write the Rerun recording (only with `out`).
    reporter : Reporter, optional
        Told what happens.

    Raises
    ------
    InputError
        If a file or an option breaks a rule; nothing is written then.
    AccuracyError
        If the solution is no longer finite.
    OutputError
        If a result cannot be written; what was written before is kept.
    """
    say = (reporter or Reporter()).say
    with _collected(say) as doubts:
        say(f"Reading {job.imu} ({job.format.name}) ...")
        recording = job.format.read_imu(job.imu)
        reference = _reference(job, recording, say)
        aiding = _aiding(job, recording, say)
    biases = np.array(job.gyro_bias_deg_per_h) * DEG_PER_H, np.array(job.accelerometer_bias_micro_g) * MICRO_G
    increments = without_bias(recording.as_increments(job.rule), *biases)
    if not is_compiled():
        say(COMPILING)
    begin = job.start.find(Given(increments, job.earth, reference, lambda: _header(job)))
    rest = _after(increments, begin.skipped)
    inputs = job.inputs()
    folder = None if out is None else RunFolder.open(Path(out), inputs, force=force)
    say(f"Solving {len(rest)} increments at {1 / rest.dt:.6g} Hz with {job.solver.name}; start: {begin.note} ...")
    solution = solve_recording(
        rest, job.solver, begin.initial, job.earth, reference=reference, interpolate=job.interpolate
    )
    damped = None
    if aiding is not None and job.filter is not None:
        say(f"Damping with {job.filter.name} ...")
        with _collected(say) as found:
            damped = damp(solution, aiding, job.filter)
        doubts += found
    outcome = SolveOutcome(job, inputs, recording, begin, solution, damped, tuple(doubts))
    if folder is None:
        return outcome
    from bench._solve_content import content_of

    return replace(outcome, files=folder.write_content(content_of(outcome, record=record), say=say))


@contextmanager
def _collected(say: Callable[[str], None]) -> Iterator[list[str]]:
    """Give a list for the warnings of the bench in the block, and tell them; others go on."""
    doubts: list[str] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", BenchWarning)
        yield doubts
    for warning in caught:
        if issubclass(warning.category, BenchWarning):
            doubts.append(str(warning.message))
            say(f"Warning: {warning.message}")
        else:
            warnings.warn_explicit(warning.message, warning.category, warning.filename, warning.lineno)


def _reference(job: SolveJob, recording: Recording, say: Callable[[str], None]) -> Trajectory | None:
    if job.reference is None:
        return None
    how = job.reference_format or job.format
    say(f"Reading {job.reference} ({how.name}) ...")
    return how.read_reference(job.reference, job.earth, epoch_ns=recording.epoch_ns)


def _aiding(job: SolveJob, recording: Recording, say: Callable[[str], None]) -> VelocityAiding | None:
    if job.aiding is None or job.aiding_format is None:
        return None
    say(f"Reading {job.aiding} (velocity) ...")
    return job.aiding_format.read(job.aiding, epoch_ns=recording.epoch_ns)


def _header(job: SolveJob) -> Any:
    if job.format.start is not None:
        raise InputError(f"initial 'header' is the state at the start of the file, got start = {job.format.start!r}")
    return job.format.read_initial(job.imu)


def _after(increments: Recording, skipped: int) -> Recording:
    """Return the increments behind the first `skipped`."""
    if skipped == 0:
        return increments
    if len(increments) - skipped < 2:
        raise InputError(
            f"initial must leave at least two increments to solve, got {len(increments) - skipped} of {len(increments)}"
        )
    return increments.between(float(increments.t[skipped]), float(increments.t[-1]))


def _file(path: Path) -> dict[str, Any]:
    with path.open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
    return {"file": str(path), "bytes": path.stat().st_size, "sha256": digest}


def _options(chosen: Any) -> dict[str, Any]:
    """Return name and options as plain data; an infinity as text, for which JSON has no number."""
    plain = {
        name: str(value) if isinstance(value, Path) or value == np.inf else value
        for name, value in asdict(chosen).items()
    }
    return {"name": chosen.name, **plain}
