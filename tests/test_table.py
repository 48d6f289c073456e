"""Tables: Parquet round trip bit for bit, Markdown, and files that appear whole or not at all."""

import numpy as np
import pytest

import bench
from bench.table import Table, replacing


@pytest.fixture
def table():
    values = np.array([0.1 + 0.2, np.pi, -0.0, 5e-324])
    return Table({"x": values, "n": np.arange(4), "name": np.array(["a", "b|c", "d", ""])}, "Some numbers")


def test_parquet_keeps_every_bit(table, tmp_path):
    table.write_parquet(tmp_path / "t.parquet")
    back = Table.read_parquet(tmp_path / "t.parquet")
    assert back.title == "Some numbers"
    assert back["x"].tobytes() == table["x"].tobytes()
    for name in ("n", "name"):
        np.testing.assert_array_equal(back[name], table[name])
    assert list(tmp_path.iterdir()) == [tmp_path / "t.parquet"]


def test_markdown(table):
    assert table.markdown().splitlines() == [
        "| x | n | name |",
        "|---|---|---|",
        "| 0.3 | 0 | a |",
        "| 3.142 | 1 | b/c |",
        "| -0 | 2 | d |",
        "| 4.941e-324 | 3 |  |",
    ]


def test_where_and_concatenate(table):
    assert table.where(n=1, name="b|c")["x"] == [np.pi]
    assert len(table.where(n=7)) == 0
    assert len(Table.concatenate([table, table])) == 8


def test_rows_and_columns_agree():
    table = Table.from_rows(("a", "b"), [(1, "x"), (2, "y")])
    assert table["b"].tolist() == ["x", "y"]
    with pytest.raises(bench.InputError, match="columns must be one-dimensional and of one length"):
        Table({"a": np.arange(2), "b": np.arange(3)})


def test_a_failed_write_leaves_the_old_file(tmp_path):
    path = tmp_path / "x.txt"
    path.write_text("old")

    def fail():
        with replacing(path) as temporary:
            temporary.write_text("half")
            raise RuntimeError("power cut")

    with pytest.raises(RuntimeError):
        fail()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_replacing_leaves_nothing_behind_if_the_path_cannot_be_replaced(tmp_path):
    folder = tmp_path / "a-folder"
    (folder / "inside").mkdir(parents=True)
    with pytest.raises(IsADirectoryError), replacing(folder) as temporary:
        temporary.write_text("whole")
    assert list(tmp_path.iterdir()) == [folder]
