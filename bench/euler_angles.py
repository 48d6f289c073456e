"""Euler angles at every attitude: the forward and the reverse set, their conversion, and tracking without jumps.

Forward: C_nb = Rz(psi) Rx(P) Ry(R), singular at P = +-90 deg. Reverse: C_nb = Rz(psi_r) Ry(R_r) Rx(P_r), singular at
R_r = +-90 deg. Where one set is singular the other is far from it, so an attitude, whoever found it, always has a set
of angles that is well determined and changes smoothly. Heading is H = -psi.

Both sets have a second branch for the same attitude, (psi + pi, pi - P, R + pi) and (psi_r + pi, P_r + pi, pi - R_r);
`track` continues each angle on the branch that is nearer to the previous one, so that a pitch may pass 90 degrees.

References
----------
[Lyu] Lyu, Cheng, Qiu: Dual-Euler full-attitude method, Aerospace Shanghai 2019(1), sections 1 and 2.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, InputError, require_scalar, require_unit_quaternion
from bench.rotation import euler_from_quat, quat_from_euler, quat_multiply, wrap
from bench.units import DEG

HYSTERESIS = 5 * DEG
BORDER = 45 * DEG  # of |pitch|, and its supplement
_QUARTER = np.array([math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)])  # a quarter turn about z


@dataclass(frozen=True, eq=False)
class DualAngles:
    """Both sets of Euler angles along n attitudes, and which of them is in use.

    Attributes
    ----------
    forward : ndarray, shape (n, 3), rad
        psi, P, R; not wrapped; continuous but for half a degree round their own pole, behind which they go on with the
        branch that the body is on.
    reverse : ndarray, shape (n, 3), rad
        psi_r, P_r, R_r; likewise.
    flag : ndarray of int, shape (n,)
        1 where the forward set is active, -1 where the reverse set is.
    """

    forward: Array
    reverse: Array
    flag: np.ndarray

    def __len__(self) -> int:
        return len(self.flag)

    @property
    def active(self) -> Array:
        """The angles of the active set, shape (n, 3), rad."""
        return np.where(self.flag[:, None] > 0, self.forward, self.reverse)


def quat_from_reverse(psi_r: ArrayLike, P_r: ArrayLike, R_r: ArrayLike) -> Array:
    """Return q_nb of reverse Euler angles, rad, shape (..., 4): qz(psi_r) o qy(R_r) o qx(P_r)."""
    turned = quat_from_euler(np.asarray(psi_r, dtype=float), R_r, -np.asarray(P_r, dtype=float))
    # Turned about z on both sides: qy = qz o qx o qz*, qx = qz o qy* o qz* of a quarter turn.
    return quat_multiply(quat_multiply(_QUARTER, turned), _QUARTER * [1, 1, 1, -1])


def reverse_from_quat(q_nb: ArrayLike) -> tuple[Array, Array, Array]:
    """Return psi_r, P_r, R_r of unit quaternions, rad; psi_r and P_r in (-pi, pi], R_r in [-pi/2, pi/2].

    Where cos R_r vanishes to rounding only psi_r + P_r or psi_r - P_r is defined, and P_r = 0 is returned.
    """
    yaw, middle, inner = euler_from_quat(quat_multiply(q_nb, _QUARTER))
    return wrap(yaw - np.pi / 2), wrap(-inner), middle


def reverse_from_forward(psi: ArrayLike, P: ArrayLike, R: ArrayLike) -> tuple[Array, Array, Array]:
    """Return psi_r, P_r, R_r of the attitude with the forward angles, as `reverse_from_quat`; equation 21 of [Lyu]."""
    return reverse_from_quat(quat_from_euler(psi, P, R))


def forward_from_reverse(psi_r: ArrayLike, P_r: ArrayLike, R_r: ArrayLike) -> tuple[Array, Array, Array]:
    """Return psi, P, R of the attitude with the reverse angles, as `euler_from_quat`; equation 22 of [Lyu]."""
    return euler_from_quat(quat_from_reverse(psi_r, P_r, R_r))


def require_hysteresis(hysteresis: float) -> float:
    """Return the hysteresis, rad, if it is in [0, pi/4).

    Raises
    ------
    InputError
        Otherwise.
    """
    if require_scalar("hysteresis", hysteresis, minimum=0.0) >= BORDER:
        raise InputError(f"hysteresis must be below pi/4 rad, got {hysteresis!r} (degrees?)")
    return float(hysteresis)


def thresholds(hysteresis: float) -> tuple[float, float]:
    """Return |sin P| above which the reverse set takes over, and below which the forward set does."""
    return math.sin(BORDER + hysteresis), math.sin(BORDER - hysteresis)


def track(q_nb: ArrayLike, hysteresis: float = HYSTERESIS) -> DualAngles:
    """Return both sets of Euler angles along a series of attitudes, without jumps.

    Parameters
    ----------
    q_nb : array_like, shape (n, 4)
        Attitudes, b to n, wxyz, unit, of either sign, dense enough to follow: the branch nearer to the previous
        attitude's angles is taken. The first one has its pitch in [-pi/2, pi/2].
    hysteresis : float, rad
        Half the width of the band round |P| = 45 and 135 degrees in which the active set is kept: the reverse set
        takes over where |P| comes within 45 deg - hysteresis of 90 degrees, the forward set where it is more than
        45 deg + hysteresis away.

    Returns
    -------
    DualAngles
        The active set never comes within 40 degrees (45 deg - hysteresis) of its singular points. The inactive one
        does: a small attitude error makes a large one of its angles there, and they turn fast.

    Raises
    ------
    InputError
        If the quaternions have another shape or are not unit, or the hysteresis is out of range.
    """
    from bench import euler_angle_kernels

    q = require_unit_quaternion("q_nb", q_nb, (None, 4)).copy()
    enter, leave = thresholds(require_hysteresis(hysteresis))
    forward, reverse, side = np.empty((len(q), 3)), np.empty((len(q), 3)), np.empty(len(q))
    euler_angle_kernels.track(q, enter, math.sin(BORDER), leave, forward, reverse, side)
    # Kernels give yaw, middle and inner angle; those of the reverse set are psi_r + pi/2, R_r and -P_r.
    reverse = np.stack([wrap(reverse[:, 0] - np.pi / 2), -reverse[:, 2], reverse[:, 1]], axis=1)
    return DualAngles(np.unwrap(forward, axis=0), np.unwrap(reverse, axis=0), side.astype(np.int64))


def angle_errors(q_est: ArrayLike, q_true: ArrayLike, hysteresis: float = HYSTERESIS) -> tuple[Array, DualAngles]:
    """Return the errors of an attitude's Euler angles in the set that is active for the truth.

    Near a pole a small attitude error makes any error of the set that is singular there; the active set shows it in
    its size.

    Parameters
    ----------
    q_est, q_true : array_like, shape (n, 4)
        Unit quaternions wxyz, b to n.
    hysteresis : float, rad
        As in `track`.

    Returns
    -------
    errors : ndarray, shape (n, 3), rad
        Estimated minus true (psi, P, R) where the flag is 1, (psi_r, P_r, R_r) where it is -1, on the same branch.
    truth : DualAngles

    Raises
    ------
    InputError
        If the shapes differ, a quaternion is not unit, or the hysteresis is out of range.
    """
    q_est = require_unit_quaternion("q_est", q_est, (None, 4))
    truth = track(q_true, hysteresis)
    if len(q_est) != len(truth):
        raise InputError(f"q_est and q_true must have the same length, got {len(q_est)} and {len(truth)}")
    forward, reverse = np.stack(euler_from_quat(q_est), axis=1), np.stack(reverse_from_quat(q_est), axis=1)
    found = np.where(truth.flag[:, None] > 0, forward, reverse)
    middle = np.where(truth.flag > 0, 1, 2)  # the angle that the other branch takes from pi: P or R_r
    other = found + np.pi
    row = np.arange(len(found))
    other[row, middle] = np.pi - found[row, middle]
    errors, others = wrap(found - truth.active), wrap(other - truth.active)
    nearer = (others**2).sum(axis=1) < (errors**2).sum(axis=1)
    return np.where(nearer[:, None], others, errors), truth
