"""The scan of `damping-external-velocity`: which unstated conditions give the published tables.

Filters 1 and 2 are linear in the errors that they start from, in those of the sensors and in those of the reference:
gains do not depend on data. So the two are run on one error at a time, in the fast mode, and every combination of
signs, constant and noise is a sum; only the fusion, which is not linear, is computed for each. Filter 1 takes a
reference every 5 s with the variance of the mean of five, which weighs the same.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from bench.errors import Array, Indices
from bench.experiments._damping_published import BOTH, FAMILIES, LARGEST, REFERENCE_ERRORS, SCALE, STATE, TABLES
from bench.experiments._damping_runs import CONSTANT, make_rows
from bench.experiments._damping_trials import ERRORS, FIRST, FUSION, HOUR, Options, Work, place, ship
from bench.solvers.damping import DampingModel, InsSamples
from bench.solvers.damping.double_filter import DoubleFilter
from bench.table import Table

R2_READINGS = ("acceleration", "velocity")
Q_READINGS = ("markov", "printed")
MEANS = {"cumulative": 0, "1 h": 3600, "4 h": 4 * 3600}  # s
NOISES = (0.0, 0.05)  # m/s
DT = 5.0  # s, of the filters here
STEP = 1800  # s, between the times at which the tables may have been read
EARLIEST = 8 * 3600  # s: before that nothing can be called steady
# Signs that show in the tables; the others, kept at +, are worth at most 0.033 arcmin, in longitude.
SIGNED = (0, 1, 2, 4, 6, 7, 8, 10, 11, 12)
UNSIGNED = (3, 5)
# What an "attitude error" is: phi, or the error of pitch, roll and yaw; and its unit, which the heads do not tell.
ATTITUDES = {"phi in arcmin": 1.0, "-phi in arcmin": -1.0, "phi in deg": 1 / 60, "-phi in deg": -1 / 60}
BOTH_TABLES = "both tables"


@dataclass(frozen=True)
class Setting:
    """What has to be run anew."""

    latitude: float
    tau: float
    r2: str
    q: str


@dataclass(frozen=True, eq=False)
class Responses:
    """Remaining errors of filters 1 and 2 at the reading times to one cause each, in the tables' columns and units.

    Attributes
    ----------
    t : ndarray, shape (m,), s
    one, two : ndarray, shape (causes, m, 7)
        Causes: all unsigned errors together, each of `SIGNED`, 1 m/s of the reference, 1 m/s of its noise.
    means : dict of str to ndarray, shape (causes, m, 7)
        Xbar = mean of X1 - X2, by window.
    p1, p2 : ndarray, shape (m, 7)
        Variances that the filters claim.
    gamma : ndarray, shape (m,)
    """

    t: Array
    one: Array
    two: Array
    means: dict[str, Array]
    p1: Array
    p2: Array
    gamma: Array


def settings(options: Options, latitude: float) -> Iterator[Setting]:
    """Yield what is run at one latitude; Q as printed, without 1/tau, only once."""
    for tau, r2 in product(options.taus, R2_READINGS):
        yield Setting(latitude, tau, r2, "markov")
    yield Setting(latitude, max(options.taus), "acceleration", "printed")


def reading_times(options: Options) -> Indices:
    """Return the times at which steady-state errors may have been read, s."""
    end = round(options.duration * HOUR)
    return np.arange(min(EARLIEST, end), end + 1, STEP)


def respond(options: Options, truth: InsSamples, setting: Setting, seed: int) -> Responses:
    """Run filters 1 and 2 on each cause alone."""
    from bench.error_simulation import ErrorSimulation, disturbed

    model = DampingModel.published(setting.tau, setting.q)
    double = DoubleFilter(
        model=replace(model, reference_noise=model.reference_noise / DT**0.5), r2_reading=setting.r2, interval=DT
    )
    t = reading_times(options)
    rows = np.round(t / DT).astype(int)
    initial = np.diag(CONSTANT.initial_std)
    causes = [initial[list(UNSIGNED)].sum(axis=0), *initial[list(SIGNED)], np.zeros(13), np.zeros(13)]
    noise = np.random.default_rng(seed).standard_normal((len(truth), 2)) / DT**0.5
    references: list[float | Array] = [*(0.0 for _ in causes[2:]), 1.0, noise]
    one, two = [], []
    means: dict[str, list[Array]] = {name: [] for name in MEANS}
    for cause, reference in zip(causes, references, strict=True):
        simulation = ErrorSimulation(CONSTANT)
        _, x = simulation.advance(simulation.start(cause), truth)
        ins = disturbed(truth, x[:, 0])
        v_ref = truth.v_n[:, :2] + reference
        solution = double.solve(ins, v_ref)
        first, second = (part.x[:, STATE] / SCALE for part in solution.parts)
        true = _true_errors(ins, truth) / SCALE
        one.append((true - first)[rows])
        two.append((true - second)[rows])
        sums = np.cumsum(first - second, axis=0)
        for name, length in MEANS.items():
            lag = round(length / DT)
            whole = (rows < lag) | (lag == 0)  # the mean over all rows so far
            before = np.where(whole[:, None], 0.0, sums[np.maximum(rows - lag, 0)])
            count = np.where(whole, rows + 1, lag)
            means[name].append((sums[rows] - before) / count[:, None])
    p1, p2 = ((part.sigma[rows][:, STATE] / SCALE) ** 2 for part in solution.parts)
    stacked = {name: np.stack(values) for name, values in means.items()}
    return Responses(t.astype(np.float64), np.stack(one), np.stack(two), stacked, p1, p2, double.gamma(t))


def _true_errors(ins: InsSamples, truth: InsSamples) -> Array:
    from bench.solvers.damping import error_states

    return error_states(ins, truth.trajectory())[:, STATE]


def sign_table() -> Array:
    """Return all combinations of the signs of `SIGNED`, shape (1024, 10)."""
    return np.array(list(product((1.0, -1.0), repeat=len(SIGNED))))


def readings_each(options: Options) -> int:
    """Return how many readings of the tables one setting has."""
    return len(sign_table()) * len(reading_times(options)) * len(NOISES) * len(MEANS) * len(ATTITUDES)


@dataclass(frozen=True, eq=False)
class Best:
    """The reading that fits best by one criterion: how well, what it is, when (s), and its tables (2, 5, 7).

    factor is what it multiplies phi by, to get the attitude of the tables.
    """

    misfit: float
    label: str
    t: float
    signs: str
    factor: float
    tables: Array


def criteria(deviation: Array) -> dict[str, Array]:
    """Return by how much readings miss the tables; deviation (2, signs, m, 5, 7) is relative to the columns' largest.

    Root mean squares for whole tables, largest deviations for single groups of columns; shape (signs, m) each.
    """
    squares = np.einsum("tsmcd,tsmcd->tsm", deviation, deviation) / BOTH[0].size
    largest = np.abs(deviation).max(axis=3)
    found = {BOTH_TABLES: np.sqrt(squares.mean(axis=0))}
    for k, table in enumerate(TABLES):
        found[table] = np.sqrt(squares[k])
        for family, columns in FAMILIES.items():
            found[f"{table}, {family}"] = largest[k][..., columns].max(axis=2)
    return found


def best_readings(responses: Responses, setting: Setting) -> dict[str, Best]:
    """Return the best reading of one setting by each criterion."""
    best: dict[str, Best] = {}
    combinations = sign_table()
    constants = np.array(REFERENCE_ERRORS)[:, None]

    def total(values: Array, noise: float) -> Array:
        fixed = values[0][:, None] + noise * values[-1][:, None] + constants * values[-2][:, None]  # (m, 5, 7)
        return np.asarray(np.einsum("sk,kmc->smc", combinations, values[1:-2])[:, :, None] + fixed)

    for noise in NOISES:
        first, second = total(responses.one, noise), total(responses.two, noise)
        for window, values in responses.means.items():
            p1 = responses.p1[:, None] + responses.gamma[:, None, None] * total(values, noise) ** 2
            share = responses.p2[:, None] / (p1 + responses.p2[:, None])
            tables = np.stack([share * first + (1 - share) * second, first])
            for attitude, factor in ATTITUDES.items():
                shown = tables.copy()
                shown[..., FAMILIES["attitude"]] *= factor
                deviation = (shown - BOTH[:, None, None]) / LARGEST[:, None, None, None]
                for criterion, misfit in criteria(deviation).items():
                    s, k = np.unravel_index(np.argmin(misfit), misfit.shape)
                    if criterion in best and best[criterion].misfit <= misfit[s, k]:
                        continue
                    signs = _sign_text(combinations[s])
                    label = (
                        f"{place(setting.latitude)}, {responses.t[k] / HOUR:g} h, tau {setting.tau:g} s, "
                        f"R2 as {setting.r2}, Q {setting.q}, Xbar {window}, noise {noise:g} m/s, "
                        f"attitude as {attitude}, signs {signs}"
                    )
                    best[criterion] = Best(
                        float(misfit[s, k]), label, float(responses.t[k]), signs, factor, shown[:, s, k].copy()
                    )
    return best


def _sign_text(signs: Array) -> str:
    text = ["+"] * 13
    for state, sign in zip(SIGNED, signs, strict=True):
        text[state] = "+" if sign > 0 else "-"
    return "".join(text)


def measure_scan(work: Work) -> Table:
    """Return the best readings of every setting at one latitude, with their tables."""
    options = work.options
    latitude = options.latitudes[work.index]
    t = np.arange(0.0, options.duration * HOUR + 1e-6, DT)
    truth = InsSamples.of(ship(replace(options, sway=False), latitude).trajectory(t))  # the paper's ship is level
    tables = []
    for setting in settings(options, latitude):
        found = best_readings(respond(options, truth, setting, work.seed), setting)
        tables += [_rows_of(work, criterion, best) for criterion, best in found.items()]
    return Table.concatenate(tables)


def _rows_of(work: Work, criterion: str, best: Best) -> Table:
    tables = []
    for name, table in zip((FUSION, FIRST), best.tables, strict=True):
        errors = {ERRORS[state]: table[:, c] * SCALE[c] for c, state in enumerate(STATE)}
        about = {"part": work.part, "case": criterion, "name": name, "label": best.label}
        reading = {"value": best.misfit, "t_h": best.t / HOUR, "factor": best.factor}
        tables.append(make_rows(5, **about, **reading, reference_m_per_s=np.array(REFERENCE_ERRORS), **errors))
    return Table.concatenate(tables)
