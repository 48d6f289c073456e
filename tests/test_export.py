"""Simulated recordings in the formats of real ones. Truth: the rig's own increments, and numpy's noise-free case."""

import numpy as np
import pytest

import bench
from bench.errors import InputError
from bench.export import earth_motions, export, simulate
from bench.formats import file_format
from bench.motion.earth_rest import EarthRest
from bench.motion.fast_vehicle import FastVehicle
from bench.motion.rest import Rest
from bench.solve import solve_recording

MOTION = FastVehicle(speed=300.0)
KF = file_format("kf-gins")
EUROC = file_format("euroc", axes="FLU")


def test_the_file_holds_the_rigs_increments(tmp_path):
    path, reference = tmp_path / "imu.txt", tmp_path / "truth.nav"
    export(MOTION, path, KF, 100.0, 2.0, reference=reference, reference_every=20)
    found, true = KF.read_imu(path), bench.Rig.load("imu", threads=1).increments(MOTION, 100.0, 2.0)
    np.testing.assert_array_equal(found.angular, true.dtheta_b)  # the format keeps every bit
    np.testing.assert_array_equal(found.specific, true.dvel)
    np.testing.assert_array_equal(found.t, true.t)
    written = KF.read_reference(reference)
    np.testing.assert_array_equal(written.t, np.arange(0, 201, 20) / 100)
    np.testing.assert_allclose(written.r_e, MOTION.trajectory(written.t).r_e, atol=1e-8)  # m: degrees as text


def test_rates_are_samples_and_mean_rates_are_not(tmp_path):
    rig = bench.Rig.load("imu", threads=1)
    samples = simulate(MOTION, 100.0, 1.0, kind="rates")
    assert (samples.kind, len(samples)) == ("rates", 101)
    np.testing.assert_array_equal(samples.angular, rig.sample(MOTION, np.arange(101) / 100).gyro)
    means = simulate(MOTION, 100.0, 1.0, kind="mean-rates")
    np.testing.assert_allclose(means.angular, rig.increments(MOTION, 100.0, 1.0).dtheta_b * 100, rtol=1e-15)
    export(MOTION, tmp_path / "data.csv", EUROC, 100.0, 1.0, kind="rates")
    np.testing.assert_allclose(EUROC.read_imu(tmp_path / "data.csv").angular, samples.angular, rtol=1e-15)


def test_errors_come_from_grade_and_seed():
    still = EarthRest()
    perfect = simulate(still, 100.0, 20.0)
    first, again, other = (simulate(still, 100.0, 20.0, grade="tactical", seed=s) for s in (1, 1, 2))
    np.testing.assert_array_equal(first.angular, again.angular)
    assert np.abs(first.angular - other.angular).max() > 0
    # 0.125 deg/sqrt(h): after dt each increment scatters by that times sqrt(dt), within 5 sigma of 2000 samples.
    scatter = (first.angular - perfect.angular).std(axis=0, ddof=1)
    np.testing.assert_allclose(scatter, np.radians(0.125) / 60 * np.sqrt(0.01), rtol=5 / np.sqrt(2 * 2000))
    noise = np.column_stack([first.angular[:, 0], first.specific[:, 0]])
    assert abs(np.corrcoef(noise.T)[0, 1]) < 5 / np.sqrt(2000)  # gyro and accelerometer draw apart
    sampled = simulate(still, 100.0, 1.0, kind="rates", grade="tactical", seed=1)
    assert np.abs(sampled.angular - simulate(still, 100.0, 1.0, kind="rates").angular).max() > 0


def test_the_recording_can_be_solved(tmp_path):
    path, reference = tmp_path / "imu.txt", tmp_path / "truth.nav"
    export(MOTION, path, KF, 100.0, 4.0, reference=reference)
    solver = bench.solver("navigation", "navigation-frame", samples=5)
    solution = solve_recording(
        KF.read_imu(path), solver, MOTION.navigation_initial(), reference=KF.read_reference(reference)
    )
    errors = solution.comparison.errors
    assert (len(errors.t), solution.comparison.matched) == (401, 81)
    assert np.abs(errors.position[::5]).max() < 2e-3  # m, of 1200 m travelled: the algorithm's own error


def test_only_motions_on_the_earth():
    assert "fast-vehicle" in earth_motions()
    assert "coning" not in earth_motions()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"motion": Rest()}, "motion must be a motion on the Earth"),
        ({"kind": "samples"}, "unknown kind 'samples'"),
        ({"kind": "rates"}, "kf-gins files hold increments"),
        ({"fmt": EUROC}, "euroc files hold rates"),
        ({"grade": "tactical"}, "seed and grade must be given together, got grade 'tactical' and seed None"),
        ({"seed": 3}, "seed and grade must be given together"),
        ({"grade": "best", "seed": 1}, "unknown sensor grade 'best'"),
        ({"rate": 0.0}, "rate must be a positive number"),
        ({"duration": 0.015}, "duration must be a whole number of intervals"),
        ({"reference_every": 0}, "reference_every must be an integer >= 1"),
        ({"reference": "imu.txt"}, "reference must be another file than the recording"),
    ],
)
def test_bad_input_is_named_and_nothing_is_written(change, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    arguments = {"motion": MOTION, "path": "imu.txt", "fmt": KF, "rate": 100.0, "duration": 1.0, **change}
    with pytest.raises(InputError, match=message):
        export(**arguments)
    assert list(tmp_path.iterdir()) == []


def test_files_are_not_overwritten(tmp_path):
    path, reference = tmp_path / "imu.txt", tmp_path / "truth.nav"
    reference.write_text("mine")
    with pytest.raises(InputError, match=r"truth.nav' exists"):
        export(MOTION, path, KF, 100.0, 1.0, reference=reference)
    assert not path.exists()
    export(MOTION, path, KF, 100.0, 1.0, reference=reference, force=True)
    assert reference.read_text() != "mine"
