"""Navigation recordings: what is written is read back with rerun's own reader.

Truth: a straight and level course with errors that are put in; places are pymap3d's, rotations scipy's.
"""

import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pymap3d
import pytest
from scipy.spatial.transform import Rotation

from bench import viewer
from bench.earth import WGS84
from bench.errors import BenchError, InputError, OutputError
from bench.record.navigation import NavigationEstimate, NavigationRun, write_navigation_recording
from bench.record.traces import ESTIMATE_COLOURS, FLOOR
from bench.rotation import quat_from_rotvec, quat_multiply, quat_normalize, quat_rotate
from bench.trajectory import Trajectory
from bench.units import ARCSEC, DEG
from tests.recording_cases import FLOAT32, column, entities, static_text

LATITUDE, LONGITUDE, HEIGHT = 48.0, 11.0, 500.0  # deg, deg, m
GOOD, POOR = "exact/ly", "with errors"
PARTS = {GOOD: r"exact\/ly", POOR: "with\\ errors"}
DIRECTIONS = ("east", "north", "up")


def course(t: np.ndarray) -> Trajectory:
    """30 m/s or so along the meridian, nose 20 deg clockwise from north, rolling."""
    n = len(t)
    latitude = LATITUDE * DEG + 30.0 * t / 6.37e6
    q_nb = np.roll(
        Rotation.from_euler("ZY", np.stack([np.full(n, -20 * DEG), 0.1 * np.sin(t)], 1)).as_quat(), 1, axis=1
    )
    v_n = np.tile([0.0, 30.0, 0.0], (n, 1))
    return Trajectory.from_geodetic(WGS84, t, q_nb, v_n, latitude, np.full(n, LONGITUDE * DEG), np.full(n, HEIGHT))


def errors_at(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Errors of position, velocity and attitude in n."""
    return np.outer(t, [0.5, -0.2, 0.1]), np.outer(t, [0.1, 0.0, -0.1]), np.outer(t, [1e-5, 2e-5, -3e-5])


def with_errors(true: Trajectory) -> Trajectory:
    position, velocity, attitude = errors_at(true.t)
    turn = quat_from_rotvec(quat_rotate(true.q_en, attitude))
    return Trajectory(
        WGS84,
        true.t,
        quat_normalize(quat_multiply(turn, true.q_eb)),
        true.v_e + quat_rotate(true.q_en, velocity),
        true.r_e + quat_rotate(true.q_en, position),
    )


def make_run(n: int = 2000, **options: object) -> NavigationRun:
    """Two estimates at their own rates; one is compared every tenth update only."""
    fast, slow = course(np.arange(n + 1) / 100), course(np.arange(n // 4 + 1) / 25)
    poor = with_errors(fast)
    some = slice(None, None, 10)
    sampled = poor[some]
    estimates = {
        GOOD: NavigationEstimate(slow, slow),
        POOR: NavigationEstimate(poor, course(poor.t[some]), sampled),
    }
    texts = {"configuration": "# Configuration\n\nmade up", "results": "# Results\n\nnone"}
    return NavigationRun(**{"title": "a course", "estimates": estimates, "truth": fast, **texts, **options})


@pytest.fixture(scope="module")
def run() -> NavigationRun:
    return make_run(parameters={"seed": 3})


@pytest.fixture(scope="module")
def recording(run: NavigationRun, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_navigation_recording(tmp_path_factory.mktemp("recording") / "run.rrd", run)


def test_rerun_verifies_it(recording):
    command = [viewer._binary(), "rrd", "verify", str(recording)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr


def test_what_it_holds(recording):
    found = entities(recording)
    for part in (*PARTS.values(), "0_truth"):
        assert {f"/track/paths/{part}", f"/track/bodies/{part}", f"/map/paths/{part}", f"/map/now/{part}"} <= found
        assert {f"/motion/{key}/{part}" for key in ("heading", "height", "speed", "velocity_east")} <= found
    for part in PARTS.values():
        assert {f"/error/{kind}/{part}" for kind in ("position", "velocity", "attitude")} <= found
        assert {f"/world/together/{part}", f"/world/truth/{part}"} <= found
    assert static_text(recording, "/results").startswith("# Results")


@pytest.mark.parametrize(
    ("kind", "which", "scale"), [("position", 0, 1.0), ("velocity", 1, 1.0), ("attitude", 2, ARCSEC)]
)
def test_errors_are_those_that_were_put_in(recording, kind, which, scale):
    for name, part in PARTS.items():
        t = np.arange(201) / 10 if name == POOR else np.arange(501) / 25
        expected = errors_at(t)[which] / scale if name == POOR else np.zeros((len(t), 3))
        # Rounding of 6.4e6 m, of 500 m/s of the frame, and of unit quaternions in arcsec.
        atol = {"position": 5e-9, "velocity": 1e-12, "attitude": 1e-9}[kind]
        for axis, direction in enumerate(DIRECTIONS):
            ns, values = column(recording, f"/error_by_axis/{kind}_{direction}/{part}", "Scalars:scalars", 1)
            np.testing.assert_array_equal(ns, np.round(t * 1e9).astype(np.int64))
            np.testing.assert_allclose(values[:, 0], expected[:, axis], atol=atol)
        _, sizes = column(recording, f"/error/{kind}/{part}", "Scalars:scalars", 1)
        size = np.linalg.norm(expected, axis=1)
        far = size > 1e3 * atol
        np.testing.assert_allclose(sizes[far, 0], np.log10(size[far]), atol=1e-3)
        assert sizes.min() >= np.log10(FLOOR)


def test_places_on_the_map_and_in_space(recording):
    t = np.arange(2001) / 100
    latitude = LATITUDE + np.degrees(30.0 * t / 6.37e6)
    _, places = column(recording, "/map/now/0_truth", "GeoPoints:positions", 2)
    np.testing.assert_allclose(places, np.stack([latitude, np.full(2001, LONGITUDE)], axis=1), atol=1e-12)
    _, positions = column(recording, "/track/bodies/0_truth", "Transform3D:translation", 3)
    expected = pymap3d.geodetic2enu(latitude, LONGITUDE, HEIGHT, LATITUDE, LONGITUDE, HEIGHT)
    np.testing.assert_allclose(positions, np.stack(expected, axis=1), atol=600 * FLOAT32)
    _, poor = column(recording, f"/track/bodies/{PARTS[POOR]}", "Transform3D:translation", 3)
    np.testing.assert_allclose(poor - positions, errors_at(t)[0], atol=1200 * FLOAT32 + 2e-3)  # n turns by 1e-4 rad


def test_attitudes_in_east_north_up(run, recording):
    for entity in ("/body/0_truth", "/track/bodies/0_truth"):  # both nearly those of n: the way is 600 m
        _, xyzw = column(recording, entity, "Transform3D:quaternion", 4)
        true = Rotation.from_euler("ZY", np.stack([np.full(2001, -20 * DEG), 0.1 * np.sin(np.arange(2001) / 100)], 1))
        assert (Rotation.from_quat(xyzw) * true.inv()).magnitude().max() < 1e-4 + 4 * FLOAT32
    _, heading = column(recording, "/motion/heading/0_truth", "Scalars:scalars", 1)
    np.testing.assert_allclose(heading, 20.0, atol=1e-9)
    _, roll = column(recording, "/motion/roll/0_truth", "Scalars:scalars", 1)
    np.testing.assert_allclose(roll[:, 0], np.degrees(0.1 * np.sin(run.truth.t)), atol=1e-9)


def test_drawn_errors_are_exaggerated_in_the_true_frame(run, recording):
    """Position errors do not turn the axes: the drawn turn is the factor times the attitude error in the true n."""
    _, drawn = column(recording, f"/world/together/{PARTS[POOR]}", "Transform3D:quaternion", 4)
    _, true = column(recording, f"/world/truth/{PARTS[POOR]}", "Transform3D:quaternion", 4)
    turn = (Rotation.from_quat(drawn) * Rotation.from_quat(true).inv()).as_rotvec()
    put_in = errors_at(np.arange(201) / 10)[2]
    factor = turn[-1] / put_in[-1]
    np.testing.assert_allclose(factor, 1000.0, rtol=1e-5)  # 7.5e-4 rad at the end, to be less than 50 deg


def test_headings_do_not_jump_and_agree():
    from bench.record._navigation_traces import _heading

    t = np.arange(100) / 10
    psi = -2 * t
    turning = course(t)
    q_nb = np.roll(Rotation.from_euler("Z", psi[:, None]).as_quat(), 1, axis=1)
    spun = Trajectory(WGS84, t, quat_normalize(quat_multiply(turning.q_en, q_nb)), turning.v_e, turning.r_e)
    np.testing.assert_allclose(_heading(spun, None), np.degrees(2 * t), atol=1e-9)
    np.testing.assert_allclose(_heading(spun, 359.9), 360 + np.degrees(2 * t), atol=1e-9)


def test_rows_are_thinned(run, tmp_path):
    path = write_navigation_recording(tmp_path / "thin.rrd", run, plot_rows=100, pose_rows=50)
    ns, _ = column(path, "/motion/height/0_truth", "Scalars:scalars", 1)
    np.testing.assert_array_equal(ns, np.arange(0, 2001, 21) * 10_000_000)
    assert len(column(path, "/map/now/0_truth", "GeoPoints:positions", 2)[0]) == 49
    full = write_navigation_recording(tmp_path / "full.rrd", run, plot_rows=None, pose_rows=None)
    assert len(column(full, "/track/bodies/0_truth", "Transform3D:translation", 3)[0]) == 2001


def test_without_truth_there_are_no_errors(tmp_path):
    run = make_run(n=100)
    alone = replace(run, truth=None, estimates={n: NavigationEstimate(e.trajectory) for n, e in run.estimates.items()})
    found = entities(write_navigation_recording(tmp_path / "alone.rrd", alone))
    assert f"/track/paths/{PARTS[POOR]}" in found
    assert not [entity for entity in found if entity.startswith(("/error", "/world")) or "truth" in entity]


def test_attitude_alone_shows_no_place(tmp_path):
    run = make_run(n=100, attitude_only=True)
    found = entities(write_navigation_recording(tmp_path / "attitude.rrd", run))
    assert f"/error/attitude/{PARTS[POOR]}" in found
    assert not [
        entity for entity in found if entity.startswith(("/error/position", "/motion/velocity", "/track", "/map"))
    ]


def test_large_angles_are_in_degrees(tmp_path):
    true = course(np.arange(101) / 10)
    q_eb = quat_normalize(quat_multiply(true.q_eb, quat_from_rotvec(np.tile([0.0, 0.0, 1 * DEG], (101, 1)))))
    estimate = NavigationEstimate(Trajectory(WGS84, true.t, q_eb, true.v_e, true.r_e), true)
    path = write_navigation_recording(tmp_path / "coarse.rrd", replace(make_run(n=8), estimates={"coarse": estimate}))
    _, sizes = column(path, "/error/attitude/coarse", "Scalars:scalars", 1)
    np.testing.assert_allclose(sizes, 0.0, atol=1e-9)  # log10 of 1 deg


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"estimates": {}}, "estimates must not be empty"),
        ({"truth_name": POOR}, "estimates must not have the name of the truth, 'with errors'"),
        ({"figures": {"one": Path("no.png")}}, r"figures\['one'\] must be a file, got 'no.png'"),
    ],
)
def test_bad_runs_are_refused(run, change, message):
    with pytest.raises(InputError, match=message):
        replace(run, **change)


def test_bad_estimates_and_options_are_refused(run, tmp_path):
    true = course(np.arange(11) / 10)
    with pytest.raises(InputError, match="sampled must come with the truth"):
        NavigationEstimate(true, None, true)
    with pytest.raises(InputError, match="must have the same length, got 11 and 2001"):
        NavigationEstimate(true, run.truth)
    with pytest.raises(InputError, match="plot_rows must be an integer >= 1, got 0"):
        write_navigation_recording(tmp_path / "x.rrd", run, plot_rows=0)
    with pytest.raises(OutputError, match="cannot be written"):
        write_navigation_recording(tmp_path / "no" / "x.rrd", run)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_screenshots(recording, tmp_path):
    from matplotlib import image

    for tab in ("Scene", "Map", "Errors by axis", "Motion"):
        try:
            path = viewer.screenshot(recording, tmp_path / "tab.png", size=(900, 600), tab=tab)
        except BenchError as error:
            if "Vulkan" not in str(error):
                raise
            pytest.skip(f"no Vulkan driver: {error}")
        picture = image.imread(path)[:, :, :3]
        close = np.abs(picture - np.array(ESTIMATE_COLOURS[1]) / 255).max(axis=2) < 0.1
        assert close.sum() > 50, tab  # track and lines of the poor estimate
