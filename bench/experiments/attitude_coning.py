"""Coning at 100 Hz to 10 kHz, ideal and quantised: section 4.1 of Xu et al., for every reading of "rotation vector".

The paper prints one set of coefficients of the rotation vector and cites another;
which of them is meant decides half of its statements. Every statement is judged
for each, quantised ones over many phases of the quantiser.
"""

from bench.experiment import Claim, Condition, Experiment
from bench.experiments._attitude_coning_trials import Options, items, measure
from bench.experiments._attitude_coning_verdicts import evaluate
from bench.experiments._attitude_judging import FLOOR
from bench.experiments._attitude_recording import record_coning
from bench.experiments._attitude_trials import READINGS
from bench.references import XU

CONDITIONS = (
    Condition("motion", "coning, half angle 5 deg, 4 pi rad/s", "stated"),
    Condition("duration", "60 s", "stated"),
    Condition("sampling rate", "100 Hz to 10 kHz", "stated"),
    Condition("rates run", "13 from 100 Hz to 10 kHz, 210 Hz among them", "assumed", "not listed in the paper"),
    Condition("increments", "exact integrals of MuJoCo's gyro", "assumed", '"ideal" is not defined'),
    Condition("quantum", "1 arcsec", "stated"),
    Condition(
        "quantiser",
        "pulse counter: the residue is carried",
        "assumed",
        "not stated; rounding each increment by itself misreads the slow axis by thousands of arcsec",
    ),
    Condition(
        "phase of the quantiser",
        "random on each axis; all results over many",
        "assumed",
        "not stated; it decides the yaw error of a single run",
    ),
    Condition(
        "rotation vector",
        "Eq. 4 (57/80, 33/80), coning-optimised (27/20, 9/20), or Song (27/40, 18/40)",
        "assumed",
        "Eq. 4 is printed, reference 3 (Song et al.) is cited, and the optimised set is the common one: all are run",
    ),
    Condition("terms of the Taylor series", "10", "stated", "for three samples"),
    Condition(
        "terms with 4 to 6 samples",
        "10, or as many as suffice (10, 20, 30)",
        "assumed",
        "not stated: both are run where it matters",
    ),
    Condition(
        "Taylor DCM",
        "C' = C [omega x], all derivatives of omega, not made orthonormal",
        "assumed",
        "equations 11 and 13 as printed have the factors in the wrong order and lack factorials",
    ),
    Condition("initial attitude", "true", "assumed", "not stated"),
    Condition(
        "error",
        "largest |estimate - truth| of each Euler angle over the run, at the updates",
        "assumed",
        "the ordinates of the figures are not defined",
    ),
)

ORDERS = (
    '"2 orders" is what rounds to 2: a factor of 10^1.5 to 10^2.5. Holds if so at most of the rates, for both new '
    f"algorithms and each angle; rates at which an error is at rounding ({FLOOR:g} arcsec) do not count"
)
PHASES = (
    "holds if so in 95 % of the phases of the quantiser for each curve, does not hold if in 5 % or less for one; "
    "otherwise it hangs on the phase, which is not stated"
)
AS_READ = {
    "Eq. 4": "rotation vector with the printed coefficients",
    "optimised": "rotation vector with coning-optimised coefficients",
    "Song": "rotation vector with Song's coefficients",
}


def _claims(name: str) -> tuple[Claim, ...]:
    """Return the claims that involve the rotation vector, for one reading of it."""
    read = f"[{AS_READ[name]}] "
    return (
        Claim(
            f"1 pitch and roll, {name}",
            "ideal, 3 samples: pitch and roll errors of the new algorithms are 2 orders smaller than the rotation "
            "vector's",
            "section 4.1.1, figure 1",
            read + ORDERS,
        ),
        Claim(
            f"2 yaw, {name}",
            "ideal, 3 samples: yaw errors of the new algorithms are 2 orders larger than the rotation vector's",
            "section 4.1.1, figure 1",
            read + ORDERS,
        ),
        Claim(
            f"3 better with rate, {name}",
            "ideal: the accuracy of all three improves with the sampling rate",
            "section 4.1.1, figure 1",
            read + "holds if every error falls from each rate to the next, until it is at rounding",
        ),
        Claim(
            f"4 quantised: pitch and roll agree, {name}",
            "quantised: the three differ little in pitch and roll",
            "section 4.1.2, figure 2",
            read + "holds if the median errors of the three are within half an order of each other at every rate",
        ),
        Claim(
            f"4 quantised: yaw at 100 to 210 Hz, {name}",
            "quantised, 100 to 210 Hz: the rotation vector's yaw is the more accurate",
            "section 4.1.2, figure 2",
            read + "true of a phase where its yaw error is the smallest of the three; " + PHASES,
        ),
        Claim(
            f"5 cost of quantisation, {name}",
            "without quantisation all three are 4 to 5 orders more accurate",
            "section 4.1.2",
            read + "true where the median quantised error is 10^3.5 to 10^5.5 times the ideal one; holds if so at most "
            "of the rates for each algorithm and angle",
        ),
        Claim(
            f"5 quantised: no gain with rate, {name}",
            "quantised: accuracy no longer improves with the sampling rate",
            "section 4.1.2, figure 2",
            read + "true of a phase where an error falls by less than half an order from the lowest rate to the "
            "highest; " + PHASES,
        ),
        Claim(
            f"6 degrades with samples, {name}",
            "ideal: the accuracy of the rotation vector falls step by step from 3 to 6 samples",
            "section 4.1.3, figure 3",
            read + "true where each error grows from 3 to 4, 4 to 5 and 5 to 6 samples; holds if so at most of the "
            "rates for each angle",
        ),
        Claim(
            f"7 better than the rotation vector, {name}",
            "ideal, below 1 kHz, more samples: the new algorithms are better than the rotation vector",
            "section 4.1.3, figure 3",
            read + "true where their errors with 6 samples are smaller; holds if so at most of the rates below 1 kHz "
            "for each angle",
        ),
    )


def _samples_claim(terms: str) -> Claim:
    return Claim(
        f"7 more samples, {terms}",
        "ideal, below 1 kHz: with more samples the new algorithms improve clearly",
        "section 4.1.3, figure 3",
        f"[Taylor series with {terms}] true where the errors with 6 samples are smaller than with 3 by half an order "
        "or more; holds if so at most of the rates below 1 kHz for both algorithms and each angle",
    )


def _all_claims() -> tuple[Claim, ...]:
    by_reading = [_claims(name) for name in READINGS]
    ordered = [claim for group in zip(*by_reading, strict=True) for claim in group]
    return (*ordered, _samples_claim("ten terms"), _samples_claim("enough terms"))


EXPERIMENT = Experiment(
    name="attitude-coning",
    title="Rotation vector, Taylor quaternion and Taylor DCM on coning, ideal and quantised",
    source=XU.at("section 4.1, figures 1 to 3"),
    conditions=CONDITIONS,
    claims=_all_claims(),
    options=Options,
    items=items,
    measure=measure,
    evaluate=evaluate,
    record=record_coning,
)
