"""Where navigation starts. Truth: directions in closed form, scipy's rotations, pymap3d's geodetic positions."""

import json

import numpy as np
import pymap3d
import pytest
from scipy.spatial.transform import Rotation

from bench.earth import WGS84
from bench.errors import InputError
from bench.recording import Recording
from bench.rotation import quat_rotate
from bench.starts import Given, starts
from bench.starts.alignment import StartCoarse, StartInertial
from bench.starts.header import StartHeader
from bench.starts.reference import StartReference
from bench.starts.values import StartFile, StartValues
from bench.trajectory import NavigationInitial, Trajectory
from bench.units import DEG

VALUES = {
    "latitude_deg": 30.5,
    "longitude_deg": 114.5,
    "height_m": 20.0,
    "velocity_enu": (1.0, 2.0, 3.0),
    "heading_deg": 90.0,
    "pitch_deg": 0.0,
    "roll_deg": 0.0,
}
PLACE = {name: VALUES[name] for name in ("latitude_deg", "longitude_deg", "height_m")}


def recording(n: int = 400, dt: float = 0.01, start: float = 100.0) -> Recording:
    """Increments of a unit that stands level at PLACE, its forward axis 40 deg clockwise from north."""
    C_nb = Rotation.from_euler("z", -40, degrees=True)
    latitude = 30.5 * DEG
    omega = 7.292115e-5 * np.array([0.0, np.cos(latitude), np.sin(latitude)])
    g = -WGS84.gravity_n(latitude, 20.0)
    rows = np.ones((n, 1)) * dt
    values = rows * C_nb.inv().apply(omega), rows * C_nb.inv().apply(g)
    return Recording(start + (np.arange(n) + 1) * dt, *values, "increments", dt)


def given(made: Recording | None = None, reference: Trajectory | None = None) -> Given:
    def header() -> NavigationInitial:
        return NavigationInitial(latitude=0.5, longitude=0.25)

    return Given(made or recording(), WGS84, reference, header)


def reference_at(t: np.ndarray) -> Trajectory:
    """A unit that goes north by 0.001 rad/s of latitude, upright."""
    n = len(t)
    latitude, zero = 0.4 + 1e-3 * (t - 100.0), np.zeros(n)
    return Trajectory.from_geodetic(WGS84, t, np.tile([1.0, 0, 0, 0], (n, 1)), np.zeros((n, 3)), latitude, zero, zero)


def test_all_are_found():
    assert set(starts()) == {"values", "file", "header", "reference", "coarse", "inertial"}


@pytest.mark.parametrize(
    ("angles", "forward", "right"),
    [
        ({"heading_deg": 90.0}, [1, 0, 0], [0, -1, 0]),  # east, so that the right side is south
        ({"heading_deg": 0.0, "pitch_deg": 90.0}, [0, 0, 1], [1, 0, 0]),  # nose up
        ({"heading_deg": 0.0, "roll_deg": 90.0}, [0, 1, 0], [0, 0, -1]),  # right side down
    ],
)
def test_angles_turn_as_they_say(angles, forward, right):
    begin = StartValues(**{**VALUES, **angles}).find(given())
    assert begin.skipped == 0
    np.testing.assert_allclose(quat_rotate(begin.initial.q_nb, [0.0, 1.0, 0.0]), forward, atol=1e-15)
    np.testing.assert_allclose(quat_rotate(begin.initial.q_nb, [1.0, 0.0, 0.0]), right, atol=1e-15)


def test_place_and_velocity_are_in_si():
    initial = StartValues(**VALUES).initial
    r_e = WGS84.position(initial.latitude, initial.longitude, initial.height)
    np.testing.assert_allclose(r_e, pymap3d.geodetic2ecef(30.5, 114.5, 20.0), atol=1e-8)  # m, a few roundings
    np.testing.assert_array_equal(initial.v_n, [1.0, 2.0, 3.0])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"latitude_deg": 91.0}, "latitude_deg must be within"),
        ({"longitude_deg": 400.0}, "longitude_deg must be within"),
        ({"height_m": np.nan}, "height_m must be finite"),
        ({"pitch_deg": -90.5}, "pitch_deg must be within"),
        ({"heading_deg": "north"}, "heading_deg must be a number, got 'north'"),
        ({"velocity_enu": (1.0, 2.0)}, "velocity_enu must have shape"),
    ],
)
def test_bad_values_are_named(change, message):
    with pytest.raises(InputError, match=message):
        StartValues(**{**VALUES, **change})


@pytest.mark.parametrize("suffix", ["json", "toml"])
def test_a_file_gives_the_same_as_numbers(suffix, tmp_path):
    path = tmp_path / f"start.{suffix}"
    values = {**VALUES, "velocity_enu": [1.0, 2.0, 3.0]}
    toml = "\n".join(f"{name} = {value}" for name, value in values.items())
    path.write_text(json.dumps(values) if suffix == "json" else toml)
    found, told = StartFile(path).find(given()).initial, StartValues(**VALUES).initial
    np.testing.assert_array_equal(found.q_nb, told.q_nb)
    np.testing.assert_array_equal(found.v_n, told.v_n)
    assert (found.latitude, found.longitude, found.height) == (told.latitude, told.longitude, told.height)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "must be TOML .* or JSON"),
        ("[1, 2]", "must hold names and values"),
        (json.dumps({k: v for k, v in VALUES.items() if k != "roll_deg"}), "misses 'roll_deg'"),
        (json.dumps({**VALUES, "yaw_deg": 3.0}), "has an unknown 'yaw_deg'"),
        (json.dumps({**VALUES, "latitude_deg": 95.0}), r"start.json': latitude_deg must be within \+-90, got 95.0"),
    ],
)
def test_bad_files_are_named(text, message, tmp_path):
    path = tmp_path / "start.json"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        StartFile(path)
    with pytest.raises(InputError, match=r"initial '.*nothing.json' cannot be read"):
        StartFile(tmp_path / "nothing.json")


def test_the_header_is_asked():
    assert StartHeader().find(given()).initial.latitude == 0.5


@pytest.mark.parametrize(
    ("first", "skipped", "latitude"),
    [
        (100.0, 0, 0.4),
        (100.5, 50, 0.4005),
        (99.7, 30, 0.4003),  # its first row within the recording is at 100.3 s
        (100.504, 50, 0.4005),  # the end of an increment is at 100.5 s; the row there is interpolated backwards
    ],
)
def test_the_references_first_row_within_the_recording(first, skipped, latitude):
    reference = reference_at(first + 0.6 * np.arange(8))
    if first == 100.504:
        reference = reference_at(np.concatenate([[99.904], reference.t]))
    begin = StartReference().find(given(reference=reference))
    assert begin.skipped == skipped
    assert begin.initial.latitude == pytest.approx(latitude, abs=1e-12)  # rad: straight in latitude, cubics are exact


def test_a_reference_out_of_time_or_missing_is_refused():
    with pytest.raises(InputError, match=r"reference.* rows within .* 500.0 to 500.6 s, .* 100.0 to 104.0 s"):
        StartReference().find(given(reference=reference_at(np.array([500.0, 500.6]))))
    with pytest.raises(InputError, match="needs a reference, got none"):
        StartReference().find(given())


@pytest.mark.parametrize("cls", [StartCoarse, StartInertial])
def test_alignment_ends_where_navigation_begins(cls):
    start = cls(seconds=3.0, **PLACE, heading_limit_deg=90.0)
    begin = start.find(given())
    assert begin.skipped == 300
    forward = quat_rotate(begin.initial.q_nb, [0.0, 1.0, 0.0])
    # Exact data: what is left is rounding of the level rate over 3 s.
    assert np.degrees(np.arctan2(forward[0], forward[1])) == pytest.approx(40.0, abs=1e-3)
    assert f"{cls.name} alignment over 3 s" in begin.note
    with pytest.raises(InputError, match=r"seconds must be a stretch within the recording of 4 s, got 4.0"):
        cls(seconds=4.0, **PLACE).find(given())


def test_a_known_heading_is_kept():
    begin = StartCoarse(seconds=2.0, **PLACE, heading_deg=77.0).find(given())
    forward = quat_rotate(begin.initial.q_nb, [0.0, 1.0, 0.0])
    assert np.degrees(np.arctan2(forward[0], forward[1])) == pytest.approx(77.0, abs=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"seconds": 0.0}, "seconds must be a positive number"),
        ({"seconds": 2.0, "latitude_deg": -91.0}, "latitude_deg must be within"),
        ({"seconds": 2.0, "gyro_sigma_deg_per_h": -1.0}, "gyro_sigma_deg_per_h must be a number >= 0"),
        ({"seconds": 2.0, "heading_limit_deg": 0.0}, "heading_limit_deg must be a positive number"),
        ({"seconds": 2.0, "heading_deg": np.inf}, "heading_deg must be finite"),
    ],
)
def test_bad_options_of_an_alignment_are_named(change, message):
    with pytest.raises(InputError, match=message):
        StartCoarse(**{**PLACE, **change})
