"""File formats of recordings: one file each, found by discovery; reading gives SI and right-forward-up, always.

A format is a frozen dataclass of options::

    recording = file_format("kf-gins", rate=200.0).read_imu("imu.txt")
    file_format("euroc", axes="FLU").write_imu("data.csv", recording.as_mean_rates())

Nothing is guessed: what a format does not fix (axes, units, rates or increments) must be declared, and
what is declared is checked against the file. Files are written whole or not at all, and replaced only by force.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, ClassVar, final

from bench._timestamps import check_times, require_tolerances
from bench.earth import WGS84, Earth
from bench.errors import Array, InputError, OutputError, require_choice, require_flag, require_instance, require_scalar
from bench.formats._raw import RawImu, filled, require_plausible, within, without_repeats
from bench.frames import axes_matrix, from_rfu, to_rfu
from bench.recording import Recording, require_finite_rows
from bench.registry import discover
from bench.table import replacing
from bench.trajectory import NavigationInitial, Trajectory


@dataclass(frozen=True)
class Format(ABC):
    """Base of the file formats: options and checks that all have in common.

    A format declares ``name`` and ``suffixes`` and defines `_check_options`, `_read_imu` and `_write_imu`; if it has a
    reference trajectory also `_read_reference` and `_write_reference`; if it has an initial state, `_read_initial`.

    Parameters
    ----------
    axes : str
        Where the sensor's x, y and z axes point, such as "RFU", "FRD", "FLU" (see `bench.frames`). Must be declared
        where the format does not fix it.
    rate : float, Hz, optional
        Declared sampling rate; refused if the times tell another one.
    jitter : float
        Accepted deviation of an interval from the nominal one, as a part of it.
    longest_gap : float, s
        Gaps up to this long are filled by linear interpolation; 0 refuses every gap.
    drop_repeats : bool
        Drop rows that are the same as the row before, time and values.
    start : float, s, optional
        Read only rows with t >= start, s, t as in the recording.
    stop : float, s, optional
        Read only rows with t <= stop, s, t as in the recording.
    range_check : bool
        Refuse values that suggest another unit: rates above 100 rad/s, or a median specific force below 1.5 or above
        500 m/s^2.

    Raises
    ------
    InputError
        If an option is out of range.
    """

    name: ClassVar[str]
    suffixes: ClassVar[tuple[str, ...]]

    axes: str = ""
    rate: float | None = None
    jitter: float = 0.1
    longest_gap: float = 0.0
    drop_repeats: bool = False
    start: float | None = None
    stop: float | None = None
    range_check: bool = True

    def __post_init__(self) -> None:
        if self.axes != "":
            axes_matrix(self.axes)
        require_tolerances(self.jitter, self.longest_gap)
        if self.rate is not None:
            require_scalar("rate", self.rate, positive=True)
        for name in ("start", "stop"):
            if getattr(self, name) is not None:
                require_scalar(name, getattr(self, name))
        for name in ("drop_repeats", "range_check"):
            require_flag(name, getattr(self, name))
        self._check_options()

    @abstractmethod
    def _check_options(self) -> None:
        """Check the options that a format adds."""

    @abstractmethod
    def _read_imu(self, path: Path) -> RawImu:
        """Return the contents of an IMU file."""

    @abstractmethod
    def _write_imu(self, path: Path, recording: Recording, initial: NavigationInitial | None) -> None:
        """Write an IMU file; `initial` goes where the format has a place for it."""

    def _read_reference(self, path: Path, earth: Earth, epoch_ns: int) -> Trajectory:
        """Return the contents of a file with a reference trajectory."""
        raise InputError(f"{self.name} has no file of reference trajectories")

    def _write_reference(self, path: Path, trajectory: Trajectory, epoch_ns: int) -> None:
        """Write a file with a reference trajectory."""
        raise InputError(f"{self.name} has no file of reference trajectories")

    def _read_initial(self, path: Path) -> NavigationInitial:
        """Return the initial state that an IMU file holds."""
        raise InputError(f"{self.name} files hold no initial state; give it")

    @final
    def read_imu(self, path: str | Path) -> Recording:
        """Return the recording in a file, in SI and right-forward-up.

        Raises
        ------
        InputError
            If the file is missing, malformed or truncated (file, line and column), holds NaN, its times are not
            regular, or its values suggest another unit than declared; with the fix.
        """
        path, axes = existing_file(path), self._declared_axes()
        raw = self._read_imu(path)
        require_finite_rows(str(path), raw.t, where=raw.where)
        raw = within(raw, str(path), self.start, self.stop)
        require_finite_rows(str(path), raw.values, where=raw.where)
        if self.drop_repeats:
            raw = without_repeats(raw)
        dt = check_times(
            raw.t,
            raw.dt if self.rate is None else 1.0 / self.rate,
            source=str(path),
            jitter=self.jitter,
            longest_gap=self.longest_gap,
            where=raw.where,
        )
        if self.range_check:
            require_plausible(raw, dt, str(path))
        t, values = filled(raw, dt)
        return Recording(
            t,
            to_rfu(values[:, :3], axes),
            to_rfu(values[:, 3:], axes),
            raw.kind,
            dt,
            source=str(path),
            epoch_ns=raw.epoch_ns,
            jitter=self.jitter,
        )

    @final
    def write_imu(
        self,
        path: str | Path,
        recording: Recording,
        *,
        initial: NavigationInitial | None = None,
        force: bool = False,
    ) -> None:
        """Write a recording; `initial` is kept where the format has a place for it.

        Times are t with the epoch added: of 1e9 s a column of floats keeps 2e-7 s, one of nanoseconds all.

        Raises
        ------
        InputError
            If the format cannot hold such a recording.
        OutputError
            If the file exists and `force` is False, or cannot be written.
        """
        require_instance("recording", recording, Recording)
        _write(path, force, lambda temporary: self._write_imu(temporary, recording, initial))

    @final
    def read_reference(self, path: str | Path, earth: Earth = WGS84, *, epoch_ns: int = 0) -> Trajectory:
        """Return the reference trajectory in a file.

        Parameters
        ----------
        path : path
        earth : Earth
            Whose ellipsoid its latitudes and heights refer to.
        epoch_ns : int, ns
            What to subtract from the file's times; give the recording's, so that both have the same t.

        Raises
        ------
        InputError
            If the file is missing, malformed or truncated, its times do not increase, or the format has none.
        """
        return self._read_reference(existing_file(path), earth, epoch_ns)

    @final
    def write_reference(
        self, path: str | Path, trajectory: Trajectory, *, epoch_ns: int = 0, force: bool = False
    ) -> None:
        """Write a trajectory as a reference.

        Raises
        ------
        InputError
            If the format has none.
        OutputError
            If the file exists and `force` is False, or cannot be written.
        """
        require_instance("trajectory", trajectory, Trajectory)
        _write(path, force, lambda temporary: self._write_reference(temporary, trajectory, epoch_ns))

    @final
    def read_initial(self, path: str | Path) -> NavigationInitial:
        """Return the initial state that an IMU file of this format holds.

        Raises
        ------
        InputError
            If the format holds none, or as `read_imu`.
        """
        return self._read_initial(existing_file(path))

    def _declared_axes(self) -> str:
        if self.axes == "":
            raise InputError(
                f"axes must be declared for {self.name}: where the sensor's x, y, z point, such as 'RFU', 'FRD', 'FLU'"
            )
        return self.axes

    def _sensed(self, recording: Recording) -> tuple[Array, Array]:
        """Return angular and specific, shape (n, 3), along the sensor's axes."""
        axes = self._declared_axes()
        return from_rfu(recording.angular, axes), from_rfu(recording.specific, axes)


def existing_file(path: str | Path) -> Path:
    """Return a path if it is that of a file.

    Raises
    ------
    InputError
        Otherwise.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"path must be a file, got {str(path)!r}")
    return path


def _write(path: str | Path, force: bool, write: Callable[[Path], None]) -> None:
    path = Path(path)
    if not require_flag("force", force) and path.exists():
        raise OutputError(f"{path} exists; choose another name, or overwrite it by force")
    try:
        with replacing(path) as temporary:
            write(temporary)
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror or error}") from error


def formats() -> dict[str, type[Format]]:
    """Return the format classes, by name."""
    return discover("bench.formats", Format)


def file_format(name: str, **options: Any) -> Format:
    """Return a format by name, with its options set.

    Raises
    ------
    UnknownNameError
        If the name is unknown; it lists the valid ones.
    InputError
        If an option is unknown or its value breaks a rule.
    """
    found = formats()
    cls = found[require_choice("format", name, found)]
    known = [field.name for field in fields(cls)]
    for option in options:
        if option not in known:
            raise InputError(f"{name} has no option {option!r}; options: {', '.join(known)}")
    return cls(**options)
