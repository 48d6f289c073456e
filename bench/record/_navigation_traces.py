"""The plots of a navigation run: errors of every estimate, and velocity, height and angles; knows no viewer."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bench.errors import Array, InputError
from bench.record.traces import FLOOR, TRUTH_COLOUR, Colour, Trace
from bench.rotation import euler_from_quat
from bench.trajectory import NavigationErrors, Trajectory, navigation_errors
from bench.units import ARCSEC, DEG

LOWEST = float(np.log10(FLOOR))
OVERVIEW = 500  # rows from which range and legend of a plot follow
TRUTH = "0_truth"  # its entity: drawn first, below the estimates that coincide with it
DIRECTIONS = ("east", "north", "up")

Line = tuple[Array, Array]  # times and values, shape (n,) each
Kind = tuple[str, str, float]  # of error: key, unit, the unit in SI


@dataclass(frozen=True, eq=False)
class NavigationEstimate:
    """What one algorithm found, and what it is judged by.

    Attributes
    ----------
    trajectory : Trajectory
        At the algorithm's own times.
    truth : Trajectory, optional
        What it is compared with; without it there are no errors.
    sampled : Trajectory, optional
        The estimate at the times of `truth`; the default is `trajectory` itself.

    Raises
    ------
    InputError
        If `sampled` comes without `truth`, or lengths or times of what is compared differ.
    """

    trajectory: Trajectory
    truth: Trajectory | None = None
    sampled: Trajectory | None = None

    def __post_init__(self) -> None:
        if self.truth is None and self.sampled is not None:
            raise InputError("sampled must come with the truth at the same times, got truth None")
        _ = self.errors

    @cached_property
    def errors(self) -> NavigationErrors | None:
        """Estimate minus truth, in the true n; None without truth."""
        return None if self.truth is None else navigation_errors(self.sampled or self.trajectory, self.truth)


@dataclass(frozen=True, eq=False)
class TimedPlot:
    """Lines with their own times in one pair of axes.

    Attributes
    ----------
    overview : Trace
        All lines at a few of their rows: gives the place, the title, the range and the legend's corner.
    lines : tuple of (ndarray, Trace)
        Times, s, and the line, stored below the overview's entity.
    """

    overview: Trace
    lines: tuple[tuple[Array, Trace], ...]


@dataclass(frozen=True)
class _Pen:
    """Names and colours of lines: what every plot of a run shares."""

    parts: Mapping[str, str]
    colours: Mapping[str, Colour]

    def plot(self, entity: str, title: str, lines: Mapping[str, Line], *, logarithmic: bool = False) -> TimedPlot:
        def trace(name: str, values: Array) -> Trace:
            return Trace(
                f"{entity}/{self.parts[name]}", title, (name,), (self.colours[name],), values[:, None], logarithmic
            )

        few = [values[np.linspace(0, len(values) - 1, OVERVIEW).astype(int)] for _, values in lines.values()]
        shown = np.stack(few, axis=1)
        if logarithmic:  # estimates begin at the truth: an error of zero says nothing of the range
            shown = np.where(shown > LOWEST, shown, min(shown[shown > LOWEST], default=LOWEST))
        colours = tuple(self.colours[name] for name in lines)
        overview = Trace(entity, title, tuple(lines), colours, shown, logarithmic)
        return TimedPlot(overview, tuple((t, trace(name, values)) for name, (t, values) in lines.items()))


def navigation_plots(
    truth: Trajectory | None,
    estimates: Mapping[str, NavigationEstimate],
    parts: Mapping[str, str],
    colours: Mapping[str, Colour],
    *,
    truth_name: str = "true",
    attitude_only: bool = False,
) -> dict[str, list[TimedPlot]]:
    """Return the plots of every page, by the page's name.

    Parameters
    ----------
    truth : Trajectory or None
        Drawn beside the estimates.
    estimates : mapping of str to NavigationEstimate
    parts, colours : mapping of str
        Entity name and colour of every estimate.
    truth_name : str
        What the truth is called.
    attitude_only : bool
        The estimates know neither velocity nor position.

    Returns
    -------
    dict of str to list of TimedPlot
        ``Errors`` and ``Errors by axis`` if an estimate has errors (rows east, north, up; columns position,
        velocity, attitude); ``Motion`` (velocity and height beside the angles, for a grid of two columns).
    """
    pen = _Pen({**parts, truth_name: TRUTH}, {**colours, truth_name: TRUTH_COLOUR})
    errors = {name: estimate.errors for name, estimate in estimates.items() if estimate.errors is not None}
    kinds = _kinds(errors)[2 if attitude_only else 0 :] if errors else []
    pages = {"Errors": _sizes(pen, errors, kinds), "Errors by axis": _by_axis(pen, errors, kinds)} if errors else {}
    shown = {name: estimate.trajectory for name, estimate in estimates.items()}
    shown = shown if truth is None else {**shown, truth_name: truth}
    angles = _angles(pen, shown)
    if attitude_only:
        return {**pages, "Motion": angles}
    columns = zip(_velocities(pen, shown), [*angles, _speed(pen, shown)], strict=True)
    return {**pages, "Motion": [plot for row in columns for plot in row]}


def _kinds(errors: Mapping[str, NavigationErrors]) -> list[Kind]:
    """Return key, unit and scale of the three kinds; angles in degrees where arcseconds would be long numbers."""
    coarse = max(np.linalg.norm(e.attitude, axis=1).max() for e in errors.values()) > 0.2 * DEG
    angle = ("attitude", "deg", DEG) if coarse else ("attitude", "arcsec", ARCSEC)
    return [("position", "m", 1.0), ("velocity", "m/s", 1.0), angle]


def _sizes(pen: _Pen, errors: Mapping[str, NavigationErrors], kinds: Sequence[Kind]) -> list[TimedPlot]:
    plots = []
    for key, unit, scale in kinds:
        lines = {name: (e.t, _log10(np.linalg.norm(getattr(e, key), axis=1) / scale)) for name, e in errors.items()}
        plots.append(pen.plot(f"error/{key}", f"log10 of {key} error, {unit}", lines, logarithmic=True))
    return plots


def _log10(error: Array) -> Array:
    return np.log10(np.maximum(error, FLOOR))


def _by_axis(pen: _Pen, errors: Mapping[str, NavigationErrors], kinds: Sequence[Kind]) -> list[TimedPlot]:
    plots = []
    for axis, direction in enumerate(DIRECTIONS):
        for key, unit, scale in kinds:
            lines = {name: (e.t, getattr(e, key)[:, axis] / scale) for name, e in errors.items()}
            about = "about" if key == "attitude" else "to"
            title = f"{key.capitalize()} error {about} {direction}, {unit}"
            plots.append(pen.plot(f"error_by_axis/{key}_{direction}", title, lines))
    return plots


def _velocities(pen: _Pen, shown: Mapping[str, Trajectory]) -> list[TimedPlot]:
    """Return the three velocities and the height."""
    plots = []
    for k, direction in enumerate(DIRECTIONS):
        lines = {name: (track.t, track.v_n[:, k]) for name, track in shown.items()}
        plots.append(pen.plot(f"motion/velocity_{direction}", f"Velocity to {direction}, m/s", lines))
    heights = {name: (track.t, track.height) for name, track in shown.items()}
    return [*plots, pen.plot("motion/height", "Height, m", heights)]


def _speed(pen: _Pen, shown: Mapping[str, Trajectory]) -> TimedPlot:
    lines = {name: (track.t, np.hypot(*track.v_n[:, :2].T)) for name, track in shown.items()}
    return pen.plot("motion/speed", "Speed over ground, m/s", lines)


def _angles(pen: _Pen, shown: Mapping[str, Trajectory]) -> list[TimedPlot]:
    first = _heading(list(shown.values())[-1], None)[0]
    lines: dict[str, dict[str, Line]] = {"heading": {}, "pitch": {}, "roll": {}}
    for name, track in shown.items():
        _, pitch, roll = euler_from_quat(track.q_nb)
        for key, angle in (("heading", _heading(track, first)), ("pitch", pitch / DEG), ("roll", roll / DEG)):
            lines[key][name] = track.t, angle
    titles = {"heading": "Heading, deg clockwise from north", "pitch": "Pitch, deg", "roll": "Roll, deg"}
    return [pen.plot(f"motion/{key}", title, lines[key]) for key, title in titles.items()]


def _heading(trajectory: Trajectory, first: float | None) -> Array:
    """Return the heading, deg, without jumps; it begins in [0, 360), or within 180 of `first`."""
    heading = -np.unwrap(euler_from_quat(trajectory.q_nb)[0]) / DEG
    turns = np.floor(heading[0] / 360) if first is None else np.round((heading[0] - first) / 360)
    return np.asarray(heading - 360 * turns)


def thinned(t: Array, count: int | None) -> slice:
    """Return every k-th row, so that at most `count` remain; None keeps all."""
    return slice(None, None, 1 if count is None else -(-len(t) // count))
