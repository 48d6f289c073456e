"""Forward and reverse Euler angles for numba kernels: from and to quaternions, the nearest branch, tracking.

Both sets are one: Rz(psi_r) Ry(R_r) Rx(P_r) = Rz(psi_r + 90 deg) Rx(R_r) Ry(-P_r) Rz(-90 deg), so that the reverse
angles are the forward (3-1-2) angles (yaw, middle, inner) = (psi_r + 90 deg, R_r, -P_r) of a body frame turned by 90
degrees about z. Kernels work with these three; `side` is +1 for the forward and -1 for the reverse set.
"""

import math

from bench.jit import njit

HALF_TURN, FULL_TURN = math.pi, 2.0 * math.pi
CAP = 0.01  # cosine of the middle angle: so near to its pole a set keeps no branch, see `track`
POLE = 1e-15  # as in rotation.euler_from_quat: no direction is left below it


@njit
def wrapped(angle):
    """Return the angle in (-pi, pi]."""
    if -HALF_TURN < angle <= HALF_TURN:
        return angle
    angle -= FULL_TURN * math.floor((angle + HALF_TURN) / FULL_TURN)
    return angle - FULL_TURN if angle > HALF_TURN else angle


@njit
def on_side(side, w, x, y, z):
    """Return the quaternion, of any length, whose 3-1-2 angles are those of the side: q, or q turned about z."""
    if side > 0.0:
        return w, x, y, z
    return w - z, x + y, y - x, z + w


@njit
def angles(side, w, x, y, z, inner0):
    """Return yaw, middle and inner angle, the middle one in [-pi/2, pi/2]; at the pole the inner one is inner0."""
    w, x, y, z = on_side(side, w, x, y, z)
    half_sum, half_difference = math.atan2(y + z, w + x), math.atan2(z - y, w - x)
    length_sum = math.sqrt((y + z) * (y + z) + (w + x) * (w + x))
    length_difference = math.sqrt((z - y) * (z - y) + (w - x) * (w - x))
    middle = math.atan2(2.0 * (w * x + y * z), length_sum * length_difference)
    if length_difference < POLE:
        return wrapped(2.0 * half_sum - inner0), middle, inner0
    if length_sum < POLE:
        return wrapped(2.0 * half_difference + inner0), middle, inner0
    return wrapped(half_sum + half_difference), middle, wrapped(half_sum - half_difference)


@njit
def nearest_angles(side, w, x, y, z, yaw0, middle0, inner0):
    """Return the angles of the side on the branch that is nearer to the given ones, each in (-pi, pi].

    The other branch is (yaw + pi, pi - middle, inner + pi); nearest is the smallest sum of squared differences.
    """
    yaw, middle, inner = angles(side, w, x, y, z, inner0)
    other = wrapped(yaw + HALF_TURN), wrapped(HALF_TURN - middle), wrapped(inner + HALF_TURN)
    a, b, c = wrapped(yaw - yaw0), wrapped(middle - middle0), wrapped(inner - inner0)
    d, e, f = wrapped(other[0] - yaw0), wrapped(other[1] - middle0), wrapped(other[2] - inner0)
    return other if d * d + e * e + f * f < a * a + b * b + c * c else (yaw, middle, inner)


@njit
def next_side(side, sine_pitch, enter, leave):
    """Return the set that serves a pitch of the given sine: reverse above `enter`, forward below `leave`."""
    if side > 0.0:
        return -1.0 if abs(sine_pitch) > enter else 1.0
    return 1.0 if abs(sine_pitch) < leave else -1.0


@njit
def track(q, enter, middle, leave, forward, reverse, flag):
    """Fill forward and reverse (n, 3), as yaw, middle and inner angle, and flag (n,) along the attitudes q (n, 4).

    The branch is that nearer to the previous angles, but within half a degree of the pole to those at which that cap
    was entered: there samples may step over the pole on the way out and walk round it on the way back, and the branch
    would not come back with the body.
    """
    f, r = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    f0, r0 = f, r
    for k in range(len(q)):
        w, x, y, z = q[k, 0], q[k, 1], q[k, 2], q[k, 3]
        sine = 2.0 * (w * x + y * z)
        if k == 0:
            f, r = angles(1.0, w, x, y, z, 0.0), angles(-1.0, w, x, y, z, 0.0)
            side = -1.0 if abs(sine) > middle else 1.0
        else:
            f = nearest_angles(1.0, w, x, y, z, f0[0], f0[1], f0[2])
            r = nearest_angles(-1.0, w, x, y, z, r0[0], r0[1], r0[2])
            side = next_side(side, sine, enter, leave)
        if k == 0 or abs(math.cos(f[1])) > CAP:
            f0 = f
        if k == 0 or abs(math.cos(r[1])) > CAP:
            r0 = r
        forward[k, 0], forward[k, 1], forward[k, 2] = f
        reverse[k, 0], reverse[k, 1], reverse[k, 2] = r
        flag[k] = side
