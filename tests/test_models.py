"""The MJCF models have the geometry that their sources print; the numbers are written out here."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

MODELS = Path(__file__).parents[1] / "models"
L = 0.1  # m, arm of all arrays
H = 0.7071067811865476  # 1 / sqrt 2
C = 0.05773502691896258  # L / sqrt 3

# Position and sensing direction of each single-axis accelerometer: A1..A9 of Qin et al., and the cube of Chen,
# Lee and DeBra with p = +1 (+e_k face: (e_i + e_j)/sqrt 2, -e_k face: (e_i - e_j)/sqrt 2, (i, j, k) cyclic).
SINGLE = {
    "nine_accelerometer": [
        ((L, 0, 0), (1, 0, 0)),
        ((0, L, 0), (0, 1, 0)),
        ((0, 0, L), (0, 0, 1)),
        ((-L, 0, 0), (-1, 0, 0)),
        ((0, -L, 0), (0, -1, 0)),
        ((0, 0, -L), (0, 0, -1)),
        ((L, -L, 0), (H, H, 0)),
        ((L, 0, -L), (H, 0, H)),
        ((0, L, -L), (0, H, H)),
    ],
    "six_accelerometer": [
        ((L, 0, 0), (0, H, H)),
        ((0, L, 0), (H, 0, H)),
        ((0, 0, L), (H, H, 0)),
        ((-L, 0, 0), (0, H, -H)),
        ((0, -L, 0), (-H, 0, H)),
        ((0, 0, -L), (H, -H, 0)),
    ],
}
# Positions of triads with axes parallel to the body's.
TRIADS = {
    "twelve_accelerometer": [(C, C, C), (C, -C, -C), (-C, C, -C), (-C, -C, C)],
    "imu": [(0, 0, 0)],
}
ALL = [*SINGLE, *TRIADS]
ROUNDING = 1e-15  # m, or unit: a few units in the last place of numbers below 1


def load(name: str) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(MODELS / f"{name}.xml"))


def sites(model: mujoco.MjModel) -> tuple[np.ndarray, np.ndarray]:
    """Positions (m, 3) and axes (m, 3, 3) of the accelerometers' sites at rest, in the order of the sensors."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    index = model.sensor_objid[:-1]
    return data.site_xpos[index], data.site_xmat[index].reshape(-1, 3, 3)


def test_every_model_is_here() -> None:
    # The turntable, which is no free body, has its own tests.
    assert sorted(path.stem for path in MODELS.glob("*.xml")) == sorted([*ALL, "turntable"])


@pytest.mark.parametrize("name", SINGLE)
def test_single_axis_geometry(name: str) -> None:
    model = load(name)
    position, axes = sites(model)
    np.testing.assert_allclose(position, [p for p, _ in SINGLE[name]], rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(axes[:, :, 2], [d for _, d in SINGLE[name]], rtol=0, atol=ROUNDING)
    assert (model.sensor_user[:-1, 0] == 1).all()


@pytest.mark.parametrize("name", TRIADS)
def test_triad_geometry(name: str) -> None:
    model = load(name)
    position, axes = sites(model)
    np.testing.assert_allclose(position, TRIADS[name], rtol=0, atol=ROUNDING)
    np.testing.assert_array_equal(axes, np.broadcast_to(np.eye(3), axes.shape))
    assert model.nuser_sensor == 0


@pytest.mark.parametrize("name", ALL)
def test_sensors_stand_in_order_and_the_gyro_is_last(name: str) -> None:
    model = load(name)
    count = len(SINGLE.get(name, TRIADS.get(name, [])))
    accelerometers = [f"A{k}" for k in range(1, count + 1)]
    assert [model.sensor(i).name for i in range(model.nsensor)] == [*accelerometers, "gyro"]
    assert [model.site(i).name for i in model.sensor_objid] == [*accelerometers, "gyro"]
    kinds = [mujoco.mjtSensor.mjSENS_ACCELEROMETER] * count + [mujoco.mjtSensor.mjSENS_GYRO]
    assert list(model.sensor_type) == kinds
    gyro = model.site("gyro")
    np.testing.assert_array_equal(gyro.pos, [0, 0, 0])
    np.testing.assert_array_equal(gyro.quat, [1, 0, 0, 0])


@pytest.mark.parametrize("name", ALL)
def test_one_free_body_that_touches_nothing(name: str) -> None:
    model = load(name)
    assert model.nbody == 2
    assert model.body(1).name == "body"
    assert list(model.jnt_type) == [mujoco.mjtJoint.mjJNT_FREE]
    assert (model.site_bodyid == 1).all()
    assert not model.geom_contype.any()
    assert not model.geom_conaffinity.any()
    # At qpos0 the body frame is the world frame, so that what a viewer shows first is the body frame.
    np.testing.assert_array_equal(model.qpos0, [0, 0, 0, 1, 0, 0, 0])


@pytest.mark.parametrize("name", ALL)
def test_the_drawing_fits_the_instrument(name: str) -> None:
    model = load(name)
    drawn = np.flatnonzero(model.geom_bodyid == 1)
    reach = np.linalg.norm(model.geom_pos[drawn], axis=1) + model.geom_rbound[drawn]
    assert 0.05 < reach.max() < 0.25  # m: within reach of the arms or the cube, no stray part far away
    assert model.cam_bodyid[model.camera("overview").id] == 1
    # Every accelerometer carries a case and an arrow of its own, so that it is seen where it is.
    position, _ = sites(model)
    for p in position:
        assert (np.linalg.norm(model.geom_pos[drawn] - p, axis=1) < 1e-4).any() or name == "imu"
