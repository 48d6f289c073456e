"""The plots of a dual-Euler run: both sets of angles, flag, jump of the plain angles, errors; knows no viewer."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from bench.errors import Array, InputError, require_array, require_times
from bench.record.traces import ESTIMATE_COLOURS, TRUTH_COLOUR, Trace
from bench.rotation import wrap
from bench.units import ARCMIN, DEG

ANGLES = ("heading", "pitch", "roll")
PLAIN, ACTIVE, REVERSE, FORWARD = ESTIMATE_COLOURS[0], ESTIMATE_COLOURS[1], ESTIMATE_COLOURS[2], ESTIMATE_COLOURS[6]
FLAG = ESTIMATE_COLOURS[5]
SETS = ("true", "true_active", "output", "plain", "forward", "reverse")
ROUND = 10.0  # s, round the passage of a pole that is shown on its own


@dataclass(frozen=True, eq=False)
class DualEulerRun:
    """What one recording of the dual-Euler method shows.

    Attributes
    ----------
    title : str
    t : ndarray, shape (n,), s
    angles : dict of str to ndarray, shape (n, 3), rad
        Heading, pitch and roll; ``true``: of the forward set, continuous, which are the axes of the table;
        ``true_active`` and ``output``: of the active set, true and estimated; ``plain``: of the estimate as commonly
        extracted; ``forward`` and ``reverse``: of the estimate, continued.
    errors : ndarray, shape (n, 3), rad
        In the active set.
    flag : ndarray, shape (n,)
        1 forward, -1 reverse.
    plain_t, plain : ndarray, shape (m,), s, and (m, 3), rad
        The quaternion method's angles as commonly extracted.
    model : mujoco.MjModel
        The table: joints heading, pitch and roll in a chain.
    configuration, results : str
        Markdown.
    parameters : dict of str to str, float or int
        Shown in the viewer's table of recordings.
    figures : dict of str to Path
        PNG files, by title.

    Raises
    ------
    InputError
        If times do not increase, or a set of angles is missing or has another shape.
    """

    title: str
    t: Array
    angles: dict[str, Array]
    errors: Array
    flag: Array
    plain_t: Array
    plain: Array
    model: Any
    configuration: str
    results: str
    parameters: dict[str, str | float | int] = field(default_factory=dict)
    figures: dict[str, Path] = field(default_factory=dict)

    def __post_init__(self) -> None:
        n = len(require_times("t", self.t))
        for name in SETS:
            if name not in self.angles:
                raise InputError(f"angles must have {', '.join(SETS)}; {name} is missing")
            require_array(f"angles[{name!r}]", self.angles[name], (n, 3))
        require_array("errors", self.errors, (n, 3))
        require_array("flag", self.flag, (n,))
        require_array("plain", self.plain, (len(require_times("plain_t", self.plain_t)), 3))

    @property
    def passage(self) -> tuple[float, float]:
        """Seconds round the passage of a pole at which the plain heading is farthest off."""
        off = np.abs(wrap(self.angles["plain"][:, 0] - self.angles["true"][:, 0]))
        middle = float(self.t[int(off.argmax())])
        return middle - ROUND, middle + ROUND


Timed = tuple[Array, Trace]


def dual_euler_plots(run: DualEulerRun) -> dict[str, list[Timed]]:
    """Return the plots by page: each a list of times and lines.

    Scene: pitch, flag, and the heading of the quaternion method beside that of dual Euler. Sets: every angle in both
    sets. Errors: in the active set, arcmin. Jump: the angles of the sets page for seconds round the pole.
    """
    t, degrees = run.t, {name: values / DEG for name, values in run.angles.items()}
    pitch = _trace("scene/pitch", "Pitch, deg", {"true": TRUTH_COLOUR, "dual Euler": ACTIVE}, degrees, 1, "true output")
    flag = Trace("scene/flag", "Flag: 1 forward, -1 reverse", ("flag",), (FLAG,), run.flag[:, None])
    plain = Trace("scene/heading/forward", "Heading, deg", ("quaternion, forward",), (PLAIN,), run.plain[:, :1] / DEG)
    active = _trace("scene/heading/set", "Heading, deg", {"dual Euler, active": ACTIVE}, degrees, 0, "output")
    sets = []
    for k, angle in enumerate(ANGLES):
        colours = {"forward, plain": PLAIN, "forward, continued": FORWARD, "reverse": REVERSE, "active": ACTIVE}
        title = f"{angle.capitalize()}, deg"
        sets.append((t, _trace(f"sets/{angle}", title, colours, degrees, k, "plain forward reverse output")))
    errors = [
        (
            t,
            Trace(
                f"errors/{angle}",
                f"{angle.capitalize()} error, arcmin",
                (angle,),
                (ACTIVE,),
                run.errors[:, [k]] / ARCMIN,
            ),
        )
        for k, angle in enumerate(ANGLES)
    ]
    return {
        "Scene": [(t, pitch), (t, flag), (run.plain_t, plain), (t, active)],
        "Both sets": sets,
        "Errors": errors,
    }


def _trace(
    entity: str, title: str, colours: dict[str, Any], degrees: dict[str, Array], angle: int, kinds: str
) -> Trace:
    values = np.stack([degrees[kind][:, angle] for kind in kinds.split()], axis=1)
    return Trace(entity, title, tuple(colours), tuple(colours.values()), values)
