"""External velocity: read from text, and taken to other times. Truth: numbers written by hand; a line between them."""

import numpy as np
import pytest

from bench.aiding import VelocityAiding, VelocityFile
from bench.errors import InputError, UnknownNameError

PLAIN = VelocityFile(columns="t,ve,vn", time_unit="s", velocity_unit="m/s")


@pytest.fixture
def write(tmp_path):
    def write(text):
        path = tmp_path / "log.csv"
        path.write_text(text)
        return path

    return write


def test_columns_in_any_order_and_units_as_declared(write):
    path = write("vn [kn],depth,east (kn),time [ms]\n7.2,-,3.6,1000\n14.4,-,0,2000\n")
    file = VelocityFile(columns="t=time,ve=east,vn", time_unit="ms", velocity_unit="kn")
    found = file.read(path)
    np.testing.assert_allclose(found.t, [1.0, 2.0], rtol=1e-15)
    np.testing.assert_allclose(found.v_en, np.array([[3.6, 7.2], [0.0, 14.4]]) * 1852 / 3600, rtol=1e-15)


def test_north_east_down_without_a_header(write):
    path = write("# a log\n10 2.0 1.0 -0.1\n11 3.0 1.5 0.1\n")
    file = VelocityFile(
        columns="t,vn,ve,-", time_unit="s", velocity_unit="km/h", header=False, delimiter="space", skip=1
    )
    found = file.read(path)
    np.testing.assert_allclose(found.v_en * 3.6, [[1.0, 2.0], [1.5, 3.0]], rtol=1e-15)


def test_times_in_the_recordings_clock(write):
    path = write("t,ve,vn\n1403636579763555584,1,2\n1403636580763555584,3,4\n")
    file = VelocityFile(columns="t,ve,vn", time_unit="ns", velocity_unit="m/s")
    np.testing.assert_array_equal(file.read(path, epoch_ns=1403636579000000000).t, [763555584 / 1e9, 1763555584 / 1e9])
    late = write("t,ve,vn\n100,1,2\n101,3,4\n")
    np.testing.assert_allclose(PLAIN.read(late, epoch_ns=90_000_000_000).t, [10.0, 11.0], rtol=1e-15)


def test_rows_stand_for_themselves_lines_between_them_and_nothing_in_gaps():
    aiding = VelocityAiding(
        np.array([0.0, 1.0, 2.0, 10.0, 12.5]),
        np.array([[0.0, 0.0], [1.0, -2.0], [2.0, -4.0], [5.0, 5.0], [6.0, 6.0]]),
    )
    assert (len(aiding), aiding.gaps) == (5, 1)
    found = aiding.at([-0.1, -5e-7, 0.0, 0.25, 1.0 - 5e-7, 2.0, 2.0 + 5e-7, 2.1, 9.9, 10.0, 11.25, 12.5, 12.6])
    nan = [np.nan, np.nan]
    expected = [nan, [0, 0], [0, 0], [0.25, -0.5], [1, -2], [2, -4], [2, -4], nan, nan, [5, 5], [5.5, 5.5], [6, 6], nan]
    np.testing.assert_allclose(found, expected, atol=1e-15)
    assert VelocityAiding(aiding.t, aiding.v_en, longest_gap=8.0).gaps == 0
    np.testing.assert_allclose(VelocityAiding(aiding.t, aiding.v_en, 8.0).at([6.0])[0], [3.5, 0.5])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file is empty"),
        ("t,ve,vn\n", "no rows of numbers"),
        ("t,ve,vn\n0,1,2\n", "at least two rows of velocity are needed, got 1"),
        ("t,ve\n0,1\n", "line 1: column 'vn' for vn is not in the header 't, ve'"),
        ("t,ve [km/h],vn\n0,1,2\n1,1,2\n", r"column 2 \(ve \[km/h\]\): the header says km/h, but m/s is declared"),
        ("t,ve,vn\n0,1,2\n1,1\n", r"line 3, column 3 \(vn\): missing"),
        ("t,ve,vn\n0,1,2\n1,1,two\n", r"line 3, column 3 \(vn\): not a number: 'two'"),
        ("t,ve,vn\n0,1,2\n1,,2\n", r"line 3, column 2 \(ve\): not a number: ''"),
        ("t,ve,vn\n0,1,2\n\n1,1,nan\n", r"line 4, column 'vn': must be finite, got nan; leave out rows without a vel"),
        ("t,ve,vn\n0,inf,2\n1,1,2\n", r"line 2, column 've': must be finite, got inf"),
        ("t,ve,vn\nnan,1,2\n1,1,2\n", r"line 2, column 't': must be finite, got nan"),
        ("t,ve,vn\n0,1,2\n2,1,2\n2,1,3\n", r"times must increase, 1 do not, first after line 3"),
    ],
)
def test_bad_files_are_named_by_line_and_column(write, text, message):
    with pytest.raises(InputError, match=message) as error:
        PLAIN.read(write(text))
    assert "log.csv" in str(error.value)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"columns": ""}, "columns must be declared: what the columns hold, such as 't,ve,vn'"),
        ({"columns": "t,ve"}, "columns must have vn once"),
        ({"time_unit": ""}, "time_unit must be declared: one of s, ms, us, ns"),
        ({"velocity_unit": ""}, "velocity_unit must be declared: one of m/s, km/h, kn"),
        ({"longest_gap": 0.0}, "longest_gap must be a positive number"),
        ({"header": "yes"}, "header must be"),
        ({"skip": -1}, "skip must be an integer >= 0"),
    ],
)
def test_bad_options_are_named(options, message):
    with pytest.raises(InputError, match=message):
        VelocityFile(**{**vars(PLAIN), **options})


def test_unknown_names_and_missing_files(tmp_path):
    for options in ({"columns": "t,vx,vy"}, {"velocity_unit": "mph"}, {"delimiter": "|"}):
        with pytest.raises(UnknownNameError):
            VelocityFile(**{**vars(PLAIN), **options})
    with pytest.raises(InputError, match=r"path must be a file, got .*nothing\.csv"):
        PLAIN.read(tmp_path / "nothing.csv")


def test_bad_velocities_are_named():
    with pytest.raises(InputError, match=r"v_en must have shape \(3, 2\)"):
        VelocityAiding(np.arange(3.0), np.zeros((3, 3)))
    with pytest.raises(InputError, match="t must increase strictly"):
        VelocityAiding(np.array([0.0, 2.0, 1.0]), np.zeros((3, 2)))
    with pytest.raises(InputError, match="v_en must be finite"):
        VelocityAiding(np.arange(2.0), np.array([[0.0, np.nan], [0.0, 0.0]]))
