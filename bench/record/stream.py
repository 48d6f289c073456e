"""Writing a recording: the file, and columns of scalars, poses and tags over time, in chunks."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from bench.errors import Array, OutputError, require_scalar
from bench.record.traces import TIMELINE, TRUTH_COLOUR, Colour, Trace
from bench.table import replacing

CHUNK = 4096  # rows a chunk: several times faster and leaner than one big chunk, and far more than row by row


@contextmanager
def recording(
    path: Path, title: str, parameters: Mapping[str, str | float | int], blueprint: rrb.Blueprint
) -> Iterator[rr.RecordingStream]:
    """Give a stream to log to; the file is written when the block ends, under a temporary name and then renamed.

    Parameters
    ----------
    path : Path
    title : str
        Shown in the viewer's list of recordings.
    parameters : mapping of str to str, float or int
        Shown in the viewer's table of recordings.
    blueprint : Blueprint
        The layout.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    strict = rr.strict_mode()
    rr.set_strict_mode(True)  # else wrong arguments only warn
    try:
        # In memory first: rerun's own file writer hangs when the disk is full.
        with rr.RecordingStream("strapbench") as rec:
            memory = rec.memory_recording()
            rec.send_blueprint(blueprint)
            rec.send_recording_name(title)
            if parameters:
                rec.send_property("run", rr.AnyValues(**parameters))
            yield rec
            content = memory.drain_as_bytes()
    finally:
        rr.set_strict_mode(strict)
    _write(path, content)


def _write(path: Path, content: bytes) -> None:
    try:
        with replacing(path) as temporary:
            temporary.write_bytes(content)
    except OSError as error:
        raise OutputError(f"recording {str(path)!r} cannot be written: {error.strerror}") from error


def rows_at(t: Array, name: str, rate: float | None) -> slice:
    """Return every k-th row, so that at most `rate` rows a second remain; None keeps all.

    Raises
    ------
    InputError
        If the rate is not positive; `name` names it.
    """
    if rate is None or len(t) < 2:
        return slice(None)
    own = (len(t) - 1) / (t[-1] - t[0])
    return slice(None, None, max(1, int(np.ceil(own / require_scalar(name, rate, positive=True) - 1e-9))))


def entity_part(name: str) -> str:
    """Return a name as one part of an entity path."""
    return rr.escape_entity_path_part(name)


def xyzw(q: Array) -> Array:
    """Return quaternions wxyz in rerun's order."""
    return np.roll(q, -1, axis=-1)


def send(rec: rr.RecordingStream, entity: str, t: Array, columns: Callable[[slice], Iterable[Any]]) -> None:
    """Send rows at times t, s, in chunks; `columns` makes the component columns of a slice of rows."""
    # Integers: rerun truncates float seconds, which is 1 ns off for some.
    ns = np.round(t * 1e9).astype(np.int64).astype("timedelta64[ns]")
    for start in range(0, len(ns), CHUNK):
        rows = slice(start, min(start + CHUNK, len(ns)))
        rec.send_columns(entity, [rr.TimeColumn(TIMELINE, duration=ns[rows])], columns(rows))


def send_pose(rec: rr.RecordingStream, entity: str, t: Array, position: Array, q: Array) -> None:
    """Send positions (n, 3), m, and quaternions (n, 4), wxyz, that take the entity's frame to its parent's."""
    send(rec, entity, t, lambda k: rr.Transform3D.columns(translation=position[k], quaternion=xyzw(q[k])))


def send_tag(rec: rr.RecordingStream, entity: str, t: Array, position: Array, text: str, colour: Colour) -> None:
    """Send a name that moves with a body but does not turn with it."""
    look = rr.Points3D.from_fields(radii=rr.Radius.ui_points(1.5), colors=colour, labels=text, show_labels=True)
    rec.log(entity, look, static=True)
    send(rec, entity, t, lambda k: rr.Points3D.columns(positions=position[k]))


def send_trace(rec: rr.RecordingStream, t: Array, trace: Trace, rows: slice, width: float = 1.5) -> None:
    """Send the lines of one plot, with their look; the truth is drawn wider than the given width, pixels."""
    widths = [2.5 if colour == TRUTH_COLOUR else width for colour in trace.colours]
    # The default aggregation halves spikes of a single sample.
    style = rr.SeriesLines(colors=trace.colours, names=trace.series, widths=widths, aggregation_policy="MinMax")
    rec.log(trace.entity, style, static=True)
    values = np.ascontiguousarray(trace.values[rows])
    send(rec, trace.entity, t[rows], lambda k: rr.Scalars.columns(scalars=values[k]))


def log_figures(rec: rr.RecordingStream, figures: Iterable[Path]) -> None:
    """Log PNG files; ``bench.record.layout.figure_tabs`` shows them."""
    for k, figure in enumerate(figures):
        image = rr.EncodedImage(contents=Path(figure).read_bytes(), media_type="image/png")
        rec.log(f"figures/{k}", image, static=True)


def log_texts(rec: rr.RecordingStream, *, configuration: str, results: str) -> None:
    """Log the two texts, Markdown."""
    for entity, text in (("configuration", configuration), ("results", results)):
        rec.log(entity, rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True)
