"""Sensor axes and navigation frames against matrices written by hand and scipy's Rotation."""

from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.errors import InputError
from bench.frames import (
    aerospace_from_quat,
    axes_matrix,
    from_rfu,
    quat_from_aerospace,
    sensor_attitude,
    swap_enu_ned,
    to_rfu,
)

# Rows: right, forward, up, of a vector given along the named axes.
BY_HAND = {
    "RFU": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "FRD": [[0, 1, 0], [1, 0, 0], [0, 0, -1]],
    "FLU": [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
    "URF": [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
}
NED_TO_ENU = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
RNG = np.random.default_rng(4)


@pytest.mark.parametrize("axes", BY_HAND)
def test_axes_are_what_their_letters_say(axes):
    np.testing.assert_array_equal(axes_matrix(axes), BY_HAND[axes])
    np.testing.assert_array_equal(axes_matrix(axes.lower()), BY_HAND[axes])


@pytest.mark.parametrize("axes", BY_HAND)
def test_vectors_are_permuted_without_rounding(axes):
    v = RNG.normal(size=(5, 3))
    there = to_rfu(v, axes)
    np.testing.assert_array_equal(there, v @ np.array(BY_HAND[axes]).T)
    np.testing.assert_array_equal(from_rfu(there, axes), v)
    np.testing.assert_array_equal(to_rfu(v[0], axes), there[0])


def test_all_right_handed_axes_are_admitted_and_no_other():
    admitted = 0
    for letters in product("RLFBUD", repeat=3):
        try:
            C = axes_matrix("".join(letters))
        except InputError:
            continue
        admitted += 1
        assert np.linalg.det(C) == pytest.approx(1)
        np.testing.assert_allclose(
            Rotation.from_quat(sensor_attitude("".join(letters)), scalar_first=True).as_matrix(), C, rtol=0, atol=1e-15
        )
    assert admitted == 24


@pytest.mark.parametrize(
    ("axes", "rule"),
    [("FRU", "right-handed"), ("FFU", "three different"), ("FBU", "three different"), ("XYZ", "such as 'RFU'")],
)
def test_wrong_axes_are_refused(axes, rule):
    with pytest.raises(InputError, match=rule):
        axes_matrix(axes)


@pytest.mark.parametrize("axes", ["", "RF", "RFUU", None, 3])
def test_what_is_no_axes_is_refused(axes):
    with pytest.raises(InputError, match="axes must say where"):
        axes_matrix(axes)


def test_ned_and_enu_are_swapped_without_rounding():
    v = RNG.normal(size=(4, 3))
    np.testing.assert_array_equal(swap_enu_ned(v), v @ NED_TO_ENU.T)
    np.testing.assert_array_equal(swap_enu_ned(swap_enu_ned(v)), v)


def test_aerospace_angles_are_those_of_scipy():
    """C_ned_frd = Rz(yaw) Ry(pitch) Rx(roll), turned into ENU and RFU by matrices."""
    roll, yaw = RNG.uniform(-np.pi, np.pi, (2, 200))
    pitch = RNG.uniform(-np.pi / 2, np.pi / 2, 200)
    C = Rotation.from_euler("ZYX", np.column_stack([yaw, pitch, roll])).as_matrix()
    expected = NED_TO_ENU @ C @ np.array(BY_HAND["FRD"]).T
    q_nb = quat_from_aerospace(roll, pitch, yaw)
    ours = Rotation.from_quat(q_nb, scalar_first=True).as_matrix()
    np.testing.assert_allclose(ours, expected, rtol=0, atol=4e-15)  # rounding of matrix products
    for found, given in zip(aerospace_from_quat(q_nb), (roll, pitch, yaw), strict=True):
        np.testing.assert_allclose(np.exp(1j * found), np.exp(1j * given), rtol=0, atol=1e-13)  # rounding / cos(pitch)


def test_heading_east_nose_up():
    """Yaw +90 deg is east, pitch is nose up, roll is right wing down."""
    q = quat_from_aerospace(0.0, np.deg2rad(10), np.pi / 2)
    forward, right = (Rotation.from_quat(q, scalar_first=True).apply(axis) for axis in ([0, 1, 0], [1, 0, 0]))
    np.testing.assert_allclose(forward, [np.cos(np.deg2rad(10)), 0, np.sin(np.deg2rad(10))], rtol=0, atol=1e-15)
    np.testing.assert_allclose(right, [0, -1, 0], rtol=0, atol=1e-15)
    down_wing = Rotation.from_quat(quat_from_aerospace(0.1, 0.0, 0.0), scalar_first=True).apply([1, 0, 0])
    assert down_wing[2] == pytest.approx(-np.sin(0.1))
