"""Kernels of the Euler-angle solvers: the power series of the angles over an update, the switch between the two sets.

The angles (yaw, middle, inner) and the trick that makes one set of equations serve both sets are those of
``bench.euler_angle_kernels``. With the rates (p, r, q) about the frame's x, y, z, and the reference turning with Omega:

    middle' = p cI + q sI + a,   inner' = r - sM t + y,   yaw' = t + Z - sM y,
    t = (q cI - p sI) / cM,   y = b / cM,   a = X cYaw + Y sYaw,   b = Y cYaw - X sYaw,   (X, Y, Z) = -Omega
"""

import math

import numpy as np

from bench.euler_angle_kernels import angles, next_side, wrapped
from bench.jit import njit
from bench.rotation_kernels import multiply

TERMS = 24  # after which a series counts as divergent
HALVINGS = 30  # of an update whose series diverges; then its increments are no motion at all
NEGLIGIBLE = 1e-15  # rad: such a term behind a small one ends the series, and what follows is rounding
SMALL = 1e-13  # rad
COLUMNS = 11  # of the work array: see `expand`


@njit
def expand(w, X, Y, Z, trig, s, d):
    """Fill s (TERMS + 1, COLUMNS) with power series in u and d (3,) with the changes of the angles to u = 1.

    w (N, 3): coefficients of the rates p, r, q; (X, Y, Z): rate of the reference frame in its own axes, reversed; all
    in rad per unit of u; trig: sine and cosine of yaw, middle and inner angle at u = 0. Columns of s: t; rates of
    middle and inner; sine and cosine of middle and inner; rate of yaw; if the reference turns, the sine and cosine of
    yaw, and y. Returns whether the series converges.
    """
    N, turning, inverse = len(w), X != 0.0 or Y != 0.0, 1.0 / trig[3]
    sM0, cM0, sI0, cI0 = trig[2], trig[3], trig[4], trig[5]
    s[0, 3], s[0, 4], s[0, 5], s[0, 6], s[0, 8], s[0, 9] = sM0, cM0, sI0, cI0, trig[0], trig[1]
    d[0] = d[1] = d[2] = 0.0
    before = 1.0
    for k in range(TERMS):
        middle = level = 0.0
        for j in range(min(N, k + 1)):
            middle += w[j, 0] * s[k - j, 6] + w[j, 2] * s[k - j, 5]
            level += w[j, 2] * s[k - j, 6] - w[j, 0] * s[k - j, 5]
        across = along = sM = cM = sI = cI = 0.0
        for j in range(k):  # all sums side by side: alone, each would wait for its own last addition
            across += s[j, 0] * s[k - j, 4]
            along += s[j, 0] * s[k - j, 3]
            cM += s[j, 1] * s[k - j, 3]
            sM += s[j, 1] * s[k - j, 4]
            cI += s[j, 2] * s[k - j, 5]
            sI += s[j, 2] * s[k - j, 6]
        t = (level - across) * inverse
        inner = (w[k, 1] if k < N else 0.0) - (along + sM0 * t)
        yaw = t + Z if k == 0 else t
        if turning:
            middle += X * s[k, 9] + Y * s[k, 8]
            across, along = Y * s[k, 9] - X * s[k, 8], 0.0
            for j in range(k):
                across -= s[j, 10] * s[k - j, 4]
                along += s[j, 10] * s[k - j, 3]
            y = across * inverse
            s[k, 10] = y
            inner += y
            yaw -= along + sM0 * y
        s[k, 0], s[k, 1], s[k, 2], s[k, 7] = t, middle, inner, yaw
        share = 1.0 / (k + 1.0)
        d[0], d[1], d[2] = d[0] + yaw * share, d[1] + middle * share, d[2] + inner * share
        size = (abs(yaw) + abs(middle) + abs(inner)) * share
        if size < NEGLIGIBLE and before < SMALL and k >= N - 1:
            return True
        before = size
        s[k + 1, 3], s[k + 1, 4] = (sM + middle * cM0) * share, -(cM + middle * sM0) * share
        s[k + 1, 5], s[k + 1, 6] = (sI + inner * cI0) * share, -(cI + inner * sI0) * share
        if turning:
            sY = cY = 0.0
            for j in range(k + 1):
                sY += s[j, 7] * s[k - j, 9]
                cY += s[j, 7] * s[k - j, 8]
            s[k + 1, 8], s[k + 1, 9] = sY * share, -cY * share
    return False


@njit
def shift(w, start, length, v):
    """Fill v (N, 3) with the coefficients of the rates w as functions of (u - start) / length, per unit of that."""
    N, scale = len(w), 1.0
    for m in range(N):
        scale *= length
        for axis in range(3):
            total, factor = 0.0, 1.0
            for j in range(m, N):
                total += factor * w[j, axis]
                factor *= start * (j + 1.0) / (j + 1.0 - m)
            v[m, axis] = scale * total


@njit
def sines(yaw, middle, inner, trig, q):
    """Fill trig (6,) with sine and cosine of each angle, and q (4,) with Rz(yaw) Rx(middle) Ry(inner)."""
    sz, cz = math.sin(0.5 * yaw), math.cos(0.5 * yaw)
    sx, cx = math.sin(0.5 * middle), math.cos(0.5 * middle)
    sy, cy = math.sin(0.5 * inner), math.cos(0.5 * inner)
    trig[0], trig[1] = 2.0 * sz * cz, (cz - sz) * (cz + sz)
    trig[2], trig[3] = 2.0 * sx * cx, (cx - sx) * (cx + sx)
    trig[4], trig[5] = 2.0 * sy * cy, (cy - sy) * (cy + sy)
    q[0], q[1] = cz * cx * cy - sz * sx * sy, cz * sx * cy - sz * cx * sy
    q[2], q[3] = cz * cx * sy + sz * sx * cy, sz * cx * cy + cz * sx * sy


@njit
def integrate(w, X, Y, Z, halvings, a, trig, q, v, s, d):
    """Turn the angles a (3,), with trig and q as `sines` fills them, by the rates w over u from 0 to 1.

    Where the series does not converge the step is halved, at most `halvings` times; without halvings one step is taken
    whatever comes of it. v (N, 3), s (TERMS + 1, COLUMNS) and d (3,) are scratch. Returns whether it has arrived.
    """
    u, length, shortest = 0.0, 1.0, 0.5**halvings
    while u < 1.0:
        if length == 1.0:
            converges = expand(w, X, Y, Z, trig, s, d)
        else:
            shift(w, u, length, v)
            converges = expand(v, X * length, Y * length, Z * length, trig, s, d)
        if not converges and halvings > 0:
            length *= 0.5
            if length < shortest:
                return False
            continue
        for axis in range(3):
            a[axis] = wrapped(a[axis] + d[axis])
        sines(a[0], a[1], a[2], trig, q)
        u += length
        length = min(2.0 * length, 1.0 - u)
    return True


@njit
def rates(G, side, dtheta, start, d, w):
    """Fill w (N, 3) with the coefficients of the rates p, r, q of a side's frame.

    G (N, N) is a `_rate_fit.difference_tables` without its first axis; d (N, 3) is scratch, for the differences.
    """
    N = len(G)
    for i in range(N):
        x, y, z = dtheta[start + i, 0], dtheta[start + i, 1], dtheta[start + i, 2]
        if side > 0.0:
            d[i, 0], d[i, 1], d[i, 2] = x, y, z
        else:
            d[i, 0], d[i, 1], d[i, 2] = y, -x, z
    for order in range(1, N):
        for i in range(N - 1, order - 1, -1):
            d[i, 0], d[i, 1], d[i, 2] = d[i, 0] - d[i - 1, 0], d[i, 1] - d[i - 1, 1], d[i, 2] - d[i - 1, 2]
    for m in range(N):
        x = y = z = 0.0
        for j in range(N - 1, m - 1, -1):  # small terms first
            x += G[m, j] * d[j, 0]
            y += G[m, j] * d[j, 1]
            z += G[m, j] * d[j, 2]
        w[m, 0], w[m, 1], w[m, 2] = x, y, z


@njit
def body_quaternion(side, q, last, out, n):
    """Fill out[n] and last (4,) with the attitude of b from q of a side's frame, of the sign that is nearer to last."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    if side < 0.0:
        h = math.sqrt(0.5)
        w, x, y, z = h * (w + z), h * (x - y), h * (y + x), h * (z - w)
    sign = -1.0 if w * last[0] + x * last[1] + y * last[2] + z * last[3] < 0.0 else 1.0
    last[0], last[1], last[2], last[3] = sign * w, sign * x, sign * y, sign * z
    out[n, 0], out[n, 1], out[n, 2], out[n, 3] = last[0], last[1], last[2], last[3]


@njit
def euler(G, halvings, dtheta, starts, carry, out):
    """Do len(out) updates of the forward angles; carry is the angles (3) and q (4). Return how many were done."""
    N = len(G)
    w, v, s = np.empty((N, 3)), np.empty((N, 3)), np.empty((TERMS + 1, COLUMNS))
    d = np.empty(3)
    a, trig, q, last = carry[:3], np.empty(6), np.empty(4), carry[3:]
    sines(a[0], a[1], a[2], trig, q)
    for n in range(len(out)):
        rates(G, 1.0, dtheta, starts[n], v, w)
        if not integrate(w, 0.0, 0.0, 0.0, halvings, a, trig, q, v, s, d):
            return n
        body_quaternion(1.0, q, last, out, n)
    return len(out)


@njit
def change_over(side, enter, leave, a, trig, q, last):
    """Return the side that serves the attitude `last` (4,); a (3,), trig and q become those of its angles."""
    w, x, y, z = last[0], last[1], last[2], last[3]
    new = next_side(side, 2.0 * (w * x + y * z), enter, leave)
    if new != side:
        a[0], a[1], a[2] = angles(new, w, x, y, z, 0.0)
        sines(a[0], a[1], a[2], trig, q)
    return new


@njit
def dual_euler(G, enter, leave, dtheta, starts, carry, out):
    """Do len(out) updates; carry is the active angles (3), q (4) and the side."""
    N = len(G)
    w, v, s = np.empty((N, 3)), np.empty((N, 3)), np.empty((TERMS + 1, COLUMNS))
    d = np.empty(3)
    a, last, side, trig, q = carry[:3], carry[3:7], carry[7], np.empty(6), np.empty(4)
    sines(a[0], a[1], a[2], trig, q)
    for n in range(len(out)):
        rates(G, side, dtheta, starts[n], v, w)
        if not integrate(w, 0.0, 0.0, 0.0, HALVINGS, a, trig, q, v, s, d):
            out[n, 0] = math.nan
            break
        body_quaternion(side, q, last, out, n)
        side = change_over(side, enter, leave, a, trig, q, last)
    carry[7] = side


@njit
def first_order_quaternion(dtheta, starts, q, out):
    """Do len(out) updates q + q o (0, dtheta)/2; q (4,) is not normalised, the rows of out are."""
    for n in range(len(out)):
        k = starts[n]
        dw, dx, dy, dz = multiply(
            q[0], q[1], q[2], q[3], 0.0, 0.5 * dtheta[k, 0], 0.5 * dtheta[k, 1], 0.5 * dtheta[k, 2]
        )
        q[0], q[1], q[2], q[3] = q[0] + dw, q[1] + dx, q[2] + dy, q[3] + dz
        scale = 1.0 / math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
        if scale == 0.0:
            scale = math.nan  # the squares overflow: this is no rotation
        out[n, 0], out[n, 1], out[n, 2], out[n, 3] = scale * q[0], scale * q[1], scale * q[2], scale * q[3]
