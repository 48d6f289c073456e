"""Rotations: laws on random rotations (hypothesis), values against SciPy and mpmath, kernels against the NumPy face.

Tolerances are multiples of the double's eps (2.2e-16), because the bench measures attitude errors down to rounding.
"""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from bench import rotation as rot
from bench import rotation_kernels as kernels

EPS = float(np.finfo(float).eps)
ULPS = 8 * EPS  # absolute error of a unit quaternion's or matrix's entries after a few products
IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])
SUBNORMAL = 1e-322  # a few units of the smallest number there is

laws = settings(deadline=None, max_examples=200, derandomize=True)  # the same examples in every run

unit = st.floats(-1, 1, allow_nan=False)


@st.composite
def directions(draw):
    """Unit vectors, those along an axis or in a coordinate plane among them."""
    v = np.array(draw(st.tuples(unit, unit, unit).filter(lambda v: math.hypot(*v) > 1e-3)))
    return v / math.hypot(*v)


tiny_angles = st.floats(-300, -7).map(lambda exponent: 10.0**exponent)
near_pi = st.floats(-16, -3).map(lambda exponent: math.pi - 10.0**exponent)
angles = st.one_of(st.floats(0, math.pi), tiny_angles, near_pi, st.just(0.0), st.just(math.pi))
vectors = st.tuples(*[st.floats(-10, 10)] * 3).map(np.array)
rotvecs = st.tuples(angles, directions()).map(lambda pair: pair[0] * pair[1])
quaternions = st.tuples(angles, directions(), st.booleans()).map(
    lambda drawn: np.append(math.cos(drawn[0] / 2), math.sin(drawn[0] / 2) * drawn[1]) * (-1.0 if drawn[2] else 1.0)
)


def random_quaternions(n=500, seed=1):
    q = np.random.default_rng(seed).normal(size=(n, 4))
    return q / np.linalg.norm(q, axis=1)[:, None]


def angle_between(p, q):
    """Angle of the rotation from p to q, rad, without a function under test."""
    p, q = np.asarray(p, dtype=float), np.asarray(q, dtype=float)
    q = q if np.dot(p, q) > 0 else -q
    return 4 * math.asin(min(1.0, np.linalg.norm(p - q) / 2))


def to_scipy(q):
    return Rotation.from_quat(np.asarray(q)[..., [1, 2, 3, 0]])


# Laws


@laws
@given(quaternions, quaternions, quaternions)
def test_quaternions_form_a_group(p, q, r):
    np.testing.assert_allclose(
        rot.quat_multiply(rot.quat_multiply(p, q), r), rot.quat_multiply(p, rot.quat_multiply(q, r)), rtol=0, atol=ULPS
    )
    np.testing.assert_array_equal(rot.quat_multiply(IDENTITY, q), q)
    np.testing.assert_array_equal(rot.quat_multiply(q, IDENTITY), q)
    np.testing.assert_allclose(rot.quat_multiply(q, rot.quat_conjugate(q)), IDENTITY, rtol=0, atol=ULPS)
    product = rot.quat_multiply(p, q)
    np.testing.assert_allclose(
        rot.quat_conjugate(product), rot.quat_multiply(rot.quat_conjugate(q), rot.quat_conjugate(p)), rtol=0, atol=ULPS
    )
    assert abs(np.linalg.norm(product) - 1) < ULPS


@laws
@given(rotvecs)
@example(np.array([math.pi, 0.0, 0.0]))
@example(np.zeros(3))
def test_exponential_and_logarithm_are_inverse(phi):
    """Relative to the length, so that an angle of 1e-300 rad keeps all its digits."""
    back = rot.rotvec_from_quat(rot.quat_from_rotvec(phi))
    length = math.hypot(*phi)  # does not underflow
    if length > math.pi - 4 * EPS and np.dot(back, phi) < 0:  # the two ends of a diameter are one rotation
        back = -back
    np.testing.assert_allclose(back, phi, rtol=0, atol=ULPS * length + SUBNORMAL)


@laws
@given(quaternions)
def test_logarithm_and_exponential_are_inverse_up_to_the_sign(q):
    back = rot.quat_from_rotvec(rot.rotvec_from_quat(q))
    np.testing.assert_allclose(back if np.dot(back, q) > 0 else -back, q, rtol=0, atol=ULPS)


@laws
@given(directions(), st.floats(-16, -12).map(lambda exponent: 10.0**exponent), st.booleans())
def test_logarithm_keeps_the_distance_from_pi(axis, gap, beyond):
    """A turn by pi - gap, or by pi + gap, which is the turn by pi - gap the other way."""
    half = 0.5 * (math.pi + (gap if beyond else -gap))
    phi = rot.rotvec_from_quat(np.append(math.cos(half), math.sin(half) * axis))
    assert np.linalg.norm(phi) <= math.pi * (1 + EPS)
    sign = -1.0 if beyond and math.cos(half) < 0 else 1.0
    np.testing.assert_allclose(phi, sign * (math.pi - gap) * axis, rtol=0, atol=ULPS * math.pi)


@laws
@given(quaternions, vectors)
def test_q_and_minus_q_are_one_rotation(q, v):
    np.testing.assert_array_equal(rot.matrix_from_quat(-q), rot.matrix_from_quat(q))
    np.testing.assert_array_equal(rot.quat_rotate(-q, v), rot.quat_rotate(q, v))
    if q[0] != 0:
        np.testing.assert_array_equal(rot.rotvec_from_quat(-q), rot.rotvec_from_quat(q))


@laws
@given(quaternions, quaternions, vectors)
def test_matrices_are_proper_rotations_and_follow_the_product(p, q, v):
    C, D = rot.matrix_from_quat(p), rot.matrix_from_quat(q)
    np.testing.assert_allclose(C @ C.T, np.eye(3), rtol=0, atol=ULPS)
    assert abs(np.linalg.det(C) - 1) < ULPS
    np.testing.assert_allclose(rot.matrix_from_quat(rot.quat_multiply(p, q)), C @ D, rtol=0, atol=2 * ULPS)
    np.testing.assert_allclose(rot.quat_rotate(q, v), D @ v, rtol=0, atol=ULPS * math.hypot(*v) + SUBNORMAL)


@laws
@given(quaternions)
@example(np.array([0.0, 1.0, 0.0, 0.0]))
@example(np.array([0.0, 0.0, 0.0, 1.0]))
@example(np.array([0.5, -0.5, 0.5, -0.5]))
def test_matrix_round_trip(q):
    back = rot.quat_from_matrix(rot.matrix_from_quat(q))
    assert back[0] >= 0
    assert angle_between(back, q) < 2 * ULPS


euler = st.floats(-math.pi, math.pi)


@laws
@given(euler, st.floats(-math.pi / 2, math.pi / 2), euler)
def test_euler_round_trip(psi, P, R):
    """Away from the poles the angles return; their error grows as 1/cos P, that is not the code's fault."""
    q = rot.quat_from_euler(psi, P, R)
    back = rot.euler_from_quat(q)
    assert abs(back[1] - P) < ULPS * (1 + 1e-8 / max(1e-8, math.cos(P)))
    if math.cos(P) > 1e-3:
        wrapped = [abs(math.remainder(a - b, 2 * math.pi)) for a, b in zip(back, (psi, P, R), strict=True)]
        assert max(wrapped) < 2 * ULPS / math.cos(P)
    assert angle_between(rot.quat_from_euler(*back), q) < 2 * ULPS


@laws
@given(euler, st.floats(-17, -3).map(lambda exponent: 10.0**exponent), euler, st.sampled_from([-1.0, 1.0]))
@example(0.3, 0.0, 0.4, 1.0)
@example(0.3, 0.0, 0.4, -1.0)
def test_euler_angles_near_the_poles_keep_the_attitude(psi, gap, R, side):
    """Where psi and R are poorly determined each, their sum (or difference) is not: the attitude is kept."""
    q = rot.quat_from_euler(psi, side * (math.pi / 2 - gap), R)
    for back in (rot.euler_from_quat(q), rot.euler_from_matrix(rot.matrix_from_quat(q))):
        assert angle_between(rot.quat_from_euler(*back), q) < 4 * ULPS
        assert abs(math.pi / 2 - abs(back[1]) - gap) < ULPS


@pytest.mark.parametrize("side", [-1, 1])
def test_at_the_pole_the_roll_is_zero(side):
    psi, P, R = rot.euler_from_quat(rot.quat_from_euler(0.3, side * math.pi / 2, 0.4))
    assert R == 0
    assert abs(P - side * math.pi / 2) < ULPS
    assert psi == pytest.approx(0.3 + side * 0.4, abs=ULPS)


@laws
@given(st.floats(-1e4, 1e4))
@example(math.pi)
@example(-math.pi)
@example(math.nextafter(math.pi, 4))
@example(-math.nextafter(math.pi, 4))
@example(math.nextafter(-math.pi, 0))
def test_wrap(angle):
    wrapped = float(rot.wrap(angle))
    assert -math.pi < wrapped <= math.pi
    assert abs(math.remainder(wrapped - angle, 2 * math.pi)) <= EPS * max(math.pi, abs(angle))
    if -math.pi < angle <= math.pi:
        assert wrapped == angle


# Values against SciPy (another convention, xyzw) and mpmath (50 digits)


def test_products_rotations_and_matrices_agree_with_scipy():
    p, q = random_quaternions(seed=1), random_quaternions(seed=2)
    v = np.random.default_rng(3).normal(size=(len(q), 3))
    product = (to_scipy(p) * to_scipy(q)).as_quat()[:, [3, 0, 1, 2]]
    ours = rot.quat_multiply(p, q)
    np.testing.assert_allclose(ours * np.sign((ours * product).sum(axis=1))[:, None], product, rtol=0, atol=ULPS)
    np.testing.assert_allclose(rot.quat_rotate(q, v), to_scipy(q).apply(v), rtol=0, atol=8 * ULPS)
    np.testing.assert_allclose(rot.matrix_from_quat(q), to_scipy(q).as_matrix(), rtol=0, atol=ULPS)
    np.testing.assert_allclose(rot.rotvec_from_quat(q), to_scipy(q).as_rotvec(), rtol=0, atol=2 * ULPS)


def test_euler_angles_agree_with_scipy():
    """SciPy's intrinsic sequence ZXY is Rz(psi) Rx(P) Ry(R)."""
    rng = np.random.default_rng(4)
    psi, R = rng.uniform(-np.pi, np.pi, (2, 500))
    P = rng.uniform(-1.5, 1.5, 500)
    theirs = Rotation.from_euler("ZXY", np.stack([psi, P, R], axis=1))
    C = rot.matrix_from_quat(rot.quat_from_euler(psi, P, R))
    np.testing.assert_allclose(C, theirs.as_matrix(), rtol=0, atol=ULPS)
    np.testing.assert_allclose(np.stack(rot.euler_from_matrix(C), axis=1), theirs.as_euler("ZXY"), rtol=0, atol=1e-13)


def test_euler_angles_of_a_known_attitude():
    """Yaw turns y towards -x (anticlockwise), pitch lifts y, roll lowers x (right hand about y)."""
    quarter = math.pi / 2
    for angles_, axis, image in (
        ((quarter, 0, 0), [0, 1, 0], [-1, 0, 0]),
        ((0, quarter, 0), [0, 1, 0], [0, 0, 1]),
        ((0, 0, quarter), [1, 0, 0], [0, 0, -1]),
    ):
        np.testing.assert_allclose(rot.quat_rotate(rot.quat_from_euler(*angles_), axis), image, rtol=0, atol=ULPS)


@pytest.mark.parametrize(
    "angle", [1e-300, 1e-160, 1e-20, 1e-9, 0.99e-8, 1.01e-8, 1e-7, 1e-3, 0.2, 1.0, 3.0, 6.0, 100.0]
)
def test_exponential_against_mpmath(angle):
    """Every component to a few eps of itself; the angle of 100 rad turns many times."""
    phi = angle * np.array([2.0, -3.0, 6.0]) / 7.0
    with mpmath.workdps(50):
        exact = [mpmath.mpf(float(x)) for x in phi]
        length = mpmath.sqrt(sum(x * x for x in exact))
        expected = [mpmath.cos(length / 2)] + [mpmath.sin(length / 2) * x / length for x in exact]
        expected = np.array([float(x) for x in expected])
    atol = EPS * max(1.0, angle) * (angle > 1)
    np.testing.assert_allclose(rot.quat_from_rotvec(phi), expected, rtol=4 * EPS, atol=atol)
    np.testing.assert_allclose(kernels.exponential(*phi), expected, rtol=4 * EPS, atol=atol)


@pytest.mark.parametrize("half", [1e-300, 1e-160, 1e-20, 0.99e-8, 1.01e-8, 1e-4, 0.5, 1.5, math.pi / 2 - 1e-13])
def test_logarithm_against_mpmath(half):
    axis = np.array([2.0, -3.0, 6.0]) / 7.0
    q = np.append(math.cos(half), math.sin(half) * axis)
    with mpmath.workdps(50):
        w, *u = (mpmath.mpf(float(x)) for x in q)
        sine = mpmath.sqrt(sum(x * x for x in u))
        expected = np.array([float(2 * mpmath.atan2(sine, w) * x / sine) for x in u])
    np.testing.assert_allclose(rot.rotvec_from_quat(q), expected, rtol=4 * EPS, atol=0)


def test_half_turns_give_a_vector_of_length_pi():
    for q in np.eye(4)[1:]:
        np.testing.assert_array_equal(rot.rotvec_from_quat(q), math.pi * q[1:])


# Broadcasting, and the kernels


def test_functions_broadcast_over_leading_dimensions():
    p, q = random_quaternions(6, seed=5).reshape(2, 3, 4), random_quaternions(3, seed=6)
    v = np.random.default_rng(7).normal(size=(2, 1, 3))
    product, rotated = rot.quat_multiply(p, q), rot.quat_rotate(q, v)
    C = rot.matrix_from_quat(p)
    assert product.shape == (2, 3, 4)
    assert rotated.shape == (2, 3, 3)
    assert C.shape == (2, 3, 3, 3)
    for i in range(2):
        for j in range(3):
            np.testing.assert_array_equal(product[i, j], rot.quat_multiply(p[i, j], q[j]))
            np.testing.assert_array_equal(rotated[i, j], rot.quat_rotate(q[j], v[i, 0]))
            np.testing.assert_array_equal(rot.quat_from_matrix(C)[i, j], rot.quat_from_matrix(C[i, j]))
            np.testing.assert_array_equal(rot.rotvec_from_quat(p)[i, j], rot.rotvec_from_quat(p[i, j]))
    assert rot.quat_from_euler(np.zeros((2, 1)), np.zeros(3), 0.0).shape == (2, 3, 4)


def test_cross_agrees_with_numpy():
    a, b = np.random.default_rng(8).normal(size=(2, 50, 3))
    np.testing.assert_allclose(rot.cross(a, b), np.cross(a, b), rtol=0, atol=ULPS)


def test_normalisation_scales_to_length_one():
    q = np.array([[3.0, 0.0, 4.0, 0.0], [1e-3, 0, 0, 0], [1.0, 1.0, 1.0, 1.0]])
    np.testing.assert_allclose(rot.quat_normalize(q), [[0.6, 0, 0.8, 0], [1, 0, 0, 0], [0.5] * 4], rtol=0, atol=EPS)
    np.testing.assert_allclose(kernels.normalize(*q[0]), [0.6, 0, 0.8, 0], rtol=0, atol=EPS)


@laws
@given(quaternions, quaternions, vectors)
def test_kernels_equal_the_numpy_face(p, q, v):
    np.testing.assert_array_equal(kernels.multiply(*p, *q), rot.quat_multiply(p, q))
    np.testing.assert_allclose(
        kernels.rotate(*q, *v), rot.quat_rotate(q, v), rtol=0, atol=2 * EPS * math.hypot(*v) + SUBNORMAL
    )
    np.testing.assert_allclose(kernels.exponential(*v), rot.quat_from_rotvec(v), rtol=0, atol=4 * EPS)


@laws
@given(rotvecs)
def test_exponential_kernel_equals_the_numpy_face_at_small_and_large_angles(phi):
    np.testing.assert_allclose(kernels.exponential(*phi), rot.quat_from_rotvec(phi), rtol=4 * EPS, atol=EPS / 4)


@pytest.mark.parametrize("angle", [0.2 * (1 - 1e-12), 0.2 * (1 + 1e-12)])
def test_exponential_kernel_is_continuous_where_the_series_ends(angle):
    phi = angle * np.array([2.0, -3.0, 6.0]) / 7.0
    np.testing.assert_allclose(kernels.exponential(*phi), rot.quat_from_rotvec(phi), rtol=2 * EPS, atol=0)
