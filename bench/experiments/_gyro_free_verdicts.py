"""The verdicts of `gyro-free-circular`: where each printed number lies in each reading, and what follows."""

from collections.abc import Callable
from itertools import product

import numpy as np

from bench.bounds import cramer_rao_std
from bench.errors import Array
from bench.evaluation import percentile_of, rms
from bench.experiment import Evaluation, Verdict
from bench.experiments import _gyro_free_figures as figures
from bench.experiments._gyro_free_published import (
    ATTITUDE,
    AXES,
    DEFINITIONS,
    IMPROVEMENTS,
    POSITION,
    PUBLISHED,
    ROWS,
    Focus,
    Published,
    Trials,
)
from bench.experiments._gyro_free_trials import BIAS, NOISE, READINGS, Options, Reading, ideal
from bench.table import Table

CENTRAL = (2.5, 97.5)  # percentiles that a single published run is expected between
ENOUGH = 100  # trials, for percentiles of 2.5 to mean something

NEEDS_NO_TRIALS = ("improvement arithmetic", "differences remove bias", "no division by zero")


def total(values: Array) -> float:
    """Return the root mean square over trials and axes."""
    return float(rms(values.ravel()))


def evaluate(options: Options, seed: int, rows: Table) -> Evaluation:
    """Turn the rows into tables, verdicts and figures."""
    trials = Trials.of(options, rows)
    placed = place_published(trials)
    together = place_together(trials)
    reading, definition = best_reading(placed)
    verdicts = {
        **{number.key: judge_number(number, placed) for number in PUBLISHED},
        **{name: judge_together(name, together) for name in ROWS},
        "improvement arithmetic": judge_arithmetic(),
        "attitude better by 95 %": judge_everywhere(
            trials, lambda r: improvement(trials, r, ATTITUDE), 0.95, "1 - rms nine/six:"
        ),
        "position better by 85 %": judge_everywhere(
            trials, lambda r: improvement(trials, r, POSITION), 0.85, "1 - rms nine/six:"
        ),
        "advantage grows with time": judge_everywhere(
            trials, lambda r: growth_of_advantage(trials, r), 1.0, "growth of rms six/nine:"
        ),
        "less smooth": judge_everywhere(trials, lambda r: rougher(trials, r), 0.95, "share of trials:"),
        "both diverge": judge_everywhere(trials, lambda r: divergence(trials, r), 1.0, "rms at the end/half time:"),
        "differences remove bias": judge_bias_removal(),
        "no division by zero": judge_zero_rate(seed),
    }
    if reason := not_the_papers(options):
        verdicts = {
            key: verdict if key in NEEDS_NO_TRIALS else Verdict("cannot be judged", verdict.measured, reason)
            for key, verdict in verdicts.items()
        }
    trial = nearest_trial(trials, reading, definition)
    text = summary(verdicts, reading, definition, placed, together)
    focus = Focus(reading, definition, trial)
    tables = {
        "published_in_readings": placed,
        "published_together": together,
        "readings": reading_table(trials, placed),
        "tables_1_and_2": rebuilt_tables(trials, reading, definition),
        "bound": bound_table(trials),
    }
    drawn = figures.figures(options, seed, trials, focus, placed)
    return Evaluation(verdicts, tables, drawn, text, focus)


def not_the_papers(options: Options) -> str:
    """Return why a run cannot judge the paper, or nothing."""
    if (options.duration, options.rate) != (60.0, 100.0):
        return f"the run is {options.duration:g} s at {options.rate:g} Hz, not the stated 60 s at 100 Hz"
    return f"{options.trials} trials are too few, at least {ENOUGH} are needed" if options.trials < ENOUGH else ""


def place_published(trials: Trials) -> Table:
    """Return where each printed number lies in each reading and under each definition."""
    found = []
    for number, reading in product(PUBLISHED, READINGS):
        for definition, column in number.columns().items():
            sample = trials.end(reading, number.system, [column])[:, 0]
            low, middle, high = np.percentile(sample, [CENTRAL[0], 50.0, CENTRAL[1]])
            percentile = 100 * float(percentile_of(number.value, sample))
            distance = (number.value - middle) / (float(sample.std()) or 1.0)
            far = trials.distance(reading, number.system, [column], np.array([number.value]))
            inside = bool(low <= number.value <= high and far <= 1)
            where = (number.key, number.unit, number.value, reading.label, definition)
            found.append((*where, low, middle, high, percentile, far, distance, inside))
    names = (
        *("number", "unit", "published", "reading", "definition", "p2.5", "median", "p97.5"),
        *("percentile", "distance", "distance_in_std", "admitted"),
    )
    return Table.from_rows(names, found, "Each printed number in each reading of the conditions, at the end of the run")


def place_together(trials: Trials) -> Table:
    """Return how far the numbers that the paper printed side by side are from what a reading can make."""
    found = []
    for (name, numbers), reading in product(ROWS.items(), READINGS):
        printed = np.array([number.value for number in numbers])
        for definition in numbers[0].columns():
            columns = [number.columns()[definition] for number in numbers]
            sample = trials.end(reading, numbers[0].system, columns)
            nearest = float(np.linalg.norm(sample - printed, axis=1).min())
            far = trials.distance(reading, numbers[0].system, columns, printed)
            found.append((name, numbers[0].unit, reading.label, definition, nearest, far, bool(far <= 1)))
    names = ("numbers", "unit", "reading", "definition", "nearest trial", "distance", "admitted")
    title = "The printed numbers of one run side by side (distance from what bias and noise can make; above 1: too far)"
    return Table.from_rows(names, found, title)


def judge_together(name: str, together: Table) -> Verdict:
    """Judge the numbers that one run printed side by side."""
    rows = together.where(numbers=name)
    k = int(np.argmin(np.nan_to_num(rows["distance"], nan=np.inf)))
    measured = f"{rows['distance'][k]:.2g} times too far" if rows["distance"][k] > 1 else "within reach"
    admitted = sorted({str(r) for r, ok in zip(rows["reading"], rows["admitted"], strict=True) if ok})
    reason = (
        f"nearest in {_where(rows, k)}, its nearest trial {rows['nearest trial'][k]:.3g} {rows['unit'][k]} away; "
        f"admitted by {len(admitted)} of {len(READINGS)} readings"
    )
    return Verdict("holds" if admitted else "does not hold", measured, reason)


def _where(rows: Table, k: int) -> str:
    definition = DEFINITIONS.get(str(rows["definition"][k]))
    return str(rows["reading"][k]) + (f" ({definition})" if definition else "")


def _counted(placed: Table, reading: Reading, definition: str) -> tuple[int, float]:
    """Return how many printed numbers a reading admits, and minus their summed squared distance in std."""
    keep = (placed["reading"] == reading.label) & np.isin(placed["definition"], ("", definition))
    return int(placed["admitted"][keep].sum()), -float((placed["distance_in_std"][keep] ** 2).sum())


def best_reading(placed: Table) -> tuple[Reading, str]:
    """Return the reading and the definition that admit most of the printed numbers."""
    return max(product(READINGS, DEFINITIONS), key=lambda choice: _counted(placed, *choice))


def judge_number(number: Published, placed: Table) -> Verdict:
    """Judge one printed number, by itself."""
    rows = placed.where(number=number.key)
    admitted = [k for k in range(len(rows)) if rows["admitted"][k]]
    k = min(admitted or range(len(rows)), key=lambda k: abs(rows["distance_in_std"][k]))
    measured = f"95 % of trials: {rows['p2.5'][k]:.3g} to {rows['p97.5'][k]:.3g} {number.unit}"
    by = {str(rows["reading"][k]) for k in admitted}
    placed_at = f"percentile {rows['percentile'][k]:.3g} in {_where(rows, k)}"
    reason = f"{placed_at}; admitted by {len(by)} of {len(READINGS)} readings"
    excluded = [reading.label for reading in READINGS if reading.label not in by]
    if by and excluded:
        reason += "; excludes " + " / ".join(excluded)
    return Verdict("holds" if admitted else "does not hold", measured, reason)


def judge_arithmetic() -> Verdict:
    """Recompute the printed improvements from the printed errors."""
    value = {(n.system, n.quantity, n.axis): n.value for n in PUBLISHED}
    got = [
        100 * (1 - abs(value["nine", quantity, axis] / value["six", quantity, axis]))
        for quantity, printed in IMPROVEMENTS.items()
        for axis in range(len(printed))
    ]
    printed = [number for numbers in IMPROVEMENTS.values() for number in numbers]
    same = all(round(a, 2) == b for a, b in zip(got, printed, strict=True))
    measured = ", ".join(f"{a:.2f}" for a in got) + " %"
    return Verdict("holds" if same else "does not hold", measured, "recomputed from the printed errors of one run")


def judge_everywhere(trials: Trials, measure: Callable[[Reading], float], threshold: float, what: str) -> Verdict:
    """Judge a statement in every reading: it is true where the measure exceeds the threshold."""
    values = {reading: measure(reading) for reading in READINGS}
    true = [reading for reading, value in values.items() if value > threshold]
    span = f"{min(values.values()):.4g} to {max(values.values()):.4g}"
    measured = f"{what} {span} (needs > {threshold:g})"
    if len(true) == len(READINGS):
        reason = f"true in all {len(READINGS)} readings, over {trials.options.trials} trials each"
        return Verdict("holds", measured, reason)
    if not true:
        return Verdict("does not hold", measured, f"true in none of {len(READINGS)} readings")
    false = [reading.label for reading in READINGS if reading not in true]
    reason = f"true in {len(true)} of {len(READINGS)} readings; not in: {' / '.join(false)}"
    return Verdict("cannot be judged", measured, reason)


def improvement(trials: Trials, reading: Reading, columns: tuple[str, ...]) -> float:
    """Return the smallest over the axes of 1 - rms(nine)/rms(six) at the end."""
    nine, six = (rms(trials.end(reading, system, columns)) for system in ("nine", "six"))
    return float((1 - nine / six).min())


def growth_of_advantage(trials: Trials, reading: Reading) -> float:
    """Return the smallest growth of rms(six)/rms(nine) from one and two thirds of the run to its end."""
    duration = trials.options.duration
    growth = []
    for columns in (ATTITUDE, POSITION):
        ratio = [
            total(trials.at(reading, "six", columns, t)) / total(trials.at(reading, "nine", columns, t))
            for t in (duration / 3, 2 * duration / 3, duration)
        ]
        growth += [ratio[2] / ratio[0], ratio[2] / ratio[1]]
    return float(min(growth))


def rougher(trials: Trials, reading: Reading) -> float:
    """Return the fraction of trials in which nine is rougher than six."""
    nine, six = (trials.end(reading, system, ["roughness_deg"]) for system in ("nine", "six"))
    return float(np.mean(nine > six))


def divergence(trials: Trials, reading: Reading) -> float:
    """Return the smallest growth of an rms error from half time to the end."""
    half, end = trials.options.duration / 2, trials.options.duration
    return float(
        min(
            total(trials.at(reading, system, columns, end)) / total(trials.at(reading, system, columns, half))
            for system in ("nine", "six")
            for columns in (ATTITUDE, POSITION)
        )
    )


def _nine_at_rest(readings: Array) -> tuple[Array, int]:
    """Return f_b and the number of negative squares of the nine-accelerometer solver for given readings at rest."""
    from bench.signals import Initial
    from bench.solvers import solver

    geometry = ideal(Options(), "no gravity").accelerometers["nine"]
    solution = solver("gyro-free", "nine-accelerometer").solve(geometry, readings, 0.01, Initial(gravity=(0, 0, 0)))
    return solution.f_b, solution.negative_squares


def judge_bias_removal() -> Verdict:
    """Give the solver every combination of bias signs at rest and look at its specific force."""
    signs = np.array(list(product((-1.0, 1.0), repeat=9)))
    error = np.abs(_nine_at_rest(BIAS * signs)[0]).max(axis=1)
    free = int((error < 1e-9 * BIAS).sum())
    reason = (
        f"f = (A1 - A4)/2 is free of bias only where opposite accelerometers have equal biases: "
        f"{free} of {len(signs)} combinations of signs"
    )
    measured = f"error of f up to {error.max():.2g} m/s^2 with biases of {BIAS:g}"
    return Verdict("holds" if free == len(signs) else "does not hold", measured, reason)


def judge_zero_rate(seed: int) -> Verdict:
    """Give the solver noise at rest: nothing may divide by the rate, but half of the squares are negative."""
    noise = NOISE**0.5 * np.random.default_rng(seed).standard_normal((20_000, 9))
    f_b, negative = _nine_at_rest(noise)
    linear = np.allclose(_nine_at_rest(2 * noise)[0], 2 * f_b, rtol=1e-12, atol=0)
    share = negative / (3 * len(noise))
    holds = bool(np.isfinite(f_b).all() and linear)
    reason = "the solution stays finite and linear, but the squares that fall below zero carry no rate"
    measured = f"finite; {100 * share:.0f} % of the squares negative"
    return Verdict("holds" if holds else "does not hold", measured, reason)


def nearest_trial(trials: Trials, reading: Reading, definition: str) -> int:
    """Return the trial whose errors are nearest to the printed ones, each in units of its own spread."""
    distance = np.zeros(trials.options.trials)
    for number in PUBLISHED:
        column = number.columns().get(definition) or number.columns()[""]
        sample = trials.end(reading, number.system, [column])[:, 0]
        distance += ((sample - number.value) / (sample.std() or 1.0)) ** 2
    return int(np.argmin(distance))


def reading_table(trials: Trials, placed: Table) -> Table:
    """Return one row per reading: how many printed numbers it admits, and how large the errors are."""
    rows = []
    for reading in READINGS:
        admitted = [f"{_counted(placed, reading, d)[0]} of {len(PUBLISHED)}" for d in DEFINITIONS]
        size = [total(trials.end(reading, s, c)) for c in (ATTITUDE, POSITION) for s in ("six", "nine")]
        gain = [100 * improvement(trials, reading, columns) for columns in (ATTITUDE, POSITION)]
        rows.append((reading.label, *admitted, *size, *gain))
    names = (
        *("reading", "admitted (integral)", "admitted (rotation vector)", "six, deg rms", "nine, deg rms"),
        *("six, m rms", "nine, m rms", "attitude better by, %", "position better by, %"),
    )
    return Table.from_rows(names, rows, "The readings of the conditions")


def rebuilt_tables(trials: Trials, reading: Reading, definition: str) -> Table:
    """Return tables 1 and 2 as distributions, in the reading that fits best."""
    rows = []
    for number in PUBLISHED:
        column = number.columns().get(definition) or number.columns()[""]
        sample = trials.end(reading, number.system, [column])[:, 0]
        printed = (number.place, number.system, number.quantity, AXES[number.axis], number.unit, number.value)
        rows.append((*printed, sample.mean(), sample.std(), *np.percentile(sample, [2.5, 50, 97.5])))
    names = ("table", "system", "error", "axis", "unit", "published", "mean", "std", "p2.5", "p50", "p97.5")
    return Table.from_rows(names, rows, f"Tables 1 and 2 in the reading that fits best ({reading.label}; {definition})")


def bound_table(trials: Trials) -> Table:
    """Return the jitter of the rate against the Cramer-Rao bound of one sample."""
    options, rows = trials.options, []
    for reading in READINGS:
        geometry = ideal(options, reading.gravity).accelerometers["nine"]
        bound = total(cramer_rao_std(geometry, np.array([2.0, 2.0, 2.0]), reading.noise_std(options.rate)))
        jitter = total(trials.end(reading, "nine", ["rate_jitter_rad_per_s"]))
        rows.append((reading.label, bound, jitter, jitter / bound))
    return Table.from_rows(
        ("reading", "Cramer-Rao bound, rad/s", "nine accelerometers, rad/s", "ratio"),
        rows,
        "Noise of the nine-accelerometer rate per sample against what any single-sample estimator can reach",
    )


def summary(verdicts: dict[str, Verdict], reading: Reading, definition: str, placed: Table, together: Table) -> str:
    """Return the finding in one paragraph."""
    count = {
        j: sum(v.judgement == j for v in verdicts.values()) for j in ("holds", "does not hold", "cannot be judged")
    }
    admitted, _ = _counted(placed, reading, definition)
    possible = [name for name in ROWS if together.where(numbers=name)["admitted"].any()]
    return (
        f"Of {len(verdicts)} claims {count['holds']} hold, {count['does not hold']} do not hold and "
        f"{count['cannot be judged']} cannot be judged. Taken one by one, the printed numbers fit best the reading "
        f"**{reading.label}** of the conditions, with the attitude error as {DEFINITIONS[definition]}: it admits "
        f"{admitted} of {len(PUBLISHED)}. Taken side by side, as one run printed them, {len(possible)} of {len(ROWS)} "
        f"sets can arise in any reading{' (' + '; '.join(possible) + ')' if possible else ''}."
    )
