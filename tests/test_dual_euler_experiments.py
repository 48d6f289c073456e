"""The dual-Euler experiments: measures against made-up attitudes, verdict rules on made-up trials, short runs."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import bench
from bench.euler_angles import track
from bench.experiment import experiment
from bench.experiments import _dual_euler_angles as angles
from bench.experiments import _dual_euler_judging as judging
from bench.experiments import _dual_euler_navigation_evaluation as navigation
from bench.experiments._dual_euler_angle_trials import DUAL_ALONE, DUAL_INS, FORWARD_ALONE, QUATERNION_INS
from bench.experiments._dual_euler_navigation_trials import COLUMNS, DUAL, QUATERNION, REPORTS, START, TRIED, Options
from bench.experiments._dual_euler_runs import LATITUDE, RATE, DrivenTable, Swing, felt, reported
from bench.motion.earth_rest import EarthRest
from bench.rotation import quat_from_euler
from bench.table import Table
from bench.trajectory import navigation_errors
from bench.units import ARCMIN, DEG

SHORT = {"trials": 2, "duration": 100.0}


def attitude(psi, P, R):
    return quat_from_euler(*np.broadcast_arrays(psi, P, R))


class TestMeasures:
    t = np.arange(2501) * angles.T  # 100 s
    pitch = 90 * DEG * np.sin(2 * np.pi * t / 256)

    def judged(self, psi, P, R):
        return angles.Judged.of(self.t, attitude(psi, P, R), attitude(0.0, self.pitch, 0.0))

    def last(self, judged, column):
        return judged.rows("trial", "c", "a", 1, 0)[column][-1]

    def test_constant_errors_come_back_in_the_active_set(self):
        """A yaw error is a heading error of the other sign in both sets, which share the outer axis."""
        judged = self.judged(-2 * ARCMIN, self.pitch, 0.0)
        assert self.last(judged, "largest_heading_arcmin") == pytest.approx(2.0, rel=1e-9)
        assert self.last(judged, "largest_roll_arcmin") < 1e-6
        judged = self.judged(0.0, self.pitch - ARCMIN, 0.0)
        assert self.last(judged, "largest_pitch_arcmin") == pytest.approx(1.0, rel=1e-9)
        assert self.last(judged, "pitch_arcmin") == pytest.approx(-1.0, rel=1e-9)

    def test_a_body_that_goes_beyond_the_pole_turns_the_plain_angles_over_and_no_active_one(self):
        judged = self.judged(0.0, self.pitch * (1 + 1e-4), 0.0)  # 0.5 arcmin beyond 90 degrees at 64 s
        assert self.last(judged, "plain_heading_deg") == pytest.approx(180.0, abs=1e-6)
        assert self.last(judged, "plain_roll_deg") == pytest.approx(180.0, abs=1e-6)
        assert self.last(judged, "away_heading_arcmin") < 1e-6
        assert self.last(judged, "output_off_deg") < 0.01
        assert self.last(judged, "step_deg") < 1e-3

    def test_the_flag_is_judged_by_the_true_pitch(self):
        still = self.judged(0.0, 0.0 * self.pitch, 0.0)
        above = np.abs(self.pitch) > 50.1 * DEG
        assert self.last(still, "flag_wrong_s") == pytest.approx(above.sum() * angles.T, abs=1e-9)
        assert self.last(still, "switches") == 0
        assert self.last(still, "true_switches") == 1  # 57 degrees again at the end
        assert self.last(self.judged(0.0, self.pitch, 0.0), "flag_wrong_s") == 0

    def test_wiggles_do_not_see_a_slope(self):
        x = 0.3 * ARCMIN * np.sin(2 * np.pi * self.t / 5)  # whole periods in a block, 25 s
        judged = angles.Judged.of(self.t, attitude(0.0, 1e-3 * self.t + x, 0.0), attitude(0.0, 1e-3 * self.t, 0.0))
        rows = judged.rows("trial", "c", "a", 1, 0)
        np.testing.assert_allclose(rows["wiggle_true_arcmin"], 0.0, atol=1e-9)
        # A sine about a straight line: its slope takes away a few percent.
        np.testing.assert_allclose(rows["wiggle_error_arcmin"], 0.3 / np.sqrt(2), rtol=0.05)

    def test_series_show_the_jump(self):
        judged = self.judged(0.0, self.pitch * (1 + 1e-4), 0.0)
        shown = judged.series("series", "c", "a", 1, 0)
        assert len(shown) == 500
        assert (np.diff(shown["t_s"]) > 0).all()
        assert np.abs(shown["plain_heading_deg"]).max() == pytest.approx(180.0, abs=1e-6)
        assert np.abs(shown["output_heading_deg"]).max() < 0.01


def test_the_branch_comes_back_with_the_body():
    """Over the pole within one sample, and back round it in many: the forward angles must not stay turned over."""
    far = np.linspace(40, 89.9, 500)
    path = [(0.0, P) for P in far] + [(0.0, 90.01), (0.0, 90.02)]
    points = [Rotation.from_euler("ZXY", [0.0, P, 0.0], degrees=True) for _, P in path]
    # Back on the other side: the axis y of the body passes the vertical at 0.01 degrees.
    around = [Rotation.from_euler("zx", [0.0, P], degrees=True) for P in np.linspace(90.02, 89.9, 400)]
    points += [Rotation.from_rotvec([0.0, 0.01 * DEG, 0.0]) * one for one in around]
    points += [Rotation.from_euler("ZXY", [0.0, P, 0.0], degrees=True) for P in far[::-1]]
    q = np.array([one.as_quat(scalar_first=True) for one in points])
    found = track(q)
    np.testing.assert_allclose(np.degrees(found.forward[-1]), [0.0, 40.0, 0.0], atol=1e-6)
    assert np.abs(np.degrees(found.active[-1] - found.active[0])).max() < 1e-6


class TestRuns:
    def test_gyros_alone_know_how_n_turns(self):
        """Ideal increments, against the truth of a motion whose turn of n is 0.4 degrees in 100 s."""
        from bench.experiments._dual_euler_angle_trials import judge

        fixed = felt(Swing(100.0))
        for name, bound in ((DUAL_ALONE, 1e-6), (DUAL_INS, 1e-6), (QUATERNION_INS, 1e-6)):
            found = judge(fixed, name, reported(fixed, 0, None), 2)
            assert np.abs(found.error).max() / ARCMIN < bound, name

    def test_the_forward_solver_alone_meets_the_pole(self):
        from bench.experiments._dual_euler_angle_trials import attitude_solver, judge

        assert attitude_solver(FORWARD_ALONE, 1).name == "euler"
        fixed = felt(Swing(100.0))
        assert np.isfinite(judge(fixed, FORWARD_ALONE, reported(fixed, 0, None)).error).all()

    def test_a_trial_is_the_same_alone_and_differs_from_others(self):
        fixed = felt(Swing(100.0))
        first, again, other = (reported(fixed, 3, trial) for trial in (1, 1, 2))
        np.testing.assert_array_equal(first[0], again[0])
        assert np.abs(first[1] - other[1]).max() > 0
        # Constant drift and noise of the stated gyro over 100 s.
        drift = (first[0] - fixed.dtheta_b).sum(axis=0)
        assert np.abs(drift).max() < 5 * (0.025 * DEG / 3600 * 100 + 0.01 * DEG / 60 * 10)

    def test_the_table_moves_as_it_is_told(self):
        case = DrivenTable(0.15, rest=5.0, duration=50.0)
        pitch = track(case.motion().trajectory(np.array([0.0, 5.0, 50.0])).q_nb).forward[:, 1]
        np.testing.assert_allclose(np.degrees(pitch), [0.0, 0.0, 0.15 * 45], atol=0.1)  # fluctuations and lag
        assert case.label == "0.15 deg/s"


SWAYING = EarthRest(latitude=LATITUDE, swing=(0.0, 60 * DEG, 0.0), swing_frequency=(1.0, 0.2, 1.0))


@pytest.fixture(scope="module")
def increments():
    found = bench.Rig.load("imu", threads=1).increments(SWAYING, RATE, 60.0)
    return found.dtheta_b, found.dvel


class TestFirstOrderInertialNavigation:
    """The crude solver on a rotating body, against the closed-form truth of the motion."""

    def error(self, increments, every=1, **options):
        fine = [part.reshape(-1, every, 3).sum(axis=1) for part in increments]
        solver = bench.solver("navigation", "first-order-quaternion", **options)
        found = solver.solve(*fine, every / RATE, SWAYING.navigation_initial(), SWAYING.earth)
        return navigation_errors(found, SWAYING.trajectory(found.t))

    def test_half_an_update_too_early_or_too_late(self, increments):
        early, late = (self.error(increments, resolved=which).velocity[:, 1] for which in ("start", "end"))
        # dv/dt = -+ (P' T/2) g north: the integral of the rate is the pitch itself.
        pitch = 60 * DEG * np.sin(0.2 * SWAYING.trajectory(np.arange(6001) / RATE).t)
        expected = 0.5 / RATE * pitch * 9.795
        np.testing.assert_allclose(early, expected, rtol=0, atol=0.01 * np.abs(expected).max())
        np.testing.assert_allclose(late, -expected, rtol=0, atol=0.01 * np.abs(expected).max())

    def test_compensated_it_is_a_hundred_times_better(self, increments):
        crude, better = (
            np.abs(self.error(increments, resolved=which, height="held").velocity).max()
            for which in ("start", "middle")
        )
        assert better < 0.01 * crude

    @pytest.mark.parametrize("normalised", [False, True])
    def test_it_is_of_first_order(self, increments, normalised):
        sizes = [np.abs(self.error(increments, n, normalised=normalised).velocity).max() for n in (1, 2, 4)]
        np.testing.assert_allclose(np.log2(np.divide(sizes[1:], sizes[:-1])), 1.0, atol=0.2)

    def test_the_norm_scales_the_specific_force(self, increments):
        """|q|^2 grows by the sum of |dtheta|^2/4, and the upward force with it."""
        fast = [part.copy() for part in increments]
        grown, unit = (self.error(fast, normalised=which).velocity[:, 2] for which in (False, True))
        square = np.cumsum(np.concatenate([[0.0], (fast[0] ** 2).sum(axis=1) / 4]))
        expected = 9.795 / RATE * np.cumsum(square)
        np.testing.assert_allclose(grown - unit, expected, rtol=0.02, atol=1e-3 * expected[-1])

    def test_options(self):
        with pytest.raises(bench.UnknownNameError, match="unknown resolved 'late'; valid: end, middle, start"):
            bench.solver("navigation", "first-order-quaternion", resolved="late")
        with pytest.raises(bench.InputError, match="normalised must be True or False, got 1"):
            bench.solver("navigation", "first-order-quaternion", normalised=1)
        with pytest.raises(bench.InputError, match="samples must be an integer from 1 to 1, got 2"):
            bench.solver("navigation", "first-order-quaternion", samples=2)
        start = EarthRest(latitude=np.pi / 2).navigation_initial()
        with pytest.raises(bench.InputError, match="must start 1e-06 rad away from the poles"):
            bench.solver("navigation", "first-order-quaternion").start(0.01, start)


class TestJudging:
    @pytest.mark.parametrize(
        ("true", "judgement"),
        [(100, "holds"), (95, "holds"), (94, "cannot be judged"), (6, "cannot be judged"), (5, "does not hold")],
    )
    def test_shares(self, true, judgement):
        assert judging.judge_share(np.arange(100) < true, "", "").judgement == judgement

    def rows(self, **final):
        names = {"t_s": [25.0, 50.0] * 100}
        names |= {name: np.repeat(values, 2) for name, values in final.items()}
        return Table({name: np.asarray(column, dtype=float) for name, column in names.items()})

    def test_bound(self):
        verdict = judging.judge_bound(self.rows(largest_pitch_arcmin=np.linspace(0, 1, 100)), "pitch", 1.0)
        assert verdict.judgement == "holds"
        assert "median 0.5 arcmin" in verdict.measured
        above = self.rows(largest_pitch_arcmin=np.ones(100))
        assert judging.judge_bound(above, "pitch", 0.9).judgement == "does not hold"
        lost = judging.judge_bound(above, "pitch", 0.9, sensors_lost=True)
        assert lost.judgement == "cannot be judged"
        assert "the table of the simulation's sensors is lost" in lost.reason

    def test_flag_without_changes_follows_nothing(self):
        rows = self.rows(flag_wrong_s=np.zeros(100), switches=np.zeros(100), true_switches=np.zeros(100))
        assert judging.judge_flag(rows).judgement == "does not hold"
        rows = self.rows(flag_wrong_s=np.zeros(100), switches=np.full(100, 4), true_switches=np.full(100, 4))
        assert judging.judge_flag(rows).judgement == "holds"

    def results(self, ratio):
        """Made-up position errors: dual Euler's are `ratio` (trials,) of the others', the same at every time."""
        rows = []
        for trial, share in enumerate(ratio):
            for algorithm in TRIED:
                size = (share if algorithm is DUAL else 1.0) * (1 + trial)
                rows += [
                    ("trial", "0.15 deg/s", algorithm.label, trial, 100.0 * (k + 1), *[size] * 3)
                    for k in range(REPORTS)
                ]
        return navigation.Results(Options(rates=(0.15,)), Table.from_rows(COLUMNS, rows))

    def test_reduction(self):
        results = self.results(np.linspace(0.8, 1.0, 200))
        for against in (QUATERNION, START):
            found = results.reduction("0.15 deg/s", against)
            np.testing.assert_allclose(found[:, 0, 2], np.linspace(20, 0, 200), atol=1e-9)
        samples = {("c", "a"): results.reduction("0.15 deg/s", QUATERNION)[:, 0, 2]}
        assert navigation.judge_number(9.81, samples).judgement == "holds"
        assert navigation.judge_number(10.02, samples).reason.endswith(" 50")  # its percentile
        assert navigation.judge_number(19.9, samples).judgement == "does not hold"

    def test_both_numbers_must_be_in_reach_together(self):
        rng = np.random.default_rng(0)
        x = 10.0 * rng.standard_normal((400, 2))
        assert navigation.judge_together({("c", "a"): x}).judgement == "holds"
        opposite = np.stack([x[:, 0], -x[:, 0]], axis=1)
        assert navigation.judge_together({("c", "a"): 0.1 * opposite}).judgement == "does not hold"

    def test_everywhere_needs_every_reading(self):
        yes, no = np.ones(100, dtype=bool), np.zeros(100, dtype=bool)
        assert navigation.judge_everywhere({("a", "b"): yes, ("c", "d"): yes}, "x").judgement == "holds"
        assert navigation.judge_everywhere({("a", "b"): yes, ("c", "d"): no}, "x").judgement == "cannot be judged"
        assert navigation.judge_everywhere({("a", "b"): no}, "x").judgement == "does not hold"


class TestBadInput:
    @pytest.mark.parametrize(
        ("name", "options", "message"),
        [
            ("dual-euler-swing", {"trials": 0}, "trials must be an integer >= 1, got 0"),
            ("dual-euler-swing", {"duration": 60.0}, "duration must be a multiple of 25 s, at least 50 s, got 60.0"),
            ("dual-euler-turntable", {"rates": ()}, r"rates must be different positive numbers, got \(\)"),
            ("dual-euler-turntable", {"rates": (0.1, 0.1)}, "rates must be different positive numbers"),
            ("dual-euler-turntable", {"rates": (-0.1,)}, "rates must be a positive number, got -0.1"),
            ("dual-euler-navigation", {"rest": -1.0}, "rest must be a number >= 0, got -1.0"),
            ("dual-euler-turntable", {"duration": 50.0}, "rest must be shorter than duration = 50 s, got 100"),
            ("dual-euler-navigation", {"fluctuation": float("nan")}, "fluctuation must be finite"),
        ],
    )
    def test_options(self, name, options, message):
        with pytest.raises(bench.InputError, match=message):
            bench.run(name, **options)


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    return bench.run("dual-euler-swing", out=tmp_path_factory.mktemp("runs") / "short", seed=1, **SHORT)


def test_a_short_run_writes_everything_and_judges_nothing(short):
    assert {v.judgement for _, v in short.verdicts} == {"cannot be judged"}
    assert "duration is 100.0, not 2500.0" in short.verdicts[0][1].reason
    assert (short.folder / "recording.rrd").stat().st_size > 100_000
    assert {f.stem for f in (short.folder / "figures").iterdir()} >= {"figures_4_to_6", "figures_7_to_9", "figure_13"}


def test_number_of_jobs_does_not_change_the_bits(short):
    work = experiment("dual-euler-swing").items(short.options, 1)[0].work
    again = experiment("dual-euler-swing").measure(work)
    for name in again.columns:
        np.testing.assert_array_equal(again[name], short.rows[name])


@pytest.mark.slow
def test_a_table_of_other_rates_runs():
    outcome = bench.run("dual-euler-turntable", trials=1, duration=50.0, rates=(1.0,), rest=5.0)
    assert {v.judgement for _, v in outcome.verdicts} == {"cannot be judged"}
    low, high = (outcome.rows.where(part="series")["true_pitch_deg"].__getattribute__(end)() for end in ("min", "max"))
    assert -0.1 < low < high
    assert high == pytest.approx(45.0, abs=0.1)
