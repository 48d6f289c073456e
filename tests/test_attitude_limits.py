"""The map of integrators: streams against their bounds, refused cells, drift fit, verdicts on made-up rows.

Truth: the closed-form attitude and increments of coning; for the drift fit, lines and sines written down here.
"""

import math

import numpy as np
import pytest

import bench
from bench.experiments import _attitude_limits_maps as maps
from bench.experiments import _attitude_limits_trials as trials
from bench.experiments import _attitude_limits_verdicts as verdicts
from bench.experiments._attitude_limits_solvers import Variant, variants
from bench.experiments._attitude_limits_trials import COLUMNS, Options
from bench.motion.coning import Coning
from bench.solvers import solvers
from bench.table import Table
from bench.units import DEG, HZ

TINY = {"frequencies": 2, "half_angles": 2, "cycles": 4}


@pytest.fixture(scope="module")
def outcome():
    """A run with a map of two by two cells and N to 4, and all three streams."""
    return bench.run("attitude-limits", **TINY, max_samples=4)


def test_every_solver_is_there_once():
    found = variants()
    assert {variant.name for variant in found} == set(solvers("attitude"))
    for text in ("label", "code"):
        assert len({getattr(variant, text) for variant in found}) == len(found)
    assert max(variant.samples for variant in variants(3)) == 3


@pytest.mark.parametrize(
    ("stream", "variant", "bound"),
    [
        (2, Variant("windowed-taylor", 4, (("window", 12),)), 5e-14),
        (2, Variant("windowed-taylor", 4, (("window", 8),)), 1e-11),
        (2, Variant("functional-iteration", 4, (("form", "quaternion"),)), 6e-7),
        (1, Variant("windowed-taylor", 4, (("window", 12),)), 5e-14),
    ],
)
def test_streams_meet_their_bounds(stream, variant, bound):
    """Increments in closed form here, so that neither rig nor experiment takes part."""
    s = trials.STREAMS[stream]
    motion = Coning(half_angle=s.half_angle_deg * DEG, angular_frequency=s.frequency_hz * HZ)
    n = round(s.duration * 100)
    q = variant.build().solve(motion.increments(100.0, n), 0.01, motion.kinematics(np.zeros(1)).q_ib[0])
    truth = motion.kinematics(np.arange(0, n + 1, variant.samples) / 100).q_ib
    error = 2 * np.abs(np.minimum(np.linalg.norm(q - truth, axis=1), np.linalg.norm(q + truth, axis=1))).max()
    assert error <= bound


def test_bounds_of_the_run(outcome):
    judged = {key: verdict.judgement for key, verdict in outcome.evaluation.verdicts.items()}
    assert judged["four samples"] == judged["window of 8"] == judged["window of 12"] == judged["long stream"] == "holds"
    # A small map shows nothing about convergence.
    assert judged["forms agree"] == judged["quaternion converges"] == "cannot be judged"
    assert "the map is too small" in outcome.evaluation.verdicts["forms agree"].reason


def test_rows_of_the_run(outcome):
    chosen = variants(4)
    assert len(outcome.rows) == len(chosen) * (3 + 4)
    assert set(outcome.rows["status"]) <= {"ok", "warned", "lost", "refused"}
    ok = outcome.rows.where(status="ok")
    assert np.isfinite(ok["error_rad"]).all()
    assert np.isfinite(ok["drift_rad_per_cycle"]).all()
    again = trials.measure(trials.MapWork(outcome.options, chosen[0]))
    same = outcome.rows.where(stream="", code=chosen[0].code)
    assert all(np.array_equal(again[name], same[name], equal_nan=again[name].dtype.kind == "f") for name in COLUMNS)


def test_tables_and_figures(outcome):
    assert list(outcome.tables["best"].columns) == ["relative frequency", "0.1 deg", "90 deg"]
    assert len(outcome.tables["streams"]) == len(variants(4))
    best = outcome.evaluation.figures[0].panels[0]
    assert best.values.shape == best.text.shape == (2, 2)
    assert best.text[0, 0] in outcome.tables["codes"]["code"]


def test_refusal_is_a_row():
    """At 180 degrees a second and 0.4 s per update the Rodrigues vector does not exist."""
    motion = Coning(half_angle=90 * DEG, angular_frequency=HZ)
    variant = Variant("functional-iteration", 4, (("form", "rodrigues"),))
    rate = 4.0
    updates, error, drift, angle, status = trials.trial(variant, motion, motion.increments(rate, 40), rate)
    assert status == "refused"
    assert math.isnan(error)
    assert math.isnan(drift)
    assert angle > math.pi
    assert updates == 10


def test_lost_has_no_drift():
    motion = Coning(half_angle=45 * DEG, angular_frequency=HZ)
    _, error, drift, _, status = trials.trial(Variant("picard", 1), motion, motion.increments(2.5, 100), 2.5)
    assert status == "lost"
    assert trials.LOST < error <= math.pi
    assert math.isnan(drift)


def test_drift_of_a_line_with_oscillations():
    t = np.linspace(0.0, 20.0, 301)
    slope = np.array([1e-9, -2e-9, 2e-9])
    wobble = 1e-8 * np.stack([np.sin(2 * np.pi * t), np.cos(2 * np.pi * t), np.ones_like(t)], axis=1)
    # 20 periods under Hann's window leave 1e-3 of the amplitude per unit of time.
    assert trials.drift(t, np.outer(t, slope) + wobble) == pytest.approx(3e-9, rel=0.01)
    assert trials.drift(t, np.outer(t, slope)) == pytest.approx(3e-9, rel=1e-12)


def _rows(*found):
    """Rows of a map of one cell per entry: code, latency, error, angle per update, status."""
    full = [
        (
            "",
            "functional-iteration",
            f"label {code}",
            code,
            int(code[-1]),
            late,
            1.0,
            0.01,
            10,
            error,
            0.0,
            angle,
            status,
        )
        for code, late, error, angle, status in found
    ]
    return Table.from_rows(COLUMNS, full)


class TestJudging:
    def test_best_prefers_no_latency_among_equals(self):
        rows = _rows(("A4", 2, 1e-9, 1.0, "ok"), ("B3", 0, 1.5e-9, 1.0, "ok"), ("C2", 0, 3e-9, 1.0, "ok"))
        names, errors = maps.best(rows, maps.codes(rows))
        assert names.tolist() == [["B3"]]
        assert errors.tolist() == [[1.5e-9]]

    def test_best_of_none(self):
        rows = _rows(("A4", 0, math.nan, 1.0, "refused"))
        names, errors = maps.best(rows, maps.codes(rows))
        assert names.tolist() == [[""]]
        assert np.isnan(errors).all()

    @pytest.mark.parametrize(
        ("angle", "status", "judgement"),
        [
            (3.1, "ok", "holds"),
            (3.1, "refused", "cannot be judged"),
            (3.2, "refused", "holds"),
            (3.2, "ok", "does not hold"),
        ],
    )
    def test_rodrigues(self, angle, status, judgement):
        rows = _rows(("FR4", 0, 1e-9, angle, status), ("FR8", 0, 1e-9, 1.0, "ok"))
        assert verdicts.judge_rodrigues(rows).judgement == judgement

    @pytest.mark.parametrize(("other", "judgement"), [(1.001e-6, "holds"), (1.1e-6, "does not hold")])
    def test_forms(self, other, judgement):
        found = [(f"{form}{N}", 0, 1e-6, 1.0, "ok") for form in verdicts.FORMS for N in (4, 8)]
        found[2] = ("FR4", 0, other, 1.0, "ok")
        assert verdicts.judge_forms(_rows(*found)).judgement == judgement

    def test_quaternion(self):
        assert verdicts.judge_quaternion(_rows(("FQ4", 0, 1e-9, 9.0, "ok"))).judgement == "holds"
        refused = verdicts.judge_quaternion(_rows(("FQ4", 0, 1e-9, 9.0, "ok"), ("FQ8", 0, math.nan, 70.0, "refused")))
        assert refused.judgement == "cannot be judged"
        assert "refused 1 of 2 cells, from 70 rad" in refused.measured

    def test_a_bound_without_its_solver(self):
        rows = _rows(("FQ4", 0, 1e-9, 1.0, "ok"))
        assert verdicts.judge_bound(verdicts.BOUNDS[0], rows).judgement == "cannot be judged"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"frequencies": 1}, "frequencies must be an integer >= 2, got 1"),
        ({"half_angles": 11}, "half_angles must be an integer from 2 to 10, got 11"),
        ({"cycles": 3}, "cycles must be an integer >= 4, got 3"),
        ({"max_samples": 9}, "max_samples must be an integer from 1 to 8, got 9"),
    ],
)
def test_bad_options(options, message):
    with pytest.raises(bench.InputError, match=message):
        Options(**options)
