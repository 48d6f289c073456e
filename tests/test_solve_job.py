"""The job of solving a file: what is in its folder, and that nothing is lost or overwritten."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest

import bench
from bench.aiding import VelocityFile
from bench.errors import AccuracyError, InputError, OutputError
from bench.formats import file_format
from bench.runner import Reporter
from bench.solve_job import SolveJob, run_job
from bench.starts.header import StartHeader
from bench.starts.reference import StartReference
from bench.starts.values import StartValues
from bench.table import Table
from tests.recorded_cases import HEIGHT, LATITUDE, LONGITUDE, initial, standing, truth, undrawn

PSINS = Path(__file__).parent / "data" / "psins"
KF = file_format("kf-gins")
LOG = VelocityFile(columns="t,ve,vn", time_unit="s", velocity_unit="m/s")
INS = bench.solver("navigation", "navigation-frame", samples=2)
VALUES = StartValues(
    latitude_deg=np.degrees(LATITUDE),
    longitude_deg=np.degrees(LONGITUDE),
    height_m=HEIGHT,
    velocity_enu=(0.0, 0.0, 0.0),
    heading_deg=-np.degrees(0.4),
    pitch_deg=np.degrees(-0.05),
    roll_deg=np.degrees(0.1),
)


@pytest.fixture
def job(tmp_path: Path) -> SolveJob:
    """A unit that stands for 5 s at 100 Hz, and a reference at 10 Hz from 1.004 s on, between ends of increments."""
    KF.write_imu(tmp_path / "imu.txt", standing(501))
    KF.write_reference(tmp_path / "truth.nav", truth(51.004 + np.arange(60) / 10))
    return SolveJob(tmp_path / "imu.txt", KF, INS, StartReference(), reference=tmp_path / "truth.nav")


def test_what_is_in_the_folder(job, tmp_path):
    said = []
    outcome = run_job(job, tmp_path / "out", reporter=Reporter(say=said.append))
    out = tmp_path / "out"
    expected = {"inputs.json", "result.json", "report.md", "report.html", "recording.rrd", "tables", "figures"}
    assert {path.name for path in out.iterdir()} == expected
    assert {path.stem for path in (out / "figures").iterdir()} == {"track", "velocity", "attitude", "errors"}
    table = Table.read_parquet(out / "tables" / "trajectory.parquet")
    np.testing.assert_array_equal(table["t_s"], outcome.solution.trajectory.t)
    np.testing.assert_allclose(table["latitude_rad"], LATITUDE, atol=1e-12)
    np.testing.assert_allclose(table["longitude_rad"], LONGITUDE, atol=1e-12)
    np.testing.assert_allclose(table["height_m"], HEIGHT, atol=1e-5)
    np.testing.assert_allclose(table["heading_rad"], 2 * np.pi - 0.4, atol=1e-9)
    np.testing.assert_allclose(table["pitch_rad"], -0.05, atol=1e-9)
    np.testing.assert_allclose(table["roll_rad"], 0.1, atol=1e-9)
    errors = Table.read_parquet(out / "tables" / "errors.parquet")
    assert len(errors) == 40
    assert max(np.abs(errors[f"position_{name}_m"]).max() for name in ("east", "north", "up")) < 1e-5
    result = json.loads((out / "result.json").read_text())
    assert result["increments"] == {"skipped": 100, "solved": 400, "left_over": 1, "compared": 40, "interpolated": 40}
    assert result["times"]["samples"] == 501
    assert result["recording"]["sha256"] == hashlib.sha256((tmp_path / "imu.txt").read_bytes()).hexdigest()
    assert result["solver"] == {"kind": "navigation", "name": "navigation-frame", **vars(INS)}
    assert result["states"]["end"]["height, m"] == pytest.approx(HEIGHT, abs=1e-5)
    html = (out / "report.html").read_text()
    assert html.count("data:image/png;base64,") == 4
    for text in (html, (out / "report.md").read_text(), outcome.summary):
        assert "100 increments before the start were not solved" in text
        assert "1 at the end were left over" in text
    assert said[0].startswith("Reading ")


def test_a_finished_run_is_not_touched_without_force(job, tmp_path, monkeypatch):
    undrawn(monkeypatch)
    run_job(job, tmp_path / "out", record=False)
    assert not (tmp_path / "out" / "recording.rrd").exists()
    before = (tmp_path / "out" / "result.json").stat().st_mtime_ns
    with pytest.raises(InputError, match="holds a finished run"):
        run_job(job, tmp_path / "out", record=False)
    assert (tmp_path / "out" / "result.json").stat().st_mtime_ns == before
    run_job(job, tmp_path / "out", record=False, force=True)


def test_without_a_folder_nothing_is_written(job, tmp_path):
    before = sorted(tmp_path.rglob("*"))
    assert run_job(job).files == {}
    assert sorted(tmp_path.rglob("*")) == before


def test_attitude_alone(job, tmp_path, monkeypatch):
    undrawn(monkeypatch)
    attitude = bench.solver("attitude", "rotation-vector", samples=3)
    outcome = run_job(SolveJob(job.imu, KF, attitude, VALUES, reference=job.reference), tmp_path / "out")
    assert outcome.counts == {"skipped": 0, "solved": 501, "left_over": 0, "compared": 41, "interpolated": 41}
    table = Table.read_parquet(tmp_path / "out" / "tables" / "trajectory.parquet")
    assert list(table.columns) == ["t_s", *(f"q_nb_{k}" for k in "wxyz"), "heading_rad", "pitch_rad", "roll_rad"]
    errors = Table.read_parquet(tmp_path / "out" / "tables" / "errors.parquet")
    assert list(errors.columns) == ["t_s", *(f"attitude_{name}_rad" for name in ("east", "north", "up"))]
    assert {path.stem for path in (tmp_path / "out" / "figures").iterdir()} == {"attitude", "errors"}


def test_the_biases_have_the_units_of_their_names(job):
    plain = run_job(SolveJob(job.imu, KF, INS, VALUES)).solution.trajectory
    biased = SolveJob(
        job.imu, KF, INS, VALUES, gyro_bias_deg_per_h=(0.0, 0.0, 3600.0), accelerometer_bias_micro_g=(0.0, 0.0, -1000.0)
    )
    found = run_job(biased).solution.trajectory
    # 1 deg/s for 5 s about z, and 1e-3 g along the axis that is up within 6 deg (0.6 %), which the turn adds 2 % to.
    turn = 2 * np.arccos(np.abs((plain.q_nb[-1] * found.q_nb[-1]).sum()))
    assert np.degrees(turn) == pytest.approx(5.0, rel=1e-6)
    assert found.v_n[-1, 2] == pytest.approx(9.80665e-3 * 5, rel=0.03)


def test_what_is_doubtful_is_told_and_kept(job, tmp_path, monkeypatch):
    undrawn(monkeypatch)
    job.imu.write_text(job.imu.read_text().rstrip())
    said = []
    run_job(job, tmp_path / "out", record=False, reporter=Reporter(say=said.append))
    assert any("Warning: " in line and "no line end" in line for line in said)
    assert "no line end" in json.loads((tmp_path / "out" / "result.json").read_text())["warnings"][0]


@pytest.mark.parametrize("reference_format", [None, file_format("psins-mat", avp="fogavp")])
def test_a_real_recording_with_its_reference(reference_format):
    file = PSINS / "mems_imu_with_fog_reference_5s.mat"
    imu = file_format("psins-mat", imu="mimu", kind="increments", avp="fogavp")
    job = SolveJob(file, imu, INS, StartReference(), reference=file, reference_format=reference_format)
    outcome = run_job(job)
    assert outcome.counts == {"skipped": 11, "solved": 490, "left_over": 0, "compared": 50, "interpolated": 0}
    # A car at 12 m/s for 4.9 s: with micromechanical sensors a metre is plausible, 57 m would be the way it went.
    assert np.linalg.norm(outcome.solution.comparison.errors.position[-1]) < 2.0
    assert np.linalg.norm(outcome.solution.comparison.errors.attitude[-1]) < np.radians(1.0)


def test_the_header_of_a_recording(tmp_path):
    path = tmp_path / "imu.imu"
    file_format("psins-imu").write_imu(path, standing(100), initial=initial())
    outcome = run_job(SolveJob(path, file_format("psins-imu"), INS, StartHeader()))
    assert outcome.beginning.initial.latitude == pytest.approx(LATITUDE, abs=1e-15)
    late = SolveJob(path, file_format("psins-imu", start=50.5), INS, StartHeader())
    with pytest.raises(InputError, match=r"initial 'header' is the state at the start of the file, got start = 50\.5"):
        run_job(late)


def test_bad_jobs_are_refused_before_any_work(job, tmp_path):
    nowhere = tmp_path / "nothing.txt"
    with pytest.raises(InputError, match="initial 'reference' needs a reference, got none"):
        SolveJob(nowhere, KF, INS, StartReference())
    with pytest.raises(InputError, match="reference_format needs a reference, got 'kf-gins' without one"):
        SolveJob(nowhere, KF, INS, VALUES, reference_format=KF)
    velocity, csv = {"filter": bench.solver("damping", "velocity-error")}, {"aiding": nowhere, "aiding_format": LOG}
    for options, message in (
        (velocity, "aiding and filter must be given together.*got filter 'velocity-error' alone"),
        (csv, "aiding and filter must be given together.*got the velocity alone"),
        ({**velocity, "aiding": nowhere}, "aiding and aiding_format must be given together"),
        ({**velocity, **csv}, r"set height to 'held' \(--solver.height held\), got 'free'"),
    ):
        with pytest.raises(InputError, match=message):
            SolveJob(nowhere, KF, INS, VALUES, **options)
    held = bench.solver("navigation", "navigation-frame", height="held")
    with pytest.raises(InputError, match=r"path must be a file, got .*nothing\.txt"):
        run_job(SolveJob(job.imu, KF, held, VALUES, **velocity, **csv), tmp_path / "out")
    with pytest.raises(InputError, match=r"gyro_bias_deg_per_h must have shape \(3,\)"):
        SolveJob(nowhere, KF, INS, VALUES, gyro_bias_deg_per_h=(1.0,))
    for bad in (
        SolveJob(nowhere, KF, INS, VALUES),
        SolveJob(job.imu, KF, INS, VALUES, reference=nowhere),
        SolveJob(job.imu, KF, INS, VALUES, rule="spline"),
    ):
        with pytest.raises(InputError):
            run_job(bad, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_failure_leaves_what_was_written(job, tmp_path, monkeypatch):
    import bench.figures

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(bench.figures, "draw", full)
    with pytest.raises(OutputError, match="cannot be written: No space left on device; what was written is kept"):
        run_job(job, tmp_path / "out")
    assert (tmp_path / "out" / "tables" / "trajectory.parquet").exists()
    assert not (tmp_path / "out" / "result.json").exists()
    undrawn(monkeypatch)
    run_job(job, tmp_path / "out", record=False)  # the same job goes on without force


def test_a_solution_that_diverges_is_not_reported(job, tmp_path, monkeypatch):
    def diverge(*_, **__):
        raise AccuracyError("navigation-frame diverges at update 3")

    monkeypatch.setattr(type(INS), "_update", diverge)
    with pytest.raises(AccuracyError, match="diverges at update 3"):
        run_job(job, tmp_path / "out")
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"inputs.json"}
