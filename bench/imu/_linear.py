"""A 3 x 3 matrix times many rows, with the same bits for any number of rows (BLAS does not promise that)."""

from bench.errors import Array


def transform(matrix: Array, rows: Array) -> Array:
    """Return matrix @ row for every row, shape (n, 3)."""
    result: Array = rows[:, :1] * matrix[:, 0]
    result += rows[:, 1:2] * matrix[:, 1]
    result += rows[:, 2:] * matrix[:, 2]
    return result
