"""The printed numbers of `gyro-free-circular`, and the trials among which they are placed."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.errors import Array
from bench.experiments._gyro_free_trials import NOISE_READINGS, READINGS, Options, Reading, Work
from bench.table import Table

AXES = "xyz"
DEFINITIONS = {"integral": "integral of the rate error", "rotation": "rotation vector in n"}

POSITION = ("position_x_m", "position_y_m")
ATTITUDE = tuple(f"integral_{axis}_deg" for axis in AXES)


@dataclass(frozen=True)
class Published:
    """One printed number of tables 1 and 2, at 60 s."""

    table: int
    system: str
    axis: int
    value: float

    @property
    def quantity(self) -> str:
        """Return what it measures."""
        return "attitude" if self.table == 1 else "position"

    @property
    def unit(self) -> str:
        """Return its unit."""
        return "deg" if self.table == 1 else "m"

    @property
    def key(self) -> str:
        """Return the name of its claim."""
        return f"{self.system}, {self.quantity} {AXES[self.axis]}"

    @property
    def place(self) -> str:
        """Return where it is printed."""
        return f"table {self.table}"

    def columns(self) -> dict[str, str]:
        """Return the columns of the rows that it may mean, by definition."""
        if self.table == 2:
            return {"": f"position_{AXES[self.axis]}_m"}
        return {name: f"{name}_{AXES[self.axis]}_deg" for name in DEFINITIONS}


PUBLISHED = tuple(
    Published(table, system, axis, value)
    for table, system, values in (
        (1, "six", (-0.534, -2.584, -1.875)),
        (1, "nine", (0.017, -0.077, 0.062)),
        (2, "six", (-103.201, 104.337)),
        (2, "nine", (10.372, 12.683)),
    )
    for axis, value in enumerate(values)
)
ROWS = {  # the numbers that one run printed side by side
    f"{system}, {quantity}, all axes at once": tuple(
        n for n in PUBLISHED if (n.system, n.quantity) == (system, quantity)
    )
    for quantity in ("attitude", "position")
    for system in ("six", "nine")
}
IMPROVEMENTS = {"attitude": (96.82, 97.02, 96.69), "position": (89.95, 87.84)}  # %, printed


@dataclass(frozen=True)
class Focus:
    """What figures and recording show: the trial that is nearest to the printed numbers."""

    reading: Reading
    definition: str
    trial: int

    def work(self, options: Options, seed: int) -> Work:
        """Return the work that this trial is a part of."""
        return Work(options, seed, self.reading, self.trial, 1)


@dataclass(frozen=True, eq=False)
class Trials:
    """The rows, cut by reading and system."""

    options: Options
    rows: dict[tuple[str, str], Table]
    noise: dict[tuple[str, str], Table]
    signs: dict[tuple[str, str], Table]

    @classmethod
    def of(cls, options: Options, rows: Table) -> "Trials":
        """Cut the rows once; selecting them again and again would be slow."""

        def cut(kind: str) -> dict[tuple[str, str], Table]:
            some = rows.where(kind=kind)
            return {(r.label, s): some.where(reading=r.label, system=s) for r in READINGS for s in ("six", "nine")}

        return cls(options, cut("trial"), cut("noise"), cut("signs"))

    def distance(self, reading: Reading, system: str, columns: Sequence[str], values: Array) -> float:
        """Return how far the values are from what bias can make, against what noise can add; above 1 is too far.

        The errors without noise are enumerated over all signs of the biases; the distance to the nearest of them
        is taken in the metric of the noise (Hotelling's T^2) and divided by its 97.5 percentile.
        """
        from scipy.stats import f

        quiet = replace(reading, noise=NOISE_READINGS[0])
        nodes, noise = (
            np.stack([table[name] for name in columns], axis=1)
            for table in (self.signs[quiet.label, system], self.noise[reading.label, system])
        )
        n, k = noise.shape
        if n <= k:
            return float("nan")  # a run too short to judge
        covariance = np.atleast_2d(np.cov(noise, rowvar=False))
        off = values - nodes
        nearest = np.einsum("ni,ni->n", off, np.linalg.solve(covariance, off.T).T).min()
        return float(np.sqrt(nearest / (k * (n - 1) / (n - k) * f.ppf(0.975, k, n - k))))

    def at(self, reading: Reading, system: str, columns: Iterable[str], t: float) -> Array:
        """Return the errors of all trials at one time, shape (trials, columns)."""
        table = self.rows[reading.label, system]
        times = table["t_s"]
        keep = times == times[np.argmin(np.abs(times - t))]
        return np.stack([table[name][keep] for name in columns], axis=1)

    def end(self, reading: Reading, system: str, columns: Iterable[str]) -> Array:
        """Return the errors of all trials at the end."""
        return self.at(reading, system, columns, self.options.duration)
