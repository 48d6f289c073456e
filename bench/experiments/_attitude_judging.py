"""How the attitude experiments judge statements about orders of magnitude: one rule for all curves of a figure."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array
from bench.experiment import Verdict

# arcsec (1e-13 rad): below it double precision shows, and not the algorithm. Not only in the arithmetic: a time of 60 s
# is known to 7e-15 s, and where the rate is no multiple of the coning's (210 Hz) such errors add up in the increments.
FLOOR = 2e-8
CERTAIN = 0.95  # of the phases of the quantiser
HALF = 0.5  # orders; what rounds to the printed number of orders, and what a reader sees in such a figure


@dataclass(frozen=True)
class Band:
    """What a value in orders of magnitude must be: at least `low`, less than `high`."""

    low: float = -np.inf
    high: float = np.inf

    def holds(self, value: Array) -> NDArray[np.bool_]:
        """Return which values are in the band."""
        return (value >= self.low) & (value < self.high)


def printed_orders(low: float, high: float | None = None) -> Band:
    """Return the band of what rounds to "low to high orders of magnitude"."""
    return Band(low - HALF, (low if high is None else high) + HALF)


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve of a comparison: an algorithm and an angle.

    Attributes
    ----------
    algorithm, angle : str
    value : ndarray, shape (n,)
        Orders of magnitude at each rate; NaN where rounding would decide.
    """

    algorithm: str
    angle: str
    value: Array


def orders(top: Array, bottom: Array, *, bound: bool = False) -> Array:
    """Return log10(top/bottom), NaN where one is below the floor; with `bound` only where the larger one is."""
    shown = np.maximum(top, bottom) if bound else np.minimum(top, bottom)
    floor = np.finfo(float).tiny
    return np.where(shown >= FLOOR, np.log10(np.maximum(top, floor) / np.maximum(bottom, floor)), np.nan)


def judge(curves: Sequence[Curve], band: Band, rates: Array, *, share: float = 0.5) -> Verdict:
    """Judge a statement about all curves: true where the value is in the band, at `share` of the rates at least.

    Parameters
    ----------
    curves : sequence of Curve
    band : Band
    rates : ndarray, shape (n,), Hz
    share : float
        1.0 demands every rate, 0.5 most of them.
    """
    measured = "; ".join(
        f"{angle} {spread([c.value for c in group])}"
        for angle, group in itertools.groupby(sorted(curves, key=lambda c: c.angle), key=lambda c: c.angle)
    )
    measured += " orders"
    passed = {(c.algorithm, c.angle): (band.holds(c.value), ~np.isnan(c.value)) for c in curves}
    if not all(judged.any() for _, judged in passed.values()):
        return Verdict("cannot be judged", measured, "rounding decides at every rate")
    shares = {key: float(true[judged].mean()) for key, (true, judged) in passed.items()}
    worst = min(shares, key=lambda key: shares[key])
    true, judged = passed[worst]
    holds = shares[worst] >= share
    if len(rates) == 1:
        failed: dict[str, list[str]] = {}
        for algorithm, angle in (key for key, value in shares.items() if value < 1):
            failed.setdefault(algorithm, []).append(angle)
        listed = "; ".join(f"{algorithm} ({', '.join(angles)})" for algorithm, angles in failed.items())
        reason = f"not for {listed}" if failed else "true for every algorithm and angle"
    else:
        reason = f"true at {(true & judged).sum()} of {judged.sum()} rates"
        if shares[worst] < 1:
            reason += f" for {worst[0]}, {worst[1]} (not at {_some(rates[judged & ~true])} Hz)"
    if judged.sum() < len(rates):
        reason += f"; at the other {len(rates) - judged.sum()} rounding decides"
    return Verdict("holds" if holds else "does not hold", measured, reason)


def judge_phases(curves: Sequence[Curve], band: Band) -> Verdict:
    """Judge a statement about quantised runs, of which the phase is not stated.

    Parameters
    ----------
    curves : sequence of Curve
        Their value (phases,) is that of every phase.
    band : Band
        Where the statement is true of a phase. It holds if it is in 95 % of the phases on every curve, and does not
        hold if in 5 % or less on one; in between it cannot be judged.
    """
    shares = [float(band.holds(curve.value).mean()) for curve in curves]
    groups: dict[str, list[float]] = {}
    for curve, share in zip(curves, shares, strict=True):
        groups.setdefault(curve.angle, []).append(100 * share)
    measured = "; ".join(
        f"{angle}: {min(found):.0f}" + (f" to {max(found):.0f}" if max(found) - min(found) >= 1 else "") + " %"
        for angle, found in groups.items()
    )
    worst = curves[int(np.argmin(shares))]
    low, middle, high = (_two_decimals(value) for value in np.percentile(worst.value, [5, 50, 95]))
    reason = f"{worst.algorithm}, {worst.angle}: median {middle} orders, {low} to {high} in 90 %"
    if min(shares) >= CERTAIN:
        return Verdict("holds", f"{measured} of the phases", reason)
    if min(shares) <= 1 - CERTAIN + 1e-12:
        return Verdict("does not hold", f"{measured} of the phases", reason)
    return Verdict("cannot be judged", f"{measured} of the phases", f"hangs on the phase of the quantiser; {reason}")


def _some(rates: Array) -> str:
    if len(rates) <= 4:
        return ", ".join(f"{rate:g}" for rate in rates)
    return f"{len(rates)} rates from {rates[0]:g} to {rates[-1]:g}"


def spread(values: Sequence[Array]) -> str:
    """Return the range of values in orders of magnitude, as text."""
    together = np.concatenate(values)
    together = together[~np.isnan(together)]
    if not len(together):
        return "at rounding"
    texts = [_two_decimals(value) for value in (together.min(), together.max())]
    return texts[0] if texts[0] == texts[1] else " to ".join(texts)


def _two_decimals(value: float) -> str:
    text = f"{value:.2f}"
    return text.removeprefix("-") if float(text) == 0 else text


def slope(rates: Array, error: Array) -> float:
    """Return the slope of log error against log rate where rounding does not show; NaN with fewer than 3 points."""
    shown = error > 5 * FLOOR
    if shown.sum() < 3:
        return float("nan")
    return float(np.polyfit(np.log10(rates[shown]), np.log10(error[shown]), 1)[0])
