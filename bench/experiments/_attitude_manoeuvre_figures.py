"""The figures of `attitude-manoeuvre`: figure 4 rebuilt, ideal and quantised, and errors against samples per update."""

import numpy as np

from bench.experiments._attitude_manoeuvre_trials import Options, errors_in_time
from bench.experiments._attitude_trials import (
    ANGLES,
    DCM,
    FULL_QUATERNION,
    HYBRID,
    MEASURES,
    OPTIMISED,
    PRINTED,
    QUATERNION,
    SAMPLES,
    SONG,
    Errors,
)
from bench.figures import Figure, Line, Panel

SHOWN = 100  # phases of the band, at most
# Drawn in this order; curves that coincide stay visible.
LOOK = {QUATERNION: (0, "-"), DCM: (2, "--"), OPTIMISED: (4, "-"), SONG: (3, "-."), PRINTED: (1, ":")}


def figures(options: Options, seed: int, errors: Errors) -> list[Figure]:
    """Return all figures."""
    return [error_figure(options, seed), samples_figure(errors)]


def error_figure(options: Options, seed: int) -> Figure:
    """Return figure 4: errors in time, ideal (logarithmic) and quantised."""
    panels = []
    found = {algorithm: errors_in_time(options, seed, algorithm, 3, None) for algorithm in LOOK}
    for k in range(3):
        lines = [
            Line(a.label, t[1:], np.abs(error[1:, k]), colour, style)
            for (a, (t, error)), (colour, style) in zip(found.items(), LOOK.values(), strict=True)
        ]
        panels.append(Panel("t, s", f"|{ANGLES[k]} error|, arcsec", lines, f"{ANGLES[k]}, ideal", yscale="log"))
    one = {algorithm: errors_in_time(options, seed, algorithm, 3, 0) for algorithm in LOOK}
    phases = range(min(options.phases, SHOWN))
    many = np.array([errors_in_time(options, seed, QUATERNION, 3, phase)[1] for phase in phases])
    low, high = np.percentile(many, [5, 95], axis=0)
    for k in range(3):
        lines = [
            Line(
                a.label,
                t,
                error[:, k],
                colour,
                style,
                low=low[:, k] if a is QUATERNION else None,
                high=high[:, k] if a is QUATERNION else None,
            )
            for (a, (t, error)), (colour, style) in zip(one.items(), LOOK.values(), strict=True)
        ]
        panels.append(Panel("t, s", f"{ANGLES[k]} error, arcsec", lines, f"{ANGLES[k]}, quantised"))
    caption = (
        f"Figure 4 of the paper: three samples, {options.rate:g} Hz. Above: ideal increments. Below: increments "
        f"counted in pulses of 1 arcsec, one phase of the counter; band: 5 to 95 percent of {len(phases)} phases "
        "(Taylor quaternion). The five curves below coincide."
    )
    title = "Large-angle manoeuvre, three samples, ideal and quantised"
    return Figure("figure_4_errors", title, caption, panels, shared_legend=True)


def samples_figure(errors: Errors) -> Figure:
    """Return the largest rotation error against the number of samples, ideal and quantised."""
    place, panels = MEASURES.index("rotation"), []
    looks = [*((algorithm, *look) for algorithm, look in LOOK.items()), (FULL_QUATERNION, 6, "--"), (HYBRID, 5, "-")]
    for data in ("ideal", "quantised"):
        lines = []
        for algorithm, colour, style in looks:
            if data == "quantised" and not algorithm.quantised:
                continue
            # For fewer than five samples ten terms are enough.
            labels = [(QUATERNION if algorithm is FULL_QUATERNION and N < 5 else algorithm).label for N in SAMPLES]
            cells = [errors.cells[label, N, data][:, 0, place] for label, N in zip(labels, SAMPLES, strict=True)]
            low, middle, high = (np.array([np.percentile(c, p) for c in cells]) for p in (5, 50, 95))
            band = (low, high) if data == "quantised" else (None, None)
            x = np.arange(len(cells), dtype=float)
            lines.append(Line(algorithm.label, x, middle, colour, style, low=band[0], high=band[1]))
        ticks = [str(N) for N in SAMPLES]
        label = "largest rotation error, arcsec"
        panels.append(Panel("samples per update", label, lines, data, yscale="log", xticks=ticks))
    caption = (
        "Largest rotation error over the manoeuvre against the number of samples; quantised: median and 5 to 95 "
        "percent of the phases. Ten terms of the Taylor series are too few for 5 and 6 quantised samples."
    )
    title = "Large-angle manoeuvre, three to six samples"
    return Figure("samples", title, caption, panels, columns=2, shared_legend=True)
