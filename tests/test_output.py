"""The folder of a run: nothing is overwritten, an interrupted run is continued, everything arrives whole."""

import json
import sys
from pathlib import Path

import pytest

import bench
from bench.output import RunFolder

INPUTS = {"experiment": "x", "options": {"trials": 3}, "seed": 0}


def test_new_folder_is_made_with_its_inputs(tmp_path):
    folder = RunFolder.open(tmp_path / "a" / "b", INPUTS)
    assert json.loads((folder.path / "inputs.json").read_text()) == INPUTS


def test_interrupted_run_is_continued(tmp_path):
    parts = RunFolder.open(tmp_path, INPUTS).parts
    parts.mkdir()
    (parts / "p.parquet").write_text("part")
    assert RunFolder.open(tmp_path, INPUTS).parts == parts
    assert (parts / "p.parquet").read_text() == "part"


def test_interrupted_run_with_other_inputs_is_refused(tmp_path):
    RunFolder.open(tmp_path, INPUTS).parts.mkdir()
    other = {**INPUTS, "seed": 5, "options": {"trials": 4}}
    with pytest.raises(bench.InputError, match=r"other inputs \(options.trials 3, now 4; seed 0, now 5\)"):
        RunFolder.open(tmp_path, other)
    RunFolder.open(tmp_path, other, force=True)
    assert not (tmp_path / "parts").exists()


def test_finished_run_needs_force(tmp_path):
    folder = RunFolder.open(tmp_path, INPUTS)
    (folder.path / "result.json").write_text("{}")
    (folder.path / "report.md").write_text("precious")
    with pytest.raises(bench.InputError, match=r"holds a finished run.*--force"):
        RunFolder.open(tmp_path, INPUTS)
    assert (folder.path / "report.md").read_text() == "precious"
    RunFolder.open(tmp_path, INPUTS, force=True)
    assert [path.name for path in tmp_path.iterdir()] == ["inputs.json"]


@pytest.mark.parametrize("force", [False, True])
def test_foreign_folder_is_never_touched(tmp_path, force):
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(bench.InputError, match=r"not a run of strapbench \(it holds 'thesis.tex'\)"):
        RunFolder.open(tmp_path, INPUTS, force=force)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_a_users_file_among_ours_is_named_and_kept(tmp_path):
    folder = RunFolder.open(tmp_path, INPUTS)
    (folder.path / "tables").mkdir()
    (folder.path / "tables" / "my_notes.txt").write_text("mine")
    with pytest.raises(bench.InputError, match=r"it holds 'tables/my_notes.txt'"):
        RunFolder.open(tmp_path, INPUTS, force=True)
    assert (folder.path / "tables" / "my_notes.txt").read_text() == "mine"


def test_damaged_inputs(tmp_path):
    (RunFolder.open(tmp_path, INPUTS).path / "inputs.json").write_text("{")
    with pytest.raises(bench.InputError, match=r"inputs.json is damaged: --force starts it anew"):
        RunFolder.open(tmp_path, INPUTS)
    RunFolder.open(tmp_path, INPUTS, force=True)


def test_out_is_a_file(tmp_path):
    (tmp_path / "f").write_text("")
    with pytest.raises(bench.InputError, match=r"out '.*/f' cannot be written"):
        RunFolder.open(tmp_path / "f", INPUTS)
    with pytest.raises(bench.InputError, match=r"out '.*/f/g' cannot be written: Not a directory"):
        RunFolder.open(tmp_path / "f" / "g", INPUTS)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs a file system that refuses even the superuser")
def test_out_where_nothing_can_be_written():
    with pytest.raises(bench.InputError, match="out '/proc/strapbench' cannot be written"):
        RunFolder.open(Path("/proc/strapbench"), INPUTS)
