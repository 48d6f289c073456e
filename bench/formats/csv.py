"""CSV and other text with declared columns and units, with or without a header; reference trajectories too."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from bench.earth import Earth
from bench.errors import Array, InputError, require_choice, require_flag, require_integer
from bench.formats import Format, RawImu
from bench.formats._columns import DELIMITERS, IGNORED, Columns, Timed, read_columns
from bench.formats._reference import geodetic_reference
from bench.formats._text import write_numbers
from bench.formats._times import NANOSECOND, nanoseconds
from bench.formats._units import ANGLE, ANGULAR, LENGTH, SPECIFIC, SPEED, TIME, Unit, kind_of
from bench.recording import Recording
from bench.rotation import euler_from_quat, quat_from_euler, wrap
from bench.table import Column
from bench.trajectory import NavigationInitial, Trajectory

GYRO = ("gx", "gy", "gz")
ACCELEROMETER = ("ax", "ay", "az")
ANGLES = ("lat", "lon", "roll", "pitch", "heading", "yaw")
SPEEDS = ("vn", "ve", "vd", "vu")
IMU = (("t",), *((key,) for key in GYRO + ACCELEROMETER))
REFERENCE = (
    *(("t",), ("lat",), ("lon",), ("h",)),
    *(("vn",), ("ve",), ("vd", "vu")),
    *(("roll",), ("pitch",), ("heading", "yaw")),
)


@dataclass(frozen=True)
class Csv(Format):
    """CSV: columns and units as declared; whether it holds rates or increments follows from the units.

    Parameters
    ----------
    columns : str
        What the columns of an IMU file hold: t, gx, gy, gz (gyro along the sensor's x, y, z), ax, ay, az
        (accelerometer), between commas. With a header in any order, as ``key`` or ``key=name in the header``; without
        one all columns in their order, ``-`` for one that is not read.
    time_unit : {"s", "ms", "us", "ns"}
        s, ms, us or ns. ns are integers; too long ones give the recording an `epoch_ns`.
    angular_unit : {"rad/s", "mrad/s", "deg/s", "deg/h"} or {"rad", "mrad", "deg", "arcsec"}
        Of rates: rad/s, mrad/s, deg/s or deg/h. Of increments over the interval that ends at t: rad, mrad, deg or
        arcsec.
    specific_unit : {"m/s^2", "g", "mg", "ft/s^2"} or {"m/s", "g*s", "ft/s"}
        Of rates: m/s^2, g, mg or ft/s^2. Of increments: m/s, g*s or ft/s. g is 9.80665 m/s^2.
    reference_columns : str
        As `columns`, of a file with a reference: t, lat, lon, h, vn, ve, vd or vu, roll, pitch, heading (clockwise from
        north) or yaw (anticlockwise). Roll and pitch are the aerospace angles, h in m, velocities in m/s.
    angle_unit : {"rad", "deg"}
        rad or deg, of the reference's latitude, longitude, roll, pitch, heading or yaw.
    header : bool
        The first line holds the names; a unit in brackets behind a name must agree with the declared one.
    delimiter : {",", ";", "tab", "space"}
        The character, or the word tab or space; "space" is any white space.
    skip : int
        Lines to skip before the header or the first row.
    """

    name: ClassVar[str] = "csv"
    suffixes: ClassVar[tuple[str, ...]] = (".csv", ".txt")

    columns: str = ""
    time_unit: str = ""
    angular_unit: str = ""
    specific_unit: str = ""
    reference_columns: str = ""
    angle_unit: str = ""
    header: bool = True
    delimiter: str = ","
    skip: int = 0

    def _check_options(self) -> None:
        require_flag("header", self.header)
        require_choice("delimiter", self.delimiter, DELIMITERS)
        require_integer("skip", self.skip, minimum=0)

    def _imu_columns(self) -> tuple[Columns, str]:
        """Return the declared columns of an IMU file, and whether they hold rates or increments."""
        kind = kind_of(self.angular_unit, self.specific_unit)
        units = {"t": Unit.declared("time_unit", self.time_unit, TIME)}
        units |= dict.fromkeys(GYRO, Unit.declared("angular_unit", self.angular_unit, ANGULAR[kind]))
        units |= dict.fromkeys(ACCELEROMETER, Unit.declared("specific_unit", self.specific_unit, SPECIFIC[kind]))
        return Columns.parse("columns", self.columns, IMU, units), kind

    def _reference_columns(self) -> Columns:
        units = {"t": Unit.declared("time_unit", self.time_unit, TIME), "h": Unit.declared("h", "m", LENGTH)}
        units |= dict.fromkeys(ANGLES, Unit.declared("angle_unit", self.angle_unit, ANGLE))
        units |= dict.fromkeys(SPEEDS, Unit.declared("velocity", "m/s", SPEED))
        return Columns.parse("reference_columns", self.reference_columns, REFERENCE, units)

    def _read_imu(self, path: Path) -> RawImu:
        columns, kind = self._imu_columns()
        t, data, where, epoch_ns = self._read(path, columns)
        values = np.stack([data[key] for key in GYRO + ACCELEROMETER], axis=1)
        return RawImu(t, values, kind, where, epoch_ns)

    def _write_imu(self, path: Path, recording: Recording, initial: NavigationInitial | None) -> None:
        columns, kind = self._imu_columns()
        if recording.kind != kind:
            raise InputError(
                f"the declared units are of {kind}, the recording holds {recording.kind}: declare other units, "
                "or convert it (as_increments(rule), as_mean_rates())"
            )
        data = dict(zip(GYRO + ACCELEROMETER, np.hstack(self._sensed(recording)).T, strict=True))
        self._write(path, columns, recording.t, data, recording.epoch_ns)

    def _read_reference(self, path: Path, earth: Earth, epoch_ns: int) -> Trajectory:
        t, data, where, _ = self._read(path, self._reference_columns(), epoch_ns)
        psi = data["yaw"] if "yaw" in data else -data["heading"]
        up = data["vu"] if "vu" in data else -data["vd"]
        q_nb = quat_from_euler(psi, data["pitch"], data["roll"])
        v_n = np.stack([data["ve"], data["vn"], up], axis=1)
        return geodetic_reference(path, earth, t, q_nb, v_n, (data["lat"], data["lon"], data["h"]), where)

    def _write_reference(self, path: Path, trajectory: Trajectory, epoch_ns: int) -> None:
        psi, P, R = euler_from_quat(trajectory.q_nb)
        east, north, up = trajectory.v_n.T
        data = {"lat": trajectory.latitude, "lon": trajectory.longitude, "h": trajectory.height}
        data |= {"vn": north, "ve": east, "vd": -up, "vu": up}
        data |= {"roll": R, "pitch": P, "heading": wrap(-psi), "yaw": psi}
        self._write(path, self._reference_columns(), trajectory.t, data, epoch_ns)

    def _read(self, path: Path, columns: Columns, epoch_ns: int | None = None) -> Timed:
        return read_columns(path, columns, self.delimiter, header=self.header, skip=self.skip, epoch_ns=epoch_ns)

    def _write(self, path: Path, columns: Columns, t: Array, data: dict[str, Array], epoch_ns: int) -> None:
        if IGNORED in columns.keys:
            raise InputError("columns to write must all be declared: '-' has no contents")
        found: dict[str, Column] = {key: column / columns.units[key].size for key, column in data.items()}
        if columns.units["t"].name == "ns":
            found["t"] = nanoseconds(t, epoch_ns)
        else:
            found["t"] = (t + epoch_ns * NANOSECOND) / columns.units["t"].size
        head = [columns.head(self.delimiter)] if self.header else []
        write_numbers(path, head, [found[key] for key in columns.keys], DELIMITERS[self.delimiter] or " ")
