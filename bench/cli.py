"""The command line: list, run, solve, export, view. Options, defaults and help come from the dataclasses.

Exit codes: 0 done, 2 bad input, 1 failed.
"""

import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, make_dataclass
from importlib.metadata import version
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from bench._cli_types import REGISTRY
from bench.cli_recordings import ExportCommand, SolveCommand, parse_export, parse_solve
from bench.errors import BenchError, InputError

if TYPE_CHECKING:
    from bench.experiment import Experiment, Outcome


@dataclass(frozen=True)
class ListCommand:
    """List experiments, motions, sensor errors and grades, rigs and solvers, one line each."""

    def __call__(self) -> None:
        """Print the lists."""
        for title, entries in _catalogue().items():
            print(f"{title}:")
            width = max(len(name) for name in entries)
            for name, line in entries.items():
                print(f"  {name:{width}}  {line}")


@dataclass(frozen=True)
class ViewCommand:
    """Open a recording in the native viewer, or make a picture of it where there is no display."""

    file: Annotated[Path, tyro.conf.Positional]
    """Recording (.rrd)."""
    screenshot: Path | None = None
    """Write a PNG instead of opening a window; works without a display."""
    at: float | None = None
    """Time of the picture, s."""
    tab: str | None = None
    """Tab of the picture, by its title."""

    def __call__(self) -> None:
        """Open the recording or write the picture."""
        from bench import viewer

        if self.screenshot is None:
            viewer.open_recording(self.file)
        else:
            print(f"Picture: {viewer.screenshot(self.file, self.screenshot, at=self.at, tab=self.tab)}")


@dataclass(frozen=True)
class RunCommand:
    """Run an experiment and write its report, tables, figures and recording."""

    experiment: Annotated[str, tyro.conf.Positional]
    """Name of the experiment, see `strapbench list`; `strapbench run NAME --help` shows its options."""


@dataclass(frozen=True)
class RunOptions:
    """What every run has in common."""

    out: Path
    """Folder for the report, tables, figures and recording; must be new, empty, or an interrupted run."""
    seed: int = 0
    """The same seed gives the same bits, whatever the number of jobs."""
    jobs: int | None = None
    """Worker processes; the default is the number of CPUs."""
    record: bool = True
    """Write the Rerun recording, if the experiment has one."""
    force: bool = False
    """Overwrite the run that is in the folder."""
    scheduler: str | None = None
    """Address of a Dask scheduler to work on, instead of worker processes."""


def _run(experiment: "Experiment", options: Any, common: RunOptions) -> None:
    from bench.campaign import cpu_count
    from bench.progress import reporting
    from bench.runner import run

    with reporting(experiment.title) as reporter:
        outcome = run(
            experiment.name,
            seed=common.seed,
            jobs=cpu_count() if common.jobs is None else common.jobs,
            out=common.out,
            force=common.force,
            record=common.record,
            scheduler=common.scheduler,
            reporter=reporter,
            **asdict(options),
        )
    _print_outcome(outcome)


def _print_outcome(outcome: "Outcome") -> None:
    from bench.progress import print_files, print_verdicts

    print_verdicts(outcome)
    print_files(outcome.files)


def _catalogue() -> dict[str, dict[str, str]]:
    from bench.experiment import experiments
    from bench.formats import formats
    from bench.imu import error_models
    from bench.imu.grades import grades
    from bench.mjcf import model_names, model_summary
    from bench.motion import motions
    from bench.registry import first_line
    from bench.solvers import KINDS, solvers
    from bench.starts import starts

    return {
        "experiments": {name: experiment.title for name, experiment in experiments().items()},
        "motions": {name: first_line(motion) for name, motion in motions().items()},
        "sensor errors": {name: first_line(model) for name, model in error_models().items()},
        "sensor grades": {name: grade.summary for name, grade in grades().items()},
        "rigs": {name: model_summary(name) for name in model_names()},
        "formats of recordings": {name: first_line(cls) for name, cls in formats().items()},
        "initial states of recordings": {name: first_line(cls) for name, cls in starts().items()},
        **{f"{kind} solvers": {name: first_line(cls) for name, cls in solvers(kind).items()} for kind in KINDS},
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # a folder's name must not stop a run in a plain locale
            stream.reconfigure(errors="backslashreplace")
    if arguments == ["--version"]:
        print(f"strapbench {version('strapbench')}")
        return 0
    try:
        command = _parse(arguments)
        command()
    except InputError as error:
        return _fail(error, 2)
    except BenchError as error:
        return _fail(error, 1)
    except KeyboardInterrupt:
        return _fail("interrupted", 1)
    except BrokenPipeError:  # the reader of our output has gone: nothing is wrong
        sys.stderr.close()
    return 0


def _parse(arguments: list[str]) -> Callable[[], None]:
    parsers = {"run": _parse_run, "solve": parse_solve, "export": parse_export}
    if len(arguments) > 1 and arguments[0] in parsers and arguments[1] not in ("-h", "--help"):
        return parsers[arguments[0]](arguments[1:])
    commands = (
        Annotated[ListCommand, tyro.conf.subcommand("list")]
        | Annotated[RunCommand, tyro.conf.subcommand("run")]
        | Annotated[SolveCommand, tyro.conf.subcommand("solve")]
        | Annotated[ExportCommand, tyro.conf.subcommand("export")]
        | Annotated[ViewCommand, tyro.conf.subcommand("view")]
    )
    command: Any = tyro.cli(
        commands,
        prog="strapbench",
        description="Tells the truth about strapdown navigation algorithms.",
        args=arguments,
        registry=REGISTRY,
    )
    return command


def _parse_run(arguments: list[str]) -> Callable[[], None]:
    """Parse the name of an experiment, wherever it stands, and the options that belong to it."""
    from bench.experiment import experiment, experiments

    known = experiments()
    # The name comes first; after options it is the last word that is one, for a folder may have the same name.
    places = [k for k, word in enumerate(arguments) if word in known]
    place = places[-1] if places and arguments[0].startswith("-") else 0
    name = arguments[place]
    chosen = experiment(name)
    flat = tyro.conf.arg(name="")
    parts: list[Any] = [
        ("common", Annotated[RunOptions, flat]),
        ("options", Annotated[chosen.options, flat], field(default=chosen.options())),
    ]
    parsed: Any = tyro.cli(
        make_dataclass("Run", parts, frozen=True),
        prog=f"strapbench run {name}",
        description=f"{chosen.title}. {chosen.source}.",
        args=[*arguments[:place], *arguments[place + 1 :]],
        config=(tyro.conf.OmitArgPrefixes,),
    )
    return lambda: _run(chosen, parsed.options, parsed.common)


def _fail(error: object, code: int) -> int:
    print(f"strapbench: {error}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
