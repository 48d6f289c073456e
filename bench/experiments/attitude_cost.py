"""What an attitude update costs: table 1 of Xu et al. beside operations counted on running kernels, and times.

The operations are counted by running the kernels of the solvers, and the formulas of the paper as they are
printed, on numbers that count what is done to them. Times are measured in the same run and judged by nobody.
"""

from bench.experiment import Claim, Condition, Experiment
from bench.experiments._attitude_cost_counts import FORMULAS, Options, items, measure
from bench.experiments._attitude_cost_verdicts import PRINTED, SHOWN, evaluate
from bench.references import XU

CONDITIONS = (
    Condition("increments per update", "3", "stated"),
    Condition("Taylor series", "10 terms", "stated"),
    Condition("what is counted", "from the increments to the attitude matrix", "stated"),
    Condition(
        "formulas counted",
        "eq. 4, the product of quaternions as 4 x 4 matrix times column, and the matrix element by element; eqs 5 to 9 "
        "and 10 to 13 as dense transition matrices, with the products in the right order and the binomials as printed",
        "assumed",
        "the derivations are in the paper's references 10 and 11; this reading gives the printed multiplications",
    ),
    Condition(
        "data",
        "coning, 5 degrees, 2 Hz, 100 Hz, seen from skew axes",
        "assumed",
        "decides branches and numbers of iterations only; skew axes leave no zeros to multiply by",
    ),
)
FORMULA_RULE = (
    "holds if the printed formulas, run on counting numbers, need exactly the printed operations; does not hold if not"
)
CLAIMS = (
    *(
        Claim(
            f"{name} operations",
            ", ".join(f"{getattr(PRINTED[name], kind)} {kind}" for kind in SHOWN if getattr(PRINTED[name], kind)),
            "section 4.3, table 1",
            FORMULA_RULE,
        )
        for name in FORMULAS
    ),
    Claim(
        "rotation vector cheapest",
        "with the same number of samples, the rotation vector needs the fewest operations",
        "section 4.3, after table 1",
        "holds if its total is the least of the three, in the printed formulas and in the recursion",
    ),
    Claim(
        "DCM preferred",
        "in operations the DCM algorithm is better than the quaternion algorithm",
        "section 4.3, after table 1",
        "holds if the DCM needs fewer multiplications and fewer operations than the quaternion to the attitude matrix, "
        "both by the recursion of the same series (3 increments, 10 terms, matrix not orthonormalised)",
    ),
)

EXPERIMENT = Experiment(
    name="attitude-cost",
    title="What an attitude update costs: operations counted, and nanoseconds",
    source=XU.at("section 4.3, table 1"),
    conditions=CONDITIONS,
    claims=CLAIMS,
    options=Options,
    items=items,
    measure=measure,
    evaluate=evaluate,
)
