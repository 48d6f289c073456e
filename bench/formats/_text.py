"""Tables of numbers in text files: read at C speed, errors found by line and column, written with every digit."""

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array, BenchWarning, InputError

ROWS = 8192  # written at a time


@dataclass(frozen=True)
class Layout:
    """How the rows of a text file are laid out.

    Attributes
    ----------
    names : tuple of str
        One per column, for messages.
    delimiter : str, optional
        None is any white space.
    comment : str, optional
        What starts a comment.
    skip : int
        Lines before the first row.
    use : tuple of int, optional
        Columns to read, in order; the others may hold anything. None reads all, and then their number must be right.
    integers : bool
        The first column read is a 64-bit integer.
    """

    names: tuple[str, ...]
    delimiter: str | None = None
    comment: str | None = None
    skip: int = 0
    use: tuple[int, ...] | None = None
    integers: bool = False

    @property
    def read(self) -> tuple[str, ...]:
        """Names of the columns that are read, in the order in which they come."""
        return self.names if self.use is None else tuple(self.names[k] for k in self.use)

    def cells(self, line: str) -> list[str]:
        """Return the cells of a line without its comment; none for a blank one."""
        text = line.split(self.comment, 1)[0] if self.comment else line
        return [cell.strip() for cell in text.split(self.delimiter)] if text.strip() else []


@dataclass(frozen=True, eq=False)
class Numbers:
    """What `read_numbers` found.

    Attributes
    ----------
    values : ndarray, shape (n, k)
    integers : ndarray of int64, shape (n,), or None
        The first column, if the layout says that it holds integers; `values` is then the rest.
    """

    values: Array
    integers: NDArray[np.int64] | None
    path: Path
    layout: Layout

    def where(self, row: int) -> str:
        """Return the line of a row, for messages; reads the file again."""
        number, _ = next(islice(_rows(self.path, self.layout), row, None))
        return f"line {number}"


def read_numbers(path: Path, layout: Layout) -> Numbers:
    """Return the numbers in a text file; NaN and infinities are left to the caller.

    Raises
    ------
    InputError
        If there are no rows, or a row has too few or too many columns or something that is no number, naming file,
        line and column.

    Warns
    -----
    BenchWarning
        If the last line has no end: it may be cut within its last number.
    """
    width = len(layout.read)
    dtype: Any = [("integer", np.int64), ("values", np.float64, (width - 1,))] if layout.integers else np.float64
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)  # how loadtxt says that there is nothing
            table = np.loadtxt(
                str(path),
                dtype=dtype,
                comments=layout.comment,
                delimiter=layout.delimiter,
                skiprows=layout.skip,
                usecols=layout.use,
                encoding="utf-8-sig",
                ndmin=1 if layout.integers else 2,
            )
        values = table["values"] if layout.integers else table
        if not layout.integers and values.shape[1] != width:
            raise ValueError(f"{values.shape[1]} columns instead of {width}")
    except (ValueError, UserWarning) as error:
        raise _located(path, layout) or InputError(f"{path}: {error}") from None
    _warn_of_open_end(path)
    return Numbers(np.ascontiguousarray(values), table["integer"].copy() if layout.integers else None, path, layout)


def line_after(path: Path, skip: int) -> tuple[int, str]:
    """Return number and text of the first line after `skip` ones that is not blank.

    Raises
    ------
    InputError
        If there is none.
    """
    for number, line in islice(_lines(path), skip, None):
        if line.strip():
            return number, line.strip()
    raise InputError(f"{path}: the file is empty" + (f" after {skip} lines" if skip else ""))


def as_number(cell: str) -> float | None:
    """Return the number in a cell, or None if it holds none."""
    try:
        return None if "_" in cell else float(cell)
    except ValueError:
        return None


def write_numbers(path: Path, head: Sequence[str], columns: Sequence[NDArray[Any]], delimiter: str) -> None:
    """Write lines of text and columns of numbers, each with as many digits as give the same number when read."""
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.writelines(line + "\n" for line in head)
        for start in range(0, len(columns[0]), ROWS):
            rows = zip(*(column[start : start + ROWS].tolist() for column in columns), strict=True)
            file.writelines(delimiter.join(map(repr, row)) + "\n" for row in rows)


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        yield from enumerate(file, start=1)


def _rows(path: Path, layout: Layout) -> Iterator[tuple[int, list[str]]]:
    for number, line in islice(_lines(path), layout.skip, None):
        if cells := layout.cells(line):
            yield number, cells


def _located(path: Path, layout: Layout) -> InputError | None:
    """Return the error of the first row that is wrong."""
    number = 0
    for number, cells in _rows(path, layout):
        if (fault := _fault(cells, layout)) is not None:
            return InputError(f"{path}, line {number}, column {fault}")
    return None if number else InputError(f"{path}: no rows of numbers")


def _fault(cells: list[str], layout: Layout) -> str | None:
    """Return which column of a row is wrong, and how."""
    names, used = layout.names, layout.use or range(len(layout.names))
    found = f"the line has {len(cells)} columns: {' '.join(cells)[:80]!r}, expected {len(names)}"
    for k in sorted(used):
        if k >= len(cells):
            return f"{k + 1} ({names[k]}): missing; {found} (a truncated file, or another format?)"
        integer = layout.integers and k == used[0]
        if as_number(cells[k]) is None or (integer and not cells[k].lstrip("+-").isdecimal()):
            return f"{k + 1} ({names[k]}): not {'an integer' if integer else 'a number'}: {cells[k][:40]!r}"
    if layout.use is None and len(cells) > len(names):
        return f"{len(names) + 1}: one too many; {found}: {', '.join(names)}"
    return None


def _warn_of_open_end(path: Path) -> None:
    with path.open("rb") as file:
        file.seek(-1, 2)
        if file.read(1) not in (b"\n", b"\r"):
            warnings.warn(
                f"{path}: the last line has no line end; if the file was cut, its last number is wrong",
                BenchWarning,
                stacklevel=2,
            )
