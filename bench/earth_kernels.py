"""The Earth for numba kernels: plain floats in, tuples out; `p` is `Earth.parameters`.

The formulas are those of ``bench.earth``; a test holds the two against each other.
"""

import math

import numpy as np

from bench.jit import njit


@njit
def gravitation(p, x, y, z):
    """Return the gravitation G in e at (x, y, z) in e: point mass and J2, or the normal field."""
    if p[5] == 0.0:
        return _j2(p, x, y, z)
    return _normal(p, x, y, z)


@njit
def _j2(p, x, y, z):
    r2 = x * x + y * y + z * z
    ratio = z * z / r2
    k = 1.5 * p[4] * p[0] * p[0] / r2
    scale = -p[2] / (r2 * math.sqrt(r2))
    across = scale * (1.0 + k * (1.0 - 5.0 * ratio))
    return across * x, across * y, scale * (1.0 + k * (3.0 - 5.0 * ratio)) * z


@njit
def _normal(p, x, y, z):
    """Gradient of the normal gravitational potential, in ellipsoidal coordinates u, beta ([HM] 2-7, 2-8).

    q and q' as series in E/u: the closed forms lose six digits where the ellipsoid is nearly a sphere.
    """
    a2, b2 = p[0] * p[0], p[0] * p[0] * (1.0 - p[1])
    E2 = a2 - b2
    r2 = x * x + y * y + z * z
    half = 0.5 * (r2 - E2)
    u2 = half + math.sqrt(half * half + E2 * z * z)
    v2 = u2 + E2
    u, v = math.sqrt(u2), math.sqrt(v2)
    sine = z / u
    across = math.sqrt(x * x + y * y)
    cosine = across / v
    q0 = _q(E2 / b2)
    big = p[3] * p[3] * a2 * (b2 / u2) ** 1.5  # q and q0 without their common factor (E/u)^3, (E/b)^3
    w2 = (u2 + E2 * sine * sine) / v2
    # Components along u and beta, without the factor 1/w.
    radial = -(p[2] + big * u * _dq(E2 / u2) / q0 * (0.5 * sine * sine - 1.0 / 6.0)) / v2
    tangential = big * _q(E2 / u2) / q0 * sine * cosine / v
    # Unit vectors of u and beta carry 1/w each: du = (u/v cos beta, sin beta)/w, dbeta = (-sin beta, u/v cos beta)/w.
    out = (radial * u / v * cosine - tangential * sine) / w2
    up = (radial * sine + tangential * u / v * cosine) / w2
    scale = out / across if across > 0.0 else 0.0
    return scale * x, scale * y, up


@njit
def _q(s):
    """Return q of [HM] Eq. 2-57 divided by (E/u)^3, s = (E/u)^2."""
    total, power = 0.0, 1.0
    for k in range(1, 13):
        total += 2.0 * k / ((2.0 * k + 1.0) * (2.0 * k + 3.0)) * power
        power *= -s
    return total


@njit
def _dq(s):
    """Return q' of [HM] Eq. 2-66 divided by (E/u)^2 (that is, -dq/du (u^2 + E^2)/E), s = (E/u)^2."""
    total, power = 0.0, 1.0
    for k in range(1, 13):
        total += 6.0 / ((2.0 * k + 1.0) * (2.0 * k + 3.0)) * power
        power *= -s
    return total


@njit
def gravitations(p, r):
    """Return the gravitation at rows of positions."""
    out = np.empty_like(r)
    for k in range(len(r)):
        out[k, 0], out[k, 1], out[k, 2] = gravitation(p, r[k, 0], r[k, 1], r[k, 2])
    return out
