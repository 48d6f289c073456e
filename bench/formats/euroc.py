"""EuRoC/ASL CSV: rates with nanosecond stamps; ground truth in a local frame, placed on the Earth by declaration."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from bench.earth import Earth
from bench.errors import Array, InputError, require_scalar
from bench.formats import Format, RawImu
from bench.formats._reference import require_rows
from bench.formats._text import Layout, line_after, read_numbers, write_numbers
from bench.formats._times import nanoseconds, seconds
from bench.formats._units import recognised
from bench.frames import sensor_attitude
from bench.recording import Recording
from bench.rotation import quat_conjugate, quat_multiply, quat_normalize, quat_rotate
from bench.trajectory import NavigationInitial, Trajectory
from bench.units import DEG


def _cells(*groups: tuple[str, str]) -> tuple[str, ...]:
    return tuple(f"{name} [{unit}]" for name, unit in groups)


IMU_HEAD = _cells(
    ("#timestamp", "ns"),
    *((f"w_RS_S_{axis}", "rad s^-1") for axis in "xyz"),
    *((f"a_RS_S_{axis}", "m s^-2") for axis in "xyz"),
)
TRUTH_HEAD = _cells(
    ("#timestamp", "ns"),
    *((f"p_RS_R_{axis}", "m") for axis in "xyz"),
    *((f"q_RS_{axis}", "") for axis in "wxyz"),
    *((f"v_RS_R_{axis}", "m s^-1") for axis in "xyz"),
    *((f"b_w_RS_S_{axis}", "rad s^-1") for axis in "xyz"),
    *((f"b_a_RS_S_{axis}", "m s^-2") for axis in "xyz"),
)
_PLACE = ("origin_latitude_deg", "origin_longitude_deg", "origin_height", "x_azimuth_deg")
NORM_TOLERANCE = 1e-3  # of quaternions as printed; six digits are usual


@dataclass(frozen=True)
class Euroc(Format):
    """EuRoC/ASL data.csv: nanosecond integers, rates (rad/s, m/s^2); axes declared; local ground truth.

    Times are rounded to 1 ns when written; rates are kept to the bit. Stamps of 2^53 ns and more give the recording an
    `epoch_ns`. The ground truth (state_groundtruth_estimate0/data.csv) is in a local level frame R that is nowhere on
    the Earth: where it is must be declared to read or write one.

    Parameters
    ----------
    origin_latitude_deg, origin_longitude_deg : float, deg, optional
        Of the origin of R.
    origin_height : float, m, optional
    x_azimuth_deg : float, deg, optional
        Direction of the x axis of R, clockwise from north; its z axis points up at the origin.
    """

    name: ClassVar[str] = "euroc"
    suffixes: ClassVar[tuple[str, ...]] = (".csv",)

    origin_latitude_deg: float | None = None
    origin_longitude_deg: float | None = None
    origin_height: float | None = None
    x_azimuth_deg: float | None = None

    def _check_options(self) -> None:
        for name in _PLACE:
            if getattr(self, name) is not None:
                require_scalar(name, getattr(self, name))
        if abs(self.origin_latitude_deg or 0.0) > 90:
            raise InputError(f"origin_latitude_deg must be within +-90, got {self.origin_latitude_deg!r}")

    def _read_imu(self, path: Path) -> RawImu:
        table = read_numbers(path, _layout(path, IMU_HEAD))
        assert table.integers is not None
        t, epoch_ns = seconds(table.integers)
        return RawImu(t, table.values, "rates", table.where, epoch_ns)

    def _write_imu(self, path: Path, recording: Recording, initial: NavigationInitial | None) -> None:
        if recording.kind != "rates":
            raise InputError("euroc files hold rates: write recording.as_mean_rates(), and read with rule 'average'")
        angular, specific = self._sensed(recording)
        ticks = nanoseconds(recording.t, recording.epoch_ns)
        write_numbers(path, [",".join(IMU_HEAD)], [ticks, *angular.T, *specific.T], ",")

    def _read_reference(self, path: Path, earth: Earth, epoch_ns: int) -> Trajectory:
        origin, q_eR, q_Sb = self._local_frame(earth)
        table = read_numbers(path, _layout(path, TRUTH_HEAD))
        assert table.integers is not None
        t, _ = seconds(table.integers, epoch_ns)
        position, q_RS, velocity = table.values[:, :3], table.values[:, 3:7], table.values[:, 7:10]
        require_rows(path, t, table.values[:, :10], table.where)
        wrong = np.abs(np.linalg.norm(q_RS, axis=1) - 1) > NORM_TOLERANCE
        if wrong.any():
            k = int(np.argmax(wrong))
            norm = float(np.linalg.norm(q_RS[k]))
            raise InputError(f"{path}, {table.where(k)}: q_RS must be a unit quaternion, got norm {norm!r}")
        q_eS = quat_multiply(q_eR, quat_normalize(q_RS))
        q_eb = quat_normalize(quat_multiply(q_eS, q_Sb))
        return Trajectory(earth, t, q_eb, quat_rotate(q_eR, velocity), origin + quat_rotate(q_eR, position))

    def _write_reference(self, path: Path, trajectory: Trajectory, epoch_ns: int) -> None:
        origin, q_eR, q_Sb = self._local_frame(trajectory.earth)
        q_Re = quat_conjugate(q_eR)
        q_RS = quat_multiply(quat_multiply(q_Re, trajectory.q_eb), quat_conjugate(q_Sb))
        position, velocity = quat_rotate(q_Re, trajectory.r_e - origin), quat_rotate(q_Re, trajectory.v_e)
        biases = np.zeros((len(trajectory), 6))
        columns = [nanoseconds(trajectory.t, epoch_ns), *np.hstack([position, q_RS, velocity, biases]).T]
        write_numbers(path, [",".join(TRUTH_HEAD)], columns, ",")

    def _local_frame(self, earth: Earth) -> tuple[Array, Array, Array]:
        """Return the origin of R in e, the attitude of R in e, and that of the body (RFU) in the sensor's axes."""
        placed = [getattr(self, name) for name in _PLACE]
        if None in placed:
            raise InputError(
                f"{', '.join(_PLACE)} must be declared: EuRoC ground truth is in a local frame that says nothing of "
                "its place on the Earth"
            )
        latitude, longitude, height, azimuth = placed
        latitude, longitude = latitude * DEG, longitude * DEG
        half = 0.5 * (90.0 - azimuth) * DEG  # x of R, anticlockwise from east
        q_eR = quat_multiply(earth.q_en(latitude, longitude), [np.cos(half), 0.0, 0.0, np.sin(half)])
        q_Sb = quat_conjugate(sensor_attitude(self._declared_axes()))
        return earth.position(latitude, longitude, height), q_eR, q_Sb


def _layout(path: Path, head: tuple[str, ...]) -> Layout:
    """Return the layout of a file whose first line has these names, and no other units than these."""
    number, text = line_after(path, 0)
    cells = [cell.strip() for cell in text.split(",")]
    for k, expected in enumerate(head):
        cell = cells[k] if k < len(cells) else ""
        if _bare(cell) != _bare(expected) or _unit(cell) not in (None, _unit(expected)):
            raise InputError(
                f"{path}, line {number}, column {k + 1}: the header of an EuRoC file must have {expected!r} here, "
                f"got {cell!r}; the csv format reads files with declared columns and units"
            )
    if len(cells) > len(head):
        raise InputError(f"{path}, line {number}, column {len(head) + 1}: one too many: {cells[len(head)]!r}")
    return Layout(tuple(_bare(cell).lstrip("#") for cell in head), ",", "#", number, None, integers=True)


def _bare(cell: str) -> str:
    return cell.partition("[")[0].strip()


def _unit(cell: str) -> str | None:
    return recognised(cell.partition("[")[2].rstrip("]"))
