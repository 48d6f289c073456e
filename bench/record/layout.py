"""The parts of a layout that every kind of recording shares: tabs, plots and texts."""

from collections.abc import Iterable
from typing import Any

import rerun.blueprint as rrb

from bench.record.traces import TIMELINE, Trace


def layout(tabs: Iterable[Any]) -> rrb.Blueprint:
    """Return the layout of some tabs, followed by the texts; panels collapsed, at the end of the run."""
    texts = (rrb.TextDocumentView(origin=name.lower(), name=name) for name in ("Results", "Configuration"))
    return rrb.Blueprint(
        rrb.Tabs(*tabs, *texts, active_tab=0),
        # Following shows the end, where errors are largest, and stands still there.
        rrb.TimePanel(timeline=TIMELINE, play_state="following", state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
    )


def figure_tabs(titles: Iterable[str]) -> list[rrb.Tabs]:
    """Return the tab of the figures that ``bench.record.stream.log_figures`` logged; none without figures."""
    views = [rrb.Spatial2DView(origin=f"/figures/{k}", name=title) for k, title in enumerate(titles)]
    return [rrb.Tabs(*views, name="Figures")] if views else []


def time_series(
    trace: Trace,
    *,
    legend: bool = True,
    span: tuple[float, float] | None = None,
    extent: tuple[float, float] | None = None,
) -> rrb.TimeSeriesView:
    """Return the plot of everything at and below the entity of a trace, scaled for its values.

    It shows the times from `span[0]` to `span[1]`, s; without a span, the minute round the time cursor. It shows the
    values from `extent[0]` to `extent[1]`; without an extent, all of them.
    """
    if extent is None and trace.logarithmic:
        extent = trace.display_range()
    return rrb.TimeSeriesView(
        axis_x=None if span is None else rrb.TimeAxis(view_range=_time_range(*span)),
        origin=f"/{trace.entity}",
        name=trace.title,
        axis_y=None if extent is None else rrb.ScalarAxis(range=extent),
        plot_legend=rrb.PlotLegend(rrb.Corner2D[trace.empty_corner()], visible=legend),
    )


def _time_range(start: float, end: float) -> rrb.TimeRange:
    first, last = (rrb.TimeRangeBoundary.absolute(seconds=t) for t in (start, end))
    return rrb.TimeRange(start=first, end=last)


def eye(position: Any, target: Any = (0, 0, 0)) -> rrb.EyeControls3D:
    """Return an eye that orbits round its target, z up."""
    return rrb.EyeControls3D(kind=rrb.Eye3DKind.Orbital, position=position, look_target=target, eye_up=(0, 0, 1))
