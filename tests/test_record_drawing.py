"""What recordings draw: shapes and sites of a model, and the sizes of a scene, against the MJCF as written."""

import mujoco
import numpy as np
import pytest

from bench.errors import InputError
from bench.record.drawing import Scene, body_shapes, body_sites, instrumented_body, mesh_triangles, round_down
from tests.recording_cases import rotation

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
