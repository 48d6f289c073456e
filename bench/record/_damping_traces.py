"""The plots of a run of damping filters: errors with 3-sigma bands, sensor errors, weights; knows no viewer."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench._damping_states import SHARES, SHOWN
from bench.errors import Array
from bench.record.traces import AXIS_COLOURS, ESTIMATE_COLOURS, Colour, Trace

Estimates = Mapping[str, tuple[Array, Array]]  # errors and sigma, shape (n, k) each, by name
NAVIGATION = {  # titles by state, in the order of the views
    2: "Latitude error, arcmin",
    3: "Longitude error, arcmin",
    0: "Velocity error east, m/s",
    1: "Velocity error north, m/s",
    4: "phi_E, arcmin",
    5: "phi_N, arcmin",
    6: "phi_U, arcmin",
}
UNDAMPED = "undamped INS"
SENSORS = {
    7: "Left of accelerometer x, micro-g",
    10: "Left of eps x, deg/h (minus the gyro's error)",
    8: "Left of accelerometer y, micro-g",
    11: "Left of eps y, deg/h",
    9: "Left of accelerometer z, micro-g",
    12: "Left of eps z, deg/h",
}
FAINT = 0.45  # how much of its colour a band keeps


@dataclass(frozen=True, eq=False)
class Plot:
    """One pair of axes: main lines for the layout, all lines with their widths in pixels, and the range shown."""

    overview: Trace
    lines: tuple[tuple[Trace, float], ...]
    extent: tuple[float, float] | None = None


def navigation_plots(estimates: Estimates, undamped: Array, colours: Mapping[str, Colour]) -> list[Plot]:
    """Return latitude, longitude, velocities and angles: what is left, +-3 sigma of every filter, and the free INS."""
    return [_plot(f"error/{k}", title, k, estimates, colours, undamped[:, k]) for k, title in NAVIGATION.items()]


def sensor_plots(estimates: Estimates, colours: Mapping[str, Colour]) -> list[Plot]:
    """Return what is left of the sensors' errors, with +-3 sigma."""
    return [_plot(f"sensor/{k}", title, k, estimates, colours, None) for k, title in SENSORS.items()]


def _plot(
    entity: str,
    title: str,
    state: int,
    estimates: Estimates,
    colours: Mapping[str, Colour],
    free: Array | None,
) -> Plot:
    lines: list[tuple[Trace, float]] = []
    shown, scale = [], SHOWN[state].scale
    for k, (name, (errors, sigma)) in enumerate(estimates.items()):
        value, band = errors[:, state] / scale, 3 * sigma[:, state] / scale
        colour = colours[name]
        faint: Colour = tuple(round(FAINT * part + (1 - FAINT) * 128) for part in colour)  # type: ignore[assignment]
        pair = np.stack([band, -band], axis=1)
        names = f"{name}, +3 sigma", f"{name}, -3 sigma"
        # A legend stands in the order of the entities: estimates before bands.
        lines.append((Trace(f"{entity}/sigma_{k}", title, names, (faint, faint), pair), 0.7))
        lines.append((Trace(f"{entity}/filter_{k}", title, (name,), (colour,), value[:, None]), 2.0))
        shown.append(value)
    if free is not None:
        line = Trace(f"{entity}/free", title, (UNDAMPED,), (colours[UNDAMPED],), (free / scale)[:, None])
        lines.append((line, 1.0))
    overview = Trace(
        entity, title, tuple(estimates), tuple(colours[name] for name in estimates), np.stack(shown, axis=1)
    )
    return Plot(overview, tuple(lines), _extent(overview.values))


def _extent(values: Array) -> tuple[float, float]:
    """Return the range of damped errors once they have settled a little; undamped ones would squeeze them."""
    later = values[len(values) // 24 :]
    low, high = min(float(later.min()), 0.0), max(float(later.max()), 0.0)
    margin = 0.15 * (high - low) or 1.0
    return low - margin, high + margin


def weight_plots(weight: Array, gamma: Array) -> list[Plot]:
    """Return the share of filter 1 in the fused states, and gamma."""
    plots = []
    for k, group in enumerate(("position", "velocity", "attitude")):
        states = SHARES[group]
        values = weight[:, list(states.values())]
        trace = Trace(f"fusion/{k}", f"Share of filter 1: {group}", tuple(states), AXIS_COLOURS[: len(states)], values)
        plots.append(Plot(trace, ((trace, 1.5),)))
    trace = Trace("fusion/gamma", "gamma: distrust in filter 1", ("gamma",), ESTIMATE_COLOURS[:1], gamma[:, None])
    return [*plots, Plot(trace, ((trace, 1.5),))]
