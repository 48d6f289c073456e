"""A start given in numbers, on the command line or in a JSON or TOML file."""

import json
import tomllib
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, ClassVar

from bench.errors import InputError, require_array, require_scalar
from bench.rotation import quat_from_euler
from bench.starts import Beginning, Given, Start, check_place
from bench.trajectory import NavigationInitial
from bench.units import DEG


@dataclass(frozen=True)
class StartValues(Start):
    """The state at the start of the recording, in numbers."""

    name: ClassVar[str] = "values"

    latitude_deg: float
    """Geodetic latitude."""
    longitude_deg: float
    """Longitude, east positive."""
    height_m: float
    """Height above the ellipsoid."""
    velocity_enu: tuple[float, float, float]
    """Velocity east, north, up, m/s."""
    heading_deg: float
    """Direction of the body's forward axis, clockwise from north (not the anticlockwise yaw)."""
    pitch_deg: float
    """Forward axis above the horizon."""
    roll_deg: float
    """About the forward axis, right side down."""

    def __post_init__(self) -> None:
        check_place(self.latitude_deg, self.longitude_deg, self.height_m)
        for name in ("heading_deg", "pitch_deg", "roll_deg"):
            require_scalar(name, getattr(self, name))
        if abs(self.pitch_deg) > 90:
            raise InputError(f"pitch_deg must be within +-90, got {self.pitch_deg!r}")
        require_array("velocity_enu", self.velocity_enu, (3,))

    @property
    def initial(self) -> NavigationInitial:
        """The state."""
        return NavigationInitial(
            quat_from_euler(-self.heading_deg * DEG, self.pitch_deg * DEG, self.roll_deg * DEG),
            self.velocity_enu,
            latitude=self.latitude_deg * DEG,
            longitude=self.longitude_deg * DEG,
            height=float(self.height_m),
        )

    def find(self, given: Given) -> Beginning:
        """Return the values."""
        return Beginning(0, self.initial, "given values, at the start of the recording")


@dataclass(frozen=True)
class StartFile(Start):
    """The state at the start of the recording, from a JSON or TOML file with the names of `StartValues`."""

    name: ClassVar[str] = "file"

    file: Path

    def __post_init__(self) -> None:
        _ = self.values

    @property
    def values(self) -> StartValues:
        """What the file holds.

        Raises
        ------
        InputError
            If it is missing, not JSON or TOML, or a value is missing, unknown or breaks a rule.
        """
        where = f"initial {str(self.file)!r}"
        found = _read(self.file, where)
        known = [f.name for f in fields(StartValues)]
        wrong = [name for name in known if name not in found] + [name for name in found if name not in known]
        if wrong:
            trouble = "misses" if wrong[0] in known else "has an unknown"
            raise InputError(f"{where} {trouble} {wrong[0]!r}; it must hold {', '.join(known)}")
        try:
            return StartValues(**found)
        except InputError as error:
            raise InputError(f"{where}: {error}") from None

    def find(self, given: Given) -> Beginning:
        """Return the values in the file."""
        return Beginning(0, self.values.initial, f"values in {self.file}, at the start of the recording")


def _read(path: Path, where: str) -> dict[str, Any]:
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{where} cannot be read: {error}") from None
    try:
        found = tomllib.loads(text) if path.suffix == ".toml" else json.loads(text)
    except ValueError as error:
        raise InputError(f"{where} must be TOML (.toml) or JSON: {error}") from None
    if not isinstance(found, dict):
        raise InputError(f"{where} must hold names and values, got {found!r}")
    return found
