"""Strapdown navigation in three frames: the claims of Wang et al. on attitude, velocity and cost, rebuilt and judged.

The conventional navigation-frame algorithm, the dual quaternion and the paper's improved inertial-frame algorithm
run on the same exact increments. The paper's own simulation is lost, so there are claims but no numbers: what its
statements leave open (how often the conventional code compensates the rotating n, which rotation compensation the
velocity increments get, whether the attitude moves) is run and judged in every reading.
"""

from bench.experiment import Claim, Condition, Experiment
from bench.experiments._ins_frames_cost import IN_E, IN_N
from bench.experiments._ins_frames_evaluation import evaluate
from bench.experiments._ins_frames_recording import record
from bench.experiments._ins_frames_trials import FLOORS, Options, items, measure
from bench.experiments._ins_frames_verdicts import ALIKE
from bench.references import WANG

CONDITIONS = (
    Condition("frames", "n is east-north-up; e agrees with i at the start", "stated"),
    Condition(
        "conventional algorithm",
        "q_nb by the rotation vector, compensated for the rotation of n; velocity in n with the correction for "
        "gravity, Coriolis and transport rate",
        "stated",
    ),
    Condition(
        "compensation of the rotating n",
        "at every update, or at every 2nd, 10th, 50th and 100th",
        "assumed",
        '"after several attitude updates": the number is not given, and decides',
    ),
    Condition(
        "rotation compensation of the velocity increments",
        "first-order (1/2 dtheta x dv) or exact, for conventional and improved alike",
        "assumed",
        "the improved algorithm is printed with the first-order one, the dual quaternion contains the exact one",
    ),
    Condition(
        "position",
        "from the velocity by a double integral with scrolling, alike in all; in i but for the conventional algorithm",
        "assumed",
        "the paper integrates the turn of n in i; this way the position is not what limits an algorithm",
    ),
    Condition("gravitational velocity", "depends on the position only, not on velocity", "stated"),
    Condition(
        "where corrections are taken",
        "half-way through the update: at its mean displacement (conventional) or at half its time (the others)",
        "assumed",
        "the paper speaks of the previous time; with values of that time every algorithm would be first order",
    ),
    Condition("Earth", "WGS-84, point mass and J2, in truth and algorithms", "assumed", "constants are not given"),
    Condition("speeds", "300, 3000, 7000 m/s", "assumed", "the simulation of the paper is lost"),
    Condition(
        "path", "from 45 deg N, 126 deg E, 20 km high, level, to the north-east", "assumed", "the simulation is lost"
    ),
    Condition(
        "attitude motion",
        "none, or yaw, pitch and roll of 10 deg at 1 Hz, a third of a turn apart in phase",
        "assumed",
        "the simulation is lost; in phase there would be hardly any coning",
    ),
    Condition(
        "manoeuvres",
        "none, a weave (50, 30, 20 m in 20, 16, 12 s east, north, up: half a g), or 20 times that",
        "assumed",
        "the simulation is lost; in the hard one velocity changes by 200 to 300 m/s within seconds",
    ),
    Condition("duration, rate, samples", "100 s, 100 Hz, 2 increments per update", "assumed", "the simulation is lost"),
    Condition("increments", "exact integrals of MuJoCo's sensors", "assumed", "so that the algorithms alone err"),
    Condition("initial state", "true", "assumed", "not stated"),
    Condition(
        "error",
        "largest length of the error vector over the flight; attitude in e, without any part of the position error",
        "assumed",
        "not stated",
    ),
)
SWINGS = {"no swing": "without attitude motion", "swing": "with attitude motion"}
ROUNDED = "Errors below {:g} arcsec, {:g} m/s, {:g} m count as that: rounding does as much".format(*FLOORS.values())
BETTER = f'"more accurate" is a factor of more than {ALIKE:g}, which a figure would show'


def _attitude_claims(words: str) -> list[Claim]:
    readings = {"every update": "n compensated at every update", "postponed": "n compensated at every k-th update"}
    return [
        Claim(
            f"1 attitude, {key}, {words}",
            "attitude in the inertial frame, by dual quaternion or rotation vector, is more accurate than in the "
            "navigation frame, since nothing has to be compensated for the rotation of n",
            "sections 2.1 and 3",
            f"[{reading}, {SWINGS[words]}] {BETTER}; holds if so for both new algorithms in every flight (and k). "
            f"{ROUNDED}, and flights with nothing else do not count",
        )
        for key, reading in readings.items()
    ] + [
        Claim(
            f"2 speed, {key}, {words}",
            "at high speed the error of the conventional attitude grows: the advantage of the inertial frame shows "
            "when the vehicle moves fast",
            "sections 2.1 and 3",
            f"[{reading}, {SWINGS[words]}] holds if the ratio of the conventional to the new attitude error grows from "
            f"each speed to the next by a factor of more than {ALIKE:g}, for both new algorithms (and every k), in "
            f"level flight. {ROUNDED}",
        )
        for key, reading in readings.items()
    ]


def _equality_claims(words: str) -> list[Claim]:
    readings = {"as printed": "first-order rotation compensation", "exact": "exact rotation compensation"}
    return [
        Claim(
            f"3 equal, {key}, {words}",
            "the accuracy of the improved algorithm is approximately that of the dual quaternion",
            "abstract, section 4",
            f"[{reading}, {SWINGS[words]}] holds if the errors of attitude, velocity and position are alike to a "
            f"factor of {ALIKE:g}, which a figure would not show, in every flight. {ROUNDED}",
        )
        for key, reading in readings.items()
    ]


def _change_claims(words: str) -> list[Claim]:
    readings = {
        "first-order": "first-order rotation compensation in both",
        "exact": "exact rotation compensation in both, and the dual quaternion",
    }
    return [
        Claim(
            f"4 fast changes, {key}, {words}",
            "gravitational velocity depends on position only, and is more accurate than the conventional correction "
            "when velocity changes fast",
            "sections 2.2 and 3",
            f"[{reading}, {SWINGS[words]}] {BETTER} of the velocity errors; holds if so in the hard weave at every "
            f"speed. {ROUNDED}",
        )
        for key, reading in readings.items()
    ]


def _cost_claims() -> list[Claim]:
    frames = {IN_E: "results in e, as all solvers here give them", IN_N: "latitude, longitude, height and results in n"}
    rotations = {"first-order": "first-order rotation compensation", "exact": "exact rotation compensation"}
    rule = (
        "all operations of an update of two increments, as executed; holds if the power of 2 nearest to their ratio is"
    )
    claims = []
    for frame, shown in frames.items():
        claims += [
            Claim(
                f"5 improved as conventional, {key}, {frame}",
                "the improved algorithm costs what the conventional one does",
                "abstract, section 3",
                f"[{rotation} in both; {shown}] {rule} 1",
            )
            for key, rotation in rotations.items()
        ]
        claims += [
            Claim(
                f"5 dual quaternion twice, {key}, {frame}",
                "the dual quaternion costs twice as much as the improved algorithm",
                "section 3",
                f"[improved algorithm with {rotation}; {shown}] {rule} 2",
            )
            for key, rotation in rotations.items()
        ]
    return claims


def _all_claims() -> tuple[Claim, ...]:
    by_swing = [[*_attitude_claims(w), *_equality_claims(w), *_change_claims(w)] for w in SWINGS]
    together = sorted((claim for claims in by_swing for claim in claims), key=lambda claim: claim.key[0])
    return (*together, *_cost_claims())


EXPERIMENT = Experiment(
    name="ins-frames",
    title="Strapdown navigation in the navigation frame, by dual quaternion and in the inertial frame",
    source=WANG,
    conditions=CONDITIONS,
    claims=_all_claims(),
    options=Options,
    items=items,
    measure=measure,
    evaluate=evaluate,
    record=record,
)
