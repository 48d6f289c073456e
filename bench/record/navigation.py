"""A navigation run as a recording: tracks on a map and in space, attitude, errors, motion and texts, with a layout."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import rerun.blueprint as rrb

from bench.errors import InputError, require_integer
from bench.record._attitude_scene import Triads
from bench.record._attitude_traces import AttitudeEstimate
from bench.record._navigation_scene import Tracks
from bench.record._navigation_traces import NavigationEstimate, TimedPlot, navigation_plots, thinned
from bench.record.layout import figure_tabs, layout, time_series
from bench.record.stream import entity_part, log_figures, log_texts, recording, send_trace
from bench.record.traces import estimate_colours
from bench.rotation import quat_from_rotvec, quat_multiply, quat_normalize
from bench.trajectory import Trajectory

__all__ = ["NavigationEstimate", "NavigationRun", "write_navigation_recording"]


@dataclass(frozen=True, eq=False)
class NavigationRun:
    """What one recording of navigation algorithms shows.

    Attributes
    ----------
    title : str
    estimates : mapping of str to NavigationEstimate
        By the name that is shown; the order gives the colours.
    configuration, results : str
        Markdown.
    truth : Trajectory, optional
        Drawn as the true track, velocity and attitude; None for a recording without reference.
    truth_name : str
        What it is called; a reference is not the truth.
    parameters : mapping of str to str, float or int
        Shown in the viewer's table of recordings.
    exaggeration : float, optional
        Factor of the drawn attitude errors, as in `AttitudeRun`.
    attitude_only : bool
        The estimates know neither velocity nor position: no tracks, and of errors only those of attitude.
    figures : mapping of str to Path
        PNG files, by title.
    pages : mapping of str to sequence of TimedPlot
        Further plots, a tab each, by title.

    Raises
    ------
    InputError
        If there is no estimate, one has the name of the truth, or a figure is not a file.
    """

    title: str
    estimates: Mapping[str, NavigationEstimate]
    configuration: str
    results: str
    truth: Trajectory | None = None
    truth_name: str = "true"
    parameters: Mapping[str, str | float | int] = field(default_factory=dict)
    exaggeration: float | None = None
    attitude_only: bool = False
    figures: Mapping[str, Path] = field(default_factory=dict)
    pages: Mapping[str, Sequence[TimedPlot]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.estimates:
            raise InputError("estimates must not be empty")
        if self.truth is not None and self.truth_name in self.estimates:
            raise InputError(f"estimates must not have the name of the truth, {self.truth_name!r}")
        for title, path in self.figures.items():
            if not Path(path).is_file():
                raise InputError(f"figures[{title!r}] must be a file, got {str(path)!r}")


def write_navigation_recording(
    path: str | Path, run: NavigationRun, *, plot_rows: int | None = 50_000, pose_rows: int | None = 10_000
) -> Path:
    """Write one run, with its layout, to an ``.rrd`` file.

    Parameters
    ----------
    path : str or Path
        Written under a temporary name and renamed when complete: never half a file.
    run : NavigationRun
    plot_rows, pose_rows : int or None
        At most so many rows of plots, and of poses, per estimate, evenly chosen; None writes all. Rows and not a
        rate, because one run lasts ten seconds and another ten hours.

    Raises
    ------
    InputError
        If a number of rows is not positive.
    OutputError
        If the file cannot be written.
    """
    path = Path(path)
    for name, count in (("plot_rows", plot_rows), ("pose_rows", pose_rows)):
        if count is not None:
            require_integer(name, count, minimum=1)
    parts = {name: entity_part(name) for name in run.estimates}
    colours = estimate_colours(run.estimates)
    pages: dict[str, Sequence[TimedPlot]] = {
        **navigation_plots(run.truth, run.estimates, parts, colours, attitude_only=run.attitude_only),
        **run.pages,
    }
    found = {name: estimate.trajectory for name, estimate in run.estimates.items()}
    tracks = Tracks.of(run.truth, found, run.truth_name)
    judged = _attitudes(run)
    triads = Triads.of(judged, None, run.exaggeration) if judged else None
    with recording(path, run.title, run.parameters, _blueprint(run, tracks, triads, pages)) as rec:
        log_texts(rec, configuration=run.configuration, results=run.results)
        log_figures(rec, run.figures.values())
        tracks.log_attitudes(rec, pose_rows)
        if not run.attitude_only:
            tracks.log_places(rec, pose_rows)
        if triads is not None:
            triads.log(rec, {name: thinned(e.t, pose_rows) for name, e in judged.items()})
        # Drawn in alphabetical order: one line below another that coincides with it shows at its edges.
        widths = dict(zip(sorted(parts, key=str.casefold), np.linspace(2.2, 1.0, len(parts)), strict=True))
        for t, line in (line for plots in pages.values() for plot in plots for line in plot.lines):
            send_trace(rec, t, line, thinned(t, plot_rows), widths.get(line.series[0], 1.3))
    return path


def _attitudes(run: NavigationRun) -> dict[str, AttitudeEstimate]:
    """Return the attitudes of the judged estimates in the true n, so that errors of position do not turn them."""
    found = {}
    for name, estimate in run.estimates.items():
        if estimate.truth is not None and estimate.errors is not None:
            q_true = estimate.truth.q_nb
            turn = quat_from_rotvec(estimate.errors.attitude)
            q = quat_normalize(quat_multiply(turn, q_true))
            found[name] = AttitudeEstimate(estimate.truth.t, q, q_true)
    return found


def _blueprint(
    run: NavigationRun, tracks: Tracks, triads: Triads | None, pages: Mapping[str, Sequence[TimedPlot]]
) -> rrb.Blueprint:
    times = [estimate.trajectory.t for estimate in run.estimates.values()]
    start, end = min(t[0] for t in times), max(t[-1] for t in times)

    def views(page: str, first: int = 0) -> list[rrb.TimeSeriesView]:
        # A little beyond the end, where the time cursor stands.
        span, plots = (start, end + 0.02 * (end - start)), pages[page][first:]
        # One legend a page, and one more where lines are not those of its first plot.
        named = set(plots[0].overview.series)
        return [
            time_series(p.overview, legend=k == 0 or not named.issuperset(p.overview.series), span=span)
            for k, p in enumerate(plots)
        ]

    beside = views("Errors") if "Errors" in pages else views("Motion", 0 if run.attitude_only else 6)
    side = rrb.Vertical(tracks.attitude_view(), *beside, row_shares=[1.6, *([1] * len(beside))])
    if run.attitude_only:
        tabs: list[Any] = [rrb.Vertical(side, name="Scene")]
    else:
        tabs = [rrb.Horizontal(tracks.view(), side, column_shares=[3, 2], name="Scene")]
        tabs.append(rrb.Vertical(tracks.map(), name="Map"))
    if triads is not None:
        tabs.append(rrb.Vertical(*views("Errors"), name="Errors"))
        columns = len(views("Errors"))
        tabs.append(rrb.Grid(*views("Errors by axis"), grid_columns=columns, name="Errors by axis"))
        tabs.append(rrb.Vertical(*triads.views(), name="Attitude errors"))
    tabs.append(rrb.Grid(*views("Motion"), grid_columns=1 if run.attitude_only else 2, name="Motion"))
    tabs += [rrb.Grid(*views(page), grid_columns=min(3, len(pages[page])), name=page) for page in run.pages]
    return layout([*tabs, *figure_tabs(run.figures)])
