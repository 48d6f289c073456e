"""A dual-Euler run as a recording: the three-axis table in motion, both sets of angles, the flag, jumps and errors."""

from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from bench.errors import InputError
from bench.record._dual_euler_traces import DualEulerRun, Timed, dual_euler_plots
from bench.record.drawing import body_shapes
from bench.record.instrument import log_shapes
from bench.record.layout import eye, figure_tabs, layout, time_series
from bench.record.stream import log_figures, log_texts, recording, send_pose, send_trace
from bench.record.traces import AXIS_COLOURS
from bench.rotation import quat_from_rotvec

__all__ = ["DualEulerRun", "write_dual_euler_recording"]

TABLE = "world/table"
EYE = np.array([0.98, 1.2, 0.32])  # m, from where the table is looked at
TARGET = np.array([0.0, 0.0, -0.2])
FLOOR = -0.71  # m, below which there is the ground, which is not drawn
POSES = 12_000  # rows


def write_dual_euler_recording(path: str | Path, run: DualEulerRun) -> Path:
    """Write one run, with its layout, to an ``.rrd`` file.

    Parameters
    ----------
    path : str or Path
        Written under a temporary name and renamed when complete: never half a file.
    run : DualEulerRun

    Raises
    ------
    InputError
        If the model is no three-axis table.
    OutputError
        If the file cannot be written.
    """
    path = Path(path)
    chain = _chain(run.model)
    pages = dual_euler_plots(run)
    with recording(path, run.title, run.parameters, _blueprint(run, pages)) as rec:
        log_texts(rec, configuration=run.configuration, results=run.results)
        log_figures(rec, run.figures.values())
        _log_table(rec, run, chain)
        for t, trace in (timed for page in pages.values() for timed in page):
            send_trace(rec, t, trace, slice(None))
    return path


def _chain(model: Any) -> list[int]:
    """Return the bodies that the joints heading, pitch and roll move, from the outer to the inner one."""
    names = [model.joint(k).name for k in range(model.njnt)]
    if names != ["heading", "pitch", "roll"]:
        raise InputError(f"model must have the joints heading, pitch, roll, got {', '.join(names) or 'none'}")
    return [int(body) for body in model.jnt_bodyid]


def _log_table(rec: rr.RecordingStream, run: DualEulerRun, chain: list[int]) -> None:
    """Log pedestal and rings; every ring is an entity below that of the ring that carries it."""
    model = run.model
    rec.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    standing = (shape for shape in body_shapes(model, 0, below=False) if shape.position[2] > FLOOR)
    log_shapes(rec, f"{TABLE}/pedestal", model, tuple(standing))
    rows = slice(None, None, max(1, len(run.t) // POSES))
    t, true = run.t[rows], run.angles["true"][rows]
    entity = TABLE
    for k, (body, sign) in enumerate(zip(chain, (-1.0, 1.0, 1.0), strict=True)):  # psi = -heading
        entity = f"{entity}/{model.body(body).name}"
        turn = quat_from_rotvec(sign * true[:, [k]] * model.jnt_axis[k])
        send_pose(rec, entity, t, np.zeros((len(t), 3)) + model.body_pos[body], turn)
        log_shapes(rec, f"{entity}/shapes", model, body_shapes(model, body, below=False))
    _log_level(rec)


def _log_level(rec: rr.RecordingStream) -> None:
    """Log where east and north are, beside the pedestal."""
    at = np.array([0.38, 0.10, FLOOR])
    arrows = 0.2 * np.eye(3)
    look = rr.Arrows3D(
        vectors=arrows, origins=np.tile(at, (3, 1)), radii=0.006, colors=AXIS_COLOURS, labels=["east", "north", "up"]
    )
    rec.log("world/n", look, static=True)


def _blueprint(run: DualEulerRun, pages: dict[str, list[Timed]]) -> rrb.Blueprint:
    whole = float(run.t[0]), float(run.t[-1]) * 1.02
    pitch, flag, plain, _ = pages["Scene"]
    heading = rrb.TimeSeriesView(
        origin="/scene/heading",
        name="Heading put out, deg: quaternion, forward, and dual Euler, active",
        axis_x=time_series(plain[1], span=whole).properties.get("TimeAxis"),
    )
    table = rrb.Spatial3DView(
        origin="/world",
        name="The table at its true angles",
        eye_controls=eye(EYE, TARGET),
        line_grid=rrb.LineGrid3D(visible=False),
    )
    side = rrb.Vertical(time_series(pitch[1], span=whole), time_series(flag[1], span=whole, legend=False), heading)
    tabs: list[Any] = [rrb.Horizontal(table, side, column_shares=[3, 2], name="Scene")]
    for page, span in (("Both sets", whole), ("Errors", whole)):
        views = [time_series(trace, span=span, legend=k == 0) for k, (_, trace) in enumerate(pages[page])]
        tabs.append(rrb.Vertical(*views, name=page))
    near = [time_series(trace, span=run.passage, legend=k == 0) for k, (_, trace) in enumerate(pages["Both sets"])]
    tabs.append(rrb.Vertical(*near, name="At the pole"))
    return layout([*tabs, *figure_tabs(run.figures)])
