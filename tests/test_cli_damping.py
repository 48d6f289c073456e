"""Damping on the command line: a simulated ship, its log as a file, and what is in the folder then."""

import json
import re

import numpy as np
import pytest

from bench.cli import main
from bench.table import Table
from bench.units import ARCMIN, DEG_PER_H, DEG_PER_SQRT_H, MICRO_G
from tests.recorded_cases import undrawn
from tests.recording_cases import column, entities, static_text


def words(*texts: str) -> list[str]:
    return " ".join(texts).split()


CSV = words(
    "--format csv --format.time-unit s --format.angular-unit rad --format.specific-unit m/s --format.axes RFU",
    "--format.columns t,gx,gy,gz,ax,ay,az --format.angle-unit deg",
    "--format.reference-columns t,lat,lon,h,ve,vn,vu,roll,pitch,yaw",
)
SHIP = words(
    "great-circle --motion.speed 12 --motion.latitude 0.8 --motion.height 0 --motion.azimuth 0.9 --motion.earth sphere",
    "--motion.swing 0.02 0.03 0.08 --motion.swing-frequency 0.5 0.8 0.63 --motion.swing-phase 0 0 0",
)
COLUMNS = words("--aiding log.csv --aiding-format.columns t,ve,vn")
LOG = [*COLUMNS, *words("--aiding-format.time-unit s --aiding-format.velocity-unit kn")]
HELD = words("--solver navigation-frame --solver.height held --earth sphere")
# At the ship's start, with errors: 0.1 m/s each way, 0.7' of roll and pitch, 7' of heading.
START = words(
    "--initial values --latitude-deg 45.836623610465864 --longitude-deg 126 --height-m 0 --velocity-enu 9.5 7.56 0",
    "--heading-deg 51.683 --pitch-deg 0.0117 --roll-deg -0.0117",
)
COUNT = 1200


@pytest.fixture(scope="module")
def sea(tmp_path_factory):
    """A ship that rolls, pitches and yaws for 20 minutes, sensors of a grade, and its log with 2 cm/s of noise."""
    folder = tmp_path_factory.mktemp("sea")
    out = ["--out", str(folder / "imu.csv"), "--reference-out", str(folder / "truth.csv"), "--reference-every", "10"]
    grade = ["--grade", "zhao", "--seed", "3"]
    assert main(["export", *SHIP, *CSV, "--rate", "10", "--duration", str(COUNT), *grade, *out]) == 0
    true = np.loadtxt(folder / "truth.csv", delimiter=",", skiprows=1)
    noise = np.random.default_rng(1).normal(0, 0.02, (COUNT + 1, 2))
    kept = (true[:, 0] < 500) | (true[:, 0] > 520)
    rows = np.column_stack([true[:, 0], (true[:, 4:6] + noise) / (1852 / 3600)])[kept]
    np.savetxt(folder / "log.csv", rows, delimiter=",", header="t,ve,vn", comments="", fmt="%.9g")
    return folder


@pytest.fixture
def folder(sea, monkeypatch, tmp_path):
    monkeypatch.chdir(sea)
    return tmp_path


@pytest.fixture(scope="module")
def solved(sea, tmp_path_factory):
    """The folder of one run, with everything drawn."""
    folder = tmp_path_factory.mktemp("solved")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(sea)
        model = ["--filter.model.reference-noise-m-per-s", "0.02", "--filter.covariance-every", "600"]
        options = [*CSV, *HELD, *START, "--reference", "truth.csv", *LOG, "--filter", "double-filter", *model]
        assert main(["solve", "imu.csv", *options, "--out", str(folder)]) == 0
    return folder


def test_free_and_damped_are_both_written(solved):
    expected = {"trajectory", "errors", "damped", "damped_errors", "filter"}
    assert {path.stem for path in (solved / "tables").iterdir()} == expected
    free, damped = (Table.read_parquet(solved / "tables" / f"{name}.parquet") for name in ("trajectory", "damped"))
    assert list(free.columns) == list(damped.columns)
    np.testing.assert_array_equal(free["t_s"], damped["t_s"])
    table = Table.read_parquet(solved / "tables" / "filter.parquet")
    np.testing.assert_allclose(table["t_s"], np.arange(COUNT + 1), atol=1e-9)
    missing = np.flatnonzero(np.isnan(table["v_ref_east_m_per_s"]))
    np.testing.assert_array_equal(missing, np.arange(500, 521))
    np.testing.assert_allclose(table["v_ref_east_m_per_s"][0], 9.4, atol=0.1)  # m/s of a file in knots
    # The correction at a step is what the filter estimates.
    np.testing.assert_allclose(
        (free["velocity_east_m_per_s"] - damped["velocity_east_m_per_s"])[::5], table["dv_E_m_per_s"], atol=1e-6
    )
    names = ("sigma_phi_U_rad", "nis_velocity_error", "nis_velocity_change", "gamma", "share_of_velocity_error_in_dv_E")
    for name in names:
        assert np.isfinite(table[name]).any(), name


def test_damping_makes_the_errors_smaller(solved):
    result = json.loads((solved / "result.json").read_text())
    free, damped = ({row["error"]: row for row in rows} for rows in (result["errors"], result["damping"]["errors"]))
    # Free: 0.7' of tilt makes 0.002 m/s^2, 1 m/s or so until the Schuler oscillation turns it round.
    assert free["velocity, horizontal, m/s"]["RMS"] > 0.3
    assert damped["velocity, horizontal, m/s"]["RMS"] < 0.1 * free["velocity, horizontal, m/s"]["RMS"]
    assert damped["position, horizontal, m"]["final"] < 0.2 * free["position, horizontal, m"]["final"]
    assert damped["attitude, level, deg"]["final"] < 0.5 * free["attitude, level, deg"]["final"]
    first, second = result["damping"]["stages"]
    assert (first["filter"], first["measurements"], first["rejected"]) == ("velocity-error", COUNT + 1 - 21, 0)
    assert first["mean NIS"] == pytest.approx(2.0, abs=0.25)  # four sigma of a mean of 1180
    assert second["filter"] == "velocity-change"


def test_what_is_used_is_kept_and_said(solved):
    inputs = json.loads((solved / "inputs.json").read_text())
    assert inputs["aiding"]["format"]["velocity_unit"] == "kn"
    assert inputs["filter"]["name"] == "double-filter"
    assert inputs["filter"]["model"]["reference_noise"] == 0.02
    report = (solved / "report.md").read_text()
    for text in (
        "navigation-frame, free",
        "double-filter, damped",
        "1 gap longer than 2.5 s: a velocity was available at 1180 of 1201 steps",
    ):
        assert text in report
    ends = json.loads((solved / "result.json").read_text())["states"]
    damped = Table.read_parquet(solved / "tables" / "damped.parquet")
    assert ends["end_damped"]["velocity north, m/s"] == damped["velocity_north_m_per_s"][-1]
    assert ends["end"]["velocity north, m/s"] != ends["end_damped"]["velocity north, m/s"]
    assert "end by double-filter, damped" in report
    assert "end by double-filter, damped" in static_text(solved / "recording.rrd", "/results")
    figures = {path.stem for path in (solved / "figures").iterdir()}
    assert figures == {"track", "velocity", "attitude", "errors", "estimated_errors", "innovations"}


def test_the_recording_shows_free_damped_and_filter(solved):
    path = solved / "recording.rrd"
    found = entities(path)
    for part in ("navigation\\-frame", "double\\-filter", "0_truth"):
        assert {name.replace("\\-", "-") for name in found} >= {
            f"/map/paths/{part}".replace("\\-", "-"),
            f"/track/paths/{part}".replace("\\-", "-"),
        }
    assert {"/filter/gamma/0", "/filter/share/0", "/filter/nis_velocity-error/0", "/filter/dv_E/0"} <= found
    table = Table.read_parquet(solved / "tables" / "filter.parquet")
    ns, estimated = column(path, "/filter/phi_U/3", "Scalars:scalars", 1)
    np.testing.assert_array_equal(ns, np.arange(COUNT + 1) * 1_000_000_000)
    np.testing.assert_allclose(estimated[:, 0], table["phi_U_rad"] / ARCMIN, atol=1e-9)
    _, high = column(path, "/filter/phi_U/0", "Scalars:scalars", 1)
    np.testing.assert_allclose((high - estimated)[:, 0], 3 * table["sigma_phi_U_rad"] / ARCMIN, atol=1e-9)
    assert "double-filter, damped" in static_text(path, "/results")


def test_noises_are_typed_in_the_units_of_their_names(folder, monkeypatch):
    undrawn(monkeypatch)
    typed = {"heading-arcmin": 10, "gyro-bias-deg-per-h": 0.02, "velocity-noise-micro-g-per-sqrt-hz": 5}
    typed |= {"attitude-noise-deg-per-sqrt-h": 0.003, "accelerometer-bias-micro-g": 100, "tau-f-s": 1800}
    noises = [word for name, value in typed.items() for word in (f"--filter.model.{name}", str(value))]
    chosen = ["--filter", "bias-augmented", "--filter.reference-bias", "0.1", "--filter.gate", "0.999", *noises]
    out = ["--no-record", "--out", str(folder / "out")]
    assert main(["solve", "imu.csv", *CSV, *HELD, *START, *LOG, *chosen, *out]) == 0
    found = json.loads((folder / "out" / "inputs.json").read_text())["filter"]
    assert (found["reference_bias"], found["gate"], found["reference_tau"]) == (0.1, 0.999, "inf")
    model = found["model"]
    expected = {"heading": 10 * ARCMIN, "gyro_bias": 0.02 * DEG_PER_H, "velocity_noise": 5 * MICRO_G, "tau_f": 1800.0}
    expected |= {"attitude_noise": 0.003 * DEG_PER_SQRT_H, "accelerometer_bias": 100 * MICRO_G}
    assert {name: model[name] for name in expected} == expected
    from bench.solvers.damping import DampingModel

    untouched = vars(DampingModel()).keys() - expected.keys()
    assert {name: model[name] for name in untouched} == {name: vars(DampingModel())[name] for name in untouched}
    assert json.loads((folder / "out" / "result.json").read_text())["damping"]["errors"] is None


@pytest.mark.parametrize(
    ("name", "unit", "chosen", "message"),
    [
        ("time", "ms", "velocity-error", "a velocity was available at 2 of 1201 steps only"),
        ("velocity", "m/s", "double-filter", "the mean NIS of velocity-change is "),
        ("velocity", "m/s", "bias-augmented", "the first velocity is 11."),  # (1/0.5144 - 1) of 12 m/s
    ],
)
def test_a_wrong_unit_of_the_velocity_is_told(name, unit, chosen, message, folder, capsys, monkeypatch):
    """A log in knots taken for m/s; one in s taken for ms lies in the first 1.2 s of the recording."""
    undrawn(monkeypatch)
    wrong = [*LOG, f"--aiding-format.{name}-unit", unit, "--filter", chosen]
    out = folder / "out"
    assert main(["solve", "imu.csv", *CSV, *HELD, *START, *wrong, "--no-record", "--out", str(out)]) == 0
    assert f"Warning: log.csv: {message}" in " ".join(capsys.readouterr().out.split())
    assert any(message in doubt for doubt in json.loads((out / "result.json").read_text())["warnings"])
    assert f"Warning: log.csv: {message}" in (out / "report.md").read_text()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([*HELD, *LOG, "--filter", "double"], "unknown filter 'double' (did you mean 'double-filter'?)"),
        ([*HELD, "--filter", "double-filter"], "aiding and filter must be given together"),
        ([*HELD, *LOG], "aiding and filter must be given together"),
        (["--solver", "navigation-frame", *LOG, "--filter", "velocity-error"], "--solver.height held"),
        (["--solver", "rotation-vector", *LOG, "--filter", "velocity-error"], "must be a navigation solver"),
        ([*HELD, "--aiding", "no.csv", *LOG[2:], "--filter", "velocity-error"], "must be a file, got 'no.csv'"),
        (
            [*HELD, *LOG, "--filter", "velocity-error", "--filter.model.tau-g-s", "1"],
            "tau_g must be at least 10 steps of the filter, 10 s at steps of 1 s, got 1 s",
        ),
        ([*HELD, *LOG, "--aiding", "imu.csv", "--filter", "velocity-error"], "imu.csv, line 1: column 've'"),
    ],
)
def test_bad_input_is_exit_code_2_with_one_line(arguments, message, folder, capsys):
    assert main(["solve", "imu.csv", *CSV, *START, *arguments, "--out", str(folder / "x")]) == 2
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("strapbench: ")]
    assert len(lines) == 1
    assert message in lines[0]
    assert not (folder / "x").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([*HELD, *COLUMNS, "--filter", "velocity-error"], "time_unit must be declared"),
        ([*HELD, *LOG, "--filter", "double-filter", "--filter.model.tau-f-s", "0"], "tau_f must be a positive"),
        (
            [*HELD, *LOG, "--aiding-format.longest-gap", "0", "--filter", "velocity-error"],
            "longest_gap must be",
        ),
        (
            [*HELD, *LOG, "--filter", "velocity-change", "--filter.interval", "20"],
            "interval must be from 1 to 15",
        ),
    ],
)
def test_wrong_options_are_exit_code_2(arguments, message, folder, capsys):
    with pytest.raises(SystemExit, match="2"):
        main(["solve", "imu.csv", *CSV, *START, *arguments, "--out", str(folder / "x")])
    assert message in " ".join(capsys.readouterr().err.split())
    assert not (folder / "x").exists()


def test_help_shows_the_options_of_the_filter(capsys):
    with pytest.raises(SystemExit, match="0"):
        main(["solve", "--filter", "double-filter", "--aiding", "log.csv", "--help"])
    printed = capsys.readouterr().out
    for option in ("--filter.interval", "--filter.model.gyro-bias-deg-per-h", "--aiding-format.velocity-unit"):
        assert option in printed


@pytest.mark.parametrize("name", ["bias-augmented", "double-filter", "velocity-change", "velocity-error"])
def test_every_option_of_velocity_and_filter_is_explained(name, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    with pytest.raises(SystemExit, match="0"):
        main(["solve", "--format", "kf-gins", "--filter", name, "--aiding", "log.csv", "--help"])
    lines = [line.strip("│ ") for line in capsys.readouterr().out.splitlines()]
    options = [k for k, line in enumerate(lines) if re.match(r"--(aiding-format|filter|format)\.", line)]
    assert len(options) > 25
    # The text stands in the line below, or behind two spaces.
    bare = [lines[k] for k in options if "  " not in lines[k] and lines[k + 1].startswith(("(", "--"))]
    assert bare == []


def test_the_hint_says_how_to_see_the_options_of_the_velocity(capsys):
    with pytest.raises(SystemExit, match="0"):
        main(["solve", "--help"])
    assert "--aiding FILE --filter NAME --help` shows the options" in " ".join(capsys.readouterr().out.split())


def test_every_noise_has_an_option():
    from bench._cli_types import NOISES
    from bench.solvers.damping import DampingModel

    assert [name for name, *_ in NOISES] == list(vars(DampingModel()))
