"""Dual Euler against the quaternion in pure inertial navigation on the driven table, as distributions.

Tables 2 to 4 of Lyu et al., section 3.3, of which two percentages survive. Which quaternion algorithm was compared is
not stated: one that is integrated properly and normalised, and one of first order that is not, are both run, over many
draws of the sensor errors.
"""

from bench.experiment import Claim, Condition, Experiment
from bench.experiments._dual_euler_judging import SHARES
from bench.experiments._dual_euler_navigation_evaluation import PUBLISHED, VISIBLE, evaluate
from bench.experiments._dual_euler_navigation_trials import Options, measure
from bench.experiments._dual_euler_runs import table_items
from bench.experiments.dual_euler_turntable import CONDITIONS as TABLE
from bench.references import LYU

CONDITIONS = (
    *(condition for condition in TABLE if condition.name not in ("error", "attitude")),
    Condition("navigation", "pure inertial, height held", "assumed", "east and north errors are tabled, no height"),
    Condition("times", "500, 1000, 1500, 2000, 2500 s", "assumed", "500 and 2500 s are stated"),
    Condition(
        "velocity and position of dual Euler",
        "those of the quaternion algorithm it is compared with, `navigation-frame`",
        "assumed",
        "so that the attitude algorithm is all that differs",
    ),
    Condition(
        "quaternion method",
        "`navigation-frame`: rotation vector, normalised; or `first-order-quaternion`, never normalised, velocity "
        "increments resolved with the attitude at the start or at the end of an update",
        "assumed",
        'stated is only that the matrix "must be orthogonalised"; all readings are run',
    ),
)

_BASELINES = {
    "normalised": "against the normalised quaternion",
    "first-order": "against the first-order quaternion, never normalised",
}
_ADMITTED = (
    "a reading admits the number if it lies between the 2.5 and the 97.5 percentile of the trials; holds if at least "
    "one admits it, does not hold if none does"
)

CLAIMS = (
    *(
        claim
        for key, against in _BASELINES.items()
        for claim in (
            Claim(
                f"4 smaller, {key}",
                "east, north and total position errors of dual Euler are all smaller than those of the quaternion",
                "section 3.3, tables 2 to 4",
                f"[{against}] true where all of them, at the five times, are smaller by more than {VISIBLE:g} % (half "
                f"the last printed digit); {SHARES}, in every reading",
            ),
            *(
                Claim(
                    f"4 {printed:g} % at {when:g} s, {key}",
                    f"position error smaller by {printed:g} % at {when:g} s",
                    "section 3.3, table 4",
                    f"[{against}] {_ADMITTED}",
                )
                for when, printed in PUBLISHED.items()
            ),
            Claim(
                f"4 both numbers, {key}",
                "both reductions in one run",
                "section 3.3, table 4",
                f"[{against}] holds if in some reading at least 5 % of the trials are as far from the median, in units "
                "of the spread at either time, as the two numbers together",
            ),
            Claim(
                f"4 grows, {key}",
                "the advantage of dual Euler grows with time",
                "section 3.3",
                f"[{against}] true where the reduction of the position error at 2500 s is larger than at 500 s by more "
                f"than {VISIBLE:g} %; {SHARES}, in every reading",
            ),
        )
    ),
    Claim(
        "4 normalisation accumulates error",
        "the quaternion must be normalised, an approximation whose error accumulates; dual Euler has no such error",
        "section 3.3",
        "holds if the normalised quaternion's position error with ideal sensors exceeds 1 % of the median with the "
        "stated IMU at 2500 s",
    ),
)

EXPERIMENT = Experiment(
    name="dual-euler-navigation",
    title="Dual Euler against the quaternion in pure inertial navigation",
    source=LYU.at("section 3.3, tables 2 to 4"),
    conditions=CONDITIONS,
    claims=CLAIMS,
    options=Options,
    items=table_items,
    measure=measure,
    evaluate=evaluate,
)
