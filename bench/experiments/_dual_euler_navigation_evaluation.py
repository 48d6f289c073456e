"""The evaluation of `dual-euler-navigation`: tables 2 to 4 as distributions, verdicts and figures."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array
from bench.evaluation import percentile_of
from bench.experiment import Evaluation, Verdict
from bench.experiments._dual_euler_judging import CERTAIN
from bench.experiments._dual_euler_navigation_trials import (
    AXES,
    COMPENSATED,
    DUAL,
    END,
    NORMALISED,
    QUATERNION,
    REPORTS,
    START,
    TIMES,
    TRIED,
    Algorithm,
    Options,
)
from bench.experiments._dual_euler_runs import not_the_papers
from bench.experiments._judging import tally, withhold
from bench.figures import Figure, Line, Panel
from bench.table import Table

PUBLISHED = {500.0: 9.81, 2500.0: 13.14}  # s: % by which the position error of dual Euler is smaller
BASELINES = {"normalised": (QUATERNION,), "first-order": (START, END)}
VISIBLE = 0.005  # %, half of the last printed digit
LEVELS = (2.5, 50.0, 97.5)
PLACES = slice(REPORTS // TIMES - 1, None, REPORTS // TIMES)  # of the tables' times among the reports
COLOURS = {DUAL: 0, QUATERNION: 1, START: 2, END: 3, NORMALISED: 4, COMPENSATED: 5}


@dataclass(frozen=True, eq=False)
class Results:
    """Position errors by case and algorithm.

    Attributes
    ----------
    options : Options
    rows : Table
    """

    options: Options
    rows: Table

    @property
    def cases(self) -> list[str]:
        """The tables, in the order of the options."""
        return [f"{rate:g} deg/s" for rate in self.options.rates]

    @property
    def t(self) -> Array:
        """Times of the reports, s."""
        return np.unique(self.rows["t_s"])

    def errors(self, case: str, algorithm: Algorithm, part: str = "trial") -> Array:
        """Return east, north and total errors, shape (trials, reports, 3), m."""
        own = self.rows.where(part=part, case=case, algorithm=algorithm.label)
        return np.stack([own[axis] for axis in AXES], axis=-1).reshape(-1, REPORTS, 3)

    def reduction(self, case: str, against: Algorithm) -> Array:
        """Return by how much dual Euler's |errors| are smaller, %, shape (trials, reports, 3)."""
        ours, theirs = (np.abs(self.errors(case, algorithm)) for algorithm in (DUAL, against))
        return 100.0 * (1.0 - ours / theirs)


def evaluate(options: Options, seed: int, rows: Table) -> Evaluation:
    """Turn the position errors into verdicts, tables and figures."""
    results = Results(options, rows)
    verdicts = withhold(judge(results), not_the_papers(options, Options(), options.trials))
    tables = {
        "tables_2_to_4": position_table(results),
        "reductions": reduction_table(results),
        "ideal": ideal_table(results),
    }
    return Evaluation(verdicts, tables, figures(results), summary(results, verdicts))


def judge(results: Results) -> dict[str, Verdict]:
    """Return the verdict on every claim."""
    verdicts = {}
    for key, baselines in BASELINES.items():
        readings = {
            (case, against.label): results.reduction(case, against) for case in results.cases for against in baselines
        }
        tabled = {reading: found[:, PLACES] for reading, found in readings.items()}
        smaller = {reading: np.all(found > VISIBLE, axis=(1, 2)) for reading, found in tabled.items()}
        grows = {reading: found[:, -1, 2] > found[:, 0, 2] + VISIBLE for reading, found in tabled.items()}
        verdicts[f"4 smaller, {key}"] = judge_everywhere(smaller, "all 15 errors smaller")
        verdicts[f"4 grows, {key}"] = judge_everywhere(grows, "reduction larger at the end than at the first fifth")
        for (when, printed), place in zip(PUBLISHED.items(), (0, -1), strict=True):
            samples = {reading: found[:, place, 2] for reading, found in tabled.items()}
            verdicts[f"4 {printed:g} % at {when:g} s, {key}"] = judge_number(printed, samples)
        both = {reading: found[:, [0, -1], 2] for reading, found in tabled.items()}
        verdicts[f"4 both numbers, {key}"] = judge_together(both)
    verdicts["4 normalisation accumulates error"] = judge_normalisation(results)
    return verdicts


def judge_everywhere(true: Mapping[tuple[str, str], NDArray[np.bool_]], what: str) -> Verdict:
    """Judge a statement about a trial, in every reading of what the baseline was."""
    shares = {reading: float(np.mean(found)) for reading, found in true.items()}
    low, high = min(shares.values()), max(shares.values())
    measured = f"{what} in {100 * low:.0f}" + (f" to {100 * high:.0f}" if high > low else "") + " % of the trials"
    reason = "; ".join(f"{' / '.join(reading)}: {100 * share:.0f} %" for reading, share in shares.items())
    if low >= CERTAIN:
        return Verdict("holds", measured, reason)
    return Verdict("does not hold" if high <= 1 - CERTAIN + 1e-12 else "cannot be judged", measured, reason)


def judge_number(printed: float, samples: dict[tuple[str, str], Array]) -> Verdict:
    """Judge a printed reduction, %, by where it stands among the trials of every reading."""
    found = []
    for reading, values in samples.items():
        low, middle, high = np.percentile(values, LEVELS)
        percentile = 100 * float(percentile_of(printed, values))
        found.append((bool(low <= printed <= high), f"{' / '.join(reading)}", low, middle, high, percentile))
    measured = "; ".join(f"{name}: median {m:.2g}, 95 % {a:.3g} to {b:.3g} %" for _, name, a, m, b, _ in found)
    reason = "percentile of the printed number " + ", ".join(f"{row[-1]:.3g}" for row in found)
    return Verdict("holds" if any(row[0] for row in found) else "does not hold", measured, reason)


def judge_together(samples: dict[tuple[str, str], Array]) -> Verdict:
    """Judge both printed reductions as those of one run: as many trials as far from the median as they are."""
    printed = np.array(list(PUBLISHED.values()))
    shares = {}
    for reading, values in samples.items():
        middle = np.median(values, axis=0)
        scale = np.maximum(np.percentile(np.abs(values - middle), 68.3, axis=0), 1e-12)
        far, own = (np.linalg.norm((v - middle) / scale, axis=-1) for v in (values, printed))
        shares[reading] = float(np.mean(far >= own))
    measured = f"{100 * max(shares.values()):.2g} % of the trials are as far from the median"
    reason = "; ".join(f"{' / '.join(reading)}: {100 * share:.2g} %" for reading, share in shares.items())
    return Verdict("holds" if max(shares.values()) >= 1 - CERTAIN else "does not hold", measured, reason)


def judge_normalisation(results: Results) -> Verdict:
    """Judge what normalising costs: the ideal error of the normalised quaternion, and what normalising changes."""
    ideal = max(float(results.errors(case, QUATERNION, "ideal")[..., 2].max()) for case in results.cases)
    typical = min(float(np.median(results.errors(case, QUATERNION)[:, -1, 2])) for case in results.cases)
    changed = max(
        float(np.linalg.norm(results.errors(case, NORMALISED) - results.errors(case, START), axis=-1).max())
        for case in results.cases
    )
    measured = (
        f"normalised quaternion with ideal sensors: {ideal:.2g} m; with the stated IMU {typical:.3g} m; "
        f"normalising the first-order quaternion moves it by {changed:.2g} m"
    )
    reason = "what differs is how velocity increments are resolved, and not the norm"
    return Verdict("holds" if ideal > 0.01 * typical else "does not hold", measured, reason)


def position_table(results: Results) -> Table:
    """Return tables 2 to 4 as distributions."""
    rows = []
    for case in results.cases:
        for place, when in enumerate(results.t[PLACES]):
            for algorithm in TRIED:
                errors = np.abs(results.errors(case, algorithm)[:, PLACES][:, place])
                rows.append((case, when, algorithm.label, *np.percentile(errors, LEVELS, axis=0).T.ravel()))
    names = [f"{axis} {level}, m" for axis in ("east", "north", "total") for level in ("p2.5", "median", "p97.5")]
    title = "Tables 2 to 4 as distributions: sizes of the position errors with the stated IMU"
    return Table.from_rows(("table", "t, s", "algorithm", *names), rows, title)


def reduction_table(results: Results) -> Table:
    """Return by how much the total position error of dual Euler is smaller, and where the printed numbers stand."""
    rows = []
    for case in results.cases:
        for against in TRIED[1:]:
            found = results.reduction(case, against)[:, PLACES, 2]
            for when, values in zip(results.t[PLACES], found.T, strict=True):
                printed = PUBLISHED.get(float(when), float("nan"))
                percentile = 100 * float(percentile_of(printed, values)) if printed == printed else float("nan")
                rows.append((case, against.label, when, *np.percentile(values, LEVELS), printed, percentile))
    names = ("table", "against", "t, s", "p2.5, %", "median, %", "p97.5, %", "published, %", "its percentile")
    return Table.from_rows(names, rows, "By how much the position error of dual Euler is smaller")


def ideal_table(results: Results) -> Table:
    """Return the largest position errors with ideal sensors: what is the algorithm's own."""
    names = list(dict.fromkeys(results.rows.where(part="ideal")["algorithm"].tolist()))
    rows = [
        (case, name, float(results.rows.where(part="ideal", case=case, algorithm=name)["total_m"].max()))
        for case in results.cases
        for name in names
    ]
    return Table.from_rows(("table", "algorithm", "largest error, m"), rows, "Position errors with ideal sensors")


def figures(results: Results) -> list[Figure]:
    """Return all figures."""
    sizes, reductions, spreads = [], [], []
    for case in results.cases:
        lines = []
        for algorithm in (QUATERNION, START, DUAL):
            low, middle, high = np.percentile(results.errors(case, algorithm)[..., 2], LEVELS, axis=0)
            style = "--" if algorithm is DUAL else "-"
            lines.append(Line(algorithm.label, results.t, middle, COLOURS[algorithm], style, low=low, high=high))
        sizes.append(Panel("t, s", "position error, m", lines, case))
        lines = [_reduction_line(results, case, against) for against in TRIED[1:]]
        if results.t[-1] == max(PUBLISHED):
            when, printed = (np.array(list(values)) for values in (PUBLISHED, PUBLISHED.values()))
            lines.append(Line("printed", when, printed, 7, "x"))
        reductions.append(Panel("t, s", "dual Euler smaller by, %", lines, case))
        spreads += [_distribution(results, case, k, float(results.t[PLACES][k])) for k in (0, -1)]
    return [
        Figure(
            "tables_2_to_4",
            "Tables 2 to 4: position error of pure inertial navigation",
            "Median and, as a band, 95 percent of the trials; the curves coincide.",
            sizes,
            columns=2,
        ),
        Figure(
            "reduction",
            "By how much the position error of dual Euler is smaller",
            "Median and 95 percent of the trials against every quaternion; crosses: the printed numbers.",
            reductions,
            columns=2,
            shared_legend=True,
        ),
        Figure(
            "distribution",
            "Distribution of the reduction over the trials",
            "Share of the trials in which dual Euler's position error is smaller by less than so much; cross: the "
            "printed number.",
            spreads,
            columns=2,
            shared_legend=True,
        ),
    ]


def _reduction_line(results: Results, case: str, against: Algorithm) -> Line:
    low, middle, high = np.percentile(results.reduction(case, against)[..., 2], LEVELS, axis=0)
    return Line(against.label, results.t, middle, COLOURS[against], low=low, high=high)


def _distribution(results: Results, case: str, place: int, when: float) -> Panel:
    lines = []
    for against in TRIED[1:]:
        values = np.sort(results.reduction(case, against)[:, PLACES][:, place, 2])
        shown = np.clip(values, -30.0, 30.0)
        lines.append(Line(against.label, shown, np.arange(1, len(values) + 1) / len(values), COLOURS[against]))
    if when in PUBLISHED:
        lines.append(Line("printed", np.array([PUBLISHED[when]]), np.array([0.5]), 7, "x"))
    return Panel("dual Euler smaller by, %", "share of the trials", lines, f"{case}, {when:g} s")


def summary(results: Results, verdicts: dict[str, Verdict]) -> str:
    """Return the finding in one paragraph."""
    equal = max(float(np.abs(results.reduction(case, QUATERNION)[:, PLACES, 2]).max()) for case in results.cases)
    parts = []
    for case in results.cases:
        found = results.reduction(case, START)[:, PLACES, 2]
        parts.append(f"{case}: {found[:, 0].std():.2g} % at the first fifth, {found[:, -1].std():.2g} % at the end")
    rest = max(float(results.errors(case, START, "ideal")[..., 2].max()) for case in results.cases)
    compensated = max(float(results.errors(case, COMPENSATED, "ideal")[..., 2].max()) for case in results.cases)
    return (
        f"{tally(verdicts)} Against a properly integrated, normalised quaternion the position errors of dual Euler are "
        f"the same to {equal:.1g} %, in every trial and at every time. A first-order quaternion, never normalised, "
        f"differs by percents, to either side (standard deviation over the trials {'; '.join(parts)}). **The norm is "
        f"not why**: with ideal sensors the first-order algorithm errs by up to {rest:.3g} m because it resolves "
        f"velocity increments half an update too early; compensated for that, still without normalising, by "
        f"{compensated:.2g} m."
    )
