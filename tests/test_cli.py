"""The command line: what it prints, its exit codes, and Ctrl-C."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

import bench
from bench.cli import main


def test_list_names_everything(capsys):
    assert main(["list"]) == 0
    printed = capsys.readouterr().out
    for name in (
        *("gyro-free-circular", "coning", "spline", "nine_accelerometer", "twelve_accelerometer"),
        *("six-accelerometer", "array-least-squares"),
    ):
        assert f"\n  {name} " in printed
    assert all(len(line) < 130 for line in printed.splitlines())


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"strapbench {bench.__version__}\n"


def test_run_prints_the_table_and_the_places(capsys, tmp_path):
    out = tmp_path / "r"
    arguments = ["run", "gyro-free-circular", "--trials", "1", "--duration", "4", "--jobs", "1", "--no-record"]
    assert main([*arguments, "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "published against measured" in " ".join(printed.split())
    assert "nine, attitude x" in printed
    for name in ("report.html", "report.md", "figures"):
        assert str(out / name) in printed.replace("\n", "")
    assert not (out / "recording.rrd").exists()
    assert main([*arguments, "--out", str(out)]) == 2
    assert "--force" in capsys.readouterr().err
    assert main([*arguments, "--out", str(out), "--force"]) == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "gyro-free-circle", "--out", "x"], "did you mean 'gyro-free-circular'"),
        (["run", "gyro-free-circular", "--out", "x", "--trials", "0"], "trials must be an integer >= 1, got 0"),
        (["run", "gyro-free-circular", "--out", "x", "--seed", "-1"], "seed must be an integer >= 0, got -1"),
        (["run", "gyro-free-circular", "--out", "/dev/null/x"], "out '/dev/null/x' cannot be written"),
        (["view", "nothing.rrd"], "recording 'nothing.rrd' is not a file"),
    ],
)
def test_bad_input_is_exit_code_2_with_one_line(arguments, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "arguments", [["run", "gyro-free-circular"], ["run", "gyro-free-circular", "--out", "x", "--trails", "3"], ["fly"]]
)
def test_wrong_usage_is_exit_code_2(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit, match="2"):
        main(arguments)


def test_a_folder_may_have_the_name_of_the_experiment(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    options = ["--trials", "1", "--duration", "4", "--jobs", "1", "--no-record"]
    assert main(["run", "gyro-free-circular", "--out", "gyro-free-circular", *options]) == 0
    assert main(["run", "--out", "gyro-free-circular", "--force", *options, "gyro-free-circular"]) == 0
    assert (tmp_path / "gyro-free-circular" / "result.json").exists()


def test_ctrl_c_after_the_work_says_that_it_is_kept(tmp_path, monkeypatch, capsys):
    import bench.output

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(bench.output, "_result", interrupt)
    options = ["--trials", "1", "--duration", "4", "--jobs", "1", "--no-record", "--out", str(tmp_path / "r")]
    assert main(["run", "gyro-free-circular", *options]) == 1
    assert "all 8 parts are finished and kept in" in capsys.readouterr().err
    assert len(list((tmp_path / "r" / "parts").glob("*.parquet"))) == 8
    monkeypatch.undo()
    assert main(["run", "gyro-free-circular", *options]) == 0


def test_failure_is_exit_code_1(tmp_path, capsys, monkeypatch):
    import bench.runner
    from bench.campaign import CampaignError

    def fail(*_, **__):
        raise CampaignError("item x failed 2 times")

    monkeypatch.setattr(bench.runner, "run_campaign", fail)
    assert main(["run", "gyro-free-circular", "--out", str(tmp_path / "r")]) == 1
    assert "item x failed" in capsys.readouterr().err


@pytest.mark.slow
def test_ctrl_c_keeps_finished_parts_and_the_run_can_be_continued(tmp_path):
    out = tmp_path / "r"
    command = [sys.executable, "-m", "bench.cli", "run", "gyro-free-circular", "--out", str(out), "--no-record"]
    command += ["--trials", "100", "--jobs", "2"]
    child = subprocess.Popen(
        command,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # A shell's background job, and so its children, would ignore it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    deadline = time.monotonic() + 60
    while len(list(out.glob("parts/*.parquet"))) < 3:
        assert time.monotonic() < deadline
        assert child.poll() is None
        time.sleep(0.02)
    os.killpg(child.pid, signal.SIGINT)  # what a terminal does: the workers get it too
    _, error = child.communicate(timeout=30)
    assert child.returncode == 1
    assert "of 44 parts are finished and kept in" in error.replace("\n", " ")
    assert "Traceback" not in error
    finished = {path: path.stat().st_mtime_ns for path in out.glob("parts/*.parquet")}
    assert 3 <= len(finished) < 44
    assert not list(out.glob("parts/.*"))
    resumed = subprocess.run(command, capture_output=True, text=True)
    assert resumed.returncode == 0, resumed.stderr
    assert json.loads((out / "result.json").read_text())["options"]["trials"] == 100
