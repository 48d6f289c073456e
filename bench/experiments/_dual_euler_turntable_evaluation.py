"""The evaluation of `dual-euler-turntable`: verdicts, tables and figures."""

import numpy as np

from bench.experiment import Evaluation, Verdict
from bench.experiments import _dual_euler_figures as figures
from bench.experiments._dual_euler_angle_trials import DUAL_INS
from bench.experiments._dual_euler_angles import final
from bench.experiments._dual_euler_judging import (
    growth,
    judge_bound,
    judge_flag,
    judge_share,
    judge_smooth,
    spread,
    summary_table,
)
from bench.experiments._dual_euler_runs import RATES, TableOptions, not_the_papers
from bench.experiments._judging import tally, withhold
from bench.table import Table
from bench.units import ARCMIN, DEG

BOUND = 2.0  # arcmin, printed
FOLLOWS = 0.1  # of the fluctuation: what is missed does not show beside it
STABLE = 1.1  # the error of the last fifth is that of the third, to a tenth
SMALL = 0.05
STATED = " **The stated rate cannot be the one of the figures**: it does not reach the first change of the flag."
ACCURACY = 0.0001 * DEG  # of the table's angles, stated
NEAR = 89.0  # deg


def evaluate(options: TableOptions, seed: int, rows: Table) -> Evaluation:
    """Turn the measures into verdicts, tables and figures."""
    found = judge(rows) if set(options.rates) == set(RATES) else {}
    if not found:  # other tables: nothing of the paper's to judge
        found = {key: Verdict("cannot be judged", "not run", "") for key in claim_keys()}
    verdicts = withhold(found, not_the_papers(options, TableOptions(), options.trials))
    tables = {"errors": summary_table(rows, "Largest errors over a run, in the active set and of forward angles")}
    return Evaluation(verdicts, tables, figures.turntable_figures(rows, BOUND), summary(rows, verdicts))


def claim_keys() -> list[str]:
    """Return the keys of all claims."""
    whats = ("pitch error", "stays stable", "follows fluctuations", "no jump at the poles", "flag follows pitch")
    keys = [f"3 {what}, {rate:g} deg/s" for rate in RATES for what in whats]
    return [*keys, "3 reaches +-90 deg", "3 table is exact"]


def judge(rows: Table) -> dict[str, Verdict]:
    """Return the verdict on every claim."""
    verdicts = {}
    for rate in RATES:
        case = f"{rate:g} deg/s"
        dual = rows.where(part="trial", case=case, algorithm=DUAL_INS)
        reach = reached(rows, case)
        verdicts[f"3 pitch error, {case}"] = judge_bound(dual, "pitch", BOUND)
        verdicts[f"3 stays stable, {case}"] = judge_stable(dual)
        verdicts[f"3 follows fluctuations, {case}"] = judge_fluctuations(dual)
        verdicts[f"3 no jump at the poles, {case}"] = (
            judge_smooth(dual)
            if reach[1] > NEAR
            else Verdict(
                "cannot be judged", f"pitch up to {reach[1]:.1f} deg", "at this rate the table comes near no pole"
            )
        )
        verdicts[f"3 flag follows pitch, {case}"] = judge_flag(dual)
    low, high = reached(rows, f"{RATES[0]:g} deg/s")
    verdicts["3 reaches +-90 deg"] = Verdict(
        "holds" if low < -NEAR and high > NEAR else "does not hold",
        f"pitch {low:.1f} to {high:.1f} deg",
        "0.015 deg/s times 2500 s is 37.5 deg: rate, time and range exclude one another",
    )
    verdicts["3 table is exact"] = judge_table(rows.where(part="trial", algorithm=DUAL_INS))
    return verdicts


def reached(rows: Table, case: str) -> tuple[float, float]:
    """Return the range of the table's pitch, deg."""
    pitch = rows.where(part="series", case=case, algorithm=DUAL_INS)["true_pitch_deg"]
    return float(pitch.min()), float(pitch.max())


def judge_stable(rows: Table) -> Verdict:
    """Judge "the pitch error stays stable"."""
    middle, last, ratio = growth(rows, "pitch")
    measured = f"RMS {middle:.2g} arcmin in the third fifth, {last:.2g} in the last: ratio {ratio:.3g}"
    reason = f"over all trials; needs at most {STABLE:g}, a constant drift would give 1.8"
    return Verdict("holds" if ratio <= STABLE else "does not hold", measured, reason)


def judge_fluctuations(rows: Table) -> Verdict:
    """Judge "the attitude follows the fluctuations of the rate"."""
    trials = len(np.unique(rows["trial"]))
    true, error = (rows[f"wiggle_{what}_arcmin"].reshape(trials, -1) for what in ("true", "error"))
    moving = true > 0.01 * np.median(true, axis=1, keepdims=True)
    ratio = np.array([np.median((e / t)[m]) for e, t, m in zip(error, true, moving, strict=True)])
    measured = f"{spread(100 * ratio, '%')} of the pitch's {np.median(true):.2g} arcmin"
    return judge_share(ratio < FOLLOWS, measured, "what the error adds is the noise of the gyros")


def judge_table(rows: Table) -> Verdict:
    """Judge "the table is without error": its accuracy against the errors that it measures."""
    largest = float(np.median(final(rows, "largest_pitch_arcmin")))
    share = ACCURACY / ARCMIN / largest
    measured = f"{ACCURACY / ARCMIN:.2g} arcmin of {largest:.2g} arcmin: {100 * share:.2g} %"
    reason = "here the truth is the joint's motion itself, and no encoder's"
    return Verdict("holds" if share < SMALL else "does not hold", measured, reason)


def summary(rows: Table, verdicts: dict[str, Verdict]) -> str:
    """Return the finding in one paragraph."""
    parts = []
    for case in dict.fromkeys(rows["case"].tolist()):
        own = rows.where(part="trial", case=case, algorithm=DUAL_INS)
        low, high = reached(rows, case)
        parts.append(
            f"at {case} the table goes from {low:z.1f} to {high:z.1f} deg and the largest pitch error is "
            f"{spread(final(own, 'largest_pitch_arcmin'), 'arcmin')}"
        )
    ideal = rows.where(part="ideal", algorithm=DUAL_INS, samples=1)
    return (
        f"{tally(verdicts)} Driven by its servos against friction, {'; '.join(parts)}. With ideal sensors dual Euler "
        f"errs by at most {final(ideal, 'largest_pitch_arcmin').max():.2g} arcmin of pitch."
        + (STATED if verdicts["3 reaches +-90 deg"].judgement == "does not hold" else "")
    )
