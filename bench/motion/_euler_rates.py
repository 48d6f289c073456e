"""Euler angles and their derivatives to attitude, body rate and its derivative, in closed form."""

import numpy as np

from bench.errors import Array
from bench.motion._waves import columns
from bench.rotation import quat_from_euler

Jet = tuple[Array, Array, Array]  # value, first and second derivative in time, each shape (n,)


def euler_rates(yaw: Jet, pitch: Jet, roll: Jet) -> tuple[Array, Array, Array]:
    """Return q (n, 4), omega_b (n, 3) and alpha_b (n, 3) of C = Rz(psi) Rx(P) Ry(R).

    omega = (cR P' - sR cP psi', R' + sP psi', sR P' + cR cP psi'). Nothing is singular at P = 90 deg: the
    angles are prescribed, not found.
    """
    (psi, dpsi, ddpsi), (P, dP, ddP), (R, dR, ddR) = yaw, pitch, roll
    sP, cP, sR, cR = np.sin(P), np.cos(P), np.sin(R), np.cos(R)
    level = cP * dpsi  # rate of the yaw axis across the roll axis, and its derivative
    dlevel = cP * ddpsi - sP * dP * dpsi
    wx, wz = cR * dP - sR * level, sR * dP + cR * level
    omega = columns(wx, dR + sP * dpsi, wz)
    alpha = columns(
        cR * ddP - sR * dlevel - dR * wz,
        ddR + sP * ddpsi + cP * dP * dpsi,
        sR * ddP + cR * dlevel + dR * wx,
    )
    return quat_from_euler(psi, P, R), omega, alpha
