"""Tables 1 and 2 of [Zhao] as printed: steady-state errors of the fusion and of filter 1, against the constant C.

The heads of the columns do not survive in the source at hand; from their sizes they are latitude and longitude
(arcmin), three attitude angles (arcmin), east and north velocity (m/s).
"""

import numpy as np

from bench.units import ARCMIN

REFERENCE_ERRORS = (-0.1, -0.2, -0.3, -0.4, -0.5)  # m/s, east and north
COLUMNS = ("latitude", "longitude", "phi_E", "phi_N", "phi_U", "v_E", "v_N")
UNITS = ("arcmin",) * 5 + ("m/s",) * 2
STATE = (2, 3, 4, 5, 6, 0, 1)  # of the error model, behind each column
SCALE = np.array([ARCMIN] * 5 + [1.0] * 2)
FAMILIES = {"position": slice(0, 2), "attitude": slice(2, 5), "velocity": slice(5, 7)}

FUSION_TABLE = np.array(
    [
        [1.140, -3.100, -0.035, -0.014, -0.020, -0.081, -0.090],
        [0.700, -4.500, -0.039, -0.016, -0.050, -0.142, -0.150],
        [0.470, -4.300, -0.046, -0.009, -0.079, -0.150, -0.181],
        [0.200, -4.250, -0.046, -0.006, -0.081, -0.131, -0.139],
        [0.440, -4.000, -0.049, -0.006, -0.080, -0.110, -0.132],
    ]
)
FILTER_1_TABLE = np.array(
    [
        [0.810, -5.901, -0.053, -0.033, -0.066, -0.092, -0.098],
        [-2.001, -11.002, -0.077, -0.072, -0.150, -0.203, -0.198],
        [-4.004, -13.705, -0.105, -0.111, -0.234, -0.296, -0.294],
        [-6.301, -18.004, -0.126, -0.150, -0.318, -0.409, -0.391],
        [-8.410, -21.201, -0.150, -0.187, -0.401, -0.504, -0.498],
    ]
)
TABLES = {"table 1": FUSION_TABLE, "table 2": FILTER_1_TABLE}
BOTH = np.stack([FUSION_TABLE, FILTER_1_TABLE])  # (2, 5, 7)
LARGEST = np.abs(BOTH).max(axis=1)  # (2, 7): what deviations are measured by
