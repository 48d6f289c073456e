"""The figures of `gyro-free-circular`: figures 3 and 4 rebuilt, and the printed numbers among the trials."""

import numpy as np

from bench.evaluation import attitude_error, integrated_rate_error, rms
from bench.experiments._gyro_free_published import AXES, DEFINITIONS, PUBLISHED, Focus, Trials
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
        f"bands: 2.5 to 97.5 percent of {options.trials} trials; crosses: printed values. "
        "Upper row: both systems; lower row: nine accelerometers alone."
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
    low, high = np.percentile(values, [2.5, 97.5], axis=0)
    return t, low, high


def _panels(trials: Trials, focus: Focus, column: str, ylabel: str, curves: dict[str, Curve]) -> list[Panel]:
    """Return the panel of both systems and that of nine accelerometers alone, whose errors vanish beside six."""
    panels = []
    for systems in (("six", "nine"), ("nine",)):
        lines = []
        for system in systems:
            t, low, high = _bands(trials, focus, system, column)
            lines.append(Line("", t, np.full_like(t, np.nan), COLOUR[system], low=low, high=high))
            x, y = curves[system]
            lines.append(Line(f"{system} accelerometers", x, y, COLOUR[system]))
        for number in PUBLISHED:
            shown = number.system in systems and column in number.columns().values()
            if shown and trials.options.duration == 60.0:
                place = np.array([60.0]), np.array([number.value])
                lines.append(Line(f"{number.system}, printed", *place, COLOUR[number.system], "x"))
        panels.append(Panel("t, s", ylabel, lines))
    return panels


def attitude_figure(options: Options, seed: int, trials: Trials, focus: Focus, where: str) -> Figure:
    """Return figure 3: attitude errors in time."""
    truth = ideal(options, focus.reading.gravity).truth
    errors = {}
    for system in ("six", "nine"):
        _, found = solve_trial(focus.work(options, seed), focus.trial, system)
        if focus.definition == "rotation":
            errors[system] = attitude_error(found.q_ib, truth.q_ib) / DEG
        else:
            errors[system] = integrated_rate_error(found.omega_ib_b, truth.omega_ib_b, 1 / options.rate) / DEG
    pairs = [
        _panels(
            trials,
            focus,
            f"{focus.definition}_{AXES[axis]}_deg",
            f"{AXES[axis]}: {DEFINITIONS[focus.definition]}, deg",
            {system: (options.t, error[:, axis]) for system, error in errors.items()},
        )
        for axis in range(3)
    ]
    panels = [pair[row] for row in (0, 1) for pair in pairs]
    return Figure("figure_3_attitude_errors", "Attitude errors (figure 3 of the paper)", where, panels)


def position_figure(options: Options, seed: int, trials: Trials, focus: Focus, where: str) -> Figure:
    """Return figure 4: position errors in time, and the paths."""
    truth = ideal(options, focus.reading.gravity).truth
    found = {s: solve_trial(focus.work(options, seed), focus.trial, s)[1].position for s in ("six", "nine")}
    pairs = [
        _panels(
            trials,
            focus,
            f"position_{AXES[axis]}_m",
            f"position error {AXES[axis]}, m",
            {system: (options.t, p[:, axis] - truth.position[:, axis]) for system, p in found.items()},
        )
        for axis in range(2)
    ]
    paths = []
    for systems in (("six", "nine"), ("nine",)):
        lines = [Line("truth", truth.position[:, 0], truth.position[:, 1], 6, "--")]
        lines += [Line(f"{s} accelerometers", found[s][:, 0], found[s][:, 1], COLOUR[s]) for s in systems]
        paths.append(Panel("x, m", "y, m", lines, equal=True))
    panels = [panel for row in (0, 1) for panel in (pairs[0][row], pairs[1][row], paths[row])]
    return Figure("figure_4_position_errors", "Position errors and path (figure 4 of the paper)", where, panels)


def percentile_figure(placed: Table) -> Figure:
    """Return where each printed number lies among the trials of each reading."""
    numbers = list(dict.fromkeys(placed["number"]))
    panels = []
    for definition, title in (("integral", "integral of the rate error"), ("rotation", "rotation vector in n")):
        lines = []
        for k, reading in enumerate(READINGS):
            keep = (placed["reading"] == reading.label) & np.isin(placed["definition"], ("", definition))
            rows = [int(np.flatnonzero(keep & (placed["number"] == name))[0]) for name in numbers]
            rank, admitted = placed["percentile"][rows], placed["admitted"][rows]
            place = np.arange(len(numbers)) + 0.08 * (k - 3.5)
            lines.append(Line(reading.label, place[admitted], rank[admitted], k, "o"))
            lines.append(Line("", place[~admitted], rank[~admitted], k, "x"))
        lines += [Line("", np.array([-0.5, len(numbers) - 0.5]), np.full(2, p), 6, ":") for p in (2.5, 97.5)]
        panels.append(Panel("", "percentile", lines, title, xticks=[n.replace(", ", "\n") for n in numbers]))
    caption = (
        "Percentile of each printed number among the trials of each reading of the conditions. Dots: the reading "
        "admits the number; crosses: it does not, because the number lies beyond the dotted lines (2.5 and 97.5) or in "
        "a gap between what bias and noise can make."
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
    caption = (
        f"Growth of the errors, rms over axes and {options.trials} trials, in every reading of the conditions. "
        "Gravity and integration rule hardly change the integral of the rate error: those curves coincide."
    )
    return Figure("error_growth", "Growth of the errors", caption, panels, columns=2, shared_legend=True)
