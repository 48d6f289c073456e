"""The plots of a damping filter beside those of navigation: estimated errors, 3-sigma bands, innovations, weights."""

import numpy as np

from bench._damp_report import HIGH
from bench._damping_states import SHARES, SHOWN
from bench.damp import Damped
from bench.errors import Array, Indices
from bench.record._navigation_traces import OVERVIEW, TimedPlot
from bench.record.traces import AXIS_COLOURS, ESTIMATE_COLOURS, FLOOR, TRUTH_COLOUR, Colour, Trace

BAND: Colour = (110, 150, 190)
ESTIMATED, WEIGHT = ESTIMATE_COLOURS[1], ESTIMATE_COLOURS[0]  # of the filter, which is the second estimate

Line = tuple[str, Colour, Array, Array]  # name, colour, times and values


def filter_plots(damped: Damped, start: float) -> dict[str, list[TimedPlot]]:
    """Return the plots by page; times are counted from `start`."""
    made, judged = damped.estimate, damped.comparison
    t, states = made.t - start, []
    for k, (name, shown) in enumerate(zip(made.states, SHOWN, strict=False)):
        x, band = made.x[:, k] / shown.scale, 3 * made.sigma[:, k] / shown.scale
        lines = [("+3 sigma", BAND, t, x + band), ("-3 sigma", BAND, t, x - band)]
        if judged is not None and damped.true_errors is not None and k < damped.true_errors.shape[1]:
            true = damped.true_errors[:, k] / shown.scale
            lines.append(("against the reference", TRUTH_COLOUR, judged.reference.t - start, true))
        lines.append(("estimated", ESTIMATED, t, x))
        states.append(_plot(f"filter/{name}", shown.title[0].upper() + shown.title[1:], lines))
    return {"Estimated errors": states, "Filter": [*_innovations(damped, start), *_weights(damped, t)]}


def _innovations(damped: Damped, start: float) -> list[TimedPlot]:
    plots = []
    for name, stage in damped.stages.items():
        rows = np.isfinite(stage.nis)
        if rows.any():
            t, nis = stage.t[rows] - start, np.log10(np.maximum(stage.nis[rows], FLOOR))
            lines = [("NIS", ESTIMATED, t, nis), ("99 %", TRUTH_COLOUR, t, np.full(len(t), np.log10(HIGH)))]
            title = f"log10 of the normalised innovation squared of {name}"
            plots.append(_plot(f"filter/nis_{name}", title, lines, logarithmic=True))
    return plots


def _weights(damped: Damped, t: Array) -> list[TimedPlot]:
    made = damped.estimate
    if made.gamma is None or made.weight is None:
        return []
    plots = [_plot("filter/gamma", "Gamma, distrust in velocity-error", [("gamma", WEIGHT, t, made.gamma)])]
    for k, (title, columns) in enumerate(SHARES.items()):
        values = made.weight[:, list(columns.values())]
        colours = AXIS_COLOURS[: len(columns)]
        trace = Trace(f"filter/share/{k}", f"Share of velocity-error: {title}", tuple(columns), colours, values)
        plots.append(TimedPlot(trace, ((t, trace),)))
    return plots


def _plot(entity: str, title: str, lines: list[Line], *, logarithmic: bool = False) -> TimedPlot:
    few = [values[_overview(values)] for *_, values in lines]
    names, colours = tuple(name for name, *_ in lines), tuple(colour for _, colour, *_ in lines)
    overview = Trace(entity, title, names, colours, np.stack(few, axis=1), logarithmic)
    traces = (
        (t, Trace(f"{entity}/{k}", title, (name,), (colour,), values[:, None], logarithmic))
        for k, (name, colour, t, values) in enumerate(lines)
    )
    return TimedPlot(overview, tuple(traces))


def _overview(values: Array) -> Indices:
    """Return a few rows, and among them the largest, which the range of a logarithmic plot must hold."""
    rows = np.linspace(0, len(values) - 1, OVERVIEW).astype(np.intp)
    rows[OVERVIEW // 2] = np.argmax(values)
    return rows
