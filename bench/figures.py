"""Figures: arrays and labels as frozen records, and one function that draws them. The only file that imports matplotlib."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from bench.errors import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Okabe and Ito's palette: distinct for colour-blind readers, and in grey.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#666666")


@dataclass(frozen=True, eq=False)
class Line:
    """One curve, and the band around it if there is one."""

    label: str
    x: Array
    y: Array
    colour: int = 0
    style: Literal["-", "--", ":", "o", "x"] = "-"
    low: Array | None = None
    high: Array | None = None


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes; labels carry the unit."""

    xlabel: str
    ylabel: str
    lines: Sequence[Line]
    title: str = ""
    xscale: Literal["linear", "log"] = "linear"
    yscale: Literal["linear", "log", "symlog"] = "linear"
    equal: bool = False


@dataclass(frozen=True, eq=False)
class Figure:
    """Panels side by side, `columns` in a row.

    Attributes
    ----------
    name : str
        File name without extension.
    caption : str
        What is seen, under which conditions; Markdown.
    """

    name: str
    title: str
    caption: str
    panels: Sequence[Panel]
    columns: int = 3


def draw(figure: Figure, path: Path) -> None:
    """Draw a figure into a PNG file, without a display."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure as Canvas

    rows = -(-len(figure.panels) // figure.columns)
    canvas = Canvas(figsize=(4.6 * min(figure.columns, len(figure.panels)), 3.6 * rows + 0.6), layout="constrained")
    FigureCanvasAgg(canvas)
    canvas.suptitle(figure.title, fontsize=12)
    for k, panel in enumerate(figure.panels):
        axes = canvas.add_subplot(rows, min(figure.columns, len(figure.panels)), k + 1)
        _draw_panel(axes, panel)
    canvas.savefig(path, dpi=130, format="png", metadata={"Software": None})


def _draw_panel(axes: "Axes", panel: Panel) -> None:
    for line in panel.lines:
        colour = COLOURS[line.colour % len(COLOURS)]
        marks = line.style in ("o", "x")
        axes.plot(
            line.x,
            line.y,
            label=line.label or None,
            color=colour,
            linestyle="none" if marks else line.style,
            marker=line.style if marks else None,
            markersize=6,
            linewidth=1.3,
        )
        if line.low is not None and line.high is not None:
            axes.fill_between(np.asarray(line.x), line.low, line.high, color=colour, alpha=0.18, linewidth=0)
    axes.set_xscale(panel.xscale)
    if panel.yscale == "symlog":
        axes.set_yscale("symlog", linthresh=1e-3)
    else:
        axes.set_yscale(panel.yscale)
    axes.set(xlabel=panel.xlabel, ylabel=panel.ylabel)
    axes.set_title(panel.title, fontsize=10)
    axes.grid(True, alpha=0.3)
    if panel.equal:
        axes.set_aspect("equal", adjustable="datalim")
    if any(line.label for line in panel.lines):
        axes.legend(fontsize=8, loc="best")
