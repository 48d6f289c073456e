"""External velocity for damping filters: read from a text file, and taken to the times of the filter.

::

    log = VelocityFile(columns="t,ve,vn", time_unit="s", velocity_unit="m/s").read("log.csv")
    v_ref = log.at(ins.t)  # NaN where no rows are near
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import (
    Array,
    InputError,
    require_array,
    require_choice,
    require_flag,
    require_integer,
    require_scalar,
    require_times,
)
from bench.formats import existing_file
from bench.formats._columns import DELIMITERS, Columns, read_columns
from bench.formats._reference import require_rows
from bench.formats._units import SPEED, TIME, Unit
from bench.interpolation import SAME_TIME

KEYS = (("t",), ("ve",), ("vn",))
LONGEST_GAP = 2.5  # s; at the filter's step of 1 s two missing rows of a log at 1 Hz are a gap


@dataclass(frozen=True, eq=False)
class VelocityAiding:
    """Horizontal velocity from outside, at its own times.

    Attributes
    ----------
    t : ndarray, shape (n,), s, n >= 2
        In the recording's times, increasing.
    v_en : ndarray, shape (n, 2), m/s
        East, north.
    longest_gap : float, s
        Between rows farther apart there is no velocity.
    source : str
        Where it comes from, for messages.

    Raises
    ------
    InputError
        If a value is not finite, shapes do not fit, times do not increase, or `longest_gap` is not positive.
    """

    t: Array
    v_en: Array
    longest_gap: float = LONGEST_GAP
    source: str = "aiding"

    def __post_init__(self) -> None:
        t = require_times("t", self.t)
        if len(t) < 2:
            raise InputError(f"{self.source}: at least two rows of velocity are needed, got {len(t)}")
        object.__setattr__(self, "t", t)
        object.__setattr__(self, "v_en", require_array("v_en", self.v_en, (len(t), 2)))
        require_scalar("longest_gap", self.longest_gap, positive=True)

    def __len__(self) -> int:
        return len(self.t)

    @property
    def gaps(self) -> int:
        """Number of intervals between rows that are longer than `longest_gap`."""
        return int(np.count_nonzero(np.diff(self.t) > self.longest_gap))

    def at(self, t: ArrayLike) -> Array:
        """Return the velocity at times t, shape (m,), s, as (m, 2), east and north; NaN where there is none.

        A row within 1 us of a time stands for it; others are interpolated linearly between the two rows about them, if
        those are at most `longest_gap` apart. Nothing is extrapolated. White noise of the rows has half its variance
        halfway between them, so that a filter which is told the rows' noise then expects more than there is.
        """
        t = require_array("t", t, (None,))
        after = np.clip(np.searchsorted(self.t, t), 1, len(self.t) - 1)
        before = after - 1
        span = self.t[after] - self.t[before]
        share = (t - self.t[before]) / span
        near = np.minimum(np.abs(t - self.t[before]), np.abs(t - self.t[after])) <= SAME_TIME
        share = np.where(near, np.round(share), share)
        found = self.v_en[before] + share[:, None] * (self.v_en[after] - self.v_en[before])
        bracketed = (share > 0.0) & (share < 1.0) & (span <= self.longest_gap)
        found[~(near | bracketed)] = np.nan
        return found


@dataclass(frozen=True)
class VelocityFile:
    """A text file with velocity east and north; columns and units as declared.

    Parameters
    ----------
    columns : str
        What the columns hold: t, ve (east), vn (north), between commas; the names say the direction, so that files in
        east-north-up and in north-east-down need no other option. With a header in any order, as ``key`` or
        ``key=name in the header``; without one all columns in their order, ``-`` for one that is not read, such as an
        upward velocity.
    time_unit : {"s", "ms", "us", "ns"}
        Of t, in the recording's clock: s, ms, us or ns; ns are integers.
    velocity_unit : {"m/s", "km/h", "kn"}
        Of ve and vn: m/s, km/h or kn (knots).
    header : bool
        The first line holds the names; a unit in brackets behind a name must agree with the declared one.
    delimiter : {",", ";", "tab", "space"}
        The character, or the word tab or space; "space" is any white space.
    skip : int
        Lines to skip before the header or the first row.
    longest_gap : float, s
        Between rows farther apart than this, s, there is no velocity.

    Raises
    ------
    InputError
        If an option breaks a rule.
    """

    columns: str = ""
    time_unit: str = ""
    velocity_unit: str = ""
    header: bool = True
    delimiter: str = ","
    skip: int = 0
    longest_gap: float = LONGEST_GAP

    def __post_init__(self) -> None:
        self._declared()
        require_flag("header", self.header)
        require_choice("delimiter", self.delimiter, DELIMITERS)
        require_integer("skip", self.skip, minimum=0)
        require_scalar("longest_gap", self.longest_gap, positive=True)

    def _declared(self) -> Columns:
        units = {"t": Unit.declared("time_unit", self.time_unit, TIME)}
        units |= dict.fromkeys(("ve", "vn"), Unit.declared("velocity_unit", self.velocity_unit, SPEED))
        return Columns.parse("columns", self.columns, KEYS, units)

    def read(self, path: str | Path, *, epoch_ns: int = 0) -> VelocityAiding:
        """Return the velocity in a file.

        Parameters
        ----------
        path : path
        epoch_ns : int, ns
            What to subtract from the file's times; give the recording's, so that both have the same t.

        Raises
        ------
        InputError
            If the file is missing, malformed or truncated (file, line and column), holds NaN, has fewer than two rows,
            or its times do not increase.
        """
        path, columns = existing_file(path), self._declared()
        t, data, where, _ = read_columns(
            path, columns, self.delimiter, header=self.header, skip=self.skip, epoch_ns=epoch_ns
        )
        for key, values in {"t": t, **data}.items():
            if not np.isfinite(values).all():
                k = int(np.argmin(np.isfinite(values)))
                name = columns.names[columns.keys.index(key)]
                raise InputError(
                    f"{path}, {where(k)}, column {name!r}: must be finite, got {values[k]}; leave out rows without a "
                    "velocity, gaps are allowed"
                )
        v_en = np.stack([data["ve"], data["vn"]], axis=1)
        require_rows(path, t, v_en, where)
        return VelocityAiding(t, v_en, self.longest_gap, str(path))
