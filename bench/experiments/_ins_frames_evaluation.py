"""The evaluation of `ins-frames`: verdicts, tables, figures and the finding in one paragraph."""

from bench.experiment import Evaluation, Verdict
from bench.experiments import _ins_frames_cost as cost
from bench.experiments._ins_frames_figures import figures
from bench.experiments._ins_frames_tables import tables
from bench.experiments._ins_frames_trials import (
    CONVENTIONAL,
    DUAL,
    IMPROVED_FIRST,
    MEASURES,
    POLYNOMIAL,
    ROUNDING,
    Algorithm,
    Options,
    postponed,
)
from bench.experiments._ins_frames_verdicts import (
    ATTITUDE,
    VELOCITY,
    Results,
    judge_all,
    judge_cost,
    not_the_conditions,
)
from bench.experiments._judging import tally, withhold
from bench.table import Table


def evaluate(options: Options, seed: int, rows: Table) -> Evaluation:
    """Turn the errors into verdicts, tables and figures; count operations and measure times."""
    results = Results(options, rows)
    counts, timed = cost.operations(), cost.timings(options)
    verdicts = {**withhold(judge_all(results), not_the_conditions(options)), **judge_cost(counts)}
    return Evaluation(
        verdicts, tables(results, counts, timed), figures(results, counts, timed), summary(results, verdicts)
    )


def summary(results: Results, verdicts: dict[str, Verdict]) -> str:
    """Return the finding in one paragraph."""
    every = max(results.options.postponed)

    def largest(algorithm: Algorithm, measure: str, swing: bool) -> str:
        return f"{results.largest(algorithm, measure, swing=swing):.3g}"

    apart = [
        max(results.largest(name, measure, swing=swing, part="difference") for swing in (False, True))
        for name in ("dual quaternion against improved", ROUNDING)
        for measure in MEASURES
    ]
    return (
        f"{tally(verdicts)} With attitude motion the frame makes no difference: compensated at every update, the "
        f"conventional attitude errs by at most {largest(CONVENTIONAL, ATTITUDE, True)} arcsec, the dual quaternion by "
        f"{largest(DUAL, ATTITUDE, True)}, at every speed. Postponed to every {every}th update it errs by "
        f"{largest(postponed(every), ATTITUDE, True)} arcsec. Without attitude motion it is "
        f"{largest(CONVENTIONAL, ATTITUDE, False)} against {largest(DUAL, ATTITUDE, False)} arcsec. "
        f"**With the exact rotation compensation the improved algorithm is the dual quaternion**: they are at most "
        f"{apart[0]:.1g} arcsec, {apart[1]:.1g} m/s and {apart[2]:.1g} m apart, the dual quaternion from itself in "
        f"turned body axes {apart[3]:.1g}, {apart[4]:.1g} and {apart[5]:.1g}; as printed, the improved algorithm errs "
        f"in velocity by {largest(IMPROVED_FIRST, VELOCITY, True)} m/s instead of {largest(DUAL, VELOCITY, True)}. "
        f"What is left is due to the two-sample rotation vector: integrated exactly, the same increments give "
        f"{largest(POLYNOMIAL, ATTITUDE, True)} arcsec and {largest(POLYNOMIAL, VELOCITY, True)} m/s."
    )
