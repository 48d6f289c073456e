"""Tables: named columns of equal length, to and from Parquet, to Markdown and to the terminal."""

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.errors import InputError

Column = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Table:
    """Named columns of equal length.

    Attributes
    ----------
    columns : dict of str to ndarray, shape (n,)
    title : str
        What the table shows; units are in the column names or in the title.
    """

    columns: dict[str, Column]
    title: str = ""

    def __post_init__(self) -> None:
        columns = {name: np.asarray(column) for name, column in self.columns.items()}
        lengths = {name: column.shape for name, column in columns.items()}
        if any(len(shape) != 1 for shape in lengths.values()) or len(set(lengths.values())) > 1:
            raise InputError(f"columns must be one-dimensional and of one length, got {lengths}")
        object.__setattr__(self, "columns", columns)

    @classmethod
    def from_rows(cls, names: Sequence[str], rows: Iterable[Sequence[Any]], title: str = "") -> "Table":
        """Return the table of the given rows."""
        rows = list(rows)
        return cls({name: np.array([row[k] for row in rows]) for k, name in enumerate(names)}, title)

    @classmethod
    def concatenate(cls, tables: Sequence["Table"]) -> "Table":
        """Return the rows of all tables, one after another; their columns must have the same names."""
        names = list(tables[0].columns)
        return cls({name: np.concatenate([t.columns[name] for t in tables]) for name in names}, tables[0].title)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def __getitem__(self, name: str) -> Column:
        return self.columns[name]

    def where(self, **values: Any) -> "Table":
        """Return the rows in which the named columns have the given values."""
        keep = np.ones(len(self), dtype=bool)
        for name, value in values.items():
            keep &= self.columns[name] == value
        return Table({name: column[keep] for name, column in self.columns.items()}, self.title)

    def cells(self) -> list[list[str]]:
        """Return the rows as text, numbers with four significant digits."""
        return [[_text(value) for value in row] for row in zip(*self.columns.values(), strict=True)]

    def write_parquet(self, path: Path) -> None:
        """Write the table; the file appears whole or not at all."""
        import pyarrow
        import pyarrow.parquet

        def plain(column: Column) -> Any:
            return column if column.dtype in (np.float64, np.int64) else column.tolist()  # else slow

        data = pyarrow.table({name: pyarrow.array(plain(column)) for name, column in self.columns.items()})
        data = data.replace_schema_metadata({"title": self.title})
        with replacing(path) as temporary:
            pyarrow.parquet.write_table(data, temporary)

    @classmethod
    def read_parquet(cls, path: Path) -> "Table":
        """Return a table written by `write_parquet`."""
        import pyarrow.parquet

        data = pyarrow.parquet.read_table(path)
        title = (data.schema.metadata or {}).get(b"title", b"").decode()
        columns = {name: np.array(data.column(name).to_pylist()) for name in data.column_names}
        return cls(columns, title)

    def markdown(self) -> str:
        """Return a Markdown table."""
        head = "| " + " | ".join(self.columns) + " |\n|" + "---|" * len(self.columns)
        return "\n".join([head, *("| " + " | ".join(row) + " |" for row in self.cells())])


def _text(value: Any) -> str:
    if isinstance(value, (float, np.floating)):
        return f"{value:.4g}"
    return str(value).replace("|", "/")


class replacing:
    """A temporary path beside `path` that replaces it when the block succeeds; nothing is left behind if it fails."""

    def __init__(self, path: Path):
        self.path = path
        self.temporary = path.with_name(f".{path.name}.{os.getpid()}.part")

    def __enter__(self) -> Path:
        return self.temporary

    def __exit__(self, kind: object, *_: object) -> None:
        try:
            if kind is None:
                os.replace(self.temporary, self.path)
        finally:
            self.temporary.unlink(missing_ok=True)
