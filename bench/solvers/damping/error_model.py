"""The error model of a free INS of held height: 13 states, continuous and discretised.

On a sphere and with gravity straight down this is the published model. Here the two radii of curvature stand where it
has R, and gravity may have a northward part g_N, which on a turning sphere is -omega^2 R sin L cos L: 0.3 % of the
Schuler oscillation's stiffness comes from it.

Filters use X' = F X + w over steps of about a second, with F the mean over the step. They take exp(F dt) as its series
to fourth order, and the covariance of the noise by Simpson's rule, Q_d = dt/6 (Q + 4 exp(F dt/2) Q exp(F dt/2)^T +
exp(F dt) Q exp(F dt)^T), which is symmetric and positive semidefinite as it stands. `discretise` is the exact one, by
Van Loan's matrix exponential, at many times the cost. The fastest rates in F are the Schuler one, 1.2e-3 1/s, and the
correlation times' 1/tau, so that the series lacks (rate dt)^5/120: nothing but rounding at dt = 1 s, 1e-9 at 20 s.
Simpson's rule is off by 6e-5 of a variance of Q_d at 1 s and by 2 % at 20 s, in the position's own share.

References
----------
[Zhao] section 1, Eq. 1.
[VanLoan] C. F. Van Loan: Computing integrals involving the matrix exponential, IEEE Trans. Automatic Control 23(3),
1978.
"""

import numpy as np
from numpy.typing import ArrayLike

from bench.earth import SPHERE, Earth
from bench.errors import Array, InputError, require_array, require_scalar
from bench.rotation import matrix_from_quat
from bench.solvers.damping._samples import deflection

SIZE = 13


def error_matrix(
    v_n: ArrayLike,
    latitude: ArrayLike,
    q_nb: ArrayLike,
    f_n: ArrayLike,
    *,
    tau_f: float,
    tau_g: float,
    earth: Earth = SPHERE,
) -> Array:
    """Return F of X' = F X + w at n points.

    X = dv_E, dv_N, dL, dlambda, phi_E, phi_N, phi_U, nabla_x, nabla_y, nabla_z, eps_x, eps_y, eps_z: INS minus truth in
    m/s and rad, C_c = (I - [phi x]) C_nb, accelerometer errors in m/s^2 and the negative of the gyro errors in
    rad/s.

    Parameters
    ----------
    v_n : array_like, shape (n, 3), m/s
        East, north, up; up is taken to be zero.
    latitude : array_like, shape (n,), rad
    q_nb : array_like, shape (n, 4)
    f_n : array_like, shape (n, 3), m/s^2
        Specific force in n.
    tau_f, tau_g : float, s
        Correlation times of nabla and eps.
    earth : Earth

    Returns
    -------
    ndarray, shape (n, 13, 13)

    Raises
    ------
    InputError
        If shapes do not fit, a value is not finite, or a correlation time is not positive.
    """
    v = require_array("v_n", v_n, (None, 3))
    n = len(v)
    L = require_array("latitude", latitude, (n,))
    C = matrix_from_quat(require_array("q_nb", q_nb, (n, 4)))
    f_E, f_N, f_U = require_array("f_n", f_n, (n, 3)).T
    tau_f, tau_g = require_scalar("tau_f", tau_f, positive=True), require_scalar("tau_g", tau_g, positive=True)
    v_E, v_N, _ = v.T
    R_M, R_N = earth.radii(L)
    sec, tan = 1 / np.cos(L), np.tan(L)
    earth_N, earth_U = earth.rate * np.cos(L), earth.rate * np.sin(L)
    transport = v_E / R_N
    omega_E, omega_N, omega_U = -v_N / R_M, earth_N + transport, earth_U + transport * tan

    F = np.zeros((n, SIZE, SIZE))
    F[:, 0, 0] = v_N * tan / R_N
    F[:, 0, 1] = earth_U + omega_U
    F[:, 0, 2] = 2 * v_N * earth_N + v_N * transport * sec**2
    F[:, 1, 0] = -2 * omega_U
    F[:, 1, 2] = -2 * v_E * earth_N - v_E * transport * sec**2 + deflection(earth) * np.cos(2 * L)
    F[:, 0, 5], F[:, 0, 6] = -f_U, f_N
    F[:, 1, 4], F[:, 1, 6] = f_U, -f_E
    F[:, :2, 7:10] = C[:, :2]
    F[:, 2, 1] = 1 / R_M
    F[:, 3, 0] = sec / R_N
    F[:, 3, 2] = transport * sec * tan
    F[:, 4, 1] = -1 / R_M
    F[:, 5, 0] = 1 / R_N
    F[:, 5, 2] = -earth_U
    F[:, 6, 0] = tan / R_N
    F[:, 6, 2] = earth_N + transport * sec**2
    F[:, 4, 5], F[:, 4, 6] = omega_U, -omega_N
    F[:, 5, 4], F[:, 5, 6] = -omega_U, omega_E
    F[:, 6, 4], F[:, 6, 5] = omega_N, -omega_E
    F[:, 4:7, 10:13] = C
    F[:, range(7, 10), range(7, 10)] = -1 / tau_f
    F[:, range(10, 13), range(10, 13)] = -1 / tau_g
    return F


def discretise(F: ArrayLike, Q: ArrayLike, dt: float) -> tuple[Array, Array]:
    """Return exp(F dt) and the covariance of the noise over dt, of constant F and density Q ([VanLoan]).

    Parameters
    ----------
    F, Q : array_like, shape (k, k)
    dt : float, s

    Raises
    ------
    InputError
        If the matrices are not square and alike, or dt is not positive.
    """
    from scipy.linalg import expm

    F = require_array("F", F, (None, None))
    k = len(F)
    if F.shape != (k, k):
        raise InputError(f"F must be square, got {F.shape}")
    Q = require_array("Q", Q, (k, k))
    dt = require_scalar("dt", dt, positive=True)
    block = expm(np.block([[-F, Q], [np.zeros((k, k)), F.T]]) * dt)
    Phi = block[k:, k:].T.copy()
    Q_d = Phi @ block[:k, k:]
    return Phi, 0.5 * (Q_d + Q_d.T)
