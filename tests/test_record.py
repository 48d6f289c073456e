"""Recordings: what is written is read back with rerun's own reader, and looked at without a display.

The run is made of plain numpy in closed form; errors are computed again here, with
scipy's rotations, not with the code under test.
"""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pyarrow as pa
import pytest
from rerun.chunk import RrdReader
from scipy.spatial.transform import Rotation

from bench import viewer
from bench.drawing import Scene, body_shapes, body_sites, instrumented_body, mesh_triangles, round_down
from bench.errors import BenchError, InputError, OutputError, UnknownNameError
from bench.record import Run, write_recording
from bench.signals import Accelerometers, GyroFreeSolution, Kinematics, Readings
from bench.traces import FLOOR, Trace

MODELS = Path(__file__).parents[1] / "models"
RATE = 1000.0  # Hz
N = 5001  # more than one chunk of 4096 rows
FLOAT32 = 2e-7  # relative rounding of poses and arrows, with a margin


def wxyz(rotation: Rotation) -> np.ndarray:
    return np.roll(rotation.as_quat(), 1, axis=-1)


def rotation(q: np.ndarray) -> Rotation:
    return Rotation.from_quat(np.roll(q, -1, axis=-1))


def make_run(model: str = "nine_accelerometer", n: int = N) -> Run:
    """A circle of 10 m with a constant rate, and two estimates with known errors."""
    t = np.arange(n) / RATE
    zero, phase = np.zeros((n, 3)), 0.4 * t
    position = 10 * np.stack([np.cos(phase), np.sin(phase), 0 * t], axis=1)
    omega = np.tile([2.0, 1.0, -0.5], (n, 1))
    q = wxyz(Rotation.from_rotvec(omega * t[:, None]))
    truth = Kinematics(position, zero, -0.16 * position, q, omega, zero, np.array([0.0, 0.0, -9.8]))
    compiled = mujoco.MjModel.from_xml_path(str(MODELS / f"{model}.xml"))
    data = mujoco.MjData(compiled)
    mujoco.mj_forward(compiled, data)
    sites = compiled.sensor_objid[:-1]
    names = tuple(compiled.site(k).name for k in sites)
    array = Accelerometers(names, data.site_xpos[sites], data.site_xmat[sites].reshape(-1, 3, 3)[:, :, 2])
    rng = np.random.default_rng(3)
    readings = Readings(t, 10 * np.sin(t[:, None] + np.arange(len(names))) + rng.normal(size=(n, len(names))))
    estimates = {}
    for name, size in (("nine accelerometers", 1e-3), ("six/accelerometers", 1e-2)):
        error = size * t[:, None] * np.array([1.0, -2.0, 0.5])
        estimates[name] = GyroFreeSolution(
            omega + size * rng.normal(size=(n, 3)),
            zero,
            zero,
            wxyz(Rotation.from_rotvec(error) * rotation(q)),
            zero,
            position + 3 * error,
        )
    return Run(
        "a test",
        compiled,
        array,
        readings,
        truth,
        estimates,
        "# Configuration\n\nmade up",
        "# Results\n\nnone",
        {"seed": 3},
    )


@pytest.fixture(scope="module")
def run() -> Run:
    return make_run()


@pytest.fixture(scope="module")
def recording(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_recording(tmp_path_factory.mktemp("recording") / "run.rrd", run, pose_rate=100.0)


def column(path: Path, entity: str, component: str, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Times, ns, and values (n, width) of one component, sorted by time, as chunks come in any order."""
    times, values = [], []
    chunks = RrdReader(str(path)).stream().filter(content=entity, components=component, has_timeline="sim_time")
    for chunk in chunks:
        batch = chunk.to_record_batch()
        times.append(batch.column("sim_time").cast(pa.int64()).to_numpy())
        flat = batch.column(component)
        while pa.types.is_list(flat.type) or pa.types.is_fixed_size_list(flat.type):
            flat = flat.flatten()
        values.append(flat.to_numpy().reshape(len(batch), width))
    t, v = np.concatenate(times), np.concatenate(values)
    order = np.argsort(t)
    return t[order], v[order]


def entities(path: Path) -> set[str]:
    return {chunk.entity_path for chunk in RrdReader(str(path)).stream()}


def static_text(path: Path, entity: str) -> str:
    (chunk,) = RrdReader(str(path)).stream().filter(content=entity)
    return chunk.to_record_batch().column("TextDocument:text").to_pylist()[0][0]


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


def test_readings_and_rates_come_back_bit_for_bit(run: Run, recording: Path) -> None:
    for group in range(3):
        t, values = column(recording, f"/readings/{group}", "Scalars:scalars", 3)
        np.testing.assert_array_equal(t, 1_000_000 * np.arange(N))  # 1 kHz is whole milliseconds
        np.testing.assert_array_equal(values, run.readings.accelerometers[:, 3 * group : 3 * group + 3])
    for k, axis in enumerate("xyz"):
        _, values = column(recording, f"/rate/{axis}", "Scalars:scalars", 3)
        rates = [*run.estimates.values(), run.truth]
        np.testing.assert_array_equal(values, np.stack([r.omega_ib_b[:, k] for r in rates], axis=1))


def test_errors_are_those_of_the_estimates(run: Run, recording: Path) -> None:
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


def test_poses_and_arrows(run: Run, recording: Path) -> None:
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
def test_plots_are_thinned_to_the_rate(run: Run, tmp_path: Path, plot_rate: float | None, rows: int) -> None:
    path = write_recording(tmp_path / "run.rrd", run, plot_rate=plot_rate)
    t, _ = column(path, "/rate/x", "Scalars:scalars", 3)
    assert len(t) == rows


def test_one_sample_without_estimates(run: Run, tmp_path: Path) -> None:
    kinematics = {name: getattr(run.truth, name)[:1] for name in run.truth.__dataclass_fields__}
    short = replace(
        run,
        readings=Readings(run.readings.t[:1], run.readings.accelerometers[:1]),
        truth=Kinematics(**kinematics),
        estimates={},
    )
    path = write_recording(tmp_path / "run.rrd", short)
    assert "/error/attitude" not in entities(path)
    assert len(column(path, "/rate/x", "Scalars:scalars", 1)[0]) == 1


def test_bad_runs_are_refused(run: Run) -> None:
    cut = GyroFreeSolution(*(np.zeros((7, k)) for k in (3, 3, 3, 4, 3, 3)))
    with pytest.raises(InputError, match=r"estimates\['cut'\] must have one row per reading, 5001, got 7"):
        replace(run, estimates={"cut": cut})
    with pytest.raises(InputError, match="readings must have 9 channels, got 8"):
        replace(run, readings=Readings(run.readings.t, run.readings.accelerometers[:, :8]))
    with pytest.raises(InputError, match="plot_rate must be a positive number, got 0"):
        write_recording("unused.rrd", run, plot_rate=0)


def test_what_cannot_be_written_leaves_nothing(run: Run, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"no/run\.rrd' cannot be written: No such file or directory"):
        write_recording(tmp_path / "no" / "run.rrd", run)
    (tmp_path / "folder.rrd").mkdir()
    with pytest.raises(OutputError, match="Is a directory"):
        write_recording(tmp_path / "folder.rrd", run)
    assert [p.name for p in tmp_path.iterdir()] == ["folder.rrd"]


def test_import_needs_no_mujoco() -> None:
    code = "import sys, bench.record; print('mujoco' in sys.modules)"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "False"


# --- drawing ----------------------------------------------------------------------------------------------------

EVERY_KIND = """
<mujoco>
  <asset>
    <material name="red" rgba="1 0 0 0.5"/>
    <mesh name="wedge" vertex="0 0 0  1 0 0  0 2 0  0 0 3"/>
  </asset>
  <worldbody>
    <geom type="plane" size="1 1 .1"/>
    <body name="cart" pos="5 0 0">
      <freejoint/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <site name="a"/><site name="b"/><site name="c" pos="1 2 3"/>
      <geom type="box" size="1 2 3" pos="1 0 0" material="red"/>
      <geom type="sphere" size="2" material="red" rgba="0 1 0 1"/>
      <geom type="ellipsoid" size="1 2 3"/>
      <geom type="capsule" size=".5" fromto="0 0 0 0 0 4"/>
      <geom type="mesh" mesh="wedge" pos="7 0 0"/>
      <geom type="sphere" size="1" group="3"/>
      <body pos="0 0 10" euler="90 0 0">
        <geom type="cylinder" size="1 2" pos="0 1 0"/>
      </body>
    </body>
  </worldbody>
  <sensor><gyro site="a"/></sensor>
</mujoco>
"""


def test_shapes_are_those_of_the_model() -> None:
    model = mujoco.MjModel.from_xml_string(EVERY_KIND)
    body = instrumented_body(model)
    assert model.body(body).name == "cart"
    shapes = body_shapes(model, body)
    assert [s.kind for s in shapes] == ["box", "ellipsoid", "ellipsoid", "capsule", "mesh", "cylinder"]
    box, sphere, _, capsule, mesh, cylinder = shapes
    assert (box.size, box.rgba) == ((1, 2, 3), (1, 0, 0, 0.5))
    assert (sphere.size, sphere.rgba) == ((2, 2, 2), (0, 1, 0, 1))
    np.testing.assert_allclose(capsule.position, [0, 0, 2])
    assert capsule.size == (0.5, 2)
    # Turned by 90 degrees about x, the child's y is the body's z: 10 + 1, and its z is the body's -y.
    np.testing.assert_allclose(cylinder.position, [0, 0, 11], atol=1e-15)
    np.testing.assert_allclose(rotation(cylinder.quat).apply([0, 0, 1]), [0, -1, 0], atol=1e-15)
    corners, normals = mesh_triangles(model, mesh.mesh)
    placed = rotation(mesh.quat).apply(corners) + mesh.position - [7, 0, 0]
    found = {tuple(np.round(corner, 6) + 0.0) for corner in placed}
    assert found == {(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 3)}  # as in the file, though MuJoCo centres meshes
    assert len(corners) == len(normals) == 12
    labels, positions = body_sites(model, body)
    assert labels == ("a, b", "c")
    np.testing.assert_array_equal(positions, [[0, 0, 0], [1, 2, 3]])


@pytest.mark.parametrize("model", ["nine_accelerometer", "six_accelerometer", "twelve_accelerometer", "imu"])
def test_every_model_can_be_recorded(model: str, tmp_path: Path) -> None:
    path = write_recording(tmp_path / "run.rrd", make_run(model, n=50))
    assert any(entity.startswith("/world/body/instrument/box") for entity in entities(path))
    assert any(entity.startswith("/world/body/enlarged/instrument/mesh") for entity in entities(path))


def test_a_model_without_inertial_sensors_is_refused() -> None:
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    with pytest.raises(InputError, match="must have an <accelerometer> or a <gyro>"):
        instrumented_body(model)


def test_scene_keeps_both_visible() -> None:
    angle = np.linspace(0, 6, 100)
    circle = 10 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    scene = Scene.of(parts=0.1 * np.eye(3), path=circle, others=[1000 * circle], strongest=10.0)
    assert 1.0 < scene.enlarged * scene.arm < 10.0  # m: visible, yet smaller than the circle
    assert 10.0 < scene.extent < 40.0  # m: the estimate that ran away does not count
    still = Scene.of(parts=0.1 * np.eye(3), path=np.zeros((5, 3)), others=[], strongest=0.0)
    assert still.enlarged == 1.0
    assert [round_down(v) for v in (0.019, 0.02, 7.0, 100.0)] == [0.01, 0.02, 5.0, 100.0]


def test_legend_goes_where_no_line_is() -> None:
    ramp = np.linspace(0, 1, 100)[:, None]
    for values, corners in ((ramp, {"LeftTop", "RightBottom"}), (-ramp, {"LeftBottom", "RightTop"})):
        assert Trace("e", "t", ("s",), ((0, 0, 0),), values).empty_corner() in corners
    assert Trace("e", "t", ("s",), ((0, 0, 0),), 0 * ramp).empty_corner() in {"LeftTop", "RightTop"}


# --- viewer -----------------------------------------------------------------------------------------------------


def test_only_complete_recordings_are_opened(recording: Path, tmp_path: Path) -> None:
    assert viewer.check_recording(recording) == recording
    whole = recording.read_bytes()
    for name, content in (
        ("cut", whole[:-1000]),
        ("half", whole[: len(whole) // 2]),
        ("text", b"hello"),
        ("empty", b""),
    ):
        path = tmp_path / f"{name}.rrd"
        path.write_bytes(content)
        with pytest.raises(InputError, match=rf"{name}\.rrd' is not a complete \.rrd file"):
            viewer.open_recording(path)
    with pytest.raises(InputError, match=r"none\.rrd' is not a file"):
        viewer.screenshot(tmp_path / "none.rrd", tmp_path / "x.png")


def test_without_a_display_it_says_what_to_do(recording: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(BenchError, match=r"no display.*rerun run\.rrd.*strapbench view .* --screenshot run\.png"):
        viewer.open_recording(recording)


def test_with_a_display_the_native_viewer_starts(recording: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[list[str]] = []
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(viewer.subprocess, "Popen", lambda command, **_: started.append(command))
    viewer.open_recording(recording)
    (command,) = started
    assert command[1] == str(recording)
    assert command[command.index("--bind") + 1] == "127.0.0.1"


def test_bad_screenshot_options(recording: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"size\[1\] must be an integer >= 200, got 10"):
        viewer.screenshot(recording, tmp_path / "x.png", size=(800, 10))
    with pytest.raises(InputError, match="at must be"):
        viewer.screenshot(recording, tmp_path / "x.png", at=float("nan"))
    with pytest.raises(OutputError, match="no such folder"):
        viewer.screenshot(recording, tmp_path / "no" / "x.png")


def test_without_a_vulkan_driver_it_names_the_package(
    recording: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for variable in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES"):  # the loader looks nowhere else
        monkeypatch.setenv(variable, str(tmp_path / "none.json"))
    with pytest.raises(BenchError, match="mesa-vulkan-drivers"):
        viewer.screenshot(recording, tmp_path / "x.png")


@pytest.mark.slow
def test_screenshot(recording: Path, tmp_path: Path) -> None:
    from matplotlib import image

    try:
        scene = viewer.screenshot(recording, tmp_path / "scene.png", at=2.5, size=(900, 600))
    except BenchError as error:
        if "Vulkan" not in str(error):
            raise
        pytest.skip(f"no Vulkan driver: {error}")
    errors = viewer.screenshot(recording, tmp_path / "errors.png", size=(900, 600), tab="Errors")
    pictures = [image.imread(path)[:, :, :3] for path in (scene, errors)]
    for picture in pictures:
        assert picture.shape == (600, 900, 3)
        assert picture.std() > 0.02  # not one colour
    # The orange of the first estimate, (235, 137, 32), is drawn in both: lines and axes, within its shading.
    for picture in pictures:
        assert (np.abs(picture - np.array([235, 137, 32]) / 255).max(axis=2) < 0.1).sum() > 50
    assert np.abs(pictures[0] - pictures[1]).mean() > 0.01
    with pytest.raises(
        UnknownNameError, match="unknown tab 'Nonsense'; valid: Configuration, Errors, Errors by axis, Rate, "
    ):
        viewer.screenshot(recording, tmp_path / "x.png", tab="Nonsense")
