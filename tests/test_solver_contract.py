"""What every gyro-free solver must do, found by discovery: a new solver is tested without an edit here.

Truth: rates, alpha and f of a hand-written motion (the solver sees only its readings); attitude, velocity and
position by closed form, or by laws that need no truth (equivariance, chunks, unit norm).
"""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import bench
from bench.references import Source
from bench.solvers import solvers
from bench.solvers.gyro_free import FIELDS
from tests.gyro_free_cases import GRAVITY, Wave, fitting, readings

DT = 0.01
INTEGRATIONS = ["fourth-order", "first-order"]
N = 1201


@pytest.fixture(params=sorted(solvers("gyro-free")))
def name(request):
    return request.param


@pytest.fixture(params=INTEGRATIONS)
def solver(name, request):
    return bench.solver("gyro-free", name, integration=request.param)


def wave_case(name, n=N, seed=3):
    there, wave = fitting(name), Wave(seed, swing=0.2)
    return there, wave.readings(there, DT * np.arange(n)), wave.initial()


def constant_case(there, omega, f_i, n):
    """Readings of a body that turns at a constant rate under a constant inertial specific force."""
    t = DT * np.arange(n)
    C_ib = Rotation.from_rotvec(t[:, None] * omega)
    f_b = C_ib.apply(f_i, inverse=True)
    rows = np.tile(omega, (n, 1))
    return t, C_ib, readings(there, rows, np.zeros((n, 3)), f_b)


def assert_same(a, b, atol=0.0, rtol=0.0):
    for field in FIELDS:
        np.testing.assert_allclose(getattr(a, field), getattr(b, field), atol=atol, rtol=rtol, err_msg=field)


def test_it_declares_itself(name):
    cls = solvers("gyro-free")[name]
    assert cls.name == name == cls.__module__.rsplit(".", 1)[1].replace("_", "-")
    assert isinstance(cls.source, Source)
    assert cls.order == 4
    assert dataclasses.is_dataclass(cls)
    assert cls.__dataclass_params__.frozen
    assert cls.__doc__.splitlines()[0].endswith(".")


def test_at_rest_it_stays(solver, name):
    there = fitting(name)
    n = 101
    f = np.tile(-GRAVITY, (n, 1))
    solution = solver.solve(there, readings(there, 0 * f, 0 * f, f), DT, bench.Initial(gravity=GRAVITY))
    # A rounding of 1e-15 m/s^2 in a square is 1e-7 rad/s where the rate is its root, and over a second 1e-7 rad,
    # times 10 m/s^2.
    assert np.abs(solution.omega_ib_b).max() < 3e-7
    np.testing.assert_allclose(solution.f_b, f, rtol=0, atol=1e-12)
    np.testing.assert_allclose(solution.q_ib, np.tile([1.0, 0, 0, 0], (n, 1)), rtol=0, atol=3e-7)
    assert np.abs(solution.velocity).max() < 3e-6
    assert np.abs(solution.position).max() < 3e-6


def test_constant_rate_has_its_closed_form(name):
    there = fitting(name)
    omega, f_i, n = np.array([1.2, -2.0, 0.7]), np.array([0.5, 1.0, 9.0]), N
    t, C_ib, A = constant_case(there, omega, f_i, n)
    initial = bench.Initial(omega_ib_b=omega, velocity=[1, 2, 3], position=[4, 5, 6], gravity=GRAVITY)
    solution = bench.solver("gyro-free", name).solve(there, A, DT, initial)
    a = f_i + GRAVITY
    # Constant omega and a constant inertial acceleration are integrated exactly; 1200 roundings remain, and the
    # array's 1e-15 m/s^2 over 0.1 m drift for 12 s.
    np.testing.assert_allclose(solution.omega_ib_b, np.tile(omega, (n, 1)), rtol=0, atol=1e-11)
    error = Rotation.from_quat(solution.q_ib, scalar_first=True) * C_ib.inv()
    assert error.magnitude().max() < 1e-11
    np.testing.assert_allclose(solution.velocity, [1, 2, 3] + t[:, None] * a, rtol=0, atol=1e-9)
    expected = [4, 5, 6] + t[:, None] * [1, 2, 3] + 0.5 * t[:, None] ** 2 * a
    np.testing.assert_allclose(solution.position, expected, rtol=0, atol=1e-8)


def test_first_order_turns_away_as_theory_says(name):
    # q o (1, omega h/2), normalised, turns by 2 atan(|omega| h/2) = |omega| h - |omega|^3 h^3/12 in a step:
    # |omega|^3 h^2/12 t = 0.0208 rad = 1.19 degrees after 60 s at (2, 2, 2) rad/s and 100 Hz.
    there, omega, n = fitting(name), np.array([2.0, 2.0, 2.0]), 6001
    _, C_ib, A = constant_case(there, omega, np.zeros(3), n)
    initial = bench.Initial(omega_ib_b=omega, gravity=(0, 0, 0))
    solution = bench.solver("gyro-free", name, integration="first-order").solve(there, A, DT, initial)
    angle = (Rotation.from_quat(solution.q_ib[-1], scalar_first=True) * C_ib[-1].inv()).magnitude()
    np.testing.assert_allclose(angle, np.sqrt(12.0) ** 3 * DT**2 / 12 * 60, rtol=1e-3)
    np.testing.assert_allclose(np.degrees(angle), 1.2, atol=0.05)


def test_row_zero_is_the_initial_state(solver, name):
    there, A, initial = wave_case(name)
    solution = solver.solve(there, A, DT, initial)
    for field in ("q_ib", "velocity", "position"):
        np.testing.assert_array_equal(getattr(solution, field)[0], getattr(initial, field))
    np.testing.assert_allclose(solution.omega_ib_b[0], initial.omega_ib_b, rtol=0, atol=1e-12)
    assert len(solution) == N


def test_quaternions_stay_unit(solver, name):
    solution = solver.solve(*wave_case(name)[:2], DT, wave_case(name)[2])
    assert np.abs(np.linalg.norm(solution.q_ib, axis=1) - 1).max() < 1e-14


def test_turning_the_inertial_frame_turns_the_solution(solver, name):
    there, A, initial = wave_case(name)
    turn = Rotation.from_rotvec([0.5, -1.1, 2.0])
    attitude = Rotation.from_quat(initial.q_ib, scalar_first=True)
    turned = bench.Initial(
        (turn * attitude).as_quat(scalar_first=True),
        initial.omega_ib_b,
        turn.apply(initial.velocity),
        turn.apply(initial.position),
        gravity=turn.apply(initial.gravity),
    )
    plain, there_too = solver.solve(there, A, DT, initial), solver.solve(there, A, DT, turned)
    np.testing.assert_array_equal(there_too.omega_ib_b, plain.omega_ib_b)
    expected = turn * Rotation.from_quat(plain.q_ib, scalar_first=True)
    difference = Rotation.from_quat(there_too.q_ib, scalar_first=True) * expected.inv()
    assert difference.magnitude().max() < 1e-13
    np.testing.assert_allclose(there_too.velocity, turn.apply(plain.velocity), rtol=0, atol=1e-11)
    np.testing.assert_allclose(there_too.position, turn.apply(plain.position), rtol=0, atol=1e-10)


@pytest.mark.parametrize("chunk", [1, 3, 7, 1000])
def test_any_chunking_gives_the_same_bits(solver, name, chunk):
    there, A, initial = wave_case(name)
    # Noise, so that negative squares and changing signs are among the rows.
    A = A + np.random.default_rng(1).normal(scale=0.3, size=A.shape)
    whole = solver.solve(there, A, DT, initial, chunk=10**6)
    assert_same(solver.solve(there, A, DT, initial, chunk=chunk), whole)
    state, pieces = solver.start(there, DT, initial), []
    for begin in range(0, N, chunk):
        state, piece = solver.advance(state, A[begin : begin + chunk])
        pieces.append(piece)
    pieces.append(solver.finish(state))
    for field in FIELDS:
        np.testing.assert_array_equal(np.concatenate([getattr(p, field) for p in pieces]), getattr(whole, field))
    assert sum(p.negative_squares for p in pieces) == whole.negative_squares


def test_a_state_can_be_advanced_twice(solver, name):
    there, A, initial = wave_case(name)
    state, _ = solver.advance(solver.start(there, DT, initial), A[:10])
    first, second = (solver.advance(state, A[10:20])[1] for _ in range(2))
    assert_same(first, second)


def test_fourth_order_gives_the_first_rows_with_the_fourth_reading(name):
    there, A, initial = wave_case(name)
    state, lengths = bench.solver("gyro-free", name).start(there, DT, initial), []
    for row in A[:6]:
        state, piece = bench.solver("gyro-free", name).advance(state, row[None])
        lengths.append(len(piece))
    assert lengths == [0, 0, 0, 4, 1, 1]


def test_input_is_not_touched_and_any_layout_is_taken(solver, name):
    there, A, initial = wave_case(name)
    expected = solver.solve(there, A, DT, initial)
    readonly = A.copy()
    readonly.flags.writeable = False
    strided = np.repeat(A, 2, axis=0)[::2]
    record = bench.Readings(DT * np.arange(N), A)
    copy = A.copy()
    for given in (readonly, strided, np.asfortranarray(A), A.tolist(), record):
        assert_same(solver.solve(there, given, DT, initial), expected)
    np.testing.assert_array_equal(A, copy)


def test_the_first_hour_of_time_does_not_look_unequal(solver, name):
    there, A, initial = wave_case(name)
    late = bench.Readings(1e6 + np.arange(N) / 100, A)
    assert_same(solver.solve(there, late, DT, initial), solver.solve(there, A, DT, initial))


def bad(**change):
    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (bad(dt=0.0), "dt must be a positive number, got 0.0"),
        (bad(dt=-0.01), "dt must be a positive number, got -0.01"),
        (bad(dt=np.nan), "dt must be finite"),
        (bad(readings=np.zeros((5, 2))), r"readings must have shape \(n, \d+\), got \(5, 2\)"),
        (bad(readings=np.zeros(5)), "readings must have shape"),
        (bad(readings="x"), "readings must be an array of real numbers"),
        (bad(readings=0), "at least 4 for fourth-order integration, got 3"),
        (bad(readings=np.nan), r"readings must be finite, got nan at \[2, 1\]"),
        (bad(readings=np.inf), r"readings must be finite, got inf at \[2, 1\]"),
        (bad(chunk=0), "chunk must be an integer >= 1, got 0"),
        (bad(initial=None), "initial must be a bench.Initial, got NoneType"),
        (bad(accelerometers=None), "accelerometers must be a bench.Accelerometers, got NoneType"),
    ],
)
def test_bad_input_is_named(name, change, message):
    there, A, initial = wave_case(name, n=20)
    arguments = {"accelerometers": there, "readings": A, "dt": DT, "initial": initial, **change}
    value = arguments["readings"]
    if isinstance(value, int):
        arguments["readings"] = A[:3]
    elif isinstance(value, float):
        arguments["readings"] = A.copy()
        arguments["readings"][2, 1] = value
    with pytest.raises(bench.InputError, match=message):
        bench.solver("gyro-free", name).solve(**arguments)


@pytest.mark.parametrize(
    ("t", "message"),
    [
        (
            np.arange(20) * 0.02,
            r"dt = 0.01 s and readings.t must agree, got readings.t\[1\] - readings.t\[0\] = 0.02 s",
        ),
        (np.delete(np.arange(21), 7) * 0.01, r"readings.t\[7\] - readings.t\[6\] = 0.02 s"),
    ],
)
def test_times_that_disagree_with_dt_are_refused(name, t, message):
    there, A, initial = wave_case(name, n=20)
    with pytest.raises(bench.InputError, match=message):
        bench.solver("gyro-free", name).solve(there, bench.Readings(t, A), DT, initial)


def test_advance_checks_its_chunk(solver, name):
    there, A, initial = wave_case(name, n=20)
    state = solver.start(there, DT, initial)
    with pytest.raises(bench.InputError, match="readings must have shape"):
        solver.advance(state, A[:, :-1])
    with pytest.raises(bench.InputError, match="readings must not be empty"):
        solver.advance(state, A[:0])


def test_a_stream_that_ends_too_early_is_an_error(name):
    there, A, initial = wave_case(name, n=20)
    solver = bench.solver("gyro-free", name)
    state, _ = solver.advance(solver.start(there, DT, initial), A[:3])
    with pytest.raises(bench.InputError, match="at least 4 for fourth-order integration, got 3"):
        solver.finish(state)


def test_first_order_takes_a_single_reading(name):
    there, A, initial = wave_case(name, n=1)
    assert len(bench.solver("gyro-free", name, integration="first-order").solve(there, A, DT, initial)) == 1


@pytest.mark.parametrize("row", [0, 5, 19])
def test_an_overflow_is_an_error_not_an_infinity(solver, name, row):
    there, A, initial = wave_case(name, n=20)
    A[row] = 1.7e308 * np.where(np.arange(A.shape[1]) % 2, -1, 1)
    with pytest.raises(bench.AccuracyError, match=f"{name} overflows"):
        solver.solve(there, A, DT, initial)


def test_an_unknown_integration_lists_the_known(name):
    with pytest.raises(bench.UnknownNameError, match="fourth-order"):
        bench.solver("gyro-free", name, integration="fifth-order")
