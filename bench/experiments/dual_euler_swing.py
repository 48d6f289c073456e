"""Dual Euler simulated: the pitch swings between both poles, with ideal sensors and with the stated ones.

The simulation of Lyu et al., section 3.1. The table of its sensors is lost: the claims are judged with ideal sensors
and with those of the paper's turntable test, in an INS and with gyros alone.
"""

from bench.experiment import Claim, Condition, Experiment
from bench.experiments._dual_euler_angle_trials import DUAL_ALONE, DUAL_INS, measure
from bench.experiments._dual_euler_judging import SHARES, SMOOTH, TURNED_OVER
from bench.experiments._dual_euler_recording import record
from bench.experiments._dual_euler_swing_evaluation import BOUNDS, Options, evaluate, items
from bench.references import LYU

CONDITIONS = (
    Condition("place", "118.8 deg E, 32.06 deg N", "stated"),
    Condition("attitude", "heading and roll 0, pitch 90 deg sin(2 pi t/256 s)", "stated"),
    Condition("duration, attitude period", "2500 s, 0.01 s", "stated"),
    Condition(
        "increments per update", "1, exact integrals of MuJoCo's sensors at 100 Hz", "assumed", "period as above"
    ),
    Condition(
        "sensors",
        "none of errors; and gyro 0.025 deg/h, 0.01 deg/sqrt(h), accelerometer 0.1 mg, 0.05 mg/sqrt(Hz)",
        "assumed",
        "the table is lost; these are the sensors of the turntable test",
    ),
    Condition("constants of the sensors", "normal, one draw a trial", "assumed", "the paper shows one run"),
    Condition(
        "where n is",
        "by pure inertial navigation, height held; or known, for gyros alone",
        "assumed",
        "not stated for the simulation: both are run. Gyros alone integrate against the axes that n has at the start, "
        "and the turn of n since then follows from time and place without error",
    ),
    Condition("initial state", "true", "assumed", "not stated"),
    Condition("Earth", "WGS-84, point mass and J2", "assumed", "not stated"),
    Condition("borders", "|P| = 45 and 135 deg", "stated"),
    Condition("hysteresis", "5 deg", "assumed", "not stated"),
    Condition(
        "error",
        "in the set that is active for the truth, against the truth in the same set",
        "assumed",
        "near a pole an attitude error of 1 arcmin is thousands of arcmin of forward heading and roll",
    ),
)

_SENSORS = {"ideal": "ideal sensors", "IMU": "the stated IMU"}
_READINGS = {
    "ideal": f"ideal sensors; {DUAL_INS} and {DUAL_ALONE}",
    "IMU, INS": "the stated IMU, pure inertial navigation",
    "IMU, gyros alone": "the stated IMU, place known",
}

_LOST = "never refuted, because the table of the simulation's sensors is lost and better ones may have been meant"

CLAIMS = (
    *(
        Claim(
            f"1 quaternion jumps, {key}",
            "heading and roll put out by the quaternion method jump near P = +-90 deg",
            "section 3.1, figures 4 to 6",
            f"[{sensors}] true where the forward heading and roll taken from the quaternion are both more than "
            f"{TURNED_OVER:g} deg off at some time; {SHARES}",
        )
        for key, sensors in _SENSORS.items()
    ),
    Claim(
        "1 quaternion is singular",
        "at P = 90 deg the quaternion method can update the matrix only, and not put out angles",
        "sections 0 and 3.1",
        "holds if the errors of the quaternion method, in the active set, exceed those of dual Euler by more than "
        "10 %, with the stated IMU",
    ),
    *(
        Claim(
            f"2 no jumps, {key}",
            "dual Euler puts out heading, pitch and roll without a jump, near +-90 deg too",
            "section 3.1, figures 7 to 9",
            f"[{sensors}] true where no step of an active angle between two outputs differs by {SMOOTH:g} deg from the "
            f"true one, and no angle is {TURNED_OVER:g} deg off; {SHARES}",
        )
        for key, sensors in _SENSORS.items()
    ),
    *(
        Claim(
            f"2 {name} error, {key}",
            f"{name} error of dual Euler below {bound:g} arcmin over 2500 s",
            "section 3.1, figures 10 to 12",
            f"[{reading}] {SHARES}" + ("" if key == "ideal" else f"; {_LOST}"),
        )
        for name, bound in BOUNDS.items()
        for key, reading in _READINGS.items()
    ),
    *(
        Claim(
            f"2 {name} error grows",
            f"the {name} error of dual Euler grows slowly with time",
            "section 3.1",
            "[the stated IMU, INS] holds if the RMS over the trials in the last fifth is more than 1.1 times that in "
            "the third",
        )
        for name in ("heading", "roll")
    ),
    Claim(
        "2 pitch error swings",
        "the pitch error goes up and down because of the periodic swing",
        "section 3.1",
        "[the stated IMU, INS] true where the swing's frequency and its double carry more than half of the pitch "
        f"error's variance about a parabola in time; {SHARES}",
    ),
    *(
        Claim(
            f"2 flag follows pitch, {key}",
            "flag 1 while the forward angles are updated and -1 while the reverse ones are",
            "section 3.1, figure 13",
            f"[{sensors}] true where the flag is -1 above |P| = 50 deg and 1 below 40 deg, and changes once a passage; "
            f"{SHARES}",
        )
        for key, sensors in _SENSORS.items()
    ),
)

EXPERIMENT = Experiment(
    name="dual-euler-swing",
    title="Dual Euler and quaternion while the pitch swings between both poles",
    source=LYU.at("section 3.1, figures 4 to 13"),
    conditions=CONDITIONS,
    claims=CLAIMS,
    options=Options,
    items=items,
    measure=measure,
    evaluate=evaluate,
    record=record,
)
