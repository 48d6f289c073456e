"""The figures of `ins-frames`: attitude in time, against speed, manoeuvres, equality, convergence and cost."""

import numpy as np

from bench.errors import Array
from bench.experiments._ins_frames_cost import IN_E, Counts
from bench.experiments._ins_frames_tables import KINDS, UNITS
from bench.experiments._ins_frames_trials import (
    BEST,
    CENTRAL,
    CONVENTIONAL,
    CONVENTIONAL_FIRST,
    DUAL,
    GENERAL,
    IMPROVED,
    IMPROVED_FIRST,
    MANOEUVRES,
    MEASURES,
    POLYNOMIAL,
    ROUNDING,
    TURNS,
    Algorithm,
    Flight,
    Options,
    errors,
    fly,
    fly_turned,
    lengths,
    postponed,
)
from bench.experiments._ins_frames_verdicts import ATTITUDE, QUANTITIES, VELOCITY, Results
from bench.figures import Figure, Line, Panel
from bench.table import Table
from bench.trajectory import navigation_errors

# Drawn in this order; curves that coincide stay visible.
LOOK = {
    CONVENTIONAL_FIRST: (1, "-"),
    CONVENTIONAL: (0, "-"),
    IMPROVED_FIRST: (4, "--"),
    IMPROVED: (2, "--"),
    DUAL: (3, ":"),
    POLYNOMIAL: (5, "-"),
    BEST: (7, "-"),
}
GREY = 6
STYLES = (":", "-.", "--", "-")  # of postponed compensations
SMALLEST = 1e-12  # drawn where an error is exactly zero, on logarithmic axes


def figures(results: Results, counts: Counts, timed: Table) -> list[Figure]:
    """Return all figures."""
    return [
        time_figure(results.options),
        speed_figure(results),
        manoeuvre_figure(results),
        equality_figure(results.options),
        convergence_figure(results),
        cost_figure(counts, timed),
    ]


def _postponed(options: Options) -> dict[Algorithm, tuple[int, str]]:
    return {postponed(every): (GREY, STYLES[k % len(STYLES)]) for k, every in enumerate(options.postponed)}


def _central(options: Options, swing: bool) -> Flight:
    """Return the level flight that is drawn in time: at the middle one of the speeds."""
    return Flight(sorted(options.speeds)[len(options.speeds) // 2], 0, swing)


def time_figure(options: Options) -> Figure:
    """Return the attitude errors in time, with and without attitude motion."""
    shown = postponed(max(options.postponed)), CONVENTIONAL, IMPROVED, DUAL, POLYNOMIAL
    looks = {algorithm: LOOK.get(algorithm, (GREY, "-")) for algorithm in shown}
    panels = []
    for swing in (False, True):
        flight = _central(options, swing)
        lines = []
        for algorithm, (colour, style) in looks.items():
            estimate = fly(flight, algorithm, options.rate, options.duration)
            error = lengths(errors(flight, estimate, options.rate))[1:, 0]
            lines.append(Line(algorithm.label, estimate.t[1:], np.maximum(error, SMALLEST), colour, style))
        panels.append(Panel("t, s", "attitude error, arcsec", lines, flight.label, yscale="log"))
    caption = (
        "Attitude errors in level flight. A code that compensates the rotation of n at every k-th update only is wrong "
        "by what n turns in between; one that compensates at every update is not. With attitude motion the frame "
        "makes no difference, but the rotation vector of two increments does: integrated exactly, the same increments "
        "give far more."
    )
    return Figure("attitude", "Rotation of the navigation frame", caption, panels, columns=2, shared_legend=True)


def speed_figure(results: Results) -> Figure:
    """Return the largest attitude errors against speed, in level flight."""
    looks = {
        **_postponed(results.options),
        **{a: look for a, look in LOOK.items() if a not in (CONVENTIONAL_FIRST, IMPROVED_FIRST)},
    }
    panels = []
    for swing in (False, True):
        level = results.flights(swing=swing, weave=0)
        x = np.array([flight.speed for flight in level])
        lines = [
            Line(a.label, x, np.array([max(results.value(f, a, ATTITUDE), SMALLEST) for f in level]), colour, style)
            for a, (colour, style) in looks.items()
        ]
        title = f"level{', swing' if swing else ''}"
        panels.append(Panel("speed, m/s", "largest attitude error, arcsec", lines, title, "log", "log"))
    caption = (
        "Largest attitude error over the flight against speed. With attitude motion the errors of two-sample coning "
        "compensation decide, unless the compensation of n is postponed."
    )
    return Figure("speed", "Attitude and speed", caption, panels, columns=2, shared_legend=True)


def manoeuvre_figure(results: Results) -> Figure:
    """Return the largest velocity errors in the manoeuvres."""
    options, panels = results.options, []
    speed = _central(options, swing=False).speed
    for swing in (False, True):
        found = [Flight(speed, weave, swing) for weave in MANOEUVRES]
        x = np.arange(len(found), dtype=float)
        lines = [
            Line(a.label, x, np.array([max(results.value(f, a, VELOCITY), SMALLEST) for f in found]), colour, style)
            for a, (colour, style) in LOOK.items()
        ]
        title = f"{speed:g} m/s{', swing' if swing else ''}"
        ticks = list(MANOEUVRES.values())
        panels.append(Panel("", "largest velocity error, m/s", lines, title, yscale="log", xticks=ticks))
    caption = (
        "Largest velocity error in level flight, in a weave of half a g and in one 20 times harder. Without attitude "
        "motion the frame decides; with it the rotation compensation of the velocity increments does."
    )
    return Figure("manoeuvres", "Velocity in manoeuvres", caption, panels, columns=2, shared_legend=True)


def equality_figure(options: Options) -> Figure:
    """Return how far the dual quaternion and the improved algorithm are apart, beside their errors and rounding."""
    flight = _central(options, swing=True)
    rate, duration = options.rate, options.duration
    dual, exact, first = (fly(flight, a, rate, duration) for a in (DUAL, IMPROVED, IMPROVED_FIRST))
    turned = fly_turned(flight, DUAL, rate, duration, TURNS[0])
    curves = {
        "error of both": (lengths(errors(flight, dual, rate)), 3, "-"),
        "apart, first-order rotation compensation": (lengths(navigation_errors(dual, first)), 4, "-"),
        "apart, exact rotation compensation": (lengths(navigation_errors(dual, exact)), 2, "-"),
        ROUNDING: (lengths(navigation_errors(dual, turned)), GREY, "-"),
    }
    panels = []
    for k, measure in enumerate(MEASURES):
        lines = [
            Line(label, dual.t[1:], np.maximum.accumulate(np.maximum(values[1:, k], SMALLEST)), colour, style)
            for label, (values, colour, style) in curves.items()
        ]
        label = f"{QUANTITIES[measure]}, largest so far, {UNITS[measure]}"
        panels.append(Panel("t, s", label, lines, QUANTITIES[measure], yscale="log"))
    caption = (
        f"The dual quaternion against the improved algorithm, {flight.label}. The dual part of the exponential is the "
        "exact rotation compensation: with it the two are one algorithm, and differ by rounding, as much as the dual "
        "quaternion differs from itself when it is computed in turned body axes."
    )
    return Figure("equality", "Dual quaternion and improved algorithm", caption, panels, shared_legend=True)


def convergence_figure(results: Results) -> Figure:
    """Return errors against the update interval, and against the increments per update."""
    panels = []
    rows = results.rows.where(part="rate")
    for measure in MEASURES:
        lines = []
        for algorithm, (colour, style) in LOOK.items():
            own = rows.where(algorithm=algorithm.label)
            x = 1e3 * own["samples"] / own["rate_hz"]
            lines.append(Line(algorithm.label, *_sorted(x, own[measure]), colour, style))
        label = f"{QUANTITIES[measure]}, {UNITS[measure]}"
        panels.append(Panel("update interval, ms", label, lines, f"{QUANTITIES[measure]}", "log", "log"))
    rows = results.rows.where(part="samples")
    for measure in MEASURES:
        lines = []
        for algorithm in GENERAL:
            own = rows.where(algorithm=algorithm.label)
            x, y = _sorted(own["samples"].astype(float), own[measure])
            lines.append(Line(algorithm.label, x, y, *LOOK[algorithm]))
        label = f"{QUANTITIES[measure]}, {UNITS[measure]}"
        title = f"{QUANTITIES[measure]}, {results.options.rate:g} Hz"
        panels.append(Panel("N, increments per update", label, lines, title, yscale="log"))
    caption = (
        f"Largest errors, {CENTRAL.label}. Above: against the update interval. Below: against the increments per "
        "update at one sampling rate; a code for more increments has a longer update."
    )
    return Figure("convergence", "Convergence", caption, panels, shared_legend=True)


def _sorted(x: Array, y: Array) -> tuple[Array, Array]:
    order = np.argsort(x)
    return x[order], np.maximum(y[order], SMALLEST)


def cost_figure(counts: Counts, timed: Table) -> Figure:
    """Return operations and times per update."""
    own = {label: count for (label, frame), count in counts.items() if frame == IN_E}
    labels = [label.replace(", ", ",\n") for label in own]
    x = np.arange(len(labels), dtype=float)
    groups = {
        "multiplications": ("multiplications",),
        "additions and subtractions": ("additions", "subtractions"),
        "divisions, roots and functions": tuple(kind for kind in KINDS if kind[0] in "drt"),
    }
    lines = [
        Line(name, x, np.array([sum(getattr(count, kind) for kind in kinds) for count in own.values()]), k, "o")
        for k, (name, kinds) in enumerate(groups.items())
    ]
    panels = [Panel("", "operations per update", lines, "counted", yscale="log", xticks=labels)]
    if len(timed):
        times = [Line(name, x, timed[f"{name}_ns"], k, "x") for k, name in enumerate(("kernel", "solve"), start=3)]
        panels.append(Panel("", "ns per update", times, "measured", yscale="log", xticks=labels))
    caption = "Operations of an update of two increments, counted on the running kernels, and its median time."
    return Figure("cost", "Cost of an update", caption, panels, columns=1)
