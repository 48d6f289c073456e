"""Starts by alignment: a first stretch of the recording, standing or swaying, gives the attitude at its end."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from bench.errors import InputError, require_scalar
from bench.starts import Beginning, Given, Start, check_place
from bench.units import DEG, DEG_PER_H, MICRO_G

if TYPE_CHECKING:
    from bench.alignment import Alignment


@dataclass(frozen=True)
class StartAlign(Start):
    """Base of the alignments: a first stretch, at a known place, gives the attitude at its end; there it starts."""

    seconds: float
    """Length of the stretch."""
    latitude_deg: float
    """Geodetic latitude."""
    longitude_deg: float
    """Longitude, east positive."""
    height_m: float
    """Height above the ellipsoid."""
    gyro_sigma_deg_per_h: float = 0.0
    """Expected constant error of each gyro (1 sigma), as its data sheet gives it."""
    accelerometer_sigma_micro_g: float = 0.0
    """Expected constant error of each accelerometer (1 sigma)."""
    heading_limit_deg: float = 6.0
    """Largest expected error of the heading that is accepted."""

    def __post_init__(self) -> None:
        require_scalar("seconds", self.seconds, positive=True)
        check_place(self.latitude_deg, self.longitude_deg, self.height_m)
        for name in ("gyro_sigma_deg_per_h", "accelerometer_sigma_micro_g"):
            require_scalar(name, getattr(self, name), minimum=0.0)
        require_scalar("heading_limit_deg", self.heading_limit_deg, positive=True)

    @abstractmethod
    def _align(self, *data: Any, **expected: Any) -> "Alignment":
        """Return the alignment of increments, dt and place."""

    def find(self, given: Given) -> Beginning:
        """Return the attitude at the end of the stretch, at rest."""
        made = given.increments
        k = round(self.seconds / made.dt)
        if not 0 < k < len(made):
            raise InputError(
                f"seconds must be a stretch within the recording of {len(made) * made.dt:.6g} s, got {self.seconds!r}"
            )
        place = (self.latitude_deg * DEG, self.longitude_deg * DEG, float(self.height_m), given.earth)
        found = self._align(
            *(made.angular[:k], made.specific[:k], made.dt, *place),
            gyro_bias=self.gyro_sigma_deg_per_h * DEG_PER_H,
            accelerometer_bias=self.accelerometer_sigma_micro_g * MICRO_G,
            heading_limit=self.heading_limit_deg * DEG,
        )
        note = (
            f"{self.name} alignment over {k * made.dt:.6g} s, expected error of tilt {found.sigma_tilt / DEG:.2g} deg"
        )
        return Beginning(k, found.initial, f"{note}, of heading {found.sigma_heading / DEG:.2g} deg (1 sigma)")


@dataclass(frozen=True)
class StartCoarse(StartAlign):
    """Coarse alignment of a unit at rest; the velocity at the end is taken as zero."""

    name: ClassVar[str] = "coarse"

    heading_deg: float | None = None
    """Heading that is known from elsewhere, clockwise from north; then only the vertical is found."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.heading_deg is not None:
            require_scalar("heading_deg", self.heading_deg)

    def _align(self, *data: Any, **expected: Any) -> "Alignment":
        from bench.alignment import coarse_alignment

        psi = None if self.heading_deg is None else -self.heading_deg * DEG
        return coarse_alignment(*data, psi=psi, **expected)


@dataclass(frozen=True)
class StartInertial(StartAlign):
    """Alignment in the inertial frame, of a unit that stands or sways; the velocity at the end is taken as zero."""

    name: ClassVar[str] = "inertial"

    def _align(self, *data: Any, **expected: Any) -> "Alignment":
        from bench.alignment import inertial_alignment

        return inertial_alignment(*data, **expected)
