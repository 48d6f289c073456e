"""What every damping filter must do, found by discovery: a new filter is tested without an edit here."""

import dataclasses
import math

import numpy as np
import pytest

import bench
from bench.earth import WGS84
from bench.error_simulation import ErrorSimulation, disturbed, reference_velocity
from bench.errors import AccuracyError, InputError
from bench.references import Source
from bench.solvers import solvers
from bench.solvers.damping import DampingModel, InsSamples, error_states
from tests.damping_cases import KNOWN, ship

NAMES = sorted(solvers("damping"))
TRUTH = ship(400, turn=0.2, sway=0.05)
X0 = np.array([0.1, -0.1, 1e-5, -1e-5, 2e-4, -2e-4, 2e-3, *[5e-4] * 3, *[-2e-8] * 3])
INS = disturbed(TRUTH, np.tile(X0, (len(TRUTH), 1)))
V_REF = reference_velocity(TRUTH, error=(-0.1, -0.1), noise=0.05, seed=1)


@pytest.fixture(params=NAMES)
def damping(request):
    return bench.solver("damping", request.param, covariance_every=30)


def fields_of(solution):
    """Return every array of a solution and of its parts."""
    found = []
    for field in dataclasses.fields(solution):
        value = getattr(solution, field.name)
        if field.name == "parts":
            found += [array for part in value for array in fields_of(part)]
        elif value is not None:
            found.append(value)
    return found


def test_the_four_filters_are_found():
    assert NAMES == ["bias-augmented", "double-filter", "velocity-change", "velocity-error"]


@pytest.mark.parametrize("name", NAMES)
def test_it_declares_itself(name):
    cls = solvers("damping")[name]
    assert cls.name == name == cls.__module__.rsplit(".", 1)[1].replace("_", "-")
    assert isinstance(cls.source, Source)
    assert cls.__dataclass_params__.frozen
    assert cls.__doc__.splitlines()[0].endswith(".")


@pytest.mark.parametrize("sizes", [(1,) * 401, (7,) * 57 + (2,), (64,) * 6 + (17,), (1, 400)], ids=len)
def test_any_chunking_gives_the_same_bits(damping, sizes):
    whole, state, parts, begin = damping.solve(INS, V_REF), damping.start(1.0), [], 0
    kept = []
    for size in sizes:
        state, part = damping.advance(state, INS[begin : begin + size], V_REF[begin : begin + size])
        kept += (part.covariance_rows + begin).tolist()
        parts.append(part)
        begin += size
    assert kept == whole.covariance_rows.tolist() == list(range(0, 401, 30))
    for name in ("x", "sigma", "innovation", "nis", "used", "covariance"):
        joined = np.concatenate([getattr(part, name) for part in parts])
        np.testing.assert_array_equal(joined, getattr(whole, name), err_msg=name)


def test_samples_in_chunks_are_those_of_the_whole():
    trajectory = TRUTH.trajectory()
    whole = InsSamples.of(trajectory)
    cut = 123
    parts = [
        bench.Trajectory(trajectory.earth, *(getattr(trajectory, name)[rows] for name in ("t", "q_eb", "v_e", "r_e")))
        for rows in (slice(0, cut), slice(cut, None))
    ]
    first = InsSamples.of(parts[0])
    second = InsSamples.of(parts[1], first)
    np.testing.assert_array_equal(InsSamples.joined(first, second).f_n, whole.f_n)


def test_a_state_can_be_used_twice(damping):
    state, _ = damping.advance(damping.start(1.0), INS[:50], V_REF[:50])
    once, again = (damping.advance(state, INS[50:90], V_REF[50:90])[1] for _ in range(2))
    for a, b in zip(fields_of(once), fields_of(again), strict=True):
        np.testing.assert_array_equal(a, b)


def test_without_errors_nothing_is_estimated(damping):
    solution = damping.solve(TRUTH, TRUTH.v_n[:, :2])
    assert np.abs(solution.x).max() == 0.0
    assert len(solution) == len(TRUTH)
    assert solution.states[:2] == ("dv_E", "dv_N")


def test_the_claimed_covariances_are_those_of_sigma(damping):
    solution = damping.solve(INS, V_REF)
    variance = np.diagonal(solution.covariance, axis1=1, axis2=2)
    np.testing.assert_allclose(np.sqrt(variance), solution.sigma[solution.covariance_rows], rtol=1e-15)
    np.testing.assert_array_equal(solution.covariance, np.swapaxes(solution.covariance, 1, 2))
    np.testing.assert_array_equal(solution.covariance_t, np.arange(0, 401, 30.0))


def test_without_a_reference_it_predicts(damping):
    v_ref = V_REF.copy()
    v_ref[100:] = np.nan
    solution = damping.solve(INS, v_ref)
    first = solution.parts[0] if solution.parts else solution
    assert not first.used[100:].any()
    assert np.isnan(first.nis[100:]).all()
    assert (solution.sigma[-1, 2:4] > solution.sigma[99, 2:4]).all()  # the place is no longer held


def test_the_gate_leaves_out_what_does_not_fit(damping):
    v_ref = V_REF.copy()
    v_ref[200] += 30.0
    gated = dataclasses.replace(damping, gate=0.9999)
    first = gated.solve(INS, v_ref)
    first = first.parts[0] if first.parts else first
    assert not first.used[200]
    assert first.nis[200] > gated.threshold == pytest.approx(-2 * math.log(1e-4), rel=1e-12)
    assert first.used.sum() >= len(INS) - 2
    plain = damping.solve(INS, v_ref)
    plain = plain.parts[0] if plain.parts else plain
    assert plain.used.all()
    assert np.abs(plain.x[201, :2] - first.x[201, :2]).max() > 0.3


def test_input_is_not_written_to(damping):
    copies = [array.copy() for array in (INS.v_n, INS.q_nb, INS.f_n, V_REF)]
    damping.solve(INS, V_REF)
    for array, copy in zip((INS.v_n, INS.q_nb, INS.f_n, V_REF), copies, strict=True):
        np.testing.assert_array_equal(array, copy)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda f: f.solve(INS, V_REF[:-1]), r"v_ref must have shape \(401, 2\)"),
        (lambda f: f.solve(INS, np.full((401, 2), np.inf)), "v_ref must be finite, or NaN"),
        (lambda f: f.solve(INS, np.c_[V_REF[:, 0], np.full(401, np.nan)]), "NaN both east and north"),
        (lambda f: f.solve(INS[:1], V_REF[:1]), "at least 2 rows"),
        (lambda f: f.start(0.0), "dt must be a positive number"),
        (lambda f: f.start(30.0), "dt must be at most 20 s"),
        (lambda f: f.advance(f.start(0.5), INS, V_REF), "go on in steps of dt = 0.5 s"),
        (lambda f: f.advance(f.advance(f.start(), INS[:3], V_REF[:3])[0], INS[5:], V_REF[5:]), "a step differs by 2 s"),
        (lambda f: f.advance(dataclasses.replace(f, gate=0.5).start(), INS, V_REF), "state must come from"),
        (lambda f: f.advance(f.start(), TRUTH.trajectory(), V_REF), "ins must be InsSamples"),
        (lambda f: dataclasses.replace(f, gate=1.0), "gate must be a probability"),
        (lambda f: dataclasses.replace(f, covariance_every=-1), "covariance_every must be an integer >= 0"),
        (lambda f: dataclasses.replace(f, model="good"), "model must be a DampingModel"),
        (lambda f: f.advance(f.start(), TRUTH.trajectory(), V_REF), "ins must be InsSamples, got Trajectory$"),
        (lambda f: f.advance(3, INS, V_REF), "state must come from start or advance of .*, got int$"),
        (lambda f: f.solve(TRUTH.trajectory(), V_REF), "ins must be InsSamples of at least 2 rows, got Trajectory$"),
        (
            lambda f: dataclasses.replace(f, model=DampingModel(tau_g=15.0)).start(2.0),
            "tau_g must be at least 10 steps of the filter, 20 s at steps of 2 s, got 15 s",
        ),
        (
            lambda f: dataclasses.replace(f, model=DampingModel(tau_f=1.0)).solve(INS, V_REF),
            "tau_f must be at least 10 steps of the filter, 10 s at steps of 1 s, got 1 s",
        ),
        (lambda f: f.solve(INS, V_REF).corrected(3), "ins must be an InsSamples, got 3"),
        (lambda f: f.solve(INS, V_REF).corrected(INS[:5]), "ins must have the times of the solution"),
    ],
)
def test_bad_input(damping, call, message):
    with pytest.raises(InputError, match=message):
        call(damping)


def test_what_is_not_finite_is_not_returned(damping):
    with pytest.raises(AccuracyError, match=f"{damping.name} diverges at t = "), np.errstate(all="ignore"):
        damping.solve(INS, np.where(np.arange(802).reshape(401, 2) // 2 % 2, 1.7e308, -1.7e308))


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("velocity-change", {"interval": 0.5}, "interval must be from 1 to 15 s"),
        ("double-filter", {"interval": 16.0}, "interval must be from 1 to 15 s"),
        ("velocity-change", {"change_noise": 0.0}, "change_noise must be a positive"),
        ("velocity-change", {"r2_reading": "jerk"}, "r2_reading"),
        ("double-filter", {"mean": "median"}, "mean"),
        ("double-filter", {"gamma_rate": 0.0}, "gamma_rate must be a positive"),
        ("double-filter", {"window": 0.0}, "window must be a positive"),
        ("bias-augmented", {"reference_bias": 0.0}, "reference_bias must be a positive"),
        ("bias-augmented", {"reference_tau": -1.0}, "reference_tau must be positive"),
        ("velocity-error", {"interval": 5.0}, "has no option 'interval'"),
    ],
)
def test_bad_options(name, options, message):
    with pytest.raises(InputError, match=message):
        bench.solver("damping", name, **options)


@pytest.mark.parametrize("name", ["velocity-change", "double-filter"])
def test_the_interval_is_a_whole_number_of_samples(name):
    with pytest.raises(InputError, match=r"interval must be a whole number of samples of 2 s, got 5\.0"):
        bench.solver("damping", name).start(2.0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: InsSamples.of(3), "trajectory must be a Trajectory, got 3"),
        (lambda: InsSamples.of(TRUTH.trajectory(), 3), "previous must be an InsSamples, got 3"),
        (lambda: InsSamples.joined(TRUTH, 3), r"parts\[1\] must be an InsSamples, got 3"),
        (lambda: dataclasses.replace(TRUTH, earth="wgs84"), "earth must be an Earth, got 'wgs84'"),
        (lambda: error_states(3, TRUTH.trajectory()), "ins must be an InsSamples or a Trajectory, got 3"),
        (lambda: error_states(INS, INS), "truth must be a Trajectory, got InsSamples"),
        (lambda: disturbed(3, np.zeros((1, 13))), "truth must be an InsSamples, got 3"),
        (lambda: reference_velocity(3, noise=0.1, seed=1), "truth must be an InsSamples, got 3"),
        (lambda: ErrorSimulation().advance(3, TRUTH), "state must be a SimulationState, got 3"),
        (lambda: ErrorSimulation().advance(ErrorSimulation().start(), 3), "truth must be an InsSamples, got 3"),
    ],
)
def test_wrong_types_are_named(call, message):
    with pytest.raises(InputError, match=message):
        call()


def test_readings_of_q():
    as_markov, as_printed = DampingModel.published(1000.0), DampingModel.published(1000.0, "printed")
    np.testing.assert_allclose(as_printed.density, 1000.0 * as_markov.density, rtol=1e-12)
    # 2 diag[(1e-4 g)^2 x2, 0, 0, (0.01 deg/h)^2 x3, (1e-5 g)^2 x3, (0.001 deg/h)^2 x3], printed
    g, h = 9.80665, math.radians(1) / 3600
    expected = 2 * np.array([1e-4 * g] * 2 + [0.0] * 2 + [0.01 * h] * 3 + [1e-5 * g] * 3 + [0.001 * h] * 3) ** 2
    np.testing.assert_allclose(as_printed.density, expected, rtol=1e-12)
    assert DampingModel() == DampingModel.published() == KNOWN
    with pytest.raises(InputError, match="q_reading"):
        DampingModel.published(q_reading="literal")
    with pytest.raises(InputError, match="tau must be a positive"):
        DampingModel.published(0.0)
    with pytest.raises(InputError, match="tilt must be a number >= 0"):
        DampingModel(tilt=-1.0)


def test_samples_refuse_what_does_not_fit():
    t = TRUTH.t.copy()
    t[5] += 0.1
    with pytest.raises(InputError, match="t must be equally spaced"):
        dataclasses.replace(TRUTH, t=t)
    with pytest.raises(InputError, match=r"f_n must have shape \(401, 3\)"):
        dataclasses.replace(TRUTH, f_n=TRUTH.f_n[:5])
    with pytest.raises(InputError, match="parts must be samples of one Earth"):
        InsSamples.joined(TRUTH[:5], dataclasses.replace(TRUTH[5:], earth=WGS84))
    with pytest.raises(InputError, match="t must be equally spaced"):
        InsSamples.of(TRUTH[10:].trajectory(), TRUTH[:5])
