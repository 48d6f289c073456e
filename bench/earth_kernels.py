"""The Earth for numba kernels: plain floats in, tuples out; `p` is `Earth.parameters`.

At r = 6.4e6 m one rounding is half a nanometre. The conversions therefore carry the rounding errors of their large
terms along, so that little more than the rounding of the result remains.

References
----------
[HM] Heiskanen, Moritz: Physical Geodesy, 1967.
[Bowring] Bowring: The accuracy of geodetic latitude and height equations, Survey Review 28, 1985.
"""

import math

import numpy as np

from bench._compensated_kernels import two_product, two_root, two_sincos, two_sum
from bench.jit import njit


@njit
def radii(p, latitude):
    """Return the radii of curvature R_M (meridian) and R_N (prime vertical) at a geodetic latitude."""
    sine = math.sin(latitude)
    w2 = 1.0 - p[1] * sine * sine
    R_N = p[0] / math.sqrt(w2)
    return R_N * (1.0 - p[1]) / w2, R_N


@njit
def geodetic_position(p, latitude, longitude, height):
    """Return r_e of a geodetic position."""
    a, e2 = p[0], p[1]
    s, s_low, c, c_low = two_sincos(latitude)
    w2, w2_low = two_sum(1.0, -e2 * s * s)
    w, w_low = two_root(w2, w2_low)
    R_N = a / w
    product, low = two_product(R_N, w)
    R_N_low = ((a - product) - low - R_N * w_low) / w
    arm, arm_low = two_sum(R_N, height)
    arm_low += R_N_low
    rho, rho_low = two_product(arm, c)
    rho_low += arm_low * c + arm * c_low
    sine, sine_low, cosine, cosine_low = two_sincos(longitude)
    x, x_low = two_product(rho, cosine)
    y, y_low = two_product(rho, sine)
    z, z_low = two_product(arm, s)
    x_low += rho_low * cosine + rho * cosine_low
    y_low += rho_low * sine + rho * sine_low
    z_low += (arm_low - e2 * R_N) * s + arm * s_low
    return x + x_low, y + y_low, z + z_low


@njit
def geodetic(p, x, y, z):
    """Return latitude, longitude in (-pi, pi] and height of r_e = (x, y, z); longitude 0 on the axis.

    [Bowring]'s step on the reduced latitude, then one of Newton: T, the distance along the meridian by which the
    normal at the latitude misses the point, vanishes at the solution, and is the derivative of the height by the
    latitude.
    """
    a, e2 = p[0], p[1]
    xx, xx_low = two_product(x, x)
    yy, yy_low = two_product(y, y)
    rho2, rho2_low = two_sum(xx, yy)
    rho, rho_low = two_root(rho2, rho2_low + xx_low + yy_low)
    k = math.sqrt(1.0 - e2)
    s, c = z * (k + e2 * a / math.sqrt(rho2 + z * z)), rho
    norm = math.sqrt(s * s + c * c)
    latitude = math.atan2(z + e2 * a / k * (s / norm) ** 3, rho - e2 * a * (c / norm) ** 3)

    s, s_low, c, c_low = two_sincos(latitude)
    w2, w2_low = two_sum(1.0, -e2 * s * s)
    w, w_low = two_root(w2, w2_low)
    north, north_low = two_product(z, c)
    south, south_low = two_product(rho, s)
    T, low = two_sum(north, -south)
    T += low + (north_low - south_low + z * c_low - rho * s_low - rho_low * s + a * e2 / w * s * c)
    across, across_low = two_product(rho, c)
    up, up_low = two_product(z, s)
    foot, foot_low = two_product(a, w)
    across_low += rho_low * c + rho * c_low
    up_low += z * s_low
    foot_low += a * w_low
    high, low = two_sum(across, up)
    height, low2 = two_sum(high, -foot)
    low += low2 + across_low + up_low - foot_low
    turn = T / (a * (1.0 - e2) / (w * w * w) + height)
    return latitude + turn, math.atan2(y + 0.0, x + 0.0), height + (low + 0.5 * T * turn)  # + 0.0: no negative zero


@njit
def gravitation(p, x, y, z):
    """Return the gravitation G in e at (x, y, z) in e: point mass and J2, or the normal field."""
    if p[5] == 0.0:
        return _j2(p, x, y, z)
    return _normal(p, x, y, z)


@njit
def _j2(p, x, y, z):
    r2 = x * x + y * y + z * z
    inverse = 1.0 / r2
    ratio = z * z * inverse
    k = 1.5 * p[4] * p[0] * p[0] * inverse
    scale = -p[2] * inverse * inverse * math.sqrt(r2)  # no second division: every update of a solver waits for this
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


@njit
def geodetic_positions(p, rows):
    """Return r_e at rows of latitude, longitude, height."""
    out = np.empty_like(rows)
    for k in range(len(rows)):
        out[k, 0], out[k, 1], out[k, 2] = geodetic_position(p, rows[k, 0], rows[k, 1], rows[k, 2])
    return out


@njit
def geodetics(p, r):
    """Return latitude, longitude, height at rows of positions r_e."""
    out = np.empty_like(r)
    for k in range(len(r)):
        out[k, 0], out[k, 1], out[k, 2] = geodetic(p, r[k, 0], r[k, 1], r[k, 2])
    return out
