"""The verdicts of `attitude-manoeuvre`: claim 8 for every reading of "rotation vector", and the paper's own truth."""

import numpy as np

from bench.errors import Array
from bench.experiment import Evaluation, Verdict
from bench.experiments import _attitude_manoeuvre_figures as figures
from bench.experiments._attitude_judging import Band, Curve, judge, orders, printed_orders
from bench.experiments._attitude_manoeuvre_trials import MOTION, PAPERS_TRUTH, RATE, TRUTH_RATE, Options
from bench.experiments._attitude_trials import ALL, ANGLES, ENOUGH_PHASES, MEASURES, NEW, READINGS, Algorithm, Errors
from bench.experiments._judging import tally, withhold
from bench.table import Table
from bench.units import ARCSEC

ALIKE = float(np.log10(1.1))  # orders: curves that a figure does not tell apart
MARGIN = 10.0  # a truth must be this much better than what it judges


def evaluate(options: Options, seed: int, rows: Table) -> Evaluation:
    """Turn the rows into tables, verdicts and figures."""
    truth = rows.where(algorithm=PAPERS_TRUTH.label)
    is_truth = rows["algorithm"] == PAPERS_TRUTH.label
    errors = Errors.of(Table({name: column[~is_truth] for name, column in rows.columns.items()}))
    verdicts = withhold(judge_all(errors, truth), not_the_papers(options))
    tables = {"errors": error_table(errors), "truths": truth_table(errors, truth)}
    drawn = figures.figures(options, seed, errors)
    return Evaluation(verdicts, tables, drawn, summary(verdicts, errors, truth), None)


def not_the_papers(options: Options) -> str:
    """Return why a run cannot judge the paper, or nothing."""
    if options.rate != RATE:
        return f"the sampling rate is {options.rate:g} Hz, not the stated {RATE:g} Hz"
    if options.truth_rate != TRUTH_RATE:
        return f"the rate of the paper's truth is {options.truth_rate:g} Hz, not the stated {TRUTH_RATE:g} Hz"
    if options.phases < ENOUGH_PHASES:
        return f"{options.phases} phases of the quantiser are too few, at least {ENOUGH_PHASES} are needed"
    return ""


def judge_all(errors: Errors, truth: Table) -> dict[str, Verdict]:
    """Return the verdict of every claim, by its key."""
    verdicts: dict[str, Verdict] = {}
    for name, rotvec in READINGS.items():
        verdicts |= {
            f"8 ideal, {name}": judge_ideal(errors, rotvec),
            f"8 quantised, {name}": judge_quantised(errors, rotvec),
            f"8 cost of quantisation, {name}": judge_cost(errors, rotvec),
        }
    verdicts["standard attitude"] = judge_truth(errors, truth)
    return verdicts


def judge_ideal(errors: Errors, rotvec: Algorithm) -> Verdict:
    """Ideal errors of the rotation vector over those of the new algorithms, three samples."""
    top = errors.middle(rotvec, 3, "ideal")
    curves = [
        Curve(a.label, ANGLES[k], orders(top[:, k], errors.middle(a, 3, "ideal")[:, k])) for a in NEW for k in range(3)
    ]
    return judge(curves, printed_orders(2), errors.rates)


def judge_quantised(errors: Errors, rotvec: Algorithm) -> Verdict:
    """Return the verdict on the largest over the smallest of the three quantised errors, median over the phases."""
    found = np.array([errors.phases(a, 3, "quantised") for a in (rotvec, *NEW)])
    ratio = np.median(orders(found.max(axis=0), found.min(axis=0)), axis=0)
    curves = [Curve("the three", ANGLES[k], ratio[:, k]) for k in range(3)]
    return judge(curves, Band(high=ALIKE), errors.rates)


def judge_cost(errors: Errors, rotvec: Algorithm) -> Verdict:
    """Quantised over ideal errors of the three algorithms."""
    curves = []
    for algorithm in (rotvec, *NEW):
        ideal, reported = (errors.middle(algorithm, 3, data) for data in ("ideal", "quantised"))
        curves += [Curve(algorithm.label, ANGLES[k], orders(reported[:, k], ideal[:, k])) for k in range(3)]
    return judge(curves, printed_orders(4, 6), errors.rates)


def _rotation(errors: Errors, algorithm: Algorithm, samples: int, data: str = "ideal") -> Array:
    """Return the largest rotation error in every phase, shape (phases,), arcsec."""
    return errors.cells[algorithm.label, samples, data][:, 0, MEASURES.index("rotation")]


def judge_truth(errors: Errors, truth: Table) -> Verdict:
    """Compare the one-sample solution at 1 MHz with what it is to judge."""
    own = float(truth["rotation_arcsec"][0])
    judged = {f"{a.label}, N = {N}": float(_rotation(errors, a, N)[0]) for a in NEW for N in a.samples}
    enough = [name for name, value in judged.items() if value >= MARGIN * own]
    smallest = min(judged.values())
    three = min(float(_rotation(errors, a, 3)[0]) for a in NEW)
    measured = f"{own:.2g} arcsec"
    reason = (
        f"the new algorithms with three samples err by {three:.2g} arcsec, with up to six by as little as "
        f"{smallest:.2g}: good enough for {len(enough)} of {len(judged)} (algorithm, N)"
    )
    return Verdict("holds" if three >= MARGIN * own else "does not hold", measured, reason)


def error_table(errors: Errors) -> Table:
    """Return the largest errors of all algorithms, ideal, and quantised as distributions."""
    rows = []
    for algorithm in ALL:
        for N in algorithm.samples:
            ideal = errors.cells[algorithm.label, N, "ideal"][0, 0]
            row: list[object] = [algorithm.label, N, *ideal[:4]]
            cell = errors.cells.get((algorithm.label, N, "quantised"))
            for k in range(4):
                if cell is None:
                    row.append("-")
                else:
                    low, middle, high = np.percentile(cell[:, 0, k], [5, 50, 95])
                    row.append(f"{middle:.3g} ({low:.2g} to {high:.2g})")
            rows.append(row)
    names = ["algorithm", "N", *MEASURES[:4], *(f"quantised: {measure}" for measure in MEASURES[:4])]
    title = "Largest errors over 1.2 s, arcsec; quantised: median over the phases (5 to 95 %)"
    return Table.from_rows(names, rows, title)


def truth_table(errors: Errors, truth: Table) -> Table:
    """Return how good the truths are, beside the algorithms that they judge."""
    rows = [
        ("reference of this bench: error estimate", MOTION.error_estimate / ARCSEC),
        (f"one sample at {truth['rate_hz'][0]:g} Hz, the paper's truth", truth["rotation_arcsec"][0]),
    ]
    for algorithm in (*NEW, READINGS["Eq. 4"]):
        rows += [
            (f"{algorithm.label}, N = {N}, {errors.rates[0]:g} Hz", _rotation(errors, algorithm, N)[0])
            for N in algorithm.samples
        ]
    return Table.from_rows(("attitude", "largest rotation error, arcsec"), rows, "The truths, and what they judge")


def summary(verdicts: dict[str, Verdict], errors: Errors, truth: Table) -> str:
    """Return the finding in one paragraph."""
    three = float(_rotation(errors, NEW[0], 3)[0])
    spread = np.percentile(_rotation(errors, NEW[0], 3, "quantised"), [5, 95])
    return (
        f"{tally(verdicts)} The Taylor quaternion with three samples errs by {three:.2g} arcsec with ideal increments, "
        f"by {spread[0]:.2g} to {spread[1]:.2g} arcsec with quantised ones, as does the rotation vector. The "
        f"one-sample solution at {truth['rate_hz'][0]:g} Hz that the paper takes as truth is good to "
        f"{truth['rotation_arcsec'][0]:.2g} arcsec, the reference used here to {MOTION.error_estimate / ARCSEC:.1g}."
    )
