"""The verdicts of `damping-external-velocity`: divergence, convergence, accuracy, tables, consistency, periods."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bench.errors import Array
from bench.evaluation import chi_square_bounds
from bench.experiment import Verdict
from bench.experiments._damping_consistency import CONSTANT_ERROR, DRAWN, PERFECT
from bench.experiments._damping_published import (
    BOTH,
    COLUMNS,
    FAMILIES,
    LARGEST,
    REFERENCE_ERRORS,
    SCALE,
    STATE,
    TABLES,
    UNITS,
)
from bench.experiments._damping_scan import BOTH_TABLES
from bench.experiments._damping_trials import AUGMENTED, ERRORS, FILTERS, FIRST, FREE, FUSION, SECOND, Options
from bench.experiments._damping_undamped import PERIODS, theory
from bench.table import Table

LAST = 1.5  # h, over which steady-state errors are taken: a Schuler period
BAND = 0.1  # of the undamped error, within which an error must stay to have settled
WITHIN = 0.1  # of the column's largest printed number: what counts as reproduced
NEAR = 0.01  # of a period
INSIDE = 0.8  # of the hourly means within their 95 % bounds: what counts as consistent
ANGLES, PLACE, SPEED = (2, 3, 4), (0, 1), (5, 6)  # columns


@dataclass(frozen=True, eq=False)
class Results:
    """What was measured, by part, filter and reference error."""

    options: Options
    rows: Table

    @cached_property
    def _groups(self) -> dict[tuple[str, str, str, str], Array]:
        """Return the rows of each (part, case, name, reference error)."""
        names = ("part", "case", "name", "reference_m_per_s")
        keys = zip(*(self.rows[name].tolist() for name in names), strict=True)
        found: dict[tuple[str, str, str, str], list[int]] = {}
        for k, (part, case, name, constant) in enumerate(keys):
            found.setdefault((part, case, name, f"{constant:g}"), []).append(k)
        return {key: np.array(rows) for key, rows in found.items()}

    def table(self, part: str, name: str, *, case: str = "", constant: float = np.nan) -> Table:
        """Return the rows of one filter."""
        rows = self._groups[part, case, name, f"{constant:g}"]
        return Table({key: column[rows] for key, column in self.rows.columns.items()}, self.rows.title)

    def run(self, name: str, constant: float | None = None, part: str = "ins") -> tuple[Array, Array]:
        """Return times, h, and errors (n, 7) in the tables' columns and units; by default of the shown reference."""
        chosen = np.nan if name == FREE else self.options.focus if constant is None else constant
        found = self.table(part, name, constant=chosen)
        return found["t_h"], columns_of(found)

    def steady(self, name: str, constant: float | None = None) -> Array:
        """Return the mean error of the last `LAST` hours, by column."""
        t, errors = self.run(name, constant)
        return np.asarray(errors[t >= t[-1] - LAST].mean(axis=0))

    def steady_rms(self, name: str, constant: float | None = None) -> Array:
        """Return the root mean square error of the last `LAST` hours, by column."""
        t, errors = self.run(name, constant)
        return np.asarray(np.sqrt((errors[t >= t[-1] - LAST] ** 2).mean(axis=0)))

    def settled(self, name: str, constant: float | None = None) -> Array:
        """Return the hours after which the errors stay near their steady-state values, by column; inf for never.

        Near is within `BAND` of the largest error of the undamped INS; who leaves that band in the last `LAST` hours
        has not settled.
        """
        t, errors = self.run(name, constant)
        band = BAND * np.abs(self.run(FREE)[1]).max(axis=0)
        outside = np.abs(errors - self.steady(name, constant)) > band
        last = np.array([t[column][-1] if column.any() else 0.0 for column in outside.T])
        return np.where(last > t[-1] - LAST, np.inf, last)

    def best(self, criterion: str) -> tuple[float, str, Array]:
        """Return misfit, label and tables (2, 5, 7) of the scanned reading that fits best by a criterion."""
        tables = [self._scanned(criterion, name) for name in (FUSION, FIRST)]
        k = int(np.argmin(tables[0]["value"][::5]))
        values = [columns_of(table)[5 * k : 5 * k + 5] for table in tables]
        return float(tables[0]["value"][5 * k]), str(tables[0]["label"][5 * k]), np.stack(values)

    def _scanned(self, criterion: str, name: str) -> Table:
        keep = (self.rows["part"] == "scan") & (self.rows["case"] == criterion) & (self.rows["name"] == name)
        return Table({key: column[keep] for key, column in self.rows.columns.items()})

    def consistency(self, case: str, name: str, measure: str) -> tuple[Array, Array]:
        """Return hours and the mean of NEES or NIS over the trials."""
        found = self.table("consistency", name, case=case)
        t = np.unique(found["t_h"])
        return t[1:], found[measure].reshape(-1, len(t)).mean(axis=0)[1:]

    def period(self, name: str) -> float:
        """Return a period that was found, s."""
        return float(self.table("undamped", name, case="period")["value"][0])


def columns_of(table: Table) -> Array:
    """Return errors (n, 7) in the columns and units of the published tables."""
    return np.stack([table[ERRORS[state]] for state in STATE], axis=1) / SCALE


def not_the_conditions(options: Options) -> str:
    """Return why a run cannot judge the paper, or nothing."""
    default = Options()
    if options.reference_errors != REFERENCE_ERRORS:
        return "the reference errors are not the published ones"
    if options.sway:
        return "the ship sways, that of the paper does not"
    if options.duration < default.duration or options.undamped < default.undamped:
        return f"{options.duration:g} h and {options.undamped:g} h undamped are too short, at least " + (
            f"{default.duration:g} h and {default.undamped:g} h are needed"
        )
    if options.trials < 10:
        return f"{options.trials} trials are too few, at least 10 are needed"
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


def _exceptions(true: Array, chosen: tuple[int, ...] = tuple(range(7))) -> str:
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


def _hours(values: Array) -> str:
    texts = ["never" if np.isinf(value) else f"{value:.1f} h" for value in values]
    return ", ".join(f"{name} {text}" for name, text in zip(COLUMNS, texts, strict=True))


def judge_twelve(results: Results) -> Verdict:
    """Judge: is the longest time in which an error of filter 2 settles about 12 h."""
    settled = results.settled(SECOND)
    longest = float(settled.max())
    return _verdict(10.0 <= longest <= 14.0, _hours(settled), f"the last one settles after {longest:.1f} h")


def judge_faster(results: Results) -> Verdict:
    """Judge: does every error of the fusion settle no later than that of filter 2, and one of them earlier."""
    fused, second = results.settled(FUSION), results.settled(SECOND)
    true = fused <= second
    measured = f"fusion: {_hours(fused)}; filter 2: {_hours(second)}"
    return _verdict(bool(true.all() and (fused < second).any()), measured, _exceptions(true))


def judge_steady(results: Results, constants: tuple[float, ...]) -> Verdict:
    """Judge: are the steady-state errors of the fusion smaller than those of filter 1."""
    fused, first = (np.abs(np.stack([results.steady(name, c) for c in constants])) for name in (FUSION, FIRST))
    true = (fused < first).all(axis=0)
    measured = "fusion / filter 1: " + ", ".join(
        f"{name} {value:.2g}" for name, value in zip(COLUMNS, (fused / first).max(axis=0), strict=True)
    )
    return _verdict(bool(true.all()), measured, _exceptions(true))


def judge_velocity(results: Results) -> Verdict:
    """Judge: is less than half of the constant error left in the fusion's velocity."""
    left = np.abs(results.steady(FUSION)) / abs(results.options.focus)
    true = bool((left[list(SPEED)] < 0.5).all())
    measured = ", ".join(f"{COLUMNS[k]} {100 * left[k]:.2g} %" for k in SPEED)
    return _verdict(true, f"left: {measured}", "filter 1 leaves all of it")


def judge_trend(results: Results) -> Verdict:
    """Judge: does the fusion change with the constant error by less than a third of what filter 1 does."""
    ends = min(results.options.reference_errors), max(results.options.reference_errors)
    fused, first = (np.abs(results.steady(name, ends[0]) - results.steady(name, ends[1])) for name in (FUSION, FIRST))
    share = fused / first
    measured = "change of the fusion / of filter 1: " + ", ".join(
        f"{name} {value:.2g}" for name, value in zip(COLUMNS, share, strict=True)
    )
    return _verdict(bool((share < 1 / 3).all()), measured, _exceptions(share < 1 / 3))


def judge_augmented(results: Results) -> Verdict:
    """Judge: is the filter with 15 states better than the fusion in position and velocity."""
    chosen = PLACE + SPEED
    mine, fused = results.steady_rms(AUGMENTED), results.steady_rms(FUSION)
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
    true = all(share >= INSIDE for _, share in found.values())
    wrong = [key.upper() for key, (_, share) in found.items() if share < INSIDE]
    return _verdict(true, measured, f"{' and '.join(wrong)} out of bounds" if wrong else "within bounds")


def judge_period(results: Results, name: str) -> Verdict:
    """Judge: is the period that of theory within 1 %."""
    found, expected = results.period(name), theory(results.options)[name]
    apart = found / expected - 1
    return _verdict(abs(apart) < NEAR, f"{found:.5g} s", f"{100 * apart:+.3f} % from {expected:.5g} s")


def judge_family(results: Results, criterion: str) -> Verdict:
    """Judge: is there a reading that gives all numbers of a group of columns."""
    misfit, label, _ = results.best(criterion)
    reason = "reproduced" if misfit < WITHIN else "no scanned reading gives them all"
    return _verdict(
        misfit < WITHIN,
        f"largest deviation {100 * misfit:.3g} % of the column's largest number",
        (f"{reason}; nearest: {label}"),
    )


def judge_tables(results: Results) -> Verdict:
    """Judge: is there one reading that gives both tables."""
    misfit, label, tables = results.best(BOTH_TABLES)
    largest = float((np.abs(tables - BOTH) / LARGEST[:, None]).max())
    measured = f"rms deviation {100 * misfit:.3g} %, largest {100 * largest:.3g} % of the column's largest number"
    return _verdict(largest < WITHIN, measured, f"best reading: {label}")
