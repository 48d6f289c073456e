"""The stated conditions of the damped ship's INS and its periods, by hand, for the tests of the experiment."""

from math import cos, pi, radians, sin, sqrt

import numpy as np

from bench.experiments._damping_trials import Options

ARCMIN, ARCSEC, DRIFT = pi / 10800, pi / 648000, radians(0.005) / 3600
# Section 3 of the paper: dv, dL and dlambda, phi, nabla, eps.
STATED = np.array([0.1, 0.1, *[2 * ARCSEC] * 2, *[0.7 * ARCMIN] * 2, 7.7 * ARCMIN, *[5e-5 * 9.80665] * 3, *[DRIFT] * 3])
COLUMN_STATES = ("dL", "dlambda", "phi_E", "phi_N", "phi_U", "dv_E", "dv_N")
COLUMN_ROWS, COLUMN_UNITS = [2, 3, 4, 5, 6, 0, 1], np.array([ARCMIN] * 5 + [1.0] * 2)
# By hand: R = 6371 km, GM and rate of WGS 84, and what the turn of the Earth takes from gravity at 48 degrees.
RADIUS, EARTH_RATE = 6371e3, 7.292115e-5
GRAVITY = 3.986004418e14 / RADIUS**2 - EARTH_RATE**2 * RADIUS * cos(radians(48.0)) ** 2
SCHULER_RATE, EARTH_TURN = sqrt(GRAVITY / RADIUS), 2 * pi / EARTH_RATE
THERE = Options(latitude=48.0, trials=10)
THEORY = {"Schuler": 2 * pi / SCHULER_RATE, "Foucault": EARTH_TURN / sin(radians(48.0)), "24 h": EARTH_TURN}
