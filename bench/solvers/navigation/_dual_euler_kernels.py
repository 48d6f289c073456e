"""Kernel of the dual-Euler INS: velocity and position of the navigation frame, attitude by Euler angles of n."""

import math

import numpy as np

from bench.jit import njit
from bench.rotation_kernels import multiply
from bench.solvers.attitude._euler_kernels import (
    COLUMNS,
    HALVINGS,
    TERMS,
    body_quaternion,
    change_over,
    integrate,
    rates,
    sines,
)
from bench.solvers.navigation._increment_kernels import BLOCK, block_integrals
from bench.solvers.navigation._navigation_frame_kernels import to_earth, update


@njit
def turn_of_frame(before, turn, after):
    """Return the rotation vector of the turn z in after = z o before o turn; z is a small turn."""
    w, x, y, z = multiply(after[0], after[1], after[2], after[3], turn[0, 0], -turn[1, 0], -turn[2, 0], -turn[3, 0])
    w, x, y, z = multiply(w, x, y, z, before[0], -before[1], -before[2], -before[3])
    sine = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 * math.atan2(sine, w) / sine if sine > 1e-8 else 2.0
    return scale * x, scale * y, scale * z


@njit
def navigate(p, S, a, L, T, north, held, G, enter, leave, d, first, carry, angles, out):
    """Do len(out) updates of the N increments each in d (n, 6); return how many succeeded, see `update`.

    carry is that of `update`, angles (8,) that of the attitude kernel `dual_euler`. Each update is done with the
    quaternion of the angles at its start; the turn of n that it makes is subtracted from the rate of the body along the
    whole update, and the attitude that the angles come to takes the place of the one that it finds.
    """
    N = len(G)
    turn, state, one, found = np.empty((10, BLOCK)), np.empty((12, BLOCK)), np.empty((10, BLOCK)), np.empty((12, BLOCK))
    w, v, s, change = np.empty((N, 3)), np.empty((N, 3)), np.empty((TERMS + 1, COLUMNS)), np.empty(3)
    active, last, side, trig, q = angles[:3], angles[3:7], angles[7], np.empty(6), np.empty(4)
    attitude = np.empty((1, 4))
    sines(active[0], active[1], active[2], trig, q)
    for begin in range(0, len(out), BLOCK):
        count = min(BLOCK, len(out) - begin)
        block_integrals(S, a, L, True, d, begin * N, count, turn)
        for u in range(count):
            for c in range(10):
                one[c, 0] = turn[c, u]
            for c in range(4):
                carry[c] = last[c]
            if update(p, T, True, north, held, 1, first + begin + u, one, 1, carry, found) < 1:
                return begin + u
            X, Y, Z = turn_of_frame(last, one, carry)
            rates(G, side, d, (begin + u) * N, v, w)
            if integrate(w, X, Y, Z, HALVINGS, active, trig, q, v, s, change):
                body_quaternion(side, q, last, attitude, 0)
                side = change_over(side, enter, leave, active, trig, q, last)
            else:
                last[0] = math.nan  # for the caller to find
            for c in range(12):
                state[c, u] = last[c - 4] if 4 <= c < 8 else found[c, 0]
        to_earth(p, state, begin, count, out)
    angles[7] = side
    return len(out)
