"""Gyro-free recordings: what is written is read back with rerun's own reader.

The run is made of plain numpy in closed form; errors are computed again here, with
scipy's rotations, not with the code under test.
"""

import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

from bench import viewer
from bench.errors import InputError, OutputError
from bench.record.gyro_free import GyroFreeRun, write_gyro_free_recording
from bench.record.traces import FLOOR, Trace
from bench.signals import GyroFreeSolution, Kinematics, Readings
from tests.recording_cases import FLOAT32, N, column, entities, make_gyro_free_run, rotation, static_text


@pytest.fixture(scope="module")
def run() -> GyroFreeRun:
    return make_gyro_free_run()


@pytest.fixture(scope="module")
def recording(run: GyroFreeRun, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_gyro_free_recording(tmp_path_factory.mktemp("recording") / "run.rrd", run, pose_rate=100.0)


def test_rerun_verifies_it(recording: Path) -> None:
    command = [viewer._binary(), "rrd", "verify", str(recording)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    assert "1 file verified without error" in result.stdout + result.stderr


def test_what_it_holds(recording: Path) -> None:
    found = entities(recording)
    expected = {"/world/body", "/world/body/specific_force", "/world/body/enlarged/specific_force", "/world/body/sites"}
    expected |= {"/world/paths/truth", r"/world/paths/nine\ accelerometers", r"/world/paths/six\/accelerometers"}
    expected |= {r"/world/estimates/nine\ accelerometers", r"/world/estimates/six\/accelerometers/axes"}
    expected |= {f"/error/{kind}" for kind in ("attitude", "position", "rate", "attitude_x", "position_z")}
    expected |= {"/rate/x", "/rate/y", "/rate/z", "/readings/0", "/readings/2", "/configuration", "/results"}
    assert expected <= found
    assert static_text(recording, "/configuration") == "# Configuration\n\nmade up"
    assert static_text(recording, "/results") == "# Results\n\nnone"
    assert len(RrdReader(str(recording)).blueprints()) == 1


def test_readings_and_rates_come_back_bit_for_bit(run: GyroFreeRun, recording: Path) -> None:
    for group in range(3):
        t, values = column(recording, f"/readings/{group}", "Scalars:scalars", 3)
        np.testing.assert_array_equal(t, 1_000_000 * np.arange(N))  # 1 kHz is whole milliseconds
        np.testing.assert_array_equal(values, run.readings.accelerometers[:, 3 * group : 3 * group + 3])
    for k, axis in enumerate("xyz"):
        _, values = column(recording, f"/rate/{axis}", "Scalars:scalars", 3)
        rates = [*run.estimates.values(), run.truth]
        np.testing.assert_array_equal(values, np.stack([r.omega_ib_b[:, k] for r in rates], axis=1))


def test_errors_are_those_of_the_estimates(run: GyroFreeRun, recording: Path) -> None:
    position = np.stack([e.position - run.truth.position for e in run.estimates.values()], axis=2)
    attitude = np.stack(
        [np.degrees((rotation(e.q_ib) * rotation(run.truth.q_ib).inv()).as_rotvec()) for e in run.estimates.values()],
        axis=2,
    )
    rate = np.stack([e.omega_ib_b - run.truth.omega_ib_b for e in run.estimates.values()], axis=2)
    for k, axis in enumerate("xyz"):
        _, values = column(recording, f"/error/position_{axis}", "Scalars:scalars", 2)
        np.testing.assert_array_equal(values, position[:, k])
        _, values = column(recording, f"/error/attitude_{axis}", "Scalars:scalars", 2)
        np.testing.assert_allclose(values, attitude[:, k], rtol=0, atol=1e-13)  # deg: rounding of quaternions
    # The logarithm amplifies rounding of an error near the rounding floor: 1e-10 relative from the second sample on.
    for name, error in (("attitude", attitude), ("position", position), ("rate", rate)):
        _, values = column(recording, f"/error/{name}", "Scalars:scalars", 2)
        size = np.log10(np.linalg.norm(error[1:], axis=1))
        np.testing.assert_allclose(values[1:], size, rtol=0, atol=1e-9)
    _, values = column(recording, "/error/position", "Scalars:scalars", 2)
    assert (values[0] == np.log10(FLOOR)).all()  # no error at all is drawn at the floor, not lost as -inf


def test_poses_and_arrows(run: GyroFreeRun, recording: Path) -> None:
    thinned = slice(None, None, 10)  # 100 Hz of 1 kHz
    bodies = {"/world/body": run.truth, r"/world/estimates/six\/accelerometers": run.estimates["six/accelerometers"]}
    for entity, body in bodies.items():
        t, position = column(recording, entity, "Transform3D:translation", 3)
        _, quaternion = column(recording, entity, "Transform3D:quaternion", 4)
        np.testing.assert_array_equal(t, 10_000_000 * np.arange(501))
        np.testing.assert_allclose(position, body.position[thinned], rtol=FLOAT32, atol=10 * FLOAT32)
        np.testing.assert_allclose(quaternion[:, [3, 0, 1, 2]], body.q_ib[thinned], rtol=0, atol=FLOAT32)
    _, vectors = column(recording, "/world/body/specific_force", "Arrows3D:vectors", 27)
    _, origins = column(recording, "/world/body/specific_force", "Arrows3D:origins", 27)
    force = run.readings.accelerometers[thinned, :, None] * run.accelerometers.direction
    # The scale is a round number of metres per m/s^2, named in the view's title.
    scale = np.linalg.norm(vectors) / np.linalg.norm(force)
    assert scale == pytest.approx(0.01, rel=1e-6)
    np.testing.assert_allclose(vectors, 0.01 * force.reshape(-1, 27), rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(origins, np.tile(run.accelerometers.position.ravel(), (501, 1)), rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    ("plot_rate", "rows"), [(None, 5001), (1000.0, 5001), (100.0, 501), (300.0, 1251), (1e9, 5001)]
)
def test_plots_are_thinned_to_the_rate(run: GyroFreeRun, tmp_path: Path, plot_rate: float | None, rows: int) -> None:
    path = write_gyro_free_recording(tmp_path / "run.rrd", run, plot_rate=plot_rate)
    t, _ = column(path, "/rate/x", "Scalars:scalars", 3)
    assert len(t) == rows


def test_one_sample_without_estimates(run: GyroFreeRun, tmp_path: Path) -> None:
    kinematics = {name: getattr(run.truth, name)[:1] for name in run.truth.__dataclass_fields__}
    short = replace(
        run,
        readings=Readings(run.readings.t[:1], run.readings.accelerometers[:1]),
        truth=Kinematics(**kinematics),
        estimates={},
    )
    path = write_gyro_free_recording(tmp_path / "run.rrd", short)
    assert "/error/attitude" not in entities(path)
    assert len(column(path, "/rate/x", "Scalars:scalars", 1)[0]) == 1


def test_bad_runs_are_refused(run: GyroFreeRun) -> None:
    cut = GyroFreeSolution(*(np.zeros((7, k)) for k in (3, 3, 3, 4, 3, 3)))
    with pytest.raises(InputError, match=r"estimates\['cut'\] must have one row per reading, 5001, got 7"):
        replace(run, estimates={"cut": cut})
    with pytest.raises(InputError, match="readings must have 9 channels, got 8"):
        replace(run, readings=Readings(run.readings.t, run.readings.accelerometers[:, :8]))
    with pytest.raises(InputError, match="plot_rate must be a positive number, got 0"):
        write_gyro_free_recording("unused.rrd", run, plot_rate=0)


def test_what_cannot_be_written_leaves_nothing(run: GyroFreeRun, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"no/run\.rrd' cannot be written: No such file or directory"):
        write_gyro_free_recording(tmp_path / "no" / "run.rrd", run)
    (tmp_path / "folder.rrd").mkdir()
    with pytest.raises(OutputError, match="Is a directory"):
        write_gyro_free_recording(tmp_path / "folder.rrd", run)
    assert [p.name for p in tmp_path.iterdir()] == ["folder.rrd"]


@pytest.mark.parametrize("model", ["nine_accelerometer", "six_accelerometer", "twelve_accelerometer", "imu"])
def test_every_model_can_be_recorded(model: str, tmp_path: Path) -> None:
    path = write_gyro_free_recording(tmp_path / "run.rrd", make_gyro_free_run(model, n=50))
    assert any(entity.startswith("/world/body/instrument/box") for entity in entities(path))
    assert any(entity.startswith("/world/body/enlarged/instrument/mesh") for entity in entities(path))


def test_legend_goes_where_no_line_is() -> None:
    ramp = np.linspace(0, 1, 100)[:, None]
    for values, corners in ((ramp, {"LeftTop", "RightBottom"}), (-ramp, {"LeftBottom", "RightTop"})):
        assert Trace("e", "t", ("s",), ((0, 0, 0),), values).empty_corner() in corners
    assert Trace("e", "t", ("s",), ((0, 0, 0),), 0 * ramp).empty_corner() in {"LeftTop", "RightTop"}
