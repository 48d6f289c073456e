"""KF-GINS text: GPS seconds of week, angle and velocity increments; reference as .nav (north-east-down, degrees)."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from bench.earth import Earth
from bench.errors import InputError
from bench.formats import Format, RawImu
from bench.formats._reference import geodetic_reference
from bench.formats._text import Layout, read_numbers, write_numbers
from bench.formats._times import NANOSECOND
from bench.frames import aerospace_from_quat, quat_from_aerospace, swap_enu_ned
from bench.recording import Recording
from bench.trajectory import NavigationInitial, Trajectory
from bench.units import DEG

WEEK = 604800.0  # s

IMU = Layout(("seconds of week", "dtheta x", "dtheta y", "dtheta z", "dvel x", "dvel y", "dvel z"))
NAV = Layout(
    (
        "week",
        "seconds of week",
        "latitude",
        "longitude",
        "height",
        "v north",
        "v east",
        "v down",
        "roll",
        "pitch",
        "yaw",
    )
)


@dataclass(frozen=True)
class KfGins(Format):
    """KF-GINS text: time (s), dtheta (rad), dvel (m/s) in forward-right-down; .nav as reference.

    Seven columns between white space; the increments are over the interval that ends at the time. The reference has
    eleven: week, seconds of week, latitude, longitude (deg), height (m), velocity north, east, down (m/s), roll, pitch,
    yaw (deg, aerospace 3-2-1, yaw clockwise from north). Increments are kept to the bit; a reference to rounding. Times
    go on over the end of the week.
    """

    name: ClassVar[str] = "kf-gins"
    suffixes: ClassVar[tuple[str, ...]] = (".txt", ".imu")

    axes: str = "FRD"

    def _check_options(self) -> None:
        """Nothing to check: it adds none."""

    def _read_imu(self, path: Path) -> RawImu:
        table = read_numbers(path, IMU)
        second = table.values[:, 0]
        new_week = np.diff(second, prepend=second[0]) < -0.5 * WEEK
        return RawImu(second + WEEK * np.cumsum(new_week), table.values[:, 1:], "increments", table.where)

    def _write_imu(self, path: Path, recording: Recording, initial: NavigationInitial | None) -> None:
        if recording.kind != "increments":
            raise InputError("kf-gins files hold increments: write recording.as_increments(rule)")
        t = recording.t + recording.epoch_ns * NANOSECOND
        angular, specific = self._sensed(recording)
        write_numbers(path, (), [t, *angular.T, *specific.T], " ")

    def _read_reference(self, path: Path, earth: Earth, epoch_ns: int) -> Trajectory:
        table = read_numbers(path, NAV)
        week, second, latitude, longitude, height, *_, roll, pitch, yaw = table.values.T
        t = second + WEEK * (week - week[0]) - epoch_ns * NANOSECOND
        q_nb = quat_from_aerospace(roll * DEG, pitch * DEG, yaw * DEG)
        position = (latitude * DEG, longitude * DEG, height)
        return geodetic_reference(path, earth, t, q_nb, swap_enu_ned(table.values[:, 5:8]), position, table.where)

    def _write_reference(self, path: Path, trajectory: Trajectory, epoch_ns: int) -> None:
        position = [trajectory.latitude / DEG, trajectory.longitude / DEG, trajectory.height]
        attitude = [angle / DEG for angle in aerospace_from_quat(trajectory.q_nb)]
        t = trajectory.t + epoch_ns * NANOSECOND
        week = np.zeros(len(t), dtype=int)
        write_numbers(path, (), [week, t, *position, *swap_enu_ned(trajectory.v_n).T, *attitude], " ")
