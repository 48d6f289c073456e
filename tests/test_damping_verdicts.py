"""The verdicts of the experiment of the damped ship's INS: made-up results in which each of them holds, or does not."""

from itertools import product
from math import log, pi, sqrt

import numpy as np
import pytest

from bench.experiments import _damping_published as published
from bench.experiments import _damping_verdicts as verdicts
from bench.experiments._damping_consistency import CASES, CONSTANT_ERROR
from bench.experiments._damping_runs import make_rows
from bench.experiments._damping_trials import AUGMENTED, FILTERS, FIRST, FREE, FUSION, SECOND, Options
from bench.experiments.damping_external_velocity import CLAIMS
from bench.table import Table
from tests.damping_experiment_cases import COLUMN_STATES, COLUMN_UNITS, THEORY, THERE

T, ONES = np.arange(241) / 10, np.ones((241, 7))  # h
TAU = 12 / log(10)  # h; from 10 to 1 in 12 h
CRITERIA = ("both tables", *(f"table {k}, {group}" for k in (1, 2) for group in ("position", "attitude", "velocity")))


def fading(tau):
    return 10 * np.exp(-T[:, None] / tau) * ONES


def rows_of(errors, **about):
    """Return rows with errors (n, 7) in the tables' columns, arcmin and m/s."""
    states = {f"e_{name}": errors[:, k] * COLUMN_UNITS[k] for k, name in enumerate(COLUMN_STATES)}
    return make_rows(len(errors), **about, **states)


# What the paper says, made up: filter 1 drifts, filter 2 does not but takes 12 h, the fusion takes 6 h.
AS_CLAIMED = {
    FREE: lambda C: 10 * ONES,
    FIRST: lambda C: 0.01 + C * T[:, None] * ONES,
    SECOND: lambda C: fading(TAU),
    FUSION: lambda C: fading(TAU / 2) + 0.05 * C,
    AUGMENTED: lambda C: 0.01 * C * ONES,
    (CONSTANT_ERROR, FIRST, "nees"): 13.0 + np.arange(13),
    (CONSTANT_ERROR, AUGMENTED): 0.9,
    "printed": published.BOTH,
}


def made_up(changes):
    """Return made-up results in which every claim holds, but for the changes."""
    told = {**AS_CLAIMED, **changes}
    tables = [rows_of(told[FREE](0.0), part="ins", name=FREE, t_h=T)]
    for name in FILTERS:
        for C in (0.0, *published.REFERENCE_ERRORS):
            tables.append(rows_of(told[name](C), part="ins", name=name, t_h=T, reference_m_per_s=C))
        normal = {"nees": 15.0 if name == AUGMENTED else 13.0, "nis": 2.0}
        for case, trial in product(CASES, range(10)):
            shown = {key: told.get((case, name, key), value) * np.ones(13) for key, value in normal.items()}
            shown = {key: value * (1.2 - 0.4 * (trial % 2)) for key, value in shown.items()}  # their means as told
            about = {"part": "consistency", "case": case, "name": name, "t_h": np.arange(13.0)}
            left = told.get((case, name), 1.0) * ONES[:13] * np.arange(13)[:, None] * (-1) ** trial
            tables.append(rows_of(left, **about, **shown, value=trial))
    for name, period in THEORY.items():
        tables.append(make_rows(1, part="undamped", case="period", name=name, value=period * told.get(name, 1.0)))
    for criterion, (k, name) in product(CRITERIA, enumerate((FUSION, FIRST))):
        about = {"part": "scan", "case": criterion, "name": name}
        tables.append(rows_of(0 * published.BOTH[k], **about, label="poor", value=0.9, t_h=9.0))
        tables.append(rows_of(told["printed"][k], **about, label="good", value=told.get(criterion, 0.05), t_h=9.0))
    return verdicts.Results(THERE, Table.concatenate(tables))


def in_columns(columns, values):
    """Return values (n, 7), or zero in the other columns."""
    return values * np.isin(np.arange(7), columns)


class TestResults:
    def test_an_exponential_settles_when_it_enters_the_band(self):
        """|e| falls from 10 to a band b in tau ln(10/b); a step is 0.1 h; what is left at the end counts for 0.03 h."""
        tau = np.array([0.5, 1.0, 1.5, 2.0, 2.5, 0.75, 0.1])
        results = made_up({FUSION: lambda C: -0.7 + fading(tau)})
        for band in (0.1, 0.01):
            np.testing.assert_allclose(results.settled(FUSION, band), tau * log(1 / band), rtol=0, atol=0.13)
        np.testing.assert_array_equal(results.settled(AUGMENTED, 0.01, -0.5), 0.0)  # a constant

    def test_what_moves_at_the_end_never_settles(self):
        moves = [8 * np.cos(2 * pi * T), T, *[1.0 * (T < 12)] * 5]
        found = made_up({FUSION: lambda C: np.stack(moves, axis=1)}).settled(FUSION, 0.05)
        np.testing.assert_allclose(found, [np.inf, np.inf, *[11.9] * 5])

    def test_the_steady_state_is_that_of_the_last_hour_and_a_half(self):
        errors = np.where(T[:, None] < 22.45, 1e3, 2.0 + 0.5 * (-1.0) ** np.arange(241)[:, None]) * np.arange(7)
        results = made_up({SECOND: lambda C: C * errors})
        # 16 rows, half of them 2.5, half 1.5; -0.3 m/s if nothing is said.
        np.testing.assert_allclose(results.steady(SECOND), -0.6 * np.arange(7), rtol=1e-12)
        np.testing.assert_allclose(results.steady(SECOND, -0.1), -0.2 * np.arange(7), rtol=1e-12)
        np.testing.assert_allclose(results.steady_rms(SECOND), 0.3 * sqrt(4.25) * np.arange(7), rtol=1e-12)


def also(name, more):
    """Return the made-up errors of a filter with more added."""
    return {name: lambda C: AS_CLAIMED[name](C) + more(C)}


NOT_ALL_HOLDS = [
    ({FIRST: lambda C: 0.01 + C * (20 + T[:, None] / 12) * ONES}, {"1 filter 1 diverges"}),
    (also(FIRST, lambda C: in_columns([6], 0.4 * C * (C + 0.3) * T[:, None])), {"1 in proportion"}),
    (also(SECOND, lambda C: in_columns([3], 2.5 * C)), {"2 filter 2 does not see it"}),
    ({SECOND: lambda C: fading(0.7 * TAU)}, {"2 settles after 12 h"}),
    (also(FUSION, lambda C: in_columns([2], fading(1.2 * TAU))), {"3 faster than filter 2"}),
    (also(FUSION, lambda C: in_columns([4], 8.0 * (C == -0.3))), {"3 more accurate than filter 1", "4 for every C"}),
    (also(FUSION, lambda C: in_columns([1], 8.0 * (C == -0.2))), {"4 for every C"}),
    (also(FUSION, lambda C: in_columns([5], 0.5 * C)), {"3 velocity compensated"}),
    (also(FUSION, lambda C: in_columns([2], 8.0 * C)), {"4 no trend with C"}),
    (also(AUGMENTED, lambda C: in_columns([6], 0.05 * C)), {"5 fifteen states"}),
    ({(CONSTANT_ERROR, AUGMENTED): np.where(np.arange(7) == 5, 1.1, 0.9)}, {"5 fifteen states, over trials"}),
    ({(CONSTANT_ERROR, AUGMENTED): np.where(np.arange(7) == 4, 1.1, 0.9)}, set()),  # position and velocity only
    ({(CONSTANT_ERROR, FIRST, "nees"): 13.0}, {"6 credibility of filter 1"}),
    ({(CONSTANT_ERROR, FIRST, "nees"): 60.0 - np.arange(13)}, {"6 credibility of filter 1"}),
    ({("none", FUSION, "nees"): 18.0}, {"7 consistent, fusion"}),
    ({("none", SECOND, "nis"): 0.13}, {"7 consistent, filter 2"}),
    ({("none", FIRST, "nees"): np.where(np.arange(13) > 9, 20.0, 13.0)}, {"7 consistent, filter 1"}),
    ({("none", FIRST, "nees"): np.where(np.arange(13) > 10, 20.0, 13.0)}, set()),  # 10 of 12 hours are within
    ({("none", AUGMENTED, "nees"): 99.0, (CONSTANT_ERROR, AUGMENTED, "nis"): 99.0}, set()),  # judged by drawn errors
    ({("drawn", AUGMENTED, "nees"): 20.0}, {"7 consistent, 15 states"}),
    ({"Schuler": 1.009, "Foucault": 0.989, "24 h": 1.011}, {"8 period, Foucault", "8 period, 24 h"}),
    ({"table 1, position": 0.101, "table 2, velocity": 0.099, "both tables": 0.2}, {"table 1, position"}),
    ({"printed": published.BOTH + in_columns([4], 0.11 * 0.081) * np.eye(5)[2][:, None]}, {"both tables"}),
]


class TestVerdicts:
    @pytest.mark.parametrize(("changes", "expected"), [({}, set()), *NOT_ALL_HOLDS])
    def test_each_change_undoes_what_it_contradicts(self, changes, expected):
        found = verdicts.judge_all(made_up(changes))
        assert set(found) == {claim.key for claim in CLAIMS}
        assert {key for key, verdict in found.items() if verdict.judgement != "holds"} == expected
        assert {verdict.judgement for verdict in found.values()} <= {"holds", "does not hold"}
        assert found["both tables"].reason == "best reading: good"

    @pytest.mark.parametrize(
        ("name", "value", "why", "left"),
        [
            ("reference_errors", (-0.1, -0.2, -0.3), "the reference errors are not the published ones", 7),
            ("sway", True, "the ship sways", 7), ("duration", 23.0, "23 h are too short", 7),
            ("duration", 11.0, "11 h are too short", 3), ("taus", (1000.0, 3600.0), "fewer latitudes or corr", 7),
            ("undamped", 95.0, "95 h undamped are too short", 23), ("trials", 9, "9 trials are too few", 20),
            ("trials", 10, "", 26), ("undamped", 100.0, "", 26),
        ],
    )  # fmt: skip
    def test_other_conditions_judge_what_does_not_depend_on_them(self, name, value, why, left):
        """7: periods (3) and consistency (4), of which the errors of the paper's reference are no part."""
        found = verdicts.withheld(Options(**{name: value}), verdicts.judge_all(made_up({})))
        others = [verdict.reason for verdict in found.values() if verdict.judgement == "cannot be judged"]
        assert len(found) - len(others) == left
        assert any(reason.startswith(why) for reason in others) or not why
