"""Experiments: a paper's conditions and claims as data, and what a run of them gives.

An `Experiment` names its conditions (each stated or assumed), its claims and three
functions: `items` cuts the work, `measure` does one piece, `evaluate` turns the rows
into tables, verdicts and figures. ``bench.runner`` runs any of them.
"""

import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any, Literal

from bench.campaign import Item
from bench.errors import require_choice
from bench.figures import Figure
from bench.references import Source
from bench.registry import discover_objects
from bench.table import Table

Judgement = Literal["holds", "does not hold", "cannot be judged"]


@dataclass(frozen=True)
class Condition:
    """One condition of an experiment, and whether the source states it.

    Attributes
    ----------
    name, value : str
        With the unit in the value.
    status : "stated" or "assumed"
    note : str
        Why, where it is assumed.
    """

    name: str
    value: str
    status: Literal["stated", "assumed"]
    note: str = ""


@dataclass(frozen=True)
class Claim:
    """What the source says, before anything is measured.

    Attributes
    ----------
    key : str
        Unique within the experiment.
    published : str
        The value or statement, as printed.
    place : str
        Where it stands in the source.
    judged_by : str
        The rule of the verdict; it follows from the printed digits or statement.
    """

    key: str
    published: str
    place: str
    judged_by: str


@dataclass(frozen=True)
class Verdict:
    """What became of a claim: the measured value and one sentence of reason."""

    judgement: Judgement
    measured: str
    reason: str


@dataclass(frozen=True, eq=False)
class Evaluation:
    """What `Experiment.evaluate` returns.

    Attributes
    ----------
    verdicts : dict of str to Verdict
        By the key of the claim; one for each.
    tables : dict of str to Table
        For the report, by file name.
    figures : sequence of Figure
    summary : str
        One paragraph of Markdown: what was found.
    focus : Any
        What the recording shows (a trial, say); the experiment's own business.
    """

    verdicts: Mapping[str, Verdict]
    tables: Mapping[str, Table]
    figures: Sequence[Figure]
    summary: str
    focus: Any = None


@dataclass(frozen=True)
class Experiment:
    """One experiment of a paper.

    Attributes
    ----------
    name, title : str
    source : Source
    conditions : tuple of Condition
    claims : tuple of Claim
    options : type
        Frozen dataclass with defaults; the command line is made from it.
    items : callable
        (options, seed) -> list of Item.
    measure : callable
        Work of an item -> Table. Module-level, so that worker processes find it.
    evaluate : callable
        (options, seed, rows) -> Evaluation.
    record : callable, optional
        (outcome, path) -> None: writes the recording.
    """

    name: str
    title: str
    source: Source
    conditions: tuple[Condition, ...]
    claims: tuple[Claim, ...]
    options: type
    items: Callable[[Any, int], list[Item]]
    measure: Callable[[Any], Table]
    evaluate: Callable[[Any, int, Table], Evaluation]
    record: "Callable[[Outcome, Path], None] | None" = None


@dataclass(frozen=True, eq=False)
class Outcome:
    """Everything a run found.

    Attributes
    ----------
    experiment : Experiment
    options : dataclass instance
    seed : int
    versions : dict
        Of strapbench, Python and the packages that compute.
    rows : Table
        What was measured, one row per item, trial and time.
    evaluation : Evaluation
    folder : Path or None
        Where it was written.
    files : dict of str to Path
        Report, recording and so on.
    """

    experiment: Experiment
    options: Any
    seed: int
    versions: dict[str, str]
    rows: Table
    evaluation: Evaluation
    folder: Path | None = None
    files: dict[str, Path] = field(default_factory=dict)

    @property
    def verdicts(self) -> list[tuple[Claim, Verdict]]:
        """Every claim with its verdict."""
        return [(claim, self.evaluation.verdicts[claim.key]) for claim in self.experiment.claims]

    @property
    def tables(self) -> Mapping[str, Table]:
        """The tables of the report."""
        return self.evaluation.tables

    def inputs(self) -> dict[str, Any]:
        """Return what determines the result, as plain data."""
        return inputs_of(self.experiment, self.options, self.seed)


def experiments() -> dict[str, Experiment]:
    """Return all experiments, by name."""
    return discover_objects("bench.experiments", Experiment)


def experiment(name: str) -> Experiment:
    """Return an experiment by name.

    Raises
    ------
    UnknownNameError
        If there is none of that name; it lists the valid ones.
    """
    found = experiments()
    return found[require_choice("experiment", name, found)]


def inputs_of(chosen: Experiment, options: Any, seed: int) -> dict[str, Any]:
    """Return what determines the result of a run, as plain data."""
    return {"experiment": chosen.name, "options": asdict(options), "seed": seed, "strapbench": version("strapbench")}


def versions() -> dict[str, str]:
    """Return the versions of everything that computes."""
    packages = ("strapbench", "mujoco", "numpy", "scipy", "numba", "rerun-sdk")
    return {"python": platform.python_version(), **{name: version(name) for name in packages}}
