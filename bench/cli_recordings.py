"""The commands `solve` and `export`: recorded data in, recorded data out; options come from the chosen parts.

A first look at the words finds the names (format, solver, ...); their dataclasses then make the options.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, make_dataclass
from inspect import getdoc
from pathlib import Path
from typing import Annotated, Any, Literal, get_type_hints

import tyro

from bench._cli_help import own_entries
from bench._cli_types import REGISTRY
from bench.earth import WGS84, Earth
from bench.errors import Array, InputError, UnknownNameError, require_choice

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class SolveCommand:
    """Run a navigation or attitude solver on recorded data, and write solution, errors, figures and recording.

    `strapbench solve --format NAME --solver NAME --initial NAME --aiding FILE --filter NAME --help` shows the options
    of those, or of as many of them as are given.
    """

    imu: Annotated[Path, tyro.conf.Positional]
    """File with the recording."""
    format: str
    """Its format, see `strapbench list`."""
    solver: str
    """Navigation or attitude solver, see `strapbench list`."""
    initial: str
    """How the initial state is found, see `strapbench list`."""
    out: Path
    """Folder for solution, report, figures and recording; must be new, empty, or an interrupted run."""
    rule: str | None = None
    """How rates are integrated: trapezoid, simpson, spline or average; needed for rates, refused for increments."""
    earth: Earth = WGS84
    """Rotation, gravitation and ellipsoid."""
    gyro_bias_deg_per_h: Vector = (0.0, 0.0, 0.0)
    """Subtracted from the gyro; right, forward, up."""
    accelerometer_bias_micro_g: Vector = (0.0, 0.0, 0.0)
    """Subtracted from the accelerometer; right, forward, up; g = 9.80665 m/s^2."""
    reference: Path | None = None
    """File with a reference trajectory, for errors."""
    reference_format: str | None = None
    """Its format; the default is that of the recording, with the same options."""
    interpolate: bool = True
    """Compare at all rows of the reference; otherwise only at those within 1 us of an update of the solver."""
    aiding: Path | None = None
    """File with an external velocity for a damping filter; `--aiding FILE --help` shows how to say what it holds."""
    filter: str | None = None
    """Damping filter, see `strapbench list`; the solver runs free, with --solver.height held."""
    record: bool = True
    """Write the Rerun recording."""
    force: bool = False
    """Overwrite the run that is in the folder."""


@dataclass(frozen=True)
class ExportCommand:
    """Write what an inertial measurement unit would record along a motion on the Earth, and the truth beside it.

    `strapbench export MOTION --format NAME --help` shows the options of both.
    """

    motion: Annotated[str, tyro.conf.Positional]
    """Motion on the Earth, see `strapbench list`."""
    format: str
    """Format of the file, see `strapbench list`."""
    rate: float
    """Sampling rate, Hz."""
    duration: float
    """Length, s, from t = 0."""
    out: Path
    """File for the recording."""
    reference_out: Path | None = None
    """File for the true trajectory, at the ends of the intervals."""
    reference_every: int = 1
    """Write every so many-th row of the truth."""
    kind: Literal["increments", "rates", "mean-rates"] = "increments"
    """Exact increments, samples of the rates, or increments divided by the interval."""
    grade: str | None = None
    """Sensor grade, see `strapbench list`; the default is perfect sensors."""
    seed: int | None = None
    """Of the sensor errors; needed with a grade."""
    force: bool = False
    """Overwrite the files."""


def parse_solve(words: Sequence[str]) -> Callable[[], None]:
    """Return what `strapbench solve` does with these words."""
    from bench.aiding import VelocityFile
    from bench.formats import formats
    from bench.solve import find_solver
    from bench.solvers import solvers
    from bench.starts import starts

    chosen_by_name = ("format", "solver", "initial", "reference_format", "aiding", "filter")
    names = {name: _value(words, name) for name in chosen_by_name}
    parts: dict[str, tuple[type, bool]] = {}
    if names["format"]:
        parts["format"] = formats()[require_choice("format", names["format"], formats())], True
    if names["reference_format"]:
        chosen = formats()[require_choice("reference_format", names["reference_format"], formats())]
        parts["reference_format"] = chosen, True
    if names["solver"]:
        parts["solver"] = find_solver(names["solver"])[1], True
    if names["initial"]:
        if names["initial"] not in starts():
            hint = "; values in a file: --initial file --file NAME"
            raise UnknownNameError("initial", names["initial"], starts(), hint)
        parts["initial"] = starts()[names["initial"]], False
    if names["aiding"]:
        parts["aiding_format"] = VelocityFile, True
    if names["filter"]:
        filters = solvers("damping")
        parts["filter"] = filters[require_choice("filter", names["filter"], filters)], True
    common, found = _parse("solve", SolveCommand, parts, words)
    return lambda: _solve(common, found)


def parse_export(words: Sequence[str]) -> Callable[[], None]:
    """Return what `strapbench export` does with these words."""
    from bench.export import earth_motions
    from bench.formats import formats

    parts: dict[str, tuple[type, bool]] = {}
    known = earth_motions()
    if words and not words[0].startswith("-"):
        require_choice("motion on the Earth", words[0], known)
    if motion := next((word for word in words if word in known), None):
        parts["motion"] = _typeable(known[motion]), True
    if name := _value(words, "format"):
        parts["format"] = formats()[require_choice("format", name, formats())], True
    common, found = _parse("export", ExportCommand, parts, words)
    return lambda: _export(common, found)


def _value(words: Sequence[str], name: str) -> str | None:
    """Return the word behind the last ``--name``, or behind ``--name=``."""
    found = None
    for flag in {f"--{name}", f"--{name.replace('_', '-')}"}:
        for k, word in enumerate(words):
            if word == flag and k + 1 < len(words):
                found = words[k + 1]
            elif word.startswith(f"{flag}="):
                found = word[len(flag) + 1 :]
    return found


def _parse(
    command: str, common: type, parts: dict[str, tuple[type, bool]], words: Sequence[str]
) -> tuple[Any, dict[str, Any]]:
    """Return the common options and those of each part; with a prefix, or flat."""
    flat = tyro.conf.arg(name="")
    members: list[Any] = [("common", Annotated[common, flat])]
    for name, (cls, prefixed) in parts.items():
        cls.__doc__ = own_entries(cls.__doc__ or "")
        members.append((name, Annotated[cls, tyro.conf.arg(name=name if prefixed else "")]))
    parsed: Any = tyro.cli(
        make_dataclass("Command", members, frozen=True),
        prog=f"strapbench {command}",
        description=getdoc(common),
        args=list(words),
        registry=REGISTRY,
    )
    return parsed.common, {name: getattr(parsed, name) for name in parts}


def _typeable(motion: type) -> type:
    """Return a motion if its options can be typed."""
    hints = get_type_hints(motion)
    for option in fields(motion):
        if hints[option.name] == Array:
            raise InputError(
                f"motion {motion.name!r} takes arrays ({option.name}), which cannot be typed: "  # type: ignore[attr-defined]
                "make it in Python and use bench.export.export"
            )
    return motion


def _solve(common: SolveCommand, parts: dict[str, Any]) -> None:
    from bench._damp_report import consistency_table
    from bench._solve_report import state_table, summary_tables
    from bench.progress import print_files, print_table, saying
    from bench.solve_job import SolveJob, run_job

    job = SolveJob(
        imu=common.imu,
        format=parts["format"],
        solver=parts["solver"],
        start=parts["initial"],
        earth=common.earth,
        rule=common.rule,
        gyro_bias_deg_per_h=common.gyro_bias_deg_per_h,
        accelerometer_bias_micro_g=common.accelerometer_bias_micro_g,
        reference=common.reference,
        reference_format=parts.get("reference_format"),
        interpolate=common.interpolate,
        aiding=common.aiding,
        aiding_format=parts.get("aiding_format"),
        filter=parts.get("filter"),
    )
    outcome = run_job(job, common.out, force=common.force, record=common.record, reporter=saying())
    solution = outcome.solution
    for table in summary_tables(solution, outcome.damped):
        print_table(table)
    if outcome.damped is not None:
        print_table(consistency_table(outcome.damped))
    print_table(state_table(solution, outcome.damped))
    print(outcome.summary)
    print_files(outcome.files)


def _export(common: ExportCommand, parts: dict[str, Any]) -> None:
    from bench.export import export
    from bench.progress import print_files, saying

    saying().say(f"Simulating {common.motion}, {common.duration:g} s at {common.rate:g} Hz ...")
    recording = export(
        parts["motion"],
        common.out,
        parts["format"],
        common.rate,
        common.duration,
        kind=common.kind,
        grade=common.grade,
        seed=common.seed,
        reference=common.reference_out,
        reference_every=common.reference_every,
        force=common.force,
    )
    files = {f"recording, {len(recording)} {recording.kind}": common.out}
    if common.reference_out is not None:
        files["reference"] = common.reference_out
    print_files(files)
