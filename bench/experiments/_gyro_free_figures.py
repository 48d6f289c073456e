"""The figures of `gyro-free-circular`: figures 3 and 4 rebuilt, and the printed numbers among the trials."""

import numpy as np

from bench.evaluation import attitude_error, integrated_rate_error, rms
from bench.experiments._gyro_free_published import AXES, PUBLISHED, Focus, Trials
from bench.experiments._gyro_free_trials import READINGS, Options, ideal, solve_trial
from bench.figures import Figure, Line, Panel, Values
from bench.table import Table
from bench.units import DEG

Curve = tuple[Values, Values]
COLOUR = {"six": 1, "nine": 0}


def figures(options: Options, seed: int, trials: Trials, focus: Focus, placed: Table) -> list[Figure]:
    """Return all figures."""
    where = (
        f"Reading: {focus.reading.label}. Lines: trial {focus.trial}, the one nearest to the printed numbers; "
        f"bands: 5 to 95 percent of {options.trials} trials; crosses: printed values."
    )
    return [
        attitude_figure(options, seed, trials, focus, where),
        position_figure(options, seed, trials, focus, where),
        percentile_figure(placed),
        growth_figure(options, trials),
    ]


def _bands(trials: Trials, focus: Focus, system: str, column: str) -> tuple[Values, Values, Values]:
    table = trials.rows[focus.reading.label, system]
    t = np.unique(table["t_s"])
    values = table[column].reshape(-1, len(t))
    low, high = np.percentile(values, [5, 95], axis=0)
    return t, low, high


def _panel(trials: Trials, focus: Focus, column: str, ylabel: str, curves: dict[str, Curve], title: str) -> Panel:
    lines = []
    for system in ("six", "nine"):
        t, low, high = _bands(trials, focus, system, column)
        lines.append(Line("", t, np.full_like(t, np.nan), COLOUR[system], low=low, high=high))
        x, y = curves[system]
        lines.append(Line(f"{system} accelerometers", x, y, COLOUR[system]))
    for number in PUBLISHED:
        if column in number.columns().values() and trials.options.duration == 60.0:
            lines.append(Line("", np.array([60.0]), np.array([number.value]), COLOUR[number.system], "x"))
    return Panel("t, s", ylabel, lines, title)


def attitude_figure(options: Options, seed: int, trials: Trials, focus: Focus, where: str) -> Figure:
    """Return figure 3: attitude errors in time."""
    truth = ideal(options, focus.reading.gravity).truth
    errors = {}
    for system in ("six", "nine"):
        _, found = solve_trial(options, seed, focus.reading, focus.trial, system)
        if focus.definition == "rotation":
            errors[system] = attitude_error(found.q_ib, truth.q_ib) / DEG
        else:
            errors[system] = integrated_rate_error(found.omega_ib_b, truth.omega_ib_b, 1 / options.rate) / DEG
    panels = [
        _panel(
            trials,
            focus,
            f"{focus.definition}_{AXES[axis]}_deg",
            "attitude error, deg",
            {system: (options.t, error[:, axis]) for system, error in errors.items()},
            f"{AXES[axis]} axis",
        )
        for axis in range(3)
    ]
    return Figure("figure_3_attitude_errors", "Attitude errors (figure 3 of the paper)", where, panels)


def position_figure(options: Options, seed: int, trials: Trials, focus: Focus, where: str) -> Figure:
    """Return figure 4: position errors in time, and the paths."""
    truth = ideal(options, focus.reading.gravity).truth
    found = {s: solve_trial(options, seed, focus.reading, focus.trial, s)[1].position for s in ("six", "nine")}
    panels = [
        _panel(
            trials,
            focus,
            f"position_{AXES[axis]}_m",
            "position error, m",
            {system: (options.t, p[:, axis] - truth.position[:, axis]) for system, p in found.items()},
            f"{AXES[axis]} axis",
        )
        for axis in range(2)
    ]
    paths = [Line("truth", truth.position[:, 0], truth.position[:, 1], 6, "--")]
    paths += [Line(f"{s} accelerometers", p[:, 0], p[:, 1], COLOUR[s]) for s, p in found.items()]
    panels.append(Panel("x, m", "y, m", paths, "path", equal=True))
    return Figure("figure_4_position_errors", "Position errors and path (figure 4 of the paper)", where, panels)


def percentile_figure(placed: Table) -> Figure:
    """Return where each printed number lies among the trials of each reading."""
    numbers = list(dict.fromkeys(placed["number"]))
    panels = []
    for definition, title in (("integral", "integral of the rate error"), ("rotation", "rotation vector in n")):
        lines = []
        for k, reading in enumerate(READINGS):
            keep = (placed["reading"] == reading.label) & np.isin(placed["definition"], ("", definition))
            rank = [placed["percentile"][keep & (placed["number"] == name)][0] for name in numbers]
            offset = np.arange(len(numbers)) + 0.08 * (k - 3.5)
            lines.append(Line(reading.label, offset, np.array(rank), k, "o" if k < 7 else "x"))
        lines += [Line("", np.array([-0.5, len(numbers) - 0.5]), np.full(2, p), 6, ":") for p in (2.5, 97.5)]
        panels.append(Panel("", "percentile", lines, title, xticks=[n.replace(", ", "\n") for n in numbers]))
    caption = (
        "Percentile of each printed number among the trials of each reading of the conditions. Between the dotted "
        "lines (2.5 and 97.5) a reading may admit the number; a point outside excludes it."
    )
    return Figure(
        "published_percentiles", "The printed numbers among the trials", caption, panels, columns=1, shared_legend=True
    )


def growth_figure(options: Options, trials: Trials) -> Figure:
    """Return the rms errors of all readings in time, on logarithmic axes."""
    panels = []
    for system in ("six", "nine"):
        for columns, ylabel in (
            ([f"integral_{a}_deg" for a in AXES], "attitude error, deg rms"),
            ([f"position_{a}_m" for a in AXES], "position error, m rms"),
        ):
            lines = []
            for k, reading in enumerate(READINGS):
                table = trials.rows[reading.label, system]
                t = np.unique(table["t_s"])
                values = np.stack([table[c].reshape(-1, len(t)) for c in columns])
                style = "-" if reading.gravity == "gravity" else "--"
                lines.append(Line(reading.label, t, rms(values.reshape(-1, len(t))), k // 2, style))
            panels.append(Panel("t, s", ylabel, lines, f"{system} accelerometers", xscale="log", yscale="log"))
    caption = f"Growth of the errors, rms over axes and {options.trials} trials, in every reading of the conditions."
    return Figure("error_growth", "Growth of the errors", caption, panels, columns=2, shared_legend=True)
