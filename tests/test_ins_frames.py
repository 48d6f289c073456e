"""The experiment on navigation frames: the rules on made-up errors, and the findings against closed forms.

Truth: closed forms written out in the tests (turn of n from the radii of the ellipsoid, the weave's own sines).
"""

import numpy as np
import pytest
from rerun.chunk import RrdReader

import bench
from bench.experiments import _ins_frames_cost as cost
from bench.experiments import _ins_frames_formulas as formulas
from bench.experiments import _ins_frames_trials as trials
from bench.experiments import _ins_frames_verdicts as verdicts
from bench.experiments._ins_frames_trials import (
    BEST,
    CONVENTIONAL,
    CONVENTIONAL_FIRST,
    DUAL,
    FLOORS,
    HARSH,
    IMPROVED,
    IMPROVED_FIRST,
    MEASURES,
    NEW,
    PAIRS,
    ROUNDING,
    TWO_SAMPLE,
    Flight,
    Options,
    flights,
    postponed,
)
from bench.experiments._ins_frames_verdicts import ATTITUDE, VELOCITY, Results
from bench.operation_count import Operations
from bench.record.stream import entity_part
from bench.solvers import solvers
from bench.table import Table
from bench.units import ARCSEC, DEG

SHORT = {
    "duration": 4.0,
    "rates": (50.0, 100.0),
    "postponed": (2, 50),
    "max_samples": 2,
    "repeats": 1,
    "timed_updates": 8,
}
MINE = ("navigation-frame", "inertial-frame", "dual-quaternion", "polynomial-exact")


@pytest.fixture(scope="module")
def ran():
    """A short run at all speeds."""
    return bench.run("ins-frames", **SHORT)


def made_up(values, options=None):
    """Results in which every error is 1, but where `values` say: {(part, algorithm, measure): function of flight}."""
    options = options or Options()
    chosen = [*TWO_SAMPLE, *(postponed(every) for every in options.postponed), BEST]
    rows = []
    for flight in flights(options):
        about = (flight.label, flight.speed, flight.weave, flight.swing)
        for part, labels in (("flight", [a.label for a in chosen]), ("difference", [*PAIRS, ROUNDING])):
            for label in labels:
                own = [values.get((part, label, m), lambda flight: 1.0)(flight) for m in MEASURES]
                rows.append((part, *about, label, 2, 100.0, *own))
    return Results(options, Table.from_rows(trials.COLUMNS, rows))


def errors(algorithms, measure, value):
    """Errors of some algorithms, as a number or as a function of the flight."""
    function = value if callable(value) else lambda flight: value
    return {("flight", algorithm.label, measure): function for algorithm in algorithms}


class TestFlights:
    """The flights are what the conditions of the experiment say."""

    def test_weave_is_half_a_g_on_each_axis_and_the_hard_one_twenty_times_that(self):
        t = np.linspace(0.0, 60.0, 6001)
        level, weave, hard = (Flight(300.0, k, False).motion for k in (0, 1, HARSH))
        n = [motion.trajectory(t).v_n - level.trajectory(t).v_n for motion in (weave, hard)]
        for amplitude, period, axis in zip(trials.WEAVE, (20.0, 16.0, 12.0), range(3), strict=True):
            w = 2 * np.pi / period
            assert 0.45 < amplitude * w**2 / 9.8 < 0.57
            # To first order; the axes of n turn a little, and longitude is an arc at the starting latitude.
            assert np.abs(n[0][:, axis]).max() == pytest.approx(amplitude * w, rel=0.02)
            assert np.abs(n[1][:, axis]).max() == pytest.approx(HARSH * amplitude * w, rel=0.05)
            assert 200 < HARSH * amplitude * w < 330  # m/s

    def test_swing_is_ten_degrees_at_one_hertz_with_phases_apart(self):
        motion = Flight(3000.0, 0, True).motion
        psi, pitch, roll = bench.rotation.euler_from_quat(motion.trajectory(np.linspace(0.0, 1.0, 1001)).q_nb)
        found = np.stack([psi - motion.attitude[0], pitch, roll])
        np.testing.assert_allclose(np.abs(found).max(axis=1), 10 * DEG, rtol=1e-4)
        assert len(set(found.argmax(axis=1))) == 3

    def test_all_speeds_manoeuvres_and_swings(self):
        found = flights(Options())
        assert len(found) == len(set(found)) == 3 * 3 * 2
        assert len({flight.label for flight in found}) == 18

    def test_items_are_the_flights_the_rates_and_the_samples(self):
        items = trials.items(Options(), 0)
        assert len({item.key for item in items}) == len(items) == 18 + 5 + 1


class TestFindings:
    """What a short run finds, against closed forms."""

    def test_postponed_compensation_is_wrong_by_what_n_turned(self, ran):
        """(k - 1) T |omega_in|, omega_in from the radii of curvature; 1 % for the latitude that changes on the way."""
        L, h, T = 45 * DEG, 20000.0, 0.02
        a, f, rate = 6378137.0, 1 / 298.257223563, 7.292115e-5
        e2 = f * (2 - f)
        R_N = a / np.sqrt(1 - e2 * np.sin(L) ** 2)
        R_M = R_N * (1 - e2) / (1 - e2 * np.sin(L) ** 2)
        for speed in (300.0, 3000.0, 7000.0):
            v = speed * np.sqrt(0.5)
            east, north = v / (R_N + h), v / (R_M + h)
            omega = np.array([-north, rate * np.cos(L) + east, rate * np.sin(L) + east * np.tan(L)])
            row = ran.rows.where(
                part="flight", flight=Flight(speed, 0, False).label, algorithm="conventional, n every 50"
            )
            assert row[ATTITUDE][0] == pytest.approx(49 * T * np.linalg.norm(omega) / ARCSEC, rel=0.01)

    def test_dual_quaternion_and_improved_are_one_algorithm(self, ran):
        """The yardstick is what the dual quaternion differs from itself by in turned body axes, over all flights."""
        exact, printed = ran.tables["equality"], ran.tables["equality_as_printed"]
        swing = np.char.endswith(exact["flight"], "swing")
        for measure, floor in zip(("attitude", "velocity", "position"), FLOORS.values(), strict=True):
            apart, rounding = (next(n for n in exact.columns if n.startswith(f"{measure} {w}")) for w in ("ap", "ro"))
            assert (exact[rounding] <= floor).all()
            assert (exact[apart] <= floor).all()
        assert (printed["velocity apart, m/s"][swing] > 1e6 * exact["velocity apart, m/s"].max()).all()

    def test_reference_is_the_bound(self, ran):
        """Six-sample polynomials: a micrometre and a tenth of a micrometre per second in every flight."""
        best = ran.rows.where(part="flight", algorithm=BEST.label)
        assert (best["position_m"] < 1e-6).all()
        assert (best["velocity_m_per_s"] < 1e-7).all()

    def test_tables_and_figures(self, ran):
        assert len(ran.tables["times"]) == len(TWO_SAMPLE)
        assert len(ran.tables["velocity_errors"]) == 18
        assert {figure.name for figure in ran.evaluation.figures} >= {"attitude", "equality", "cost"}
        lines = [line for figure in ran.evaluation.figures for panel in figure.panels for line in panel.lines]
        assert all(len(line.x) == len(line.y) > 0 for line in lines)
        assert all((line.y > 0).all() for line in lines)  # all but the counted axes are logarithmic

    def test_recording_shows_the_algorithms(self, ran, tmp_path):
        path = tmp_path / "recording.rrd"
        ran.experiment.record(ran, path)
        entities = " ".join({str(chunk.entity_path) for chunk in RrdReader(str(path)).stream()})
        for algorithm in (CONVENTIONAL, IMPROVED, DUAL, BEST):
            assert entity_part(algorithm.label) in entities

    def test_short_flights_cannot_judge_accuracy_but_cost(self, ran):
        judged = {claim.key: verdict for claim, verdict in ran.verdicts}
        assert judged["1 attitude, postponed, swing"].judgement == "cannot be judged"
        assert "4 s at 100 Hz, claims are judged over 100 s at 100 Hz" in judged["3 equal, exact, swing"].reason
        assert "cannot be judged" not in {v.judgement for key, v in judged.items() if key.startswith("5")}

    def test_every_solver_of_the_kind_that_the_paper_needs_is_run(self):
        assert {a.solver for a in (*TWO_SAMPLE, BEST)} == set(MINE) <= set(solvers("navigation"))


class TestJudging:
    """The rules, on made-up errors."""

    @pytest.mark.parametrize(("value", "judgement"), [(0.9, "holds"), (0.92, "does not hold"), (1.0, "does not hold")])
    def test_more_accurate_is_a_factor_of_more_than_ten_percent(self, value, judgement):
        results = made_up(errors(NEW, ATTITUDE, value))
        assert verdicts.judge_attitude(results, (CONVENTIONAL,), False).judgement == judgement

    def test_one_even_flight_is_enough_to_fail(self):
        odd = Flight(7000.0, HARSH, True)
        results = made_up(errors(NEW, ATTITUDE, lambda flight: 1.0 if flight == odd else 0.1))
        verdict = verdicts.judge_attitude(results, (CONVENTIONAL,), True)
        assert verdict.judgement == "does not hold"
        assert "of 18 comparisons 16 favour the new algorithms, 2 are even" in verdict.reason
        assert odd.label in verdict.reason
        assert verdicts.judge_attitude(results, (CONVENTIONAL,), False).judgement == "holds"

    def test_rounding_is_not_judged(self):
        results = made_up(errors((CONVENTIONAL,), ATTITUDE, 1e-8) | errors(NEW, ATTITUDE, 1e-9))
        assert verdicts.judge_attitude(results, (CONVENTIONAL,), True).judgement == "cannot be judged"

    def test_growth_with_speed_at_every_step(self):
        def growing(flight):
            return flight.speed

        def flat(flight):
            return min(flight.speed, 3000.0)

        for function, judgement in ((growing, "holds"), (flat, "does not hold")):
            results = made_up(errors((CONVENTIONAL,), ATTITUDE, function))
            assert verdicts.judge_speed(results, (CONVENTIONAL,), True).judgement == judgement
        one = made_up({}, Options(speeds=(300.0,)))
        assert verdicts.judge_speed(one, (CONVENTIONAL,), True).judgement == "cannot be judged"

    @pytest.mark.parametrize("measure", MEASURES)
    def test_equality_needs_every_measure(self, measure):
        assert verdicts.judge_equality(made_up({}), IMPROVED, True).judgement == "holds"
        for value in (0.9, 1.2):
            results = made_up(errors((IMPROVED_FIRST,), measure, value))
            verdict = verdicts.judge_equality(results, IMPROVED_FIRST, True)
            assert verdict.judgement == "does not hold"
            assert f"{measure.split('_')[0]} in 9 of 9 flights" in verdict.reason

    def test_fast_changes_are_judged_in_the_hard_weave(self):
        results = made_up(errors(NEW, VELOCITY, lambda flight: 0.5 if flight.weave == HARSH else 2.0))
        verdict = verdicts.judge_changes(results, CONVENTIONAL, NEW, True)
        assert verdict.judgement == "holds"
        assert "in level flight the ratio is 0.5" in verdict.reason
        results = made_up(errors(NEW, VELOCITY, lambda flight: 2.0 if flight.weave == HARSH else 0.5))
        assert verdicts.judge_changes(results, CONVENTIONAL, NEW, True).judgement == "does not hold"

    @pytest.mark.parametrize(
        ("dual", "improved", "expected"), [(2.8, 1.4, True), (1.43, 0.72, True), (2.9, 1.43, False), (1.4, 0.7, False)]
    )
    def test_cost_is_the_nearest_power_of_two(self, dual, improved, expected):
        def operations(total):
            return Operations(multiplications=600 * total, additions=300 * total, divisions=100 * total)

        totals = {CONVENTIONAL: 1.0, CONVENTIONAL_FIRST: 1.0, IMPROVED: improved, IMPROVED_FIRST: improved}
        totals[DUAL] = dual * improved
        frames = (cost.IN_E, cost.IN_N)
        judged = verdicts.judge_cost({(a.label, f): operations(total) for a, total in totals.items() for f in frames})
        assert {verdict.judgement == "holds" for verdict in judged.values()} == {expected}

    def test_runs_off_the_conditions_do_not_judge(self):
        assert verdicts.not_the_conditions(Options()) == ""
        assert "speeds are 300 m/s" in verdicts.not_the_conditions(Options(speeds=(300.0,)))
        assert "over 100 s at 100 Hz" in verdicts.not_the_conditions(Options(rate=200.0))


class TestCost:
    @pytest.mark.parametrize("algorithm", TWO_SAMPLE, ids=lambda a: a.label)
    def test_counts_are_whole_and_generic(self, algorithm):
        """Every update takes the same branches."""
        found = cost.count(algorithm)
        assert found.multiplications == int(found.multiplications) > 100
        assert found.additions + found.subtractions > 50

    def test_counted_conversions_convert(self):
        """The formulas that are counted, against views of the true trajectory; Bowring's one step is good to 1e-6 m."""
        true = Flight(3000.0, HARSH, True).motion.trajectory(np.array([0.7]))
        row = np.concatenate([true.q_eb[0], true.v_e[0], true.r_e[0]])
        p, q_en, out, lat_lon = true.earth.parameters, true.q_en[0].copy(), np.empty(10), np.empty(2)
        formulas.to_navigation(p, row, out)
        np.testing.assert_allclose(out[:2], [true.latitude[0], true.longitude[0]], rtol=0, atol=1e-12)
        np.testing.assert_allclose(out[2], true.height[0], rtol=0, atol=1e-8)
        np.testing.assert_allclose(np.sign(out[3] * true.q_nb[0, 0]) * out[3:7], true.q_nb[0], rtol=0, atol=1e-12)
        np.testing.assert_allclose(out[7:], true.v_n[0], rtol=0, atol=1e-8)
        formulas.to_earth(p, q_en, true.q_nb[0].copy(), true.v_n[0].copy(), float(true.height[0]), out)
        np.testing.assert_allclose(out[:4], row[:4], rtol=0, atol=1e-14)
        np.testing.assert_allclose(out[4:], row[4:], rtol=1e-14, atol=1e-10)
        half, tilt = 0.5 * true.longitude[0] + np.pi / 4, np.pi / 4 - 0.5 * true.latitude[0]
        formulas.angles(np.array([np.cos(half), np.sin(half), np.cos(tilt), np.sin(tilt)]), lat_lon)
        np.testing.assert_allclose(lat_lon, [true.latitude[0], true.longitude[0]], rtol=0, atol=1e-14)

    def test_rounds_are_interleaved(self, monkeypatch):
        order = []

        def runs(algorithm, updates):
            return (lambda: order.append(algorithm.label), lambda: order.append(algorithm.label))

        monkeypatch.setattr(cost, "_runs", runs)
        table = cost.timings(Options(repeats=2, timed_updates=3))
        labels = table["algorithm"].tolist()
        assert order == 3 * [label for label in labels for _ in range(2)]  # the first round is not counted
        assert len(cost.timings(Options(repeats=0))) == 0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"speeds": ()}, r"speeds must not be empty, got shape \(0,\)"),
        ({"speeds": (300.0, 300.0)}, "speeds must be different positive numbers"),
        ({"speeds": (-1.0,)}, "speeds must be different positive numbers"),
        ({"rates": (0.0,)}, "rates must be different positive numbers"),
        ({"duration": 0.0}, "duration must be a positive number, got 0.0"),
        ({"duration": 0.105}, "duration must be a whole number of intervals"),
        ({"duration": 0.04}, "duration must hold at least 8 intervals, got 4 at 100 Hz"),
        ({"rate": -1.0}, "rate must be a positive number, got -1.0"),
        ({"postponed": ()}, r"postponed must be different integers >= 2, got \(\)"),
        ({"postponed": (1,)}, "postponed must be an integer >= 2, got 1"),
        ({"max_samples": 9}, "max_samples must be an integer from 2 to 8, got 9"),
        ({"max_samples": 1}, "max_samples must be an integer >= 2, got 1"),
        ({"repeats": -1}, "repeats must be an integer >= 0, got -1"),
        ({"timed_updates": 0}, "timed_updates must be an integer >= 1, got 0"),
    ],
)
def test_bad_options(options, message):
    with pytest.raises(bench.InputError, match=message):
        Options(**options)


@pytest.mark.slow
def test_the_whole_experiment(tmp_path):
    """What the README says of it, with the files."""
    outcome = bench.run("ins-frames", out=tmp_path / "frames", record=False)
    judged = {claim.key: verdict.judgement for claim, verdict in outcome.verdicts}
    for words in ("no swing", "swing"):
        assert judged[f"1 attitude, postponed, {words}"] == judged[f"2 speed, postponed, {words}"] == "holds"
        assert judged[f"3 equal, exact, {words}"] == "holds"
        assert judged[f"3 equal, as printed, {words}"] == "does not hold"
        assert judged[f"4 fast changes, exact, {words}"] == "does not hold"
    assert judged["1 attitude, every update, no swing"] == judged["2 speed, every update, no swing"] == "holds"
    assert judged["1 attitude, every update, swing"] == judged["2 speed, every update, swing"] == "does not hold"
    assert "cannot be judged" not in judged.values()
    best = outcome.rows.where(part="flight", algorithm=BEST.label)
    assert (best["position_m"] < 1e-6).all()
    assert (best["velocity_m_per_s"] < 1e-7).all()
    exact = outcome.tables["equality"]
    for quantity, floor in zip(("attitude", "velocity", "position"), FLOORS.values(), strict=True):
        for what in ("apart", "rounding"):
            (name,) = (n for n in exact.columns if n.startswith(f"{quantity} {what}"))
            assert exact[name].max() <= floor
    for algorithm in (CONVENTIONAL, IMPROVED, DUAL):  # fourth order, as long as the rotation vector is what errs
        rows = outcome.tables["convergence_rate"].where(algorithm=algorithm.label)
        np.testing.assert_allclose(rows["order"], 4.0, atol=0.05)
    drawn = {path.name for path in (outcome.folder / "figures").iterdir()}
    assert drawn == {f"{figure.name}.png" for figure in outcome.evaluation.figures}
