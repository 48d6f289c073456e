"""The commands `solve` and `export`: options of the chosen parts, what is printed, exit codes."""

import json

import numpy as np
import pytest

from bench.cli import main
from bench.formats import file_format
from bench.table import Table
from tests.recorded_cases import LATITUDE, LONGITUDE, as_rates, standing, truth, undrawn

PLACE = ["--latitude-deg", str(np.degrees(LATITUDE)), "--longitude-deg", str(np.degrees(LONGITUDE)), "--height-m", "35"]
ANGLES = [
    "--heading-deg",
    str(-np.degrees(0.4)),
    "--pitch-deg",
    str(np.degrees(-0.05)),
    "--roll-deg",
    "5.729577951308232",
]
VALUES = ["--initial", "values", *PLACE, *ANGLES, "--velocity-enu", "0", "0", "0"]
BASE = ["--format", "kf-gins", "--solver", "navigation-frame"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a recording and its reference; figures are not drawn."""
    monkeypatch.chdir(tmp_path)
    undrawn(monkeypatch)
    file_format("kf-gins").write_imu("imu.txt", standing(500))
    file_format("kf-gins").write_reference("truth.nav", truth(50.0 + np.arange(6)))
    return tmp_path


def test_export_and_solve(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    motion = [
        "export",
        "fast-vehicle",
        "--motion.speed",
        "50",
        "--motion.earth",
        "sphere",
        "--motion.swing",
        "0",
        "0",
        "0",
    ]
    files = ["--out", "imu.csv", "--reference-out", "truth.csv", "--reference-every", "50"]
    units = ["--format.time-unit", "s", "--format.angular-unit", "arcsec", "--format.specific-unit", "m/s"]
    columns = ["--format.columns", "t,gx,gy,gz,ax,ay,az", "--format.axes=FLU", "--format.angle-unit", "deg"]
    reference = ["--format.reference-columns", "t,lat,lon,h,ve,vn,vu,roll,pitch,yaw"]
    csv = ["--format", "csv", *units, *columns, *reference]
    assert main([*motion, *files, *csv, "--rate", "100", "--duration", "5"]) == 0
    assert "recording, 500 increments: " in capsys.readouterr().out
    assert (tmp_path / "truth.csv").read_text().count("\n") == 12
    undrawn(monkeypatch)
    solver = ["--solver=navigation/navigation-frame", "--solver.samples", "5", "--solver.height", "free"]
    out = ["--out", "solved", "--earth", "sphere", "--no-record"]
    assert main(["solve", "imu.csv", *csv, *solver, *out, "--initial", "reference", "--reference", "truth.csv"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    for words in (
        "Errors against the reference",
        "position, horizontal, m",
        "State at the start",
        "interpolated for 0",
    ):
        assert words in printed
    errors = Table.read_parquet(tmp_path / "solved" / "tables" / "errors.parquet")
    assert len(errors) == 11
    # 250 m on a sphere: another Earth would leave 9 m of height, wrong axes or units much more.
    assert max(np.abs(errors[f"position_{name}_m"]).max() for name in ("east", "north", "up")) < 1e-3
    inputs = json.loads((tmp_path / "solved" / "inputs.json").read_text())
    assert inputs["solver"]["samples"] == 5
    assert inputs["recording"]["format"]["angular_unit"] == "arcsec"


def test_values_and_a_reference_in_another_format(folder, capsys):
    reference = ["--reference", "truth.mat", "--reference-format", "psins-mat", "--reference-format.avp", "avp"]
    file_format("psins-mat", avp="avp").write_reference("truth.mat", truth(50.0 + np.arange(6)))
    assert main(["solve", "imu.txt", *BASE, *VALUES, *reference, "--no-record", "--out", "out"]) == 0
    result = json.loads((folder / "out" / "result.json").read_text())
    assert result["increments"]["compared"] == 6
    assert all(row["largest"] < 1e-4 for row in result["errors"])  # m, m/s, deg: a unit that stands
    assert main(["solve", "imu.txt", *BASE, *VALUES, *reference, "--no-record", "--out", "out"]) == 2
    assert "holds a finished run" in capsys.readouterr().err
    assert main(["solve", "imu.txt", *BASE, *VALUES, *reference, "--no-record", "--out", "out", "--force"]) == 0


def test_heading_is_clockwise(folder):
    turned = [*VALUES[: VALUES.index("--heading-deg")], "--heading-deg", "80", *VALUES[VALUES.index("--pitch-deg") :]]
    attitude = ["--format", "kf-gins", "--solver", "rotation-vector"]
    assert main(["solve", "imu.txt", *attitude, *turned, "--no-record", "--out", "out"]) == 0
    states = json.loads((folder / "out" / "result.json").read_text())["states"]
    assert states["start"]["heading, deg"] == pytest.approx(80.0, abs=1e-9)
    table = Table.read_parquet(folder / "out" / "tables" / "trajectory.parquet")
    w, x, y, z = (table[f"q_nb_{k}"][0] for k in "wxyz")
    east, north = 2 * (x * y - w * z), 1 - 2 * (x * x + z * z)  # the forward axis in n
    assert np.degrees(np.arctan2(east, north)) == pytest.approx(80.0, abs=1e-9)


def test_a_file_of_values_alignment_and_a_rule(folder):
    rates = as_rates(standing(1000))
    file_format("euroc", axes="FLU").write_imu("data.csv", rates)
    euroc = ["solve", "data.csv", "--format", "euroc", "--format.axes", "FLU", "--no-record"]
    euroc += ["--solver", "navigation-frame", "--rule", "simpson"]
    limits = ["--heading-limit-deg", "90", "--gyro-sigma-deg-per-h", "0.01"]
    assert main([*euroc, "--initial", "coarse", "--seconds", "8", *PLACE, *limits, "--out", "coarse"]) == 0
    result = json.loads((folder / "coarse" / "result.json").read_text())
    assert result["increments"] == {"skipped": 400, "solved": 100, "left_over": 0}  # Simpson's are of 2 dt
    assert result["states"]["start"]["heading, deg"] == pytest.approx(360 - np.degrees(0.4), abs=1e-3)
    names = {"latitude_deg": 10.0, "longitude_deg": 20.0, "height_m": 30.0, "velocity_enu": [1, 2, 3]}
    (folder / "start.json").write_text(json.dumps({**names, "heading_deg": 40.0, "pitch_deg": 5.0, "roll_deg": 6.0}))
    assert main([*euroc, "--initial", "file", "--file", "start.json", "--out", "file"]) == 0
    states = json.loads((folder / "file" / "result.json").read_text())["states"]
    assert states["start"]["longitude, deg"] == pytest.approx(20.0, abs=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["imu.txt", "--format", "kfgins", "--solver", "x"], "unknown format 'kfgins' (did you mean 'kf-gins'?)"),
        (["imu.txt", "--format", "kf-gins", "--solver", "navigate"], "unknown solver 'navigate'"),
        (
            ["imu.txt", *BASE, "--initial", "start.toml"],
            "valid: coarse, file, header, inertial, reference, values; values",
        ),
        (["imu.txt", *BASE, "--reference-format", "nav"], "unknown reference_format 'nav'"),
        (["no.txt", *BASE, *VALUES, "--out", "x"], "path must be a file, got 'no.txt'"),
        (["imu.txt", *BASE, *VALUES, "--pitch-deg", "100", "--out", "x"], "pitch_deg must be within +-90, got 100.0"),
        (["imu.txt", *BASE, *VALUES, "--rule", "simpson", "--out", "x"], "rule must not be given"),
        (["imu.txt", *BASE, "--initial", "reference", "--out", "x"], "initial 'reference' needs a reference"),
        (["imu.txt", *BASE, *VALUES, "--reference", "imu.txt", "--out", "x"], "imu.txt, line 1"),
        (["imu.txt", *BASE, *VALUES, "--out", "/dev/null/x"], "out '/dev/null/x' cannot be written"),
    ],
)
def test_bad_input_of_solve_is_exit_code_2_with_one_line(arguments, message, folder, capsys):
    before = sorted(folder.rglob("*"))
    assert main(["solve", *arguments]) == 2
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("strapbench: ")]
    assert len(lines) == 1
    assert message in lines[0]
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["coning", "--format", "kf-gins"], "unknown motion on the Earth 'coning'"),
        (["waypoints", "--format", "kf-gins"], "motion 'waypoints' takes arrays (t), which cannot be typed"),
        (["earth-rest", "--format", "kf-gin"], "unknown format 'kf-gin'"),
        (
            ["earth-rest", "--format", "kf-gins", "--rate", "100", "--duration", "1", "--out", "imu.txt"],
            "'imu.txt' exists: choose another name",
        ),
        (
            [
                "earth-rest",
                "--format",
                "kf-gins",
                "--rate",
                "100",
                "--duration",
                "1",
                "--out",
                "x",
                "--grade",
                "tactical",
            ],
            "seed and grade must be given together",
        ),
    ],
)
def test_bad_input_of_export_is_exit_code_2_with_one_line(arguments, message, folder, capsys):
    assert main(["export", *arguments]) == 2
    assert message in capsys.readouterr().err.splitlines()[-1]
    assert not (folder / "x").exists()


@pytest.mark.parametrize(
    "arguments",
    [
        ["solve", "imu.txt", *BASE, "--out", "x"],  # no initial state
        ["solve", "imu.txt", *BASE, *VALUES, "--out", "x", "--solver.samples", "9"],
        ["solve", "imu.txt", *BASE, "--initial", "values", *PLACE, "--out", "x"],  # no attitude, no velocity
        ["solve", "imu.txt", *BASE, *VALUES, "--out", "x", "--yaw-deg", "100"],
        ["solve", "imu.txt", *BASE, *VALUES, "--out", "x", "--earth", "flat"],
        ["export", "earth-rest", "--format", "kf-gins", "--out", "x"],  # no rate
        ["export", "earth-rest", "--motion.latitude", "50", "--format", "kf-gins", "--out", "x"],
    ],
)
def test_wrong_usage_is_exit_code_2(arguments, folder):
    with pytest.raises(SystemExit, match="2"):
        main(arguments)
    assert not (folder / "x").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["solve", "--help"], ["--format", "--solver", "--initial"]),
        (["solve", "--format", "psins-mat", "--initial", "coarse", "--help"], ["--format.avp", "--seconds"]),
        (["solve", "--solver", "navigation-frame", "--help"], ["--solver.samples", "--solver.height"]),
        (["export", "--help"], ["--reference-out"]),
        (["export", "fast-vehicle", "--help"], ["--motion.speed", "--motion.earth {wgs84,"]),
    ],
)
def test_help_shows_the_options_of_what_is_chosen(arguments, words, capsys):
    with pytest.raises(SystemExit, match="0"):
        main(arguments)
    printed = capsys.readouterr().out
    assert all(word in printed for word in words)


def test_list_names_formats_and_initial_states(capsys):
    assert main(["list"]) == 0
    printed = capsys.readouterr().out
    for name in ("kf-gins", "euroc", "psins-mat", "coarse", "reference", "navigation-frame", "fast-vehicle"):
        assert f"\n  {name} " in printed
