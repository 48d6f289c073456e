"""The verdicts of `ins-frames`: attitude, speed, equality, fast changes of velocity, and cost."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bench.experiment import Verdict
from bench.experiments._ins_frames_cost import IN_E, IN_N, Counts
from bench.experiments._ins_frames_trials import (
    CONVENTIONAL,
    CONVENTIONAL_FIRST,
    DUAL,
    DURATION,
    FLOORS,
    HARSH,
    IMPROVED,
    IMPROVED_FIRST,
    MEASURES,
    NEW,
    RATE,
    SPEEDS,
    Algorithm,
    Flight,
    Options,
    flights,
    postponed,
)
from bench.table import Table

ATTITUDE, VELOCITY = MEASURES[:2]
ALIKE = 1.1  # a factor that a figure does not show
QUANTITIES = {measure: measure.split("_")[0] for measure in MEASURES}


@dataclass(frozen=True, eq=False)
class Results:
    """Largest errors by part, flight, algorithm and measure."""

    options: Options
    rows: Table

    @cached_property
    def _places(self) -> dict[tuple[str, str, str], int]:
        keys = zip(*(self.rows[name].tolist() for name in ("part", "flight", "algorithm")), strict=True)
        return {key: k for k, key in enumerate(keys) if key[0] not in ("rate", "samples")}

    def value(self, flight: Flight, algorithm: Algorithm | str, measure: str, part: str = "flight") -> float:
        """Return the largest error of an algorithm in a flight (or of a difference, by its name)."""
        label = algorithm.label if isinstance(algorithm, Algorithm) else algorithm
        return float(self.rows[measure][self._places[part, flight.label, label]])

    def flights(self, *, swing: bool, weave: int | None = None) -> list[Flight]:
        """Return the flights with or without attitude motion, in one manoeuvre or in all, in the order of speed."""
        found = [f for f in flights(self.options) if f.swing == swing and weave in (None, f.weave)]
        return sorted(found, key=lambda flight: (flight.weave, flight.speed))

    def largest(self, algorithm: Algorithm | str, measure: str, *, swing: bool, part: str = "flight") -> float:
        """Return the largest error of an algorithm over all flights with or without attitude motion."""
        return max(self.value(flight, algorithm, measure, part) for flight in self.flights(swing=swing))


def not_the_conditions(options: Options) -> str:
    """Return why a run cannot judge the paper, or nothing."""
    if set(options.speeds) != set(SPEEDS):
        return f"the speeds are {_listed(options.speeds)} m/s, claims are judged at {_listed(SPEEDS)}"
    if (options.duration, options.rate) != (DURATION, RATE):
        return f"{options.duration:g} s at {options.rate:g} Hz, claims are judged over {DURATION:g} s at {RATE:g} Hz"
    return ""


def _listed(values: Iterable[float]) -> str:
    return ", ".join(f"{value:g}" for value in sorted(values))


def spread(values: Sequence[float]) -> str:
    """Return the range of values as text."""
    texts = [f"{value:.3g}" for value in (min(values), max(values))]
    return texts[0] if texts[0] == texts[1] else " to ".join(texts)


def judge_all(results: Results) -> dict[str, Verdict]:
    """Return the verdicts on accuracy, by the key of the claim."""
    verdicts: dict[str, Verdict] = {}
    every = tuple(postponed(k) for k in results.options.postponed)
    for swing, words in ((False, "no swing"), (True, "swing")):
        verdicts |= {
            f"1 attitude, every update, {words}": judge_attitude(results, (CONVENTIONAL,), swing),
            f"1 attitude, postponed, {words}": judge_attitude(results, every, swing),
            f"2 speed, every update, {words}": judge_speed(results, (CONVENTIONAL,), swing),
            f"2 speed, postponed, {words}": judge_speed(results, every, swing),
            f"3 equal, as printed, {words}": judge_equality(results, IMPROVED_FIRST, swing),
            f"3 equal, exact, {words}": judge_equality(results, IMPROVED, swing),
            f"4 fast changes, first-order, {words}": judge_changes(
                results, CONVENTIONAL_FIRST, (IMPROVED_FIRST,), swing
            ),
            f"4 fast changes, exact, {words}": judge_changes(results, CONVENTIONAL, NEW, swing),
        }
    return verdicts


@dataclass(frozen=True)
class Ratio:
    """Error of one algorithm over that of a new one, in one flight."""

    flight: Flight
    new: Algorithm
    top: float
    bottom: float
    floor: float

    @property
    def value(self) -> float:
        """Above 1 where the new algorithm is the better one; an error below rounding counts as rounding."""
        return max(self.top, self.floor) / max(self.bottom, self.floor)


def _ratios(
    results: Results, against: Sequence[Algorithm], new: Sequence[Algorithm], found: Sequence[Flight], measure: str
) -> list[Ratio]:
    return [
        Ratio(flight, b, results.value(flight, a, measure), results.value(flight, b, measure), FLOORS[measure])
        for a in against
        for b in new
        for flight in found
    ]


def _better(ratios: Sequence[Ratio], unit: str) -> Verdict:
    """Judge "the new algorithms are more accurate": by more than what a figure does not show, in every flight."""
    values = [ratio.value for ratio in ratios]
    measured = (
        f"conventional {spread([r.top for r in ratios])} {unit}, new {spread([r.bottom for r in ratios])} {unit}; "
        f"ratio {spread(values)}"
    )
    if min(values) > ALIKE:
        return Verdict("holds", measured, f"the new algorithms err less in all {len(values)} comparisons")
    worst = min(ratios, key=lambda ratio: ratio.value)
    equal = sum(1 / ALIKE <= value <= ALIKE for value in values)
    worse = sum(value < 1 / ALIKE for value in values)
    reason = (
        f"of {len(values)} comparisons {len(values) - equal - worse} favour the new algorithms, {equal} are even and "
        f"{worse} favour the conventional one; the least ratio is that of {worst.new.label} at {worst.flight.label}"
    )
    return Verdict("does not hold", measured, reason)


def judge_attitude(results: Results, against: Sequence[Algorithm], swing: bool) -> Verdict:
    """Claim 1: attitude errors of the conventional algorithms over those of the new ones, in all flights."""
    ratios = _ratios(results, against, NEW, results.flights(swing=swing), ATTITUDE)
    shown = [ratio for ratio in ratios if max(ratio.top, ratio.bottom) >= ratio.floor]
    if not shown:
        return Verdict("cannot be judged", f"below {FLOORS[ATTITUDE]:g} arcsec", "rounding decides in every flight")
    return _better(shown, "arcsec")


def judge_speed(results: Results, against: Sequence[Algorithm], swing: bool) -> Verdict:
    """Claim 2: whether the ratio of attitude errors grows from each speed to the next, in level flight."""
    level = results.flights(swing=swing, weave=0)
    if len(level) < 2:
        return Verdict("cannot be judged", "one speed", "growth with speed needs at least two speeds")
    curves = {
        (a.label, b.label): np.array([ratio.value for ratio in _ratios(results, [a], [b], level, ATTITUDE)])
        for a in against
        for b in NEW
    }
    steps = np.array([curve[1:] / curve[:-1] for curve in curves.values()])
    first, last = ([curve[k] for curve in curves.values()] for k in (0, -1))
    measured = (
        f"ratio of the attitude errors {spread(first)} at {level[0].speed:g} m/s, "
        f"{spread(last)} at {level[-1].speed:g} m/s"
    )
    grows = bool((steps > ALIKE).all())
    reason = (
        f"from each speed to the next the ratio changes by a factor of {spread(steps.ravel().tolist())}"
        f"{'' if grows else f'; growth would be more than {ALIKE:g} at every step'}"
    )
    return Verdict("holds" if grows else "does not hold", measured, reason)


def judge_equality(results: Results, improved: Algorithm, swing: bool) -> Verdict:
    """Claim 3: errors of the improved algorithm over those of the dual quaternion, every measure and flight."""
    found = results.flights(swing=swing)
    ratios = {
        measure: [ratio.value for ratio in _ratios(results, [improved], [DUAL], found, measure)] for measure in MEASURES
    }
    measured = "ratio of the errors: " + "; ".join(f"{QUANTITIES[m]} {spread(values)}" for m, values in ratios.items())
    apart = {
        QUANTITIES[measure]: sum(not 1 / ALIKE <= value <= ALIKE for value in values)
        for measure, values in ratios.items()
    }
    if not any(apart.values()):
        name = "dual quaternion against improved" + ("" if improved is IMPROVED else ", first-order")
        largest = max(results.value(flight, name, VELOCITY, "difference") for flight in found)
        reason = f"errors alike in all {len(found)} flights; the velocities differ by at most {largest:.2g} m/s"
        return Verdict("holds", measured, reason)
    listed = ", ".join(f"{name} in {count}" for name, count in apart.items() if count)
    return Verdict("does not hold", measured, f"errors are not alike: {listed} of {len(found)} flights")


def judge_changes(results: Results, against: Algorithm, new: Sequence[Algorithm], swing: bool) -> Verdict:
    """Claim 4: velocity errors of the conventional algorithm over those of the new ones, in the harsh weave."""
    ratios = _ratios(results, [against], new, results.flights(swing=swing, weave=HARSH), VELOCITY)
    verdict = _better(ratios, "m/s")
    level = _ratios(results, [against], new, results.flights(swing=swing, weave=0), VELOCITY)
    reason = f"{verdict.reason}; in level flight the ratio is {spread([ratio.value for ratio in level])}"
    return Verdict(verdict.judgement, verdict.measured, reason)


def judge_cost(counts: Counts) -> dict[str, Verdict]:
    """Claim 5: all operations of an update, in both frames of the results."""
    verdicts: dict[str, Verdict] = {}
    for frame in (IN_E, IN_N):
        verdicts |= {
            f"5 improved as conventional, first-order, {frame}": _cost(
                counts, frame, IMPROVED_FIRST, CONVENTIONAL_FIRST, 1
            ),
            f"5 improved as conventional, exact, {frame}": _cost(counts, frame, IMPROVED, CONVENTIONAL, 1),
            f"5 dual quaternion twice, first-order, {frame}": _cost(counts, frame, DUAL, IMPROVED_FIRST, 2),
            f"5 dual quaternion twice, exact, {frame}": _cost(counts, frame, DUAL, IMPROVED, 2),
        }
    return verdicts


def _cost(counts: Counts, frame: str, top: Algorithm, bottom: Algorithm, printed: int) -> Verdict:
    a, b = counts[top.label, frame], counts[bottom.label, frame]
    ratio = a.total / b.total
    words = [
        f"{label}: {count.multiplications:g} multiplications, {count.additions + count.subtractions:g} additions, "
        f"{count.divisions + count.roots + count.trigonometric:g} divisions, roots and functions"
        for label, count in ((top.label, a), (bottom.label, b))
    ]
    holds = printed / math.sqrt(2) <= ratio <= printed * math.sqrt(2)
    reason = f"ratio of all operations {ratio:.2f}, {'' if holds else 'not '}{printed} to the nearest power of 2"
    return Verdict("holds" if holds else "does not hold", "; ".join(words), reason)
