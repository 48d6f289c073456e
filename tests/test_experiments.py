"""Experiments: they load, run short, judge by the printed digits, and give the same bits on any number of workers."""

import json

import numpy as np
import pytest
from rerun.chunk import RrdReader

import bench
from bench.experiment import experiment, experiments
from bench.experiments import _gyro_free_verdicts as verdicts
from bench.experiments._gyro_free_published import Trials
from bench.experiments._gyro_free_trials import BIAS, NOISE, READINGS, Options, Work, ideal, solve_trial
from bench.table import Table

SHORT = {
    "attitude-coning": {"phases": 2, "duration": 6.0, "rates": (100.0, 200.0)},
    "attitude-manoeuvre": {"phases": 2, "truth_rate": 1e4},
    "ins-frames": {
        "duration": 2.0,
        "speeds": (300.0, 3000.0),
        "rates": (50.0, 100.0),
        "postponed": (2, 10),
        "max_samples": 2,
        "repeats": 1,
        "timed_updates": 8,
    },
    "dual-euler-swing": {"trials": 2, "duration": 100.0},
    "dual-euler-turntable": {"trials": 1, "duration": 50.0, "rest": 5.0},
    "dual-euler-navigation": {"trials": 2, "duration": 50.0, "rest": 5.0},
    "damping-external-velocity": {
        "duration": 0.5,
        "rate": 10.0,
        "reference_errors": (-0.1, -0.3),
        "latitudes": (52.0,),
        "taus": (3600.0,),
        "trials": 2,
        "undamped": 6.0,
    },
    "gyro-free-circular": {"trials": 2, "duration": 6.0},
    "attitude-cost": {"max_samples": 2, "repeats": 1, "timed_updates": 8},
    "attitude-limits": {"frequencies": 2, "half_angles": 2, "cycles": 4, "max_samples": 3},
}


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    """A short run of the gyro-free experiment, written to a folder."""
    out = tmp_path_factory.mktemp("runs") / "short"
    return bench.run("gyro-free-circular", out=out, seed=3, **SHORT["gyro-free-circular"])


@pytest.mark.parametrize("name", experiments())
def test_every_experiment_runs_short_and_judges_every_claim(name):
    outcome = bench.run(name, **SHORT[name])
    assert [claim.key for claim, _ in outcome.verdicts] == [claim.key for claim in outcome.experiment.claims]
    assert set(outcome.evaluation.verdicts) == {claim.key for claim in outcome.experiment.claims}
    assert {condition.status for condition in outcome.experiment.conditions} == {"stated", "assumed"}
    assert outcome.folder is None


def test_files_of_a_run(short):
    names = {path.relative_to(short.folder).as_posix() for path in short.folder.rglob("*") if path.is_file()}
    assert {"result.json", "inputs.json", "report.md", "report.html", "recording.rrd", "tables/rows.parquet"} <= names
    assert sum(name.startswith("figures/") for name in names) == 4
    assert not any(name.startswith("parts") or name.endswith(".part") for name in names)
    result = json.loads((short.folder / "result.json").read_text())
    assert result["seed"] == 3
    assert result["options"]["trials"] == 2
    assert len(result["verdicts"]) == len(short.experiment.claims)
    assert set(result["versions"]) >= {"mujoco", "numpy", "python", "strapbench"}
    back = Table.read_parquet(short.folder / "tables" / "rows.parquet")
    assert all(np.array_equal(back[name], short.rows[name]) for name in short.rows.columns)


def test_reports_hold_the_verdicts_and_the_pictures(short):
    markdown, page = ((short.folder / f"report.{kind}").read_text() for kind in ("md", "html"))
    for claim, verdict in short.verdicts:
        assert f"| {claim.key} |" in markdown
        assert verdict.judgement in markdown
    assert "figures/figure_3_attitude_errors.png" in markdown
    assert page.count("data:image/png;base64,") == 4
    assert "http" not in page  # self-contained
    assert page.count('class="cannot-be-judged"') >= 10  # two trials of 6 s cannot judge the paper


def test_recording_shows_the_focused_trial(short):
    entities = {chunk.entity_path for chunk in RrdReader(str(short.files["recording"])).stream()}
    assert any("nine" in entity for entity in entities)
    assert any("six" in entity for entity in entities)


def test_run_does_not_overwrite(short):
    with pytest.raises(bench.InputError, match="finished run"):
        bench.run("gyro-free-circular", out=short.folder, seed=3, **SHORT["gyro-free-circular"])


def test_number_of_jobs_does_not_change_the_bits(short, tmp_path):
    outcome = bench.run(
        "gyro-free-circular", out=tmp_path / "two", jobs=2, seed=3, record=False, **SHORT["gyro-free-circular"]
    )
    assert all(np.array_equal(outcome.rows[name], short.rows[name]) for name in short.rows.columns)
    same = [(tmp_path / "two" / name).read_bytes() == (short.folder / name).read_bytes() for name in ("inputs.json",)]
    assert all(same)
    assert not (tmp_path / "two" / "recording.rrd").exists()


def test_a_trial_alone_is_the_trial_of_the_campaign(short):
    options = short.options
    _, alone = solve_trial(Work(options, 3, READINGS[4], 1, 1), 1, "nine")
    row = short.rows.where(reading=READINGS[4].label, system="nine", trial=1)
    truth = ideal(options, READINGS[4].gravity).truth
    assert row["position_x_m"][-1] == alone.position[-1, 0] - truth.position[-1, 0]


def test_seeds_differ(short):
    other = bench.run("gyro-free-circular", seed=4, **SHORT["gyro-free-circular"])
    assert not np.array_equal(other.rows["position_x_m"], short.rows["position_x_m"])


def test_the_two_readings_of_the_noise_differ_by_a_hundred_in_variance():
    t = np.zeros((60_000, 1))
    variance, density = (
        reading.errors().apply(t, 0.01, "samples", seed=1).var()
        for reading in READINGS
        if reading.integration == "first-order" and reading.gravity == "gravity"
    )
    # 60 000 samples know a variance to 0.6 %, one sigma.
    assert variance == pytest.approx(NOISE, rel=0.03)
    assert density == pytest.approx(100 * NOISE, rel=0.03)


def test_first_order_reading_shows_the_known_attitude_error():
    """Normalised Euler steps lose |w|^3 h^2 / 12 a second about w: 1.19 degrees in 60 s at (2, 2, 2) rad/s, 100 Hz."""
    options = Options(trials=1)
    first = next(r for r in READINGS if r.integration == "first-order" and r.noise == "variance")
    row = bench.experiment.experiment("gyro-free-circular").measure(
        experiment("gyro-free-circular").items(options, 0)[READINGS.index(first)].work
    )
    end = row.where(system="nine", t_s=60.0)
    lost = np.sqrt(sum(end[f"rotation_{axis}_deg"][0] ** 2 for axis in "xyz"))
    assert lost == pytest.approx(np.rad2deg(12**1.5 * 1e-4 / 12 * 60), rel=0.15)


class TestJudging:
    """The rules, on made-up samples."""

    def test_published_improvements_follow_from_the_published_errors(self):
        assert verdicts.judge_arithmetic().judgement == "holds"

    def test_bias_removal_needs_equal_biases(self):
        verdict = verdicts.judge_bias_removal()
        assert verdict.judgement == "does not hold"
        assert f"{BIAS:.2g}" in verdict.measured
        assert "64 of 512" in verdict.reason  # three pairs must agree: 2^9 / 2^3

    def test_reach_sees_gaps_that_percentiles_do_not(self):
        """Made-up errors: bias puts each axis at -1 or 1, noise of 0.1 blurs them, and axes go together."""
        rng = np.random.default_rng(0)
        nodes, noise = np.array([[-1.0, -1.0], [1.0, 1.0]]), 0.1 * rng.standard_normal((60, 2))

        def table(values):
            return Table({"x": values[:, 0], "y": values[:, 1]})

        key = (READINGS[0].label, "nine")
        trials = Trials(Options(), {}, {key: table(noise)}, {key: table(nodes)})
        for value, too_far in ((0.9, False), (0.0, True)):
            assert (trials.distance(READINGS[0], "nine", ["x"], np.array([value])) > 1) == too_far
        both = [trials.distance(READINGS[0], "nine", ["x", "y"], np.array(v)) for v in ([0.9, 1.1], [1.0, -1.0])]
        assert both[0] < 1 < both[1]  # each of 1 and -1 can arise, but not together

    def test_signs_are_enumerated(self):
        work = Work(Options(), 0, READINGS[0], 0, 512, "signs")
        values = {work.errors(trial, 9).models[0].value for trial in range(512)}
        assert len(values) == 512
        assert {abs(v) for value in values for v in value} == {BIAS}

    def test_short_or_few_trials_cannot_judge(self, short):
        by_key = short.evaluation.verdicts
        assert by_key["six, attitude x"].judgement == "cannot be judged"
        assert "6 s at 100 Hz, not the stated 60 s" in by_key["six, attitude x"].reason
        assert by_key["improvement arithmetic"].judgement == "holds"
        assert verdicts.not_the_papers(Options(trials=99)) == "99 trials are too few, at least 100 are needed"
        assert verdicts.not_the_papers(Options()) == ""


class TestBadInput:
    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ({"trials": 0}, "trials must be an integer >= 1, got 0"),
            ({"trials": 2.5}, "trials must be an integer >= 1, got 2.5"),
            ({"duration": -1.0}, "duration must be a number >= 4, got -1.0"),
            ({"duration": 7.0}, "duration must be a multiple of 2 s, got 7.0"),
            ({"rate": float("nan")}, "rate must be finite"),
            ({"rate": 0.0}, "rate must be a number >= 1, got 0.0"),
            ({"rate": 33.3}, "rate must give a whole number of readings in 2 s, got 33.3 Hz"),
            ({"rate": 1e9}, r"rate \* duration must not exceed 1e\+07 readings, got 6e\+10"),
            ({"circle": "square"}, "unknown circle 'square'; valid: accelerating, constant-rate"),
            ({"trails": 3}, "gyro-free-circular has no option 'trails'; options: trials, duration, rate, circle"),
            ({"seed": -1}, "seed must be an integer >= 0, got -1"),
            ({"jobs": 0}, "jobs must be an integer >= 1, got 0"),
        ],
    )
    def test_options(self, options, message, tmp_path):
        with pytest.raises(bench.InputError, match=message):
            bench.run("gyro-free-circular", out=tmp_path / "never", **options)
        assert not (tmp_path / "never").exists()

    def test_unknown_experiment(self):
        with pytest.raises(bench.UnknownNameError, match=r"unknown experiment 'table-1'; valid: .*gyro-free-circular"):
            bench.run("table-1")


@pytest.mark.slow
def test_the_paper_at_full_length():
    """What the README says of the main job; every bound is many times the Monte Carlo spread of 200 trials."""
    outcome = bench.run("gyro-free-circular", seed=0)
    judged = {key: verdict.judgement for key, verdict in outcome.evaluation.verdicts.items()}
    assert judged["attitude better by 95 %"] == "holds"
    assert judged["position better by 85 %"] == "cannot be judged"
    assert judged["less smooth"] == judged["both diverge"] == "holds"
    assert judged["nine, position x"] == judged["nine, position y"] == "does not hold"
    ratio = outcome.tables["bound"].columns["ratio"]
    np.testing.assert_allclose(ratio, 1.0, atol=0.02)  # the roots are efficient for one sample
    focus = outcome.evaluation.focus
    assert (focus.reading.noise, focus.reading.gravity, focus.definition) == ("density", "gravity", "integral")
