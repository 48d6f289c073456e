"""The plots of a damping filter beside those of navigation: estimated errors, 3-sigma bands, innovations, weights."""

import numpy as np

from bench._damping_states import SHOWN
from bench.damp import Damped
from bench.errors import Array
from bench.record._navigation_traces import OVERVIEW, TimedPlot
from bench.record.traces import ESTIMATE_COLOURS, TRUTH_COLOUR, Colour, Trace

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
            line = ("NIS", ESTIMATED, stage.t[rows] - start, stage.nis[rows])
            plots.append(_plot(f"filter/nis_{name}", f"Normalised innovation squared of {name}, 2 expected", [line]))
    return plots


def _weights(damped: Damped, t: Array) -> list[TimedPlot]:
    made = damped.estimate
    if made.gamma is None or made.weight is None:
        return []
    colours = [ESTIMATE_COLOURS[k % len(ESTIMATE_COLOURS)] for k in range(len(made.states))]
    shares = [(name, colours[k], t, made.weight[:, k]) for k, name in enumerate(made.states)]
    return [
        _plot("filter/gamma", "Gamma, distrust in velocity-error", [("gamma", WEIGHT, t, made.gamma)]),
        _plot("filter/share", "Share of velocity-error in each fused state", shares),
    ]


def _plot(entity: str, title: str, lines: list[Line]) -> TimedPlot:
    few = [values[np.linspace(0, len(values) - 1, OVERVIEW).astype(int)] for *_, values in lines]
    names, colours = tuple(name for name, *_ in lines), tuple(colour for _, colour, *_ in lines)
    overview = Trace(entity, title, names, colours, np.stack(few, axis=1))
    traces = (
        (t, Trace(f"{entity}/{k}", title, (name,), (colour,), values[:, None]))
        for k, (name, colour, t, values) in enumerate(lines)
    )
    return TimedPlot(overview, tuple(traces))
