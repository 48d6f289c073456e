"""Recordings with a known answer: a unit that stands on the Earth, in closed form."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.earth import WGS84
from bench.recording import Recording
from bench.trajectory import NavigationInitial, Trajectory

LATITUDE, LONGITUDE, HEIGHT = 0.6, -1.2, 35.0
ATTITUDE = Rotation.from_euler("ZXY", [0.4, -0.05, 0.1])
Q_NB = np.roll(ATTITUDE.as_quat(), 1)
OMEGA_B = ATTITUDE.inv().apply(7.292115e-5 * np.array([0.0, np.cos(LATITUDE), np.sin(LATITUDE)]))


def standing(n: int = 1000, dt: float = 0.01, start: float = 50.0, **options: object) -> Recording:
    """Exact increments of n intervals: in body axes nothing changes, so each is rate times dt."""
    force = ATTITUDE.inv().apply(-WGS84.gravity_n(LATITUDE, HEIGHT))
    t = start + (np.arange(n) + 1) * dt
    rows = np.full((n, 1), dt)
    return Recording(t, rows * OMEGA_B, rows * force, "increments", dt, **options)


def as_rates(recording: Recording) -> Recording:
    """The same as rate samples at both ends of every interval."""
    t = np.append(recording.start, recording.t)
    rates = [np.vstack([a[:1], a]) / recording.dt for a in (recording.angular, recording.specific)]
    return Recording(t, *rates, "rates", recording.dt)


def initial() -> NavigationInitial:
    return NavigationInitial(Q_NB, latitude=LATITUDE, longitude=LONGITUDE, height=HEIGHT)


def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let figures be one pixel each, where they are not what is tested: drawing takes longer than all else."""
    pixel = bytes.fromhex(
        "89504e470d0a1a0a0000000d49484452000000010000000108000000003a7e9b55"
        "0000000a49444154789c63680000008200813f4cd8d00000000049454e44ae426082"
    )
    monkeypatch.setattr("bench.figures.draw", lambda _, path: path.write_bytes(pixel))


def truth(t: np.ndarray) -> Trajectory:
    n = len(t)
    place = (np.full(n, LATITUDE), np.full(n, LONGITUDE), np.full(n, HEIGHT))
    return Trajectory.from_geodetic(WGS84, t, np.tile(Q_NB, (n, 1)), np.zeros((n, 3)), *place)
