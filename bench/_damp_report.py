"""What a damped recording shows beside the free solution: tables, figures, and what is said of it; arrays only."""

import numpy as np

from bench._damping_states import SHOWN
from bench.damp import Damped
from bench.figures import Figure, Line, Panel
from bench.table import Column, Table

SINCE = "time since the start, s"
TRUE, ESTIMATED = 6, 0  # colours of lines
POINTS = 2000  # of a line
HIGH = -2.0 * float(np.log(0.01))  # 99 % of chi-square of 2 degrees, which is exponential


def filter_table(damped: Damped) -> Table:
    """Return external velocity, estimated errors, standard deviations and innovations at every step of the filter."""
    made = damped.estimate
    columns: dict[str, Column] = {"t_s": made.t}
    columns |= {f"v_ref_{name}_m_per_s": damped.v_ref[:, k] for k, name in enumerate(("east", "north"))}
    states = list(zip(SHOWN, made.x.T, made.sigma.T, strict=False))
    columns |= {shown.column: x for shown, x, _ in states}
    columns |= {f"sigma_{shown.column}": sigma for shown, _, sigma in states}
    for name, stage in damped.stages.items():
        key, unit = name.replace("-", "_"), "m_per_s2" if name == "velocity-change" else "m_per_s"
        columns |= {f"innovation_{k}_{key}_{unit}": stage.innovation[:, i] for i, k in enumerate("EN")}
        columns |= {f"nis_{key}": stage.nis, f"used_{key}": stage.used}
    if made.gamma is not None and made.weight is not None:
        columns["gamma"] = made.gamma
        weights = zip(made.states, made.weight.T, strict=True)
        columns |= {f"share_of_velocity_error_in_{name}": weight for name, weight in weights}
    return Table(columns, "Estimated errors, INS minus truth; v_ref and innovations are NaN where there is none")


def consistency_table(damped: Damped) -> Table:
    """Return how many measurements each stage took and left out, and whether its innovations are as it claims."""
    rows = []
    for name, stage in damped.stages.items():
        nis = stage.nis[np.isfinite(stage.nis)]
        mean, share = (float(nis.mean()), float((nis <= HIGH).mean())) if len(nis) else (np.nan, np.nan)
        rows.append((name, len(nis), damped.rejected(stage), mean, share))
    names = ("filter", "measurements", "rejected", "mean NIS", "share within 99 %")
    return Table.from_rows(names, rows, "Innovations; consistent are a mean NIS of 2 and a share of 0.99")


def damping_figures(damped: Damped) -> list[Figure]:
    """Return estimated errors with their bands, and innovations with the weights of the fusion."""
    return [_errors(damped), _innovations(damped)]


def _errors(damped: Damped) -> Figure:
    made, judged = damped.estimate, damped.comparison
    start, thin = made.t[0], _thin(len(made))
    panels = []
    for k, shown in enumerate(SHOWN[: made.x.shape[1]]):
        x, band = made.x[thin, k] / shown.scale, 3 * made.sigma[thin, k] / shown.scale
        lines = [Line("estimated, 3 sigma", made.t[thin] - start, x, ESTIMATED, low=x - band, high=x + band)]
        if judged is not None and damped.true_errors is not None and k < damped.true_errors.shape[1]:
            rows = _thin(len(judged.reference))
            true = damped.true_errors[rows, k] / shown.scale
            lines.append(Line("against the reference", judged.reference.t[rows] - start, true, TRUE))
        panels.append(Panel(SINCE, shown.title, lines))
    caption = "Errors of the free solution as the filter estimates them, with its claimed 3 sigma; INS minus truth."
    return Figure("estimated_errors", "Estimated errors", caption, panels, shared_legend=True)


def _innovations(damped: Damped) -> Figure:
    start, panels = damped.estimate.t[0], []
    for name, stage in damped.stages.items():
        rows = np.flatnonzero(np.isfinite(stage.nis))
        rows = rows[_thin(len(rows))]
        t = stage.t[rows] - start
        lines = [Line("", t, stage.nis[rows], ESTIMATED, "."), Line("99 %", t, np.full(len(t), HIGH), TRUE)]
        panels.append(Panel(SINCE, f"NIS of {name}", lines, yscale="log"))
    if damped.estimate.gamma is not None:
        panels.append(Panel(SINCE, "gamma", [Line("", damped.estimate.t - start, damped.estimate.gamma)]))
    caption = (
        "Innovations squared, normalised by the covariance that the filter expects (NIS); of a consistent filter 99 of "
        "100 are below the line."
    )
    return Figure("innovations", "Innovations", caption, panels)


def _thin(n: int) -> slice:
    return slice(None, None, max(1, -(-n // POINTS)))


def damped_sentence(damped: Damped) -> str:
    """Return what was damped and what was not."""
    aiding, steps = damped.aiding, len(damped.ins)
    text = f" `{damped.filter.name}` damped it with {len(aiding)} rows of velocity from {aiding.source}, which has "
    text += f"{aiding.gaps or 'no'} gap{'' if aiding.gaps == 1 else 's'} longer than {aiding.longest_gap:g} s: "
    text += f"a velocity was available at {damped.with_reference} of {steps} steps."
    if rejected := sum(damped.rejected(stage) for stage in damped.stages.values()):
        text += f" {rejected} measurements did not pass the gate."
    return text
