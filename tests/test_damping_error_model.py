"""The error model against the complex-step derivative of the mechanisation; its discretisation against Van Loan.

Truth: the strapdown equations of a held height on a turning sphere, written here once more in complex numbers, whose
imaginary step differentiates to rounding.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bench.earth import SPHERE, WGS84
from bench.errors import InputError
from bench.rotation import matrix_from_quat
from bench.solvers.damping._error_kernels import fill, matrix, predict, transition, turn_back
from bench.solvers.damping._samples import deflection
from bench.solvers.damping.error_model import discretise, error_matrix
from tests.damping_cases import KNOWN

R, RATE = SPHERE.semi_major_axis, SPHERE.rate
TAU_F, TAU_G = 1234.0, 2345.0


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def mechanisation(v_E, v_N, L, C, f_b, omega_b):
    """Return v_E', v_N', L', lambda', C' of a held height on the sphere, gravity -omega^2 R sin L cos L northward."""
    sine, cosine = np.sin(L), np.cos(L)
    f = C @ f_b
    earth = np.array([0, RATE * cosine, RATE * sine])
    transport = np.array([-v_N / R, v_E / R, v_E * sine / cosine / R])
    g_N = -(RATE**2) * R * sine * cosine
    omega_U = 2 * earth[2] + transport[2]
    return (
        f[0] + omega_U * v_N,
        f[1] + g_N - omega_U * v_E,
        v_N / R,
        v_E / (R * cosine),
        C @ skew(omega_b) - skew(earth + transport) @ C,
    )


def random_point(rng):
    q = rng.standard_normal(4)
    return {
        "v": rng.uniform(-300, 300, 2),
        "L": rng.uniform(-1.3, 1.3),
        "q": q / np.linalg.norm(q),
        "f_b": rng.uniform(-15, 15, 3),
        "omega_b": rng.uniform(-0.5, 0.5, 3),
    }


def differentiated(point):
    """Return F column by column from an imaginary error of 1e-30 in one state."""
    C, (v_E, v_N), L = matrix_from_quat(point["q"]), point["v"], point["L"]
    F = np.empty((13, 13))
    step = 1e-30
    for j in range(13):
        X = np.zeros(13, dtype=complex)
        X[j] = step * 1j
        C_c = (np.eye(3) - skew(X[4:7])) @ C
        there = mechanisation(v_E + X[0], v_N + X[1], L + X[2], C_c, point["f_b"] + X[7:10], point["omega_b"] - X[10:])
        here = mechanisation(v_E, v_N, L, C, point["f_b"], point["omega_b"])
        turning = there[4] @ C.T + C_c @ here[4].T  # -[phi' x]
        phi = -np.array([turning[2, 1], turning[0, 2], turning[1, 0]])
        F[:4, j] = np.array(there[:4]).imag / step
        F[4:7, j] = phi.imag / step
    F[7:] = np.diag([0.0] * 7 + [-1 / TAU_F] * 3 + [-1 / TAU_G] * 3)[7:]
    return F


def model_at(point, earth=SPHERE):
    v_n = np.append(point["v"], 0.0)[None]
    f_n = (matrix_from_quat(point["q"]) @ point["f_b"])[None]
    return error_matrix(v_n, [point["L"]], point["q"][None], f_n, tau_f=TAU_F, tau_g=TAU_G, earth=earth)[0]


def test_the_error_model_is_the_derivative_of_the_mechanisation():
    rng = np.random.default_rng(1)
    for _ in range(200):
        point = random_point(rng)
        expected = differentiated(point)
        # Rounding of the body's rate, 0.5 rad/s, stands where zeros should; the smallest elements are 1e-7.
        np.testing.assert_allclose(model_at(point), expected, rtol=1e-6, atol=1e-15)


def test_the_published_model_is_the_one_of_gravity_straight_down():
    """Only g_N's slope is not in print: minus omega^2 R cos 2L, 0.34 % of g/R at the equator and at the poles."""
    point = random_point(np.random.default_rng(2))
    slope = -(RATE**2) * R * math.cos(2 * point["L"])
    tan, sec2 = math.tan(point["L"]), 1 / math.cos(point["L"]) ** 2
    v_E = point["v"][0]
    printed = -2 * v_E * RATE * math.cos(point["L"]) - v_E**2 * sec2 / R
    assert model_at(point)[1, 2] == pytest.approx(printed + slope, rel=1e-12)
    assert model_at(point)[1, 0] == pytest.approx(-2 * (RATE * math.sin(point["L"]) + v_E * tan / R), rel=1e-12)
    assert abs(slope) < 0.0035 * 9.81


def test_on_an_ellipsoid_gravity_is_upright_and_there_are_two_radii():
    point = random_point(np.random.default_rng(3))
    F = model_at(point, WGS84)
    R_M, R_N = WGS84.radii(point["L"])
    assert (F[2, 1], -F[4, 1], F[5, 0]) == pytest.approx((1 / R_M, 1 / R_M, 1 / R_N), rel=1e-12)
    assert abs(deflection(WGS84)) < 1e-3 * abs(deflection(SPHERE))


def kernel_rows(point):
    C, F = np.zeros((3, 3)), np.empty((7, 13))
    matrix(point["q"], C)
    f_n = C @ point["f_b"]
    fill(SPHERE.parameters, deflection(SPHERE), *point["v"], point["L"], *f_n, C, F)
    return F


def test_the_kernel_has_the_same_model():
    rng = np.random.default_rng(4)
    for _ in range(20):
        point = random_point(rng)
        np.testing.assert_allclose(kernel_rows(point), model_at(point)[:7], rtol=1e-11, atol=1e-18)


def discrete(point, dt, model=KNOWN):
    """Return Phi, Q_d and Phi^-1 (first two rows) of the kernel, from a step of x = 0, P = 0."""
    rate = np.repeat([0.0, 1 / TAU_F, 1 / TAU_G], [7, 3, 3])
    forth, half, back = (np.empty((7, 13)) for _ in range(3))
    transition(kernel_rows(point), rate, dt, np.empty((2, 7, 13)), forth, half, back)
    decay = np.exp(-dt * rate), np.exp(-0.5 * dt * rate)
    scratch = np.empty((7, 13)), np.empty(13)
    Phi, P = np.eye(13), np.zeros((13, 13))
    for row in Phi:  # each a state
        predict(row, np.zeros((13, 13)), forth, half, *decay, np.zeros(13), dt, *scratch)
    Phi = Phi.T
    predict(np.zeros(13), P, forth, half, *decay, model.density, dt, *scratch)
    r = np.eye(2, 13)
    turn_back(r, back, np.exp(dt * rate), np.empty(13))
    return Phi, P, r


# In units that make the states alike: m/s, and angles as velocities they cause in a Schuler period.
SCALE = np.repeat([1.0, 1 / 8000.0, 1 / 8000.0, 1e-3, 1e-7], [2, 2, 3, 3, 3])


@pytest.mark.parametrize(("dt", "exact", "noise"), [(1.0, 3e-15, 1e-4), (5.0, 2e-12, 2e-3), (20.0, 2e-9, 2e-2)])
def test_the_series_is_van_loans_matrix_exponential(dt, exact, noise):
    """Phi lacks (rate dt)^5/120, with rates up to 3e-3 1/s at these 26 m/s^2: 2e-15 at 1 s.

    The noise of a step is worst for the position, which feels the tilt's noise through two integrations: Simpson's rule
    gives 25/24 of that part, which grows against the velocity's own noise as dt^2.
    """
    rng = np.random.default_rng(5)
    for _ in range(10):
        point = random_point(rng)
        Phi, Q_d, r = discrete(point, dt)
        expected, noise_expected = discretise(model_at(point), np.diag(KNOWN.density), dt)
        np.testing.assert_allclose(Phi * SCALE / SCALE[:, None], expected * SCALE / SCALE[:, None], rtol=0, atol=exact)
        np.testing.assert_allclose(r * SCALE, np.linalg.inv(expected)[:2] * SCALE, rtol=0, atol=10 * exact)
        std = np.sqrt(np.diag(noise_expected))
        np.testing.assert_allclose(Q_d / std / std[:, None], noise_expected / std / std[:, None], rtol=0, atol=noise)


def test_the_noise_of_a_step_is_positive():
    _, Q_d, _ = discrete(random_point(np.random.default_rng(6)), 1.0)
    std = np.sqrt(np.diag(Q_d))
    assert np.linalg.eigvalsh(Q_d / std / std[:, None]).min() > -1e-15
    np.testing.assert_array_equal(Q_d, Q_d.T)


def test_van_loan_is_the_integral():
    point = random_point(np.random.default_rng(7))
    F, Q, dt = model_at(point), np.diag(KNOWN.density), 30.0
    Phi, Q_d = discretise(F, Q, dt)
    scaled = F * SCALE / SCALE[:, None]
    Qs = Q / SCALE / SCALE[:, None]

    def slope(_, y):
        A, P = y.reshape(2, 13, 13)
        return np.stack([scaled @ A, scaled @ P + P @ scaled.T + Qs]).ravel()

    start = np.stack([np.eye(13), np.zeros((13, 13))]).ravel()
    A, P = solve_ivp(slope, (0, dt), start, method="DOP853", rtol=1e-12, atol=1e-18).y[:, -1].reshape(2, 13, 13)
    np.testing.assert_allclose(Phi * SCALE / SCALE[:, None], A, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(Q_d / SCALE / SCALE[:, None], P, rtol=1e-8, atol=1e-10 * np.abs(P).max())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"tau_f": 0.0}, "tau_f must be a positive number"),
        ({"latitude": [0.1, 0.2]}, r"latitude must have shape \(1,\)"),
        ({"f_n": [[0.0, 0.0, math.nan]]}, "f_n must be finite"),
    ],
)
def test_bad_input(change, message):
    options = {
        "v_n": np.zeros((1, 3)), "latitude": [0.5], "q_nb": [[1.0, 0, 0, 0]], "f_n": [[0, 0, 9.8]], "tau_f": 1e3,
        "tau_g": 1e3,
    }  # fmt: skip
    with pytest.raises(InputError, match=message):
        error_matrix(**{**options, **change})
    with pytest.raises(InputError, match="F must be square"):
        discretise(np.zeros((2, 3)), np.zeros((2, 2)), 1.0)
