"""Attitude recordings: what is written is read back with rerun's own reader.

Truth and errors are closed forms; errors are computed again here with scipy's
rotations, not with the code under test.
"""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader
from scipy.spatial.transform import Rotation

import bench
from bench import viewer
from bench.errors import BenchError, InputError, OutputError
from bench.mjcf import compile_model
from bench.record._attitude_scene import times
from bench.record.attitude import AttitudeEstimate, AttitudeRun, write_attitude_recording
from bench.record.traces import ESTIMATE_COLOURS, FLOOR
from bench.units import ARCSEC
from tests.recording_cases import FLOAT32, column, entities, make_attitude_run, rotation, static_text

PARTS = {"drifts/slowly": r"drifts\/slowly", "swings": "swings", "exact": "exact"}
ROUNDING = 1e-9  # arcsec: 5e-15 rad, a few roundings of unit quaternions and of angles near pi/2


def png(path: Path, colour: tuple[float, float, float]) -> Path:
    from matplotlib import image

    image.imsave(path, np.tile(np.array(colour), (60, 80, 1)))
    return path


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> AttitudeRun:
    folder = tmp_path_factory.mktemp("figures")
    figures = {
        "Figure 1": png(folder / "one.png", (0.1, 0.9, 0.2)),
        "Figure 2": png(folder / "two.png", (0.9, 0.1, 0.2)),
    }
    return make_attitude_run(model=compile_model("imu"), figures=figures)


@pytest.fixture(scope="module")
def recording(run: AttitudeRun, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_attitude_recording(tmp_path_factory.mktemp("recording") / "run.rrd", run)


def rotation_error(estimate: AttitudeEstimate) -> np.ndarray:
    return (rotation(estimate.q) * rotation(estimate.q_true).inv()).as_rotvec()


def angle_errors(estimate: AttitudeEstimate) -> np.ndarray:
    """Pitch, roll and yaw errors, arcsec, from scipy's intrinsic z-x-y angles."""
    found, true = (rotation(q).as_euler("ZXY") for q in (estimate.q, estimate.q_true))
    return (found - true)[:, [1, 2, 0]] / ARCSEC


def test_rerun_verifies_it(recording: Path) -> None:
    command = [viewer._binary(), "rrd", "verify", str(recording)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    assert "1 file verified without error" in result.stdout + result.stderr


def test_what_it_holds(run: AttitudeRun, recording: Path) -> None:
    found = entities(recording)
    keys = ["rotation", *(f"{prefix}{angle}" for prefix in ("", "largest_") for angle in ("pitch", "roll", "yaw"))]
    expected = {f"/error/{key}/{part}" for key in keys for part in PARTS.values()}
    for part in PARTS.values():
        expected |= {f"/world/{kind}/{part}" for kind in ("truth", "together", "apart")}
        expected |= {f"/world/{kind}/{part}/axes" for kind in ("truth", "together", "apart")}
        expected |= {f"/world/labels/{kind}/{part}" for kind in ("together", "apart")}
        expected |= {f"/world/trails/{kind}/{part}" for kind in ("together", "apart")}
    expected |= {
        "/world/instrument",
        "/world/labels/instrument",
        "/world/instrument/body/box_0",
        "/figures/0",
        "/figures/1",
    }
    assert expected <= found
    assert static_text(recording, "/configuration") == run.configuration
    assert static_text(recording, "/results") == run.results
    assert len(RrdReader(str(recording)).blueprints()) == 1


def test_errors_come_back(run: AttitudeRun, recording: Path) -> None:
    for name, part in PARTS.items():
        estimate = run.estimates[name]
        angles = angle_errors(estimate)
        for k, angle in enumerate(("pitch", "roll", "yaw")):
            t, values = column(recording, f"/error/{angle}/{part}", "Scalars:scalars", 1)
            np.testing.assert_array_equal(t, np.round(1e9 * estimate.t).astype(np.int64))
            np.testing.assert_allclose(values[:, 0], angles[:, k], rtol=0, atol=ROUNDING)
            _, largest = column(recording, f"/error/largest_{angle}/{part}", "Scalars:scalars", 1)
            expected = np.maximum.accumulate(np.abs(values[:, 0]))
            np.testing.assert_array_equal(largest[:, 0], np.log10(np.maximum(expected, FLOOR)))
        _, size = column(recording, f"/error/rotation/{part}", "Scalars:scalars", 1)
        expected = np.linalg.norm(rotation_error(estimate), axis=1) / ARCSEC
        np.testing.assert_allclose(10 ** size[:, 0], expected, rtol=1e-12, atol=ROUNDING)
    # Against the closed form: 1e-4 rad/s about z after 2 s, and 1e-7 rad all the time.
    _, drift = column(recording, r"/error/yaw/drifts\/slowly", "Scalars:scalars", 1)
    assert drift[-1, 0] == pytest.approx(2e-4 / ARCSEC, abs=ROUNDING)
    _, swing = column(recording, "/error/rotation/swings", "Scalars:scalars", 1)
    np.testing.assert_allclose(10**swing * ARCSEC, 1e-7, rtol=0, atol=5e-15)


def test_scalars_are_not_rounded(tmp_path: Path) -> None:
    """A yaw of x, times and values that float32 and milliseconds cannot hold, comes back to the last bit."""
    yaw = np.random.default_rng(2).uniform(-1, 1, 10_000)  # more than two chunks of 4096 rows
    zero = np.zeros_like(yaw)
    t = np.arange(len(yaw)) / 7e4
    q = np.stack([np.cos(0.5 * yaw), zero, zero, np.sin(0.5 * yaw)], axis=1)
    estimate = AttitudeEstimate(t, q, np.tile([1.0, 0.0, 0.0, 0.0], (len(t), 1)))
    run = AttitudeRun("yaw", {"a": estimate}, "", "")
    ns, values = column(
        write_attitude_recording(tmp_path / "run.rrd", run, plot_rate=None), "/error/yaw/a", "Scalars:scalars", 1
    )
    np.testing.assert_array_equal(ns, np.round(1e9 * t).astype(np.int64))
    # A turn about z alone: yaw is twice one arctangent, and nothing else is rounded.
    expected = 2 * np.arctan2(q[:, 3], q[:, 0]) / ARCSEC
    np.testing.assert_array_equal(values[:, 0], expected)


def test_drawn_errors_are_exaggerated_by_the_stated_factor(run: AttitudeRun, recording: Path) -> None:
    # 2e-4 rad becomes at most 50 degrees times 2000; 1e-7 rad times 5e6; no error is not exaggerated.
    own = {"drifts/slowly": 2000.0, "swings": 5e6, "exact": 1.0}
    for name, part in PARTS.items():
        estimate = run.estimates[name]
        rows = slice(None, None, {"drifts/slowly": 10, "swings": 4, "exact": 3}[name])  # at most 100 Hz
        error, true = rotation_error(estimate)[rows], rotation(estimate.q_true[rows])
        t, truth = column(recording, f"/world/truth/{part}", "Transform3D:quaternion", 4)
        np.testing.assert_array_equal(t, np.round(1e9 * estimate.t[rows]).astype(np.int64))
        np.testing.assert_allclose(truth, true.as_quat(), rtol=0, atol=FLOAT32)
        for row, factor in (("together", 2000.0), ("apart", own[name])):
            _, shown = column(recording, f"/world/{row}/{part}", "Transform3D:quaternion", 4)
            turn = (Rotation.from_quat(shown) * true.inv()).as_rotvec()
            # Rounding of the estimate's quaternions, 1e-15 rad, times the factor, and of float32.
            np.testing.assert_allclose(turn, factor * error, rtol=0, atol=4 * FLOAT32 + 1e-15 * factor)
            _, place = column(recording, f"/world/{row}/{part}", "Transform3D:translation", 3)
            _, tips = column(recording, f"/world/trails/{row}/{part}", "Points3D:positions", 9)
            arms = tips.reshape(-1, 3, 3) - place[:, None, :]
            np.testing.assert_allclose(
                arms.transpose(0, 2, 1), Rotation.from_quat(shown).as_matrix(), rtol=0, atol=1e-5
            )


def labels(path: Path, entity: str) -> list[str]:
    (chunk,) = RrdReader(str(path)).stream().filter(content=entity)
    return chunk.to_record_batch().column("Points3D:labels").to_pylist()[0]


def view_names(path: Path) -> str:
    """The blueprint as the viewer's command line prints it."""
    command = [viewer._binary(), "rrd", "print", "-vvv", str(path)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def test_factors_and_largest_errors_are_written_down(run: AttitudeRun, recording: Path, tmp_path: Path) -> None:
    assert "all errors × 2000" in view_names(recording)
    assert labels(recording, r"/world/labels/together/drifts\/slowly")[-1] == "up to 41 arcsec"  # 2e-4 rad
    assert labels(recording, "/world/labels/together/swings")[-1] == "up to 0.021 arcsec"
    assert labels(recording, "/world/labels/apart/swings") == ["swings", "× 5e6"]
    given = write_attitude_recording(tmp_path / "given.rrd", replace(run, exaggeration=750))
    assert "all errors × 750" in view_names(given)
    assert [times(f) for f in (1.0, 20000.0, 2e8, 5e14, 12.5)] == ["1", "20000", "2e8", "5e14", "12.5"]


def test_triads_stand_apart_from_each_other(recording: Path) -> None:
    places = [column(recording, f"/world/truth/{part}", "Transform3D:translation", 3)[1] for part in PARTS.values()]
    places.append(column(recording, "/world/instrument", "Transform3D:translation", 3)[1])
    for k, place in enumerate(places):
        np.testing.assert_array_equal(place, np.tile(place[0], (len(place), 1)))
        for other in places[:k]:
            assert np.linalg.norm(place[0] - other[0]) > 2.3  # two triads, whose axes have the lengths 1 and 1.15


@pytest.mark.parametrize(("plot_rate", "rows"), [(None, 2001), (1000.0, 2001), (100.0, 201), (300.0, 501)])
def test_plots_are_thinned_to_the_rate(tmp_path: Path, plot_rate: float | None, rows: int) -> None:
    path = write_attitude_recording(tmp_path / "run.rrd", make_attitude_run(), plot_rate=plot_rate)
    t, _ = column(path, r"/error/yaw/drifts\/slowly", "Scalars:scalars", 1)
    assert len(t) == rows
    assert "/world/instrument" not in entities(path)  # no model was given
    assert "/figures/0" not in entities(path)


def test_one_estimate_of_one_update(tmp_path: Path) -> None:
    q = np.array([[1.0, 0.0, 0.0, 0.0]])
    run = AttitudeRun("short", {"only": AttitudeEstimate(np.zeros(1), q, q)}, "", "")
    path = write_attitude_recording(tmp_path / "run.rrd", run)
    _, values = column(path, "/error/rotation/only", "Scalars:scalars", 1)
    np.testing.assert_array_equal(values, [[np.log10(FLOOR)]])  # no error is drawn at the floor, not lost as -inf


def test_there_are_colours_for_every_algorithm_of_a_paper() -> None:
    assert len(set(ESTIMATE_COLOURS)) == len(ESTIMATE_COLOURS) >= 12
    spread = np.array(ESTIMATE_COLOURS, dtype=float)
    apart = np.linalg.norm(spread[:, None] - spread, axis=2) + 1e3 * np.eye(len(spread))
    assert apart.min() > 40  # of 255


def test_bad_input_is_refused(tmp_path: Path) -> None:
    run = make_attitude_run(n=8)
    estimate = run.estimates["swings"]
    with pytest.raises(InputError, match="q must have one row per time, 2, got 3"):
        AttitudeEstimate(estimate.t[:2], estimate.q, estimate.q_true)
    with pytest.raises(InputError, match="q_true must be unit quaternions"):
        AttitudeEstimate(estimate.t, estimate.q, 2 * estimate.q_true)
    with pytest.raises(InputError, match="t must increase strictly"):
        AttitudeEstimate(0 * estimate.t, estimate.q, estimate.q_true)
    with pytest.raises(InputError, match="estimates must not be empty"):
        replace(run, estimates={})
    with pytest.raises(InputError, match=r"exaggeration must be a number >= 1, got 0\.5"):
        replace(run, exaggeration=0.5)
    with pytest.raises(InputError, match=r"figures\['F'\] must be a file, got '.*none\.png'"):
        replace(run, figures={"F": tmp_path / "none.png"})
    with pytest.raises(InputError, match="pose_rate must be a positive number, got -1"):
        write_attitude_recording(tmp_path / "run.rrd", run, pose_rate=-1)
    with pytest.raises(OutputError, match=r"no/run\.rrd' cannot be written: No such file or directory"):
        write_attitude_recording(tmp_path / "no" / "run.rrd", run)
    assert list(tmp_path.iterdir()) == []


def test_cut_recordings_are_refused(recording: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.rrd"
    cut.write_bytes(recording.read_bytes()[:-1000])
    with pytest.raises(InputError, match=r"cut\.rrd' is not a complete \.rrd file"):
        viewer.check_recording(cut)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("attitude-coning", {"phases": 1, "duration": 2.4, "rates": (200.0, 100.0)}),
        ("attitude-manoeuvre", {"phases": 1, "truth_rate": 1e4}),
    ],
)
def test_experiments_record_what_they_measured(name: str, options: dict, tmp_path: Path) -> None:
    """The largest errors at the end of the plots are those in the rows, which other code computes."""
    outcome = bench.run(name, out=tmp_path / "run", seed=1, **options)
    rows = outcome.rows
    rate = 100.0 if name == "attitude-coning" else 1000.0
    chosen = (rows["rate_hz"] == rate) & (rows["samples"] == 3) & (rows["phase"] == 0)
    labels = ["rotation vector, Eq. 4", "Taylor quaternion", "hybrid", "Taylor quaternion, quantised"]
    for label in labels if name == "attitude-coning" else labels[:3]:
        algorithm, _, data = label.partition(", q")
        row = chosen & (rows["algorithm"] == algorithm) & (rows["data"] == ("quantised" if data else "ideal"))
        part = rr.escape_entity_path_part(f"{algorithm}, N = 3{', quantised' if data else ''}")
        for angle in ("pitch", "roll", "yaw"):
            entity = f"/error/largest_{angle}/{part}"
            _, values = column(outcome.files["recording"], entity, "Scalars:scalars", 1)
            (measured,) = rows[f"{angle}_arcsec"][row]
            assert 10 ** values[-1, 0] == pytest.approx(measured, rel=1e-6, abs=ROUNDING)
    assert "/figures/1" in entities(outcome.files["recording"])
    assert static_text(outcome.files["recording"], "/results").startswith("# Results")


def test_import_needs_no_mujoco() -> None:
    code = "import sys, bench.record.attitude; print([m for m in ('mujoco', 'scipy', 'numba') if m in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


@pytest.mark.slow
def test_screenshots(recording: Path, tmp_path: Path) -> None:
    from matplotlib import image

    pictures = {}
    for tab in ("Scene", "Errors", "Figures"):
        try:
            path = viewer.screenshot(recording, tmp_path / f"{tab}.png", size=(900, 600), tab=tab)
        except BenchError as error:
            if "Vulkan" not in str(error):
                raise
            pytest.skip(f"no Vulkan driver: {error}")
        pictures[tab] = image.imread(path)[:, :, :3]
    for colour in ((222, 74, 66), (60, 168, 92), (66, 126, 230)):  # the axes, within their shading
        assert (np.abs(pictures["Scene"] - np.array(colour) / 255).max(axis=2) < 0.1).sum() > 50
    for colour in ESTIMATE_COLOURS[:2]:  # lines; the third estimate has no error and lies below the plot
        assert (np.abs(pictures["Errors"] - np.array(colour) / 255).max(axis=2) < 0.1).sum() > 50
    one = write_attitude_recording(
        tmp_path / "one.rrd",
        replace(make_attitude_run(n=8), figures={"only": png(tmp_path / "g.png", (0.1, 0.9, 0.2))}),
    )
    viewer.screenshot(one, tmp_path / "one.png", size=(300, 300), tab="Figures")  # the tab is there for one figure too
    green = np.abs(pictures["Figures"] - [0.1, 0.9, 0.2]).max(axis=2) < 0.05
    assert green.sum() > 10_000  # the first figure fills much of the page
