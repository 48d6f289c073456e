"""Figures: arrays and labels as frozen records, and one function that draws them with matplotlib."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.floating[Any]]

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Okabe and Ito's palette: distinct for colour-blind readers, and in grey.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#666666", "#000000")


@dataclass(frozen=True, eq=False)
class Line:
    """One curve, and the band around it if there is one."""

    label: str
    x: Values
    y: Values
    colour: int = 0
    style: str = "-"  # matplotlib line styles, or a marker: "o", "x", or "." for small ones
    low: Values | None = None
    high: Values | None = None
    note: str = ""  # written beside the middle of the curve


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes; labels carry the unit. `xticks` names the places 0, 1, 2, ... of a categorical axis."""

    xlabel: str
    ylabel: str
    lines: Sequence[Line]
    title: str = ""
    xscale: Literal["linear", "log"] = "linear"
    yscale: Literal["linear", "log"] = "linear"
    equal: bool = False
    xticks: Sequence[str] = ()


@dataclass(frozen=True, eq=False)
class HeatMap:
    """A map on a grid: one colour, and a few letters if there are any, for every cell.

    Attributes
    ----------
    columns, rows : sequence of str
        Labels of the cells, from the left and from the bottom; labels carry the unit in xlabel and ylabel.
    values : ndarray, shape (rows, columns)
        NaN leaves a cell grey.
    low, high : float
        Ends of the colour scale.
    text : ndarray of str, shape (rows, columns), optional
        Written into the cells.
    colour_label : str
        What the colours show; several maps with the same label and ends can be compared.
    """

    xlabel: str
    ylabel: str
    columns: Sequence[str]
    rows: Sequence[str]
    values: Values
    low: float
    high: float
    text: NDArray[np.str_] | None = None
    title: str = ""
    colour_label: str = ""


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
    panels: Sequence[Panel | HeatMap]
    columns: int = 3
    shared_legend: bool = False


def draw(figure: Figure, path: Path) -> None:
    """Draw a figure into a PNG file, without a display."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure as Canvas

    columns = min(figure.columns, len(figure.panels))
    rows = -(-len(figure.panels) // columns)
    width = max(4.6 * columns, 9.0)
    canvas = Canvas(figsize=(width, 3.6 * rows + 0.6 + 0.5 * figure.shared_legend), layout="constrained")
    FigureCanvasAgg(canvas)
    canvas.suptitle(figure.title, fontsize=12)
    for k, panel in enumerate(figure.panels):
        axes = canvas.add_subplot(rows, columns, k + 1)
        if isinstance(panel, HeatMap):
            _draw_map(axes, panel)
            continue
        _draw_panel(axes, panel)
        if any(line.label for line in panel.lines) and not figure.shared_legend:
            axes.legend(fontsize=8, loc="best")
    if figure.shared_legend:
        handles, labels = canvas.axes[0].get_legend_handles_labels()
        canvas.legend(handles, labels, fontsize=8, loc="outside lower center", ncols=4)
    canvas.savefig(path, dpi=130, format="png", metadata={"Software": None})


def _draw_panel(axes: "Axes", panel: Panel) -> None:
    from matplotlib.ticker import LogLocator, MaxNLocator

    for line in panel.lines:
        colour = COLOURS[line.colour % len(COLOURS)]
        marks = line.style in ("o", "x", ".")
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
        if line.note:
            middle = (line.x[len(line.x) // 2], line.y[len(line.y) // 2])
            axes.annotate(line.note, middle, (3, 3), textcoords="offset points", fontsize=7, color=colour)
        if line.low is not None and line.high is not None:
            axes.fill_between(np.asarray(line.x), line.low, line.high, color=colour, alpha=0.18, linewidth=0)
    for axis, scale in ((axes.xaxis, panel.xscale), (axes.yaxis, panel.yscale)):
        if scale == "log":
            axis.axes.set(**{f"{axis.axis_name}scale": "log"})
            low, high = axis.get_view_interval()
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 1e3 * low else (1.0,)))
            axis.set_major_formatter(lambda value, _: f"{value:g}")
            axis.set_minor_formatter("")
        else:
            axis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))  # long numbers stay apart
    axes.set(xlabel=panel.xlabel, ylabel=panel.ylabel)
    axes.set_title(panel.title, fontsize=10)
    axes.grid(True, alpha=0.3)
    if panel.xticks:
        axes.set_xticks(range(len(panel.xticks)), panel.xticks, fontsize=8)
    if panel.equal:
        axes.set_aspect("equal", adjustable="datalim")


def _draw_map(axes: "Axes", panel: HeatMap) -> None:
    image = axes.imshow(panel.values, cmap="viridis", vmin=panel.low, vmax=panel.high, origin="lower", aspect="auto")
    axes.set_facecolor("#cccccc")
    axes.figure.colorbar(image, ax=axes, label=panel.colour_label, extend="both", pad=0.01)
    axes.set(xlabel=panel.xlabel, ylabel=panel.ylabel)
    axes.set_title(panel.title, fontsize=10)
    axes.set_xticks(range(len(panel.columns)), panel.columns, fontsize=7, rotation=90 if len(panel.columns) > 9 else 0)
    axes.set_yticks(range(len(panel.rows)), panel.rows, fontsize=7)
    if panel.text is None:
        return
    middle = 0.5 * (panel.low + panel.high)
    for (row, column), text in np.ndenumerate(panel.text):
        colour = "black" if not panel.values[row, column] < middle else "white"
        axes.text(column, row, text, ha="center", va="center", fontsize=6, color=colour)
