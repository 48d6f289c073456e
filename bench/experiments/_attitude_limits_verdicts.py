"""The verdicts of `attitude-limits`: the streams against their bounds, and where forms agree and converge."""

import math
from dataclasses import dataclass

import numpy as np

from bench.experiment import Evaluation, Judgement, Verdict
from bench.experiments._attitude_limits_maps import FLOOR, cell_table, codes, figures, tables
from bench.experiments._attitude_limits_trials import STREAMS, Options
from bench.table import Table

AGREEMENT = 0.01  # of the error
FORMS = ("FQ", "FR", "FV")
FORM_SAMPLES = (4, 8)
DEGREE = "the solver's series of degree 64 may fail before the iteration does"


@dataclass(frozen=True)
class Bound:
    """An error that a solver must not exceed on a stream; no code: the best of all solvers."""

    key: str
    stream: int
    code: str
    limit: float
    statement: str
    place: str


BOUNDS = (
    Bound(
        "four samples",
        2,
        "FQ4",
        6e-7,
        "functional or Picard iteration on a fit of four samples stops at 5e-7 rad",
        "the fit of [Wu], [WuYan] with N = 4; bound: 6e-7 rad",
    ),
    Bound(
        "window of 8", 2, "W8/4", 1e-11, "the middle four of eight samples: below 1e-11 rad", "bench: borrowed samples"
    ),
    Bound(
        "window of 12",
        2,
        "W12/4",
        5e-14,
        "the middle four of twelve samples: below 5e-14 rad",
        "bench: borrowed samples",
    ),
    Bound("long stream", 1, "", 5e-14, "the best solver stays below 5e-14 rad", "bench: rounding of 6000 increments"),
)


def evaluate(options: Options, seed: int, rows: Table) -> Evaluation:
    """Turn the rows into tables, verdicts and figures."""
    verdicts = {
        **{bound.key: judge_bound(bound, rows) for bound in BOUNDS},
        "forms agree": judge_forms(rows),
        "Rodrigues converges below pi": judge_rodrigues(rows),
        "quaternion converges": judge_quaternion(rows),
    }
    if reason := too_coarse(options):
        for key in ("forms agree", "Rodrigues converges below pi", "quaternion converges"):
            verdicts[key] = Verdict("cannot be judged", verdicts[key].measured, reason)
    return Evaluation(verdicts, tables(options, rows), figures(options, rows), summary(rows))


def too_coarse(options: Options) -> str:
    """Return why a run cannot judge what the map is to show, or nothing."""
    full = Options()
    got = (options.frequencies, options.half_angles, options.cycles, options.max_samples)
    needed = (full.frequencies, full.half_angles, full.cycles, full.max_samples)
    if all(a >= b for a, b in zip(got, needed, strict=True)):
        return ""
    small = f"{got[0]} frequencies, {got[1]} half angles, {got[2]} cycles and N to {got[3]}"
    return f"the map is too small: {small}; needed: {', '.join(map(str, needed))}"


def judge_bound(bound: Bound, rows: Table) -> Verdict:
    """Judge an error on a stream against its bound."""
    stream = STREAMS[bound.stream].name
    chosen = rows.where(stream=stream, status="ok")
    if bound.code:
        chosen = chosen.where(code=bound.code)
    if not len(chosen):
        return Verdict("cannot be judged", "not run", f"{bound.code or 'no solver'} has no result on {stream}")
    k = int(np.argmin(chosen["error_rad"]))
    error, label = chosen["error_rad"][k], chosen["label"][k]
    judgement: Judgement = "holds" if error <= bound.limit else "does not hold"
    reason = f"largest error over the stream {stream} at 100 Hz, {label}; the bound is {bound.limit:g} rad"
    return Verdict(judgement, f"{error:.2g} rad", reason)


def judge_forms(rows: Table) -> Verdict:
    """Judge whether the three forms of functional iteration give one result wherever all give one."""
    worst, where, count = 0.0, "", 0
    for N in FORM_SAMPLES:
        parts = [rows.where(code=f"{form}{N}") for form in FORMS]
        if not all(len(part) for part in parts):
            return Verdict("cannot be judged", "not run", f"not all forms are there with N = {N}")
        errors = np.array([part["error_rad"] for part in parts])
        served = np.all([part["status"] == "ok" for part in parts], axis=0)
        count += int(served.sum())
        spread = np.where(served, np.ptp(errors, axis=0), 0.0)
        relative = np.where(spread <= FLOOR, 0.0, spread / np.where(served, errors[0], 1.0))
        k = int(np.argmax(relative))
        if relative[k] > worst:
            worst = float(relative[k])
            where = f", most at {parts[0]['half_angle_deg'][k]:g} deg and {parts[0]['relative_frequency'][k]:.3g}"
    measured = f"errors differ by {100 * worst:.2g} % of the error at most, beyond rounding ({FLOOR:g} rad)"
    reason = f"{count} cells and streams in which all three forms give a result, N = 4 and 8{where}"
    return Verdict("holds" if worst <= AGREEMENT else "does not hold", measured, reason)


def judge_rodrigues(rows: Table) -> Verdict:
    """Judge whether the Rodrigues form serves all updates below pi and refuses those above."""
    cells = cell_table(rows)
    cells = Table.concatenate([cells.where(code=f"FR{N}") for N in FORM_SAMPLES])
    if not len(cells):
        return Verdict("cannot be judged", "not run", "the Rodrigues form is not there")
    angle, refused = cells["angle_per_update_rad"], cells["status"] == "refused"
    measured = (
        f"served up to S = {angle[~refused].max(initial=0.0):.4g} rad in an update, refused from "
        f"{angle[refused].min(initial=math.inf):.4g} rad"
    )
    early, late = int((refused & (angle < math.pi)).sum()), int((~refused & (angle >= math.pi)).sum())
    reason = f"{len(cells)} cells with N = 4 and 8, {refused.sum()} of them refused, {early} of these below pi"
    if late:
        return Verdict("does not hold", measured, f"{reason}; {late} served from pi on")
    return Verdict("cannot be judged" if early else "holds", measured, reason + (f": {DEGREE}" if early else ""))


def judge_quaternion(rows: Table) -> Verdict:
    """Judge whether the quaternion form gives a result in every cell."""
    cells = cell_table(rows).where(solver="functional-iteration")
    keep = np.char.startswith(cells["code"].astype(str), "FQ")
    angle, refused = cells["angle_per_update_rad"][keep], cells["status"][keep] == "refused"
    measured = f"served up to S = {angle[~refused].max(initial=0.0):.3g} rad in an update"
    if not refused.any():
        return Verdict("holds", measured, f"all {len(refused)} cells served, N = 1 to 8")
    measured += f", refused {refused.sum()} of {len(refused)} cells, from {angle[refused].min():.3g} rad"
    return Verdict("cannot be judged", measured, f"in the refused cells {DEGREE}")


def summary(rows: Table) -> str:
    """Return one paragraph: what was found."""
    text = []
    for stream in STREAMS:
        found = rows.where(stream=stream.name, status="ok")
        k, quick = int(np.argmin(found["error_rad"])), found.where(latency=0)
        j = int(np.argmin(quick["error_rad"]))
        text.append(
            f"{stream.name}: best {found['label'][k]} with {found['error_rad'][k]:.1e} rad, without latency "
            f"{quick['label'][j]} with {quick['error_rad'][j]:.1e} rad"
        )
    refused = int((rows["status"] == "refused").sum())
    return (
        f"{len(codes(rows))} solvers, {len(rows)} runs, {refused} refused. On the streams at 100 Hz: "
        + "; ".join(text)
        + "."
    )
