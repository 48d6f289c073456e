"""Triads side by side: every estimate's axes on the true ones, the rotation between them exaggerated."""

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from bench.errors import Array
from bench.record._attitude_traces import AttitudeEstimate
from bench.record.drawing import body_shapes, instrumented_body, round_down
from bench.record.instrument import log_shapes
from bench.record.layout import eye
from bench.record.stream import entity_part, send, send_pose
from bench.record.traces import AXIS_COLOURS, TIMELINE, TRUTH_COLOUR, Colour, estimate_colours
from bench.rotation import cross, quat_from_rotvec, quat_multiply, quat_rotate
from bench.units import ARCSEC, DEG

LARGEST_SHOWN = 50 * DEG  # an automatic factor is the roundest one that does not turn an error into more
WIDTH, HEIGHT = 3.2, 4.1  # of the place of one triad, whose axes have the length 1, and of its label
SHAPE = 2.0  # width by height of a view
EYE = np.array([0.45, -0.8, 0.45]) / np.linalg.norm([0.45, -0.8, 0.45])  # from where the views look
RIGHT = np.array([-EYE[1], EYE[0], 0.0]) / np.hypot(EYE[0], EYE[1])  # in the views, as is UP
UP = cross(EYE, RIGHT)
LONGEST_TRAIL = 1.0  # s, for which the tips of the axes leave a trail, but at most a fifth of the run
TOGETHER, APART = "together", "apart"


@dataclass(frozen=True, eq=False)
class Triads:
    """Where each triad stands, and by which factors its error is exaggerated.

    Attributes
    ----------
    estimates : mapping of str to AttitudeEstimate
    model : mujoco.MjModel or None
        The instrument, drawn at the true attitude in a place of its own, the first.
    places : ndarray, shape (k, 3)
        Of the instrument if there is one, and of the estimates.
    largest : dict of str to float, rad
        The largest error of each estimate.
    together : float
        The factor that all errors share.
    apart : dict of str to float
        A factor for each estimate.
    """

    estimates: Mapping[str, AttitudeEstimate]
    model: Any
    places: Array
    largest: dict[str, float]
    together: float
    apart: dict[str, float]

    @property
    def extent(self) -> float:
        """Height of a view that holds all places."""
        return float(max(np.ptp(self.places @ UP) + HEIGHT, (np.ptp(self.places @ RIGHT) + WIDTH) / SHAPE))

    @classmethod
    def of(cls, estimates: Mapping[str, AttitudeEstimate], model: Any, factor: float | None) -> "Triads":
        """Return the triads of some estimates; without a factor it follows from the largest error."""
        largest = {name: float(np.linalg.norm(e.error, axis=1).max()) for name, e in estimates.items()}
        return cls(
            estimates=estimates,
            model=model,
            places=_places(len(estimates) + (model is not None)),
            largest=largest,
            together=_nice_factor(max(largest.values())) if factor is None else factor,
            apart={name: _nice_factor(size) for name, size in largest.items()},
        )

    def log(self, rec: rr.RecordingStream, rows: Mapping[str, slice]) -> None:
        """Log all triads at some of the rows of their estimates."""
        rec.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        colours = estimate_colours(self.estimates)
        for (name, estimate), at in zip(self.estimates.items(), self.places[-len(self.estimates) :], strict=True):
            part, t, q_true = entity_part(name), estimate.t[rows[name]], estimate.q_true[rows[name]]
            place = np.tile(at, (len(t), 1))
            send_pose(rec, f"world/truth/{part}", t, place, q_true)
            _log_axes(rec, f"world/truth/{part}", 1.15, 0.018, [TRUTH_COLOUR])
            size = f"up to {self.largest[name] / ARCSEC:.2g} arcsec"
            self._log_label(rec, f"{TOGETHER}/{part}", at, colours[name], name, size)
            self._log_label(rec, f"{APART}/{part}", at, colours[name], name, f"× {times(self.apart[name])}")
            for row, factor in ((TOGETHER, self.together), (APART, self.apart[name])):
                turn = quat_from_rotvec(factor * estimate.error[rows[name]])
                q = quat_multiply(turn, q_true)
                send_pose(rec, f"world/{row}/{part}", t, place, q)
                _send_trail(rec, f"world/trails/{row}/{part}", t, at, q)
                _log_axes(rec, f"world/{row}/{part}", 1.0, 0.035, AXIS_COLOURS)
        if self.model is not None:
            self._log_instrument(rec, rows)

    def views(self) -> list[rrb.Spatial3DView]:
        """Return one view with the common factor and, if there are several estimates, one with a factor for each."""
        title = f"Axes of the body, true (grey) and estimated; all errors × {times(self.together)}"
        views = [self._view(title, TOGETHER, "+ /world/instrument/**", "+ /world/labels/instrument")]
        if len(self.estimates) > 1:
            views.append(self._view("The same; each error × a factor of its own, beside its name", APART))
        return views

    def _log_label(
        self, rec: rr.RecordingStream, entity: str, place: Array, colour: Colour, name: str, *more: str
    ) -> None:
        """Log a name and more lines below a triad; a label has one line, so that each has its own."""
        unbroken = name.replace(" = ", "\u00a0=\u00a0").replace(". ", ".\u00a0")
        lines = [*textwrap.wrap(unbroken, max(8, int(54 * WIDTH / self.extent))), *more]
        down = 1.05 + 0.06 * self.extent * np.arange(len(lines))
        points = place - down[:, None] * UP
        look = rr.Points3D(points, radii=rr.Radius.ui_points(0.5), colors=colour, labels=lines, show_labels=True)
        rec.log(f"world/labels/{entity}", look, static=True)

    def _log_instrument(self, rec: rr.RecordingStream, rows: Mapping[str, slice]) -> None:
        """Log the instrument as large as a triad, at the truth of the estimate that has most rows."""
        name = max(self.estimates, key=lambda name: len(self.estimates[name].t))
        estimate, entity = self.estimates[name], "world/instrument"
        t, q_true = estimate.t[rows[name]], estimate.q_true[rows[name]]
        send_pose(rec, entity, t, np.tile(self.places[0], (len(t), 1)), q_true)
        shapes = body_shapes(self.model, instrumented_body(self.model))
        arm = max([1e-3, *(float(np.linalg.norm(shape.position)) for shape in shapes)])  # m
        rec.log(f"{entity}/body", rr.Transform3D(scale=1.0 / arm), static=True)
        log_shapes(rec, f"{entity}/body", self.model, shapes)
        self._log_label(rec, "instrument", self.places[0], TRUTH_COLOUR, "true attitude")

    def _view(self, title: str, row: str, *more: str) -> rrb.Spatial3DView:
        centre = self.places.mean(axis=0) - 0.8 * UP
        longest = max(float(e.t[-1] - e.t[0]) for e in self.estimates.values())
        recent = rrb.TimeRangeBoundary.cursor_relative(seconds=-min(LONGEST_TRAIL, 0.2 * longest))
        return rrb.Spatial3DView(
            origin="/world",
            contents=["+ /world/truth/**", *(f"+ /world/{part}{row}/**" for part in ("", "labels/", "trails/")), *more],
            name=title,
            eye_controls=eye(centre + 1.03 * self.extent * EYE, centre),
            line_grid=rrb.LineGrid3D(visible=False),
            time_ranges=rrb.VisibleTimeRange(TIMELINE, start=recent, end=rrb.TimeRangeBoundary.cursor_relative()),
        )


def times(factor: float) -> str:
    """Return a factor as it is printed: 2e8."""
    mantissa, e, exponent = f"{factor:g}".partition("e")
    return f"{mantissa}{e}{int(exponent)}" if e else mantissa


def _nice_factor(largest: float) -> float:
    """Return 1, 2 or 5 times a power of ten, at least 1, that makes a large angle of an error, rad."""
    return max(1.0, round_down(LARGEST_SHOWN / largest)) if largest > 0 else 1.0


def _places(n: int) -> Array:
    """Return n places (n, 3) in rows, from left to right and from top to bottom, that fill a view best."""
    columns = max(range(1, n + 1), key=lambda c: min(SHAPE / (c * WIDTH), 1 / (-(-n // c) * HEIGHT)))
    row, column = np.divmod(np.arange(n), columns)
    return WIDTH * np.outer(column, RIGHT) - HEIGHT * np.outer(row, UP)


def _log_axes(rec: rr.RecordingStream, entity: str, length: float, radius: float, colours: Sequence[Colour]) -> None:
    rec.log(f"{entity}/axes", rr.Arrows3D(vectors=length * np.eye(3), radii=radius, colors=colours), static=True)


def _send_trail(rec: rr.RecordingStream, entity: str, t: Array, place: Array, q: Array) -> None:
    """Send the tips of the three axes as points; the view shows the latest."""
    tips = place + quat_rotate(q[:, None, :], np.eye(3))
    rec.log(entity, rr.Points3D.from_fields(radii=0.02, colors=AXIS_COLOURS), static=True)

    def points(k: slice) -> Iterable[Any]:
        return rr.Points3D.columns(positions=tips[k].reshape(-1, 3)).partition(np.full(len(tips[k]), 3))

    send(rec, entity, t, points)
