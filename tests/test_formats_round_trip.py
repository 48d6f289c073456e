"""MuJoCo's increments and the true trajectory through every format and back: the same doubles where they fit."""

from time import process_time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import bench
from bench.errors import InputError, OutputError
from bench.formats import file_format, formats
from bench.formats._text import Layout, read_numbers, write_numbers
from bench.recording import Recording
from bench.trajectory import navigation_errors
from tests.format_cases import MOTION, OPTIONS, RATE, RATES, increments_through, simulated, truth

WITH_REFERENCE = ["csv", "euroc", "kf-gins", "psins-mat"]
# One count each, and the rounding of mean rates; all others keep every bit.
TOLERANCE = {"psins-imu": (1e-5 / 3600 * np.pi / 180, 1e-10 * 9.80665), "euroc": (1e-17, 1e-15)}


def test_every_format_is_tested():
    assert set(OPTIONS) == set(formats())


@pytest.mark.parametrize("name", OPTIONS)
def test_increments_come_back(name, tmp_path):
    written, rule = increments_through(name)
    form = file_format(name, **OPTIONS[name])
    form.write_imu(tmp_path / "imu", written, initial=MOTION.navigation_initial())
    read = form.read_imu(tmp_path / "imu")
    assert (read.kind, read.dt, read.source) == (written.kind, 1 / RATE, str(tmp_path / "imu"))
    dtheta_b, dvel_b, dt = read.increments(rule)
    angle, speed = TOLERANCE.get(name, (0.0, 0.0))
    np.testing.assert_allclose(dtheta_b, simulated().angular, rtol=0, atol=angle)
    np.testing.assert_allclose(dvel_b, simulated().specific, rtol=0, atol=speed)
    np.testing.assert_allclose(read.t, simulated().t, rtol=0, atol=1e-15)
    assert dt == simulated().dt


@pytest.mark.parametrize("name", ["csv", "euroc", "psins-mat"])
def test_rates_come_back_to_the_bit(name, tmp_path):
    rates = Recording.from_readings(bench.Rig.load("imu", threads=1).sample(MOTION, np.arange(50) / RATE))
    form = file_format(name, **RATES.get(name, OPTIONS[name]))
    form.write_imu(tmp_path / "imu", rates)
    read = form.read_imu(tmp_path / "imu")
    assert read.kind == "rates"
    for field in ("t", "angular", "specific"):
        assert getattr(read, field).tobytes() == getattr(rates, field).tobytes()


@pytest.mark.parametrize("name", WITH_REFERENCE)
def test_the_truth_comes_back(name, tmp_path):
    form = file_format(name, **OPTIONS[name])
    form.write_reference(tmp_path / "truth", truth())
    read = form.read_reference(tmp_path / "truth", MOTION.earth)
    np.testing.assert_array_equal(read.t, truth().t)
    errors = navigation_errors(read, truth())
    assert np.abs(errors.attitude).max() < 2e-15  # rounding of angles, rad
    assert np.abs(errors.velocity).max() < 5e-12  # of 3000 m/s
    assert np.abs(errors.position).max() < 5e-9  # of longitude (126 deg) in degrees: 1.4e-14 deg


@pytest.mark.parametrize("name", WITH_REFERENCE)
def test_the_truth_keeps_the_epoch_of_the_recording(name, tmp_path):
    """Both files count time from elsewhere; t of both is the same again."""
    epoch_ns = 3_600_000_000_000
    form = file_format(name, **OPTIONS[name])
    form.write_reference(tmp_path / "truth", truth(), epoch_ns=epoch_ns)
    assert form.read_reference(tmp_path / "truth", MOTION.earth).t[0] == pytest.approx(3600.01, abs=1e-9)
    read = form.read_reference(tmp_path / "truth", MOTION.earth, epoch_ns=epoch_ns)
    np.testing.assert_allclose(read.t, truth().t, rtol=0, atol=1e-12)  # rounding at 3600 s


def test_nanoseconds_beyond_doubles_keep_their_digits(tmp_path):
    """Unix time in ns does not fit a double (steps of 256 ns); the recording carries the whole seconds apart."""
    rates = simulated().as_mean_rates()
    late = Recording(rates.t, rates.angular, rates.specific, "rates", rates.dt, epoch_ns=1_403_636_579_000_000_000)
    form = file_format("euroc", **OPTIONS["euroc"])
    form.write_imu(tmp_path / "imu.csv", late)
    assert (tmp_path / "imu.csv").read_text().splitlines()[1].startswith("1403636579010000000,")
    read = form.read_imu(tmp_path / "imu.csv")
    assert read.epoch_ns == late.epoch_ns
    np.testing.assert_array_equal(read.t, late.t)
    form.write_reference(tmp_path / "truth.csv", truth(), epoch_ns=read.epoch_ns)
    np.testing.assert_array_equal(form.read_reference(tmp_path / "truth.csv", epoch_ns=read.epoch_ns).t, truth().t)


def test_csv_nanoseconds_need_not_be_the_first_column(tmp_path):
    options = {**OPTIONS["csv"], "columns": "gx,gy,gz,t,ax,ay,az", "time_unit": "ns"}
    form = file_format("csv", **options)
    for header in (True, False):
        form = file_format("csv", **options, header=header)
        form.write_imu(tmp_path / f"{header}.csv", simulated())
        read = form.read_imu(tmp_path / f"{header}.csv")
        np.testing.assert_array_equal(read.t, simulated().t)
        np.testing.assert_array_equal(read.angular, simulated().angular)


@pytest.mark.parametrize("delimiter", [",", ";", "tab", "space"])
@pytest.mark.parametrize("units", [("deg", "g*s", "ms"), ("arcsec", "ft/s", "us"), ("mrad", "m/s", "s")])
def test_csv_in_other_units(delimiter, units, tmp_path):
    angular, specific, time = units
    options = {"angular_unit": angular, "specific_unit": specific, "time_unit": time, "delimiter": delimiter}
    form = file_format("csv", **{**OPTIONS["csv"], **options})
    form.write_imu(tmp_path / "imu.csv", simulated())
    read = form.read_imu(tmp_path / "imu.csv")
    # Two roundings each.
    np.testing.assert_allclose(read.angular, simulated().angular, rtol=4e-16, atol=0)
    np.testing.assert_allclose(read.specific, simulated().specific, rtol=4e-16, atol=0)
    np.testing.assert_allclose(read.t, simulated().t, rtol=4e-16, atol=0)


def test_psins_counts_do_not_accumulate(tmp_path):
    """The sum of the written increments is within half a count of the true one at every time."""
    form = file_format("psins-imu", gyro_count_arcsec=0.1, accelerometer_count_ug_s=100.0)
    form.write_imu(tmp_path / "a.imu", simulated(), initial=MOTION.navigation_initial())
    read = form.read_imu(tmp_path / "a.imu")
    count = np.deg2rad(0.1 / 3600)
    assert np.abs(read.angular - simulated().angular).max() > 0.4 * count
    assert np.abs(np.cumsum(read.angular - simulated().angular, axis=0)).max() <= 0.5 * count * (1 + 1e-6)
    assert np.abs(np.cumsum(read.specific - simulated().specific, axis=0)).max() <= 0.5 * 980.665e-6 * (1 + 1e-6)


def test_psins_header_holds_the_initial_state(tmp_path):
    given = MOTION.navigation_initial()
    form = file_format("psins-imu")
    form.write_imu(tmp_path / "a.imu", simulated(), initial=given)
    read = form.read_initial(tmp_path / "a.imu")
    for field in ("q_nb", "v_n", "latitude", "longitude", "height"):
        np.testing.assert_allclose(getattr(read, field), getattr(given, field), rtol=4e-16, atol=4e-16)
    with pytest.raises(InputError, match="initial must be given"):
        form.write_imu(tmp_path / "b.imu", simulated())
    with pytest.raises(InputError, match="kf-gins files hold no initial state"):
        file_format("kf-gins").read_initial(tmp_path / "a.imu")


@settings(deadline=None)
@given(values=arrays(float, (5, 3), elements=st.floats(allow_nan=False, allow_infinity=False)))
def test_text_keeps_every_double(tmp_path_factory, values):
    path = tmp_path_factory.mktemp("numbers") / "a.txt"
    write_numbers(path, ["% head"], list(values.T), " ")
    read = read_numbers(path, Layout(("a", "b", "c"), comment="%"))
    assert read.values.tobytes() == values.tobytes()


def test_reading_costs_little_more_than_numpy_does(tmp_path):
    """No loop over rows in Python; processor time of both, the best of three."""
    n = 40_000
    noise = np.random.default_rng(0).normal(size=(n, 6)) * 1e-3 + [0, 0, 0, 0, 0, 0.1]
    recording = Recording(np.arange(1, n + 1) / RATE, noise[:, :3], noise[:, 3:], "increments")
    form, path = file_format("kf-gins"), tmp_path / "imu.txt"
    form.write_imu(path, recording)

    def cost(read):
        start = process_time()
        read()
        return process_time() - start

    ours = min(cost(lambda: form.read_imu(path)) for _ in range(3))
    assert ours < 2 * min(cost(lambda: np.loadtxt(path)) for _ in range(3))


# What a format cannot hold, and files that exist.


@pytest.mark.parametrize("name", ["kf-gins", "psins-imu", "csv", "psins-mat"])
def test_rates_are_not_written_as_increments(name, tmp_path):
    with pytest.raises(InputError, match="as_increments"):
        file_format(name, **OPTIONS[name]).write_imu(
            tmp_path / "a", simulated().as_mean_rates(), initial=MOTION.navigation_initial()
        )
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["euroc", "csv", "psins-mat"])
def test_increments_are_not_written_as_rates(name, tmp_path):
    with pytest.raises(InputError, match="as_mean_rates"):
        file_format(name, **RATES.get(name, OPTIONS[name])).write_imu(tmp_path / "a", simulated())
    assert not list(tmp_path.iterdir())


def test_files_are_replaced_by_force_only(tmp_path):
    form, path = file_format("kf-gins"), tmp_path / "imu.txt"
    path.write_text("precious\n")
    for write in (form.write_imu, form.write_reference):
        with pytest.raises(OutputError, match="exists; choose another name"):
            write(path, simulated() if write == form.write_imu else truth())
    assert path.read_text() == "precious\n"
    form.write_imu(path, simulated(), force=True)
    assert len(form.read_imu(path)) == 100
    assert [p.name for p in tmp_path.iterdir()] == ["imu.txt"]


def test_a_folder_that_is_not_there_is_an_output_error(tmp_path):
    with pytest.raises(OutputError, match="cannot be written: No such file"):
        file_format("kf-gins").write_imu(tmp_path / "none" / "imu.txt", simulated())


def test_formats_without_reference_say_so(tmp_path):
    form = file_format("psins-imu")
    with pytest.raises(InputError, match="psins-imu has no file of reference trajectories"):
        form.write_reference(tmp_path / "a", truth())
    (tmp_path / "a").write_text("1 2 3\n")
    with pytest.raises(InputError, match="psins-imu has no file of reference trajectories"):
        form.read_reference(tmp_path / "a")


@pytest.mark.parametrize(("method", "rule"), [("write_imu", "a Recording"), ("write_reference", "a Trajectory")])
def test_other_things_are_not_written(method, rule, tmp_path):
    with pytest.raises(InputError, match=rule):
        getattr(file_format("kf-gins"), method)(tmp_path / "a", 3)


def test_same_recording_same_file(tmp_path):
    for name in ("a", "b"):
        file_format("csv", **OPTIONS["csv"]).write_imu(tmp_path / name, simulated())
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


@pytest.mark.parametrize(("option", "match"), [({"imu": ""}, "imu must be declared"), ({"imu": "1a"}, "got '1a'")])
def test_matrices_to_write_need_a_name(option, match, tmp_path):
    with pytest.raises(InputError, match=match):
        file_format("psins-mat", **{**OPTIONS["psins-mat"], **option}).write_imu(tmp_path / "a.mat", simulated())
