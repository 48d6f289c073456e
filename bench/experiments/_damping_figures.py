"""The figures of `damping-external-velocity`: figures 3 to 5 of the paper, tables, consistency, the undamped INS."""

from typing import Literal

import numpy as np

from bench.evaluation import chi_square_bounds
from bench.experiments._damping_consistency import CONSTANT_ERROR, DRAWN, PERFECT
from bench.experiments._damping_published import BOTH, REFERENCE_ERRORS, TABLES, UNITS
from bench.experiments._damping_results import Results, read_heads
from bench.experiments._damping_scan import BOTH_TABLES
from bench.experiments._damping_trials import AUGMENTED, FILTERS, FIRST, FREE, FUSION, HOUR, SECOND
from bench.experiments._damping_undamped import GYRO_CASE, PERIODS, VELOCITY_CASE, theory
from bench.figures import Figure, Line, Panel
from bench.units import ARCMIN

COLOURS = {FREE: 6, FIRST: 1, SECOND: 0, FUSION: 2, AUGMENTED: 3}
TITLES = ("latitude", "longitude", "phi_E", "phi_N", "phi_U", "v_E", "v_N")


def figures(results: Results) -> list[Figure]:
    """Return all figures."""
    focus = f"constant error of the reference {results.options.focus:g} m/s east and north"
    return [
        _errors(results, "figure_3_attitude", f"Attitude errors, {focus}", (2, 3, 4)),
        _errors(results, "figure_4_position", f"Position errors, {focus}", (0, 1)),
        _errors(results, "figure_5_velocity", f"Velocity errors, {focus}", (5, 6)),
        _undamped_figure(results),
        _table_figure(results),
        _consistency_figure(results),
    ]


def _errors(results: Results, name: str, title: str, columns: tuple[int, ...]) -> Figure:
    panels = []
    for k in columns:
        damped = [_line(results, filter_name, k) for filter_name in FILTERS]
        panels.append(Panel("t, h", f"{TITLES[k]} error, {UNITS[k]}", damped, "damped"))
    free = []
    for k in columns:
        t, errors = results.run(FREE)
        line = Line("", t, errors[:, k], COLOURS[FREE])
        free.append(Panel("t, h", f"{TITLES[k]} error, {UNITS[k]}", [line], "undamped"))
    caption = (
        "Corrected INS minus truth: filter 1 (velocity error), filter 2 (velocity change), their fusion, and one "
        "filter with the error of the reference as two more states; below, the free-running INS."
    )
    return Figure(name, title, caption, [*panels, *free], columns=len(columns))


def _line(results: Results, name: str, column: int) -> Line:
    t, errors = results.run(name)
    return Line(name, t, errors[:, column], COLOURS[name], "--" if name == AUGMENTED else "-")


def _undamped_figure(results: Results) -> Figure:
    panels = []
    expected, found_s = theory(results.options), {name: results.period(name) for name in PERIODS}
    found_h, theory_h = ([period[name] / HOUR for name in PERIODS] for period in (found_s, expected))
    for case, key, scale, unit, title in (
        (VELOCITY_CASE, "e_dv_N", 1.0, "m/s", f"v_N: Schuler, {found_h[0]:.3f} h"),
        (VELOCITY_CASE, "e_dv_E", 1.0, "m/s", f"v_E: turned by Foucault, {found_h[1]:.2f} h"),
        (GYRO_CASE, "e_dL", ARCMIN, "arcmin", f"latitude: the Earth's turn, {found_h[2]:.2f} h"),
    ):
        found = results.table("undamped", FREE, case=case)
        panels.append(Panel("t, h", f"{key[2:]}, {unit}", [Line("", found["t_h"], found[key] / scale, 6)], title))
    caption = (
        f"The undamped INS at rest: an initial velocity error ({VELOCITY_CASE}) shows the Schuler oscillation, "
        f"whose plane turns with Foucault's period; a gyro drift ({GYRO_CASE}) the 24 h one. "
        f"Theory: {theory_h[0]:.3f}, {theory_h[1]:.2f} and {theory_h[2]:.2f} h."
    )
    return Figure("undamped", "Oscillations of the undamped INS at rest", caption, panels)


def _table_figure(results: Results) -> Figure:
    best = results.best(BOTH_TABLES)
    constants = np.array(REFERENCE_ERRORS)
    panels = []
    for k, head in enumerate(read_heads(best.factor)):
        lines = []
        for row, (table, colour) in enumerate(zip(TABLES, (COLOURS[FUSION], COLOURS[FIRST]), strict=True)):
            name = (FUSION, FIRST)[row]
            lines.append(Line(f"{name}, printed ({table})", constants, BOTH[row, :, k], colour, "o"))
            lines.append(Line(f"{name}, best reading", constants, best.tables[row, :, k], colour, "-"))
        panels.append(Panel("constant error, m/s", head, lines))
    caption = f"Tables 1 and 2 against the reading of the unstated conditions that fits both best: {best.label}."
    return Figure("tables", "Steady-state errors against the constant error", caption, panels, 4, shared_legend=True)


def _consistency_figure(results: Results) -> Figure:
    panels = []
    for measure, degrees in (("nees", 13), ("nis", 2)):
        for case in (PERFECT, CONSTANT_ERROR):
            lines = []
            for name in FILTERS:
                if name == FUSION and measure == "nis":
                    continue
                shown = DRAWN if name == AUGMENTED and case == PERFECT else case
                t, values = results.consistency(shown, name, measure)
                k = 15 if name == AUGMENTED and measure == "nees" else degrees
                lines.append(Line(f"{name}", t, values / k, COLOURS[name]))
            low, high = (bound / degrees for bound in chi_square_bounds(degrees, results.options.trials))
            ends = np.array([t[0], t[-1]])
            lines.append(Line("expected, 95 % bounds", ends, np.ones(2), 7, ":", np.full(2, low), np.full(2, high)))
            scale: Literal["linear", "log"] = "linear" if (measure, case) == ("nees", PERFECT) else "log"
            title = "reference as believed" if case == PERFECT else f"reference off by {results.options.focus:g} m/s"
            panels.append(Panel("t, h", f"{measure.upper()} / degrees of freedom", lines, title, yscale=scale))
    caption = (
        f"Normalised squares of errors (NEES) and of innovations (NIS), means over {results.options.trials} trials of "
        "errors drawn as the filters believe them. 1 is consistent; above, a filter claims to be better than it is. "
        "The fusion has no innovation, so no NIS."
    )
    return Figure("consistency", "Consistency", caption, panels, columns=2)
