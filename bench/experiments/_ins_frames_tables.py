"""The tables of `ins-frames`: errors by flight, what they are due to, equality to rounding, convergence and cost."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from bench.errors import Array
from bench.experiments._ins_frames_cost import Counts
from bench.experiments._ins_frames_trials import (
    BEST,
    CENTRAL,
    CONVENTIONAL,
    GENERAL,
    IMPROVED,
    IMPROVED_FIRST,
    MEASURES,
    POLYNOMIAL,
    ROUNDING,
    SAMPLES,
    TWO_SAMPLE,
    flights,
    postponed,
)
from bench.experiments._ins_frames_verdicts import QUANTITIES, Results
from bench.table import Table

UNITS = dict(zip(MEASURES, ("arcsec", "m/s", "m"), strict=True))
KINDS = ("multiplications", "divisions", "additions", "subtractions", "roots", "trigonometric")


def tables(results: Results, counts: Counts, timed: Table) -> dict[str, Table]:
    """Return all tables, by file name."""
    found = {f"{QUANTITIES[measure]}_errors": error_table(results, measure) for measure in MEASURES}
    found |= {
        "attitude_after_compensation": compensated_table(results),
        **{f"{QUANTITIES[m]}_attribution": attribution_table(results, m) for m in MEASURES[:2]},
        "equality": equality_table(results),
        "equality_as_printed": equality_table(results, as_printed=True),
        "convergence_rate": convergence_table(results, "rate"),
        "convergence_samples": convergence_table(results, "samples"),
        "operations": operation_table(counts),
    }
    return {**found, "times": timed} if len(timed) else found


def error_table(results: Results, measure: str) -> Table:
    """Return the largest errors of all algorithms in all flights."""
    chosen = (*TWO_SAMPLE, *(postponed(every) for every in results.options.postponed), BEST)
    rows = [
        (flight.label, *(results.value(flight, algorithm, measure) for algorithm in chosen))
        for flight in flights(results.options)
    ]
    names = ("flight", *(algorithm.label for algorithm in chosen))
    return Table.from_rows(names, rows, f"Largest {QUANTITIES[measure]} errors, {UNITS[measure]}")


def compensated_table(results: Results) -> Table:
    """Return what is left of the postponed rotation of n right after it was compensated."""
    chosen = [postponed(every) for every in results.options.postponed]
    rows = [
        (
            flight.label,
            results.value(flight, CONVENTIONAL, MEASURES[0]),
            *(results.value(flight, a, MEASURES[0], "compensated") for a in chosen),
        )
        for flight in flights(results.options)
    ]
    title = "Largest attitude errors right after a compensation of the rotating n, arcsec"
    return Table.from_rows(("flight", "n every update", *(a.label.partition(", ")[2] for a in chosen)), rows, title)


def attribution_table(results: Results, measure: str) -> Table:
    """Return where an error comes from: what one ingredient changes, and what is left without any of them."""
    causes = {
        "first-order for exact rotation, conventional": "rotation compensation, conventional",
        "first-order for exact rotation, improved": "rotation compensation, improved",
        "navigation for inertial frame": "frame",
        "dual quaternion for rotation vector": "dual quaternion against improved",
        "two-sample formulas for exact integrals": "formulas",
    }
    rows = [
        (
            flight.label,
            *(results.value(flight, name, measure, "difference") for name in causes.values()),
            results.value(flight, POLYNOMIAL, measure),
            results.value(flight, BEST, measure),
        )
        for flight in flights(results.options)
    ]
    names = ("flight", *causes, "left: two increments", f"left: {BEST.label}")
    quantity = QUANTITIES[measure]
    return Table.from_rows(names, rows, f"What the {quantity} error is due to: largest differences, {UNITS[measure]}")


def equality_table(results: Results, *, as_printed: bool = False) -> Table:
    """Return the difference of the dual quaternion and the improved algorithm beside their errors and rounding.

    Rounding is what the dual quaternion differs from itself by, computed in turned body axes.
    """
    name = f"dual quaternion against improved{', first-order' if as_printed else ''}"
    rows: list[tuple[Any, ...]] = []
    for flight in flights(results.options):
        row: list[Any] = [flight.label]
        for measure in MEASURES:
            row += [results.value(flight, what, measure, "difference") for what in (name, ROUNDING)]
            row.append(results.value(flight, IMPROVED_FIRST if as_printed else IMPROVED, measure))
        rows.append(tuple(row))
    names = ["flight"]
    for measure in MEASURES:
        quantity = QUANTITIES[measure]
        names += [f"{quantity} apart, {UNITS[measure]}", f"{quantity} rounding", f"{quantity} error"]
    which = "as printed" if as_printed else "with the exact rotation compensation"
    title = f"Dual quaternion and improved algorithm {which}: how far apart, rounding, and errors"
    return Table.from_rows(names, rows, title)


def convergence_table(results: Results, part: str) -> Table:
    """Return errors against rate or number of samples, with the order of each step in the interval or in N."""
    rows = results.rows.where(part=part)
    x = np.unique(rows["rate_hz" if part == "rate" else "samples"])
    chosen = (*TWO_SAMPLE, BEST) if part == "rate" else GENERAL
    found = []
    for algorithm in chosen:
        own = rows.where(algorithm=algorithm.label)
        order = np.argsort(own["rate_hz" if part == "rate" else "samples"])
        for measure in MEASURES:
            values = own[measure][order]
            order_of = [slope(x, values)] if part == "rate" else []
            found.append((algorithm.label, QUANTITIES[measure], *values, *order_of))
    head = [f"{value:g} Hz" if part == "rate" else f"N = {value}" for value in x]
    names = ["algorithm", "largest error (arcsec, m/s, m)", *head, *(["order"] if part == "rate" else ())]
    title = f"Convergence with {'the sampling rate' if part == 'rate' else 'increments per update'}, {CENTRAL.label}"
    return Table.from_rows(names, found, title)


def slope(rates: Array, values: Array) -> float:
    """Return minus the slope of log error against log rate between the two lowest rates, where rounding shows least."""
    if len(rates) < 2:
        return float("nan")
    low, high = np.log(np.maximum(values[:2], np.finfo(float).tiny))
    return float((low - high) / np.log(rates[1] / rates[0]))


def operation_table(counts: Counts) -> Table:
    """Return operations per update of two increments."""
    rows: Sequence[tuple[Any, ...]] = [
        (
            label,
            frame,
            *(getattr(count, kind) for kind in KINDS),
            count.total,
            count.total / counts[CONVENTIONAL.label, frame].total,
            count.total / counts[IMPROVED.label, frame].total,
        )
        for (label, frame), count in sorted(counts.items(), key=lambda item: item[0][1])
    ]
    names = ("algorithm", "results", *KINDS, "total", f"over {CONVENTIONAL.label}", f"over {IMPROVED.label}")
    return Table.from_rows(names, rows, f"Operations per update of {SAMPLES} increments, as executed")
