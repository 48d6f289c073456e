"""Reports: the published | measured | verdict tables, in Markdown and in self-contained HTML.

A report is a list of blocks; each format renders the same blocks.
"""

import base64
import html
import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from bench.experiment import Outcome
from bench.table import Table


@dataclass(frozen=True)
class Heading:
    """A heading; level 1 is the title."""

    text: str
    level: int = 2


@dataclass(frozen=True)
class Image:
    """A picture in the run's folder."""

    path: Path
    caption: str


Block = Heading | Image | Table | str

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
table { border-collapse: collapse; margin: 1rem 0; font-size: 0.86rem; display: block; overflow-x: auto; }
th, td { border: 1px solid #ccc; padding: 0.3rem 0.6rem; text-align: left; vertical-align: top; }
th { background: #f2f4f7; } td { font-variant-numeric: tabular-nums; }
.holds { background: #e2f4e6; } .does-not-hold { background: #fbe3e0; } .cannot-be-judged { background: #fdf3d3; }
img { max-width: 100%; } figcaption { color: #555; font-size: 0.9rem; } code { background: #f2f4f7; }
"""


def verdict_table(outcome: Outcome, *, reasons: bool = True) -> Table:
    """Return published against measured, with verdicts; without reasons verdicts come first, places are left out."""
    columns = {
        "claim": [claim.key for claim, _ in outcome.verdicts],
        "where": [claim.place for claim, _ in outcome.verdicts],
        "published": [claim.published for claim, _ in outcome.verdicts],
        "measured": [verdict.measured for _, verdict in outcome.verdicts],
        "verdict": [verdict.judgement for _, verdict in outcome.verdicts],
        "reason": [verdict.reason for _, verdict in outcome.verdicts],
    }
    chosen = list(columns) if reasons else ["claim", "verdict", "published", "measured"]
    return Table({name: np.array(columns[name]) for name in chosen}, "Published against measured")


def condition_table(outcome: Outcome) -> Table:
    """Return the conditions, stated and assumed."""
    return Table.from_rows(
        ("condition", "value", "status", "note"),
        [(c.name, c.value, c.status, c.note) for c in outcome.experiment.conditions],
        "Conditions",
    )


def condition_text(outcome: Outcome) -> str:
    """Return by which options a run differs from the conditions."""
    default = asdict(outcome.experiment.options())
    changed = [
        f"`{name}` is {value}, by default {default[name]}"
        for name, value in asdict(outcome.options).items()
        if value != default[name]
    ]
    return "At these conditions claims are judged." + (f" **In this run** {'; '.join(changed)}." if changed else "")


def results_markdown(outcome: Outcome) -> str:
    """Return summary and verdicts, as recordings show them."""
    table = verdict_table(outcome, reasons=False)
    return f"# Results\n\n{outcome.evaluation.summary}\n\n{table.markdown()}"


def configuration_markdown(outcome: Outcome, shown: str) -> str:
    """Return title, what is shown, and the conditions, as recordings show them."""
    parts = f"# {outcome.experiment.title}", shown, condition_text(outcome), condition_table(outcome).markdown()
    return "\n\n".join(parts)


def figure_files(outcome: Outcome, recording: Path) -> dict[str, Path]:
    """Return the figures that were drawn beside a recording, by title."""
    folder = recording.parent / "figures"
    drawn = {figure.title: folder / f"{figure.name}.png" for figure in outcome.evaluation.figures}
    return {title: file for title, file in drawn.items() if file.is_file()}


def blocks(outcome: Outcome) -> list[Block]:
    """Return the report, independent of the format."""
    experiment = outcome.experiment
    rules = Table.from_rows(("claim", "judged by"), [(c.key, c.judged_by) for c in experiment.claims], "Rules")
    inputs = {**outcome.inputs()["options"], "seed": outcome.seed}
    content: list[Block] = [
        Heading(experiment.title, 1),
        f"Source: {experiment.source}.",
        outcome.evaluation.summary,
        Heading("Published against measured"),
        verdict_table(outcome),
        Heading("Figures"),
    ]
    for figure in outcome.evaluation.figures:
        content.append(Image(outcome.files[f"figure {figure.name}"], figure.caption))
    content.append(Heading("Tables"))
    for table in outcome.tables.values():
        content += [Heading(table.title, 3), table]
    return [
        *content,
        Heading("Conditions"),
        condition_text(outcome),
        condition_table(outcome),
        Heading("How each claim is judged"),
        rules,
        Heading("Inputs and versions"),
        Table.from_rows(("option", "value"), [(k, str(v)) for k, v in inputs.items()], "Inputs"),
        Table.from_rows(("package", "version"), list(outcome.versions.items()), "Versions"),
    ]


def markdown_report(content: Sequence[Block]) -> str:
    """Return a report as Markdown; pictures by relative path."""

    def render(block: Block) -> str:
        match block:
            case Heading():
                return f"{'#' * block.level} {block.text}"
            case Image():
                return f"![{block.path.stem}](figures/{block.path.name})\n\n{block.caption}"
            case Table():
                return block.markdown()
            case _:
                return block

    return "\n\n".join(render(block) for block in content) + "\n"


def html_report(title: str, content: Sequence[Block]) -> str:
    """Return a report as one HTML page that needs no other file."""
    body = "\n".join(_html(block) for block in content)
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title>'
        f"<style>{STYLE}</style></head>\n<body>\n{body}\n</body></html>\n"
    )


def _html(block: Block) -> str:
    match block:
        case Heading():
            return f"<h{block.level}>{_inline(block.text)}</h{block.level}>"
        case Image():
            data = base64.b64encode(block.path.read_bytes()).decode()
            picture = f'<img alt="{html.escape(block.path.stem)}" src="data:image/png;base64,{data}">'
            return f"<figure>{picture}<figcaption>{_inline(block.caption)}</figcaption></figure>"
        case Table():
            head = "".join(f"<th>{_inline(name)}</th>" for name in block.columns)
            rows = "\n".join(f"<tr>{''.join(_cell(text) for text in row)}</tr>" for row in block.cells())
            return f"<table><thead><tr>{head}</tr></thead><tbody>\n{rows}\n</tbody></table>"
        case _:
            return "\n".join(f"<p>{_inline(text)}</p>" for text in block.split("\n\n"))


def _cell(text: str) -> str:
    verdict = text in ("holds", "does not hold", "cannot be judged")
    mark = f' class="{text.replace(" ", "-")}"' if verdict else ""
    return f"<td{mark}>{_inline(text)}</td>"


def _inline(text: str) -> str:
    """Escape, and render the little Markdown that captions and summaries use: `code`, **bold**, *emphasis*."""
    text = html.escape(text)
    text = re.sub(r"`([^`]+)`", r"<code>\1</code>", text)
    text = re.sub(r"\*\*([^*]+)\*\*", r"<strong>\1</strong>", text)
    return re.sub(r"(?<!\*)\*([^*\s][^*]*)\*(?!\*)", r"<em>\1</em>", text)
