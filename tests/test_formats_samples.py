"""Files as other tools write them: excerpts of real recordings, and rows written by hand with known values.

The excerpts in tests/data/psins are from the PSINS toolbox, Copyright (c) 2009-2015, Gongmin Yan; see LICENSE there.
Truth of placing a local frame on the Earth: pymap3d.
"""

from functools import reduce
from pathlib import Path

import numpy as np
import pymap3d
import pytest
from scipy.io import loadmat
from scipy.spatial.transform import Rotation

from bench.errors import BenchWarning
from bench.formats import file_format
from bench.units import ARCSEC, DEG

PSINS = Path(__file__).parent / "data" / "psins"
LASER, MEMS = PSINS / "ring_laser_stationary_60s.imu", PSINS / "mems_imu_with_fog_reference_5s.mat"


# PSINS.


def test_psins_counts_of_a_ring_laser():
    recording = file_format("psins-imu", rate=100.0).read_imu(LASER)
    assert (len(recording), recording.kind, recording.dt, recording.start) == (5996, "increments", 0.01, 0.0)
    np.testing.assert_allclose(recording.angular[4], np.array([2, 0, 2]) * 0.1 * ARCSEC, rtol=1e-15)
    np.testing.assert_allclose(recording.specific[5], np.array([0, 1, 80]) * 125e-6 * 9.780327, rtol=1e-15)
    # It stands: gravity of China's latitudes, and the Earth's rate about the vertical within the gyro's noise.
    force = np.linalg.norm(recording.specific.mean(axis=0)) / recording.dt
    assert force == pytest.approx(9.797, abs=0.005)
    up = recording.angular[:, 2].mean() / recording.dt
    assert up == pytest.approx(7.292115e-5 * np.sin(34.246 * DEG), abs=0.5 * DEG / 3600)


def test_psins_header_of_a_ring_laser():
    initial = file_format("psins-imu").read_initial(LASER)
    assert initial.latitude == pytest.approx(34.246048 * DEG, abs=1e-15)
    assert initial.longitude == pytest.approx(108.909664 * DEG, abs=1e-15)
    assert initial.height == 380.0
    forward = Rotation.from_quat(initial.q_nb, scalar_first=True).apply([0, 1, 0])
    heading = np.rad2deg(np.arctan2(forward[0], forward[1]))
    assert heading == pytest.approx(90.6)  # yaw -90.6 deg, anticlockwise positive


def test_psins_matrices_of_a_drive():
    form = file_format("psins-mat", imu="mimu", avp="fogavp", kind="increments", rate=100.0)
    recording, reference = form.read_imu(MEMS), form.read_reference(MEMS)
    assert (len(recording), recording.dt, recording.t[-1]) == (501, 0.01, 5.0)
    np.testing.assert_allclose(recording.specific[0], [-1.75363752e-03, -3.02966296e-03, 8.62757935e-02], atol=1e-11)
    assert len(reference) == 51
    assert reference.height[0] == pytest.approx(172.591933, abs=1e-6)
    # Axes and senses: the gyros, less the bias that the file gives, turn as the reference does, all 24 mrad of it.
    bias = loadmat(MEMS)["eb0"][0]
    turns = Rotation.from_rotvec(recording.angular[11:] - bias * 0.01)  # after t = 0.1 s, where the reference starts
    turned = reduce(lambda whole, turn: whole * turn, turns)
    attitude = Rotation.from_quat(reference.q_nb, scalar_first=True)
    expected = (attitude[0].inv() * attitude[49]).as_rotvec()  # t = 5 s
    np.testing.assert_allclose(turned.as_rotvec(), expected, rtol=0, atol=1e-3)  # MEMS: 0.05 deg in 5 s
    assert np.abs(expected).max() > 20e-3
    # The velocity is the derivative of the position, 12 m/s, within what the reference itself is good for.
    moved = reference.r_e[-1] - reference.r_e[0]
    mean = reference.v_e[:-1].mean(axis=0) / 2 + reference.v_e[1:].mean(axis=0) / 2
    assert np.linalg.norm(moved / 5.0 - mean) < 0.06


# KF-GINS.


def test_kf_gins_is_forward_right_down(tmp_path):
    path = tmp_path / "imu.txt"
    path.write_text("  456300.000   1e-3  2e-3 3e-3   0.01 0.02 -0.0490\n\t456300.005 0 0 0 0 0 -0.0490\n")
    recording = file_format("kf-gins").read_imu(path)
    np.testing.assert_array_equal(recording.angular[0], [2e-3, 1e-3, -3e-3])
    np.testing.assert_array_equal(recording.specific[0], [0.02, 0.01, 0.0490])
    assert recording.dt == pytest.approx(0.005, rel=1e-8)


def test_kf_gins_goes_on_over_the_end_of_the_week(tmp_path):
    path = tmp_path / "imu.txt"
    path.write_text("".join(f"{second} 0 0 0 0 0 -0.098\n" for second in (604799.98, 604799.99, 0.0, 0.01)))
    recording = file_format("kf-gins", rate=100.0).read_imu(path)
    np.testing.assert_allclose(recording.t, 604799.98 + np.arange(4) / 100, rtol=0, atol=3e-10)  # rounding at 6e5 s


def test_kf_gins_reference_is_north_east_down(tmp_path):
    path = tmp_path / "truth.nav"
    path.write_text(
        "2017 604799.5 30.5 114.25 22.0 1.0 2.0 -3.0 10.0 20.0 30.0\n"
        "2018 0.0 30.5 114.25 23.5 1.0 2.0 -3.0 10.0 20.0 30.0\n"
    )
    reference = file_format("kf-gins").read_reference(path)
    np.testing.assert_array_equal(reference.t, [604799.5, 604800.0])  # over the end of the week
    np.testing.assert_allclose(reference.v_n[0], [2.0, 1.0, 3.0], rtol=0, atol=1e-14)
    assert reference.latitude[0] == pytest.approx(30.5 * DEG, abs=1e-15)
    frd = Rotation.from_euler("ZYX", [30, 20, 10], degrees=True).as_matrix()  # to NED
    enu = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
    ours = Rotation.from_quat(reference.q_nb[0], scalar_first=True).as_matrix()
    np.testing.assert_allclose(ours, enu @ frd @ enu, rtol=0, atol=1e-15)


# EuRoC.

EUROC = """#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],\
a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]
1403636579758555392,-0.1,0.15,0.08,8.2,-0.04,-3.3
1403636579763555584,-0.2,0.16,0.09,8.3,-0.05,-3.4
1403636579768555520,-0.3,0.17,0.1,8.4,-0.06,-3.5
"""
TRUTH = """#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], \
v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], \
b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]
1403636579758555392,400.0,-300.0,20.0,0.534108,-0.153029,-0.827383,-0.082152,1.0,2.0,3.0,0,0,0,0,0,0
1403636579763555584,400.0,-300.0,20.0,0.534108,-0.153029,-0.827383,-0.082152,1.0,2.0,3.0,0,0,0,0,0,0
"""
PLACE = {"origin_latitude_deg": 47.4, "origin_longitude_deg": 8.5, "origin_height": 450.0, "x_azimuth_deg": 30.0}


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_euroc_stamps_and_axes(tmp_path, end):
    path = tmp_path / "data.csv"
    path.write_bytes(EUROC.replace("\n", end).encode())
    recording = file_format("euroc", axes="URF").read_imu(path)  # x up, y right, z forward
    assert (recording.kind, recording.epoch_ns) == ("rates", 1403636579000000000)
    np.testing.assert_array_equal(recording.t, [0.758555392, 0.763555584, 0.768555520])
    np.testing.assert_array_equal(recording.angular[0], [0.15, 0.08, -0.1])
    np.testing.assert_array_equal(recording.specific[0], [-0.04, -3.3, 8.2])


def test_euroc_truth_is_placed_on_the_earth(tmp_path):
    path = tmp_path / "data.csv"
    path.write_text(TRUTH)
    reference = file_format("euroc", axes="URF", **PLACE).read_reference(path, epoch_ns=1403636579000000000)
    assert reference.t[0] == 0.758555392
    # x of the local frame points 30 deg from north to east, y 90 deg to the left of it.
    sine, cosine = np.sin(30 * DEG), np.cos(30 * DEG)
    east, north = 400 * sine - (-300) * cosine, 400 * cosine + (-300) * sine
    expected = pymap3d.enu2ecef(east, north, 20.0, 47.4, 8.5, 450.0)
    np.testing.assert_allclose(reference.r_e[0], expected, rtol=0, atol=1e-8)  # rounding at 6.4e6 m
    velocity = pymap3d.enu2uvw(sine - 2 * cosine, cosine + 2 * sine, 3.0, 47.4, 8.5)
    np.testing.assert_allclose(reference.v_e[0], velocity, rtol=0, atol=1e-14)
    # The sensor's z axis is the body's forward one.
    sensor = Rotation.from_quat([0.534108, -0.153029, -0.827383, -0.082152], scalar_first=True)
    x, y, z = sensor.apply([0, 0, 1])
    forward = pymap3d.enu2uvw(x * sine - y * cosine, x * cosine + y * sine, z, 47.4, 8.5)
    ours = Rotation.from_quat(reference.q_eb[0], scalar_first=True).apply([0, 1, 0])
    np.testing.assert_allclose(ours, forward, rtol=0, atol=1e-14)


# CSV.


def test_csv_columns_are_found_by_name(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text(
        "made by a logger\n# time [ms];note;acc Z (g);acc X (g);acc Y (g);rate z [deg s^-1];rate x [°/s];rate y\n"
        "10;start;1.0;0.1;0.2;30;10;20\n\n20;;1.0;0.1;0.2;30;10;20\n30;;1.0;0.1;0.2;30;10;20\n"
    )
    names = "t=time,gx=rate x,gy=rate y,gz=rate z,ax=acc X,ay=acc Y,az=acc Z"
    units = {"time_unit": "ms", "angular_unit": "deg/s", "specific_unit": "g"}
    form = file_format("csv", axes="RFU", columns=names, **units, delimiter=";", skip=1, range_check=False)
    recording = form.read_imu(path)
    np.testing.assert_allclose(recording.t, [0.01, 0.02, 0.03], rtol=2e-16)
    np.testing.assert_allclose(recording.angular[0], np.array([10, 20, 30]) * DEG, rtol=2e-16)
    np.testing.assert_allclose(recording.specific[0], np.array([0.1, 0.2, 1.0]) * 9.80665, rtol=2e-16)


def test_csv_columns_by_place(tmp_path):
    path = tmp_path / "log.txt"
    path.write_text("# a comment\n0.1 7 0.01 0.02 0.03 1 2 9.8\n0.2 x 0.01 0.02 0.03 1 2 9.8 # another\n")
    form = file_format(
        "csv",
        axes="FRD",
        columns="t,-,gx,gy,gz,ax,ay,az",
        header=False,
        delimiter="space",
        time_unit="s",
        angular_unit="rad/s",
        specific_unit="m/s^2",
    )
    recording = form.read_imu(path)
    np.testing.assert_array_equal(recording.angular, [[0.02, 0.01, -0.03]] * 2)
    np.testing.assert_array_equal(recording.specific, [[2, 1, -9.8]] * 2)


@pytest.mark.parametrize(("attitude", "vertical"), [("heading", "vd"), ("yaw", "vu")])
def test_csv_reference_says_which_way_is_positive(attitude, vertical, tmp_path):
    path = tmp_path / "truth.csv"
    path.write_text(
        f"lat,lon,h,t,ve,vn,{vertical},roll,pitch,{attitude}\n45,9,100,0,1,2,3,0,0,90\n45,9,100,1,1,2,3,0,0,90\n"
    )
    columns = f"t,lat,lon,h,vn,ve,{vertical},roll,pitch,{attitude}"
    reference = file_format("csv", reference_columns=columns, time_unit="s", angle_unit="deg").read_reference(path)
    np.testing.assert_allclose(reference.v_n[0], [1, 2, 3 if vertical == "vu" else -3], rtol=0, atol=1e-14)
    forward = Rotation.from_quat(reference.q_nb[0], scalar_first=True).apply([0, 1, 0])
    np.testing.assert_allclose(forward, [1 if attitude == "heading" else -1, 0, 0], rtol=0, atol=1e-15)


def test_a_last_line_without_end_is_told(tmp_path):
    path = tmp_path / "imu.txt"
    path.write_text("0.00 0 0 0 0 0 -0.098\n0.01 0 0 0 0 0 -0.0")
    with pytest.warns(BenchWarning, match="the last line has no line end; if the file was cut"):
        assert len(file_format("kf-gins").read_imu(path)) == 2
