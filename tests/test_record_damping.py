"""Recording of damping filters: what is written comes back, bands lie round zero at 3 sigma, tracks where they were."""

import subprocess

import numpy as np
import pytest

import bench
from bench import viewer
from bench.record.damping import DampingRun, Estimate, write_damping_recording
from bench.units import ARCMIN, DEG, DEG_PER_H
from tests.recording_cases import column, entities, static_text

N = 5001  # more than one chunk of 4096 rows
NAMES = ("filter 1", "15 states")
FLOAT32 = 1e-6  # km: tracks are stored as such


def make_run(**change):
    """A made-up day: errors that grow in known steps, a ship that sails north-east from 50 N, 126 E."""
    t = 20.0 * np.arange(N)
    true = np.stack([50 + 1e-5 * t, 126 + 2e-5 * t], axis=1)
    states = np.arange(1, 14) * 1e-6
    estimates = {}
    for k, (name, size) in enumerate(zip(NAMES, (13, 15), strict=True)):
        columns = np.append(states, [0.1, 0.2])[:size]
        errors = (k + 1) * columns * (t[:, None] / t[-1])
        estimates[name] = Estimate(errors, np.tile(2 * columns, (N, 1)), true + errors[:, 2:4] / DEG)
    free = np.sin(t[:, None] / 800) * states * 20
    values = {
        "title": "made up",
        "t": t,
        "estimates": estimates,
        "undamped": Estimate(free, np.empty((N, 0)), true + free[:, 2:4] / DEG),
        "true_place": true,
        "gamma": 1 / (1 + np.exp(-(t - 40_000) / 5000)),
        "weight": np.linspace(1, 0, N)[:, None] ** np.arange(1, 14),
        "configuration": "# c",
        "results": "# r",
        "parameters": {"seed": 0},
    }
    return DampingRun(**{**values, **change})


@pytest.fixture(scope="module")
def run():
    return make_run()


@pytest.fixture(scope="module")
def recording(run, tmp_path_factory):
    return write_damping_recording(tmp_path_factory.mktemp("recording") / "run.rrd", run)


def test_rerun_verifies_it(recording):
    result = subprocess.run(
        [viewer._binary(), "rrd", "verify", str(recording)], capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr


def test_what_it_holds(recording):
    states = {f"/error/{k}/{line}" for k in range(7) for line in ("filter_0", "filter_1", "sigma_0", "sigma_1", "free")}
    sensors = {f"/sensor/{k}/{line}_{who}" for k in range(7, 13) for line in ("filter", "sigma") for who in (0, 1)}
    weights = {f"/fusion/{k}" for k in (0, 1, 2, "gamma")}
    assert states | sensors | weights <= entities(recording)
    assert static_text(recording, "/configuration") == "# c"
    assert static_text(recording, "/results") == "# r"


@pytest.mark.parametrize(
    ("entity", "state", "unit"),
    [("error/2", 2, ARCMIN), ("error/0", 0, 1.0), ("sensor/8", 8, 9.80665e-6), ("sensor/12", 12, DEG_PER_H)],
)
def test_errors_and_bands_come_back_in_their_units(run, recording, entity, state, unit):
    for k, name in enumerate(NAMES):
        t, value = column(recording, f"/{entity}/filter_{k}", "Scalars:scalars", 1)
        np.testing.assert_array_equal(t, (1e9 * run.t).astype(np.int64))
        np.testing.assert_allclose(value[:, 0], run.estimates[name].errors[:, state] / unit, rtol=1e-14)
        _, band = column(recording, f"/{entity}/sigma_{k}", "Scalars:scalars", 2)
        three = 3 * run.estimates[name].sigma[:, state] / unit
        np.testing.assert_allclose(band, np.stack([three, -three], axis=1), rtol=1e-14)


def test_the_undamped_ins_the_weights_and_gamma_come_back(run, recording):
    _, free = column(recording, "/error/6/free", "Scalars:scalars", 1)
    np.testing.assert_allclose(free[:, 0], run.undamped.errors[:, 6] / ARCMIN, rtol=1e-14)
    _, velocity = column(recording, "/fusion/1", "Scalars:scalars", 2)
    np.testing.assert_array_equal(velocity, run.weight[:, :2])
    _, gamma = column(recording, "/fusion/gamma", "Scalars:scalars", 1)
    np.testing.assert_array_equal(gamma[:, 0], run.gamma)


def test_places_and_tracks(run, recording):
    """The map has degrees; the track has kilometres east and north of the true place, on a sphere of 6371 km."""
    _, place = column(recording, "/map/now/filter\\ 1", "GeoPoints:positions", 2)
    expected = run.estimates["filter 1"].place
    np.testing.assert_allclose(place, expected, rtol=0, atol=1e-9)
    _, tag = column(recording, "/track/tags/filter\\ 1", "Points3D:positions", 3)
    north, east = np.radians(expected - run.true_place).T * 6371
    east *= np.cos(np.radians(run.true_place[:, 0]))
    np.testing.assert_allclose(tag, np.stack([east, north, 0 * east], axis=1), rtol=0, atol=FLOAT32)


def test_bad_input():
    with pytest.raises(bench.InputError, match="estimates must not be empty"):
        make_run(estimates={})
    with pytest.raises(bench.InputError, match="gamma must have shape"):
        make_run(gamma=np.ones(3))
    wrong = Estimate(np.ones((3, 13)), np.ones((N, 13)), np.ones((N, 2)))
    with pytest.raises(bench.InputError, match="errors of filter 1 must have shape"):
        make_run(estimates={"filter 1": wrong})


def test_nothing_is_left_where_it_cannot_be_written(run, tmp_path):
    (tmp_path / "run.rrd").mkdir()
    with pytest.raises(bench.errors.OutputError, match="cannot be written"):
        write_damping_recording(tmp_path / "run.rrd", run)
    assert [path.name for path in tmp_path.iterdir()] == ["run.rrd"]
