"""External damping of a ship's INS by two filters and their fusion: the claims of Zhao, Li and Cheng, judged.

A free INS works on MuJoCo's increments with the stated sensor errors; its errors are estimated from a reference
velocity that is off by a constant. What the paper leaves open (latitude, duration, correlation times, signs, noise, the
mean in the fusion) is scanned with the error model, and the reading that meets the printed tables best is named.
"""

from bench.experiment import Claim, Condition, Experiment
from bench.experiments._damping_evaluation import evaluate
from bench.experiments._damping_parts import items, measure
from bench.experiments._damping_published import FAMILIES, TABLES
from bench.experiments._damping_recording import record
from bench.experiments._damping_scan import BOTH_TABLES
from bench.experiments._damping_trials import FILTERS, Options
from bench.experiments._damping_undamped import PERIODS
from bench.references import ZHAO

CONDITIONS = (
    Condition("motion", "at rest to 1000 s, accelerating for 100 s, then 10 m/s east and 8 m/s north", "stated"),
    Condition("sensors", "gyro drift 0.005 deg/h, accelerometer bias 5e-5 g, constant", "stated"),
    Condition(
        "initial errors",
        "2 arcsec in latitude and longitude, 0.1 m/s east and north, pitch and roll 0.7 arcmin, heading 7.7 arcmin",
        "stated",
    ),
    Condition("reference velocity", "truth + constant C + white noise; C = -0.1 to -0.5 m/s east and north", "stated"),
    Condition("signs of errors and biases", "scanned; those of the best reading", "assumed", "not stated"),
    Condition("start latitude", "scanned; 52 deg N, that of the best reading", "assumed", "not stated"),
    Condition(
        "duration", "24 h; times at which tables may have been read are scanned from 8 h on", "assumed", "not stated"
    ),
    Condition(
        "noise of the sensor errors in the filters",
        "first-order Markov processes, 2 sigma^2/tau; tau is scanned; 3600 s, that of the best reading",
        "assumed",
        "Q is printed as 2 sigma^2, whose unit is not that of a density: 1/tau is missing, and tau is not stated",
    ),
    Condition("noise of the reference", "0.05 m/s, that of R1; 0 is scanned too", "assumed", "not stated"),
    Condition(
        "R2",
        "(0.001 m/s^2)^2, or 2 (0.001 m/s)^2/T^2",
        "assumed",
        "printed in (m/s)^2, but the measurement is an acceleration",
    ),
    Condition("interval T of filter 2", "5 s", "stated"),
    Condition("rate of filter 1", "1 Hz", "assumed", "not stated"),
    Condition("P0", "squares of the initial errors and of the sensors' constants", "assumed", "not stated"),
    Condition(
        "mean in the fusion (Xbar)",
        "since the start, over 1 h or 4 h: scanned; 4 h, that of the best reading",
        "assumed",
        '"the mean"',
    ),
    Condition("fusion", "a = 5e-4 1/s, t0 = 2.5 h, tm = 4 h", "stated"),
    Condition(
        "columns of the tables",
        "latitude, longitude, phi_E, phi_N, phi_U, v_E, v_N; angles in arcmin",
        "assumed",
        "the heads are lost; the attitudes are read as phi and as -phi, in arcmin and in deg: scanned",
    ),
    Condition("attitude of the ship", "level, bow north", "assumed", "not stated; sway is an option"),
    Condition("Earth", "sphere of 6371 km", "assumed", "a sphere is stated, its radius is not"),
    Condition("INS", "navigation frame, two samples at 100 Hz, height held, free-running", "assumed", "not stated"),
    Condition("steady-state error", "mean of the last 1.5 h, alike for all filters", "assumed", "not defined"),
    Condition(
        "convergence time",
        "from when on the error stays near its steady state: within 10 %, and within 1 %, of the largest error of the "
        "undamped INS",
        "assumed",
        "not defined; alike for all filters",
    ),
    Condition("undamped INS", "at rest at the start latitude, 96 h", "assumed", "long enough for 24 h and Foucault"),
)

CLAIMS = (
    Claim(
        "1 filter 1 diverges",
        "with a constant error of the reference, position and attitude errors of filter 1 grow with time",
        "section 3.2, figures 3 and 4",
        "holds if the steady-state error exceeds that at half time by more than a tenth, in latitude, longitude and "
        "the three angles",
    ),
    Claim(
        "1 in proportion",
        "the steady-state errors of filter 1 grow with the constant error",
        "section 3.2, table 2",
        "holds if what C adds to the error, per m/s, is the same for every C to 10 %, in every column",
    ),
    Claim(
        "2 filter 2 does not see it",
        "the velocity change as measurement shields filter 2 from a constant error",
        "sections 1 and 3.2",
        "holds if what C adds to the steady-state error is less than a tenth of what it adds to filter 1's, "
        "in every column",
    ),
    Claim(
        "2 settles after 12 h",
        "the Earth-rate oscillation of filter 2 converges only after about 12 h",
        "section 3.2",
        "holds if the longest convergence time of a column is 10 to 14 h, by either band",
    ),
    Claim(
        "3 faster than filter 2",
        "the Earth-rate oscillation converges markedly faster after the fusion than with filter 2",
        "abstract, section 3.2",
        "holds if no column converges later than with filter 2, and one earlier, by either band",
    ),
    Claim(
        "3 more accurate than filter 1",
        "the fusion is more accurate than filter 1 in steady state",
        "abstract, section 3.2",
        "holds if its steady-state error is smaller in every column, at C = -0.3 m/s",
    ),
    Claim(
        "3 velocity compensated",
        "the constant error of the reference is effectively compensated in the fusion's velocity",
        "section 3.2, figure 5",
        "holds if less than half of C is left in the steady state",
    ),
    Claim(
        "4 for every C",
        "the steady-state errors of the fusion stay small and are clearly better than those of filter 1",
        "section 3.2, tables 1 and 2",
        "holds if they are smaller in every column for every C",
    ),
    Claim(
        "4 no trend with C",
        "the steady-state errors of the fusion show no clear trend with C",
        "section 3.2, table 1",
        "holds if they change from the smallest to the largest C by less than a third of what those of filter 1 do",
    ),
    Claim(
        "5 fifteen states",
        "one filter with the reference's error as two more states is better than the fusion (not in the paper: what "
        "one would do today)",
        "-",
        "holds if its rms errors of the last 1.5 h are smaller in position and velocity, at C = -0.3 m/s",
    ),
    Claim(
        "5 fifteen states, over trials",
        "the same over trials, with errors drawn as the filters believe them",
        "-",
        "holds if its rms errors over the trials are smaller in position and velocity at their end, at C = -0.3 m/s",
    ),
    Claim(
        "6 credibility of filter 1",
        "with a constant error the covariance of filter 1 loses its credibility with time",
        "section 2, before eq. (8)",
        "holds if NEES over the trials grows and ends above its 95 % bound",
    ),
    *(
        Claim(
            f"7 consistent, {name}",
            "the diagonal of the covariance characterises the accuracy of the estimate",
            "section 2, after eq. (5)",
            "errors and reference drawn as the filter believes them; holds if 80 % of the hourly means of NEES (and "
            "NIS, where there is an innovation) are within their 95 % chi-square bounds",
        )
        for name in FILTERS
    ),
    *(
        Claim(
            f"8 period, {name}",
            {"Schuler": "2 pi sqrt(R/g)", "Foucault": "2 pi/(omega sinL)", "24 h": "2 pi/omega"}[name],
            "theory (the paper: 'system oscillations')",
            "least squares on the undamped INS; holds if within 1 %",
        )
        for name in PERIODS
    ),
    *(
        Claim(
            f"{table}, {family}",
            f"five rows of {table}, columns of {family}",
            table,
            "holds if one reading of the unstated conditions gives all numbers within 10 % of their column's largest",
        )
        for table in TABLES
        for family in FAMILIES
    ),
    Claim(
        BOTH_TABLES,
        "70 numbers",
        "tables 1 and 2",
        "holds if one reading of the unstated conditions gives all of them within 10 % of their column's largest",
    ),
)

EXPERIMENT = Experiment(
    name="damping-external-velocity",
    title="External velocity damping of a ship's INS: two serial filters, their fusion, and 15 states",
    source=ZHAO.at("section 3, tables 1 and 2, figures 3 to 5"),
    conditions=CONDITIONS,
    claims=CLAIMS,
    options=Options,
    items=items,
    measure=measure,
    evaluate=evaluate,
    record=record,
)
