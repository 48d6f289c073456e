"""Other people's axes: sensor axes such as FRD or FLU to right-forward-up, north-east-down to east-north-up and back.

Everything inside is RFU and ENU; this is the edge. Both conversions are signed permutations, exact in floating point.
The aerospace Euler angles (3-2-1 from NED to FRD) are the same roll and pitch as ours (3-1-2 from ENU to RFU), for
right is our x and forward our y; only the yaw turns the other way, because down points the other way.
"""

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, InputError
from bench.rotation import euler_from_quat, quat_from_euler, quat_from_matrix, wrap

_DIRECTIONS = {"R": (0, 1.0), "L": (0, -1.0), "F": (1, 1.0), "B": (1, -1.0), "U": (2, 1.0), "D": (2, -1.0)}


def axes_matrix(axes: str) -> Array:
    """Return C_bs, shape (3, 3), that takes components along sensor axes s to right-forward-up.

    Parameters
    ----------
    axes : str
        Where the sensor's x, y and z axes point, one letter each: R(ight) or L(eft), F(orward) or B(ack), U(p) or
        D(own). "RFU" changes nothing; "FRD" and "FLU" are the other usual ones; all 24 right-handed ones are admitted.

    Raises
    ------
    InputError
        If the letters are not three different axes, or the three are left-handed.
    """
    letters = axes.upper() if isinstance(axes, str) else ""
    if len(letters) != 3 or any(letter not in _DIRECTIONS for letter in letters):
        raise InputError(
            f"axes must say where the sensor's x, y, z point, such as 'RFU', 'FRD' or 'FLU' "
            f"(R/L right/left, F/B forward/back, U/D up/down), got {axes!r}"
        )
    C_bs = np.zeros((3, 3))
    for column, letter in enumerate(letters):
        row, sign = _DIRECTIONS[letter]
        C_bs[row, column] = sign
    determinant = round(np.linalg.det(C_bs))
    if determinant != 1:
        rule = "three different directions" if determinant == 0 else "right-handed axes"
        raise InputError(f"axes must name {rule}, got {axes!r}")
    return C_bs


def to_rfu(vectors: ArrayLike, axes: str) -> Array:
    """Return vectors (..., 3) given along the sensor axes `axes`, along right-forward-up; no rounding."""
    return _permuted(vectors, axes_matrix(axes))


def from_rfu(vectors: ArrayLike, axes: str) -> Array:
    """Return vectors (..., 3) given along right-forward-up, along the sensor axes `axes`; no rounding."""
    return _permuted(vectors, axes_matrix(axes).T)


def _permuted(vectors: ArrayLike, matrix: Array) -> Array:
    source = np.abs(matrix).argmax(axis=1)
    return np.asarray(vectors, dtype=float)[..., source] * matrix.sum(axis=1)


def sensor_attitude(axes: str) -> Array:
    """Return q_bs, shape (4,), the attitude of sensor axes in right-forward-up."""
    return quat_from_matrix(axes_matrix(axes))


def swap_enu_ned(vectors: ArrayLike) -> Array:
    """Return vectors (..., 3) given east-north-up as north-east-down, or the other way round; no rounding."""
    v = np.asarray(vectors, dtype=float)
    return np.stack([v[..., 1], v[..., 0], -v[..., 2]], axis=-1)


def quat_from_aerospace(roll: ArrayLike, pitch: ArrayLike, yaw: ArrayLike) -> Array:
    """Return q_nb (ENU, RFU), shape (..., 4), of aerospace angles (3-2-1, NED to FRD, yaw from north clockwise)."""
    return quat_from_euler(-np.asarray(yaw, dtype=float), pitch, roll)


def aerospace_from_quat(q_nb: ArrayLike) -> tuple[Array, Array, Array]:
    """Return aerospace roll, pitch, yaw, rad, of q_nb (ENU, RFU), shape (..., 4); roll and yaw in (-pi, pi]."""
    psi, P, R = euler_from_quat(q_nb)
    return R, P, wrap(-psi)
