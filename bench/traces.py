"""The lines that a recording plots over time: errors, rates and readings of a run, as plain arrays.

Knows no viewer. A `Trace` is one plot; `gyro_free_traces` makes the plots of every
page for gyro-free estimates of one motion.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.errors import Array
from bench.rotation import quat_conjugate, quat_multiply, rotvec_from_quat
from bench.signals import Accelerometers, GyroFreeSolution, Kinematics, Readings
from bench.units import DEG

Colour = tuple[int, int, int]

TIMELINE = "sim_time"
FLOOR = 1e-12  # smallest error on a logarithmic axis
AXES = ("x", "y", "z")

# Mid-tones, readable on a dark and on a light background.
TRUTH_COLOUR: Colour = (140, 146, 156)
AXIS_COLOURS: tuple[Colour, ...] = ((222, 74, 66), (60, 168, 92), (66, 126, 230))
ESTIMATE_COLOURS: tuple[Colour, ...] = (
    (235, 137, 32),
    (32, 160, 176),
    (176, 92, 204),
    (150, 150, 40),
    (214, 84, 140),
    (110, 110, 220),
)


@dataclass(frozen=True, eq=False)
class Trace:
    """One plot of lines over time.

    Attributes
    ----------
    entity : str
        Where it is stored.
    title : str
        With the unit.
    series : tuple of str
        Name of each line.
    colours : tuple of Colour
    values : ndarray, shape (n, len(series))
    logarithmic : bool
        Whether the values are log10 of an error.
    """

    entity: str
    title: str
    series: tuple[str, ...]
    colours: tuple[Colour, ...]
    values: Array
    logarithmic: bool = False

    def display_range(self) -> tuple[float, float]:
        """Return whole decades that hold the values, but for the lowest 2 %.

        Estimates begin at the truth: the first samples would squeeze all others into a strip.
        """
        low, high = np.floor(np.quantile(self.values, 0.02)), np.ceil(self.values.max())
        return float(low), float(max(high, low + 1.0))

    def empty_corner(self) -> str:
        """Return the corner where a legend hides least: LeftTop, LeftBottom, RightTop or RightBottom."""
        low, high = self.display_range() if self.logarithmic else (self.values.min(), self.values.max())
        height = (self.values - low) / max(high - low, np.finfo(float).tiny)
        n = len(height)
        sides = {"Right": height[-max(1, n // 5) :], "Left": height[: max(1, n // 5)]}
        covered = {
            f"{side}{edge}": float(np.mean(part < 0.4 if edge == "Bottom" else part > 0.6))
            for side, part in sides.items()
            for edge in ("Bottom", "Top")
        }
        return min(covered, key=lambda corner: covered[corner])


def estimate_colours(names: Mapping[str, object]) -> dict[str, Colour]:
    """Return one colour per estimate, in their order."""
    return {name: ESTIMATE_COLOURS[k % len(ESTIMATE_COLOURS)] for k, name in enumerate(names)}


def gyro_free_traces(
    truth: Kinematics,
    estimates: Mapping[str, GyroFreeSolution],
    accelerometers: Accelerometers,
    readings: Readings,
) -> dict[str, list[Trace]]:
    """Return the plots of every page, by the page's name.

    The attitude error is the rotation vector from the true to the estimated attitude, in i.
    """
    pages = {} if not estimates else {"Errors": _sizes(truth, estimates), "Errors by axis": _by_axis(truth, estimates)}
    return {**pages, "Rate": _rates(truth, estimates), "Readings": _readings(accelerometers, readings)}


def _attitude_deg(truth: Kinematics, estimate: GyroFreeSolution) -> Array:
    return rotvec_from_quat(quat_multiply(estimate.q_ib, quat_conjugate(truth.q_ib))) / DEG


def _position(truth: Kinematics, estimate: GyroFreeSolution) -> Array:
    return estimate.position - truth.position


def _rate(truth: Kinematics, estimate: GyroFreeSolution) -> Array:
    return estimate.omega_ib_b - truth.omega_ib_b


def _sizes(truth: Kinematics, estimates: Mapping[str, GyroFreeSolution]) -> list[Trace]:
    traces = []
    for key, title, error in (
        ("attitude", "log10 of attitude error, deg", _attitude_deg),
        ("position", "log10 of position error, m", _position),
        ("rate", "log10 of rate error, rad/s", _rate),
    ):
        sizes = [np.linalg.norm(error(truth, estimate), axis=1) for estimate in estimates.values()]
        values = np.log10(np.maximum(np.stack(sizes, axis=1), FLOOR))
        traces.append(Trace(f"error/{key}", title, *_lines(estimates), values, logarithmic=True))
    return traces


def _by_axis(truth: Kinematics, estimates: Mapping[str, GyroFreeSolution]) -> list[Trace]:
    """Attitude and position in turn, for a grid of two columns."""
    attitude = np.stack([_attitude_deg(truth, estimate) for estimate in estimates.values()], axis=2)
    position = np.stack([_position(truth, estimate) for estimate in estimates.values()], axis=2)
    lines = _lines(estimates)
    traces = []
    for k, axis in enumerate(AXES):
        traces.append(Trace(f"error/attitude_{axis}", f"Attitude error about {axis}, deg", *lines, attitude[:, k]))
        traces.append(Trace(f"error/position_{axis}", f"Position error along {axis}, m", *lines, position[:, k]))
    return traces


def _rates(truth: Kinematics, estimates: Mapping[str, GyroFreeSolution]) -> list[Trace]:
    names, colours = _lines(estimates)
    # The truth last: it is drawn above the noise.
    rates = np.stack([*(estimate.omega_ib_b for estimate in estimates.values()), truth.omega_ib_b], axis=2)
    return [
        Trace(f"rate/{axis}", f"Rate about body {axis}, rad/s", (*names, "true"), (*colours, TRUTH_COLOUR), rates[:, k])
        for k, axis in enumerate(AXES)
    ]


def _readings(accelerometers: Accelerometers, readings: Readings) -> list[Trace]:
    """Three channels a plot: a triad, or three arms."""
    traces = []
    for start in range(0, len(accelerometers), 3):
        channels = accelerometers.names[start : start + 3]
        values = readings.accelerometers[:, start : start + 3]
        title = f"Accelerometers {', '.join(channels)}, m/s^2"
        traces.append(Trace(f"readings/{start // 3}", title, channels, AXIS_COLOURS[: len(channels)], values))
    return traces


def _lines(estimates: Mapping[str, GyroFreeSolution]) -> tuple[tuple[str, ...], tuple[Colour, ...]]:
    return tuple(estimates), tuple(estimate_colours(estimates).values())
