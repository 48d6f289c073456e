"""A start that the recording's own file holds."""

from dataclasses import dataclass
from typing import ClassVar

from bench.starts import Beginning, Given, Start


@dataclass(frozen=True)
class StartHeader(Start):
    """The state that the recording's own file holds (PSINS .imu)."""

    name: ClassVar[str] = "header"

    def find(self, given: Given) -> Beginning:
        """Return the state in the header."""
        return Beginning(0, given.header(), "header of the recording")
