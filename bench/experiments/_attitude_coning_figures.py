"""The figures of `attitude-coning`: figures 1, 2 and 3 rebuilt, with slopes, and the best that is attainable."""

import itertools

import numpy as np

from bench.errors import Array
from bench.experiments._attitude_coning_trials import Options
from bench.experiments._attitude_judging import FLOOR, slope
from bench.experiments._attitude_trials import (
    ANGLES,
    BEST,
    DCM,
    FULL_QUATERNION,
    HYBRID,
    ITERATION,
    OPTIMISED,
    PRINTED,
    QUATERNION,
    SAMPLES,
    SONG,
    WINDOW,
    Algorithm,
    Errors,
)
from bench.figures import Figure, Line, Panel

COLOUR = {PRINTED: 1, OPTIMISED: 4, SONG: 3, QUATERNION: 0, DCM: 2, HYBRID: 5, ITERATION: 6, WINDOW: 2}
STYLE = {DCM: "--", SONG: "-.", PRINTED: ":", WINDOW: "--"}
DRAWN = (QUATERNION, DCM, OPTIMISED, SONG, PRINTED)  # in this order, so that curves that coincide stay visible
RATE_LABEL = "sampling rate, Hz"


def figures(options: Options, errors: Errors) -> list[Figure]:
    """Return all figures."""
    return [ideal_figure(errors), quantised_figure(options, errors), samples_figure(errors), best_figure(errors)]


def _error(errors: Errors, algorithm: Algorithm, samples: int, angle: int) -> Array:
    """Return the ideal errors of one angle; ten terms stand for enough where they are."""
    if algorithm is FULL_QUATERNION and samples not in algorithm.samples:
        algorithm = QUATERNION
    return errors.middle(algorithm, samples, "ideal")[:, angle]


def _slope(rates: Array, error: Array) -> str:
    found = slope(rates, error)
    return "-" if np.isnan(found) else f"{found:.1f}"


def _until_rounding(rates: Array, error: Array) -> tuple[Array, Array]:
    """Return the curve up to its first point at rounding."""
    below = np.flatnonzero(error < FLOOR)
    end = int(below[0]) + 1 if len(below) else len(error)
    return rates[:end], error[:end]


def _line(errors: Errors, algorithm: Algorithm, angle: int) -> Line:
    """Return an ideal error curve of three samples with its slope."""
    found = _error(errors, algorithm, 3, angle)
    look = COLOUR[algorithm], STYLE.get(algorithm, "-")
    return Line(algorithm.label, *_until_rounding(errors.rates, found), *look, note=_slope(errors.rates, found))


def _panel(lines: list[Line], angle: int, title: str) -> Panel:
    label = f"largest {ANGLES[angle]} error, arcsec"
    return Panel(RATE_LABEL, label, lines, title, xscale="log", yscale="log")


def ideal_figure(errors: Errors) -> Figure:
    """Return figure 1: three samples, ideal increments."""
    panels = [_panel([_line(errors, a, k) for a in DRAWN], k, ANGLES[k]) for k in range(3)]
    caption = (
        "Figure 1 of the paper: three samples, ideal increments. Numbers: fitted slope of each curve. Curves end where "
        "rounding is reached. In yaw the rotation vector with the printed coefficients lies under the Taylor curves; "
        "with the coning-optimised sums (which Song's set has too) it is about two orders better."
    )
    title = "Three samples, ideal increments: coning, half angle 5 deg, 2 Hz"
    return Figure("figure_1_ideal", title, caption, panels, shared_legend=True)


def quantised_figure(options: Options, errors: Errors) -> Figure:
    """Return figure 2: three samples, increments quantised to 1 arcsec."""
    panels = []
    for k in range(3):
        lines = []
        for algorithm in DRAWN:
            found = errors.phases(algorithm, 3, "quantised")[:, :, k]
            low, middle, high = np.percentile(found, [5, 50, 95], axis=0)
            band = (low, high) if algorithm in (QUATERNION, OPTIMISED) else (None, None)
            look = COLOUR[algorithm], STYLE.get(algorithm, "-")
            lines.append(Line(algorithm.label, errors.rates, middle, *look, low=band[0], high=band[1]))
        panels.append(_panel(lines, k, ANGLES[k]))
    caption = (
        f"Figure 2 of the paper: three samples, increments counted in pulses of 1 arcsec. Lines: median of "
        f"{options.phases} phases of the counter; bands: 5 to 95 percent of them (Taylor quaternion, and "
        "coning-optimised rotation vector)."
    )
    title = "Three samples, increments quantised to 1 arcsec: coning, half angle 5 deg, 2 Hz"
    return Figure("figure_2_quantised", title, caption, panels, shared_legend=True)


def samples_figure(errors: Errors) -> Figure:
    """Return figure 3: three to six samples, ideal increments."""
    panels = []
    for group in ((PRINTED, OPTIMISED, SONG), (QUATERNION, DCM, FULL_QUATERNION)):
        for k, algorithm in itertools.product((0, 2), group):
            found = [_error(errors, algorithm, N, k) for N in SAMPLES]
            lines = [
                Line(f"N = {N}", *_until_rounding(errors.rates, error), colour)
                for N, error, colour in zip(SAMPLES, found, (1, 4, 2, 0), strict=True)
            ]
            slopes = ", ".join(_slope(errors.rates, error) for error in found)
            panels.append(_panel(lines, k, f"{algorithm.label}: {ANGLES[k]}\nslopes {slopes}"))
    caption = (
        "Figure 3 of the paper: three to six samples, ideal increments, with fitted slopes in the same order; "
        "roll behaves as pitch and is left out. Ten "
        "terms of the Taylor series, as in the paper, are too few for 5 and 6 samples at low rates."
    )
    title = "Three to six samples, ideal increments"
    return Figure("figure_3_samples", title, caption, panels, shared_legend=True)


def best_figure(errors: Errors) -> Figure:
    """Return the best of the paper's algorithms against the best of the bench."""
    chosen = [(PRINTED, 3), (OPTIMISED, 3), (QUATERNION, 3), *((a, a.samples[-1]) for a in BEST)]
    panels = [
        _panel(
            [
                Line(f"{a.label}, N = {N}", errors.rates, _error(errors, a, N, k), COLOUR[a], STYLE.get(a, "-"))
                for a, N in chosen
            ],
            k,
            ANGLES[k],
        )
        for k in (0, 2)
    ]
    caption = (
        "What is attainable from the same increments: three samples as in the paper, and today's best solvers. The "
        "noise at 1e-9 arcsec is that of double precision; at 210 Hz that of the sampling times, which adds up."
    )
    title = "The paper's algorithms and the best ones, ideal increments"
    return Figure("best", title, caption, panels, columns=2, shared_legend=True)
