"""How the dual-Euler experiments judge: statements about one run are placed among the trials of a Monte Carlo."""

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array
from bench.experiment import Verdict
from bench.experiments._dual_euler_angles import LARGEST, NAMES, PLAIN_ERRORS, final
from bench.table import Table

CERTAIN = 0.95  # of the trials
FEW = 2  # ideal runs, of different algorithms: no trials
TURNED_OVER = 90.0  # deg: an angle that is so far off has jumped
SMOOTH = 1.0  # deg: largest step between two outputs, beyond that of the truth, that a figure would not show as a jump
SHARES = (
    "holds if true in 95 % of the trials, does not hold if in 5 % or less; in between it cannot be judged, because it "
    "hangs on the draw of the sensor errors"
)


def judge_share(true: NDArray[np.bool_], measured: str, reason: str) -> Verdict:
    """Judge a statement that is true in some of the trials; `true` (trials,) says in which."""
    share = float(np.mean(true))
    text = f"true in {100 * share:.0f} % of {len(true)} trials; {reason}" if len(true) > FEW else reason
    if share >= CERTAIN:
        return Verdict("holds", measured, text)
    return Verdict("does not hold" if share <= 1 - CERTAIN + 1e-12 else "cannot be judged", measured, text)


def spread(values: Array, unit: str) -> str:
    """Return the median of values over trials and where 95 % of them lie; of a few runs the range."""
    if len(values) <= FEW:
        low, high = (f"{value:.3g}" for value in (values.min(), values.max()))
        return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"
    low, middle, high = (f"{value:.3g}" for value in np.percentile(values, [2.5, 50, 97.5]))
    return f"median {middle} {unit}, 95 % of trials {low} to {high} {unit}"


def judge_bound(rows: Table, angle: str, bound: float, *, sensors_lost: bool = False) -> Verdict:
    """Judge "the error stays below so many arcmin"; where the sensors are not known, an excess refutes nothing."""
    largest = final(rows, f"largest_{angle}_arcmin")
    measured = f"largest error {spread(largest, 'arcmin')}"
    verdict = judge_share(largest <= bound, measured, f"the bound is {bound:g} arcmin")
    if sensors_lost and verdict.judgement == "does not hold":
        reason = f"{verdict.reason}; the table of the simulation's sensors is lost, they may have been better"
        return Verdict("cannot be judged", measured, reason)
    return verdict


def judge_turned_over(rows: Table) -> Verdict:
    """Judge "heading and roll as commonly extracted jump near the poles"."""
    least = np.minimum(final(rows, PLAIN_ERRORS[0]), final(rows, PLAIN_ERRORS[2]))
    reason = f"a heading and a roll that are more than {TURNED_OVER:g} deg off have jumped"
    return judge_share(least > TURNED_OVER, f"smaller one of the largest errors {spread(least, 'deg')}", reason)


def judge_smooth(rows: Table) -> Verdict:
    """Judge "no angle of the active set jumps"."""
    step, off = final(rows, "step_deg"), final(rows, "output_off_deg")
    measured = f"largest step beyond the true one {spread(step, 'deg')}; angle at most {off.max():.3g} deg off"
    reason = f"a step between two outputs that differs by less than {SMOOTH:g} deg from the true one is no jump"
    return judge_share((step < SMOOTH) & (off < TURNED_OVER), measured, reason)


def judge_flag(rows: Table) -> Verdict:
    """Judge "the flag follows the pitch"."""
    wrong, switches, true = (final(rows, name) for name in ("flag_wrong_s", "switches", "true_switches"))
    measured = f"{_range(switches)} changes, {_range(true)} by the true pitch; {wrong.max():.3g} s against the rule"
    if true.max() == 0:
        return Verdict(
            "does not hold", measured, "the pitch never reaches 45 deg: the flag stays 1 and changes nowhere"
        )
    reason = "-1 above |P| = 50 deg, 1 below 40 deg, one change a passage"
    return judge_share((wrong == 0) & (switches == true), measured, reason)


def _range(values: Array) -> str:
    low, high = values.min(), values.max()
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def judge_same_output(dual: Table, quaternion: Table) -> Verdict:
    """Judge "the quaternion method cannot put out angles at the pole": take the active set from it as well."""
    larger = max(float(np.max(final(quaternion, name) / final(dual, name))) for name in LARGEST)
    smaller = min(float(np.min(final(quaternion, name) / final(dual, name))) for name in LARGEST)
    measured = f"errors of the quaternion in the active set are {smaller:.4f} to {larger:.4f} of those of dual Euler"
    reason = "forward and reverse angles can be taken from any attitude; only forward ones are not defined at the pole"
    return Verdict("holds" if smaller > 1.1 else "does not hold", measured, reason)


def growth(rows: Table, angle: str) -> tuple[float, float, float]:
    """Return the RMS over the trials of an angle's error in the third fifth and the last, arcmin, and their ratio."""
    t, error = rows["t_s"], rows[f"{angle}_arcmin"]
    end = t.max()
    middle, last = (
        float(np.sqrt(np.mean(error[(t > low * end) & (t <= high * end)] ** 2))) for low, high in ((0.4, 0.6), (0.8, 1))
    )
    return middle, last, last / middle


def summary_table(rows: Table, title: str) -> Table:
    """Return the largest errors over each run, by part, case, algorithm and samples: median and 97.5 percentile."""
    found = []
    for part, case, algorithm, samples in dict.fromkeys(
        zip(*(rows[name].tolist() for name in ("part", "case", "algorithm", "samples")), strict=True)
    ):
        if part.endswith("series"):
            continue
        own = rows.where(part=part, case=case, algorithm=algorithm, samples=samples)
        row: list[object] = ["ideal" if part == "ideal" else "stated IMU", case, algorithm, samples]
        for name in (*LARGEST, "away_heading_arcmin", "away_roll_arcmin", PLAIN_ERRORS[0], PLAIN_ERRORS[2]):
            row += [float(np.percentile(final(own, name), level)) for level in (50, 97.5)][
                : 2 if part == "trial" else 1
            ]
            row += [] if part == "trial" else [row[-1]]
        found.append(tuple(row))
    active = [f"{name} {level}, arcmin" for name in NAMES for level in ("median", "p97.5")]
    away = [
        f"forward {name} below 80 deg {level}, arcmin" for name in ("heading", "roll") for level in ("median", "p97.5")
    ]
    plain = [f"forward {name} {level}, deg" for name in ("heading", "roll") for level in ("median", "p97.5")]
    return Table.from_rows(("sensors", "motion", "algorithm", "N", *active, *away, *plain), found, title)
