"""Running an experiment: checks, campaign, evaluation, and what is written; generic."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from bench.campaign import CampaignInterrupted, open_executor, run_campaign
from bench.errors import InputError, require_integer
from bench.experiment import Experiment, Outcome, experiment, inputs_of, versions
from bench.jit import is_compiled
from bench.output import RunFolder

COMPILING = (
    "Compiling the numerical kernels: the first run of this version takes about 10 s longer, "
    "or more where there are many solvers."
)


@dataclass
class Reporter:
    """How a run tells what it does; the default is silent."""

    say: Callable[[str], None] = lambda text: None
    progress: Callable[[int, int], None] = lambda done, total: None


def make_options(chosen: Experiment, values: Mapping[str, Any]) -> Any:
    """Return the experiment's options with some values set.

    Raises
    ------
    InputError
        If an option is unknown; it lists the valid ones.
    """
    known = [f.name for f in fields(chosen.options)]
    for name in values:
        if name not in known:
            raise InputError(f"{chosen.name} has no option {name!r}; options: {', '.join(known)}")
    return chosen.options(**values)


def run(
    name: str,
    *,
    seed: int = 0,
    jobs: int = 1,
    out: str | Path | None = None,
    force: bool = False,
    record: bool = True,
    scheduler: str | None = None,
    reporter: Reporter | None = None,
    **options: Any,
) -> Outcome:
    """Run an experiment.

    Parameters
    ----------
    name : str
        As in ``strapbench list``.
    seed : int
        The same seed gives the same bits, whatever the number of jobs.
    jobs : int
        Worker processes. More than one needs the usual ``if __name__ == "__main__"`` guard in a script.
    out : path, optional
        Folder for report, tables, figures and recording; None writes nothing. An interrupted run in that folder
        is continued, a finished one is not touched without `force`.
    force : bool
        Overwrite the run in `out`.
    record : bool
        Write the Rerun recording (only with `out`).
    scheduler : str, optional
        Address of a Dask scheduler, used instead of worker processes.
    reporter : Reporter, optional
        Told what happens.
    **options
        Of the experiment.

    Returns
    -------
    Outcome

    Raises
    ------
    UnknownNameError
        If there is no such experiment.
    InputError
        If an argument or an option breaks a rule, or `out` cannot be written or holds another run.
    OutputError
        If a result cannot be written at the end; the finished parts are kept.
    CampaignError, CampaignInterrupted
        If the work fails or is interrupted.
    """
    chosen = experiment(name)
    seed = require_integer("seed", seed, minimum=0)
    jobs = require_integer("jobs", jobs, minimum=1)
    settings = make_options(chosen, options)
    reporter = reporter or Reporter()
    items = chosen.items(settings, seed)
    first_run = not is_compiled()
    with open_executor(min(jobs, len(items)), scheduler) as executor:
        folder = None if out is None else RunFolder.open(_path(out), inputs_of(chosen, settings, seed), force=force)
        if first_run:
            reporter.say(COMPILING)
        rows = run_campaign(
            chosen.measure,
            items,
            executor=executor,
            folder=None if folder is None else folder.parts,
            progress=reporter.progress,
            first_here=first_run,
        )
    try:
        evaluation = chosen.evaluate(settings, seed, rows)
        outcome = Outcome(chosen, settings, seed, versions(), rows, evaluation)
        return outcome if folder is None else folder.write(outcome, record=record, say=reporter.say)
    except KeyboardInterrupt:
        kept = "" if folder is None else f" and kept in {folder.parts}; run the same command again to continue"
        raise CampaignInterrupted(f"interrupted; all {len(items)} parts are finished{kept}") from None


def _path(out: str | Path) -> Path:
    if not isinstance(out, (str, Path)) or not str(out):
        raise InputError(f"out must be a path, got {out!r}")
    return Path(out)
