"""The results of `damping-external-velocity` by part, filter and reference error: series, steady states, settling."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bench.errors import Array
from bench.experiments._damping_published import COLUMNS, SCALE, STATE, UNITS
from bench.experiments._damping_trials import ERRORS, FIRST, FREE, FUSION, Options
from bench.table import Table

LAST = 1.5  # h, over which steady-state errors are taken: a Schuler period
ANGLES, PLACE, SPEED = (2, 3, 4), (0, 1), (5, 6)  # columns


class Reading(NamedTuple):
    """Unstated conditions: by how much they miss, what they are, time, factor of attitudes, and tables (2, 5, 7)."""

    misfit: float
    label: str
    hours: float
    factor: float
    tables: Array


@dataclass(frozen=True, eq=False)
class Results:
    """What was measured, by part, filter and reference error."""

    options: Options
    rows: Table

    @cached_property
    def _groups(self) -> dict[tuple[str, str, str, str], Array]:
        """Return the rows of each (part, case, name, reference error)."""
        names = ("part", "case", "name", "reference_m_per_s")
        keys = zip(*(self.rows[name].tolist() for name in names), strict=True)
        found: dict[tuple[str, str, str, str], list[int]] = {}
        for k, (part, case, name, constant) in enumerate(keys):
            found.setdefault((part, case, name, f"{constant:g}"), []).append(k)
        return {key: np.array(rows) for key, rows in found.items()}

    def table(self, part: str, name: str, *, case: str = "", constant: float = np.nan) -> Table:
        """Return the rows of one filter."""
        rows = self._groups[part, case, name, f"{constant:g}"]
        return Table({key: column[rows] for key, column in self.rows.columns.items()}, self.rows.title)

    def run(self, name: str, constant: float | None = None, part: str = "ins") -> tuple[Array, Array]:
        """Return times, h, and errors (n, 7) in the tables' columns and units; by default of the shown reference."""
        chosen = np.nan if name == FREE else self.options.focus if constant is None else constant
        found = self.table(part, name, constant=chosen)
        return found["t_h"], columns_of(found)

    def steady(self, name: str, constant: float | None = None) -> Array:
        """Return the mean error of the last `LAST` hours, by column."""
        t, errors = self.run(name, constant)
        return np.asarray(errors[t >= t[-1] - LAST].mean(axis=0))

    def steady_rms(self, name: str, constant: float | None = None) -> Array:
        """Return the root mean square error of the last `LAST` hours, by column."""
        t, errors = self.run(name, constant)
        return np.asarray(np.sqrt((errors[t >= t[-1] - LAST] ** 2).mean(axis=0)))

    def at(self, name: str, constant: float, hours: float) -> Array:
        """Return the error at a time, by column."""
        t, errors = self.run(name, constant)
        return np.asarray(errors[int(np.argmin(np.abs(t - hours)))])

    def settled(self, name: str, band: float, constant: float | None = None) -> Array:
        """Return the hours after which the errors stay near their steady-state values, by column; inf for never.

        Near is within `band` of the largest error of the undamped INS; who leaves that in the last `LAST` hours has
        not settled.
        """
        t, errors = self.run(name, constant)
        band = band * np.abs(self.run(FREE)[1]).max(axis=0)
        outside = np.abs(errors - self.steady(name, constant)) > band
        last = np.array([t[column][-1] if column.any() else 0.0 for column in outside.T])
        return np.where(last > t[-1] - LAST, np.inf, last)

    def best(self, criterion: str) -> "Reading":
        """Return the scanned reading that fits best by a criterion."""
        tables = [self._scanned(criterion, name) for name in (FUSION, FIRST)]
        k = int(np.argmin(tables[0]["value"][::5]))
        values = [columns_of(table)[5 * k : 5 * k + 5] for table in tables]
        first = {name: tables[0][name][5 * k].item() for name in ("value", "label", "t_h", "factor")}
        return Reading(first["value"], first["label"], first["t_h"], first["factor"], np.stack(values))

    def _scanned(self, criterion: str, name: str) -> Table:
        keep = (self.rows["part"] == "scan") & (self.rows["case"] == criterion) & (self.rows["name"] == name)
        return Table({key: column[keep] for key, column in self.rows.columns.items()})

    def consistency(self, case: str, name: str, measure: str) -> tuple[Array, Array]:
        """Return hours and the mean of NEES or NIS over the trials."""
        found = self.table("consistency", name, case=case)
        t = np.unique(found["t_h"])
        return t[1:], found[measure].reshape(-1, len(t)).mean(axis=0)[1:]

    def trial_rms(self, case: str, name: str) -> Array:
        """Return the root mean square error over the trials at their end, by column."""
        found = self.table("consistency", name, case=case)
        end = found["t_h"] == found["t_h"].max()
        return np.asarray(np.sqrt((columns_of(found)[end] ** 2).mean(axis=0)))

    def period(self, name: str) -> float:
        """Return a period that was found, s."""
        return float(self.table("undamped", name, case="period")["value"][0])


def columns_of(table: Table) -> Array:
    """Return errors (n, 7) in the columns and units of the published tables."""
    return np.stack([table[ERRORS[state]] for state in STATE], axis=1) / SCALE


def as_read(factor: float) -> Array:
    """Return what the columns of errors are multiplied by, to be as a reading has the attitudes."""
    return np.where(np.isin(np.arange(len(COLUMNS)), ANGLES), factor, 1.0)


def read_heads(factor: float) -> list[str]:
    """Return the heads of the columns as a reading has them."""
    sign, unit = "-" if factor < 0 else "", "deg" if abs(factor) < 1 else "arcmin"
    return [f"{sign}{COLUMNS[k]}, {unit}" if k in ANGLES else f"{COLUMNS[k]}, {UNITS[k]}" for k in range(len(COLUMNS))]
