"""Damping a solved recording: a unit that stands, in closed form, solved with wrong initial values and a gyro's bias.

Truth: it stands; what is estimated is compared with what was put in.
"""

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import bench
from bench._damp_report import damping_figures
from bench._solve_report import state_table
from bench.aiding import VelocityAiding
from bench.damp import damp
from bench.errors import BenchWarning, InputError
from bench.record._filter_traces import filter_plots
from bench.recording import Recording
from bench.rotation import quat_from_rotvec, quat_multiply, quat_normalize
from bench.solve import Solution, solve_recording
from bench.solvers.damping import DampingModel
from bench.units import ARCMIN, DEG_PER_H
from tests.recorded_cases import initial, standing, truth

DURATION, RATE, START = 1200, 10, 50.0  # s, Hz, s
TILT = np.array([0.5, -0.4, 6.0]) * ARCMIN  # of the computed axes, as a rotation vector in n
SLIP = np.array([0.08, -0.06, 0.0])  # m/s
DRIFT = 0.005 * DEG_PER_H * np.array([1.0, -1.0, 1.0])
INS = bench.solver("navigation", "navigation-frame", height="held")
NAMES = ("velocity-error", "velocity-change", "double-filter", "bias-augmented")
MODEL = DampingModel(reference_noise=0.01)


@pytest.fixture(scope="module")
def solution() -> Solution:
    plain = standing(DURATION * RATE, 1 / RATE, START)
    made = Recording(plain.t, plain.angular + DRIFT * plain.dt, plain.specific, "increments", plain.dt)
    begin = initial()
    wrong = replace(begin, q_nb=quat_normalize(quat_multiply(quat_from_rotvec(TILT), begin.q_nb)), v_n=SLIP)
    return solve_recording(made, INS, wrong, reference=truth(START + np.arange(0, DURATION + 1, 10)))


def still(**options: object) -> VelocityAiding:
    """A log that says that the unit stands, with white noise of 1 cm/s, from 2.5 s on."""
    t = START + 2.5 + np.arange(DURATION)
    return VelocityAiding(t, np.random.default_rng(5).normal(0, 0.01, (len(t), 2)), **options)


def test_the_damped_velocity_is_better_than_the_free_one(solution):
    free = solution.comparison.errors
    for name in NAMES:
        damped = damp(solution, still(), bench.solver("damping", name, model=MODEL))
        judged = damped.comparison.errors
        late = judged.t > START + DURATION / 2
        # Free, 0.5' of tilt and the Schuler oscillation; filter 2 alone is not told the velocity itself.
        limit = 0.5 if name == "velocity-change" else 0.1
        assert np.linalg.norm(judged.velocity[late]) < limit * np.linalg.norm(free.velocity[late]), name
        np.testing.assert_allclose(damped.trajectory.height, 35.0, atol=0.01)


def test_errors_are_those_that_were_put_in(solution):
    damped = damp(solution, still(), bench.solver("damping", "velocity-error", model=MODEL))
    true = damped.true_errors
    np.testing.assert_allclose(true[0], [*SLIP[:2], 0.0, 0.0, *-TILT], atol=1e-9)
    rows = np.searchsorted(damped.estimate.t, damped.comparison.reference.t)
    off = np.abs(damped.estimate.x[rows, :7] - true) / damped.estimate.sigma[rows, :7]
    assert off[30:].max() < 3.5  # after 300 s; sigma is what the filter claims
    # Halfway between two rows the noise has half its variance: 1 instead of 2, within 4 sigma of a mean of 1200.
    assert np.nanmean(damped.stages["velocity-error"].nis) == pytest.approx(1.0, abs=0.12)


def test_corrections_are_those_of_the_filter_and_linear_between_its_steps(solution):
    """The unit stands, so that velocity is the correction itself; attitude turns with it."""
    damped = damp(solution, still(), bench.solver("damping", "bias-augmented", model=MODEL))
    at_steps = damped.estimate.corrected(damped.ins)
    free, found = solution.trajectory, damped.trajectory
    np.testing.assert_array_equal(found.t, free.t)
    per_step = RATE // INS.samples
    np.testing.assert_allclose(found.v_n[::per_step], at_steps.v_n, atol=1e-9)
    np.testing.assert_allclose(found.r_e[::per_step], at_steps.r_e, atol=1e-7)
    change = found.v_e - free.v_e
    between = change[per_step * 100 : per_step * 101 + 1]
    share = np.arange(per_step + 1)[:, None] / per_step
    np.testing.assert_allclose(between, between[0] + share * (between[-1] - between[0]), atol=1e-12)
    turn = (turns(found.q_nb[::per_step]) * turns(at_steps.q_nb).inv()).magnitude()
    assert turn.max() < 1e-9


def turns(q: np.ndarray) -> Rotation:
    return Rotation.from_quat(np.roll(q, -1, axis=-1))


def test_gaps_are_seen_and_bridged(solution):
    log = still()
    kept = (log.t < START + 600) | (log.t > START + 700)
    damped = damp(
        solution, VelocityAiding(log.t[kept], log.v_en[kept]), bench.solver("damping", "velocity-error", model=MODEL)
    )
    assert damped.aiding.gaps == 1
    missing = np.isnan(damped.v_ref[:, 0])
    # Steps are at whole seconds, rows at half ones: 0 to 2 s, and 600 to 700 s with the steps next to the gap.
    np.testing.assert_array_equal(np.flatnonzero(missing), [0, 1, 2, *range(600, 701)])
    assert damped.with_reference == DURATION + 1 - 104
    sigma = damped.estimate.sigma[:, 0]
    assert sigma[700] > 2 * sigma[599]
    assert sigma[720] < 1.5 * sigma[599]


def test_outliers_are_counted(solution):
    log = still()
    v_en = log.v_en.copy()
    v_en[400] += 5.0
    aiding = VelocityAiding(log.t, v_en)
    gated = damp(solution, aiding, bench.solver("damping", "velocity-error", model=MODEL, gate=0.9999))
    stage = gated.stages["velocity-error"]
    assert gated.rejected(stage) == 2  # the steps on either side of the row
    with pytest.warns(BenchWarning, match="mean NIS of velocity-error"):
        plain = damp(solution, aiding, bench.solver("damping", "velocity-error", model=MODEL))
    assert plain.rejected(plain.stages["velocity-error"]) == 0


def doubts(solution, aiding, **options) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        damp(solution, aiding, bench.solver("damping", "velocity-error", model=MODEL, **options))
    assert all(issubclass(each.category, BenchWarning) for each in caught)
    return [str(each.message) for each in caught]


def test_too_little_velocity_is_doubtful(solution):
    """Milliseconds declared as seconds leave a row or two; half of the steps is the limit."""
    log = still(source="log.csv")
    sparse = VelocityAiding(START + (log.t - START) * 1e3 - 2000.0, log.v_en, source="log.csv")
    (doubt,) = doubts(solution, sparse)
    assert doubt.startswith("log.csv: a velocity was available at 1 of 1201 steps only; check its time unit, clock")
    for end, expected in ((601, []), (599, ["599 of 1201 steps only"])):
        t = START + np.arange(float(end))
        found = doubts(solution, VelocityAiding(t, np.zeros((end, 2))))
        assert [text in doubt for text, doubt in zip(expected, found, strict=True)] == [True] * len(expected)


def test_a_velocity_that_does_not_fit_is_doubtful(solution):
    """2 m/s that are not there are 200 sigma of the log; with a gate hardly anything passes."""
    log = still(source="log.csv")
    assert doubts(solution, log) == []
    wrong = VelocityAiding(
        log.t, log.v_en + np.where(np.arange(len(log)) % 20 < 10, 2.0, 0.0)[:, None], source="log.csv"
    )
    (doubt,) = doubts(solution, wrong)
    assert re.match(
        r"log\.csv: the mean NIS of velocity-error is \S+, 2 is expected; check the velocity's unit, axes", doubt
    )
    (doubt,) = doubts(solution, VelocityAiding(log.t, log.v_en + 30.0, source="log.csv"), gate=0.999)
    assert doubt.startswith("log.csv: 1198 of 1198 measurements did not pass the gate of velocity-error; check the")


def test_a_constant_that_the_filter_takes_for_errors_of_the_ins_is_doubtful_at_once(solution):
    """5 m/s are 50 sigma of the first innovation, and soon an error of the velocity like any other."""
    log = still(source="log.csv")
    shifted = VelocityAiding(log.t, log.v_en + np.array([5.0, 0.0]), source="log.csv")
    (doubt,) = doubts(solution, shifted)
    assert doubt.startswith("log.csv: the first velocity is 4.9")  # less the slip


def test_the_damped_state_at_the_end_is_shown_beside_the_free_one(solution):
    damped = damp(solution, still(), bench.solver("damping", "velocity-error", model=MODEL))
    table = state_table(solution, damped)
    free_title, title = "end by navigation-frame, free", "end by velocity-error, damped"
    assert list(table.columns) == ["quantity", "start", free_title, title]
    row = list(table["quantity"]).index("velocity north, m/s")
    assert float(table[free_title][row]) == pytest.approx(solution.trajectory.v_n[-1, 1], abs=1e-5)
    assert float(table[title][row]) == pytest.approx(damped.trajectory.v_n[-1, 1], abs=1e-5)
    assert abs(float(table[title][row])) < 0.02 < abs(float(table[free_title][row]))  # it stands
    assert list(state_table(solution).columns) == ["quantity", "start", "end"]


def test_the_normalised_innovations_are_drawn_on_a_logarithmic_axis(solution):
    damped = damp(solution, still(), bench.solver("damping", "double-filter", model=MODEL))
    _, innovations = damping_figures(damped)
    assert [panel.yscale for panel in innovations.panels] == ["log", "log", "linear"]


def test_plots_of_the_filter_hold_the_largest_innovation_and_name_their_lines(solution):
    log = still()
    v_en = log.v_en.copy()
    v_en[401] += 0.5
    damped = damp(solution, VelocityAiding(log.t, v_en), bench.solver("damping", "double-filter", model=MODEL))
    plots = {plot.overview.entity: plot.overview for plot in filter_plots(damped, START)["Filter"]}
    first = plots["filter/nis_velocity-error"]
    largest = np.nanmax(damped.stages["velocity-error"].nis)
    assert largest > 100
    assert first.display_range()[1] == np.ceil(np.log10(largest))
    assert plots["filter/share/0"].series == ("latitude", "longitude")
    shares = [name for entity, plot in plots.items() if "/share/" in entity for name in plot.series]
    assert len(shares) == 13


def test_stages_have_the_names_of_the_filters(solution):
    for name, expected in (
        ("velocity-error", ["velocity-error"]),
        ("velocity-change", ["velocity-error", "velocity-change"]),
        ("double-filter", ["velocity-error", "velocity-change"]),
        ("bias-augmented", ["bias-augmented"]),
    ):
        damped = damp(solution, still(), bench.solver("damping", name))
        assert list(damped.stages) == expected
        assert all(np.isfinite(stage.nis).any() for stage in damped.stages.values())


def test_without_a_reference_there_are_no_errors(solution):
    damped = damp(replace(solution, comparison=None), still(), bench.solver("damping", "velocity-error"))
    assert (damped.comparison, damped.true_errors) == (None, None)


def test_bad_input_is_named(solution):
    chosen = bench.solver("damping", "velocity-error")
    for arguments, message in (
        ((None, still(), chosen), "solution must be a Solution, got None"),
        ((solution, np.zeros((3, 2)), chosen), "aiding must be a VelocityAiding"),
        ((solution, still(), "velocity-error"), "damping must be a DampingFilter, got 'velocity-error'"),
        ((replace(solution, solver=replace(INS, height="free")), still(), chosen), "set height to 'held'.*got 'free'"),
        (
            (replace(solution, solver=bench.solver("attitude", "rotation-vector")), still(), chosen),
            "got the attitude solver 'rotation-vector'",
        ),
        (
            (solution, VelocityAiding(np.arange(3.0), np.zeros((3, 2)), source="log.csv"), chosen),
            r"log\.csv: no velocity at any of the 1201 steps.*0\.0 to 2\.0 s, those of the solution 50\.0 to 1250\.0 s",
        ),
    ):
        with pytest.raises(InputError, match=message):
            damp(*arguments)
    with pytest.raises(InputError, match=r"solution must last one step of the filter, 2000 s, got 1200 s"):
        damp(solution, still(), chosen, step=2000.0)
    with pytest.raises(InputError, match="step must be a positive number"):
        damp(solution, still(), chosen, step=0.0)
