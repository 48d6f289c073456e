"""Malformed, truncated and mis-declared files: refused with file, line and column, and how to mend it."""

import numpy as np
import pytest

from bench.errors import InputError, UnknownNameError
from bench.formats import file_format
from bench.formats._text import Layout, read_numbers
from tests.format_cases import CSV, MOTION, OPTIONS, rows, simulated, truth, write_rows
from tests.test_formats_samples import EUROC, LASER, MEMS, PLACE, TRUTH

HEAD = "t [s],gx [deg/s],gy [deg/s],gz [deg/s],ax [g],ay [g],az [g]"
BODY = [[repr(k / 100), "1", "2", "3", "0", "0", "1"] for k in range(30)]
RATES = {**CSV, "angular_unit": "deg/s", "specific_unit": "g"}


def refused(path, name, match, **options):
    with pytest.raises(InputError, match=match) as error:
        file_format(name, **options).read_imu(path)
    return str(error.value)


# Rows of numbers: every text format goes through the same reader.


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (lambda cells: cells[20].pop(), r"imu\.txt, line 21, column 7 \(dvel z\): missing; the line has 6 columns"),
        (lambda cells: cells[20].append("3"), r"imu\.txt, line 21, column 8: one too many"),
        (lambda cells: cells[20].__setitem__(3, "1e-3x"), r"line 21, column 4 \(dtheta z\): not a number: '1e-3x'"),
        (lambda cells: cells[20].__setitem__(3, "1_0"), r"line 21, column 4 \(dtheta z\): not a number: '1_0'"),
        (lambda cells: cells[39].__delitem__(slice(2, 7)), r"line 40, column 3 \(dtheta y\): missing; .*truncated"),
        (lambda cells: cells[0].__setitem__(0, "time"), r"line 1, column 1 \(seconds of week\): not a number: 'time'"),
        (lambda cells: [row.pop() for row in cells], r"line 1, column 7 \(dvel z\): missing"),
        (lambda cells: cells.clear(), "no rows of numbers"),
        (lambda cells: cells[5].__setitem__(2, "nan"), r"1 of 40 rows hold NaN or infinity \(line 6\)"),
        (lambda cells: cells[5].__setitem__(0, "nan"), r"1 of 40 rows hold NaN or infinity \(line 6\)"),
        (lambda cells: cells[5].__setitem__(2, "-inf"), r"1 of 40 rows hold NaN or infinity \(line 6\)"),
        (lambda cells: cells.__delitem__(slice(20, 22)), r"gaps \(2 missing samples\): 1, first after line 20 "),
        (lambda cells: cells.insert(20, cells[19]), "repeated times: 1, first after line 20 .*drop_repeats=True"),
        (lambda cells: cells.append(cells[30]), "steps back: 1, first after line 40 .*sort it by time"),
    ],
)
def test_wrong_rows(change, match, tmp_path):
    cells = rows()
    change(cells)
    message = refused(write_rows(tmp_path / "imu.txt", cells), "kf-gins", match)
    assert message.startswith(str(tmp_path / "imu.txt"))


def test_lines_are_counted_as_an_editor_does(tmp_path):
    """Blank lines and comments count, although they are no rows."""
    path = tmp_path / "a.txt"
    path.write_text("% head\n\n1 2\n% more\n3 4 % same line\n\n5 x\n")
    layout = Layout(("a", "b"), comment="%")
    with pytest.raises(InputError, match=r"line 7, column 2 \(b\): not a number: 'x'"):
        read_numbers(path, layout)
    path.write_text(path.read_text().replace("x", "6"))
    table = read_numbers(path, layout)
    np.testing.assert_array_equal(table.values, [[1, 2], [3, 4], [5, 6]])
    assert [table.where(k) for k in range(3)] == ["line 3", "line 5", "line 7"]


@pytest.mark.parametrize(
    "content", [b"\x00\x01\x02\xff\xfe" * 100, b"", b"\n\n", "0.1 1 2 3 4 5 ß\n".encode("latin-1")]
)
def test_what_is_no_text(content, tmp_path):
    path = tmp_path / "imu.txt"
    path.write_bytes(content)
    refused(path, "kf-gins", r"imu\.txt.*(line 1, column|no rows of numbers)")


def test_a_byte_order_mark_is_no_number(tmp_path):
    path = write_rows(tmp_path / "imu.txt", rows())
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert len(file_format("kf-gins").read_imu(path)) == 40


def test_files_that_are_not_there(tmp_path):
    for path in (tmp_path / "none.txt", tmp_path):
        refused(path, "kf-gins", "path must be a file")


# Options that all formats have.


def test_a_wrong_rate(tmp_path):
    path = write_rows(tmp_path / "imu.txt", rows())
    assert file_format("kf-gins", rate=100.0).read_imu(path).dt == 0.01
    refused(path, "kf-gins", "declared rate 200 Hz, but the times tell 100 Hz", rate=200.0)
    refused(LASER, "psins-imu", "declared rate 200 Hz, but the times tell 100 Hz", rate=200.0)


def test_a_stretch_may_be_read_alone(tmp_path):
    cells = rows()
    cells[5][2] = "nan"
    path = write_rows(tmp_path / "imu.txt", [*cells[:10], *cells[12:]])
    part = file_format("kf-gins", start=100.15, stop=100.3).read_imu(path)
    assert (len(part), part.t[0], part.t[-1]) == (16, 100.15, 100.3)
    refused(path, "kf-gins", r"rows hold NaN or infinity \(line 6\)", stop=100.2)
    refused(path, "kf-gins", "gaps .* first after line 10", start=100.06)
    refused(path, "kf-gins", r"start and stop must enclose two samples \(t from 100\.0 to 100\.39 s\)", start=200.0)


def test_gaps_are_filled_as_far_as_declared(tmp_path):
    cells = rows()
    for k, row in enumerate(cells):
        row[1] = repr(1e-3 * k)
    path = write_rows(tmp_path / "imu.txt", [*cells[:10], *cells[13:]])
    filled = file_format("kf-gins", longest_gap=0.04).read_imu(path)
    assert len(filled) == 40
    np.testing.assert_allclose(filled.t, 100 + np.arange(40) / 100, rtol=0, atol=3e-14)
    np.testing.assert_allclose(filled.angular[:, 1], 1e-3 * np.arange(40), rtol=0, atol=1e-17)
    refused(path, "kf-gins", r"gaps \(3 missing samples\): 1", longest_gap=0.03)


def test_repeats_are_dropped_if_they_are_the_same(tmp_path):
    cells = rows()
    path = write_rows(tmp_path / "imu.txt", [*cells[:10], cells[9], *cells[10:]])
    assert len(file_format("kf-gins", drop_repeats=True).read_imu(path)) == 40
    other = [*cells[9][:6], "-0.0982"]
    path = write_rows(tmp_path / "imu.txt", [*cells[:10], other, *cells[10:]])
    refused(path, "kf-gins", "repeated times: 1, first after line 10", drop_repeats=True)


@pytest.mark.parametrize(
    ("cells", "match"),
    [
        (["2", "0", "0", "0", "0", "-0.098"], "angular rate of 200 rad/s at line 1, above 100 rad/s; .* degrees"),
        (["0", "0", "0", "0", "0", "-9.8"], "median specific force of 980 m/s.2, .* rates declared as increments"),
        (["0", "0", "0", "0", "0", "-0.01"], "median specific force of 1 m/s.2, .* multiples of g"),
    ],
)
def test_values_that_suggest_another_unit(cells, match, tmp_path):
    path = write_rows(tmp_path / "imu.txt", [[row[0], *cells] for row in rows()])
    assert "range_check=False" in refused(path, "kf-gins", match)
    assert len(file_format("kf-gins", range_check=False).read_imu(path)) == 40


def test_increments_declared_as_rates():
    message = refused(MEMS, "psins-mat", "median specific force of 0.09805", imu="mimu", kind="rates")
    assert "increments declared as rates" in message


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"axes": "XYZ"}, "axes must say where"),
        ({"rate": 0.0}, "rate must be"),
        ({"jitter": 0.7}, "jitter must be below 0.5"),
        ({"longest_gap": -1.0}, "longest_gap must be"),
        ({"drop_repeats": 1}, "drop_repeats must be True or False"),
        ({"range_check": "no"}, "range_check must be True or False"),
        ({"start": "now"}, "start must be"),
        ({"columns": "t"}, "kf-gins has no option 'columns'; options: axes, rate"),
    ],
)
def test_bad_options(options, match):
    with pytest.raises(InputError, match=match):
        file_format("kf-gins", **options)


def test_unknown_formats():
    with pytest.raises(UnknownNameError, match="did you mean 'kf-gins'"):
        file_format("kfgins")


@pytest.mark.parametrize("name", ["csv", "euroc"])
def test_axes_are_not_guessed(name, tmp_path):
    options = {key: value for key, value in OPTIONS[name].items() if key != "axes"}
    (tmp_path / "imu").write_text("1,2,3\n")
    refused(tmp_path / "imu", name, f"axes must be declared for {name}", **options)
    recording = simulated() if name == "csv" else simulated().as_mean_rates()
    with pytest.raises(InputError, match="axes must be declared"):
        file_format(name, **options).write_imu(tmp_path / "new", recording)


# CSV.


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"angular_unit": ""}, "angular_unit must be declared: one of rad/s"),
        ({"specific_unit": ""}, "specific_unit must be declared: one of m/s"),
        ({"time_unit": ""}, "time_unit must be declared: one of s, ms, us, ns"),
        ({"time_unit": "min"}, "unknown time_unit 'min'"),
        ({"angular_unit": "rpm"}, "unknown angular_unit 'rpm'"),
        ({"specific_unit": "m/s"}, "angular_unit 'deg/s' is of rates, specific_unit 'm/s' of increments"),
        ({"columns": ""}, "columns must be declared: what the columns hold, such as 't,gx"),
        ({"columns": "t,gx,gy,gz,ax,ay"}, "columns must have az once, .*; not in"),
        ({"columns": "t,gx,gx,gy,gz,ax,ay,az"}, "columns must have gx once, .*; 2 times in"),
        ({"columns": "t,gx,gy,gz,ax,ay,az,temperature"}, "unknown key in columns 'temperature'"),
        ({"columns": "t,gx=wx,gy,gz,ax,ay,az"}, r"line 1: column 'wx' for gx is not in the header .*gx=NAME"),
        ({"specific_unit": "m/s^2"}, r"line 1, column 5 \(ax \[g\]\): the header says g, but m/s\^2 is declared"),
        ({"time_unit": "ms"}, r"line 1, column 1 \(t \[s\]\): the header says s, but ms is declared"),
        ({"header": False}, "line 1: names, not numbers: .*header=True reads them"),
        ({"skip": 1}, "line 2: numbers, not names; header=False"),
        ({"skip": 100}, "the file is empty after 100 lines"),
        ({"delimiter": ";"}, "line 1: column 't' for t is not in the header"),
    ],
)
def test_csv_declarations_that_do_not_fit(options, match, tmp_path):
    path = write_rows(tmp_path / "imu.csv", BODY, ",", [HEAD])
    refused(path, "csv", match, **{**RATES, **options})


@pytest.mark.parametrize("options", [{"delimiter": "|"}, {"header": 1}, {"skip": -1}])
def test_csv_options_are_checked(options):
    with pytest.raises(InputError, match=f"{next(iter(options))}"):
        file_format("csv", **options)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (lambda cells: cells[7].__setitem__(4, ""), r"imu\.csv, line 9, column 5 \(ax \[g\]\): not a number: ''"),
        (lambda cells: cells[29].pop(), r"line 31, column 7 \(az \[g\]\): missing"),
        (lambda cells: cells.clear(), "no rows of numbers"),
    ],
)
def test_csv_wrong_rows(change, match, tmp_path):
    cells = [row.copy() for row in BODY]
    change(cells)
    refused(write_rows(tmp_path / "imu.csv", cells, ",", [HEAD]), "csv", match, **RATES)


def test_csv_mixed_units_in_the_header(tmp_path):
    path = write_rows(tmp_path / "imu.csv", BODY, ",", [HEAD.replace("gy [deg/s]", "gy [rad/s]")])
    refused(path, "csv", r"line 1, column 3 \(gy \[rad/s\]\): the header says rad/s, but deg/s is declared", **RATES)


def test_csv_nanoseconds_are_integers(tmp_path):
    path = write_rows(tmp_path / "imu.csv", BODY, ",", [HEAD.replace("[s]", "[ns]")])
    refused(path, "csv", r"line 2, column 1 \(t \[ns\]\): not an integer: '0.0'", **{**RATES, "time_unit": "ns"})


def test_csv_ignored_columns_cannot_be_written(tmp_path):
    form = file_format("csv", **{**CSV, "columns": "t,-,gx,gy,gz,ax,ay,az"})
    with pytest.raises(InputError, match="'-' has no contents"):
        form.write_imu(tmp_path / "a.csv", simulated())


# EuRoC.


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("#timestamp", "#stamp", "line 1, column 1: the header of an EuRoC file must have '#timestamp"),
        ("w_RS_S_y [rad s^-1]", "w_RS_S_y [deg s^-1]", r"line 1, column 3: .* must have 'w_RS_S_y \[rad s\^-1\]' here"),
        (",a_RS_S_z [m s^-2]", "", r"line 1, column 7: .* got ''"),
        ("a_RS_S_z [m s^-2]", "a_RS_S_z [m s^-2],T", "line 1, column 8: one too many: 'T'"),
        ("1403636579763555584", "1403636579.763", r"line 3, column 1 \(timestamp\): not an integer"),
        (",0.16,", ",,", r"line 3, column 3 \(w_RS_S_y\): not a number: ''"),
    ],
)
def test_euroc_files_that_are_not(old, new, match, tmp_path):
    path = tmp_path / "data.csv"
    assert old in EUROC
    path.write_text(EUROC.replace(old, new))
    refused(path, "euroc", match, axes="URF")


def test_euroc_truth_needs_a_place(tmp_path):
    path = tmp_path / "data.csv"
    path.write_text(TRUTH)
    form = file_format("euroc", axes="URF", origin_latitude_deg=47.4)
    with pytest.raises(InputError, match="origin_height, x_azimuth_deg must be declared: EuRoC ground truth"):
        form.read_reference(path)
    with pytest.raises(InputError, match="must be declared"):
        form.write_reference(tmp_path / "new.csv", truth())
    with pytest.raises(InputError, match="origin_latitude_deg must be within"):
        file_format("euroc", axes="URF", origin_latitude_deg=470.0)


def test_euroc_truth_needs_unit_quaternions(tmp_path):
    path = tmp_path / "data.csv"
    path.write_text(TRUTH[::-1].replace("801435.0", "801437.0", 1)[::-1])  # the last row's q_RS_w
    with pytest.raises(InputError, match=r"data\.csv, line 3: q_RS must be a unit quaternion, got norm 1\.1"):
        file_format("euroc", axes="URF", **PLACE).read_reference(path)


# PSINS.


@pytest.mark.parametrize(
    ("line", "old", "new", "match"),
    [
        (13, "10.00000000", "-10", r"line 13, column 5: the interval \(ms\) must be positive, got -10"),
        (13, "9.780327", "1.0", "line 13, column 6: g must be between 9.7 and 9.9"),
        (13, "34.24604800", "134.2", "line 13, column 1: the latitude must be within"),
        (14, "125.000 125.000 125.000", "125 0 125", "line 14, column 5: a scale factor must be positive, got 0"),
        (15, "0 0 2 0 0 80", "0 0 2 0 0", r"line 15, column 6 \(accelerometer z\): missing"),
    ],
)
def test_psins_counts_that_are_wrong(line, old, new, match, tmp_path):
    lines = LASER.read_text().splitlines()[:50]
    assert old in lines[line - 1]
    lines[line - 1] = lines[line - 1].replace(old, new)
    (tmp_path / "a.imu").write_text("\n".join(lines) + "\n")
    refused(tmp_path / "a.imu", "psins-imu", match)


def test_psins_counts_without_counts(tmp_path):
    (tmp_path / "a.imu").write_text("\n".join(LASER.read_text().splitlines()[:15]) + "\n")
    refused(tmp_path / "a.imu", "psins-imu", "3 rows of header and at least 2 of counts are needed, got 4")


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"imu": "imu"}, r"imu must name a matrix of .*, got 'imu'; it holds mimu \(501, 7\), fogavp \(51, 10\)"),
        ({"imu": ""}, "none is declared; it holds mimu"),
        ({"imu": "fogavp"}, r"a real matrix of 7 columns .*, fogavp is float64 \(51, 10\)"),
        ({"kind": ""}, "kind must be declared for psins-mat: one of increments, rates"),
    ],
)
def test_psins_matrices_are_not_guessed(options, match):
    refused(MEMS, "psins-mat", match, **{"imu": "mimu", "kind": "increments", **options})


@pytest.mark.parametrize("size", [0, 90, 1000, 9000, 23000])
def test_psins_matrices_cut_off(size, tmp_path):
    path = tmp_path / "a.mat"
    path.write_bytes(MEMS.read_bytes()[:size])
    with pytest.raises(InputError, match=r"a\.mat: (not a MATLAB file, or truncated|MATLAB)|imu must name a matrix"):
        file_format("psins-mat", imu="mu0", kind="increments").read_imu(path)


def test_psins_kind_is_checked():
    with pytest.raises(UnknownNameError, match="unknown kind 'samples'"):
        file_format("psins-mat", kind="samples")


def test_matlab_7_3_is_named(tmp_path):
    path = tmp_path / "a.mat"
    path.write_bytes(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM" + bytes(512))
    refused(path, "psins-mat", "v7.3 .HDF5. is not read; save it with -v7", imu="a", kind="rates")


# References.


def nav(path, change):
    file_format("kf-gins").write_reference(path, truth())
    cells = [line.split() for line in path.read_text().splitlines()]
    change(cells)
    return write_rows(path.with_suffix(".changed"), cells)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (lambda cells: cells[5].__setitem__(2, "nan"), r"1 of 100 rows hold NaN or infinity \(line 6\)"),
        (lambda cells: cells[5].__setitem__(2, "145"), "line 6: latitude must be within 1.571 rad, got 2.53073 rad"),
        (lambda cells: cells[5].__setitem__(3, "400"), "line 6: longitude must be within 6.283 rad"),
        (lambda cells: cells[5].pop(), r"line 6, column 11 \(yaw\): missing"),
        (lambda cells: cells.insert(5, cells[4]), "times must increase, 1 do not, first after line 5"),
    ],
)
def test_wrong_rows_of_a_reference(change, match, tmp_path):
    path = nav(tmp_path / "a.nav", change)
    with pytest.raises(InputError, match=match):
        file_format("kf-gins").read_reference(path, MOTION.earth)


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"reference_columns": ""}, "reference_columns must be declared"),
        ({"reference_columns": "t,lat,lon,h,vn,ve,roll,pitch,yaw"}, "must have vd or vu once"),
        ({"angle_unit": ""}, "angle_unit must be declared: one of rad, deg"),
        ({"angle_unit": "deg"}, r"line 1, column 2 \(lat \[rad\]\): the header says rad, but deg is declared for lat"),
    ],
)
def test_csv_references_that_do_not_fit(options, match, tmp_path):
    path = tmp_path / "truth.csv"
    file_format("csv", **CSV).write_reference(path, truth())
    with pytest.raises(InputError, match=match):
        file_format("csv", **{**CSV, **options}).read_reference(path)
