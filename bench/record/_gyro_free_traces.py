"""The plots of a gyro-free run: errors, rates and readings, by the page on which they stand; knows no viewer."""

from collections.abc import Mapping

import numpy as np

from bench.errors import Array
from bench.record.traces import (
    AXES,
    AXIS_COLOURS,
    FLOOR,
    TRUTH_COLOUR,
    Colour,
    Trace,
    estimate_colours,
)
from bench.rotation import quat_conjugate, quat_multiply, rotvec_from_quat
from bench.signals import Accelerometers, GyroFreeSolution, Kinematics, Readings
from bench.units import DEG


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
        traces.append(
            Trace(
                f"error/attitude_{axis}",
                f"Attitude error about {axis} of i (rotation vector), deg",
                *lines,
                attitude[:, k],
            )
        )
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
