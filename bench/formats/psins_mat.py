"""PSINS .mat files: matrices of increments or rates with times, and of attitude, velocity and position as reference."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from bench.earth import Earth
from bench.errors import Array, InputError, require_choice
from bench.formats import Format, RawImu
from bench.formats._reference import Where, geodetic_reference
from bench.formats._times import NANOSECOND
from bench.recording import KINDS, Recording
from bench.rotation import euler_from_quat, quat_from_euler
from bench.trajectory import NavigationInitial, Trajectory

IMU_COLUMNS = 7  # gyro x, y, z, accelerometer x, y, z, t
AVP_COLUMNS = 10  # pitch, roll, yaw, v east, north, up, latitude, longitude, height, t


@dataclass(frozen=True)
class PsinsMat(Format):
    """PSINS .mat: an (n, 7) matrix of increments or rates and t, RFU; an (n, 10) matrix avp as reference.

    Columns of avp: pitch, roll, yaw (rad, yaw anticlockwise from north), velocity east, north, up (m/s), latitude,
    longitude (rad), height (m), t (s). One matrix a file is written; values are kept to the bit, a reference to
    rounding. Files of MATLAB up to v7 (``save -v7``); v7.3 is HDF5 and not read.

    Parameters
    ----------
    imu : str
        Name of the matrix with gyro, accelerometer and t.
    kind : {"increments", "rates"}
        What it holds: rad and m/s over the interval that ends at t, or rad/s and m/s^2.
    avp : str
        Name of the matrix with the reference.
    """

    name: ClassVar[str] = "psins-mat"
    suffixes: ClassVar[tuple[str, ...]] = (".mat",)

    axes: str = "RFU"
    imu: str = ""
    kind: str = ""
    avp: str = ""

    def _check_options(self) -> None:
        if self.kind != "":
            require_choice("kind", self.kind, KINDS)

    def _declared_kind(self) -> str:
        if self.kind == "":
            raise InputError(f"kind must be declared for psins-mat: one of {', '.join(KINDS)}")
        return self.kind

    def _read_imu(self, path: Path) -> RawImu:
        kind = self._declared_kind()
        table = _matrix(path, "imu", self.imu, IMU_COLUMNS)
        return RawImu(table[:, 6], table[:, :6], kind, _row_of(self.imu))

    def _write_imu(self, path: Path, recording: Recording, initial: NavigationInitial | None) -> None:
        if recording.kind != self._declared_kind():
            raise InputError(
                f"kind is declared as {self.kind}, the recording holds {recording.kind}: declare it so, or convert it "
                "(as_increments(rule), as_mean_rates())"
            )
        t = recording.t + recording.epoch_ns * NANOSECOND
        _save(path, "imu", self.imu, np.column_stack([*self._sensed(recording), t]))

    def _read_reference(self, path: Path, earth: Earth, epoch_ns: int) -> Trajectory:
        table = _matrix(path, "avp", self.avp, AVP_COLUMNS)
        pitch, roll, yaw = table[:, :3].T
        t = table[:, 9] - epoch_ns * NANOSECOND
        q_nb = quat_from_euler(yaw, pitch, roll)
        latitude, longitude, height = table[:, 6:9].T
        return geodetic_reference(path, earth, t, q_nb, table[:, 3:6], (latitude, longitude, height), _row_of(self.avp))

    def _write_reference(self, path: Path, trajectory: Trajectory, epoch_ns: int) -> None:
        psi, P, R = euler_from_quat(trajectory.q_nb)
        position = [trajectory.latitude, trajectory.longitude, trajectory.height]
        t = trajectory.t + epoch_ns * NANOSECOND
        _save(path, "avp", self.avp, np.column_stack([P, R, psi, trajectory.v_n, *position, t]))


def _row_of(name: str) -> Where:
    """Return what names row k in messages, counted from 1 as in MATLAB."""
    return lambda k: f"row {k + 1} of {name}"


def _matrix(path: Path, option: str, name: str, columns: int) -> Array:
    """Return a matrix of a file, shape (n, columns)."""
    from scipy.io import loadmat

    try:
        contents: dict[str, Any] = loadmat(path, appendmat=False)
    except NotImplementedError:
        raise InputError(f"{path}: MATLAB v7.3 (HDF5) is not read; save it with -v7") from None
    except Exception as error:  # a damaged file leads scipy to almost any
        raise InputError(f"{path}: not a MATLAB file, or truncated: {error}") from None
    shapes = {key: np.shape(value) for key, value in contents.items() if not key.startswith("__")}
    listed = ", ".join(f"{key} {shape}" for key, shape in shapes.items()) or "nothing"
    if name not in shapes:
        asked = f"got {name!r}" if name else "none is declared"
        raise InputError(f"{option} must name a matrix of {path}, {asked}; it holds {listed}")
    table = np.asarray(contents[name])
    if table.dtype.kind not in "fiu" or table.ndim != 2 or table.shape[1] != columns or len(table) == 0:
        raise InputError(
            f"{option} must name a real matrix of {columns} columns in {path}, {name} is {table.dtype} {table.shape}; "
            f"it holds {listed}"
        )
    return np.ascontiguousarray(table, dtype=np.float64)


def _save(path: Path, option: str, name: str, table: Array) -> None:
    from scipy.io import savemat

    if not name.isidentifier() or name.startswith("_"):
        raise InputError(f"{option} must be declared: the name of the matrix to write, got {name!r}")
    savemat(path, {name: table}, appendmat=False, do_compression=True)
