"""The options, items and evaluation of `dual-euler-swing`: verdicts, tables and figures."""

from dataclasses import dataclass

import numpy as np

from bench.campaign import Item
from bench.experiment import Evaluation, Verdict
from bench.experiments import _dual_euler_figures as figures
from bench.experiments._dual_euler_angle_trials import (
    DUAL_ALONE,
    DUAL_INS,
    QUATERNION_INS,
)
from bench.experiments._dual_euler_angles import LARGEST, NAMES, final
from bench.experiments._dual_euler_judging import (
    TURNED_OVER,
    growth,
    judge_bound,
    judge_flag,
    judge_same_output,
    judge_share,
    judge_smooth,
    judge_turned_over,
    summary_table,
)
from bench.experiments._dual_euler_runs import DURATION, PERIOD, Swing, Work, cut, not_the_papers, require_run
from bench.experiments._judging import tally, withhold
from bench.table import Table

BOUNDS = {"heading": 0.5, "pitch": 1.0, "roll": 0.6}  # arcmin, printed
CHUNK = 50  # trials an item


@dataclass(frozen=True)
class Options:
    """Options of the experiment; the defaults are the paper's conditions.

    Attributes
    ----------
    trials : int
        Monte Carlo trials over sensor errors.
    duration : float
        Length of the run, s.
    """

    trials: int = 100
    duration: float = DURATION

    def __post_init__(self) -> None:
        require_run(self.trials, self.duration)


def items(options: Options, seed: int) -> list[Item]:
    """Cut the Monte Carlo into chunks of trials; the ideal runs belong to the first."""
    case = Swing(options.duration)
    return [Item(f"trial-{first:05d}", Work(case, seed, first, n)) for first, n in cut(options.trials, CHUNK)]


def evaluate(options: Options, seed: int, rows: Table) -> Evaluation:
    """Turn the measures into verdicts, tables and figures."""
    verdicts = withhold(judge(rows), not_the_papers(options, Options(), options.trials))
    tables = {"errors": summary_table(rows, "Largest errors over a run, in the active set and of forward angles")}
    return Evaluation(verdicts, tables, figures.swing_figures(rows, BOUNDS), summary(rows, verdicts))


def judge(rows: Table) -> dict[str, Verdict]:
    """Return the verdict on every claim."""
    ideal, tried = rows.where(part="ideal", samples=1), rows.where(part="trial")
    parts = {"ideal": ideal, "IMU": tried}
    verdicts = {}
    for key, part in parts.items():
        dual, quaternion = part.where(algorithm=DUAL_INS), part.where(algorithm=QUATERNION_INS)
        verdicts[f"1 quaternion jumps, {key}"] = judge_turned_over(quaternion)
        verdicts[f"2 no jumps, {key}"] = judge_smooth(dual)
        verdicts[f"2 flag follows pitch, {key}"] = judge_flag(dual)
    dual = tried.where(algorithm=DUAL_INS)
    verdicts["1 quaternion is singular"] = judge_same_output(dual, tried.where(algorithm=QUATERNION_INS))
    both = Table.concatenate([ideal.where(algorithm=name) for name in (DUAL_INS, DUAL_ALONE)])
    readings = {"ideal": both, "IMU, INS": dual, "IMU, gyros alone": tried.where(algorithm=DUAL_ALONE)}
    for name, bound in BOUNDS.items():
        for key, part in readings.items():
            verdicts[f"2 {name} error, {key}"] = judge_bound(part, name, bound, sensors_lost=key != "ideal")
    for name in ("heading", "roll"):
        verdicts[f"2 {name} error grows"] = judge_growth(dual, name)
    verdicts["2 pitch error swings"] = judge_swing(dual)
    return verdicts


def judge_growth(rows: Table, angle: str) -> Verdict:
    """Judge "the error grows slowly with time"."""
    middle, last, ratio = growth(rows, angle)
    measured = f"RMS {middle:.2g} arcmin in the third fifth, {last:.2g} in the last: ratio {ratio:.3g}"
    return Verdict("holds" if ratio > 1.1 else "does not hold", measured, "over all trials; needs more than 1.1")


def judge_swing(rows: Table) -> Verdict:
    """Judge "the pitch error goes up and down with the swing"."""
    t = np.unique(rows["t_s"])
    error = rows["pitch_arcmin"].reshape(-1, len(t))
    x, w = t / t[-1], 2 * np.pi * t / PERIOD
    slow = np.stack([np.ones_like(x), x, x**2], axis=1)
    fast = np.concatenate([slow, *(np.stack([np.sin(k * w), np.cos(k * w)], axis=1) for k in (1, 2))], axis=1)
    left = [
        ((error.T - basis @ np.linalg.lstsq(basis, error.T, rcond=None)[0]) ** 2).sum(axis=0) for basis in (slow, fast)
    ]
    share = 1 - left[1] / np.maximum(left[0], 1e-300)
    low, middle, high = 100 * np.percentile(share, [2.5, 50, 97.5])
    measured = f"{middle:.2g} % of the variance (95 % of trials: {low:.2g} to {high:.2g} %)"
    reason = "the pitch axis does not turn, and what swings with the body is too fast to tilt an INS"
    return judge_share(share > 0.5, measured, reason)


def summary(rows: Table, verdicts: dict[str, Verdict]) -> str:
    """Return the finding in one paragraph."""

    def largest(part: str, algorithm: str, samples: int = 1) -> list[float]:
        own = rows.where(part=part, algorithm=algorithm, samples=samples)
        return [float(np.median(final(own, name))) for name in LARGEST]

    ideal, four = max(largest("ideal", DUAL_INS)), max(largest("ideal", DUAL_INS, 4))
    found = ", ".join(f"{name} {value:.2g}" for name, value in zip(NAMES, largest("trial", DUAL_INS), strict=True))
    plain = final(rows.where(part="trial", algorithm=DUAL_INS), "plain_heading_deg")
    return (
        f"{tally(verdicts)} With ideal increments dual Euler errs by {ideal:.2g} arcmin ({four:.1g} with four samples "
        f"an update); with the stated IMU the medians of the largest errors are {found} arcmin, and the sensors' draw "
        "decides whether the printed bounds are met. **The quaternion method gives the same active angles**: "
        "what jumps at the poles is the forward extraction, from whatever solver "
        f"({100 * float(np.mean(plain > TURNED_OVER)):.0f} % of the trials turn over, from dual Euler's matrix too)."
    )
