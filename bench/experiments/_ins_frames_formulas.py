"""Between the Earth frame and the navigation frame, as usually coded: kernels to be counted, not to be used."""

import math

from bench.errors import Array
from bench.jit import njit
from bench.rotation_kernels import multiply, rotate


@njit
def to_earth(p: Array, q_en: Array, q_nb: Array, v_n: Array, h: float, out: Array) -> None:
    """Fill out (10,) with q_eb, v_e, r_e of attitude and velocity in n and the height; p is `Earth.parameters`."""
    w, x, y, z = q_en[0], q_en[1], q_en[2], q_en[3]
    out[0], out[1], out[2], out[3] = multiply(w, x, y, z, q_nb[0], q_nb[1], q_nb[2], q_nb[3])
    out[4], out[5], out[6] = rotate(w, x, y, z, v_n[0], v_n[1], v_n[2])
    s = 1.0 - 2.0 * (x * x + y * y)
    R_N = p[0] / math.sqrt(1.0 - p[1] * s * s)
    out[7] = (R_N + h) * (2.0 * (x * z + w * y))
    out[8] = (R_N + h) * (2.0 * (y * z - w * x))
    out[9] = (R_N * (1.0 - p[1]) + h) * s


@njit
def angles(frame: Array, out: Array) -> None:
    """Fill out (2,) with latitude and longitude; frame is cos and sin of (lon + pi/2)/2 and of (pi/2 - lat)/2."""
    out[0] = 0.5 * math.pi - 2.0 * math.atan2(frame[3], frame[2])
    out[1] = 2.0 * math.atan2(frame[1], frame[0]) - 0.5 * math.pi


@njit
def to_navigation(p: Array, row: Array, out: Array) -> None:
    """Fill out (10,) with latitude, longitude, height, q_nb, v_n of row = (q_eb, v_e, r_e); one step of Bowring's."""
    a, e2 = p[0], p[1]
    x, y, z = row[7], row[8], row[9]
    k = math.sqrt(1.0 - e2)
    rho2 = x * x + y * y
    rho = math.sqrt(rho2)
    s, c = z * (k + e2 * a / math.sqrt(rho2 + z * z)), rho
    norm = math.sqrt(s * s + c * c)
    s, c = s / norm, c / norm
    latitude = math.atan2(z + e2 * a / k * (s * s * s), rho - e2 * a * (c * c * c))
    longitude = math.atan2(y, x)
    sine, cosine = math.sin(latitude), math.cos(latitude)
    out[0], out[1], out[2] = latitude, longitude, rho * cosine + z * sine - a * math.sqrt(1.0 - e2 * sine * sine)
    half, tilt = 0.5 * longitude + 0.25 * math.pi, 0.25 * math.pi - 0.5 * latitude
    cz, sz, cx, sx = math.cos(half), math.sin(half), math.cos(tilt), math.sin(tilt)
    ew, ex, ey, ez = cz * cx, -cz * sx, -sz * sx, -sz * cx  # of e in n
    out[3], out[4], out[5], out[6] = multiply(ew, ex, ey, ez, row[0], row[1], row[2], row[3])
    out[7], out[8], out[9] = rotate(ew, ex, ey, ez, row[4], row[5], row[6])
