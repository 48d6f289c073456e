"""PSINS .imu text: integer counts per interval in right-forward-up, with scale factors and an initial state on top."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from bench.errors import Array, InputError, require_scalar
from bench.formats import Format, RawImu
from bench.formats._text import Layout, Numbers, read_numbers, write_numbers
from bench.recording import Recording
from bench.rotation import euler_from_quat, quat_from_euler
from bench.trajectory import NavigationInitial
from bench.units import ARCSEC, DEG, STANDARD_GRAVITY

LAYOUT = Layout(("gyro x", "gyro y", "gyro z", "accelerometer x", "accelerometer y", "accelerometer z"), comment="%")
HEAD_ROWS = 3
COMMENTS = (
    "% PSINS-format SIMU log file.",
    "% 1st line: pitch0, roll0, yaw0 (deg), VE0, VN0, VU0 (m/s).",
    "% 2nd line: latitude0, longitude0 (deg), height0 (m), t0 (s), sampling interval (ms), g (m/s^2).",
    "% 3rd line: gyro scale factors (arcsec per count), accelerometer scale factors (ug*s per count), x, y, z.",
    "% Then counts per interval: gyro x, y, z, accelerometer x, y, z; x right, y forward, z up.",
)


@dataclass(frozen=True)
class PsinsImu(Format):
    """PSINS .imu text: increments as integer counts, RFU, with scale factors and initial state in the header.

    Lines that start with ``%`` are comments. Rows have no times: the k-th interval ends at t0 + k * interval, so gaps
    cannot be seen. Writing quantises; each count carries the remainder of those before, so that the sum of the written
    increments is everywhere within half a count of the true one.

    Parameters
    ----------
    gyro_count_arcsec : float, arcsec
        One count of the gyro in written files.
    accelerometer_count_ug_s : float, micro-g s
        One count of the accelerometer in written files; g is 9.80665 m/s^2.
    """

    name: ClassVar[str] = "psins-imu"
    suffixes: ClassVar[tuple[str, ...]] = (".imu",)

    axes: str = "RFU"
    gyro_count_arcsec: float = 1e-5
    accelerometer_count_ug_s: float = 1e-4

    def _check_options(self) -> None:
        for name in ("gyro_count_arcsec", "accelerometer_count_ug_s"):
            require_scalar(name, getattr(self, name), positive=True)

    def _read_imu(self, path: Path) -> RawImu:
        table, state, scale = _read(path)
        t0, dt = state[1, 3], state[1, 4] / 1e3
        counts = table.values[HEAD_ROWS:]
        t = t0 + np.arange(1, len(counts) + 1) * dt
        return RawImu(t, counts * scale, "increments", lambda k: table.where(k + HEAD_ROWS), dt=dt)

    def _write_imu(self, path: Path, recording: Recording, initial: NavigationInitial | None) -> None:
        if recording.kind != "increments":
            raise InputError("psins-imu files hold increments: write recording.as_increments(rule)")
        if initial is None:
            raise InputError("initial must be given: the header of a psins-imu file holds the initial state")
        psi, P, R = euler_from_quat(initial.q_nb)
        factors = np.repeat([self.gyro_count_arcsec, self.accelerometer_count_ug_s], 3)
        head = [
            [float(angle) / DEG for angle in (P, R, psi)] + initial.v_n.tolist(),
            [
                *(initial.latitude / DEG, initial.longitude / DEG, initial.height),
                *(recording.start, recording.dt * 1e3, STANDARD_GRAVITY),
            ],
            factors.tolist(),
        ]
        values = np.hstack(self._sensed(recording))
        totals = np.round(np.cumsum(values, axis=0) / _scale(factors, STANDARD_GRAVITY))
        counts = np.diff(totals, axis=0, prepend=0.0).astype(np.int64)
        lines = [" ".join(map(repr, row)) for row in head]
        write_numbers(path, [*COMMENTS, *lines], list(counts.T), " ")

    def _read_initial(self, path: Path) -> NavigationInitial:
        _, state, _ = _read(path)
        pitch, roll, yaw = state[0, :3] * DEG
        latitude, longitude = state[1, :2] * DEG
        return NavigationInitial(
            quat_from_euler(yaw, pitch, roll),
            state[0, 3:],
            latitude=float(latitude),
            longitude=float(longitude),
            height=float(state[1, 2]),
        )


def _read(path: Path) -> tuple[Numbers, Array, Array]:
    """Return all rows, the first two (initial state, interval) and the size of a count in SI, shape (6,)."""
    table = read_numbers(path, LAYOUT)
    if len(table.values) < HEAD_ROWS + 2:
        raise InputError(
            f"{path}: {HEAD_ROWS} rows of header and at least 2 of counts are needed, got {len(table.values)}"
        )
    state, factors = table.values[:2], table.values[2]
    interval, g = state[1, 4:]
    rules = [
        (1, 5, "the interval (ms) must be positive", 0 < interval < np.inf, interval),
        (1, 6, "g must be between 9.7 and 9.9 m/s^2", 9.7 < g < 9.9, g),
        (1, 1, "the latitude must be within +-90 deg", abs(state[1, 0]) <= 90, state[1, 0]),
        *((2, k + 1, "a scale factor must be positive", 0 < factors[k] < np.inf, factors[k]) for k in range(6)),
    ]
    for row, column, rule, kept, value in rules:
        if not kept:
            raise InputError(f"{path}, {table.where(row)}, column {column}: {rule}, got {value:g}")
    return table, state, _scale(factors, g)


def _scale(factors: Array, g: float) -> Array:
    """Return the size of a count, rad and m/s, shape (6,), of factors in arcsec and micro-g s."""
    return factors * np.repeat([ARCSEC, 1e-6 * g], 3)
