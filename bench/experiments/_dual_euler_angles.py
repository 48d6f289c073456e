"""What the dual-Euler experiments measure of an attitude: errors in the active set, jumps of outputs, the flag."""

from dataclasses import dataclass

import numpy as np

from bench.errors import Array
from bench.euler_angles import DualAngles, angle_errors, track
from bench.experiments._dual_euler_runs import RATE, REPORT
from bench.rotation import euler_from_quat, wrap
from bench.table import Table
from bench.units import ARCMIN, DEG

EVERY = 4  # increments between judged attitudes
T = EVERY / RATE  # s
SHOWN = 5  # judged attitudes of which one is shown in figures and recordings
AWAY = 80 * DEG  # of |pitch|: where the forward output is compared
NAMES = ("heading", "pitch", "roll")
SIGNS = np.array([-1.0, 1.0, 1.0])  # H = -psi

KEYS = ("part", "case", "algorithm", "samples", "trial")
ERRORS = tuple(f"{name}_arcmin" for name in NAMES)
LARGEST = tuple(f"largest_{name}_arcmin" for name in NAMES)
AWAY_ERRORS = tuple(f"away_{name}_arcmin" for name in NAMES)
PLAIN_ERRORS = tuple(f"plain_{name}_deg" for name in NAMES)
MEASURES = (
    *("t_s", *ERRORS, *LARGEST, *AWAY_ERRORS, *PLAIN_ERRORS, "step_deg", "output_off_deg", "flag_wrong_s"),
    *("switches", "true_switches", "wiggle_true_arcmin", "wiggle_error_arcmin"),
)
SETS = ("true", "true_active", "output", "plain", "forward", "reverse")
SHOWN_ANGLES = tuple(f"{kind}_{name}_deg" for kind in SETS for name in NAMES)
SERIES = ("t_s", *ERRORS, *SHOWN_ANGLES, "flag")


@dataclass(frozen=True, eq=False)
class Judged:
    """The angles of an estimate beside the true ones, at n times, `T` apart.

    Attributes
    ----------
    t : ndarray, shape (n,), s
    error : ndarray, shape (n, 3), rad
        Of heading, pitch and roll in the set that is active for the truth.
    truth, estimate : DualAngles
        Tracked without jumps.
    plain : ndarray, shape (n, 3), rad
        psi, P, R as they are commonly taken from the estimated matrix.
    """

    t: Array
    error: Array
    truth: DualAngles
    estimate: DualAngles
    plain: Array

    @classmethod
    def of(cls, t: Array, q: Array, q_true: Array) -> "Judged":
        """Return the angles of estimated and true attitudes, both b to n."""
        error, truth = angle_errors(q, q_true)
        return cls(t, SIGNS * error, truth, track(q), np.stack(euler_from_quat(q), axis=1))

    def rows(self, *keys: object) -> Table:
        """Return the measures, one row every `REPORT` seconds; the keys are those of `KEYS`."""
        every = round(REPORT / T)
        plain = np.abs(wrap(self.plain - self.truth.forward))
        pitch = self.truth.forward[:, 1]
        away = np.where((np.abs(np.sin(pitch)) < np.sin(AWAY))[:, None], plain, 0.0)
        # Where both sets serve, near a switch, truth and estimate may use different ones for a moment.
        step = np.abs(wrap(np.diff(self.estimate.active, axis=0) - np.diff(self.truth.active, axis=0)))
        same = (np.diff(self.estimate.flag) == 0) & (np.diff(self.truth.flag) == 0)
        step = np.where(same[:, None], step, 0.0).max(axis=1, initial=0.0, keepdims=True)
        off = np.abs(wrap(self.estimate.active - self.truth.active)).max(axis=1, keepdims=True)
        off = np.where((self.estimate.flag == self.truth.flag)[:, None], off, 0.0)
        folded = np.abs(np.arcsin(np.clip(np.sin(pitch), -1.0, 1.0)))  # 50 and 40 deg, give or take the error
        wrong = np.where(folded > 50.1 * DEG, self.estimate.flag > 0, (folded < 39.9 * DEG) & (self.estimate.flag < 0))
        columns = [
            self.t[:, None],
            self.error / ARCMIN,
            _largest(np.abs(self.error)) / ARCMIN,
            _largest(away) / ARCMIN,
            _largest(plain) / DEG,
            _largest(np.concatenate([np.zeros((1, 1)), step])) / DEG,
            _largest(off) / DEG,
            np.cumsum(wrong, axis=0)[:, None] * T,
            _switches(self.estimate.flag),
            _switches(self.truth.flag),
        ]
        values = np.concatenate(columns, axis=1)[every::every]
        wiggles = [_wiggle(angle[1:], every) / ARCMIN for angle in (pitch, self.error[:, 1])]
        values = np.concatenate([values, *wiggles], axis=1)
        return _table(keys, dict(zip(MEASURES, values.T, strict=True)))

    def series(self, *keys: object) -> Table:
        """Return angles in time; of every `SHOWN` times the one at which the plain heading is farthest off."""
        n = len(self.t) // SHOWN * SHOWN
        off = np.abs(wrap(self.plain - self.truth.forward))[:n, 0].reshape(-1, SHOWN)
        k = np.arange(0, n, SHOWN) + off.argmax(axis=1)
        kinds = (self.truth.forward, self.truth.active, self.estimate.active, self.plain)
        angles = [SIGNS * kind[k] / DEG for kind in (*kinds, self.estimate.forward, self.estimate.reverse)]
        values = [self.t[k, None], self.error[k] / ARCMIN, *angles, self.estimate.flag[k, None]]
        return _table(keys, dict(zip(SERIES, np.concatenate(values, axis=1).T, strict=True)))


def _largest(values: Array) -> Array:
    return np.asarray(np.maximum.accumulate(values, axis=0))


def _switches(flag: np.ndarray) -> Array:
    changed = np.concatenate([[0], np.diff(flag) != 0])
    return np.cumsum(changed)[:, None].astype(float)


def _wiggle(angle: Array, every: int) -> Array:
    """Return the RMS about a straight line in each block of rows, shape (blocks, 1)."""
    blocks = angle[: len(angle) // every * every].reshape(-1, every)
    x = np.arange(every) - 0.5 * (every - 1)
    flat = blocks - blocks.mean(axis=1, keepdims=True)
    flat = flat - np.outer(flat @ x / (x @ x), x)
    return np.sqrt((flat**2).mean(axis=1))[:, None]


def _table(keys: tuple[object, ...], found: dict[str, Array]) -> Table:
    """Return a table with the columns of measures and of series alike; what a part has not is NaN."""
    n = len(found["t_s"])
    columns = {name: np.full(n, key) for name, key in zip(KEYS, keys, strict=True)}
    for name in dict.fromkeys((*MEASURES, *SERIES)):
        columns[name] = found.get(name, np.full(n, np.nan))
    return Table(columns, "Errors of every trial (estimate minus truth), and the angles of one")


def final(rows: Table, column: str) -> Array:
    """Return a column at the end of every trial."""
    return np.asarray(rows[column][rows["t_s"] == rows["t_s"].max()])
