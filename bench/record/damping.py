"""A run of damping filters as a recording: errors with 3-sigma bands, fusion weights, and tracks on a map."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from bench.errors import Array, InputError, require_array
from bench.record._damping_traces import UNDAMPED, Plot, navigation_plots, sensor_plots, weight_plots
from bench.record.layout import figure_tabs, layout, time_series
from bench.record.stream import entity_part, log_figures, log_texts, recording, send, send_tag, send_trace
from bench.record.traces import TRUTH_COLOUR, Colour, estimate_colours

TRUE = "true"
EARTH_RADIUS = 6371.0  # km, of the drawn tracks


@dataclass(frozen=True, eq=False)
class Estimate:
    """What is left in the INS that one filter corrects.

    Attributes
    ----------
    errors : ndarray, shape (n, k)
        True less estimated error states, SI, in the order of ``bench.solvers.damping.STATES``.
    sigma : ndarray, shape (n, k)
        Standard deviations that the filter claims; no columns for an INS without a filter.
    place : ndarray, shape (n, 2), deg
        Latitude and longitude of the corrected INS.
    """

    errors: Array
    sigma: Array
    place: Array


@dataclass(frozen=True, eq=False)
class DampingRun:
    """What one recording of damping filters shows.

    Attributes
    ----------
    title : str
    t : ndarray, shape (n,), s
    estimates : mapping of str to Estimate
        By the name that is shown; the order gives the colours.
    undamped : Estimate
        The free INS.
    true_place : ndarray, shape (n, 2), deg
    gamma : ndarray, shape (n,)
        Of the fusion.
    weight : ndarray, shape (n, k)
        Share of filter 1 in each fused state.
    configuration, results : str
        Markdown.
    parameters : mapping of str to str, float or int
    figures : mapping of str to Path
        PNG files, by title.

    Raises
    ------
    InputError
        If there is no estimate, or lengths differ.
    """

    title: str
    t: Array
    estimates: Mapping[str, Estimate]
    undamped: Estimate
    true_place: Array
    gamma: Array
    weight: Array
    configuration: str
    results: str
    parameters: Mapping[str, str | float | int] = field(default_factory=dict)
    figures: Mapping[str, Path] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.estimates:
            raise InputError("estimates must not be empty")
        n = len(self.t)
        require_array("true_place", self.true_place, (n, 2))
        require_array("gamma", self.gamma, (n,))
        require_array("weight", self.weight, (n, None))
        for name, estimate in {**self.estimates, UNDAMPED: self.undamped}.items():
            for part in ("errors", "sigma") if name in self.estimates else ("errors",):
                require_array(f"{part} of {name}", getattr(estimate, part), (n, None))
            require_array(f"place of {name}", estimate.place, (n, 2))

    @property
    def shown(self) -> dict[str, Array]:
        """Places by name, the true one last."""
        places = {name: estimate.place for name, estimate in self.estimates.items()}
        return {UNDAMPED: self.undamped.place, **places, TRUE: self.true_place}

    @property
    def colours(self) -> dict[str, Colour]:
        """Colour of every name."""
        return {**estimate_colours({**self.estimates, UNDAMPED: None}), TRUE: TRUTH_COLOUR}


def write_damping_recording(path: str | Path, run: DampingRun) -> Path:
    """Write one run, with its layout, to an ``.rrd`` file.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    path = Path(path)
    estimates = {name: (estimate.errors, estimate.sigma) for name, estimate in run.estimates.items()}
    pages = {
        "Errors": navigation_plots(estimates, run.undamped.errors, run.colours),
        "Sensor errors": sensor_plots(estimates, run.colours),
        "Fusion": weight_plots(run.weight, run.gamma),
    }
    with recording(path, run.title, run.parameters, _blueprint(run, pages)) as rec:
        log_texts(rec, configuration=run.configuration, results=run.results)
        log_figures(rec, run.figures.values())
        _log_tracks(rec, run)
        for plot in (plot for plots in pages.values() for plot in plots):
            for trace, width in plot.lines:
                send_trace(rec, run.t, trace, slice(None), width)
    return path


def _log_tracks(rec: rr.RecordingStream, run: DampingRun) -> None:
    """Log places on the map, and tracks as they part from the true one: km east and north of it over its own length."""
    rec.log("track", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for name, place in run.shown.items():
        part, colour = entity_part(name), run.colours[name]
        width = rr.Radius.ui_points(3.0 if name == TRUE else 1.5)
        rec.log(f"map/paths/{part}", rr.GeoLineStrings(lat_lon=[place], colors=colour, radii=width), static=True)
        look = rr.GeoPoints.from_fields(radii=rr.Radius.ui_points(5.0), colors=colour)
        rec.log(f"map/now/{part}", look, static=True)
        send(rec, f"map/now/{part}", run.t, lambda k, place=place: rr.GeoPoints.columns(positions=place[k]))  # type: ignore[misc]
        flat = _offset(place, run.true_place)
        line = rr.LineStrips3D([flat], colors=colour, radii=width)
        rec.log(f"track/paths/{part}", line, static=True)
        send_tag(rec, f"track/tags/{part}", run.t, flat, name, colour)


def _offset(place: Array, true: Array) -> Array:
    """Return places relative to the true ones, km east and north."""
    apart = np.deg2rad(place - true) * EARTH_RADIUS
    return np.stack([apart[:, 1] * np.cos(np.deg2rad(true[:, 0])), apart[:, 0], np.zeros(len(apart))], axis=1)


def _blueprint(run: DampingRun, pages: Mapping[str, list[Plot]]) -> rrb.Blueprint:
    start, end = float(run.t[0]), float(run.t[-1])

    def views(page: str) -> list[rrb.TimeSeriesView]:
        span = start, end + 0.02 * (end - start)
        return [
            time_series(plot.overview, legend=k == 0 or page == "Fusion", span=span, extent=plot.extent)
            for k, plot in enumerate(pages[page])
        ]

    track = rrb.Spatial3DView(
        origin="/track",
        name="Position relative to the ship, km east (right) and north (up)",
        eye_controls=_above(run),
        line_grid=rrb.LineGrid3D(visible=True, spacing=5.0),
    )
    position = views("Errors")[:4]
    scene = rrb.Horizontal(track, rrb.Vertical(*position), column_shares=[2, 3], name="Scene")
    tabs: list[Any] = [
        scene,
        rrb.Vertical(rrb.MapView(origin="/map", name="Map (background needs a network)", zoom=_zoom(run)), name="Map"),
        rrb.Grid(*views("Errors"), grid_columns=2, name="Errors"),
        rrb.Grid(*views("Sensor errors"), grid_columns=2, name="Sensor errors"),
        rrb.Vertical(*views("Fusion"), name="Fusion"),
    ]
    return layout([*tabs, *figure_tabs(run.figures)])


def _zoom(run: DampingRun) -> float:
    """Return the zoom of the map at which all of the true track is seen, in a view 800 pixels high."""
    span = float(np.ptp(run.true_place, axis=0).max())
    return float(np.clip(np.log2(360 / 256 * 640 / max(span, 1e-3)), 2, 16))


def _above(run: DampingRun) -> rrb.EyeControls3D:
    """Return an eye that looks down on all tracks, north up."""
    points = np.concatenate([_offset(place, run.true_place) for place in run.shown.values()])
    low, high = points.min(axis=0), points.max(axis=0)
    centre, size = 0.5 * (low + high), max(float((high - low).max()), 0.1)
    position = centre + np.array([0.0, -0.01 * size, 1.8 * size])
    return rrb.EyeControls3D(kind=rrb.Eye3DKind.Orbital, position=position, look_target=centre, eye_up=(0, 1, 0))
