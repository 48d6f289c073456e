"""The attitude experiments: short runs, the rules on made-up errors, and the main findings against other numbers."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from rerun.chunk import RrdReader

import bench
from bench.evaluation import attitude_error, euler_error
from bench.experiments import _attitude_coning_verdicts as coning
from bench.experiments import _attitude_judging as judging
from bench.experiments import _attitude_manoeuvre_verdicts as manoeuvre
from bench.experiments import _attitude_trials as trials
from bench.experiments._attitude_coning_trials import RATES
from bench.experiments._attitude_coning_trials import Options as ConingOptions
from bench.experiments._attitude_judging import FLOOR, Band, Curve, judge, orders, printed_orders
from bench.experiments._attitude_manoeuvre_trials import Options as ManoeuvreOptions
from bench.experiments._attitude_trials import (
    ALL,
    DCM,
    NEW,
    OPTIMISED,
    PRINTED,
    QUATERNION,
    READINGS,
    SAMPLES,
    SONG,
    Errors,
    Truth,
)
from bench.motion.coning import Coning
from bench.motion.savage_manoeuvre import SavageManoeuvre
from bench.rotation import quat_from_rotvec, quat_multiply
from bench.table import Table
from bench.units import ARCSEC

SHORT_CONING = {"phases": 3, "duration": 6.0, "rates": (100.0, 200.0, 400.0)}
SHORT_MANOEUVRE = {"phases": 3, "truth_rate": 1e4}
UPDATES = 6.0 * 100.0 / 3  # of three samples at the lowest rate of the short run
HALF_ANGLE, FREQUENCY = math.radians(5.0), 4 * math.pi


@pytest.fixture(scope="module")
def coned():
    """A short run of the coning experiment."""
    return bench.run("attitude-coning", seed=1, **SHORT_CONING)


@pytest.fixture(scope="module")
def manoeuvred(tmp_path_factory):
    """A short run of the manoeuvre experiment, written to a folder."""
    out = tmp_path_factory.mktemp("runs") / "manoeuvre"
    return bench.run("attitude-manoeuvre", out=out, seed=1, record=False, **SHORT_MANOEUVRE)


def made_up(values):
    """Errors of all algorithms with all samples: 1 arcsec everywhere but where `values` say; rates are the paper's."""
    rates = np.array(RATES)
    cells = {}
    for algorithm in ALL:
        for samples in algorithm.samples:
            for data in ("ideal", "quantised"):
                shape = (20 if data == "quantised" else 1, len(rates), 5)
                cells[algorithm.label, samples, data] = np.ones(shape)
    for (algorithm, samples, data), value in values.items():
        cells[algorithm.label, samples, data][:] = value
    return Errors(rates, cells)


def by_rate(exponent, scale=1.0):
    """Errors that fall with the rate, the same for every angle."""
    return scale * (np.array(RATES)[:, None] / 100.0) ** -exponent


class TestJudging:
    """The rules, on made-up numbers."""

    def test_orders_of_magnitude(self):
        np.testing.assert_allclose(orders(np.array([1.0, 5.0]), np.array([0.01, 5.0])), [2, 0], rtol=0, atol=1e-15)

    def test_orders_are_not_given_at_rounding(self):
        top, bottom = np.array([1.0, FLOOR / 2, 1.0]), np.array([FLOOR / 2, FLOOR / 3, 0.0])
        assert np.isnan(orders(top, bottom)).all()
        bound = orders(top, bottom, bound=True)
        assert np.isnan(bound).tolist() == [False, True, False]
        assert bound[0] == pytest.approx(np.log10(2 / FLOOR))

    @pytest.mark.parametrize(("value", "holds"), [(1.49, False), (1.5, True), (2.49, True), (2.5, False)])
    def test_two_orders_is_what_rounds_to_two(self, value, holds):
        assert printed_orders(2).holds(np.array([value]))[0] == holds

    def test_four_to_five_orders(self):
        np.testing.assert_array_equal(
            printed_orders(4, 5).holds(np.array([3.4, 3.6, 5.4, 5.6])), [False, True, True, False]
        )

    def test_most_of_the_rates_for_every_curve(self):
        rates = np.array([100.0, 200.0, 300.0, 400.0])
        good, half, bad = (np.array(v, dtype=float) for v in ([2, 2, 2, 2], [2, 2, 0, 0], [2, 0, 0, 0]))
        most = [Curve("a", "pitch", good), Curve("b", "pitch", half)]
        verdict = judge(most, printed_orders(2), rates)
        assert verdict.judgement == "holds"
        assert verdict.measured == "pitch 0.00 to 2.00 orders"
        assert verdict.reason == "true at 2 of 4 rates for b, pitch (not at 300, 400 Hz)"
        assert judge([*most, Curve("c", "yaw", bad)], printed_orders(2), rates).judgement == "does not hold"
        assert judge(most, printed_orders(2), rates, share=1.0).judgement == "does not hold"

    def test_rates_at_rounding_do_not_count(self):
        value = np.array([2.0, np.nan, np.nan])
        verdict = judge([Curve("a", "yaw", value)], printed_orders(2), np.array([1.0, 2.0, 3.0]), share=1.0)
        assert verdict.judgement == "holds"
        assert "at the other 2 rounding decides" in verdict.reason
        none = judge([Curve("a", "yaw", np.full(3, np.nan))], Band(), np.array([1.0, 2.0, 3.0]))
        assert none.judgement == "cannot be judged"

    def test_slope_is_fitted_above_rounding(self):
        rates = np.array(RATES)
        error = np.maximum(1e-3 * (rates / 100) ** -4, 1e-10)
        assert judging.slope(rates, error) == pytest.approx(-4.0, abs=1e-9)
        assert math.isnan(judging.slope(rates, np.full(len(rates), 1e-10)))

    def test_statements_of_the_coning_section(self):
        """A world as the paper describes it with Song's coefficients, and the opposite."""
        ideal = {(a, 3, "ideal"): by_rate(1, 1e-4) for a in NEW}
        rotvec = by_rate(1, 1e-2) * np.array([1, 1, 1e-4])
        padded = {key: np.hstack([np.tile(v, (1, 3)), np.zeros((len(RATES), 2))]) for key, v in ideal.items()}
        padded[SONG, 3, "ideal"] = np.hstack([rotvec, np.zeros((len(RATES), 2))])
        errors = made_up(padded)
        assert coning.judge_periodic(errors, SONG).judgement == "holds"
        assert coning.judge_drift(errors, SONG).judgement == "holds"
        assert coning.judge_gain(errors, SONG).judgement == "holds"
        assert coning.judge_cost(errors, SONG).judgement == "does not hold"
        assert coning.judge_no_gain(errors, SONG).judgement == "holds"
        assert coning.judge_agreement(errors, SONG).judgement == "holds"
        flat = made_up({})
        for rule in (coning.judge_periodic, coning.judge_drift, coning.judge_gain, coning.judge_degradation):
            assert rule(flat, SONG).judgement == "does not hold"

    def test_samples(self):
        worse = {(PRINTED, N, "ideal"): 10.0 ** (N - 6) for N in SAMPLES}
        better = {(a, N, "ideal"): 10.0 ** (3 - N) for a in NEW for N in SAMPLES}
        errors = made_up(worse | better)
        assert coning.judge_degradation(errors, PRINTED).judgement == "holds"
        assert coning.judge_degradation(errors, OPTIMISED).judgement == "does not hold"
        assert coning.judge_samples(errors, NEW).judgement == "holds"
        assert coning.judge_samples(errors, (PRINTED, PRINTED)).judgement == "does not hold"
        assert coning.judge_superiority(errors, PRINTED).judgement == "holds"

    @pytest.mark.parametrize(("best", "verdict"), [(20, "holds"), (10, "cannot be judged"), (0, "does not hold")])
    def test_yaw_at_low_rates_hangs_on_the_phase(self, best, verdict):
        yaw = np.where(np.arange(20)[:, None, None] < best, 0.5, 2.0)
        found = coning.judge_low_rates(made_up({(SONG, 3, "quantised"): yaw}), SONG)
        assert found.judgement == verdict
        assert f"150 Hz: {5 * best} %" in found.measured

    def test_runs_that_are_not_the_papers_judge_nothing(self):
        assert coning.not_the_papers(ConingOptions()) == ""
        assert "12 s" in coning.not_the_papers(ConingOptions(duration=12.0, rates=(100.0,)))
        assert "2 rates from 100 to 200 Hz" in coning.not_the_papers(ConingOptions(rates=(100, 200)))
        assert "19 phases" in coning.not_the_papers(ConingOptions(phases=19))
        assert manoeuvre.not_the_papers(ManoeuvreOptions()) == ""
        assert "2000 Hz" in manoeuvre.not_the_papers(ManoeuvreOptions(rate=2000.0))
        assert "10000 Hz" in manoeuvre.not_the_papers(ManoeuvreOptions(truth_rate=1e4))
        assert "3 phases" in manoeuvre.not_the_papers(ManoeuvreOptions(phases=3))


class TestErrors:
    """What is measured, against `bench.evaluation` (which SciPy tests)."""

    @pytest.mark.parametrize("motion", [Coning(), SavageManoeuvre()])
    def test_largest_errors(self, motion):
        """Roll of the manoeuvre crosses 180 deg; random errors of 1e-5 rad; to rounding of angles of 3 rad."""
        t = np.linspace(0, 1.2, 500)
        truth = Truth.of(motion, t)
        q = quat_multiply(quat_from_rotvec(1e-5 * np.random.default_rng(0).standard_normal((500, 3))), truth.q)
        yaw, pitch, roll = np.abs(euler_error(q, truth.q)).max(axis=0)
        rotation = attitude_error(q, truth.q)
        expected = [pitch, roll, yaw, np.linalg.norm(rotation, axis=1).max(), rotation[-1, 2]]
        np.testing.assert_allclose(trials.errors(q, truth), expected, rtol=0, atol=2e-15)

    def test_rows_become_arrays_whatever_their_order(self):
        rng = np.random.default_rng(0)
        rows = [
            (rate, "a", 3, data, phase, *(rate * 10 + phase + np.arange(5.0)))
            for rate in (200.0, 100.0)
            for data in ("ideal", "quantised")
            for phase in range(1 if data == "ideal" else 2)
        ]
        table = trials.error_table([rows[k] for k in rng.permutation(len(rows))])
        errors = Errors.of(table)
        np.testing.assert_array_equal(errors.rates, [100, 200])
        np.testing.assert_array_equal(errors.cells["a", 3, "quantised"][1, :, 2], [1003, 2003])
        assert errors.cells["a", 3, "ideal"].shape == (1, 2, 5)

    def test_quantised_increments_carry_the_residue(self):
        """Sums of the reports stay within one pulse of the truth, and are whole pulses."""
        dtheta = Coning().increments(1000.0, 3000)
        reported = trials.quantised(dtheta, 1e-3, seed=0, phase=4)
        assert np.abs(np.cumsum(reported - dtheta, axis=0)).max() <= ARCSEC * (1 + 1e-9)
        np.testing.assert_allclose(reported / ARCSEC, np.rint(reported / ARCSEC), rtol=0, atol=1e-9)
        assert not np.array_equal(reported, trials.quantised(dtheta, 1e-3, seed=0, phase=5))


class TestShortConing:
    """What six seconds at low rates show already."""

    def test_it_judges_nothing_and_says_why(self, coned):
        assert {v.judgement for _, v in coned.verdicts} == {"cannot be judged"}
        assert {v.reason for _, v in coned.verdicts} == {"the run is 6 s long, not the stated 60 s"}
        assert all("orders" in v.measured or "phases" in v.measured for _, v in coned.verdicts)

    def test_every_algorithm_was_run(self, coned):
        ideal = coned.rows.where(data="ideal")
        found = {*zip(ideal["algorithm"].tolist(), ideal["samples"].tolist(), ideal["rate_hz"].tolist(), strict=True)}
        assert found == {(a.label, N, rate) for a in ALL for N in a.samples for rate in SHORT_CONING["rates"]}
        assert len(coned.rows) == 3 * sum(len(a.samples) * (1 + 3 * a.quantised) for a in ALL)

    def test_drifts_of_three_samples_are_the_theoretical_residuals(self, coned):
        """sin^2 a / 2 [3 lam - sin 3 lam - sum_p k_p (4 sin p lam - 2 sin (p+1) lam - 2 sin (p-1) lam)] an update.

        k_p is the sum of the coefficients of products p apart. A rotation vector leaves out the third order, a^2 =
        0.8 % at most of a drift. A series errs by what the polynomial misses of the rate only, and in the first order
        of that its drift is sin^2 a times a function of lam: the same one, as the printed set is exact for the
        polynomial.
        """
        lam = FREQUENCY / 100.0

        def expected(k):
            sums = sum(
                c * (4 * math.sin(p * lam) - 2 * math.sin((p + 1) * lam) - 2 * math.sin((p - 1) * lam))
                for p, c in enumerate(k, 1)
            )
            return 0.5 * math.sin(HALF_ANGLE) ** 2 * (3 * lam - math.sin(3 * lam) - sums) * UPDATES / ARCSEC

        printed, optimised = expected((114 / 80, 33 / 80)), expected((27 / 20, 9 / 20))
        drift = {
            a: coned.rows.where(rate_hz=100.0, algorithm=a.label, samples=3, data="ideal")["drift_arcsec"][0]
            for a in (PRINTED, OPTIMISED, SONG, QUATERNION)
        }
        assert drift[QUATERNION] == pytest.approx(printed, rel=1e-5)
        assert drift[PRINTED] == pytest.approx(printed, rel=0.01)
        for a in (OPTIMISED, SONG):
            assert drift[a] - drift[PRINTED] == pytest.approx(optimised - printed, rel=0.01)

    def test_the_printed_rotation_vector_drifts_as_the_taylor_series(self, coned):
        """They fit the same polynomial; they differ in the third order, 1e-3 of the drift."""
        for rate in SHORT_CONING["rates"]:
            at = {
                a: coned.rows.where(rate_hz=rate, algorithm=a.label, samples=3, data="ideal")["yaw_arcsec"][0]
                for a in (PRINTED, SONG, QUATERNION, DCM)
            }
            assert at[PRINTED] == pytest.approx(at[QUATERNION], rel=3e-3)
            assert at[DCM] == pytest.approx(at[QUATERNION], rel=1e-5)
            assert at[SONG] < 0.02 * at[QUATERNION]

    def test_number_of_jobs_does_not_change_the_bits(self, coned, tmp_path):
        fewer = {**SHORT_CONING, "rates": SHORT_CONING["rates"][:2]}
        other = bench.run("attitude-coning", seed=1, jobs=2, out=tmp_path / "two", **fewer)
        for rate in fewer["rates"]:
            ours, theirs = (rows.where(rate_hz=rate) for rows in (coned.rows, other.rows))
            assert all(np.array_equal(theirs[name], ours[name]) for name in ours.columns)
        assert {p.name for p in (tmp_path / "two" / "figures").iterdir()} == {
            "figure_1_ideal.png",
            "figure_2_quantised.png",
            "figure_3_samples.png",
            "best.png",
        }
        entities = {chunk.entity_path for chunk in RrdReader(str(other.files["recording"])).stream()}
        assert any("Song" in entity for entity in entities)

    def test_an_interrupted_run_is_continued(self, tmp_path, monkeypatch):
        """The rates are a tuple, which JSON gives back as a list."""
        options = {**SHORT_CONING, "phases": 1}
        calls = []

        def interrupted(work):
            calls.append(work.rate)
            if len(calls) == 2:
                raise KeyboardInterrupt
            return chosen.measure(work)

        chosen = bench.experiment.experiment("attitude-coning")
        broken = replace(chosen, measure=interrupted)
        monkeypatch.setattr("bench.runner.experiment", lambda name: broken)
        monkeypatch.setattr("bench.figures.draw", lambda figure, path: path.write_bytes(b""))  # not what is tested
        with pytest.raises(bench.campaign.CampaignInterrupted, match="1 of 3 parts"):
            bench.run("attitude-coning", out=tmp_path / "run", **options)
        bench.run("attitude-coning", out=tmp_path / "run", record=False, **options)
        assert calls == [100.0, 400.0, 400.0, 200.0]


class TestShortManoeuvre:
    """The manoeuvre with few phases and a coarser truth."""

    def test_files(self, manoeuvred):
        names = {path.relative_to(manoeuvred.folder).as_posix() for path in manoeuvred.folder.rglob("*")}
        assert {"figures/figure_4_errors.png", "figures/samples.png", "report.html", "tables/truths.parquet"} <= names
        assert "recording.rrd" not in names  # not asked for
        rows = Table.read_parquet(manoeuvred.folder / "tables" / "rows.parquet")
        assert len(rows) == 1 + sum(len(a.samples) * (1 + 3 * a.quantised) for a in ALL)
        assert json.loads((manoeuvred.folder / "result.json").read_text())["options"]["truth_rate"] == 1e4

    def test_it_judges_nothing_and_says_why(self, manoeuvred):
        assert {v.judgement for _, v in manoeuvred.verdicts} == {"cannot be judged"}
        assert "10000 Hz, not the stated 1e+06 Hz" in manoeuvred.verdicts[0][1].reason

    def test_one_sample_errs_as_the_square_of_the_interval(self, manoeuvred):
        """At 10 kHz 1e4 times more than at 1 MHz, where it is known to be 1.7e-6 to 2.2e-6 arcsec."""
        row = manoeuvred.rows.where(algorithm="one sample")
        assert 1.5e-2 < row["rotation_arcsec"][0] < 2.5e-2

    def test_two_orders_with_the_printed_coefficients(self, manoeuvred):
        measured = {claim.key: verdict.measured for claim, verdict in manoeuvred.verdicts}
        assert measured["8 ideal, Eq. 4"] == "pitch 1.70; roll 1.67; yaw 1.68 orders"

    def test_quantised_errors_do_not_depend_on_the_algorithm(self, manoeuvred):
        errors = Errors.of(manoeuvred.rows.where(rate_hz=1000.0))
        for a in (PRINTED, SONG, DCM):
            np.testing.assert_allclose(
                errors.phases(a, 3, "quantised"), errors.phases(QUATERNION, 3, "quantised"), rtol=0.01
            )


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("attitude-coning", {"phases": 0}, "phases must be an integer >= 1, got 0"),
        ("attitude-coning", {"duration": -1.0}, "duration must be a positive number, got -1.0"),
        ("attitude-coning", {"rates": ()}, "rates must not be empty"),
        ("attitude-coning", {"rates": (100.0, -5.0)}, "rates must be a positive number, got -5.0"),
        ("attitude-coning", {"rates": (100.0, 100.0)}, "rates must differ"),
        ("attitude-coning", {"rates": (101.0,)}, "multiple of 120 intervals .*, got 6060 at 101 Hz"),
        ("attitude-coning", {"duration": 0.015, "rates": (100.0,)}, "whole number of intervals"),
        ("attitude-manoeuvre", {"phases": 1.5}, "phases must be an integer >= 1, got 1.5"),
        ("attitude-manoeuvre", {"rate": 110.0}, "rate must give a multiple of 120 intervals in 1.2 s, got 132"),
        ("attitude-manoeuvre", {"truth_rate": math.nan}, "truth_rate must be finite"),
    ],
)
def test_bad_options_are_refused(name, options, message):
    with pytest.raises(bench.InputError, match=message):
        bench.run(name, **options)


def test_claims_are_judged_for_every_reading():
    for name, per_reading, others in (("attitude-coning", 9, 2), ("attitude-manoeuvre", 3, 1)):
        keys = [claim.key for claim in bench.experiment.experiment(name).claims]
        assert len(keys) == len(set(keys)) == per_reading * len(READINGS) + others


@pytest.mark.slow
def test_the_coning_section_up_to_1_khz(monkeypatch):
    """The main findings, which the rates up to 1 kHz show already: a tenth of the work of the whole section."""
    from bench.experiments import _attitude_coning_verdicts

    monkeypatch.setattr(_attitude_coning_verdicts, "not_the_papers", lambda options: "")
    rates = (100.0, 150.0, 210.0, 300.0, 450.0, 700.0, 1000.0)
    outcome = bench.run("attitude-coning", seed=0, rates=rates, phases=6)
    judged = {key: verdict.judgement for key, verdict in outcome.evaluation.verdicts.items()}
    assert [judged[f"1 pitch and roll, {name}"] for name in READINGS] == ["holds", "does not hold", "holds"]
    assert [judged[f"2 yaw, {name}"] for name in READINGS] == ["does not hold", "holds", "holds"]
    assert {judged[f"3 better with rate, {name}"] for name in ("Eq. 4", "Song")} == {"holds"}
    assert {judged[f"4 quantised: pitch and roll agree, {name}"] for name in READINGS} == {"holds"}
    assert {judged[f"5 cost of quantisation, {name}"] for name in READINGS} == {"does not hold"}
    assert judged["6 degrades with samples, Eq. 4"] == "does not hold"  # its yaw improves from 3 to 4 samples
    assert judged["7 more samples, enough terms"] == "holds"


@pytest.mark.slow
def test_the_manoeuvre_at_full_length():
    outcome = bench.run("attitude-manoeuvre", seed=0)
    judged = {key: verdict.judgement for key, verdict in outcome.evaluation.verdicts.items()}
    assert [judged[f"8 ideal, {name}"] for name in READINGS] == ["holds", "does not hold", "holds"]
    assert {judged[f"8 quantised, {name}"] for name in READINGS} == {"holds"}
    assert {judged[f"8 cost of quantisation, {name}"] for name in READINGS} == {"does not hold"}
    truth = outcome.tables["truths"].columns["largest rotation error, arcsec"]
    assert truth[0] < 1e-9
    assert 1.5e-6 < truth[1] < 2.5e-6
