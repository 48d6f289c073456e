"""Tracks of a navigation run: on a map, in a local east-north-up frame, and the body's attitude in it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from bench.errors import Array
from bench.record._attitude_scene import times
from bench.record._navigation_traces import TRUTH, thinned
from bench.record.drawing import round_down
from bench.record.layout import eye
from bench.record.stream import entity_part, send, send_pose, send_tag
from bench.record.traces import AXIS_COLOURS, TRUTH_COLOUR, Colour, estimate_colours
from bench.rotation import quat_conjugate, quat_multiply, quat_normalize, quat_rotate
from bench.trajectory import Trajectory
from bench.units import DEG

SMALLEST = 1.0  # m, half the size of a scene in which nothing moves
POINTS = 4000  # of a drawn track
BODY = np.array([0.45, 1.0, 0.2])  # half sizes of the drawn vehicle, right, forward, up
EYE = np.array([0.7, -1.25, 1.0])  # from where the views look: from the south-east, above


@dataclass(frozen=True, eq=False)
class Tracks:
    """Where truth and estimates went, and how large the scene is.

    Attributes
    ----------
    shown : dict of str to Trajectory
        Truth, if there is one, last.
    parts, colours : dict of str
        Entity name and colour.
    enu : dict of str to ndarray, shape (n, 3), m
        Positions east, north, up of the first position of what is shown last.
    q_le : ndarray, shape (4,)
        From the Earth frame to that local frame.
    centre : ndarray, shape (3,), m
    extent : float, m
        Radius round the centre that the view shows.
    """

    shown: dict[str, Trajectory]
    parts: dict[str, str]
    colours: dict[str, Colour]
    enu: dict[str, Array]
    q_le: Array
    centre: Array
    extent: float

    @classmethod
    def of(cls, truth: Trajectory | None, estimates: Mapping[str, Trajectory], truth_name: str) -> "Tracks":
        """Return the tracks of a run."""
        parts, colours = {name: entity_part(name) for name in estimates}, estimate_colours(estimates)
        shown = {**estimates}
        if truth is not None:
            shown[truth_name], parts[truth_name], colours[truth_name] = truth, TRUTH, TRUTH_COLOUR
        main = shown[next(reversed(shown))]
        q_le = quat_conjugate(main.q_en[0])
        enu = {name: quat_rotate(q_le, track.r_e - main.r_e[0]) for name, track in shown.items()}
        centre, extent = _frame(list(enu.values()))
        return cls(shown, parts, colours, enu, q_le, centre, extent)

    @property
    def body(self) -> float:
        """Half the length of the drawn vehicle, m."""
        return 0.5 * round_down(0.12 * self.extent)

    def log_attitudes(self, rec: rr.RecordingStream, pose_rows: int | None) -> None:
        """Log the attitudes in east-north-up: what is shown last as a vehicle, the others as axes."""
        rec.log("body", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        _log_compass(rec)
        last = next(reversed(self.shown))
        for name, trajectory in self.shown.items():
            entity, rows = f"body/{self.parts[name]}", thinned(trajectory.t, pose_rows)
            t = trajectory.t[rows]
            send_pose(rec, entity, t, np.zeros((len(t), 3)), trajectory.q_nb[rows])
            if name == last:
                _log_body(rec, entity, 1.0, self.colours[name])
            else:
                axes = rr.Arrows3D(vectors=2.2 * np.eye(3), radii=0.02, colors=self.colours[name])
                rec.log(f"{entity}/axes", axes, static=True)

    def log_places(self, rec: rr.RecordingStream, pose_rows: int | None) -> None:
        """Log tracks and moving vehicles with their names, in space and on the map."""
        rec.log("track", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        for k, (name, trajectory) in enumerate(self.shown.items()):
            part, colour, enu = self.parts[name], self.colours[name], self.enu[name]
            rows = thinned(trajectory.t, pose_rows)
            t, q_lb = trajectory.t[rows], quat_normalize(quat_multiply(self.q_le, trajectory.q_eb[rows]))
            send_pose(rec, f"track/bodies/{part}", t, enu[rows], q_lb)
            _log_body(rec, f"track/bodies/{part}", self.body, colour)
            # Above one another, because estimates begin at one place; the truth below.
            above = -3.0 if part == TRUTH else 3.0 + 1.7 * k
            send_tag(rec, f"track/tags/{part}", t, enu[rows] + [0.0, 0.0, above * self.body], name, colour)
            self._log_paths(rec, name)
            place, now = _degrees(trajectory, rows), f"map/now/{part}"
            rec.log(now, rr.GeoPoints.from_fields(radii=rr.Radius.ui_points(5.0), colors=colour), static=True)
            send(rec, now, t, partial(_geo_points, place))

    def _log_paths(self, rec: rr.RecordingStream, name: str) -> None:
        part, trajectory = self.parts[name], self.shown[name]
        thin = thinned(trajectory.t, POINTS)
        look = {"colors": self.colours[name], "radii": rr.Radius.ui_points(3.0 if part == TRUTH else 1.5)}
        rec.log(f"track/paths/{part}", rr.LineStrips3D([self.enu[name][thin]], **look), static=True)
        rec.log(f"map/paths/{part}", rr.GeoLineStrings(lat_lon=[_degrees(trajectory, thin)], **look), static=True)

    def view(self) -> rrb.Spatial3DView:
        """Return the view of the tracks in space."""
        return rrb.Spatial3DView(
            origin="/track",
            name=f"Tracks in east-north-up at the start; vehicle drawn {times(2 * self.body)} m long",
            eye_controls=eye(self.centre + 1.3 * self.extent * EYE, self.centre),
            line_grid=rrb.LineGrid3D(visible=True, spacing=round_down(0.3 * self.extent)),
            spatial_information=rrb.SpatialInformation(target_frame="tf#/track", show_axes=True),
        )

    def attitude_view(self) -> rrb.Spatial3DView:
        """Return the view of the body's attitude in east-north-up."""
        name = next(reversed(self.shown))
        return rrb.Spatial3DView(
            origin="/body",
            name=f"Attitude in east-north-up, {name}; axes x right, y forward, z up",
            eye_controls=eye(3.1 * EYE, (0, 0, 0.3)),
            line_grid=rrb.LineGrid3D(visible=False),
        )

    def map(self) -> rrb.MapView:
        """Return the map; its background is loaded by the viewer, and stays blank where there is no network."""
        return rrb.MapView(origin="/map", name="Map (background needs a network)")


def _frame(tracks: list[Array]) -> tuple[Array, float]:
    """Return centre and radius: the main track whole, and estimates that stay near it.

    One that runs away does not make all others small; but round a main track without extent all are shown.
    """
    low, high = tracks[-1].min(axis=0), tracks[-1].max(axis=0)
    radius = 0.5 * float(np.linalg.norm(high - low))
    if radius < SMALLEST:
        near = tracks
    else:
        near = [track[np.linalg.norm(track - 0.5 * (low + high), axis=1) < 2.0 * radius] for track in tracks]
    points = np.concatenate(near)
    low, high = points.min(axis=0), points.max(axis=0)
    return 0.5 * (low + high), max(SMALLEST, 0.5 * float(np.linalg.norm(high - low)))


def _degrees(trajectory: Trajectory, rows: slice) -> Array:
    return np.stack([trajectory.latitude[rows], trajectory.longitude[rows]], axis=1) / DEG


def _geo_points(place: Array, rows: slice) -> Iterable[Any]:
    return rr.GeoPoints.columns(positions=place[rows])


def _log_body(rec: rr.RecordingStream, entity: str, size: float, colour: Colour) -> None:
    """Log a vehicle: a box with a nose, and its axes."""
    box = rr.Boxes3D(half_sizes=[size * BODY], colors=colour, fill_mode=rr.components.FillMode.Solid)
    rec.log(f"{entity}/box", box, static=True)
    axes = rr.Arrows3D(vectors=2.0 * size * np.eye(3), radii=0.06 * size, colors=AXIS_COLOURS)
    rec.log(f"{entity}/axes", axes, static=True)


def _log_compass(rec: rr.RecordingStream) -> None:
    """Log the directions of east-north-up, named at their ends."""
    ends = 2.6 * np.eye(3)
    rec.log("body/compass", rr.Arrows3D(vectors=ends, radii=0.012, colors=TRUTH_COLOUR), static=True)
    names = rr.Points3D(1.04 * ends, radii=0.01, colors=TRUTH_COLOUR, labels=["east", "north", "up"], show_labels=True)
    rec.log("body/compass/names", names, static=True)
