"""What a solved recording shows: tables, figures and the report's blocks; arrays and text only."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bench._damp_report import consistency_table, damping_figures
from bench.damp import Damped
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
REFERENCE, ESTIMATE, DAMPED = 6, 0, 1  # colours of lines

Shown = tuple[str, Trajectory, int]  # name, track and colour


def trajectory_table(found: Trajectory, *, attitude_only: bool = False) -> Table:
    """Return time, position, velocity and attitude at every update; only time and attitude if no more was solved."""
    psi, pitch, roll = euler_from_quat(found.q_nb)
    columns = {"t_s": found.t}
    if not attitude_only:
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


def summary_table(errors: NavigationErrors, *, attitude_only: bool, of: str = "") -> Table:
    """Return final, RMS and largest errors, of what is named if there is more than one."""
    measures: list[tuple[str, Array]] = []
    for key, unit in (("position", "m"), ("velocity", "m/s"))[: 0 if attitude_only else 2]:
        value: Array = getattr(errors, key)
        measures.append((f"{key}, horizontal, {unit}", np.hypot(value[:, 0], value[:, 1])))
        measures.append((f"{key}, up, {unit}", value[:, 2]))
    measures.append(("attitude, level, deg", np.hypot(errors.attitude[:, 0], errors.attitude[:, 1]) / DEG))
    measures.append(("attitude, about up, deg", errors.attitude[:, 2] / DEG))
    rows = [(name, float(v[-1]), float(rms(v)), float(np.abs(v).max())) for name, v in measures]
    title = "Errors against the reference" + (of and f", {of}")
    return Table.from_rows(("error", "final", "RMS", "largest"), rows, title)


def summary_tables(solution: Solution, damped: Damped | None) -> list[Table]:
    """Return final, RMS and largest errors of the solution, and of the damped one; nothing without a reference."""
    if solution.comparison is None:
        return []
    tables = [
        summary_table(
            solution.comparison.errors,
            attitude_only=solution.attitude_only,
            of=f"{solution.solver.name}, free" if damped else "",
        )
    ]
    if damped is not None and damped.comparison is not None:
        tables.append(summary_table(damped.comparison.errors, attitude_only=False, of=f"{damped.filter.name}, damped"))
    return tables


def states(solution: Solution, damped: Damped | None = None) -> dict[str, dict[str, float]]:
    """Return the states at the start and at the end, in degrees and SI, by quantity; also the damped one at the end."""
    found = {name: _state(solution.trajectory, k, solution.attitude_only) for name, k in (("start", 0), ("end", -1))}
    return found if damped is None else {**found, "end_damped": _state(damped.trajectory, -1, False)}


def _state(found: Trajectory, row: int, attitude_only: bool) -> dict[str, float]:
    psi, pitch, roll = euler_from_quat(found.q_nb[row])
    state = {"t, s": found.t[row]}
    if not attitude_only:
        state |= {"latitude, deg": found.latitude[row] / DEG, "longitude, deg": found.longitude[row] / DEG}
        state |= {"height, m": found.height[row]}
        state |= {f"velocity {name}, m/s": v for name, v in zip(DIRECTIONS, found.v_n[row], strict=True)}
    state |= {"heading, deg": -psi / DEG % 360, "pitch, deg": pitch / DEG, "roll, deg": roll / DEG}
    return {name: float(value) for name, value in state.items()}


def state_table(solution: Solution, damped: Damped | None = None) -> Table:
    """Return the state at the start and at the end, as text with as many digits as matter; free and damped."""
    digits = {"t": 6, "latitude": 9, "longitude": 9, "height": 4, "velocity": 5}
    found = states(solution, damped)
    titles = ["start", "end"]
    if damped is not None:
        titles = ["start", f"end by {solution.solver.name}, free", f"end by {damped.filter.name}, damped"]

    def text(quantity: str, value: float) -> str:
        return f"{value:z.{digits.get(quantity.split(',')[0].split()[0], 6)}f}"

    rows = [(name, *(text(name, state[name]) for state in found.values())) for name in found["start"]]
    return Table.from_rows(("quantity", *titles), rows, "State at the start and at the end")


def solution_figures(solution: Solution, damped: Damped | None = None) -> list[Figure]:
    """Return track, velocity, attitude and, with a reference, errors; and what a filter found."""
    shown = _shown(solution, damped)
    figures = [] if solution.attitude_only else [_track(solution, shown), _velocity(shown)]
    figures.append(_attitude(shown))
    if solution.comparison is not None:
        errors = {solution.solver.name: solution.comparison.errors}
        if damped is not None and damped.comparison is not None:
            errors[damped.filter.name] = damped.comparison.errors
        figures.append(_errors(solution, errors))
    return figures + ([] if damped is None else damping_figures(damped))


def report_blocks(
    title: str,
    summary: str,
    solution: Solution,
    damped: Damped | None,
    facts: Mapping[str, Table],
    files: Mapping[str, Path],
) -> list[Block]:
    """Return the report: summary, errors, states, figures, and tables of facts by heading."""
    content: list[Block] = [Heading(title, 1), summary]
    if solution.comparison is not None:
        content.append(Heading("Errors"))
        for table in summary_tables(solution, damped):
            content += [f"{table.title}:", table] if damped else [table]
    if damped is not None:
        content += [Heading("Filter"), consistency_table(damped)]
    content += [Heading("States"), state_table(solution, damped), Heading("Figures")]
    for figure in solution_figures(solution, damped):
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


def _shown(solution: Solution, damped: Damped | None) -> list[Shown]:
    """Return what is drawn, from below: the reference, the free solution, the damped one."""
    found = [(solution.solver.name, solution.trajectory, ESTIMATE)]
    if solution.comparison is not None:
        found.insert(0, ("reference", solution.comparison.reference, REFERENCE))
    if damped is not None:
        found.append((damped.filter.name, damped.trajectory, DAMPED))
    return found


def _panel(shown: Sequence[Shown], label: str, values: Sequence[Array]) -> Panel:
    """Return values of what is drawn over time."""
    start = shown[-1][1].t[0]
    lines = [
        _line(name, track.t - start, value, colour) for (name, track, colour), value in zip(shown, values, strict=True)
    ]
    return Panel(SINCE, label, lines)


def _line(label: str, x: Array, y: Array, colour: int, style: str = "-") -> Line:
    thin = slice(None, None, -(-len(x) // DRAWN))
    return Line(label, x[thin], y[thin], colour, style)


def _track(solution: Solution, shown: Sequence[Shown]) -> Figure:
    main = solution.trajectory
    q_ne = quat_conjugate(main.q_en[0])
    lines = []
    for name, track, colour in shown:
        enu = quat_rotate(q_ne, track.r_e - main.r_e[0])
        lines.append(_line(name, enu[:, 0], enu[:, 1], colour))
    horizontal = Panel("east of the start, m", "north of the start, m", lines, equal=True)
    height = _panel(shown, "height, m", [track.height for _, track, _ in shown])
    return Figure("track", "Track", "Track, in the level plane at the start, and height.", [horizontal, height], 2)


def _velocity(shown: Sequence[Shown]) -> Figure:
    v_n = [track.v_n for _, track, _ in shown]
    panels = [_panel(shown, f"velocity {name}, m/s", [v[:, k] for v in v_n]) for k, name in enumerate(DIRECTIONS)]
    return Figure("velocity", "Velocity", "Velocity relative to the Earth.", panels)


def _attitude(shown: Sequence[Shown]) -> Figure:
    angles = [euler_from_quat(track.q_nb) for _, track, _ in shown]
    headings = [-np.unwrap(psi) / DEG for psi, _, _ in angles]
    headings = [h - 360 * np.round((h[0] - headings[-1][0] % 360) / 360) for h in headings]
    panels = [
        _panel(shown, "heading, deg", headings),
        _panel(shown, "pitch, deg", [pitch / DEG for _, pitch, _ in angles]),
        _panel(shown, "roll, deg", [roll / DEG for _, _, roll in angles]),
    ]
    return Figure("attitude", "Attitude", "Heading (clockwise from north, without jumps), pitch and roll.", panels)


def _errors(solution: Solution, errors: Mapping[str, NavigationErrors]) -> Figure:
    """Return the errors of the free solution, dashed below those of the damped one if there is one."""
    kinds = (("position", "m", 1.0), ("velocity", "m/s", 1.0), ("attitude", "deg", DEG))
    start, several = solution.trajectory.t[0], len(errors) > 1
    panels = []
    for key, unit, scale in kinds[2 if solution.attitude_only else 0 :]:
        about = "about " if key == "attitude" else ""
        lines = [
            _line(f"{about}{name}{f', {who}' if several else ''}", e.t - start, getattr(e, key)[:, k] / scale, k, style)
            for (who, e), style in zip(errors.items(), ("--", "-")[-len(errors) :], strict=True)
            for k, name in enumerate(DIRECTIONS)
        ]
        panels.append(Panel(SINCE, f"{key} error, {unit}", lines))
    return Figure("errors", "Errors", "Solution minus reference, in east-north-up at the reference.", panels)
