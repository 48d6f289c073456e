"""A large-angle manoeuvre, ideal and quantised: section 4.2 of Xu et al., against a truth that is good enough.

The paper takes a one-sample solution at 1 MHz as truth; how good that is, is
measured here against the attitude solved to rounding.
"""

from bench.experiment import Claim, Condition, Experiment
from bench.experiments._attitude_manoeuvre_trials import Options, items, measure
from bench.experiments._attitude_manoeuvre_verdicts import evaluate
from bench.experiments._attitude_recording import record_manoeuvre
from bench.experiments._attitude_trials import READINGS
from bench.references import XU

CONDITIONS = (
    Condition("motion", "Eq. 15: integrated body rate, up to 685 deg/s, from rest of all angles", "stated"),
    Condition("duration", "1.2 s", "stated"),
    Condition("sampling rate", "1 kHz", "stated"),
    Condition("initial attitude", "identity, known to the algorithms", "assumed", "not stated"),
    Condition(
        "truth",
        "attitude solved to rounding",
        "assumed",
        "the paper's, a one-sample quaternion at 1 MHz, is measured against it",
    ),
    Condition("quantum", "1 arcsec", "stated"),
    Condition("quantiser", "pulse counter: the residue is carried", "assumed", "not stated"),
    Condition("phase of the quantiser", "random on each axis; all results over many", "assumed", "not stated"),
    Condition(
        "rotation vector",
        "Eq. 4 (57/80, 33/80), coning-optimised (27/20, 9/20), or Song (27/40, 18/40)",
        "assumed",
        "Eq. 4 is printed, reference 3 (Song et al.) is cited, and the optimised set is the common one: all are run",
    ),
    Condition("terms of the Taylor series", "10", "stated"),
    Condition(
        "error",
        "largest |estimate - truth| of each Euler angle over the run, wrapped",
        "assumed",
        "figure 4 shows curves; roll crosses 180 deg, the rotation error is reported too",
    ),
)
AS_READ = {
    "Eq. 4": "rotation vector with the printed coefficients",
    "optimised": "rotation vector with coning-optimised coefficients",
    "Song": "rotation vector with Song's coefficients",
}


def _claims(name: str) -> tuple[Claim, ...]:
    """Return the three statements of claim 8, for one reading of the rotation vector."""
    read = f"[{AS_READ[name]}] "
    return (
        Claim(
            f"8 ideal, {name}",
            "ideal, 3 samples: the two new algorithms are about 2 orders more accurate than the rotation vector",
            "section 4.2, figure 4",
            read + '"2 orders" is what rounds to 2: a factor of 10^1.5 to 10^2.5; holds if so for both algorithms and '
            "each angle",
        ),
        Claim(
            f"8 quantised, {name}",
            "quantised: the accuracy of the three is the same",
            "section 4.2, figure 4",
            read + "holds if the largest and the smallest of the three errors differ by less than 10 % in the median "
            "over the phases, for each angle",
        ),
        Claim(
            f"8 cost of quantisation, {name}",
            "ideal is 4 to 6 orders more accurate than quantised, for all three",
            "section 4.2, figure 4",
            read + "holds if the median quantised error is 10^3.5 to 10^6.5 times the ideal one for each algorithm and "
            "angle",
        ),
    )


def _all_claims() -> tuple[Claim, ...]:
    by_reading = [_claims(name) for name in READINGS]
    ordered = [claim for group in zip(*by_reading, strict=True) for claim in group]
    truth = Claim(
        "standard attitude",
        "the standard attitude is that of the one-sample quaternion at 1 MHz",
        "section 4.2",
        "holds if its error is at most a tenth of that of the new algorithms with three samples, which it judges",
    )
    return (*ordered, truth)


EXPERIMENT = Experiment(
    name="attitude-manoeuvre",
    title="Rotation vector, Taylor quaternion and Taylor DCM in a large-angle manoeuvre",
    source=XU.at("section 4.2, figure 4"),
    conditions=CONDITIONS,
    claims=_all_claims(),
    options=Options,
    items=items,
    measure=measure,
    evaluate=evaluate,
    record=record_manoeuvre,
)
