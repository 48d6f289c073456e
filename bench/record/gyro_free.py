"""A gyro-free run as a recording: the instrument, its paths, errors, rates, readings and texts, with a layout."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from bench.errors import InputError
from bench.record._gyro_free_traces import gyro_free_traces
from bench.record.drawing import Scene, Shape, body_shapes, body_sites, instrumented_body, round_down
from bench.record.instrument import log_shapes
from bench.record.layout import eye, layout, time_series
from bench.record.stream import entity_part, log_texts, recording, rows_at, send, send_pose, send_tag, send_trace
from bench.record.traces import TRUTH_COLOUR, Colour, Trace, estimate_colours
from bench.signals import Accelerometers, GyroFreeSolution, Kinematics, Readings

FORCE_COLOUR: Colour = (238, 190, 52)


@dataclass(frozen=True, eq=False)
class GyroFreeRun:
    """What one recording shows; every array has one row per reading.

    Attributes
    ----------
    title : str
    model : mujoco.MjModel
        The compiled model as drawn (`Rig.model`); only its arrays are read.
    accelerometers : Accelerometers
    readings : Readings
        What the sensors reported; its times are those of everything else.
    truth : Kinematics
    estimates : mapping of str to GyroFreeSolution
        By the name that is shown; the order gives the colours.
    configuration, results : str
        Markdown.
    parameters : mapping of str to str, float or int
        Shown in the viewer's table of recordings.

    Raises
    ------
    InputError
        If the numbers of rows or channels differ.
    """

    title: str
    model: Any
    accelerometers: Accelerometers
    readings: Readings
    truth: Kinematics
    estimates: Mapping[str, GyroFreeSolution]
    configuration: str
    results: str
    parameters: Mapping[str, str | float | int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        n = len(self.readings)
        counts = {"truth": len(self.truth)}
        counts |= {f"estimates[{name!r}]": len(estimate) for name, estimate in self.estimates.items()}
        for name, count in counts.items():
            if count != n:
                raise InputError(f"{name} must have one row per reading, {n}, got {count}")
        channels = self.readings.accelerometers.shape[1]
        if channels != len(self.accelerometers):
            raise InputError(f"readings must have {len(self.accelerometers)} channels, got {channels}")


def write_gyro_free_recording(
    path: str | Path, run: GyroFreeRun, *, plot_rate: float | None = 1000.0, pose_rate: float | None = 100.0
) -> Path:
    """Write one run, with its layout, to an ``.rrd`` file.

    Parameters
    ----------
    path : str or Path
        Written under a temporary name and renamed when complete: never half a file.
    run : Run
    plot_rate, pose_rate : float, Hz, or None
        At most so many rows a second of plots, and of poses and arrows; None writes all.

    Raises
    ------
    InputError
        If a rate is not positive.
    OutputError
        If the file cannot be written.
    """
    path = Path(path)
    plots = rows_at(run.readings.t, "plot_rate", plot_rate)
    poses = rows_at(run.readings.t, "pose_rate", pose_rate)
    shapes = body_shapes(run.model, instrumented_body(run.model))
    scene = Scene.of(
        parts=np.array([*run.accelerometers.position, *(shape.position for shape in shapes)]),
        path=run.truth.position,
        others=[estimate.position for estimate in run.estimates.values()],
        strongest=float(np.abs(run.readings.accelerometers).max()),
    )
    pages = gyro_free_traces(run.truth, run.estimates, run.accelerometers, run.readings)
    with recording(path, run.title, run.parameters, _blueprint(scene, pages)) as rec:
        log_texts(rec, configuration=run.configuration, results=run.results)
        _log_instrument(rec, run, shapes, scene)
        _log_paths(rec, run, scene)
        _log_poses(rec, run, scene, poses)
        for trace in (trace for traces in pages.values() for trace in traces):
            send_trace(rec, run.readings.t, trace, plots)
    return path


# --- logging ----------------------------------------------------------------------------------------------------


def _log_instrument(rec: rr.RecordingStream, run: GyroFreeRun, shapes: tuple[Shape, ...], scene: Scene) -> None:
    """Log the body in true size for the body-frame view, and enlarged for the world view."""
    rec.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    rec.log("world/body/enlarged", rr.Transform3D(scale=scene.enlarged), static=True)
    for parent in ("world/body", "world/body/enlarged"):
        log_shapes(rec, f"{parent}/instrument", run.model, shapes)
    rec.log("world/body/axes", rr.TransformAxes3D(0.7 * scene.arm), static=True)
    labels, positions = body_sites(run.model, instrumented_body(run.model))
    if labels:
        points = rr.Points3D(positions, radii=0.02 * scene.arm, colors=(240, 240, 240), labels=labels, show_labels=True)
        rec.log("world/body/sites", points, static=True)


def _log_paths(rec: rr.RecordingStream, run: GyroFreeRun, scene: Scene) -> None:
    """Log whole paths; thinned, so that a long run stays light."""
    thin = slice(None, None, max(1, len(run.readings) // 4000))
    paths = [("truth", run.truth.position, TRUTH_COLOUR)]
    colours = estimate_colours(run.estimates)
    paths += [(entity_part(name), estimate.position, colours[name]) for name, estimate in run.estimates.items()]
    for name, position, colour in paths:
        line = rr.LineStrips3D([position[thin]], colors=colour, radii=0.003 * scene.extent)
        rec.log(f"world/paths/{name}", line, static=True)


def _log_poses(rec: rr.RecordingStream, run: GyroFreeRun, scene: Scene, rows: slice) -> None:
    """Log the moving body with its specific force, and the moving axes of every estimate."""
    t = run.readings.t[rows]
    send_pose(rec, "world/body", t, run.truth.position[rows], run.truth.q_ib[rows])
    _log_forces(rec, run, scene, rows)
    length = 1.8 * scene.arm * scene.enlarged
    tags = [("true", "truth", run.truth.position[rows], TRUTH_COLOUR)]
    for name, colour in estimate_colours(run.estimates).items():
        estimate, entity = run.estimates[name], f"world/estimates/{entity_part(name)}"
        position = estimate.position[rows]
        send_pose(rec, entity, t, position, estimate.q_ib[rows])
        axes = rr.Arrows3D(vectors=length * np.eye(3), radii=0.015 * length, colors=colour)
        rec.log(f"{entity}/axes", axes, static=True)
        tags.append((name, entity_part(name), position, colour))
    for k, (text, part, position, colour) in enumerate(tags):
        # Above one another, because estimates begin at one place; the truth below.
        height = -length if k == 0 else length + 0.12 * (k - 1) * scene.extent
        send_tag(rec, f"world/tags/{part}", t, position + np.array([0.0, 0.0, height]), text, colour)


def _log_forces(rec: rr.RecordingStream, run: GyroFreeRun, scene: Scene, rows: slice) -> None:
    """Log one arrow per accelerometer channel, along its sensing axis."""
    force = scene.force_scale * run.readings.accelerometers[rows, :, None] * run.accelerometers.direction
    m = len(run.accelerometers)

    def arrows(k: slice) -> Iterable[Any]:
        vectors = force[k].reshape(-1, 3)
        origins = np.tile(run.accelerometers.position, (len(force[k]), 1))
        return rr.Arrows3D.columns(vectors=vectors, origins=origins).partition(np.full(len(force[k]), m))

    for parent in ("world/body", "world/body/enlarged"):
        entity = f"{parent}/specific_force"
        rec.log(entity, rr.Arrows3D.from_fields(colors=FORCE_COLOUR, radii=0.022 * scene.arm), static=True)
        send(rec, entity, run.readings.t[rows], arrows)


# --- layout -----------------------------------------------------------------------------------------------------


def _blueprint(scene: Scene, pages: Mapping[str, list[Trace]]) -> rrb.Blueprint:
    summary = [time_series(trace) for trace in pages.get("Errors", [])[:2]]
    side = rrb.Vertical(_body_view(scene), *summary, row_shares=[2.2, *([1] * len(summary))])
    tabs = [rrb.Horizontal(_world_view(scene), side, column_shares=[3, 2], name="Scene")]
    for name, traces in pages.items():
        views = [time_series(trace) for trace in traces]
        by_axis = name == "Errors by axis"
        tabs.append(rrb.Grid(*views, grid_columns=2, name=name) if by_axis else rrb.Vertical(*views, name=name))
    return layout(tabs)


def _world_view(scene: Scene) -> rrb.Spatial3DView:
    centre = np.array(scene.centre)
    size = f", instrument drawn {scene.enlarged:g} times larger" if scene.enlarged > 1 else ""
    true_size = ("axes", "instrument", "sites", "specific_force")
    return rrb.Spatial3DView(
        origin="/world",
        contents=["+ $origin/**", *(f"- /world/body/{part}/**" for part in true_size)],
        name=f"World{size}",
        eye_controls=eye(centre + scene.extent * np.array([0.85, -1.35, 1.1]), centre),
        line_grid=rrb.LineGrid3D(visible=True, spacing=round_down(0.3 * scene.extent)),
        spatial_information=rrb.SpatialInformation(target_frame="tf#/world", show_axes=True),
    )


def _body_view(scene: Scene) -> rrb.Spatial3DView:
    return rrb.Spatial3DView(
        origin="/world/body",
        contents=["+ $origin/**", "- $origin/enlarged/**"],
        name=f"Body frame; arrows: specific force, {scene.force_scale:g} m per m/s^2",
        eye_controls=eye(scene.arm * np.array([2.55, 1.19, 1.26])),
        line_grid=rrb.LineGrid3D(visible=False),
    )
