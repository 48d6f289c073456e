"""The printed numbers of `gyro-free-circular`, and the trials among which they are placed."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from bench.errors import Array
from bench.experiments._gyro_free_trials import READINGS, Options, Reading
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
IMPROVEMENTS = {"attitude": (96.82, 97.02, 96.69), "position": (89.95, 87.84)}  # %, printed


@dataclass(frozen=True)
class Focus:
    """What figures and recording show: the trial that is nearest to the printed numbers."""

    reading: Reading
    definition: str
    trial: int


@dataclass(frozen=True, eq=False)
class Trials:
    """The rows, cut by reading and system."""

    options: Options
    rows: dict[tuple[str, str], Table]

    @classmethod
    def of(cls, options: Options, rows: Table) -> "Trials":
        """Cut the rows once; selecting them again and again would be slow."""
        cut = {(r.label, s): rows.where(reading=r.label, system=s) for r in READINGS for s in ("six", "nine")}
        return cls(options, cut)

    def at(self, reading: Reading, system: str, columns: Iterable[str], t: float) -> Array:
        """Return the errors of all trials at one time, shape (trials, columns)."""
        table = self.rows[reading.label, system]
        times = table["t_s"]
        keep = times == times[np.argmin(np.abs(times - t))]
        return np.stack([table[name][keep] for name in columns], axis=1)

    def end(self, reading: Reading, system: str, columns: Iterable[str]) -> Array:
        """Return the errors of all trials at the end."""
        return self.at(reading, system, columns, self.options.duration)
