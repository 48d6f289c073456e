"""Recording of a dual-Euler run: what is written comes back, and the rings stand as the angles say."""

import subprocess

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import bench
from bench import viewer
from bench.mjcf import compile_model
from bench.record.drawing import body_shapes
from bench.record.dual_euler import DualEulerRun, write_dual_euler_recording
from bench.units import ARCMIN
from tests.recording_cases import column, entities, static_text

FLOAT32 = 2e-7  # poses are stored as such
RINGS = ("outer", "middle", "inner")


def make_run(**change):
    """A made-up run of 30 s: a heading of 0.3, a pitch that passes a pole at 10 s, a roll that oscillates."""
    t = np.arange(301) / 10
    true = np.stack([np.full_like(t, 0.3), 0.5 * np.pi + 0.02 * (t - 10.0), 0.2 * np.sin(t)], axis=1)
    angles = {kind: true + 1e-4 * k for k, kind in enumerate(("true", "true_active", "output", "forward", "reverse"))}
    plain = true.copy()
    plain[np.abs(t - 10.0) < 0.25, 0] += np.pi
    values = {
        "title": "made up",
        "t": t,
        "angles": {**angles, "plain": plain},
        "errors": 1e-4 * np.stack([np.sin(t), np.cos(t), t], axis=1),
        "flag": np.where(t < 15, -1.0, 1.0),
        "plain_t": t[::2],
        "plain": plain[::2],
        "model": compile_model("turntable"),
        "configuration": "# c",
        "results": "# r",
        "parameters": {"trial": 0},
    }
    return DualEulerRun(**{**values, **change})


@pytest.fixture(scope="module")
def run():
    return make_run()


@pytest.fixture(scope="module")
def recording(run, tmp_path_factory):
    return write_dual_euler_recording(tmp_path_factory.mktemp("recording") / "run.rrd", run)


def test_rerun_verifies_it(recording):
    command = [viewer._binary(), "rrd", "verify", str(recording)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr


def test_what_it_holds(recording):
    assert {
        "/world/table/outer/middle/inner",
        "/scene/pitch",
        "/scene/flag",
        "/scene/heading/forward",
        "/scene/heading/set",
        *(f"/{page}/{angle}" for page in ("sets", "errors") for angle in ("heading", "pitch", "roll")),
    } <= entities(recording)
    assert static_text(recording, "/configuration") == "# c"
    assert static_text(recording, "/results") == "# r"


def test_rings_stand_at_the_true_angles(run, recording):
    """Outer, middle and inner turn make Rz(-heading) Rx(pitch) Ry(roll), by scipy."""
    total, entity = Rotation.identity(len(run.t)), "/world/table"
    for ring in RINGS:
        entity = f"{entity}/{ring}"
        t, q = column(recording, entity, "Transform3D:quaternion", 4)
        np.testing.assert_array_equal(t, np.round(1e9 * run.t).astype(np.int64))
        total = total * Rotation.from_quat(q)
    heading, pitch, roll = run.angles["true"].T
    expected = Rotation.from_euler("ZXY", np.stack([-heading, pitch, roll], axis=1))
    assert (total * expected.inv()).magnitude().max() < 5 * FLOAT32


def test_every_shape_of_the_table_is_drawn_once():
    model = compile_model("turntable")
    each = [len(body_shapes(model, body, below=False)) for body in range(model.nbody)]
    assert min(each) > 0
    assert sum(each) == len(body_shapes(model, 0))


def test_plots_come_back(run, recording):
    _, flag = column(recording, "/scene/flag", "Scalars:scalars", 1)
    np.testing.assert_array_equal(flag[:, 0], run.flag)
    _, error = column(recording, "/errors/roll", "Scalars:scalars", 1)
    np.testing.assert_allclose(error[:, 0], run.errors[:, 2] / ARCMIN, rtol=1e-15)
    _, sets = column(recording, "/sets/heading", "Scalars:scalars", 4)
    kinds = ("plain", "forward", "reverse", "output")
    expected = np.degrees(np.stack([run.angles[kind][:, 0] for kind in kinds], axis=1))
    np.testing.assert_allclose(sets, expected, rtol=0, atol=1e-12)
    t, plain = column(recording, "/scene/heading/forward", "Scalars:scalars", 1)
    assert len(t) == len(run.plain_t)
    np.testing.assert_allclose(plain[:, 0], np.degrees(run.plain[:, 0]), rtol=0, atol=1e-12)


def test_the_jump_is_found(run):
    assert run.passage == pytest.approx((-0.2, 19.8), abs=0.5)


def test_bad_input():
    with pytest.raises(bench.InputError, match=r"angles must have true, .*; plain is missing"):
        make_run(angles={kind: np.zeros((301, 3)) for kind in ("true", "true_active", "output")})
    with pytest.raises(bench.InputError, match="flag must have shape"):
        make_run(flag=np.ones(3))
    with pytest.raises(bench.InputError, match="errors must have shape"):
        make_run(errors=np.ones((3, 3)))


def test_another_model_is_refused(tmp_path):
    with pytest.raises(bench.InputError, match="model must have the joints heading, pitch, roll, got"):
        write_dual_euler_recording(tmp_path / "run.rrd", make_run(model=compile_model("imu")))
    assert not list(tmp_path.iterdir())
