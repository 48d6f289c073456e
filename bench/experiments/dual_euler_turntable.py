"""Dual Euler on a driven three-axis table: MuJoCo's dynamics make the motion, the rig senses it, an INS solves it.

The half-physical test of Lyu et al., section 3.2. The stated rate of 0.015 deg/s does not reach the poles within the
stated time, which the paper's figures show; the table is driven at this rate, and at one that reaches them.
"""

from bench.experiment import Claim, Condition, Experiment
from bench.experiments._dual_euler_angle_trials import measure
from bench.experiments._dual_euler_judging import SHARES, SMOOTH, TURNED_OVER
from bench.experiments._dual_euler_recording import record
from bench.experiments._dual_euler_runs import RATES, TableOptions, table_items
from bench.experiments._dual_euler_turntable_evaluation import BOUND, FOLLOWS, SMALL, STABLE, evaluate
from bench.references import LYU

CONDITIONS = (
    Condition("table", "outer axis heading, middle pitch, inner roll; outer and inner one still", "stated"),
    Condition("motion of the middle axis", "at rest, then at a constant rate to and fro between +-90 deg", "stated"),
    Condition("rate", "0.015 deg/s", "stated"),
    Condition(
        "rate that reaches the poles",
        "0.15 deg/s",
        "assumed",
        "at the stated one the table turns by 36 deg in the time left; the figures show a pitch near +-90 deg",
    ),
    Condition("time at rest", "100 s", "assumed", '"first at rest for a while"'),
    Condition(
        "fluctuations of the rate",
        "0.001 deg/s RMS between 0.02 and 0.5 Hz",
        "assumed",
        '"small fluctuations from manual operation", without a number',
    ),
    Condition("accuracy of the table", "0.0005 deg/s, 0.0001 deg", "stated"),
    Condition(
        "inertias, friction, servos",
        "those of the model: Coulomb and viscous friction, servos of about 8 Hz",
        "assumed",
        "not stated; the motion that MuJoCo's dynamics make of the commands is the truth",
    ),
    Condition("duration, attitude period", "2500 s, 0.01 s", "stated"),
    Condition("sensors", "gyro 0.025 deg/h, 0.01 deg/sqrt(h); accelerometer 0.1 mg, 0.05 mg/sqrt(Hz)", "stated"),
    Condition("constants of the sensors", "normal, one draw a trial", "assumed", "the paper shows one run"),
    Condition("place", "118.8 deg E, 32.06 deg N, WGS-84", "assumed", "stated for the simulation"),
    Condition("attitude", "by pure inertial navigation, height held", "assumed", "gyros and accelerometers are used"),
    Condition("initial state", "true", "assumed", "not stated"),
    Condition("borders, hysteresis", "|P| = 45 and 135 deg, 5 deg", "assumed", "the hysteresis is not stated"),
    Condition("error", "in the set that is active for the truth", "assumed", "as for the simulation"),
)

_DRIVEN = tuple(f"{rate:g} deg/s" for rate in RATES)


def _claims_at(driven: str) -> tuple[Claim, ...]:
    return (
        Claim(
            f"3 pitch error, {driven}",
            f"pitch error of dual Euler within +-{BOUND:g} arcmin",
            "section 3.2, figure 16",
            f"[{driven}] {SHARES}",
        ),
        Claim(
            f"3 stays stable, {driven}",
            "the pitch error stays stable",
            "section 3.2",
            f"[{driven}] holds if its RMS over the trials in the last fifth is at most {STABLE:g} times that in the "
            "third: half-way between an error that stays and one that grows with time",
        ),
        Claim(
            f"3 follows fluctuations, {driven}",
            "the attitude follows the small fluctuations of the table's rate",
            "section 3.2",
            f"[{driven}] true where the pitch error fluctuates by less than {100 * FOLLOWS:g} % of what the pitch "
            f"does, RMS about a straight line over 25 s, median over the motion; {SHARES}",
        ),
        Claim(
            f"3 no jump at the poles, {driven}",
            "near +-90 deg the pitch is put out normally and does not jump to +-180 deg",
            "section 3.2, figure 15",
            f"[{driven}] true where no step of an active angle between two outputs differs by {SMOOTH:g} deg from the "
            f"true one, and no angle is {TURNED_OVER:g} deg off; {SHARES}; needs a table within 1 deg of a pole",
        ),
        Claim(
            f"3 flag follows pitch, {driven}",
            "the changes of the flag agree with the pitch",
            "section 3.2, figure 17",
            f"[{driven}] true where the flag changes, is -1 above |P| = 50 deg and 1 below 40 deg, and changes once a "
            f"passage; {SHARES}",
        ),
    )


CLAIMS = (
    Claim(
        "3 reaches +-90 deg",
        "0.015 deg/s for at most 2500 s, periodically between +-90 deg",
        "section 3.2",
        "holds if the driven table reaches both limits within a degree",
    ),
    *(claim for driven in _DRIVEN for claim in _claims_at(driven)),
    Claim(
        "3 table is exact",
        "what the table puts out can be taken for an attitude without error",
        "section 3.2",
        f"holds if its angle accuracy of 0.0001 deg is below {100 * SMALL:g} % of the median largest pitch error",
    ),
)

EXPERIMENT = Experiment(
    name="dual-euler-turntable",
    title="Dual Euler on a driven three-axis turntable",
    source=LYU.at("section 3.2, figures 15 to 17"),
    conditions=CONDITIONS,
    claims=CLAIMS,
    options=TableOptions,
    items=table_items,
    measure=measure,
    evaluate=evaluate,
    record=record,
)
