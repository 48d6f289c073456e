"""The figures of `dual-euler-swing` and `dual-euler-turntable`: figures 4 to 13 and 15 to 17 of the paper rebuilt."""

from collections.abc import Mapping, Sequence

import numpy as np

from bench.errors import Array
from bench.experiments._dual_euler_angle_trials import DUAL_ALONE, DUAL_INS, QUATERNION_INS
from bench.experiments._dual_euler_angles import NAMES
from bench.figures import Figure, Line, Panel
from bench.table import Table

TRUE, QUATERNION, DUAL, OTHER, GREY = 7, 1, 0, 2, 6  # colours
ONE = "Trial 0 with the stated IMU, pure inertial navigation"


def swing_figures(rows: Table, bounds: Mapping[str, float]) -> list[Figure]:
    """Return the figures of the swing."""
    tried = rows.where(part="series", trial=0)
    quaternion, dual = (tried.where(algorithm=name) for name in (QUATERNION_INS, DUAL_INS))
    return [
        output_figure(
            "figures_4_to_6",
            "Figures 4 to 6: the quaternion method, forward angles",
            f"{ONE}. Heading and roll taken from the quaternion as usual turn over near the poles. Of every 0.2 s the "
            "attitude is drawn whose heading is farthest off.",
            quaternion,
            "plain",
            QUATERNION,
        ),
        output_figure(
            "figures_7_to_9",
            "Figures 7 to 9: dual Euler, angles of the active set",
            f"{ONE}. Heading and roll are zero in truth, in both sets. Mind the scale of heading and roll.",
            dual,
            "output",
            DUAL,
        ),
        error_figure(
            rows,
            "figures_10_to_12",
            "Figures 10 to 12: errors of dual Euler",
            {"INS": (DUAL_INS, DUAL), "gyros alone, place known": (DUAL_ALONE, OTHER)},
            bounds,
        ),
        flag_figure("figure_13", "Figure 13: flag", [("", dual)]),
        sets_figure(dual),
    ]


def turntable_figures(rows: Table, bound: float) -> list[Figure]:
    """Return the figures of the driven table."""
    cases = [(case, rows.where(part="series", trial=0, case=case)) for case in dict.fromkeys(rows["case"].tolist())]
    duals = [(case, own.where(algorithm=DUAL_INS)) for case, own in cases]
    panels = []
    for case, own in duals:
        t = own["t_s"]
        lines = [
            Line("true (MuJoCo's joint)", t, own["true_pitch_deg"], TRUE),
            Line("dual Euler", t, own["output_pitch_deg"], DUAL, "--"),
        ]
        panels.append(Panel("t, s", "pitch, deg", lines, case))
    shown = Figure(
        "figure_15",
        "Figure 15: pitch of the driven table",
        f"{ONE}. At 0.015 deg/s the table is 36 degrees from where it started when the test ends.",
        panels,
        columns=2,
    )
    errors = []
    for case, own in duals:
        lines = [*_band(rows.where(case=case), DUAL_INS, "pitch", DUAL, "dual Euler, trial 0")]
        lines += _bounds(own["t_s"], bound)
        errors.append(Panel("t, s", "pitch error, arcmin", lines, case))
    caption = "Pitch error in the active set. Band: 2.5 to 97.5 percent of the trials; dotted: the printed bound."
    jumps = []
    for case, own in cases:
        plain = own.where(algorithm=QUATERNION_INS)
        lines = [
            Line("quaternion, forward", plain["t_s"], plain["plain_heading_deg"], QUATERNION),
            Line("dual Euler, active", *_pair(own.where(algorithm=DUAL_INS), "output_heading_deg"), DUAL),
        ]
        jumps.append(Panel("t, s", "heading, deg", lines, case))
    jump_caption = f"{ONE}. The heading of the table, which is zero, as the forward and as the active set show it."
    return [
        shown,
        Figure("figure_16", "Figure 16: pitch error", caption, errors, columns=2),
        flag_figure("figure_17", "Figure 17: flag", duals),
        Figure("heading", "Heading of the driven table", jump_caption, jumps, columns=2),
    ]


def output_figure(name: str, title: str, caption: str, own: Table, kind: str, colour: int) -> Figure:
    """Return heading, pitch and roll as put out, beside the true ones."""
    panels = []
    for angle in NAMES:
        lines = [
            Line("true", *_pair(own, f"true_{angle}_deg"), TRUE),
            Line("put out", *_pair(own, f"{kind}_{angle}_deg"), colour, "--" if angle == "pitch" else "-"),
        ]
        panels.append(Panel("t, s", f"{angle}, deg", lines))
    return Figure(name, title, caption, panels)


def _pair(own: Table, column: str) -> tuple[Array, Array]:
    return own["t_s"], own[column]


def _band(rows: Table, algorithm: str, angle: str, colour: int, label: str) -> Sequence[Line]:
    """Return where 95 % of the trials lie, and the error of trial 0."""
    tried = rows.where(part="trial", algorithm=algorithm)
    t = np.unique(tried["t_s"])
    low, high = np.percentile(tried[f"{angle}_arcmin"].reshape(-1, len(t)), [2.5, 97.5], axis=0)
    own = rows.where(part="series", trial=0, algorithm=algorithm)
    band = Line("", t, np.full_like(t, np.nan), colour, low=low, high=high)
    return band, Line(label, *_pair(own, f"{angle}_arcmin"), colour)


def _bounds(t: Array, bound: float) -> list[Line]:
    ends = t[[0, -1]]
    return [Line("", ends, np.full(2, sign * bound), GREY, ":") for sign in (-1, 1)]


def error_figure(
    rows: Table, name: str, title: str, shown: Mapping[str, tuple[str, int]], bounds: Mapping[str, float]
) -> Figure:
    """Return the errors of heading, pitch and roll in the active set."""
    panels = []
    for angle in NAMES:
        lines = [line for label, (who, colour) in shown.items() for line in _band(rows, who, angle, colour, label)]
        lines += _bounds(rows.where(part="series")["t_s"], bounds[angle])
        panels.append(Panel("t, s", f"{angle} error, arcmin", lines))
    caption = (
        "Errors in the active set with the stated IMU. Lines: trial 0; bands: 2.5 to 97.5 percent of the trials; "
        "dotted: printed bounds."
    )
    return Figure(name, title, caption, panels)


def flag_figure(name: str, title: str, cases: Sequence[tuple[str, Table]]) -> Figure:
    """Return the flag below the pitch."""
    panels = [
        Panel("t, s", "pitch, deg", [Line("", *_pair(own, "true_pitch_deg"), TRUE)], case) for case, own in cases
    ] + [Panel("t, s", "flag", [Line("", *_pair(own, "flag"), DUAL)]) for _, own in cases]
    caption = f"{ONE}. Flag 1: forward angles are integrated; -1: reverse angles."
    return Figure(name, title, caption, panels, columns=max(1, len(cases)))


def sets_figure(own: Table) -> Figure:
    """Return both sets of angles near a pole, where one of them is smooth."""
    t = own["t_s"]
    middle = t[int(np.abs(own["plain_heading_deg"]).argmax())]
    near = Table({name: column[np.abs(t - middle) < 8.0] for name, column in own.columns.items()})
    panels = []
    for angle in NAMES:
        lines = [
            Line("forward, plain", *_pair(near, f"plain_{angle}_deg"), QUATERNION, "x"),
            Line("forward, continued", *_pair(near, f"forward_{angle}_deg"), OTHER),
            Line("reverse", *_pair(near, f"reverse_{angle}_deg"), DUAL),
        ]
        panels.append(Panel("t, s", f"{angle}, deg", lines))
    caption = (
        f"{ONE}: seconds round a passage of the pole. The same attitude in both sets: the forward heading and roll "
        "turn, or turn over, while the reverse angles hardly move."
    )
    return Figure("both_sets", "The same attitude in both sets", caption, panels)
