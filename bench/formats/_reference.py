"""What the formats share in reading reference trajectories: checks with lines, rows in geodetic terms."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from bench.earth import Earth
from bench.errors import Array, InputError
from bench.recording import require_finite_rows
from bench.trajectory import Trajectory

Where = Callable[[int], str]


def geodetic_reference(
    path: Path,
    earth: Earth,
    t: Array,
    q_nb: Array,
    v_n: Array,
    position: tuple[ArrayLike, ArrayLike, ArrayLike],
    where: Where,
) -> Trajectory:
    """Return a trajectory of latitude, longitude, height (rad, m), ENU velocity and q_nb.

    Raises
    ------
    InputError
        If a value is not finite, the times do not increase, or a latitude exceeds pi/2; naming file and line.
    """
    latitude, longitude, height = (np.asarray(value, dtype=float) for value in position)
    require_rows(path, t, np.column_stack([q_nb, v_n, latitude, longitude, height]), where)
    # A radian more than the range of the angle means degrees, or columns in another order.
    for name, angle, limit in (("latitude", latitude, np.pi / 2), ("longitude", longitude, 2 * np.pi)):
        if (wrong := np.abs(angle) > limit).any():
            k = int(np.argmax(wrong))
            raise InputError(
                f"{path}, {where(k)}: {name} must be within {limit:.4g} rad, got {angle[k]:.6g} rad; "
                "check unit and order of the columns"
            )
    return Trajectory.from_geodetic(earth, t, q_nb, v_n, latitude, longitude, height)


def require_rows(path: Path, t: Array, values: Array, where: Where) -> None:
    """Check that times increase and all values are finite.

    Raises
    ------
    InputError
        Otherwise; naming file and line.
    """
    require_finite_rows(str(path), t, values, where=where)
    wrong = np.diff(t) <= 0
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InputError(
            f"{path}: times must increase, {np.count_nonzero(wrong)} do not, first after {where(k)} "
            f"(t = {float(t[k])!r} to {float(t[k + 1])!r} s); sort the file by time"
        )
