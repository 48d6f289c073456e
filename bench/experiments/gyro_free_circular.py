"""Nine against six accelerometers on a circular path: section 2 of Qin, Xu and Li, as distributions.

The paper prints one run and leaves conditions open that change the result by factors
of ten. Every reading of the conditions is therefore run as a Monte Carlo over bias
signs and noise, and each printed number is placed in each distribution.
"""

from bench.experiment import Claim, Condition, Experiment
from bench.experiments._gyro_free_published import PUBLISHED, ROWS
from bench.experiments._gyro_free_recording import record
from bench.experiments._gyro_free_trials import Options, items, measure
from bench.experiments._gyro_free_verdicts import evaluate
from bench.references import QIN

CONDITIONS = (
    Condition("path", "circle, radius 10 m, in the xy plane, anticlockwise", "stated"),
    Condition("start on the path", "(10, 0, 0) m", "assumed", "not stated; only shifts the path"),
    Condition(
        "motion on the path",
        "angular acceleration 0.01 rad/s^2, from rest",
        "assumed",
        'printed as a "rotation rate of 0.01 rad/s^2": the unit is stated, rest at the start is assumed; '
        "option `circle` has the other reading",
    ),
    Condition("body rate", "(2, 2, 2) rad/s, constant", "stated"),
    Condition("initial attitude", "identity", "assumed", "not stated"),
    Condition("initial state of the solvers", "true attitude, rate, velocity and position", "assumed", "not stated"),
    Condition("arm length l", "0.1 m", "stated"),
    Condition("six-accelerometer cube", "same l, sign p = +1", "assumed", "cited by the paper, without geometry"),
    Condition("accelerometer bias", "1.5e-5 m/s^2", "stated"),
    Condition("signs of the biases", "random, each + or -", "assumed", "not stated; all drawn in the Monte Carlo"),
    Condition(
        "accelerometer noise",
        "2e-10 (m/s^2)^2, per sample or per hertz",
        "assumed",
        'printed as "power spectral density (variance)" of band-limited white noise: both readings are run; '
        "at 100 Hz they differ by a factor 100 in variance",
    ),
    Condition("integration rule", "fourth order, or first order", "assumed", "not stated: both readings are run"),
    Condition(
        "gravity",
        "9.80665 m/s^2, known to the solvers, or absent",
        "assumed",
        "left out of the paper's formulas: both readings are run",
    ),
    Condition("duration and step", "60 s, 0.01 s", "stated"),
    Condition(
        "attitude error",
        "per-axis integral of the rate error in b, or rotation vector in n",
        "assumed",
        "not defined in the paper: both are reported",
    ),
)

REACH = (
    "all signs of the biases are enumerated without noise, and the distance to the nearest result must be within the "
    "97.5 percentile of what noise alone adds (Hotelling's T^2 from 60 trials without bias)"
)
WITHIN = (
    "a reading of the conditions admits the printed number if it lies between the 2.5 and the 97.5 percentile of the "
    "trials and within reach: " + REACH + "; holds if at least one reading admits it, does not hold if none does"
)
TOGETHER = (
    "a reading of the conditions admits the printed numbers as those of one run if they are together within reach: "
    + REACH
    + "; holds if at least one reading admits them, does not hold if none does"
)
STATEMENT = (
    "holds if true in every reading of the conditions, does not hold if true in none; otherwise it cannot be judged, "
    "because it hangs on a condition that is not stated"
)

CLAIMS = (
    *(Claim(number.key, f"{number.value:g} {number.unit}", number.place, WITHIN) for number in PUBLISHED),
    *(
        Claim(name, ", ".join(f"{n.value:g}" for n in numbers) + f" {numbers[0].unit}", numbers[0].place, TOGETHER)
        for name, numbers in ROWS.items()
    ),
    Claim(
        "improvement arithmetic",
        "96.82, 97.02, 96.69 % (attitude), 89.95, 87.84 % (position)",
        "tables 1 and 2, third row",
        "holds if 1 - |nine/six| of the printed errors gives the printed digits",
    ),
    Claim(
        "attitude better by 95 %",
        "nine accelerometers improve the attitude at 60 s by more than 95 %",
        "section 2, conclusion 1",
        "true where 1 - rms(nine)/rms(six) over the trials exceeds 0.95 on every axis; " + STATEMENT,
    ),
    Claim(
        "position better by 85 %",
        "nine accelerometers improve the position at 60 s by more than 85 %",
        "section 2, conclusion 1",
        "true where 1 - rms(nine)/rms(six) over the trials exceeds 0.85 in x and y; " + STATEMENT,
    ),
    Claim(
        "advantage grows with time",
        "the advantage of nine accelerometers becomes more obvious with time",
        "section 2, conclusion 1",
        "true where rms(six)/rms(nine) is larger at the end than at one third and at two thirds of the run, in "
        "attitude and in position; " + STATEMENT,
    ),
    Claim(
        "less smooth",
        "the attitude error of nine accelerometers is less smooth than that of six",
        "section 2, conclusion 2",
        "true where the rms second difference of the attitude error is larger with nine in 95 % of the trials; "
        + STATEMENT,
    ),
    Claim(
        "both diverge",
        "the errors of both diverge with time, at different speed",
        "section 2, conclusion 3",
        "true where the rms attitude and position errors of both at the end exceed those at half time; " + STATEMENT,
    ),
    Claim(
        "differences remove bias",
        "taking differences removes the constant drift of the accelerometers from the linear acceleration",
        "section 1, after eq. (6)",
        "holds if the solver's specific force is free of constant biases for every combination of their signs",
    ),
    Claim(
        "no division by zero",
        "squared rates, angular and linear accelerations follow linearly; nothing is divided by a rate",
        "section 1, after eq. (6)",
        "holds if the solution stays finite, and its squares linear in the readings, at zero rate",
    ),
)

EXPERIMENT = Experiment(
    name="gyro-free-circular",
    title="Nine against six accelerometers without gyros, on a circular path",
    source=QIN.at("section 2, tables 1 and 2, figures 3 and 4"),
    conditions=CONDITIONS,
    claims=CLAIMS,
    options=Options,
    items=items,
    measure=measure,
    evaluate=evaluate,
    record=record,
)
