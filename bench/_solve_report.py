"""What a solved recording shows: tables, figures and the report's blocks; arrays and text only."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bench.errors import Array
from bench.evaluation import rms
from bench.figures import Figure, Line, Panel
from bench.report import Block, Heading, Image
from bench.rotation import euler_from_quat, quat_conjugate, quat_rotate
from bench.solve import Solution
from bench.table import Table
from bench.trajectory import NavigationErrors, Trajectory
from bench.units import DEG

DRAWN = 4000  # points of a line
DIRECTIONS = ("east", "north", "up")
SINCE = "time since the start, s"
REFERENCE, ESTIMATE = 6, 0  # colours of lines


def trajectory_table(solution: Solution) -> Table:
    """Return time, position, velocity and attitude at every update; only time and attitude if no more was solved."""
    found = solution.trajectory
    psi, pitch, roll = euler_from_quat(found.q_nb)
    columns = {"t_s": found.t}
    if not solution.attitude_only:
        columns |= {"latitude_rad": found.latitude, "longitude_rad": found.longitude, "height_m": found.height}
        columns |= {f"velocity_{name}_m_per_s": found.v_n[:, k] for k, name in enumerate(DIRECTIONS)}
    columns |= {f"q_nb_{name}": found.q_nb[:, k] for k, name in enumerate("wxyz")}
    columns |= {"heading_rad": -psi % (2 * np.pi), "pitch_rad": pitch, "roll_rad": roll}
    return Table(columns, "Solution; n is east-north-up, heading is clockwise from north")


def error_table(errors: NavigationErrors, *, attitude_only: bool) -> Table:
    """Return the errors at the reference's times."""
    columns = {"t_s": errors.t}
    for key, unit in (("position", "m"), ("velocity", "m_per_s"), ("attitude", "rad"))[2 if attitude_only else 0 :]:
        columns |= {f"{key}_{name}_{unit}": getattr(errors, key)[:, k] for k, name in enumerate(DIRECTIONS)}
    return Table(columns, "Solution minus reference, in east-north-up; attitude as rotation vector")


def summary_table(errors: NavigationErrors, *, attitude_only: bool) -> Table:
    """Return final, RMS and largest errors."""
    measures: list[tuple[str, Array]] = []
    for key, unit in (("position", "m"), ("velocity", "m/s"))[: 0 if attitude_only else 2]:
        value: Array = getattr(errors, key)
        measures.append((f"{key}, horizontal, {unit}", np.hypot(value[:, 0], value[:, 1])))
        measures.append((f"{key}, up, {unit}", value[:, 2]))
    measures.append(("attitude, level, deg", np.hypot(errors.attitude[:, 0], errors.attitude[:, 1]) / DEG))
    measures.append(("attitude, about up, deg", errors.attitude[:, 2] / DEG))
    rows = [(name, float(v[-1]), float(rms(v)), float(np.abs(v).max())) for name, v in measures]
    return Table.from_rows(("error", "final", "RMS", "largest"), rows, "Errors against the reference")


def states(solution: Solution) -> dict[str, dict[str, float]]:
    """Return the state at the start and at the end, in degrees and SI, by quantity."""
    found = solution.trajectory
    psi, pitch, roll = euler_from_quat(found.q_nb)
    columns = {"t, s": found.t}
    if not solution.attitude_only:
        columns |= {"latitude, deg": found.latitude / DEG, "longitude, deg": found.longitude / DEG}
        columns |= {"height, m": found.height}
        columns |= {f"velocity {name}, m/s": found.v_n[:, k] for k, name in enumerate(DIRECTIONS)}
    columns |= {"heading, deg": -psi / DEG % 360, "pitch, deg": pitch / DEG, "roll, deg": roll / DEG}
    return {name: {key: float(column[k]) for key, column in columns.items()} for name, k in (("start", 0), ("end", -1))}


def state_table(solution: Solution) -> Table:
    """Return the state at the start and at the end, as text with as many digits as matter."""
    digits = {"t": 6, "latitude": 9, "longitude": 9, "height": 4, "velocity": 5}
    found = states(solution)

    def text(quantity: str, value: float) -> str:
        return f"{value:z.{digits.get(quantity.split(',')[0].split()[0], 6)}f}"

    rows = [(name, *(text(name, found[end][name]) for end in ("start", "end"))) for name in found["start"]]
    return Table.from_rows(("quantity", "start", "end"), rows, "State at the start and at the end")


def solution_figures(solution: Solution) -> list[Figure]:
    """Return track, velocity, attitude and, with a reference, errors."""
    figures = [] if solution.attitude_only else [_track(solution), _velocity(solution)]
    figures.append(_attitude(solution))
    if solution.comparison is not None:
        figures.append(_errors(solution, solution.comparison.errors))
    return figures


def report_blocks(
    title: str, summary: str, solution: Solution, facts: Mapping[str, Table], files: Mapping[str, Path]
) -> list[Block]:
    """Return the report: summary, errors, states, figures, and tables of facts by heading."""
    content: list[Block] = [Heading(title, 1), summary]
    if solution.comparison is not None:
        content += [Heading("Errors"), _summary(solution)]
    content += [Heading("States"), state_table(solution), Heading("Figures")]
    for figure in solution_figures(solution):
        content.append(Image(files[f"figure {figure.name}"], figure.caption))
    for heading, table in facts.items():
        content += [Heading(heading), table]
    return content


def facts_table(title: str, facts: Mapping[str, Any]) -> Table:
    """Return names and values as text."""
    return Table.from_rows(("name", "value"), [(name, _text(value)) for name, value in facts.items()], title)


def _text(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {_text(item)}" for name, item in value.items() if item not in (None, ""))
    if isinstance(value, (list, tuple)):
        return " ".join(map(_text, value))
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def _summary(solution: Solution) -> Table:
    assert solution.comparison is not None
    return summary_table(solution.comparison.errors, attitude_only=solution.attitude_only)


def _shown(solution: Solution) -> list[tuple[str, Trajectory, int]]:
    """Return what is drawn: the reference below, the solution above it."""
    found = [(solution.solver.name, solution.trajectory, ESTIMATE)]
    if solution.comparison is not None:
        found.insert(0, ("reference", solution.comparison.reference, REFERENCE))
    return found


def _panel(solution: Solution, label: str, values: Sequence[Array]) -> Panel:
    """Return values of what is drawn over time."""
    start = solution.trajectory.t[0]
    lines = [
        _line(name, track.t - start, value, colour)
        for (name, track, colour), value in zip(_shown(solution), values, strict=True)
    ]
    return Panel(SINCE, label, lines)


def _line(label: str, x: Array, y: Array, colour: int) -> Line:
    thin = slice(None, None, -(-len(x) // DRAWN))
    return Line(label, x[thin], y[thin], colour)


def _track(solution: Solution) -> Figure:
    main = solution.trajectory
    q_ne = quat_conjugate(main.q_en[0])
    lines = []
    for name, track, colour in _shown(solution):
        enu = quat_rotate(q_ne, track.r_e - main.r_e[0])
        lines.append(_line(name, enu[:, 0], enu[:, 1], colour))
    horizontal = Panel("east of the start, m", "north of the start, m", lines, equal=True)
    height = _panel(solution, "height, m", [track.height for _, track, _ in _shown(solution)])
    return Figure("track", "Track", "Track, in the level plane at the start, and height.", [horizontal, height], 2)


def _velocity(solution: Solution) -> Figure:
    tracks = [track for _, track, _ in _shown(solution)]
    panels = [
        _panel(solution, f"velocity {name}, m/s", [t.v_n[:, k] for t in tracks]) for k, name in enumerate(DIRECTIONS)
    ]
    return Figure("velocity", "Velocity", "Velocity relative to the Earth.", panels)


def _attitude(solution: Solution) -> Figure:
    angles = [euler_from_quat(track.q_nb) for _, track, _ in _shown(solution)]
    headings = [-np.unwrap(psi) / DEG for psi, _, _ in angles]
    headings = [h - 360 * np.round((h[0] - headings[-1][0] % 360) / 360) for h in headings]
    panels = [
        _panel(solution, "heading, deg", headings),
        _panel(solution, "pitch, deg", [pitch / DEG for _, pitch, _ in angles]),
        _panel(solution, "roll, deg", [roll / DEG for _, _, roll in angles]),
    ]
    return Figure("attitude", "Attitude", "Heading (clockwise from north, without jumps), pitch and roll.", panels)


def _errors(solution: Solution, errors: NavigationErrors) -> Figure:
    kinds = (("position", "m", 1.0), ("velocity", "m/s", 1.0), ("attitude", "deg", DEG))
    t = errors.t - solution.trajectory.t[0]
    panels = []
    for key, unit, scale in kinds[2 if solution.attitude_only else 0 :]:
        value = getattr(errors, key) / scale
        about = "about " if key == "attitude" else ""
        lines = [_line(f"{about}{name}", t, value[:, k], k) for k, name in enumerate(DIRECTIONS)]
        panels.append(Panel(SINCE, f"{key} error, {unit}", lines))
    return Figure("errors", "Errors", "Solution minus reference, in east-north-up at the reference.", panels)
