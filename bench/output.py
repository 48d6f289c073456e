"""The folder of one run: refuses to overwrite, resumes what was interrupted, writes everything at the end.

inputs.json   what determines the result; written first
parts/        finished work items, until the run is complete
result.json   inputs, versions, verdicts; written last, so its presence means "finished"
report.md, report.html, tables/*.parquet, figures/*.png, recording.rrd
"""

import json
import shutil
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from bench.errors import InputError, OutputError
from bench.experiment import Outcome
from bench.table import replacing

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
        """Write tables, figures, recording and report, then result.json; return the outcome with its files.

        Raises
        ------
        OutputError
            If a file cannot be written; the finished parts are kept.
        """
        try:
            return self._write(outcome, record, say)
        except OSError as error:
            raise OutputError(
                f"out {str(self.path)!r} cannot be written: {error.strerror or error}; finished parts are kept"
            ) from error

    def _write(self, outcome: Outcome, record: bool, say: Callable[[str], None]) -> Outcome:
        from bench.figures import draw
        from bench.report import html_report, markdown_report

        files: dict[str, Path] = {}
        for folder in ("tables", "figures"):
            (self.path / folder).mkdir(exist_ok=True)
        for name, table in {**outcome.tables, "rows": outcome.rows}.items():
            table.write_parquet(self.path / "tables" / f"{name}.parquet")
        say("Drawing the figures ...")
        for figure in outcome.evaluation.figures:
            files[f"figure {figure.name}"] = path = self.path / "figures" / f"{figure.name}.png"
            with replacing(path) as temporary:
                draw(figure, temporary)
        outcome = replace(outcome, folder=self.path, files=files)
        if record and outcome.experiment.record is not None:
            say("Writing the recording ...")
            recording = self.path / "recording.rrd"
            outcome.experiment.record(outcome, recording)
            files["recording"] = recording
        for kind, text in (("report.md", markdown_report(outcome)), ("report.html", html_report(outcome))):
            files[kind] = self.path / kind
            with replacing(files[kind]) as temporary:
                temporary.write_text(text, encoding="utf-8")
        _write_json(self.path / "result.json", _result(outcome))
        shutil.rmtree(self.parts, ignore_errors=True)
        return outcome


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
