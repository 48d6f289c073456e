"""The verdicts of `attitude-coning`: every claim for every reading of "rotation vector", tables and summary."""

import numpy as np

from bench.errors import Array
from bench.experiment import Evaluation, Verdict
from bench.experiments import _attitude_coning_figures as figures
from bench.experiments._attitude_coning_trials import DURATION, RATES, Options
from bench.experiments._attitude_judging import HALF, Band, Curve, judge, judge_phases, orders, printed_orders, slope
from bench.experiments._attitude_trials import (
    ALL,
    ANGLES,
    ENOUGH_PHASES,
    FULL_DCM,
    FULL_QUATERNION,
    NEW,
    QUATERNION,
    READINGS,
    SAMPLES,
    Algorithm,
    Errors,
)
from bench.experiments._judging import tally, withhold
from bench.table import Table

LOW_RATES = (100.0, 210.0)  # Hz, of claim 4
FEW_RATES = 1000.0  # Hz, of claim 7


def evaluate(options: Options, seed: int, rows: Table) -> Evaluation:
    """Turn the rows into tables, verdicts and figures."""
    errors = Errors.of(rows)
    verdicts = withhold(judge_all(errors), not_the_papers(options))
    tables = {"ideal": ideal_table(errors), "quantised": quantised_table(errors)}
    return Evaluation(verdicts, tables, figures.figures(options, errors), summary(verdicts, errors), None)


def not_the_papers(options: Options) -> str:
    """Return why a run cannot judge the paper, or nothing."""
    if options.duration != DURATION:
        return f"the run is {options.duration:g} s long, not the stated {DURATION:g} s"
    rates = options.rates
    if len(rates) < len(RATES) or (min(rates), max(rates)) != (min(RATES), max(RATES)):
        return f"{len(rates)} rates from {min(rates):g} to {max(rates):g} Hz, not {len(RATES)} from 100 to 10000 Hz"
    if options.phases < ENOUGH_PHASES:
        return f"{options.phases} phases of the quantiser are too few, at least {ENOUGH_PHASES} are needed"
    return ""


def judge_all(errors: Errors) -> dict[str, Verdict]:
    """Return the verdict of every claim, by its key."""
    verdicts: dict[str, Verdict] = {}
    for name, rotvec in READINGS.items():
        verdicts |= {
            f"1 pitch and roll, {name}": judge_periodic(errors, rotvec),
            f"2 yaw, {name}": judge_drift(errors, rotvec),
            f"3 better with rate, {name}": judge_gain(errors, rotvec),
            f"4 quantised: pitch and roll agree, {name}": judge_agreement(errors, rotvec),
            f"4 quantised: yaw at 100 to 210 Hz, {name}": judge_low_rates(errors, rotvec),
            f"5 cost of quantisation, {name}": judge_cost(errors, rotvec),
            f"5 quantised: no gain with rate, {name}": judge_no_gain(errors, rotvec),
            f"6 degrades with samples, {name}": judge_degradation(errors, rotvec),
            f"7 better than the rotation vector, {name}": judge_superiority(errors, rotvec),
        }
    verdicts["7 more samples, ten terms"] = judge_samples(errors, NEW)
    verdicts["7 more samples, enough terms"] = judge_samples(errors, (FULL_QUATERNION, FULL_DCM))
    return verdicts


def _ideal(errors: Errors, algorithm: Algorithm, samples: int = 3) -> Array:
    return errors.middle(algorithm, samples, "ideal")


def judge_periodic(errors: Errors, rotvec: Algorithm) -> Verdict:
    """Claim 1: pitch and roll errors of the rotation vector over those of the new algorithms."""
    top = _ideal(errors, rotvec)
    curves = [Curve(a.label, ANGLES[k], orders(top[:, k], _ideal(errors, a)[:, k])) for a in NEW for k in (0, 1)]
    return judge(curves, printed_orders(2), errors.rates)


def judge_drift(errors: Errors, rotvec: Algorithm) -> Verdict:
    """Claim 2: yaw errors of the new algorithms over that of the rotation vector."""
    bottom = _ideal(errors, rotvec)[:, 2]
    curves = [Curve(a.label, "yaw", orders(_ideal(errors, a)[:, 2], bottom)) for a in NEW]
    return judge(curves, printed_orders(2), errors.rates)


def judge_gain(errors: Errors, rotvec: Algorithm) -> Verdict:
    """Claim 3: the fall of every error from each rate to the next, as long as it is not at rounding."""
    curves = []
    for algorithm in (rotvec, *NEW):
        found = _ideal(errors, algorithm)
        curves += [Curve(algorithm.label, ANGLES[k], orders(found[:-1, k], found[1:, k])) for k in range(3)]
    return judge(curves, Band(low=np.finfo(float).tiny), errors.rates[:-1], share=1.0)


def judge_agreement(errors: Errors, rotvec: Algorithm) -> Verdict:
    """Claim 4, first half: the largest over the smallest of the three median errors, pitch and roll."""
    found = np.array([errors.middle(a, 3, "quantised") for a in (rotvec, *NEW)])
    curves = [Curve("the three", ANGLES[k], orders(found.max(axis=0)[:, k], found.min(axis=0)[:, k])) for k in (0, 1)]
    return judge(curves, Band(high=HALF), errors.rates, share=1.0)


def judge_low_rates(errors: Errors, rotvec: Algorithm) -> Verdict:
    """Claim 4, second half: in which phases of the quantiser the rotation vector's yaw is the best of the three."""
    low = (errors.rates >= LOW_RATES[0]) & (errors.rates <= LOW_RATES[1])
    if not low.any():
        return Verdict("cannot be judged", "-", "no rate from 100 to 210 Hz")
    own = errors.phases(rotvec, 3, "quantised")[:, low, 2]
    best_new = np.min([errors.phases(a, 3, "quantised")[:, low, 2] for a in NEW], axis=0)
    value = orders(best_new, own)
    curves = [Curve("new over old", f"{rate:g} Hz", value[:, k]) for k, rate in enumerate(errors.rates[low])]
    return judge_phases(curves, Band(low=np.finfo(float).tiny))


def judge_cost(errors: Errors, rotvec: Algorithm) -> Verdict:
    """Claim 5, first half: quantised over ideal error of the three algorithms."""
    curves = []
    for algorithm in (rotvec, *NEW):
        ideal, reported = (errors.middle(algorithm, 3, data) for data in ("ideal", "quantised"))
        curves += [Curve(algorithm.label, ANGLES[k], orders(reported[:, k], ideal[:, k])) for k in range(3)]
    return judge(curves, printed_orders(4, 5), errors.rates)


def judge_no_gain(errors: Errors, rotvec: Algorithm) -> Verdict:
    """Claim 5, second half: the fall of the quantised errors from the lowest to the highest rate, in every phase."""
    curves = []
    for algorithm in (rotvec, *NEW):
        found = errors.phases(algorithm, 3, "quantised")
        curves += [Curve(algorithm.label, ANGLES[k], orders(found[:, 0, k], found[:, -1, k])) for k in range(3)]
    return judge_phases(curves, Band(high=HALF))


def judge_degradation(errors: Errors, rotvec: Algorithm) -> Verdict:
    """Claim 6: the smallest growth of the error from N to N + 1 samples, N = 3, 4, 5."""
    found = np.array([_ideal(errors, rotvec, N) for N in SAMPLES])
    curves = []
    for k in range(3):
        steps = np.array([orders(found[i + 1, :, k], found[i, :, k]) for i in range(len(SAMPLES) - 1)])
        curves.append(Curve(rotvec.label, ANGLES[k], steps.min(axis=0)))
    return judge(curves, Band(low=np.finfo(float).tiny), errors.rates)


def judge_samples(errors: Errors, new: tuple[Algorithm, ...]) -> Verdict:
    """Claim 7, first half: 3 over 6 samples, below 1 kHz."""
    low = errors.rates < FEW_RATES
    curves = []
    for three, algorithm in zip(NEW, new, strict=True):
        few, many = _ideal(errors, three)[low], _ideal(errors, algorithm, 6)[low]
        curves += [Curve(algorithm.label, ANGLES[k], orders(few[:, k], many[:, k], bound=True)) for k in range(3)]
    return judge(curves, Band(low=HALF), errors.rates[low])


def judge_superiority(errors: Errors, rotvec: Algorithm) -> Verdict:
    """Claim 7, second half: rotation vector over new algorithms with 6 samples, below 1 kHz."""
    low = errors.rates < FEW_RATES
    top = _ideal(errors, rotvec, 6)[low]
    curves = [
        Curve(a.label, ANGLES[k], orders(top[:, k], _ideal(errors, a, 6)[low, k], bound=True))
        for a in NEW
        for k in range(3)
    ]
    return judge(curves, Band(low=np.finfo(float).tiny), errors.rates[low])


def _some_rates(errors: Errors) -> list[int]:
    """Return the places of the lowest rate, of that next to 1 kHz, and of the highest."""
    middle = int(np.argmin(np.abs(np.log(errors.rates / 1000.0))))
    return sorted({0, middle, len(errors.rates) - 1})


def ideal_table(errors: Errors) -> Table:
    """Return errors at three rates and fitted slopes, beside the orders that the solvers declare."""
    rows = []
    for algorithm in ALL:
        for N in algorithm.samples:
            found = _ideal(errors, algorithm, N)
            solver = algorithm.make(N)
            row = [algorithm.label, N]
            for k in (0, 2):
                row += [found[place, k] for place in _some_rates(errors)]
                row.append(_text(-slope(errors.rates, found[:, k])))
                row.append(_text(solver.order_periodic if k == 0 else solver.order_drift))
            rows.append(row)
    names = ["algorithm", "N"]
    for k in (0, 2):
        names += [f"{ANGLES[k]} at {errors.rates[place]:g} Hz" for place in _some_rates(errors)]
        names += [f"{ANGLES[k]}: order found", f"{ANGLES[k]}: declared"]
    return Table.from_rows(names, rows, "Ideal increments: largest errors, arcsec, and the fitted order in dt")


def quantised_table(errors: Errors) -> Table:
    """Return medians and spread over the phases of the quantiser at three rates."""
    rows = []
    for label, N, data in errors.cells:
        if data == "quantised":
            found = errors.cells[label, N, data]
            row: list[object] = [label, N]
            for k in (0, 2):
                for place in _some_rates(errors):
                    low, middle, high = np.percentile(found[:, place, k], [5, 50, 95])
                    row.append(f"{middle:.3g} ({low:.2g} to {high:.2g})")
            rows.append(row)
    names = ["algorithm", "N"]
    names += [f"{ANGLES[k]} at {errors.rates[place]:g} Hz" for k in (0, 2) for place in _some_rates(errors)]
    title = "Increments quantised to 1 arcsec: largest errors, arcsec, median over the phases (5 to 95 %)"
    return Table.from_rows(names, rows, title)


def _text(value: float | None) -> str:
    return "-" if value is None or np.isnan(value) else f"{value:.3g}"


def summary(verdicts: dict[str, Verdict], errors: Errors) -> str:
    """Return the finding in one paragraph."""
    both = [
        name
        for name in READINGS
        if verdicts[f"1 pitch and roll, {name}"].judgement == verdicts[f"2 yaw, {name}"].judgement == "holds"
    ]
    which = f" ({', '.join(both)})" if both else ""
    text = (
        f"{tally(verdicts)} Claims 1 and 2 hold together in {len(both)} of {len(READINGS)} readings of "
        f'"rotation vector"{which}. With the printed coefficients (57/80, 33/80) it is the same polynomial as in '
        "the new algorithms, and the drift about the vertical is the same"
    )
    drift = [errors.cells[a.label, 3, "ideal"][0, 0, 4] for a in (READINGS["Eq. 4"], QUATERNION)]
    return f"{text}: {drift[0]:.4g} and {drift[1]:.4g} arcsec at {errors.rates[0]:g} Hz."
