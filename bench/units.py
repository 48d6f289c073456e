"""Published units in SI; the only place where conversion factors appear.

Multiply to enter (``5 * DEG``), divide to leave (``angle / ARCSEC``).
"""

import math

DEG = math.pi / 180.0  # rad
ARCMIN = DEG / 60.0  # rad
ARCSEC = DEG / 3600.0  # rad
HOUR = 3600.0  # s
DEG_PER_S = DEG  # rad/s
DEG_PER_H = DEG / HOUR  # rad/s
DEG_PER_SQRT_H = DEG / math.sqrt(HOUR)  # rad/sqrt(s), angle random walk = (rad/s)/sqrt(Hz)
M_PER_S_PER_SQRT_H = 1.0 / math.sqrt(HOUR)  # (m/s)/sqrt(s), velocity random walk = (m/s^2)/sqrt(Hz)
FOOT = 0.3048  # m, international
KM_PER_H = 1.0 / 3.6  # m/s
KNOT = 1852.0 / HOUR  # m/s, international nautical miles per hour
STANDARD_GRAVITY = 9.80665  # m/s^2, CGPM 1901
MILLI_G = 1e-3 * STANDARD_GRAVITY  # m/s^2
MICRO_G = 1e-6 * STANDARD_GRAVITY  # m/s^2
PPM = 1e-6
HZ = 2.0 * math.pi  # rad/s, for angular frequencies
