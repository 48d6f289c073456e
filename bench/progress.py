"""What a run shows in the terminal: a progress bar, lines that say what happens, the table of verdicts."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table as RichTable

from bench.experiment import Outcome
from bench.runner import Reporter
from bench.table import Table

COLOURS = {"holds": "green", "does not hold": "red", "cannot be judged": "yellow"}


@contextmanager
def reporting(title: str) -> Iterator[Reporter]:
    """Show a progress bar while the block runs; without a terminal, only the lines."""
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    bar = Progress(*columns, console=console)
    task = bar.add_task("parts", total=None)
    told: int | None = None

    def progress(done: int, total: int) -> None:
        nonlocal told
        if told is None:  # not before the input has been checked
            console.print(title)
            bar.start()
        bar.update(task, completed=done, total=total)
        if not console.is_terminal and told != (tenth := 10 * done // total):
            told = tenth
            console.print(f"{done} of {total} parts")  # a log file has no moving bar
        told = told or 0
        if done == total:
            bar.stop()

    try:
        yield Reporter(say=console.print, progress=progress)
    finally:
        if bar.live.is_started:
            bar.stop()


def saying() -> Reporter:
    """Return what prints lines only, for work without parts."""
    console = Console(stderr=True)
    return Reporter(say=lambda text: console.print(text, markup=False, highlight=False, soft_wrap=True))


def print_table(table: Table) -> None:
    """Print a table under its title."""
    shown = RichTable(title=table.title, box=SIMPLE_HEAD, title_justify="left")
    for k, heading in enumerate(table.columns):
        shown.add_column(heading, justify="left" if k == 0 else "right")
    for row in table.cells():
        shown.add_row(*row)
    Console().print(shown, markup=False)


def print_files(files: Mapping[str, Path]) -> None:
    """Print what was written, and where."""
    for kind, path in files.items():
        print(f"{kind + ':':42} {path}")


def print_verdicts(outcome: Outcome) -> None:
    """Print published against measured, with verdicts."""
    console = Console()
    table = RichTable(title=f"{outcome.experiment.title}: published against measured", box=SIMPLE_HEAD)
    for heading in ("claim", "published", "measured", "verdict"):
        table.add_column(heading, no_wrap=heading == "verdict")
    for claim, verdict in outcome.verdicts:
        colour = COLOURS[verdict.judgement]
        table.add_row(claim.key, claim.published, verdict.measured, f"[{colour}]{verdict.judgement}[/{colour}]")
    console.print(table)
    console.print(outcome.evaluation.summary.replace("**", ""), markup=False, highlight=False)
