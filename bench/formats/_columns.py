"""Declared columns of a text file: found by name in its header, or by place where it has none."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from bench.errors import Array, InputError, UnknownNameError
from bench.formats._text import Layout, as_number, line_after, read_numbers
from bench.formats._times import NANOSECOND, seconds
from bench.formats._units import Unit, recognised

IGNORED = "-"
DELIMITERS = {",": ",", ";": ";", "tab": "\t", "space": None}  # None: any white space


@dataclass(frozen=True)
class Columns:
    """Which column of a file holds what.

    Attributes
    ----------
    keys : tuple of str
        What each declared column holds; "-" is not read.
    names : tuple of str
        Its name in the header.
    units : dict of str to Unit
        Declared unit of each key.
    """

    keys: tuple[str, ...]
    names: tuple[str, ...]
    units: dict[str, Unit]

    @classmethod
    def parse(cls, option: str, text: str, needed: tuple[tuple[str, ...], ...], units: dict[str, Unit]) -> "Columns":
        """Return what an option such as "t,gx=rate x,-,ax" declares.

        Parameters
        ----------
        option : str
            Its name, for messages.
        text : str
            Items between commas: a key, or key=name in the header; without a name the key is the name.
        needed : tuple of tuples of str
            Keys, one of each tuple.
        units : dict of str to Unit

        Raises
        ------
        InputError
            If a key is unknown, missing, or there twice.
        """
        example = ",".join(choice[0] for choice in needed)
        if not text.strip():
            raise InputError(f"{option} must be declared: what the columns hold, such as {example!r}")
        items = [item.partition("=") for item in text.split(",")]
        keys = tuple(key.strip() for key, _, _ in items)
        names = tuple((name if equals else key).strip() for key, equals, name in items)
        known = [key for choice in needed for key in choice]
        for key in keys:
            if key not in known and key != IGNORED:
                raise UnknownNameError(f"key in {option}", key, [*known, IGNORED])
        for choice in needed:
            if (count := sum(key in choice for key in keys)) != 1:
                found = f"{count} times" if count else "not"
                raise InputError(
                    f"{option} must have {' or '.join(choice)} once, such as {example!r}; {found} in {text!r}"
                )
        return cls(keys, names, units)

    def used(self) -> tuple[str, ...]:
        """Return the keys that are read, the time first: it may be an integer."""
        return tuple(sorted((key for key in self.keys if key != IGNORED), key=lambda key: key != "t"))

    def layout(self, path: Path, delimiter: str, *, header: bool, skip: int) -> Layout:
        """Return the layout of a file with these columns.

        Parameters
        ----------
        path : path
        delimiter : str
            One of `DELIMITERS`.
        header : bool
            The first line (after `skip`) holds names, which may have units in brackets behind them.
        skip : int
            Lines before the header or the first row.

        Raises
        ------
        InputError
            If a name is not in the header or there twice, or a unit differs; naming file, line and column.
        """
        separator, integers = DELIMITERS[delimiter], self.units["t"].name == "ns"
        if not header:
            self._refuse_header(path, skip, separator)
            use = tuple(self.keys.index(key) for key in self.used())
            everything = use == tuple(range(len(self.keys)))
            return Layout(self.keys, separator, "#", skip, None if everything else use, integers)
        number, text = line_after(path, skip)
        cells = [cell.strip().strip("\"'") for cell in text.lstrip("#% ").split(separator)]
        where = f"{path}, line {number}"
        if all(as_number(cell) is not None for cell in cells):
            raise InputError(f"{where}: numbers, not names; header=False takes the columns by their place")
        use = tuple(self._place(key, cells, where) for key in self.used())
        return Layout(tuple(cells), separator, "#", number, use, integers)

    def _refuse_header(self, path: Path, skip: int, separator: str | None) -> None:
        number, text = line_after(path, skip)
        if not text.startswith("#") and all(as_number(cell) is None for cell in text.split(separator)):
            raise InputError(f"{path}, line {number}: names, not numbers: {text[:80]!r}; header=True reads them")

    def _place(self, key: str, cells: list[str], where: str) -> int:
        name, unit = self.names[self.keys.index(key)], self.units[key].name
        split = [_split_unit(cell) for cell in cells]
        places = [k for k, cell in enumerate(cells) if name in (cell, split[k][0])]
        if len(places) != 1:
            count = f"{len(places)} times" if places else "not"
            raise InputError(
                f"{where}: column {name!r} for {key} is {count} in the header {', '.join(cells)!r}; "
                f"declare it as {key}=NAME"
            )
        k = places[0]
        said = recognised(split[k][1])
        if said is not None and said != unit:
            raise InputError(
                f"{where}, column {k + 1} ({cells[k]}): the header says {said}, but {unit} is declared for {key}; "
                "correct the one that is wrong"
            )
        return k

    def head(self, delimiter: str) -> str:
        """Return the header line of a file with these columns, units in brackets."""
        separator = DELIMITERS[delimiter]
        space = "" if separator is None else " "
        items = zip(self.keys, self.names, strict=True)
        cells = [name if _split_unit(name)[1] else f"{name}{space}[{self.units[key].name}]" for key, name in items]
        return (separator or " ").join(cells)


class Timed(NamedTuple):
    """Times, the other columns in SI by key, what names a row's line, and the epoch that was subtracted."""

    t: Array
    data: dict[str, Array]
    where: Callable[[int], str]
    epoch_ns: int


def read_columns(
    path: Path, columns: Columns, delimiter: str, *, header: bool, skip: int, epoch_ns: int | None = None
) -> Timed:
    """Return what the declared columns of a file hold; the layout is that of `Columns.layout`.

    Without a given `epoch_ns` it is found for times in nanoseconds, and 0 for others.

    Raises
    ------
    InputError
        If the header or a row is wrong, naming file, line and column.
    """
    table = read_numbers(path, columns.layout(path, delimiter, header=header, skip=skip))
    keys, values = columns.used(), table.values
    if table.integers is None:
        t, found = values[:, 0] * columns.units["t"].size - (epoch_ns or 0) * NANOSECOND, 0
        values = values[:, 1:]
    else:
        t, found = seconds(table.integers, epoch_ns)
    data = {key: column * columns.units[key].size for key, column in zip(keys[1:], values.T, strict=True)}
    return Timed(t, data, table.where, found)


def _split_unit(cell: str) -> tuple[str, str]:
    """Return the name and the unit of a header cell such as "gx [rad/s]" or "gx (rad/s)"."""
    for opening, closing in ("[]", "()"):
        if cell.endswith(closing) and opening in cell:
            name, _, unit = cell[:-1].rpartition(opening)
            return name.strip(), unit
    return cell, ""
