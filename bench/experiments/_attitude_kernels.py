"""Compiled errors of attitudes: the largest Euler and rotation errors over a run in one pass."""

import math

from bench.errors import Array
from bench.jit import njit


@njit
def euler(w: float, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return pitch, roll and yaw, rad, as `bench.rotation.euler_from_quat` away from pitch +-90 deg, not wrapped."""
    a, b, c, d = y + z, w + x, z - y, w - x
    half_sum, half_difference = math.atan2(a, b), math.atan2(c, d)
    pitch = math.atan2(2.0 * (w * x + y * z), math.sqrt((a * a + b * b) * (c * c + d * d)))
    return pitch, half_sum - half_difference, half_sum + half_difference


@njit
def angles(q: Array, out: Array) -> None:
    """Fill out (n, 3) with pitch, roll and yaw of q (n, 4), rad, not wrapped."""
    for k in range(q.shape[0]):
        out[k, 0], out[k, 1], out[k, 2] = euler(q[k, 0], q[k, 1], q[k, 2], q[k, 3])


@njit
def largest_errors(q: Array, q_true: Array, angles_true: Array, largest: Array) -> None:
    """Fill largest (4,) with the largest |pitch|, |roll|, |yaw| error (wrapped) and rotation error, rad."""
    turn = 2.0 * math.pi
    p = r = y = s = 0.0
    for k in range(q.shape[0]):
        pitch, roll, yaw = euler(q[k, 0], q[k, 1], q[k, 2], q[k, 3])
        p = max(p, abs(pitch - angles_true[k, 0]))
        d = roll - angles_true[k, 1]
        r = max(r, abs(d - turn * round(d / turn)))
        d = yaw - angles_true[k, 2]
        y = max(y, abs(d - turn * round(d / turn)))
        a, b, c, e = q[k, 0], q[k, 1], q[k, 2], q[k, 3]
        t, u, v, w = q_true[k, 0], q_true[k, 1], q_true[k, 2], q_true[k, 3]
        i = -a * u + b * t - c * w + e * v  # the vector part of q o q_true*
        j = -a * v + b * w + c * t - e * u
        m = -a * w - b * v + c * u + e * t
        s = max(s, i * i + j * j + m * m)
    largest[0], largest[1], largest[2], largest[3] = p, r, y, 2.0 * math.asin(min(math.sqrt(s), 1.0))
