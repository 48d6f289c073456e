"""Motions: every stated derivative against high-order differences of what it is the derivative of, values against
closed forms in mpmath, SciPy's DOP853 and digits from mpmath's Taylor integrator, and bad input.
"""

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import j1

import bench
from bench import rotation as rot
from bench.errors import AccuracyError, InputError, UnknownNameError
from bench.motion import STANDARD, Motion
from bench.motion.body_rate import BodyRate
from bench.motion.circular import Circular
from bench.motion.coning import Coning
from bench.motion.constant_rate import ConstantRate
from bench.motion.euler_swing import EulerSwing
from bench.motion.rest import Rest
from bench.motion.savage_manoeuvre import SavageManoeuvre
from bench.motion.sculling import Sculling
from bench.motion.spline import Spline
from bench.registry import discover
from bench.units import ARCSEC, DEG
from tests.motion_examples import Example, earth_examples

EPS = float(np.finfo(float).eps)
SKEW = rot.quat_normalize(np.array([0.3, -0.4, 0.5, 0.7]))
SWING = EulerSwing(
    amplitude=(0.9, 0.7, 1.3),
    angular_frequency=(0.7, 1.1, 1.9),
    phase=(0.3, -0.8, 2.0),
    offset=(0.5, 1.2, -2.0),  # the pitch goes through 90 degrees
    velocity=(1.0, -2.0, 0.5),
    position=(3.0, 4.0, 5.0),
)
TABLE = np.array(  # coefficients of the large-angle manoeuvre of Savage (2006), Eq. 15 of [Xu]
    [
        [-1.1, 0.45, -0.6, 1.1, -0.1, 0.2, 0.3],
        [-0.5, 1.0, -0.3, 0.7, -0.2, -0.5, 0.6],
        [0.3, -1.2, 2.0, -0.9, 0.4, 0.8, -0.9],
    ]
)


def manoeuvre_rate(t):
    """Derivative of the integrated body rate sum c_k t^k + c sin(wt) + d (1 - cos(wt)), w = 2.6 pi."""
    w = 2.6 * math.pi
    terms = [np.ones_like(t), 2 * t, 3 * t**2, 4 * t**3, 5 * t**4, w * np.cos(w * t), w * np.sin(w * t)]
    return np.stack(terms, axis=1) @ TABLE.T


def wavy(t):
    """A rate with harmonics in each axis, up to 9 rad/s^2."""
    return np.stack([np.cos(3 * t), 2 * np.sin(2 * t) + 0.5, np.exp(np.sin(t)) - 1], axis=1)


def wavy_derivative(t):
    return np.stack([-3 * np.sin(3 * t), 4 * np.cos(2 * t), np.cos(t) * np.exp(np.sin(t))], axis=1)


def lift(t):
    """Translation along a helix, with its derivatives."""
    s, c, one = np.sin(2 * t), np.cos(2 * t), np.ones_like(t)
    return (
        np.stack([s, c, 3 * t], axis=1),
        np.stack([2 * c, -2 * s, 3 * one], axis=1),
        np.stack([-4 * s, -4 * c, 0 * one], axis=1),
    )


POSE_TIMES = np.sort(np.append(np.linspace(0, 20, 61), [0.1, 7.77]))  # uneven on purpose


def poses():
    """Recorded poses of the swing, every other quaternion with the other sign."""
    truth = SWING.kinematics(POSE_TIMES)
    waypoints = np.stack([np.sin(POSE_TIMES), np.cos(0.7 * POSE_TIMES), POSE_TIMES**2 / 40], axis=1)
    return Spline(POSE_TIMES, waypoints, truth.q_ib * (-1.0) ** np.arange(len(POSE_TIMES))[:, None])


def examples():
    return {
        "rest": [Example(Rest()), Example(Rest(q_ib=SKEW, position=(1, 2, 3), gravity=(0, 0, 9.8)))],
        "constant-rate": [
            Example(ConstantRate()),
            Example(ConstantRate((3.0, -2.0, 1.0), q_ib=SKEW, velocity=(1, 2, 3), position=(4, 5, 6)), fastest=4.0),
            Example(ConstantRate((0.0, 0.0, 0.0), velocity=(1, 0, 0))),
            Example(ConstantRate((1e-9, 0.0, 2e-9))),
        ],
        "coning": [Example(Coning(), fastest=13.0), Example(Coning(90 * DEG, 5.0, position=(1, 2, 3)), fastest=9.0)],
        "circular": [
            Example(Circular(), fastest=4.0),
            Example(Circular(3.0, -0.5, 0.02, (0.1, 0.2, -0.3), SKEW), fastest=2.0),
        ],
        "sculling": [
            Example(Sculling(), fastest=65.0),
            Example(Sculling(1.0, 0.2, 7.0, "z", "x", q_ib=SKEW, position=(1, 2, 3)), fastest=15.0),
        ],
        "euler-swing": [Example(EulerSwing(), fastest=2.0), Example(SWING, fastest=6.0)],
        "body-rate": [
            Example(BodyRate(wavy, (0.0, 60.0), SKEW), fastest=6.0),
            Example(BodyRate(wavy, (0.0, 60.0), SKEW, wavy_derivative, lift), fastest=6.0),
            Example(BodyRate(manoeuvre_rate, (0.0, 1.2)), span=(0.0, 1.2), fastest=20.0),
            Example(BodyRate(wavy, (100.0, 103.0)), span=(100.0, 103.0), fastest=6.0),
        ],
        "savage-manoeuvre": [
            Example(SavageManoeuvre(), span=(0.0, 1.2), fastest=20.0),
            Example(SavageManoeuvre(SKEW, (1, 2, 3), (0, 0, 9.8)), span=(0.0, 1.2), fastest=20.0),
        ],
        "spline": [
            Example(poses(), (0.0, 20.0), 20.0, tuple(POSE_TIMES)),
            Example(Spline(POSE_TIMES, poses().position), (0.0, 20.0), 20.0, tuple(POSE_TIMES)),
            Example(Spline(POSE_TIMES, q_ib=poses().q_ib), (0.0, 20.0), 20.0, tuple(POSE_TIMES)),
        ],
        **earth_examples(),
    }


EXAMPLES = [
    pytest.param(example, id=f"{name}-{k}") for name, rows in examples().items() for k, example in enumerate(rows)
]


def angle_between(p, q):
    """Angles of the rotations from p to q, shape (n,), rad."""
    return 2 * np.linalg.norm(rot.quat_multiply(rot.quat_conjugate(p), q)[:, 1:], axis=1)


def body_rate_of_manoeuvre():
    return BodyRate(manoeuvre_rate, (0.0, 1.2))


# What every motion must do


def test_every_motion_has_an_example():
    assert set(examples()) == set(discover("bench.motion", Motion))


def difference(function, t, h):
    """Eighth-order central difference of function(t) (n, k)."""
    weights = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}
    return sum(w / h * (function(t + k * h) - function(t - k * h)) for k, w in weights.items())


@pytest.mark.parametrize("example", EXAMPLES)
def test_derivatives_agree_with_each_other(example):
    """At 400 random times, to 1e-11 of the fastest change and a few roundings of the value over the step.

    With a step h of about 0.05 periods/(2 pi) the difference's own truncation is (w h)^8/630 < 1e-12. Times and step
    are binary fractions, so that t + h is not rounded.
    """
    h = 2.0 ** math.floor(math.log2(0.06 / example.fastest))
    rng = np.random.default_rng(1)
    t = np.round(rng.uniform(example.span[0] + 5 * h, example.span[1] - 5 * h, 400) * 2**20) / 2**20
    if example.knots:  # between the knots: there the spline is a polynomial
        t = t[np.abs(t[:, None] - np.array(example.knots)).min(axis=1) > 4 * h]
    assert len(t) > 100
    motion = example.motion
    at = motion.kinematics(t)
    pure_rate = np.hstack([np.zeros((len(t), 1)), at.omega_ib_b])
    for field, stated in (
        ("position", at.velocity),
        ("velocity", at.acceleration),
        ("q_ib", 0.5 * rot.quat_multiply(at.q_ib, pure_rate)),
        ("omega_ib_b", at.alpha_ib_b),
    ):
        value = getattr(at, field)

        def at_time(x, field=field, value=value):
            there = getattr(motion.kinematics(x), field)
            # A quaternion may stand with either sign, and may change it between two times.
            return there * np.sign((there * value).sum(axis=1, keepdims=True)) if field == "q_ib" else there

        measured = difference(at_time, t, h)
        scale = example.fastest * np.ptp(value, axis=0).max() + np.abs(stated).max()
        atol = 1e-11 * scale + 16 * EPS * np.abs(value).max() / h
        np.testing.assert_allclose(measured, stated, rtol=0, atol=atol, err_msg=field)


@pytest.mark.parametrize("example", EXAMPLES)
def test_kinematics_do_not_depend_on_how_the_times_are_cut(example):
    """Bit for bit: in one block, in odd pieces, backwards."""
    motion, t = example.motion, np.linspace(*example.span, 203)
    whole, reverse = motion.kinematics(t), motion.kinematics(t[::-1])
    pieces = [motion.kinematics(part) for part in (t[:1], t[1:8], t[8:101], t[101:])]
    for field in vars(whole):
        np.testing.assert_array_equal(np.concatenate([getattr(p, field) for p in pieces]), getattr(whole, field))
        np.testing.assert_array_equal(getattr(reverse, field)[::-1], getattr(whole, field))
    assert np.abs(np.linalg.norm(whole.q_ib, axis=1) - 1).max() < 4 * EPS


@pytest.mark.parametrize("example", EXAMPLES)
def test_times_are_checked(example):
    with pytest.raises(InputError, match=r"t must be finite, got nan at \[1\]"):
        example.motion.kinematics([0.5 * sum(example.span), math.nan])
    with pytest.raises(InputError, match="t must not be empty"):
        example.motion.kinematics([])
    with pytest.raises(InputError, match=r"t must have shape \(n,\)"):
        example.motion.kinematics([[0.0, 1.0]])


@pytest.mark.parametrize("example", EXAMPLES)
def test_initial_state_is_the_truth_at_that_time(example):
    t0 = 0.5 * sum(example.span)
    initial, truth = example.motion.initial(t0), example.motion.kinematics([t0])
    for field in ("q_ib", "omega_ib_b", "velocity", "position", "gravity"):
        np.testing.assert_array_equal(getattr(initial, field), getattr(truth, field)[0])


@pytest.mark.parametrize("name", sorted(set(examples()) - set(earth_examples())))
def test_gravity_is_an_option(name):
    """On the Earth it is not: there gravitation follows from the place."""
    example = examples()[name][0]
    truth = example.motion.kinematics([example.span[0]])
    np.testing.assert_array_equal(truth.gravity[0], STANDARD)
    changed = replace(example.motion, gravity=(0.0, 1.0, 2.0))
    np.testing.assert_array_equal(changed.kinematics([example.span[0]]).gravity[0], [0, 1, 2])


def test_a_motion_of_ones_own():
    class Fall(bench.Motion):
        def kinematics(self, t):
            t = np.asarray(t)
            fall = np.array([0.0, 0.0, -9.8])
            return bench.Kinematics(
                position=0.5 * t[:, None] ** 2 * fall,
                velocity=t[:, None] * fall,
                acceleration=fall,
                q_ib=(1, 0, 0, 0),
                omega_ib_b=(0, 0, 0),
                alpha_ib_b=(0, 0, 0),
                gravity=fall,
            )

    truth = Fall().kinematics(np.array([0.0, 1.0, 2.0]))
    assert len(truth) == 3
    assert truth.acceleration.shape == (3, 3)
    np.testing.assert_array_equal(Fall().initial(2.0).position, [0, 0, -19.6])


def test_motions_are_values():
    assert Coning() == Coning(5 * DEG)
    assert hash(ConstantRate(np.array([1.0, 2.0, 3.0]))) == hash(ConstantRate((1, 2, 3)))
    with pytest.raises(AttributeError):
        Coning().half_angle = 1.0


# Closed forms


@pytest.mark.parametrize("t", [0.0, 0.123, 60.0, 3600.1, 1e6 + 0.37])
def test_coning_against_mpmath(t):
    """Eq. 14 of [Xu] in 50 digits, for hours: the phase w t must not lose what it has before the point."""
    motion = Coning()
    with mpmath.workdps(50):
        w, a, tau = mpmath.mpf(motion.angular_frequency), mpmath.mpf(motion.half_angle), mpmath.mpf(t)
        s, c = mpmath.sin(w * tau), mpmath.cos(w * tau)
        q = [mpmath.cos(a / 2), mpmath.sin(a / 2) * s, mpmath.sin(a / 2) * c, 0]
        omega = [w * mpmath.sin(a) * c, -w * mpmath.sin(a) * s, 2 * w * mpmath.sin(a / 2) ** 2]
        q, omega = (np.array([float(x) for x in v]) for v in (q, omega))
    truth = motion.kinematics([t])
    np.testing.assert_allclose(truth.q_ib[0], q, rtol=0, atol=2 * EPS)
    np.testing.assert_allclose(truth.omega_ib_b[0], omega, rtol=0, atol=4 * EPS)


@pytest.mark.parametrize("rate", [100.0, 10_000.0])
def test_coning_increments_are_the_integral_of_the_rate(rate):
    """Against Gauss-Legendre quadrature with 8 nodes, whose own error at w h = 0.13 is below 1e-30."""
    motion, n, t0 = Coning(), 50, 0.3
    x, weights = np.polynomial.legendre.leggauss(8)
    nodes = t0 + (np.arange(n)[:, None] + 0.5 + 0.5 * x) / rate
    omega = motion.kinematics(nodes.ravel()).omega_ib_b.reshape(n, 8, 3)
    expected = np.einsum("j,njk->nk", weights / 2 / rate, omega)
    np.testing.assert_allclose(motion.increments(rate, n, t0), expected, rtol=0, atol=1e-15 * 100 / rate)


@pytest.mark.parametrize("t", [0.1, 60.0, 3600.1])
def test_constant_rate_against_mpmath(t):
    """q_ib o exp(omega t / 2) in 50 digits, over thousands of turns."""
    motion = ConstantRate((2.0, -1.3, 0.7), q_ib=SKEW)
    with mpmath.workdps(50):
        w = [mpmath.mpf(x) for x in motion.omega_ib_b]
        norm = mpmath.sqrt(sum(x * x for x in w))
        half = norm * mpmath.mpf(t) / 2
        step = np.array([float(mpmath.cos(half))] + [float(mpmath.sin(half) * x / norm) for x in w])
    np.testing.assert_allclose(
        motion.kinematics([t]).q_ib[0], rot.quat_multiply(motion.q_ib, step), rtol=0, atol=4 * EPS
    )


def test_circular_has_the_conditions_of_the_paper():
    """[Qin], section 2: from (10, 0, 0) at rest, anticlockwise, 0.01 rad/s^2, so 18 rad and 0.6 rad/s at 60 s."""
    truth = Circular().kinematics([0.0, 60.0])
    np.testing.assert_array_equal(truth.position[0], [10, 0, 0])
    np.testing.assert_array_equal(truth.velocity[0], [0, 0, 0])
    np.testing.assert_allclose(truth.acceleration[0], [0, 0.1, 0], rtol=0, atol=1e-16)
    np.testing.assert_array_equal(truth.q_ib[0], [1, 0, 0, 0])
    np.testing.assert_array_equal(truth.omega_ib_b, [[2, 2, 2]] * 2)
    direction = np.array([math.cos(18.0), math.sin(18.0), 0.0])
    np.testing.assert_allclose(truth.position[1], 10 * direction, rtol=0, atol=1e-13)
    np.testing.assert_allclose(truth.velocity[1], 6 * np.cross([0, 0, 1], direction), rtol=0, atol=1e-13)
    half = 60 * math.sqrt(3)
    np.testing.assert_allclose(
        truth.q_ib[1], [math.cos(half), *[math.sin(half) / math.sqrt(3)] * 3], rtol=0, atol=3e-14
    )


@pytest.mark.parametrize(("angular_axis", "linear_axis"), [("x", "y"), ("y", "x"), ("z", "y")])
def test_sculling_rectifies(angular_axis, linear_axis):
    """The mean of f_b over a period without gravity is D w^2 J1(A) k x l; 64 even points integrate it exactly."""
    A, D, w = 0.3, 0.02, 20.0
    motion = Sculling(A, D, w, angular_axis, linear_axis, q_ib=SKEW)
    truth = motion.kinematics(np.arange(64) * (2 * math.pi / w / 64))
    mean = rot.quat_rotate(rot.quat_conjugate(truth.q_ib), truth.acceleration).mean(axis=0)
    axes = dict(zip("xyz", np.eye(3), strict=True))
    expected = D * w**2 * j1(A) * np.cross(axes[angular_axis], axes[linear_axis])
    np.testing.assert_allclose(mean, expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("t", [0.0, 0.7, 11.3])
def test_euler_swing_against_mpmath(t):
    """C = Rz(psi) Rx(P) Ry(R) from its three matrices, and the rate from C^T dC/dt, differentiated in 40 digits."""

    def attitude(tau):
        angles = (
            mpmath.mpf(SWING.offset[k])
            + mpmath.mpf(SWING.amplitude[k])
            * mpmath.sin(mpmath.mpf(SWING.angular_frequency[k]) * tau + mpmath.mpf(SWING.phase[k]))
            for k in range(3)
        )
        (cz, sz), (cx, sx), (cy, sy) = ((mpmath.cos(a), mpmath.sin(a)) for a in angles)
        yaw = mpmath.matrix([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
        pitch = mpmath.matrix([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
        roll = mpmath.matrix([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
        return yaw * pitch * roll

    with mpmath.workdps(40):
        C = attitude(mpmath.mpf(t))
        dC = mpmath.matrix(3, 3)
        for i in range(3):
            for j in range(3):
                dC[i, j] = mpmath.diff(lambda tau, i=i, j=j: attitude(tau)[i, j], mpmath.mpf(t))
        W = C.T * dC
        C, omega = np.array(C.tolist(), dtype=float), np.array([W[2, 1], W[0, 2], W[1, 0]], dtype=float)
    truth = SWING.kinematics([t])
    np.testing.assert_allclose(rot.matrix_from_quat(truth.q_ib[0]), C, rtol=0, atol=8 * EPS)
    np.testing.assert_allclose(truth.omega_ib_b[0], omega, rtol=0, atol=16 * EPS)


# Attitude from a body rate


def test_body_rate_reproduces_a_minute_of_coning():
    """5 degrees at 2 Hz for 60 s: 1e-9 arcsec (5e-15 rad), a tenth of what the 66 rad of path would excuse."""
    coning = Coning()
    motion = BodyRate(lambda t: coning.kinematics(t).omega_ib_b, (0.0, 60.0), coning.initial().q_ib)
    t = np.random.default_rng(2).uniform(0, 60, 5000)
    error = angle_between(motion.kinematics(t).q_ib, coning.kinematics(t).q_ib).max()
    assert error < 1e-9 * ARCSEC
    assert 0 < motion.error_estimate < 1e-14
    alpha = coning.kinematics(t).alpha_ib_b
    np.testing.assert_allclose(motion.kinematics(t).alpha_ib_b, alpha, rtol=0, atol=1e-11 * np.abs(alpha).max())


def test_body_rate_reproduces_a_fast_spin_from_a_late_start():
    """A constant rate has a closed form; 700 rad of path, so 1e-16 of it is 7e-14 rad."""
    spin = ConstantRate((20.0, -9.0, 3.0), q_ib=SKEW)
    motion = BodyRate(lambda t: np.tile(spin.omega_ib_b, (len(t), 1)), (1000.0, 1032.0), spin.initial(1000.0).q_ib)
    t = np.random.default_rng(3).uniform(1000, 1032, 2000)
    assert angle_between(motion.kinematics(t).q_ib, spin.kinematics(t).q_ib).max() < 3e-13
    np.testing.assert_allclose(motion.kinematics(t).alpha_ib_b, 0, rtol=0, atol=1e-9)


def test_manoeuvre_ends_where_the_paper_says():
    """Pitch, roll, yaw at 1.2 s, as printed: half a unit of the eighth decimal."""
    psi, P, R = rot.euler_from_quat(body_rate_of_manoeuvre().kinematics([1.2]).q_ib[0])
    np.testing.assert_allclose(
        np.array([P, R, psi]) / DEG, [31.53552599, -160.58123171, 13.32385593], rtol=0, atol=5e-9
    )


def test_manoeuvre_ends_where_thirty_digits_say():
    """The digits are mpmath.odefun's (Taylor series, 30 digits) for q' = 1/2 q o omega from the identity."""
    expected = [-0.192281842042727308058, -0.155565713356088381678, 0.936864351667972127597, 0.247208795600838727205]
    motion = body_rate_of_manoeuvre()
    assert angle_between(motion.kinematics([1.2]).q_ib, np.array([expected]))[0] < 1e-9 * ARCSEC
    assert motion.error_estimate < 1e-14


def test_manoeuvre_agrees_with_dop853_all_the_way():
    """SciPy's DOP853 at its tightest is good to about 1e-12."""

    def derivative(t, q):
        return 0.5 * rot.quat_multiply(q, np.append(0.0, manoeuvre_rate(np.array([t]))[0]))

    t = np.linspace(0, 1.2, 25)
    theirs = solve_ivp(derivative, (0, 1.2), [1.0, 0, 0, 0], "DOP853", t_eval=t, rtol=1e-13, atol=1e-14).y.T
    assert angle_between(body_rate_of_manoeuvre().kinematics(t).q_ib, theirs).max() < 5e-12


@pytest.mark.parametrize("t", [0.0, 0.37, 1.2])
def test_savage_manoeuvre_against_mpmath(t):
    """Rate and angular acceleration: derivatives of the printed integral (TABLE), in 40 digits."""
    with mpmath.workdps(40):
        w = mpmath.mpf(26) / 10 * mpmath.pi

        def integral(tau, axis):
            c = [mpmath.mpf(repr(x)) for x in TABLE[axis].tolist()]
            powers = sum(c[k] * tau ** (k + 1) for k in range(5))
            return powers + c[5] * mpmath.sin(w * tau) + c[6] * (1 - mpmath.cos(w * tau))

        omega, alpha = (
            np.array([float(mpmath.diff(lambda x, k=k: integral(x, k), mpmath.mpf(t), n)) for k in range(3)])
            for n in (1, 2)
        )
    truth = SavageManoeuvre().kinematics([t])
    np.testing.assert_allclose(truth.omega_ib_b[0], omega, rtol=0, atol=32 * EPS * np.abs(omega).max())
    np.testing.assert_allclose(truth.alpha_ib_b[0], alpha, rtol=0, atol=32 * EPS * np.abs(alpha).max())


def test_savage_manoeuvre_is_the_body_rate_with_the_same_function():
    t = np.linspace(0, 1.2, 301)
    ours, theirs = SavageManoeuvre().kinematics(t), body_rate_of_manoeuvre().kinematics(t)
    assert angle_between(ours.q_ib, theirs.q_ib).max() < 1e-14
    assert 0 < SavageManoeuvre().error_estimate < 1e-14
    speed = np.linalg.norm(ours.omega_ib_b, axis=1).max()
    assert speed / DEG == pytest.approx(684.8, abs=0.1)  # independently known peak; 300 steps miss it by less


@pytest.mark.parametrize(("rate", "n", "t0"), [(100.0, 120, 0.0), (1e6, 50, 0.7), (10.0, 3, 0.9)])
def test_savage_increments_are_the_integral_of_the_rate(rate, n, t0):
    """Against Gauss-Legendre quadrature with 12 nodes, exact to 1e-30 at w h < 0.9; 10 roundings of 12 rad/s."""
    motion = SavageManoeuvre()
    x, weights = np.polynomial.legendre.leggauss(12)
    nodes = t0 + (np.arange(n)[:, None] + 0.5 + 0.5 * x) / rate
    omega = motion.kinematics(nodes.ravel()).omega_ib_b.reshape(n, 12, 3)
    expected = np.einsum("j,njk->nk", weights / 2 / rate, omega)
    np.testing.assert_allclose(motion.increments(rate, n, t0), expected, rtol=0, atol=10 * 12 * EPS / rate)


def test_kinks_are_resolved_by_short_segments():
    """|sin| has kinks; about z its integral is a closed form: 2 a half period."""
    motion = BodyRate(lambda t: np.stack([0 * t, 0 * t, np.abs(np.sin(t))], axis=1), (0.0, 10.0))
    t = np.linspace(0, 10, 301)
    angle = 2 * np.floor(t / np.pi) + 1 - np.cos(t - np.pi * np.floor(t / np.pi))
    expected = np.stack([np.cos(angle / 2), 0 * t, 0 * t, np.sin(angle / 2)], axis=1)
    assert angle_between(motion.kinematics(t).q_ib, expected).max() < 1e-14


def test_body_rate_from_several_threads_is_the_same():
    motion, t = BodyRate(wavy, (0.0, 60.0)), np.linspace(0, 60, 4001)
    with ThreadPoolExecutor(4) as pool:
        results = list(pool.map(lambda _: motion.kinematics(t).q_ib, range(8)))
    for q in results:
        np.testing.assert_array_equal(q, BodyRate(wavy, (0.0, 60.0)).kinematics(t).q_ib)


@pytest.mark.parametrize(
    ("rate", "error", "message"),
    [
        (lambda t: np.sign(t - 0.7)[:, None] * np.ones(3), AccuracyError, r"not smooth enough near t = 0\.(7|6999)"),
        (lambda t: np.sin(1e9 * t)[:, None] * np.ones(3), AccuracyError, "not smooth enough|is known to"),
        (lambda t: np.ones((3, len(t))), InputError, r"rate\(t\) must have shape"),
        (lambda t: np.ones(3), InputError, r"rate\(t\) must have shape"),
        (
            lambda t: np.sqrt(np.where(t > 0.5, np.nan, t))[:, None] * np.ones(3),
            InputError,
            r"rate\(t\) must be finite",
        ),
    ],
)
def test_rates_that_cannot_be_solved_are_refused(rate, error, message):
    with pytest.raises(error, match=message):
        BodyRate(rate, (0.0, 1.0)).kinematics([0.5])


def test_a_tolerance_that_is_not_met_is_an_error():
    with pytest.raises(AccuracyError, match=r"tolerance is 1e-17 rad"):
        BodyRate(wavy, (0.0, 60.0), tolerance=1e-17).kinematics([0.5])


# Splines


def test_spline_goes_through_its_poses():
    spline = poses()
    truth = spline.kinematics(POSE_TIMES)
    np.testing.assert_allclose(truth.position, spline.position, rtol=0, atol=1e-13)
    assert angle_between(truth.q_ib, SWING.kinematics(POSE_TIMES).q_ib).max() < 1e-14


def test_spline_through_a_quintic_is_the_quintic():
    """Six waypoints determine a polynomial of degree five: position, velocity, acceleration in closed form."""
    polynomial = np.polynomial.Polynomial([1.0, -2.0, 0.5, 0.3, -0.2, 0.05])
    nodes = np.array([0.0, 0.4, 1.1, 1.9, 2.5, 3.0])
    truth = Spline(nodes, np.stack([polynomial(nodes)] * 3, axis=1)).kinematics(np.linspace(0, 3, 50))
    t = np.linspace(0, 3, 50)
    for field, order in (("position", 0), ("velocity", 1), ("acceleration", 2)):
        expected = (polynomial.deriv(order) if order else polynomial)(t)
        np.testing.assert_allclose(getattr(truth, field)[:, 1], expected, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(truth.q_ib, np.tile([1.0, 0, 0, 0], (50, 1)))


def test_spline_converges_to_the_motion_it_samples():
    """Halving the spacing divides the attitude's error by about 2^6, the rate's by 2^5 (quintic, off the ends)."""
    t = np.linspace(5, 15, 400)
    truth = SWING.kinematics(t)
    errors = []
    for n in (101, 201):
        nodes = np.linspace(0, 20, n)
        spline = Spline(nodes, q_ib=SWING.kinematics(nodes).q_ib).kinematics(t)
        rate_error = np.abs(spline.omega_ib_b - truth.omega_ib_b).max()
        errors.append((angle_between(spline.q_ib, truth.q_ib).max(), rate_error))
    orders = np.log2(np.array(errors[0]) / errors[1])
    assert orders[0] > 5.5
    assert orders[1] > 4.5


def test_spline_is_smooth_across_its_poses():
    """Rate C2: the jump of alpha's slope across a pose falls with the distance d at which it is taken, as d."""
    spline, knots = poses(), POSE_TIMES[5:-5]

    def slope_jump(d, field):
        at = [getattr(spline.kinematics(knots + k * d), field) for k in (-2, -1, 1, 2)]
        return np.abs((at[3] - at[2]) / d - (at[1] - at[0]) / d).max()

    for field in ("alpha_ib_b", "acceleration"):
        assert slope_jump(1e-5, field) < 0.15 * slope_jump(1e-4, field)


def test_spline_keeps_its_own_copy():
    times, waypoints = POSE_TIMES.copy(), poses().position.copy()
    spline = Spline(times, waypoints)
    before = spline.position.copy()
    waypoints[:] = 0
    times[:] = 0
    np.testing.assert_array_equal(spline.position, before)
    np.testing.assert_array_equal(spline.t, POSE_TIMES)


# Bad input

EIGHT = np.arange(8.0)
TUMBLE = rot.quat_from_rotvec(EIGHT[:, None] * np.array([0.0, 0.0, 100 * DEG]))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Rest(q_ib=(1, 0, 0, 0.1)), "q_ib must be unit quaternions .*got norm .*1.00498"),
        (lambda: Rest(q_ib=(1, 0, 0)), r"q_ib must have shape \(4,\), got \(3,\)"),
        (lambda: Rest(position=(0, math.inf, 0)), r"position must be finite, got inf at \[1\]"),
        (lambda: Rest(gravity=9.8), r"gravity must have shape \(3,\)"),
        (lambda: ConstantRate(omega_ib_b=(0, math.nan, 0)), "omega_ib_b must be finite, got nan"),
        (lambda: ConstantRate(velocity="fast"), "velocity must be an array of real numbers"),
        (lambda: Coning(half_angle=5.0), r"half_angle must be at most pi rad, got 5.0 \(degrees\?\)"),
        (lambda: Coning(half_angle=-0.1), "half_angle must be a number >= 0, got -0.1"),
        (lambda: Coning(angular_frequency=0), "angular_frequency must be a positive number, got 0"),
        (lambda: Coning().increments(0.0, 5), "rate must be a positive number, got 0.0"),
        (lambda: Coning().increments(100.0, 0), "n must be an integer >= 1, got 0"),
        (lambda: SavageManoeuvre(q_ib=(2, 0, 0, 0)), "q_ib must be unit quaternions"),
        (lambda: SavageManoeuvre().increments(1000.0, 1201), r"t must lie in the motion's span \[0.0, 1.2\] s"),
        (lambda: SavageManoeuvre().increments(-1.0, 10), "rate must be a positive number, got -1.0"),
        (lambda: Circular(radius=-1.0), "radius must be a positive number, got -1.0"),
        (lambda: Circular(angular_rate=math.nan), "angular_rate must be finite"),
        (lambda: Sculling(linear_axis="x"), "linear_axis must differ from angular_axis, got 'x'"),
        (lambda: Sculling(linear_amplitude=-1), "linear_amplitude must be a number >= 0"),
        (lambda: EulerSwing(phase=(0, 0)), r"phase must have shape \(3,\), got \(2,\)"),
        (lambda: BodyRate(3.0, (0, 1)), "rate must be a function of times, got 3.0"),
        (lambda: BodyRate(wavy, (0, 1), alpha=1), "alpha must be a function of times or None, got 1"),
        (lambda: BodyRate(wavy, (1, 0)), r"span must be \(start, end\) with start < end, got \(1.0, 0.0\)"),
        (lambda: BodyRate(wavy, (0, math.nan)), "span must be finite"),
        (lambda: BodyRate(wavy, (0, 1), tolerance=0), "tolerance must be a positive number"),
        (lambda: BodyRate(wavy, (0, 1), longest_segment=-1), "longest_segment must be a positive number"),
        (lambda: Spline(EIGHT[:5]), "t must hold at least 6 times for a quintic spline, got 5"),
        (lambda: Spline(EIGHT[::-1]), r"t must increase strictly, got t\[0\] = 7.0, t\[1\] = 6.0"),
        (lambda: Spline(EIGHT, np.zeros((7, 3))), r"position must have shape \(8, 3\), got \(7, 3\)"),
        (lambda: Spline(EIGHT, q_ib=np.ones((8, 4))), "q_ib must be unit quaternions"),
        (lambda: Spline(EIGHT, q_ib=TUMBLE), "at most 90 deg from one pose .* 100 deg from t = 0.0 to 1.0 s"),
    ],
)
def test_bad_options_are_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()


def test_unknown_axes_list_the_valid_ones():
    with pytest.raises(UnknownNameError, match=r"angular_axis 'w'.*valid: x, y, z"):
        Sculling(angular_axis="w")


@pytest.mark.parametrize("motion", [BodyRate(wavy, (0.0, 7.0)), Spline(EIGHT)], ids=["body-rate", "spline"])
@pytest.mark.parametrize("t", [-1e-6, 7.1])
def test_times_outside_the_span_are_refused(motion, t):
    with pytest.raises(InputError, match=rf"t must lie in the motion's span \[0.0, 7.0\] s, got t\[1\] = {t}"):
        motion.kinematics([3.0, t])
