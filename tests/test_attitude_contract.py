"""What every attitude solver must do, found by discovery: a new solver is tested without an edit here.

Truth: SciPy's Rotation for a constant rate; else laws that need no truth (equivariance, chunks, unit norm, latency).
"""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import bench
from bench.references import Source
from bench.solvers import solvers
from tests.attitude_cases import all_variants, swinging, variants, window
from tests.solver_cases import WRONG_SAMPLES, assert_choices_are_listed, assert_samples_are_refused, label

DT = 0.01
N_ALL = 840  # a multiple of all N, longer than any window
Q0 = np.array([0.5, -0.5, 0.1, math.sqrt(0.49)])
NAMES = sorted(solvers("attitude"))
ANY = all_variants(sizes=(1, 2, 3, 4, 8))


@pytest.fixture(params=ANY, ids=label)
def solver(request):
    return request.param


def chunked(solver, dtheta, chunk):
    """Return the rows after q0 and how many had come after each chunk, through start, advance, finish."""
    state, rows, counts = solver.start(DT, Q0), [], []
    for begin in range(0, len(dtheta), chunk):
        state, q = solver.advance(state, dtheta[begin : begin + chunk])
        rows.append(q)
        counts.append(sum(map(len, rows)))
    return np.concatenate([*rows, solver.finish(state)]), counts


def gentle(solver):
    """Return increments that turn by less than 0.1 rad in an update, for which the constant-rate tolerance speaks."""
    dtheta = swinging(N_ALL)
    return dtheta * (0.099 / (solver.samples * np.linalg.norm(dtheta, axis=1).max()))


def angle_between(q, rotation):
    return (Rotation.from_quat(q, scalar_first=True) * rotation.inv()).magnitude()


@pytest.mark.parametrize("name", NAMES)
def test_it_declares_itself(name):
    cls = solvers("attitude")[name]
    assert cls.name == name == cls.__module__.rsplit(".", 1)[1].replace("_", "-")
    assert isinstance(cls.source, Source)
    assert cls.__dataclass_params__.frozen
    first = cls.__doc__.splitlines()[0]
    assert first.endswith(".")
    assert "(" not in first.partition(":")[0]  # not the signature that dataclass writes
    assert variants(name), "it accepts no number of samples"
    assert cls() in variants(name), "the defaults are not among the variants"


def test_it_declares_orders_latency_and_tolerance(solver):
    for order in (solver.order_periodic, solver.order_drift):
        assert order is None or (isinstance(order, int) and order >= 1)
    before, after = solver.borrowed
    assert before >= 0
    assert solver.latency == after >= 0
    assert 1e-17 < solver.constant_rate_tolerance < 0.1


def test_at_rest_it_stays(solver):
    q = solver.solve(np.zeros((N_ALL, 3)), DT, Q0)
    assert q.shape == (N_ALL // solver.samples + 1, 4)
    np.testing.assert_allclose(q, np.tile(Q0, (len(q), 1)), rtol=0, atol=4e-16)  # one rounding of a normalisation


def test_row_zero_is_the_given_attitude(solver):
    np.testing.assert_array_equal(solver.solve(swinging(N_ALL), DT, Q0)[0], Q0)


def test_a_constant_rate_has_its_closed_form(solver):
    N, updates = solver.samples, 40
    turn = 0.1 * np.array([2.0, -3.0, 6.0]) / 7  # |turn| = 0.1 rad in every update
    dtheta = np.tile(turn / N, (updates * N, 1))
    q = solver.solve(dtheta, DT, Q0)
    truth = Rotation.from_quat(Q0, scalar_first=True) * Rotation.from_rotvec(np.arange(updates + 1)[:, None] * turn)
    error, tolerance = angle_between(q, truth), solver.constant_rate_tolerance
    # The declared error of each update, and roundings: of SciPy's product and of the solver's, 2 an update.
    assert (error <= np.arange(updates + 1) * (tolerance + 3e-16) + 1e-15).all(), f"largest {error.max():.2g} rad"
    if tolerance > 1e-14:  # then it is not rounding, and must not be declared larger than it is
        assert error[-1] > 0.3 * updates * tolerance


def test_quaternions_stay_unit(solver):
    q = solver.solve(swinging(N_ALL), DT, Q0)
    assert np.abs(np.linalg.norm(q, axis=1) - 1).max() < 1e-15


def test_turning_the_inertial_frame_turns_the_solution(solver):
    turn, dtheta = Rotation.from_rotvec([0.5, -1.1, 2.0]), gentle(solver)
    start = (turn * Rotation.from_quat(Q0, scalar_first=True)).as_quat(scalar_first=True)
    expected = turn * Rotation.from_quat(solver.solve(dtheta, DT, Q0), scalar_first=True)
    # Up to 840 roundings at random; and a matrix that is not orthonormal gives another quaternion in another frame.
    tolerance = 1e-13 + N_ALL * solver.constant_rate_tolerance
    assert angle_between(solver.solve(dtheta, DT, start), expected).max() < tolerance


def test_turning_the_body_frame_turns_the_solution(solver):
    turn, dtheta = Rotation.from_rotvec([-0.7, 0.3, 1.9]), gentle(solver)  # from b to another body frame
    start = (Rotation.from_quat(Q0, scalar_first=True) * turn.inv()).as_quat(scalar_first=True)
    expected = Rotation.from_quat(solver.solve(dtheta, DT, Q0), scalar_first=True) * turn.inv()
    # The increments are rounded otherwise, and a fit of high degree makes up to 1e4 of a rounding at its ends.
    tolerance = 1e-12 + N_ALL * solver.constant_rate_tolerance
    assert angle_between(solver.solve(turn.apply(dtheta), DT, start), expected).max() < tolerance


def test_any_chunking_gives_the_same_bits(solver):
    N, dtheta = solver.samples, swinging(N_ALL)
    whole = solver.solve(dtheta, DT, Q0, chunk=10**6)
    for chunk in {1, max(N - 1, 1), 7, 1000}:
        np.testing.assert_array_equal(solver.solve(dtheta, DT, Q0, chunk=chunk), whole, err_msg=f"chunk = {chunk}")
        np.testing.assert_array_equal(chunked(solver, dtheta, chunk)[0], whole[1:], err_msg=f"chunk = {chunk}")


def test_a_state_can_be_advanced_twice(solver):
    dtheta = swinging(N_ALL)
    state, _ = solver.advance(solver.start(DT, Q0), dtheta[:100])
    first, second = (solver.advance(state, dtheta[100:200])[1] for _ in range(2))
    assert len(first) > 0
    np.testing.assert_array_equal(first, second)


def test_a_row_appears_exactly_when_its_window_is_complete(solver):
    N, n = solver.samples, 10 * window(solver) * solver.samples
    _, counts = chunked(solver, swinging(n), 1)
    seen = np.arange(1, n + 1)
    due = np.where(seen < window(solver), 0, (seen - solver.latency) // N)
    np.testing.assert_array_equal(counts, due)


def test_input_is_not_touched_and_any_layout_is_taken(solver):
    dtheta = swinging(N_ALL)
    copy, expected = dtheta.copy(), solver.solve(dtheta, DT, Q0)
    readonly = dtheta.copy()
    readonly.flags.writeable = False
    strided = np.repeat(dtheta, 2, axis=0)[::2]
    for given in (readonly, strided, np.asfortranarray(dtheta), dtheta.tolist()):
        np.testing.assert_array_equal(solver.solve(given, DT, Q0), expected)
    np.testing.assert_array_equal(dtheta, copy)


def test_the_shortest_stream_is_one_window(solver):
    n = -(-window(solver) // solver.samples) * solver.samples
    assert len(solver.solve(swinging(n), DT, Q0)) == n // solver.samples + 1
    if n > solver.samples:
        short = n - solver.samples
        with pytest.raises(bench.InputError, match=rf"at least {window(solver)} increments .*got {short}"):
            solver.solve(swinging(short), DT, Q0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"dt": 0.0}, "dt must be a positive number, got 0.0"),
        ({"dt": -0.01}, "dt must be a positive number, got -0.01"),
        ({"dt": np.nan}, "dt must be finite"),
        ({"q0": [1.0, 0.0, 0.1, 0.0]}, r"q0 must be unit quaternions \(wxyz\), got norm 1.00498"),
        ({"q0": [1.0, 0.0, 0.0]}, r"q0 must have shape \(4,\), got \(3,\)"),
        ({"q0": [np.nan, 0.0, 0.0, 0.0]}, "q0 must be finite"),
        ({"dtheta_b": np.zeros((N_ALL, 2))}, r"dtheta_b must have shape \(n, 3\), got \(840, 2\)"),
        ({"dtheta_b": np.zeros(3)}, r"dtheta_b must have shape \(n, 3\), got \(3,\)"),
        ({"dtheta_b": np.zeros((0, 3))}, "dtheta_b must not be empty"),
        ({"dtheta_b": "x"}, "dtheta_b must be an array of real numbers"),
        ({"chunk": 0}, "chunk must be an integer >= 1, got 0"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
@pytest.mark.parametrize("name", NAMES)
def test_bad_input_is_named(name, change, message):
    arguments = {"dtheta_b": swinging(N_ALL), "dt": DT, "q0": Q0, **change}
    with pytest.raises(bench.InputError, match=message):
        bench.solver("attitude", name).solve(**arguments)


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("name", NAMES)
def test_an_increment_that_is_not_finite_is_named(name, value):
    dtheta = swinging(N_ALL)
    dtheta[17, 1] = value
    message = rf"dtheta_b must be finite, got {value} at \[17, 1\]"
    solver = bench.solver("attitude", name)
    with pytest.raises(bench.InputError, match=message):
        solver.solve(dtheta, DT, Q0)
    with pytest.raises(bench.InputError, match=message):
        solver.advance(solver.start(DT, Q0), dtheta)


def test_leftover_increments_are_an_error(solver):
    N = solver.samples
    if N == 1:
        return  # every number is a multiple
    dtheta = swinging(N_ALL + N - 1)
    message = f"dtheta_b must have a multiple of samples = {N} increments, got {len(dtheta)}"
    with pytest.raises(bench.InputError, match=message):
        solver.solve(dtheta, DT, Q0)
    state, _ = solver.advance(solver.start(DT, Q0), dtheta)
    with pytest.raises(bench.InputError, match=message):
        solver.finish(state)


@pytest.mark.parametrize("samples", WRONG_SAMPLES)
@pytest.mark.parametrize("name", NAMES)
def test_a_wrong_number_of_samples_is_named(name, samples):
    assert_samples_are_refused("attitude", name, samples)


@pytest.mark.parametrize("name", NAMES)
def test_an_unknown_choice_lists_the_known(name):
    assert_choices_are_listed("attitude", name)


@pytest.mark.filterwarnings("ignore::bench.errors.BenchWarning")  # that the series is too short for it
@pytest.mark.parametrize("row", [0, 400, N_ALL - 1])
def test_an_overflow_is_an_error_not_a_nan(solver, row):
    dtheta = swinging(N_ALL)
    dtheta[row] = [1e200, -1e200, 1e200]
    with pytest.raises(bench.AccuracyError, match=solver.name):
        solver.solve(dtheta, DT, Q0)
