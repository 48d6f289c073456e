"""An attitude run as a recording: triads that diverge from the truth, errors, figures and texts, with a layout."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import rerun.blueprint as rrb

from bench.errors import InputError, require_scalar
from bench.record._attitude_scene import Triads
from bench.record._attitude_traces import ANGLES, AttitudeEstimate, Plot, attitude_plots
from bench.record.layout import figure_tabs, layout, time_series
from bench.record.stream import entity_part, log_figures, log_texts, recording, rows_at, send_trace

__all__ = ["AttitudeEstimate", "AttitudeRun", "write_attitude_recording"]


@dataclass(frozen=True, eq=False)
class AttitudeRun:
    """What one recording of attitude algorithms shows.

    Attributes
    ----------
    title : str
    estimates : mapping of str to AttitudeEstimate
        By the name that is shown; the order gives the colours.
    configuration, results : str
        Markdown.
    parameters : mapping of str to str, float or int
        Shown in the viewer's table of recordings.
    exaggeration : float, optional
        Factor, >= 1, by which the drawn errors of all estimates are multiplied, stated in the view's title; the
        default turns the largest error into 20 to 50 degrees. A second view gives each estimate its own factor.
    model : mujoco.MjModel, optional
        The instrument, drawn at the true attitude.
    figures : mapping of str to Path
        PNG files, by title.

    Raises
    ------
    InputError
        If there is no estimate, the factor is below 1, or a figure is not a file.
    """

    title: str
    estimates: Mapping[str, AttitudeEstimate]
    configuration: str
    results: str
    parameters: Mapping[str, str | float | int] = field(default_factory=dict)
    exaggeration: float | None = None
    model: Any = None
    figures: Mapping[str, Path] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.estimates:
            raise InputError("estimates must not be empty")
        if self.exaggeration is not None:
            require_scalar("exaggeration", self.exaggeration, minimum=1.0)
        for title, path in self.figures.items():
            if not Path(path).is_file():
                raise InputError(f"figures[{title!r}] must be a file, got {str(path)!r}")


def write_attitude_recording(
    path: str | Path, run: AttitudeRun, *, plot_rate: float | None = 1000.0, pose_rate: float | None = 100.0
) -> Path:
    """Write one run, with its layout, to an ``.rrd`` file.

    Parameters
    ----------
    path : str or Path
        Written under a temporary name and renamed when complete: never half a file.
    run : AttitudeRun
    plot_rate, pose_rate : float, Hz, or None
        At most so many rows a second of plots, and of triads, per estimate; None writes all.

    Raises
    ------
    InputError
        If a rate is not positive.
    OutputError
        If the file cannot be written.
    """
    path = Path(path)
    names = {name: entity_part(name) for name in run.estimates}
    plots = attitude_plots(run.estimates, names)
    plot_rows = {name: rows_at(e.t, "plot_rate", plot_rate) for name, e in run.estimates.items()}
    pose_rows = {name: rows_at(e.t, "pose_rate", pose_rate) for name, e in run.estimates.items()}
    triads = Triads.of(run.estimates, run.model, run.exaggeration)
    with recording(path, run.title, run.parameters, _blueprint(run, triads, plots)) as rec:
        log_texts(rec, configuration=run.configuration, results=run.results)
        log_figures(rec, run.figures.values())
        triads.log(rec, pose_rows)
        # Drawn in alphabetical order: one line below another that coincides with it shows at its edges.
        widths = dict(zip(sorted(names, key=str.casefold), np.linspace(3.0, 1.2, len(names)), strict=True))
        for plot in plots.values():
            for name, line in zip(run.estimates, plot.lines, strict=True):
                send_trace(rec, run.estimates[name].t, line, plot_rows[name], widths[name])
    return path


def _blueprint(run: AttitudeRun, triads: Triads, plots: Mapping[str, Plot]) -> rrb.Blueprint:
    def views(*keys: str, legend: str = "") -> list[rrb.TimeSeriesView]:
        return [time_series(plots[key].overview, legend=key == legend) for key in keys]

    by_axis = [key for angle in ANGLES for key in (angle, f"largest_{angle}")]
    # The labels of the triads are the legend of the first tab.
    scene = rrb.Vertical(*triads.views()), rrb.Vertical(*views("rotation", "largest_yaw"))
    tabs = [
        rrb.Horizontal(*scene, column_shares=[3, 2], name="Scene"),
        rrb.Vertical(*views("rotation", legend="rotation"), name="Errors"),
        rrb.Grid(*views(*by_axis, legend="largest_pitch"), grid_columns=2, name="Errors by axis"),
    ]
    return layout([*tabs, *figure_tabs(run.figures)])
