"""Where the navigation of a recording starts: one file per way of finding the initial state, found by discovery."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from bench.earth import Earth
from bench.errors import InputError, require_scalar
from bench.recording import Recording
from bench.registry import discover
from bench.trajectory import NavigationInitial, Trajectory


@dataclass(frozen=True, eq=False)
class Given:
    """What a start may be found from.

    Attributes
    ----------
    increments : Recording
    earth : Earth
    reference : Trajectory or None
    header : callable
        Returns the initial state in the recording's file, or raises an InputError if there is none.
    """

    increments: Recording
    earth: Earth
    reference: Trajectory | None
    header: Callable[[], NavigationInitial]


@dataclass(frozen=True, eq=False)
class Beginning:
    """The state before increment number `skipped`, and how it was found."""

    skipped: int
    initial: NavigationInitial
    note: str


class Start(ABC):
    """One way of finding the initial state; a frozen dataclass of options, from which the command line is made."""

    name: ClassVar[str]

    @abstractmethod
    def find(self, given: Given) -> Beginning:
        """Return the initial state and how many increments lie before it."""


def starts() -> dict[str, type[Start]]:
    """Return the ways of finding the initial state, by name."""
    return discover("bench.starts", Start)


def check_place(latitude_deg: Any, longitude_deg: Any, height_m: Any) -> None:
    """Check a geodetic place.

    Raises
    ------
    InputError
        If a value is not finite, or an angle out of range.
    """
    if abs(require_scalar("latitude_deg", latitude_deg)) > 90:
        raise InputError(f"latitude_deg must be within +-90, got {latitude_deg!r}")
    if abs(require_scalar("longitude_deg", longitude_deg)) > 360:
        raise InputError(f"longitude_deg must be within +-360, got {longitude_deg!r}")
    require_scalar("height_m", height_m)
