"""The folder of one run: refuses to overwrite, resumes what was interrupted, writes everything at the end.

inputs.json   what determines the result; written first
parts/        finished work items, until the run is complete
result.json   inputs, versions, verdicts; written last, so its presence means "finished"
report.md, report.html, tables/*.parquet, figures/*.png, recording.rrd
"""

import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.errors import InputError, OutputError
from bench.experiment import Outcome
from bench.figures import Figure
from bench.table import Table, replacing

if TYPE_CHECKING:
    from bench.report import Block

FOLDERS = {"parts": ".parquet", "tables": ".parquet", "figures": ".png"}
MADE_HERE = ("result.json", *FOLDERS, "report.md", "report.html", "recording.rrd", "inputs.json")


@dataclass(frozen=True)
class RunFolder:
    """A folder that holds one run and nothing else; make one with `RunFolder.open`."""

    path: Path

    @classmethod
    def open(cls, path: Path, inputs: dict[str, Any], *, force: bool = False) -> "RunFolder":
        """Return the folder, ready for a run with these inputs.

        Raises
        ------
        InputError
            If it cannot be written, holds something that is not a run, or holds a finished run or an interrupted
            one with other inputs and `force` is not set.
        """
        folder = cls(path)
        try:
            path.mkdir(parents=True, exist_ok=True)
            found = sorted(entry.name for entry in path.iterdir())
            folder._refuse(found, inputs, force)
            if force:
                folder._clear()
            _write_json(path / "inputs.json", inputs)
        except OSError as error:
            raise InputError(f"out {str(path)!r} cannot be written: {error.strerror or error}") from error
        return folder

    @property
    def parts(self) -> Path:
        """Folder of the finished work items."""
        return self.path / "parts"

    def _refuse(self, found: list[str], inputs: dict[str, Any], force: bool) -> None:
        where = f"out {str(self.path)!r}"
        if not found:
            return
        foreign = [name for name in found if name not in MADE_HERE and not name.endswith(".part")]
        for name, suffix in FOLDERS.items():
            foreign += [f"{name}/{f.name}" for f in (self.path / name).glob("*") if f.suffix not in (suffix, ".part")]
        if foreign or "inputs.json" not in found:
            alien = (foreign or found)[0]
            raise InputError(f"{where} is not empty and not a run of strapbench (it holds {alien!r}): choose another")
        if force:
            return
        if "result.json" in found:
            raise InputError(f"{where} holds a finished run: choose another folder, or --force to overwrite it")
        try:
            started = json.loads((self.path / "inputs.json").read_text())
        except ValueError:
            raise InputError(f"{where} holds a run whose inputs.json is damaged: --force starts it anew") from None
        inputs = json.loads(json.dumps(inputs))  # a tuple comes back as a list
        if started != inputs:
            raise InputError(
                f"{where} holds an interrupted run with other inputs ({_difference(started, inputs)}): "
                "choose another folder, or --force to overwrite it"
            )

    def _clear(self) -> None:
        for name in MADE_HERE:
            target = self.path / name
            if target.is_dir():
                shutil.rmtree(target)
            else:
                target.unlink(missing_ok=True)

    def write(self, outcome: Outcome, *, record: bool, say: Callable[[str], None]) -> Outcome:
        """Write tables, figures, recording and report of an experiment; return the outcome with its files.

        Raises
        ------
        OutputError
            If a file cannot be written; what was written is kept.
        """
        from bench.report import blocks

        recorder = outcome.experiment.record

        def at(files: dict[str, Path]) -> Outcome:
            return replace(outcome, folder=self.path, files=files)

        content = Content(
            title=outcome.experiment.title,
            tables={**outcome.tables, "rows": outcome.rows},
            figures=outcome.evaluation.figures,
            record=None if recorder is None or not record else lambda path, files: recorder(at(files), path),
            report=lambda files: blocks(at(files)),
            result=lambda: _result(outcome),
        )
        return at(self.write_content(content, say=say))

    def write_content(self, content: "Content", *, say: Callable[[str], None]) -> dict[str, Path]:
        """Write tables, figures, recording and report, then result.json; return the files by kind.

        Raises
        ------
        OutputError
            If a file cannot be written; what was written is kept.
        """
        try:
            return self._write(content, say)
        except OSError as error:
            raise OutputError(
                f"out {str(self.path)!r} cannot be written: {error.strerror or error}; what was written is kept"
            ) from error

    def _write(self, content: "Content", say: Callable[[str], None]) -> dict[str, Path]:
        from bench.figures import draw
        from bench.report import html_report, markdown_report

        files: dict[str, Path] = {}
        for folder in ("tables", "figures"):
            (self.path / folder).mkdir(exist_ok=True)
        for name, table in content.tables.items():
            table.write_parquet(self.path / "tables" / f"{name}.parquet")
        say("Drawing the figures ...")
        for figure in content.figures:
            files[f"figure {figure.name}"] = path = self.path / "figures" / f"{figure.name}.png"
            with replacing(path) as temporary:
                draw(figure, temporary)
        if content.record is not None:
            say("Writing the recording ...")
            recording = self.path / "recording.rrd"
            content.record(recording, files)
            files["recording"] = recording
        report = content.report(files)
        for kind, text in (("report.md", markdown_report(report)), ("report.html", html_report(content.title, report))):
            files[kind] = self.path / kind
            with replacing(files[kind]) as temporary:
                temporary.write_text(text, encoding="utf-8")
        _write_json(self.path / "result.json", content.result())
        shutil.rmtree(self.parts, ignore_errors=True)
        return files


@dataclass(frozen=True, eq=False)
class Content:
    """What a finished run leaves in its folder.

    Attributes
    ----------
    title : str
        Of the report's page.
    tables : mapping of str to Table
        By file name.
    figures : sequence of Figure
    record : callable or None
        (path, files) -> None: writes the recording; the figures are among the files.
    report : callable
        (files) -> blocks of the report.
    result : callable
        () -> what result.json holds.
    """

    title: str
    tables: Mapping[str, Table]
    figures: Sequence[Figure]
    record: Callable[[Path, dict[str, Path]], None] | None
    report: "Callable[[dict[str, Path]], Sequence[Block]]"
    result: Callable[[], dict[str, Any]]


def _difference(a: dict[str, Any], b: dict[str, Any], prefix: str = "") -> str:
    words = []
    for key in sorted(a.keys() | b.keys()):
        x, y = a.get(key), b.get(key)
        if isinstance(x, dict) and isinstance(y, dict):
            words.append(_difference(x, y, f"{key}."))
        elif x != y:
            words.append(f"{prefix}{key} {x!r}, now {y!r}")
    return "; ".join(word for word in words if word)


def _result(outcome: Outcome) -> dict[str, Any]:
    experiment = outcome.experiment
    return {
        **outcome.inputs(),
        "versions": outcome.versions,
        "source": str(experiment.source),
        "conditions": [asdict(condition) for condition in experiment.conditions],
        "summary": outcome.evaluation.summary,
        "verdicts": [{**asdict(claim), **asdict(verdict)} for claim, verdict in outcome.verdicts],
    }


def _write_json(path: Path, data: dict[str, Any]) -> None:
    with replacing(path) as temporary:
        temporary.write_text(json.dumps(data, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
