"""Path over the ellipsoid from a velocity profile, to rounding.

L' = v_N / (R_M + h), lon' = v_E / ((R_N + h) cosL), h' = v_U.
The velocity is sampled at Chebyshev points of segments. Height follows by quadrature, then latitude by Picard's
iteration on all segments at once (each round gains two digits or more: the equation is nearly a quadrature, as R_M
depends on L by e^2 only), then longitude by quadrature. Segments on which one of the three rates has not decayed to
rounding are halved, and all is done again. The solution gives places only: velocity and acceleration of a motion
come from its profile.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.earth import Earth
from bench.errors import AccuracyError, Array
from bench.motion._chebyshev import EPS, FIT, INTEGRAL, Function, evaluate_segments, sample
from bench.motion._earth_options import NEAR_POLE, check_off_poles

NEGLIGIBLE = 1e-12  # m; what a segment may leave unresolved whatever its speed
SHORTEST = 1e-6  # s; a profile that still needs shorter segments has a jump
LARGEST_COUNT = 2**17  # of segments: 100 MB; 48 h of waves of 1.5 s
LARGEST_ROUNDS = 60


@dataclass(frozen=True, eq=False)
class GeodeticPath:
    """The solved path: m segments of Chebyshev series.

    Attributes
    ----------
    breaks : ndarray, shape (m + 1,), s
    starts : ndarray, shape (m + 1, 3), rad, rad, m
        Latitude, longitude and height at the breaks.
    change : ndarray, shape (m, DEGREE + 1, 4)
        Coefficients of (latitude, longitude, height, 0) minus that at the start of the segment: the change is small, so
        its roundings are, too.
    """

    breaks: Array
    starts: Array
    change: Array

    def places(self, t: Array) -> Array:
        """Return latitude, longitude (rad, not wrapped) and height (m) at times t, shape (n, 3)."""
        segment = np.searchsorted(self.breaks[1:-1], t, side="right")
        return np.asarray(self.starts[segment] + evaluate_segments(self.breaks, self.change, t)[:, :3])


def solve(
    velocity_n: Function, corners: Array, place: tuple[float, float, float], earth: Earth, longest: float
) -> GeodeticPath:
    """Return the path from a place (latitude, longitude, height: rad, m) at the first corner.

    Parameters
    ----------
    velocity_n : callable, (n,) s -> (n, 3) m/s
        East, north, up; smooth between the corners.
    corners : ndarray, shape (k + 1,), s
        Start, times where a derivative of the velocity may jump, end.
    place : tuple of 3 floats
    earth : Earth
    longest : float, s
        The segments start from this length.

    Raises
    ------
    InputError
        If the path comes within 1e-6 rad of a pole.
    AccuracyError
        If the velocity cannot be resolved.
    """
    pieces = [math.ceil(length / longest) for length in np.diff(corners)]
    if sum(pieces) > LARGEST_COUNT:
        raise AccuracyError(
            f"the path would need {sum(pieces)} segments of {longest:.1g} s, more than {LARGEST_COUNT}: the velocity "
            "changes too fast for so long a time"
        )
    breaks = np.concatenate(
        [a + (b - a) * (np.arange(k) / k) for a, b, k in zip(corners[:-1], corners[1:], pieces, strict=True)]
        + [corners[-1:]]
    )
    while True:
        starts, change, fine = _solve_on(breaks, velocity_n, place, earth)
        if fine.all():
            break
        if len(breaks) > LARGEST_COUNT or np.diff(breaks)[~fine].min() < SHORTEST:
            raise AccuracyError(
                f"the velocity is not smooth enough near t = {breaks[:-1][~fine][0]:.17g} s for a path at rounding "
                "(a jump, or a huge frequency?)"
            )
        breaks = np.sort(np.concatenate([breaks, (breaks[:-1] + 0.5 * np.diff(breaks))[~fine]]))
    padded = np.concatenate([change, np.zeros((*change.shape[:2], 1))], axis=2)
    return GeodeticPath(breaks, starts, padded)


def _solve_on(
    breaks: Array, velocity_n: Function, place: tuple[float, float, float], earth: Earth
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Return starts (m + 1, 3), coefficients of the change (m, DEGREE + 1, 3), and which segments are resolved."""
    v, _ = sample("velocity", velocity_n, breaks[:-1], breaks[1:])
    length = np.diff(breaks)
    h_starts, h_change = _integrate(v[:, :, 2], length, place[2])
    h = h_starts[:-1, None] + h_change
    L = np.full_like(h, place[0])
    for _ in range(LARGEST_ROUNDS):
        R_M, R_N = earth.radii(np.clip(L, -math.pi / 2, math.pi / 2))  # beyond, the path will be refused
        previous, dL = L, v[:, :, 1] / (R_M + h)
        L_starts, L_change = _integrate(dL, length, place[0])
        L = L_starts[:-1, None] + L_change
        if np.abs(L - previous).max() <= EPS:
            break
    cosine = np.maximum(np.cos(L), 0.5 * NEAR_POLE)
    dlon = v[:, :, 0] / ((R_N + h) * cosine)
    lon_starts, lon_change = _integrate(dlon, length, place[1])
    east = dlon * (R_N + h) * cosine.max(axis=1, keepdims=True)
    metres = np.stack([dL * (R_M + h), east, v[:, :, 2]], axis=2)
    tail, largest = (np.abs(x).max(axis=1) for x in (FIT[-3:] @ metres, metres))
    largest[:, 1] += largest[:, 1] / cosine.min(axis=1)  # a rounding of the latitude is more of its cosine
    fine = (tail <= 8 * EPS * largest) | (tail * length[:, None] <= NEGLIGIBLE)
    if fine[:, ::2].all():
        check_off_poles("latitude of the path", L)
    starts = np.stack([L_starts, lon_starts, h_starts], axis=1)
    return starts, FIT @ np.stack([L_change, lon_change, h_change], axis=2), fine.all(axis=1)


def _integrate(rate: Array, length: Array, start: float) -> tuple[Array, Array]:
    """Return the integral of a rate (m, DEGREE + 1), plus `start`, at the breaks, and its change to the nodes."""
    change = (0.5 * length)[:, None] * (rate @ INTEGRAL.T)
    sums = np.concatenate([[0.0], change[:, -1]])
    shift = 1
    while shift < len(sums):  # running sums of depth log2(m), so that few roundings enter any break
        sums[shift:] = sums[shift:] + sums[:-shift]
        shift *= 2
    return start + sums, change
