"""The maps of `attitude-limits`: which solver errs least in every cell, how far each one reaches, and figures."""

import numpy as np

from bench.errors import Array
from bench.experiments._attitude_limits_solvers import SHORT_NAMES
from bench.experiments._attitude_limits_trials import STREAMS, Options
from bench.figures import Figure, HeatMap, Line, Panel
from bench.table import Table

ALIKE = 2.0  # errors within this factor of the least are alike,
FLOOR = 1e-13  # rad, and so are those below
REACHES = (1e-6, 1e-9)  # rad
LINES = ("P1", "RVp3", "RVo3", "RVo6", "TQ3", "TQ6", "H4", "H8", "FQ8", "C12/4", "W8/4", "W12/4")
MAPS = ("RVp3", "RVo3", "RVe4", "TQ3", "TD4", "TQ6", "RKq2", "H4", "FQ8", "C12/4", "W8/4", "W12/4")
SCALE = (-15.0, 0.0)  # decades of rad


def cell_table(rows: Table) -> Table:
    """Return the rows of the map."""
    return rows.where(stream="")


def grid(rows: Table, code: str, column: str) -> Array:
    """Return a column of one solver as a map, shape (half angles, frequencies); NaN where it refuses."""
    own = rows.where(stream="", code=code)
    angles, frequencies = np.unique(own["half_angle_deg"]), np.unique(own["relative_frequency"])
    values = np.full((len(angles), len(frequencies)), np.nan)
    at = np.searchsorted(angles, own["half_angle_deg"]), np.searchsorted(frequencies, own["relative_frequency"])
    values[at] = own[column]
    return values


def codes(rows: Table) -> list[str]:
    """Return all solvers of the map, those preferred among equals first: no latency, simple algorithm, small N."""
    found = cell_table(rows)
    families = list(SHORT_NAMES)
    key = {}
    for code, label, latency, samples in zip(
        *(found[name].tolist() for name in ("code", "label", "latency", "samples")), strict=True
    ):
        family = label.partition(",")[0]
        rank = families.index(family) if family in families else len(families)
        key[code] = (latency, rank, samples, code)
    return sorted(key, key=lambda code: key[code])


def best(rows: Table, chosen: list[str]) -> tuple[np.ndarray, Array]:
    """Return the code of the best solver in every cell, and its error, rad; NaN and "" where all refuse.

    The best is the first of the chosen whose error is at most twice the least, or below 1e-13 rad.
    """
    errors = np.array([grid(rows, code, "error_rad") for code in chosen])
    known = np.where(np.isnan(errors), np.inf, errors)
    first = (known <= np.maximum(ALIKE * known.min(axis=0), FLOOR)).argmax(axis=0)
    value = np.take_along_axis(known, first[np.newaxis], axis=0)[0]
    names = np.where(np.isinf(value), "", np.array(chosen)[first])
    return names, np.where(np.isinf(value), np.nan, value)


def without_latency(rows: Table) -> list[str]:
    """Return the solvers that borrow nothing from the future."""
    immediate = set(cell_table(rows).where(latency=0)["code"].tolist())
    return [code for code in codes(rows) if code in immediate]


def tables(options: Options, rows: Table) -> dict[str, Table]:
    """Return the maps and the streams as tables."""
    return {
        "streams": stream_table(rows),
        "best": best_table(options, rows, codes(rows), "The best solver, and its error, rad"),
        "best_without_latency": best_table(
            options, rows, without_latency(rows), "The best solver that borrows nothing from the future, and its error"
        ),
        "reach": reach_table(options, rows),
        "codes": code_table(rows),
    }


def stream_table(rows: Table) -> Table:
    """Return the largest error of every solver on the three streams, rad."""
    parts = [rows.where(stream=stream.name) for stream in STREAMS]
    columns = {"code": parts[0]["code"], "solver": parts[0]["label"], "latency": parts[0]["latency"]}
    for stream, part in zip(STREAMS, parts, strict=True):
        columns[stream.name] = np.array(
            [
                f"{e:.2g}" if s == "ok" else f"{e:.2g} ({s})" if e == e else s
                for e, s in zip(part["error_rad"], part["status"], strict=True)
            ]
        )
    return Table(columns, "Largest error on the three streams at 100 Hz, through the rig, rad")


def best_table(options: Options, rows: Table, chosen: list[str], title: str) -> Table:
    """Return the best solver and its error: a row per relative frequency, a column per half angle."""
    names, errors = best(rows, chosen)
    columns = {"relative frequency": np.array([f"{f:.3g}" for f in options.relative_frequencies])}
    for k, angle in enumerate(options.half_angles_deg):
        columns[f"{angle:g} deg"] = np.array(
            [f"{name} {error:.1e}" if name else "none" for name, error in zip(names[k], errors[k], strict=True)]
        )
    return Table(columns, title)


def reach_table(options: Options, rows: Table) -> Table:
    """Return the highest relative frequency up to which each solver errs less than some angles."""
    frequencies = options.relative_frequencies
    found = []
    for code in codes(rows):
        own = grid(rows, code, "error_rad")
        reach = []
        for k in representative(options):
            for limit in REACHES:
                good = np.append(own[k] <= limit, False)  # NaN is not
                count = int(np.argmin(good))
                reach.append(f"{frequencies[count - 1]:.3g}" if count else "none")
        found.append((code, *reach))
    names = [f"{options.half_angles_deg[k]:g} deg, {limit:g} rad" for k in representative(options) for limit in REACHES]
    title = f"Highest relative frequency with a smaller error after {options.cycles} cycles, by half angle and error"
    return Table.from_rows(("code", *names), found, title)


def code_table(rows: Table) -> Table:
    """Return what the codes mean."""
    found = cell_table(rows)
    label = dict(zip(found["code"].tolist(), found["label"].tolist(), strict=True))
    return Table.from_rows(("code", "solver"), [(code, label[code]) for code in codes(rows)], "Solvers and their codes")


def representative(options: Options) -> list[int]:
    """Return a small, a middle and the largest half angle of the map, by index."""
    angles = np.log(options.half_angles_deg)
    return sorted({int(np.argmin(np.abs(angles - np.log(wanted)))) for wanted in (1.0, 10.0, 90.0)})


def figures(options: Options, rows: Table) -> list[Figure]:
    """Return the map of the best, the maps of some solvers, and lines of error and drift."""
    return [best_figure(options, rows), solver_maps(options, rows), line_figure(options, rows)]


def _map(options: Options, values: Array, title: str, text: np.ndarray | None = None) -> HeatMap:
    with np.errstate(divide="ignore", invalid="ignore"):
        decades = np.log10(np.maximum(values, 10.0 ** SCALE[0]))
    return HeatMap(
        xlabel="coning frequency / sampling frequency",
        ylabel="half angle, deg",
        columns=[f"{f:.3g}" for f in options.relative_frequencies],
        rows=[f"{a:g}" for a in options.half_angles_deg],
        values=decades,
        low=SCALE[0],
        high=SCALE[1],
        text=text,
        title=title,
        colour_label="log10 of the error, rad",
    )


def best_figure(options: Options, rows: Table) -> Figure:
    """Return which solver errs least, with and without latency."""
    panels = []
    for chosen, title in (
        (codes(rows), "all solvers"),
        (without_latency(rows), "solvers that borrow nothing from the future"),
    ):
        names, errors = best(rows, chosen)
        panels.append(_map(options, errors, title, names))
    caption = (
        f"The solver with the least error after {options.cycles} cycles of coning (exact increments), by its code "
        "(table `codes`): letters of the algorithm and N; W12/4 is a window of 12 round 4. Among errors within a "
        "factor 2 of the least, or below 1e-13 rad, the one with the least latency, the simplest algorithm and the "
        "smallest N stands. Colour: its error."
    )
    return Figure("best_solver", "Which integrator at my rate", caption, panels, columns=1)


def solver_maps(options: Options, rows: Table) -> Figure:
    """Return the error of some solvers over the whole map."""
    shown = [code for code in MAPS if code in codes(rows)] or codes(rows)[:6]
    label = dict(zip(rows["code"].tolist(), rows["label"].tolist(), strict=True))
    panels = [_map(options, grid(rows, code, "error_rad"), f"{code}: {label[code]}") for code in shown]
    caption = (
        f"Largest error within {options.cycles} cycles of coning with exact increments. Grey: the solver refuses, for "
        "the increments are beyond its convergence."
    )
    return Figure("error_maps", "Error over relative frequency and half angle", caption, panels, columns=3)


def line_figure(options: Options, rows: Table) -> Figure:
    """Return error and drift against relative frequency, on logarithmic axes, for three half angles."""
    shown = [code for code in LINES if code in codes(rows)] or codes(rows)[:7]
    frequencies = options.relative_frequencies
    panels = []
    for column, ylabel in (("error_rad", "largest error, rad"), ("drift_rad_per_cycle", "drift, rad per cycle")):
        for k in representative(options):
            lines = []
            for n, code in enumerate(shown):
                values = grid(rows, code, column)[k]
                lines.append(Line(code, frequencies, np.where(values > 0, values, np.nan), n, ("-", "--")[n // 7 % 2]))
            title = f"half angle {options.half_angles_deg[k]:g} deg"
            xlabel = "coning frequency / sampling frequency"
            panels.append(Panel(xlabel, ylabel, lines, title, xscale="log", yscale="log"))
    caption = (
        f"Largest error within {options.cycles} cycles and drift, against the relative frequency. Lines end where the "
        "error exceeds 1 rad (drift) or where the solver refuses."
    )
    columns = len(representative(options))
    return Figure("error_lines", "Error and drift of coning", caption, panels, columns=columns, shared_legend=True)
