"""The experiment of the damped ship's INS: its runs against closed forms, its scan against direct runs.

Truth: closed forms written here, scipy's rotations and chi-square, and the printed tables.
"""

from dataclasses import replace
from itertools import product
from math import pi, radians, sqrt

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from bench.error_simulation import ErrorSimulation, disturbed
from bench.errors import InputError
from bench.experiments import _damping_published as published
from bench.experiments import _damping_scan as scan
from bench.experiments import _damping_undamped as undamped
from bench.experiments import _damping_verdicts as verdicts
from bench.experiments._damping_consistency import measure_consistency
from bench.experiments._damping_runs import CONSTANT, free_ins, measure_fast, measure_ins, simulated_ins
from bench.experiments._damping_trials import AUGMENTED, FILTERS, FIRST, FREE, Options, Work, ship
from bench.solvers.damping import DampingModel, InsSamples, error_states
from bench.solvers.damping.double_filter import DoubleFilter
from bench.table import Table
from tests.damping_experiment_cases import (
    ARCMIN,
    COLUMN_ROWS,
    COLUMN_UNITS,
    RADIUS,
    SCHULER_RATE,
    STATED,
    THEORY,
    THERE,
)


def rotation(q):
    return Rotation.from_quat(q, scalar_first=True)


class TestPeriods:
    def test_theory(self):
        assert undamped.theory(THERE) == pytest.approx(THEORY, rel=1e-9)
        assert THEORY["Schuler"] / 60 == pytest.approx(84.4, abs=0.05)  # as in every textbook
        assert undamped.theory(Options(latitude=-30.0))["Foucault"] == pytest.approx(2 * THEORY["24 h"], rel=1e-12)

    @pytest.mark.parametrize("factors", [(1.0, 1.0, 1.0), (1.2, 0.85, 1.1), (0.8, 1.2, 0.85)])
    def test_they_are_those_of_the_signals_and_not_of_theory(self, factors):
        """Noise of 1 % of the amplitude: a wave's rate is known to sqrt(24/n) 0.01/T, a period to 1e-4 at worst."""
        t = np.arange(0.0, 96 * 3600 + 1, 300.0)
        true = {name: factor * THEORY[name] for name, factor in zip(THEORY, factors, strict=True)}
        schuler, foucault, earth = (2 * pi / period * t for period in true.values())
        rng = np.random.default_rng(4)
        velocity, gyro = 1e-9 * rng.standard_normal((2, len(t), 13))
        swing = np.cos(schuler + 0.3)[:, None] * np.stack([np.sin(foucault), np.cos(foucault)], axis=1)
        velocity[:, :2] = 0.5 * swing + 0.005 * rng.standard_normal((len(t), 2))
        slow = 3.0 * (1 - np.cos(earth)) + 0.8 * np.cos(schuler) * np.cos(foucault)
        gyro[:, 2] = ARCMIN * (slow + 0.03 * rng.standard_normal(len(t)))
        assert undamped.find_periods(t, velocity, t, gyro, THEORY) == pytest.approx(true, rel=5e-4)


class TestScan:
    @pytest.mark.parametrize(
        ("size", "setting"),
        [(1.0, (48, 1e3, "acceleration", "markov")), (0.01, (44, 3600, "velocity", "markov")),
         (0.01, (52, 3600, "acceleration", "printed"))],
    )  # fmt: skip
    def test_sums_of_responses_are_what_a_run_gives(self, monkeypatch, size, setting):
        """They differ by products of errors, 0.04 arcmin of 14: a hundredth of all errors leaves 1e-4 of it."""
        setting, signs = scan.Setting(*setting), np.random.default_rng(7).choice([-1.0, 1.0], 10)
        smaller = {name: value * (1 if "tau" in name else size) for name, value in vars(CONSTANT).items()}
        told = {"CONSTANT": replace(CONSTANT, **smaller), "NOISES": (0.05 * size,), "ATTITUDES": {"-phi, deg": -1 / 60}}
        told |= {"REFERENCE_ERRORS": tuple(size * C for C in published.REFERENCE_ERRORS)}
        for name, value in {**told, "sign_table": lambda: signs[None]}.items():
            monkeypatch.setattr(scan, name, value)
        t, options = np.arange(0.0, 8 * 3600 + 1, 5.0), Options(duration=8.0)  # read once, at the end
        truth = InsSamples.of(ship(options, setting.latitude).trajectory(t))
        responses = scan.respond(options, truth, setting, seed=5)
        errors, simulation = STATED.copy(), ErrorSimulation(CONSTANT)
        errors[[0, 1, 2, 4, 6, 7, 8, 10, 11, 12]] *= signs
        ins = disturbed(truth, simulation.advance(simulation.start(size * errors), truth)[1][:, 0])
        true = error_states(ins, truth.trajectory())[-1]
        noise = 0.05 * np.random.default_rng(5).standard_normal((len(t), 2)) / sqrt(5)  # mean of five
        model = replace(DampingModel.published(setting.tau, setting.q), reference_noise=0.05 / sqrt(5))
        tolerance = size**2 * np.array([0.02, 0.1, 0.005, 0.003, 0.06, 0.002, 0.002])
        as_shown = np.array([1, 1, *[-1 / 60] * 3, 1, 1])

        def left(solution):
            return (true - solution.x[-1, :7])[COLUMN_ROWS] / COLUMN_UNITS

        for name, seconds in (("cumulative", 0.0), ("1 h", 3600.0), ("4 h", 14400.0)):
            about = {"mean": "window", "window": seconds} if seconds else {}
            double = DoubleFilter(model=model, r2_reading=setting.r2, **about)
            found = scan.best_readings(replace(responses, means={name: responses.means[name]}), setting)
            text = "".join("+" if error > 0 else "-" for error in errors)
            assert {(best.signs, best.factor) for best in found.values()} == {(text, -1 / 60)}
            for row, C in ((0, -0.1), (4, -0.5)):
                fused = double.solve(ins, truth.v_n[:, :2] + size * (C + noise))
                second = np.tensordot([1.0, *signs, size * C, size * 0.05], responses.two, 1)[0]
                assert (np.abs(second - left(fused.parts[1])) < tolerance).all()
                direct = np.stack([left(fused), left(fused.parts[0])])
                apart = np.array([best.tables[:, row] / as_shown - direct for best in found.values()])
                assert (np.abs(apart) < tolerance).all()
        apart = np.abs(found["both tables"].tables - published.BOTH) / published.LARGEST[:, None]
        assert found["both tables"].misfit == pytest.approx(sqrt((apart**2).mean()), rel=1e-12)
        for k, (group, columns) in product((0, 1), published.FAMILIES.items()):
            assert found[f"table {k + 1}, {group}"].misfit == pytest.approx(apart[k][:, columns].max(), rel=1e-12)

    def test_all_combinations_and_settings_are_there(self):
        assert len({tuple(signs) for signs in scan.sign_table()}) == 2**10
        assert len(set(scan.settings(Options(taus=(1000.0, 3600.0)), 48.0))) == 2 * 2 + 1
        np.testing.assert_array_equal(scan.reading_times(Options(duration=24.0)) / 3600, np.arange(8, 24.1, 0.5))


class TestRuns:
    """The ship rests for 1000 s, level, bow north: x is east and y north."""

    def run(self, errors, duration=600.0, rate=2.0):
        return list(free_ins(ship(THERE), rate, duration, np.asarray(errors), seed=0))

    def test_a_run_starts_with_the_stated_errors(self):
        errors = STATED * np.where(np.arange(13) % 3, 1.0, -1.0)
        for found in (self.run(errors, 10.0)[0], next(simulated_ins(ship(THERE), 10.0, errors))):
            np.testing.assert_allclose(found.errors[:, 7:], np.tile(errors[7:], (11, 1)), rtol=1e-10)
            np.testing.assert_allclose(found.errors[0], errors, rtol=0, atol=1e-14)
            ins, true = found.ins, found.truth
            np.testing.assert_allclose((ins.v_n - true.v_n)[0], [*errors[:2], 0.0], rtol=0, atol=1e-14)
            place = [ins.latitude[0] - true.latitude[0], ins.longitude[0] - true.longitude[0]]
            np.testing.assert_allclose(place, errors[2:4], rtol=0, atol=1e-15)
            turn = rotation(ins.q_nb[0]) * rotation(true.q_nb[0]).inv()  # C_c = (I - [phi x]) C_nb
            np.testing.assert_allclose(turn.as_rotvec(), -errors[4:7], rtol=0, atol=1e-15)

    @pytest.mark.parametrize("state", [7, 8, 10, 11, 12])
    def test_constant_sensor_errors_act_with_the_signs_of_the_paper(self, state):
        """Schuler's closed forms; the Earth's turn, 0.04 rad in ten minutes, takes away its square's half."""
        errors = STATED * (np.arange(13) == state)
        found, k = self.run(errors)[0], (state - 7) % 3
        turn = (rotation(found.ins.q_nb) * rotation(found.truth.q_nb).inv()).as_rotvec()
        # nabla is the accelerometer's error; eps is minus the gyro's, which turns the computed axes with it.
        shown = (found.ins.v_n - found.truth.v_n)[:, k] if state < 10 else -turn[:, k]
        swing = np.sin(SCHULER_RATE * found.ins.t) / SCHULER_RATE
        expected = errors[state] * (found.ins.t if state == 12 else swing)
        np.testing.assert_allclose(shown, expected, rtol=0, atol=2e-3 * abs(expected[-1]))

    def test_hours_join(self):
        parts, t = self.run(STATED, 2.5 * 3600), np.arange(2.5 * 3600 + 1)
        ins = InsSamples.joined(*(part.ins for part in parts))
        np.testing.assert_allclose(ins.t, t, rtol=0, atol=1e-9)
        np.testing.assert_array_equal(np.concatenate([part.truth.t for part in parts]), ins.t)
        np.testing.assert_allclose(ins.f_n, InsSamples.of(ins.trajectory()).f_n, rtol=0, atol=1e-9)
        fast = list(simulated_ins(ship(THERE), 2.0 * 3600, STATED))
        np.testing.assert_array_equal(np.concatenate([part.ins.t for part in fast]), t[: 2 * 3600 + 1])
        coarse = list(free_ins(ship(THERE), 0.5, 2 * 3600.0, STATED, 0, 300.0))
        np.testing.assert_allclose(np.concatenate([part.ins.t for part in coarse]), np.arange(25) * 300.0, atol=1e-9)

    def test_the_ship(self):
        path = ship(THERE).trajectory(np.array([0.0, 500.0, 1000.0, 1050.0, 1100.0, 40000.0, 86400.0]))
        np.testing.assert_allclose(path.v_n[:3], 0.0, rtol=0, atol=1e-12)
        np.testing.assert_allclose(path.v_n[4:], np.tile([10.0, 8.0, 0.0], (3, 1)), rtol=0, atol=1e-9)
        assert 0 < path.v_n[3, 1] < 8
        np.testing.assert_allclose(np.abs(path.q_nb), np.tile([1.0, 0, 0, 0], (7, 1)), rtol=0, atol=1e-12)
        north = 8 * (86400 - 1100) + 0.5 * 8 * 100  # m; on a sphere latitude is the way north over R
        assert path.latitude[-1] - path.latitude[0] == pytest.approx(north / RADIUS, rel=1e-6)
        assert ship(THERE, -12.0).latitude == pytest.approx(radians(-12.0))

    def test_the_ship_in_waves(self):
        t = np.arange(0.0, 120.0, 0.05)
        motion = ship(Options(sway=True))
        for k, (size, period) in enumerate(((1.0, 12.0), (2.0, 8.0), (5.0, 10.0))):  # heading, pitch, roll
            times = (t, t + period / 2, t + period)
            now, half, later = (rotation(motion.trajectory(at).q_nb).as_euler("ZXY")[:, k] for at in times)
            assert np.abs(now).max() == pytest.approx(radians(size), rel=1e-3)  # 0.05 s is 0.4 % of a turn
            np.testing.assert_allclose(now, later, rtol=0, atol=1e-9)
            np.testing.assert_allclose(now, -half, rtol=0, atol=1e-9)
        np.testing.assert_allclose(motion.trajectory(np.array([2000.0])).v_n[0], [10, 8, 0], rtol=0, atol=1e-9)


HALF_AN_HOUR = Options(duration=0.5, rate=10.0, reference_errors=(-0.3,))


@pytest.fixture(scope="module")
def both_ways():
    tables = [measure_ins(Work(HALF_AN_HOUR, 1, "ins")), measure_fast(Work(HALF_AN_HOUR, 1, "fast"))]
    results = verdicts.Results(HALF_AN_HOUR, Table.concatenate(tables))
    # They differ by products of three errors; two of them at most 7.7 arcmin, the heading's. And twice that.
    return results, 2 * (7.7 * ARCMIN) ** 2 * np.abs(results.run(FREE)[1]).max(axis=0)


class TestTwoWays:
    """The INS on the rig, and errors by their model: half an hour with the acceleration, at 10 Hz."""

    @pytest.mark.parametrize("name", [FREE, *FILTERS])
    def test_they_agree(self, both_ways, name):
        results, tolerance = both_ways
        (t, found), (t_fast, fast) = results.run(name), results.run(name, part="fast")
        np.testing.assert_allclose([t, t_fast], [np.arange(16) / 30] * 2, rtol=0, atol=1e-12)
        assert (np.abs(found - fast).max(axis=0) < tolerance).all()

    @pytest.mark.parametrize("state", [0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 12])  # nabla_z has nothing to act on
    def test_they_do_not_if_a_sign_is_wrong(self, both_ways, state):
        results, tolerance = both_ways
        wrong = HALF_AN_HOUR.initial * np.where(np.arange(13) == state, -1, 1)
        (chunk,) = simulated_ins(ship(HALF_AN_HOUR), 1800.0, wrong)
        apart = (chunk.errors[::120, COLUMN_ROWS] / COLUMN_UNITS) - results.run(FREE)[1]
        assert (np.abs(apart).max(axis=0) > 3 * tolerance).any()


class TestConsistency:
    def test_a_trial_does_not_depend_on_the_others(self):
        def trials(count, index):
            return measure_consistency(Work(Options(duration=0.5, trials=count), 3, "consistency", index))

        few, many, rest = trials(2, 0), trials(7, 0), trials(7, 5)
        assert (set(many["value"]), set(rest["value"])) == (set(range(5)), {5, 6})
        for name, trial in product(few.columns, (0, 1)):
            np.testing.assert_array_equal(few.where(value=trial)[name], many.where(value=trial)[name])
        assert not np.isin(rest["e_dv_E"], many["e_dv_E"]).any()

    def test_filter_1_is_consistent_without_a_constant_error_and_lost_with_one(self):
        """99.9 % bounds by scipy: a covariance 30 % too large or small is outside them."""
        options = Options(duration=1.0, trials=20)
        parts = [measure_consistency(Work(options, 8, "consistency", k)) for k in range(0, 20, 5)]
        results = verdicts.Results(options, Table.concatenate(parts))
        for case, name, degrees in (("none", FIRST, 13), ("drawn", AUGMENTED, 15)):
            t, found = results.consistency(case, name, "nees")
            np.testing.assert_allclose(t, [0.5, 1.0])
            low, high = chi2.ppf([0.0005, 0.9995], degrees * 20) / 20
            assert ((low < found) & (found < high)).all()
        assert results.consistency("constant", FIRST, "nees")[1].min() > 100
        mean = results.table("consistency", FIRST, case="none").where(t_h=1.0)["nees"].mean()
        assert results.consistency("none", FIRST, "nees")[1][-1] == pytest.approx(mean, rel=1e-12)


def test_printed_numbers_stand_in_their_places():
    assert published.REFERENCE_ERRORS == (-0.1, -0.2, -0.3, -0.4, -0.5)
    np.testing.assert_allclose(Options(signs="+-" * 6 + "-").initial, STATED * [*[1, -1] * 6, -1], rtol=1e-12)
    fusion, first = published.BOTH
    assert fusion[0].tolist() == [1.140, -3.100, -0.035, -0.014, -0.020, -0.081, -0.090]
    assert fusion[2].tolist() == [0.470, -4.300, -0.046, -0.009, -0.079, -0.150, -0.181]
    assert first[0].tolist() == [0.810, -5.901, -0.053, -0.033, -0.066, -0.092, -0.098]
    assert first[4].tolist() == [-8.410, -21.201, -0.150, -0.187, -0.401, -0.504, -0.498]
    largest = [[1.14, 4.5, 0.049, 0.016, 0.081, 0.15, 0.181], [8.41, 21.201, 0.15, 0.187, 0.401, 0.504, 0.498]]
    np.testing.assert_array_equal(published.LARGEST, largest)
    assert list(published.STATE) == COLUMN_ROWS
    np.testing.assert_allclose(published.SCALE, COLUMN_UNITS, rtol=1e-12)
    assert published.COLUMNS[published.FAMILIES["position"]] == ("latitude", "longitude")
    assert published.COLUMNS[published.FAMILIES["velocity"]] == ("v_E", "v_N")


BAD = {
    "duration": (0.4, 1.01), "undamped": (5.0, 8.05, "long"), "rate": (1.0, 15.0, 2.5), "sway": (1,),
    "latitude": (70.1, 0.0, np.nan, "north"), "latitudes": ((48.0, -71.0), (), (48.0, 48.0)), "mean": ("median",),
    "reference_errors": ((), (-0.1, -0.1), (0.0, -0.1), (np.nan,), -0.3), "reference_noise": (-0.01,),
    "tau": (199.0,), "taus": ((1e3, 199.0), (1e3, 1e3)), "signs": ("+" * 12, "+" * 12 + "0"), "trials": (1, 2.0),
}  # fmt: skip


@pytest.mark.parametrize(("name", "value"), [(name, value) for name, values in BAD.items() for value in values])
def test_bad_options(name, value):
    with pytest.raises(InputError, match=name):
        Options(**{name: value})
