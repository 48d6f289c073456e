"""What every navigation solver must do, found by discovery: a new solver is tested without an edit here.

Truth: a body at rest on the Earth, in closed form; MuJoCo's increments of a flight over the pole; else laws that need
no truth (equivariance, chunks, unit norm, ownership of states).
"""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import bench
from bench.references import Source
from bench.solvers import solvers
from tests.inertial_cases import OverThePole, flown, largest
from tests.navigation_cases import (
    CRUDE,
    all_variants,
    at_rest,
    goes_over_poles,
    initial,
    is_late,
    swaying,
    variants,
)
from tests.solver_cases import WRONG_SAMPLES, assert_choices_are_listed, assert_samples_are_refused, label

DT = 0.01
N_ALL = 240  # a multiple of all N
START = initial()
NAMES = sorted(solvers("navigation"))
ANY = all_variants()
PARTS = ("q_eb", "v_e", "r_e")


@pytest.fixture(params=ANY, ids=label)
def solver(request):
    return request.param


def solved(solver, increments, start=START, **options):
    return solver.solve(*increments, DT, start, **options)


def parts(estimate):
    """Return attitude, velocity and position side by side, (n, 10)."""
    return np.concatenate([getattr(estimate, name) for name in PARTS], axis=1)


def chunked(solver, increments, chunk):
    """Return the rows after the first, through start and advance."""
    state, rows = solver.start(DT, START), []
    for begin in range(0, len(increments[0]), chunk):
        state, estimate = solver.advance(state, *(part[begin : begin + chunk] for part in increments))
        rows += [] if estimate is None else [np.column_stack([estimate.t, parts(estimate)])]
    return np.concatenate(rows)


def turned(estimate, turn):
    """Return attitude (as Rotation), velocity and position of an estimate with e turned."""
    attitude = turn * Rotation.from_quat(estimate.q_eb, scalar_first=True)
    return attitude, turn.apply(estimate.v_e), turn.apply(estimate.r_e)


def angles(estimate, rotations):
    return (Rotation.from_quat(estimate.q_eb, scalar_first=True) * rotations.inv()).magnitude()


@pytest.mark.parametrize("name", NAMES)
def test_it_declares_itself(name):
    cls = solvers("navigation")[name]
    assert cls.name == name == cls.__module__.rsplit(".", 1)[1].replace("_", "-")
    assert isinstance(cls.source, Source)
    assert cls.__dataclass_params__.frozen
    first = cls.__doc__.splitlines()[0]
    assert first.endswith(".")
    assert "(" not in first.partition(":")[0]  # not the signature that dataclass writes
    assert variants(name), "it accepts no number of samples"
    assert cls() in variants(name, range(1, 9)), "the defaults are not among the variants"


def test_it_declares_an_order_or_none(solver):
    order = solver.order_periodic
    assert order is None or (isinstance(order, int) and order >= 1)


@pytest.mark.parametrize("latitude", [0.0, 0.9, -np.pi / 2, np.pi / 2], ids=["equator", "middle", "south", "north"])
@pytest.mark.parametrize("solver", [solver for solver in ANY if not is_late(solver)], ids=label)
def test_at_rest_on_the_earth_it_stays(solver, latitude):
    start = initial(latitude, 0.0, 30.0, (0.0, 0.0, 0.0))
    increments = at_rest(N_ALL, DT, latitude, 30.0, start.q_nb)
    if abs(latitude) > 1.5 and not goes_over_poles(solver):
        with pytest.raises((bench.AccuracyError, bench.InputError), match=rf"{solver.name} .* poles?[:,]"):
            solved(solver, increments, start)
        return
    estimate = solved(solver, increments, start)
    first = estimate.q_eb[:1]
    # In 2.4 s. First-order rotation leaves (omega_ie T)^2 g / 6; else roundings: of 6.4e6 m (1e-9 m), and of g t.
    # Crude ones resolve the force, or gravity, half an update too early: omega_ie T/2 g.
    seconds, lag = N_ALL * DT, 9.9 * 7.3e-5 * DT / 2 if solver.name in CRUDE else 0.0
    assert angles(estimate, Rotation.from_quat(first, scalar_first=True)).max() < 1e-13
    assert np.abs(estimate.v_e).max() < 1e-9 + lag * seconds
    assert np.abs(estimate.r_e - estimate.r_e[0]).max() < 5e-8 + lag * seconds**2 / 2


def test_the_first_row_is_the_initial_state(solver):
    estimate = solved(solver, swaying(N_ALL))
    np.testing.assert_allclose(estimate.q_nb[0], START.q_nb, rtol=0, atol=1e-15)
    np.testing.assert_allclose(estimate.v_n[0], START.v_n, rtol=0, atol=1e-14)
    np.testing.assert_allclose([estimate.latitude[0], estimate.longitude[0]], [0.7, -2.0], rtol=0, atol=1e-15)
    assert abs(estimate.height[0] - 500.0) < 2e-9


def test_it_gives_unit_quaternions_at_every_update(solver):
    estimate = solved(solver, swaying(N_ALL))
    assert len(estimate) == N_ALL // solver.samples + 1
    np.testing.assert_array_equal(estimate.t, np.arange(len(estimate)) * (solver.samples * DT))
    assert np.isfinite(parts(estimate)).all()
    assert np.abs(np.linalg.norm(estimate.q_eb, axis=1) - 1).max() < 2e-15


def test_a_held_height_is_held(solver):
    estimate = solved(solver, swaying(N_ALL))
    if solver.height == "held":
        assert np.abs(estimate.height - 500.0).max() < 1e-8  # a few roundings of 6.4e6 m
        assert np.abs(estimate.v_n[1:, 2]).max() < 1e-12
    else:
        assert np.abs(estimate.height - 500.0).max() > 1.0  # the sway lifts it


def test_turning_the_body_frame_turns_the_attitude_only(solver):
    turn, (dtheta, dvel) = Rotation.from_rotvec([-0.7, 0.3, 1.9]), swaying(N_ALL)  # from b to another body frame
    q_nb = (Rotation.from_quat(START.q_nb, scalar_first=True) * turn.inv()).as_quat(scalar_first=True)
    estimate = solved(solver, (turn.apply(dtheta), turn.apply(dvel)), initial(q_nb=q_nb))
    expected = solved(solver, (dtheta, dvel))
    # The increments are rounded otherwise, and a fit of high degree makes up to 1e4 of a rounding at its ends.
    assert angles(estimate, Rotation.from_quat(expected.q_eb, scalar_first=True) * turn.inv()).max() < 2e-12
    assert np.abs(estimate.v_e - expected.v_e).max() < 1e-10
    assert np.abs(estimate.r_e - expected.r_e).max() < 5e-8


@pytest.mark.parametrize("shift", [1.1, -2.9])
def test_another_longitude_turns_everything(solver, shift):
    estimate = solved(solver, swaying(N_ALL), initial(longitude=-2.0 + shift))
    attitude, velocity, position = turned(solved(solver, swaying(N_ALL)), Rotation.from_rotvec([0.0, 0.0, shift]))
    assert angles(estimate, attitude).max() < 1e-13
    assert np.abs(estimate.v_e - velocity).max() < 1e-10
    assert np.abs(estimate.r_e - position).max() < 3e-7  # a rounding of 6.4e6 m at each of 240 updates, all one way


@pytest.mark.parametrize("name", [name for name in NAMES if any(map(goes_over_poles, variants(name)))])
def test_it_flies_over_the_pole(name):
    options = {"azimuth": "wander"} if hasattr(solvers("navigation")[name], "azimuth") else {}
    motion = OverThePole()
    attitude, velocity, position = largest(flown(motion, 10.0, name, samples=2, **options), motion)
    # The body turns at a constant 0.6 rad/s, for which two samples are accurate; an error of 1e-6 m/s^2 would be seen.
    assert attitude.max() < 1e-10
    assert velocity.max() < 1e-5
    assert position.max() < 1e-4


def test_any_chunking_gives_the_same_bits(solver):
    increments = swaying(N_ALL)
    whole = solved(solver, increments, chunk=10**6)
    expected = np.column_stack([whole.t, parts(whole)])
    for chunk in {1, max(solver.samples - 1, 1), 7, 130}:
        np.testing.assert_array_equal(parts(solved(solver, increments, chunk=chunk)), expected[:, 1:], f"{chunk}")
        np.testing.assert_array_equal(chunked(solver, increments, chunk), expected[1:], f"chunk = {chunk}")


def test_a_state_can_be_advanced_twice(solver):
    dtheta, dvel = swaying(N_ALL)
    state, _ = solver.advance(solver.start(DT, START), dtheta[:100], dvel[:100])
    first, second = (parts(solver.advance(state, dtheta[100:200], dvel[100:200])[1]) for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_a_chunk_may_be_empty_or_too_short_for_an_update(solver):
    state, estimate = solver.advance(solver.start(DT, START), np.zeros((0, 3)), np.zeros((0, 3)))
    assert estimate is None
    if solver.samples > 1:
        state, estimate = solver.advance(state, np.zeros((1, 3)), np.zeros((1, 3)))
        assert estimate is None
        assert len(state.kept) == 1


def test_a_state_belongs_to_its_solver(solver):
    other = dataclasses.replace(solver, height="held" if solver.height == "free" else "free")
    dtheta, dvel = swaying(N_ALL)
    with pytest.raises(bench.InputError, match="state must come from start or advance of"):
        solver.advance(other.start(DT, START), dtheta, dvel)
    with pytest.raises(bench.InputError, match="state must come from start or advance of"):
        solver.advance(None, dtheta, dvel)


def test_input_is_not_touched_and_any_layout_is_taken(solver):
    increments = swaying(N_ALL)
    copies, expected = [part.copy() for part in increments], parts(solved(solver, increments))
    readonly = [part.copy() for part in increments]
    for part in readonly:
        part.flags.writeable = False
    strided = [np.repeat(part, 2, axis=0)[::2] for part in increments]
    columns, lists = [np.asfortranarray(part) for part in increments], [part.tolist() for part in increments]
    for given in (readonly, strided, columns, lists):
        np.testing.assert_array_equal(parts(solved(solver, given)), expected)
    for part, copy in zip(increments, copies, strict=True):
        np.testing.assert_array_equal(part, copy)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"dt": 0.0}, "dt must be a positive number, got 0.0"),
        ({"dt": np.nan}, "dt must be finite"),
        ({"initial": None}, "initial must be of type NavigationInitial, got NoneType"),
        ({"earth": "wgs84"}, "earth must be of type Earth, got str"),
        ({"dtheta_b": np.zeros((N_ALL, 2))}, r"dtheta_b must have shape \(n, 3\), got \(240, 2\)"),
        ({"dtheta_b": np.zeros((0, 3))}, "dtheta_b must not be empty"),
        ({"dtheta_b": "x"}, "dtheta_b must be an array of real numbers"),
        ({"dvel_b": np.zeros((N_ALL + 1, 3))}, r"dvel_b must have shape \(240, 3\), got \(241, 3\)"),
        ({"chunk": 0}, "chunk must be an integer >= 1, got 0"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
@pytest.mark.parametrize("name", NAMES)
def test_bad_input_is_named(name, change, message):
    dtheta, dvel = swaying(N_ALL)
    arguments = {"dtheta_b": dtheta, "dvel_b": dvel, "dt": DT, "initial": START, **change}
    with pytest.raises(bench.InputError, match=message):
        bench.solver("navigation", name).solve(**arguments)


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("which", [0, 1], ids=["dtheta_b", "dvel_b"])
@pytest.mark.parametrize("name", NAMES)
def test_an_increment_that_is_not_finite_is_named(name, which, value):
    increments = swaying(N_ALL)
    increments[which][17, 1] = value
    message = rf"{('dtheta_b', 'dvel_b')[which]} must be finite, got {value} at \[17, 1\]"
    solver = bench.solver("navigation", name)
    with pytest.raises(bench.InputError, match=message):
        solver.solve(*increments, DT, START)
    with pytest.raises(bench.InputError, match=message):
        solver.advance(solver.start(DT, START), *increments)


def test_leftover_increments_are_an_error(solver):
    N = solver.samples
    if N == 1:
        return  # every number is a multiple
    message = f"dtheta_b must have a multiple of samples = {N} increments, got {N_ALL + 1}"
    with pytest.raises(bench.InputError, match=message):
        solved(solver, swaying(N_ALL + 1))


@pytest.mark.parametrize("samples", WRONG_SAMPLES)
@pytest.mark.parametrize("name", NAMES)
def test_a_wrong_number_of_samples_is_named(name, samples):
    assert_samples_are_refused("navigation", name, samples)


@pytest.mark.parametrize("name", NAMES)
def test_an_unknown_choice_lists_the_known(name):
    assert_choices_are_listed("navigation", name)


@pytest.mark.parametrize("row", [0, 100])
def test_an_overflow_is_an_error_not_a_nan(solver, row):
    for which in range(2):
        increments = swaying(N_ALL)
        increments[which][row] = [1e200, -1e200, 1e200]
        with pytest.raises(bench.AccuracyError, match=solver.name):
            solved(solver, increments)
