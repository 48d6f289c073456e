"""The built wheel, installed into a clean environment, runs from outside the repository."""

import json
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def run(*command, cwd):
    result = subprocess.run([str(c) for c in command], cwd=cwd, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dist")
    run(sys.executable, "-m", "build", "--wheel", "--outdir", folder, ROOT, cwd=folder)
    (path,) = folder.glob("*.whl")
    return path


@pytest.mark.slow
def test_wheel_holds_the_models_and_nothing_foreign(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    models = {path.name for path in (ROOT / "models").glob("*.xml")}
    assert {Path(n).name for n in names if n.startswith("bench/models/")} == models
    assert {n.split("/")[0] for n in names if ".dist-info" not in n} == {"bench"}


@pytest.mark.slow
def test_installed_wheel_runs_a_short_job(wheel, tmp_path):
    venv.create(tmp_path / "venv", with_pip=True)
    python = tmp_path / "venv" / "bin" / "python"
    run(python, "-m", "pip", "install", "--quiet", wheel, cwd=tmp_path)
    code = (
        "import bench, numpy as np; from bench.motion.rest import Rest; from bench.mjcf import models_dir;"
        "print(models_dir()); print(bench.Rig.load('imu').sample(Rest(), np.arange(2.0)).accelerometers[0, 2])"
    )
    folder, reading = run(python, "-c", code, cwd=tmp_path).split()
    assert Path(folder).is_relative_to(tmp_path / "venv")
    assert float(reading) == 9.80665
    command = (tmp_path / "venv" / "bin" / "strapbench", "run", "gyro-free-circular", "--trials", "2")
    printed = run(*command, "--duration", "6", "--jobs", "1", "--out", "short", cwd=tmp_path)
    assert "nine, attitude x" in printed
    assert json.loads((tmp_path / "short" / "result.json").read_text())["options"]["trials"] == 2
    assert (tmp_path / "short" / "recording.rrd").stat().st_size > 10_000
