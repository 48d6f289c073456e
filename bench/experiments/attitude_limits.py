"""Which attitude integrator at which rate: every solver over relative coning frequency and half angle.

The map uses exact increments in closed form; three streams go through the MuJoCo rig at 100 Hz.
"""

from bench.experiment import Claim, Condition, Experiment
from bench.experiments._attitude_limits_trials import LOST, STREAMS, Options, items, measure
from bench.experiments._attitude_limits_verdicts import BOUNDS, evaluate
from bench.references import WU_YAN

CONDITIONS = (
    Condition("motion", "coning, quaternion [cos a/2, sin a/2 sin wt, sin a/2 cos wt, 0]", "stated"),
    Condition("increments of the map", "exact, closed form", "stated"),
    Condition("streams", "; ".join(stream.name for stream in STREAMS) + ", at 100 Hz, through the rig", "stated"),
    Condition(
        "increments left over",
        "a stream ends with the last whole update",
        "assumed",
        "the number of increments is not a multiple of every N",
    ),
    Condition("error", "largest rotation-vector error at the updates", "assumed", "no update is left out"),
    Condition(
        "lost",
        f"error above {LOST:g} rad: no drift is fitted",
        "assumed",
        "the rotation vector is ambiguous from pi on",
    ),
)

CLAIMS = (
    *(
        Claim(
            bound.key,
            f"{STREAMS[bound.stream].name} at 100 Hz: {bound.statement}",
            bound.place,
            f"holds if the largest error is at most {bound.limit:g} rad",
        )
        for bound in BOUNDS
    ),
    Claim(
        "forms agree",
        "quaternion, Rodrigues vector and rotation vector give the same attitude for the same fit: the fit limits the "
        "accuracy, not the integration",
        "comparison of QuatFIter and RodFIter",
        "holds if, wherever all three give a result, their errors differ by less than 1 % of the error or 1e-13 rad",
    ),
    Claim(
        "Rodrigues converges below pi",
        "the iteration of the Rodrigues vector converges if the body turns by less than pi in an update",
        "convergence of RodFIter; sharply at pi",
        "holds if every cell of the map with S = sum |dtheta| < pi is served and every other one refused; does not "
        "hold if one from pi on is served; cannot be judged if one below pi is refused: the series end at degree 64",
    ),
    Claim(
        "quaternion converges",
        "the iteration of the quaternion converges for every rate",
        "convergence of QuatFIter",
        "holds if no cell of the map is refused; otherwise cannot be judged: the solver's series end at degree 64",
    ),
)

EXPERIMENT = Experiment(
    name="attitude-limits",
    title="Which attitude integrator at which rate",
    source=WU_YAN,
    conditions=CONDITIONS,
    claims=CLAIMS,
    options=Options,
    items=items,
    measure=measure,
    evaluate=evaluate,
)
