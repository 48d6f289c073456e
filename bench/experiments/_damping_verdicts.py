"""The verdicts of `damping-external-velocity`: divergence, convergence, accuracy, tables, consistency, periods."""

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array
from bench.evaluation import chi_square_bounds
from bench.experiment import Verdict
from bench.experiments._damping_consistency import CONSTANT_ERROR, DRAWN, LONGEST, PERFECT
from bench.experiments._damping_published import (
    BOTH,
    COLUMNS,
    FAMILIES,
    FILTER_1_TABLE,
    FUSION_TABLE,
    LARGEST,
    REFERENCE_ERRORS,
    TABLES,
    UNITS,
)
from bench.experiments._damping_results import ANGLES, LAST, PLACE, SPEED, Results
from bench.experiments._damping_scan import BOTH_TABLES
from bench.experiments._damping_trials import AUGMENTED, FILTERS, FIRST, FUSION, SECOND, Options
from bench.experiments._damping_undamped import PERIODS, theory
from bench.experiments._judging import withhold

BANDS = (0.1, 0.01)  # of the undamped error, within which an error must stay to have settled
WITHIN = 0.1  # of the column's largest printed number: what counts as reproduced
NEAR = 0.01  # of a period
INSIDE = 0.8  # of the hourly means within their 95 % bounds: what counts as consistent
ENOUGH = 10  # trials


def withheld(options: Options, verdicts: dict[str, Verdict]) -> dict[str, Verdict]:
    """Return the verdicts, but those that a run at other conditions cannot judge."""
    reasons = {"8 ": why_not_periods(options), "7 ": why_not_trials(options)}
    reasons |= dict.fromkeys(("5 fifteen states, over trials", "6 "), why_not_trials(options) or why_not_paper(options))
    default = why_not_paper(options)
    found: dict[str, Verdict] = {}
    for key, verdict in verdicts.items():
        reason = next((why for start, why in reasons.items() if key.startswith(start)), default)
        found |= withhold({key: verdict}, reason)
    return found


def why_not_periods(options: Options) -> str:
    """Return why the periods of the undamped INS cannot be judged, or nothing."""
    least = Options().undamped
    if options.undamped < least:
        return f"{options.undamped:g} h undamped are too short, at least {least:g} h are needed"
    return ""


def why_not_trials(options: Options) -> str:
    """Return why consistency cannot be judged, or nothing."""
    if options.duration < LONGEST:
        return f"{options.duration:g} h are too short, at least {LONGEST:g} h are needed"
    return f"{options.trials} trials are too few, at least {ENOUGH} are needed" if options.trials < ENOUGH else ""


def why_not_paper(options: Options) -> str:
    """Return why the paper's claims cannot be judged, or nothing."""
    default = Options()
    if options.reference_errors != REFERENCE_ERRORS:
        return "the reference errors are not the published ones"
    if options.sway:
        return "the ship sways, that of the paper does not"
    if not (set(default.latitudes) <= set(options.latitudes) and set(default.taus) <= set(options.taus)):
        return "fewer latitudes or correlation times are scanned than by default"
    if options.duration < default.duration:
        return f"{options.duration:g} h are too short, at least {default.duration:g} h are needed"
    return ""


def judge_all(results: Results) -> dict[str, Verdict]:
    """Return all verdicts, by the key of the claim."""
    verdicts = {
        "1 filter 1 diverges": judge_divergence(results),
        "1 in proportion": judge_proportion(results),
        "2 filter 2 does not see it": judge_blindness(results),
        "2 settles after 12 h": judge_twelve(results),
        "3 faster than filter 2": judge_faster(results),
        "3 more accurate than filter 1": judge_steady(results, (results.options.focus,)),
        "3 velocity compensated": judge_velocity(results),
        "4 for every C": judge_steady(results, results.options.reference_errors),
        "4 no trend with C": judge_trend(results),
        "5 fifteen states": judge_augmented(results),
        "5 fifteen states, over trials": judge_augmented_trials(results),
        "6 credibility of filter 1": judge_credibility(results),
    }
    verdicts |= {f"7 consistent, {name}": judge_consistency(results, name) for name in FILTERS}
    verdicts |= {f"8 period, {name}": judge_period(results, name) for name in PERIODS}
    for table in TABLES:
        verdicts |= {f"{table}, {family}": judge_family(results, f"{table}, {family}") for family in FAMILIES}
    return {**verdicts, BOTH_TABLES: judge_tables(results)}


def _verdict(true: bool, measured: str, reason: str) -> Verdict:
    return Verdict("holds" if true else "does not hold", measured, reason)


def _named(values: Array, chosen: tuple[int, ...] = tuple(range(7)), digits: str = ".3g") -> str:
    return ", ".join(f"{COLUMNS[k]} {values[k]:{digits}} {UNITS[k]}" for k in chosen)


def _exceptions(true: NDArray[np.bool_], chosen: tuple[int, ...] = tuple(range(7))) -> str:
    wrong = [COLUMNS[k] for k in chosen if not true[k]]
    return f"not in {', '.join(wrong)}" if wrong else "true in every column"


def judge_divergence(results: Results) -> Verdict:
    """Judge: are position and attitude errors of filter 1 larger at the end than half-way."""
    t, errors = results.run(FIRST)
    half = np.abs(errors[np.abs(t - 0.5 * t[-1]) <= 0.5 * LAST].mean(axis=0))
    end = np.abs(results.steady(FIRST))
    chosen = PLACE + ANGLES
    true = end > 1.1 * half
    ratio = ", ".join(f"{COLUMNS[k]} {half[k]:.3g} to {end[k]:.3g}" for k in chosen)
    return _verdict(bool(true[list(chosen)].all()), f"{ratio} arcmin", _exceptions(true, chosen))


def judge_proportion(results: Results) -> Verdict:
    """Judge: is what a constant error adds to filter 1 the same per m/s for every constant."""
    none = results.steady(FIRST, 0.0)
    rates = np.stack([(results.steady(FIRST, c) - none) / c for c in results.options.reference_errors])
    spread = np.ptp(rates, axis=0) / np.abs(rates).mean(axis=0)
    reason = f"spread {100 * spread.max():.2g} % at most; {_exceptions(spread < WITHIN)}"
    return _verdict(bool((spread < WITHIN).all()), _named(rates.mean(axis=0)) + " per m/s", reason)


def judge_blindness(results: Results) -> Verdict:
    """Judge: is what a constant error adds to filter 2 less than a tenth of what it adds to filter 1."""
    worst = np.zeros(7)
    for c in results.options.reference_errors:
        one, two = (np.abs(results.steady(name, c) - results.steady(name, 0.0)) for name in (FIRST, SECOND))
        worst = np.maximum(worst, two / one)
    measured = "of what it does to filter 1: " + ", ".join(
        f"{name} {100 * value:.2g} %" for name, value in zip(COLUMNS, worst, strict=True)
    )
    return _verdict(bool((worst < WITHIN).all()), measured, _exceptions(worst < WITHIN))


def hours(value: float) -> str:
    """Return a convergence time as text."""
    return "never" if np.isinf(value) else f"{value:.1f} h"


def _hours(values: Array) -> str:
    return ", ".join(f"{name} {hours(value)}" for name, value in zip(COLUMNS, values, strict=True))


def judge_twelve(results: Results) -> Verdict:
    """Judge: is the longest time in which an error of filter 2 settles about 12 h, by either band."""
    settled = {band: results.settled(SECOND, band) for band in BANDS}
    longest = np.array([values.max() for values in settled.values()])
    measured = "; ".join(f"to {100 * band:g} %: {_hours(values)}" for band, values in settled.items())
    reason = " and ".join(hours(value) for value in longest)
    return _verdict(bool(((longest >= 10) & (longest <= 14)).any()), measured, f"the last one settles in: {reason}")


def judge_faster(results: Results) -> Verdict:
    """Judge: does every error of the fusion settle no later than that of filter 2, and one of them earlier."""
    measured, reasons, holds = [], [], False
    for band in BANDS:
        fused, second = results.settled(FUSION, band), results.settled(SECOND, band)
        true = fused <= second
        holds |= bool(true.all() and (fused < second).any())
        measured.append(f"to {100 * band:g} %: fusion {_hours(fused)}; filter 2 {_hours(second)}")
        reasons.append(f"to {100 * band:g} %: {_exceptions(true)}")
    return _verdict(holds, ". ".join(measured), "; ".join(reasons))


def judge_steady(results: Results, constants: tuple[float, ...]) -> Verdict:
    """Judge: are the steady-state errors of the fusion smaller than those of filter 1."""
    fused, first = (np.abs(np.stack([results.steady(name, c) for c in constants])) for name in (FUSION, FIRST))
    smaller = fused < first
    printed = np.array([np.abs(FUSION_TABLE[k]) < np.abs(FILTER_1_TABLE[k]) for k in _printed_rows(constants)])
    measured = "fusion / filter 1: " + ", ".join(
        f"{name} {value:.2g}" for name, value in zip(COLUMNS, (fused / first).max(axis=0), strict=True)
    )
    reason = f"{_exceptions_by(smaller, constants)}; in the printed tables {_exceptions_by(printed, constants)}"
    return _verdict(bool(smaller.all()), measured, reason)


def _printed_rows(constants: tuple[float, ...]) -> list[int]:
    return [REFERENCE_ERRORS.index(constant) for constant in constants if constant in REFERENCE_ERRORS]


def _exceptions_by(true: NDArray[np.bool_], constants: tuple[float, ...]) -> str:
    """Return the columns in which something is not true, with the constants for which."""
    wrong = {
        COLUMNS[k]: [f"{c:g}" for c, right in zip(constants, true[:, k], strict=False) if not right]
        for k in range(true.shape[-1])
    }
    found = [f"{column} ({', '.join(values)} m/s)" for column, values in wrong.items() if values]
    return f"not in {', '.join(found)}" if found else "in every column"


def judge_velocity(results: Results) -> Verdict:
    """Judge: is less than half of the constant error left in the fusion's velocity."""
    left, first = (np.abs(results.steady(name)) / abs(results.options.focus) for name in (FUSION, FIRST))
    true = bool((left[list(SPEED)] < 0.5).all())
    measured, full = (", ".join(f"{COLUMNS[k]} {100 * part[k]:.3g} %" for k in SPEED) for part in (left, first))
    printed = ", ".join(
        f"{100 * share:.0f} %"
        for k in _printed_rows((results.options.focus,))
        for share in FUSION_TABLE[k, list(SPEED)] / REFERENCE_ERRORS[k]
    )
    return _verdict(true, f"left: {measured}", f"filter 1: {full}; fusion by the printed table: {printed}")


def judge_trend(results: Results) -> Verdict:
    """Judge: does the fusion change with the constant error by less than a third of what filter 1 does."""
    if len(results.options.reference_errors) < 2:
        return Verdict("cannot be judged", "one constant error", "two are needed for a trend")
    ends = min(results.options.reference_errors), max(results.options.reference_errors)
    fused, first = (np.abs(results.steady(name, ends[0]) - results.steady(name, ends[1])) for name in (FUSION, FIRST))
    share = fused / first
    measured = "change of the fusion / of filter 1: " + ", ".join(
        f"{name} {value:.2g}" for name, value in zip(COLUMNS, share, strict=True)
    )
    return _verdict(bool((share < 1 / 3).all()), measured, _exceptions(share < 1 / 3))


def judge_augmented(results: Results) -> Verdict:
    """Judge: is the filter with 15 states better than the fusion in position and velocity."""
    return _better(results.steady_rms(AUGMENTED), results.steady_rms(FUSION))


def judge_augmented_trials(results: Results) -> Verdict:
    """Judge: is it better over the trials."""
    return _better(*(results.trial_rms(CONSTANT_ERROR, name) for name in (AUGMENTED, FUSION)))


def _better(mine: Array, fused: Array) -> Verdict:
    chosen = PLACE + SPEED
    true = mine < fused
    measured = f"15 states: {_named(mine, chosen)}; fusion: {_named(fused, chosen)}"
    return _verdict(bool(true[list(chosen)].all()), measured, _exceptions(true, chosen))


def judge_credibility(results: Results) -> Verdict:
    """Judge: does NEES of filter 1 grow with time under a constant error."""
    t, values = results.consistency(CONSTANT_ERROR, FIRST, "nees")
    _, perfect = results.consistency(PERFECT, FIRST, "nees")
    _, high = chi_square_bounds(13, results.options.trials)
    true = values[-1] > high and values[-1] > values[0]
    measured = f"NEES {values[0]:.3g} after {t[0]:.3g} h, {values[-1]:.3g} after {t[-1]:.3g} h; 13 expected"
    reason = f"without a constant error {perfect[-1]:.3g} in the end; upper 95 % bound {high:.3g}"
    return _verdict(bool(true), measured, reason)


def inside(results: Results, case: str, name: str, measure: str) -> tuple[float, float]:
    """Return the mean of NEES or NIS over the run, and the share of hourly means within their 95 % bounds."""
    _, values = results.consistency(case, name, measure)
    degrees = 2 if measure == "nis" else 15 if name == AUGMENTED else 13
    low, high = chi_square_bounds(degrees, results.options.trials)
    return float(values.mean()), float(((values >= low) & (values <= high)).mean())


def judge_consistency(results: Results, name: str) -> Verdict:
    """Judge: are NEES and NIS within their bounds, with a reference as the filter believes it."""
    case = DRAWN if name == AUGMENTED else PERFECT
    measures = ("nees",) if name == FUSION else ("nees", "nis")
    found = {measure: inside(results, case, name, measure) for measure in measures}
    degrees = {"nees": 15 if name == AUGMENTED else 13, "nis": 2}
    measured = "; ".join(
        f"{key.upper()} {mean:.3g} ({degrees[key]} expected), {100 * share:.0f} % of the hours within bounds"
        for key, (mean, share) in found.items()
    )
    wrong = {key: mean for key, (mean, share) in found.items() if share < INSIDE}
    reasons = [f"{key.upper()} too {'large' if mean > degrees[key] else 'small'}" for key, mean in wrong.items()]
    return _verdict(not wrong, measured, "; ".join(reasons) or "within bounds")


def judge_period(results: Results, name: str) -> Verdict:
    """Judge: is the period that of theory within 1 %."""
    found, expected = results.period(name), theory(results.options)[name]
    apart = found / expected - 1
    return _verdict(abs(apart) < NEAR, f"{found:.5g} s", f"{100 * apart:+.3f} % from {expected:.5g} s")


def judge_family(results: Results, criterion: str) -> Verdict:
    """Judge: is there a reading that gives all numbers of a group of columns."""
    best = results.best(criterion)
    reason = "reproduced" if best.misfit < WITHIN else "no scanned reading gives them all"
    return _verdict(
        best.misfit < WITHIN,
        f"largest deviation {100 * best.misfit:.3g} % of the column's largest number",
        f"{reason}; nearest: {best.label}",
    )


def judge_tables(results: Results) -> Verdict:
    """Judge: is there one reading that gives both tables."""
    best = results.best(BOTH_TABLES)
    largest = float((np.abs(best.tables - BOTH) / LARGEST[:, None]).max())
    measured = f"rms deviation {100 * best.misfit:.3g} %, largest {100 * largest:.3g} % of the column's largest number"
    return _verdict(largest < WITHIN, measured, f"best reading: {best.label}")
