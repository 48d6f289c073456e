"""One run as a Rerun recording: the instrument, its paths, errors, rates, readings and texts, with a layout.

The only file, with ``bench.viewer``, that imports rerun. Numbers that matter are
kept elsewhere (Parquet): a recording is something to look at, and is readable by
the same and the next minor version of rerun only. Scalars are stored as float64,
bit for bit; poses and arrows as float32.
"""

import os
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from bench.drawing import Scene, Shape, body_shapes, body_sites, instrumented_body, mesh_triangles, round_down
from bench.errors import Array, InputError, OutputError, require_scalar
from bench.rotation import quat_rotate
from bench.signals import Accelerometers, GyroFreeSolution, Kinematics, Readings
from bench.traces import TIMELINE, TRUTH_COLOUR, Colour, Trace, estimate_colours, gyro_free_traces

CHUNK = 4096  # rows a chunk: several times faster and leaner than one big chunk, and far more than row by row
FORCE_COLOUR: Colour = (238, 190, 52)


@dataclass(frozen=True, eq=False)
class Run:
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


def write_recording(
    path: str | Path, run: Run, *, plot_rate: float | None = 1000.0, pose_rate: float | None = 100.0
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
    plots = _rows(run.readings.t, "plot_rate", plot_rate)
    poses = _rows(run.readings.t, "pose_rate", pose_rate)
    shapes = body_shapes(run.model, instrumented_body(run.model))
    scene = Scene.of(
        parts=np.array([*run.accelerometers.position, *(shape.position for shape in shapes)]),
        path=run.truth.position,
        others=[estimate.position for estimate in run.estimates.values()],
        strongest=float(np.abs(run.readings.accelerometers).max()),
    )
    pages = gyro_free_traces(run.truth, run.estimates, run.accelerometers, run.readings)
    strict = rr.strict_mode()
    rr.set_strict_mode(True)  # else wrong arguments only warn
    try:
        # In memory first: rerun's own file writer hangs when the disk is full.
        with rr.RecordingStream("strapbench") as rec:
            memory = rec.memory_recording()
            rec.send_blueprint(_blueprint(scene, pages))
            rec.send_recording_name(run.title)
            if run.parameters:
                rec.send_property("run", rr.AnyValues(**run.parameters))
            _log_texts(rec, run)
            _log_instrument(rec, run, shapes, scene)
            _log_paths(rec, run, scene)
            _log_poses(rec, run, scene, poses)
            _log_traces(rec, run.readings.t, pages, plots)
            content = memory.drain_as_bytes()
    finally:
        rr.set_strict_mode(strict)
    _write(path, content)
    return path


def _write(path: Path, content: bytes) -> None:
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        temporary.write_bytes(content)
        os.replace(temporary, path)
    except OSError as error:
        with suppress(OSError):
            temporary.unlink()
        raise OutputError(f"recording {str(path)!r} cannot be written: {error.strerror}") from error


def _rows(t: Array, name: str, rate: float | None) -> slice:
    """Return every k-th row, so that at most `rate` rows a second remain."""
    if rate is None or len(t) < 2:
        return slice(None)
    own = (len(t) - 1) / (t[-1] - t[0])
    return slice(None, None, max(1, int(np.ceil(own / require_scalar(name, rate, positive=True) - 1e-9))))


# --- logging ----------------------------------------------------------------------------------------------------


def _nanoseconds(t: Array) -> Array:
    """Return times as integers: rerun truncates float seconds, which is 1 ns off for some."""
    return np.round(t * 1e9).astype(np.int64).astype("timedelta64[ns]")


def _send(rec: rr.RecordingStream, entity: str, t: Array, columns: Callable[[slice], Iterable[Any]]) -> None:
    """Send rows in chunks; `columns` makes the component columns of a slice of rows."""
    ns = _nanoseconds(t)
    for start in range(0, len(ns), CHUNK):
        rows = slice(start, min(start + CHUNK, len(ns)))
        rec.send_columns(entity, [rr.TimeColumn(TIMELINE, duration=ns[rows])], columns(rows))


def _xyzw(q: Array) -> Array:
    return np.roll(q, -1, axis=-1)


def _name(part: str) -> str:
    return rr.escape_entity_path_part(part)


def _log_texts(rec: rr.RecordingStream, run: Run) -> None:
    for entity, text in (("configuration", run.configuration), ("results", run.results)):
        rec.log(entity, rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True)


def _log_instrument(rec: rr.RecordingStream, run: Run, shapes: tuple[Shape, ...], scene: Scene) -> None:
    """Log the body in true size for the body-frame view, and enlarged for the world view."""
    rec.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    rec.log("world/body/enlarged", rr.Transform3D(scale=scene.enlarged), static=True)
    for parent in ("world/body", "world/body/enlarged"):
        _log_shapes(rec, f"{parent}/instrument", run.model, shapes)
    rec.log("world/body/axes", rr.TransformAxes3D(0.7 * scene.arm), static=True)
    labels, positions = body_sites(run.model, instrumented_body(run.model))
    if labels:
        points = rr.Points3D(positions, radii=0.02 * scene.arm, colors=(240, 240, 240), labels=labels, show_labels=True)
        rec.log("world/body/sites", points, static=True)


def _log_shapes(rec: rr.RecordingStream, parent: str, model: Any, shapes: tuple[Shape, ...]) -> None:
    """One entity per kind; one per mesh and colour."""
    groups: dict[tuple[Any, ...], list[Shape]] = {}
    for shape in shapes:
        groups.setdefault((shape.kind, shape.mesh, shape.rgba if shape.kind == "mesh" else None), []).append(shape)
    for k, ((kind, mesh, rgba), group) in enumerate(groups.items()):
        if kind == "mesh":
            corners, normals = mesh_triangles(model, mesh)
            archetypes = [
                rr.Mesh3D(vertex_positions=corners, vertex_normals=normals, albedo_factor=rgba),
                rr.InstancePoses3D(
                    translations=[s.position for s in group], quaternions=[_xyzw(s.quat) for s in group]
                ),
            ]
        else:
            archetypes = [_primitives(kind, group)]
        rec.log(f"{parent}/{kind}_{k}", *archetypes, static=True)


def _primitives(kind: str, group: list[Shape]) -> Any:
    size = np.array([s.size for s in group])
    position, quat = np.array([s.position for s in group]), np.array([s.quat for s in group])
    look = {"quaternions": _xyzw(quat), "colors": [s.rgba for s in group]}
    solid = rr.components.FillMode.Solid
    if kind == "box":
        return rr.Boxes3D(half_sizes=size, centers=position, fill_mode=solid, **look)
    if kind == "ellipsoid":
        return rr.Ellipsoids3D(half_sizes=size, centers=position, fill_mode=solid, **look)
    if kind == "cylinder":
        return rr.Cylinders3D(radii=size[:, 0], lengths=2 * size[:, 1], centers=position, fill_mode=solid, **look)
    # Rerun's capsule begins at its origin, MuJoCo's is centred.
    start = position - quat_rotate(quat, size[:, 1:] * [0.0, 0.0, 1.0])
    return rr.Capsules3D(radii=size[:, 0], lengths=2 * size[:, 1], translations=start, fill_mode=solid, **look)


def _log_paths(rec: rr.RecordingStream, run: Run, scene: Scene) -> None:
    """Log whole paths; thinned, so that a long run stays light."""
    thin = slice(None, None, max(1, len(run.readings) // 4000))
    paths = [("truth", run.truth.position, TRUTH_COLOUR)]
    colours = estimate_colours(run.estimates)
    paths += [(_name(name), estimate.position, colours[name]) for name, estimate in run.estimates.items()]
    for name, position, colour in paths:
        line = rr.LineStrips3D([position[thin]], colors=colour, radii=0.003 * scene.extent)
        rec.log(f"world/paths/{name}", line, static=True)


def _log_poses(rec: rr.RecordingStream, run: Run, scene: Scene, rows: slice) -> None:
    """Log the moving body with its specific force, and the moving axes of every estimate."""
    t = run.readings.t[rows]
    _log_pose(rec, "world/body", t, run.truth.position[rows], run.truth.q_ib[rows])
    _log_forces(rec, run, scene, rows)
    length = 1.8 * scene.arm * scene.enlarged
    tags = [("true", "truth", run.truth.position[rows], TRUTH_COLOUR)]
    for name, colour in estimate_colours(run.estimates).items():
        estimate, entity = run.estimates[name], f"world/estimates/{_name(name)}"
        position = estimate.position[rows]
        _log_pose(rec, entity, t, position, estimate.q_ib[rows])
        axes = rr.Arrows3D(vectors=length * np.eye(3), radii=0.015 * length, colors=colour)
        rec.log(f"{entity}/axes", axes, static=True)
        tags.append((name, _name(name), position, colour))
    for k, (text, part, position, colour) in enumerate(tags):
        # Above one another, because estimates begin at one place; the truth below.
        height = -length if k == 0 else length + 0.12 * (k - 1) * scene.extent
        _log_tag(rec, f"world/tags/{part}", t, position + np.array([0.0, 0.0, height]), text, colour)


def _log_forces(rec: rr.RecordingStream, run: Run, scene: Scene, rows: slice) -> None:
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
        _send(rec, entity, run.readings.t[rows], arrows)


def _log_pose(rec: rr.RecordingStream, entity: str, t: Array, position: Array, q: Array) -> None:
    _send(rec, entity, t, lambda k: rr.Transform3D.columns(translation=position[k], quaternion=_xyzw(q[k])))


def _log_tag(rec: rr.RecordingStream, entity: str, t: Array, position: Array, text: str, colour: Colour) -> None:
    """Log a name that moves with a body but does not turn with it."""
    look = rr.Points3D.from_fields(radii=rr.Radius.ui_points(1.5), colors=colour, labels=text, show_labels=True)
    rec.log(entity, look, static=True)
    _send(rec, entity, t, lambda k: rr.Points3D.columns(positions=position[k]))


def _log_traces(rec: rr.RecordingStream, t: Array, pages: Mapping[str, list[Trace]], rows: slice) -> None:
    for trace in (trace for traces in pages.values() for trace in traces):
        # The default aggregation halves spikes of a single sample.
        widths = [2.5 if colour == TRUTH_COLOUR else 1.5 for colour in trace.colours]
        style = rr.SeriesLines(colors=trace.colours, names=trace.series, widths=widths, aggregation_policy="MinMax")
        rec.log(trace.entity, style, static=True)
        _send_scalars(rec, trace.entity, t[rows], np.ascontiguousarray(trace.values[rows]))


def _send_scalars(rec: rr.RecordingStream, entity: str, t: Array, values: Array) -> None:
    _send(rec, entity, t, lambda k: rr.Scalars.columns(scalars=values[k]))


# --- layout -----------------------------------------------------------------------------------------------------


def _blueprint(scene: Scene, pages: Mapping[str, list[Trace]]) -> rrb.Blueprint:
    summary = [_time_series(trace) for trace in pages.get("Errors", [])[:2]]
    side = rrb.Vertical(_body_view(scene), *summary, row_shares=[2.2, *([1] * len(summary))])
    tabs = [rrb.Horizontal(_world_view(scene), side, column_shares=[3, 2], name="Scene")]
    for name, traces in pages.items():
        views = [_time_series(trace) for trace in traces]
        by_axis = name == "Errors by axis"
        tabs.append(rrb.Grid(*views, grid_columns=2, name=name) if by_axis else rrb.Vertical(*views, name=name))
    texts = (rrb.TextDocumentView(origin=name.lower(), name=name) for name in ("Results", "Configuration"))
    return rrb.Blueprint(
        rrb.Tabs(*tabs, *texts, active_tab=0),
        # Following shows the end, where errors are largest, and stands still there.
        rrb.TimePanel(timeline=TIMELINE, play_state="following", state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
    )


def _world_view(scene: Scene) -> rrb.Spatial3DView:
    centre = np.array(scene.centre)
    size = f", instrument drawn {scene.enlarged:g} times larger" if scene.enlarged > 1 else ""
    true_size = ("axes", "instrument", "sites", "specific_force")
    return rrb.Spatial3DView(
        origin="/world",
        contents=["+ $origin/**", *(f"- /world/body/{part}/**" for part in true_size)],
        name=f"World{size}",
        eye_controls=rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital,
            position=centre + scene.extent * np.array([0.85, -1.35, 1.1]),
            look_target=centre,
            eye_up=(0, 0, 1),
        ),
        line_grid=rrb.LineGrid3D(visible=True, spacing=round_down(0.3 * scene.extent)),
        spatial_information=rrb.SpatialInformation(target_frame="tf#/world", show_axes=True),
    )


def _body_view(scene: Scene) -> rrb.Spatial3DView:
    return rrb.Spatial3DView(
        origin="/world/body",
        contents=["+ $origin/**", "- $origin/enlarged/**"],
        name=f"Body frame; arrows: specific force, {scene.force_scale:g} m per m/s^2",
        eye_controls=rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital,
            position=scene.arm * np.array([2.55, 1.19, 1.26]),
            look_target=(0, 0, 0),
            eye_up=(0, 0, 1),
        ),
        line_grid=rrb.LineGrid3D(visible=False),
    )


def _time_series(trace: Trace) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        origin=f"/{trace.entity}",
        name=trace.title,
        axis_y=rrb.ScalarAxis(range=trace.display_range()) if trace.logarithmic else None,
        plot_legend=rrb.PlotLegend(rrb.Corner2D[trace.empty_corner()]),
    )
