"""Units that files declare, and which of them belong to rates and which to increments."""

from dataclasses import dataclass

from bench.errors import InputError, require_choice
from bench.units import ARCSEC, DEG, DEG_PER_H, DEG_PER_S, FOOT, KM_PER_H, KNOT, MILLI_G, STANDARD_GRAVITY

TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
ANGLE = {"rad": 1.0, "deg": DEG}
ANGULAR = {
    "rates": {"rad/s": 1.0, "mrad/s": 1e-3, "deg/s": DEG_PER_S, "deg/h": DEG_PER_H},
    "increments": {"rad": 1.0, "mrad": 1e-3, "deg": DEG, "arcsec": ARCSEC},
}
SPECIFIC = {
    "rates": {"m/s^2": 1.0, "g": STANDARD_GRAVITY, "mg": MILLI_G, "ft/s^2": FOOT},
    "increments": {"m/s": 1.0, "g*s": STANDARD_GRAVITY, "ft/s": FOOT},
}
LENGTH = {"m": 1.0}
SPEED = {"m/s": 1.0, "km/h": KM_PER_H, "kn": KNOT}
_ALL = {unit for table in (TIME, LENGTH, SPEED, *ANGULAR.values(), *SPECIFIC.values()) for unit in table}
_SPELLINGS = {
    "m/s2": "m/s^2",
    "m/s/s": "m/s^2",
    "ft/s2": "ft/s^2",
    "dps": "deg/s",
    "µs": "us",
    "kph": "km/h",
    "kt": "kn",
}


@dataclass(frozen=True)
class Unit:
    """A declared unit: its name and its size in SI."""

    name: str
    size: float

    @classmethod
    def declared(cls, option: str, name: str, table: dict[str, float]) -> "Unit":
        """Return the unit that an option declares.

        Raises
        ------
        InputError
            If it is not declared, or unknown.
        """
        if name == "":
            raise InputError(f"{option} must be declared: one of {', '.join(table)}")
        return cls(name, table[require_choice(option, name, table)])


def kind_of(angular_unit: str, specific_unit: str) -> str:
    """Return "rates" or "increments", whichever both units belong to.

    Raises
    ------
    InputError
        If a unit is not declared or unknown, or one is a rate's and the other an increment's.
    """
    kinds = []
    for name, unit, tables in (("angular_unit", angular_unit, ANGULAR), ("specific_unit", specific_unit, SPECIFIC)):
        Unit.declared(name, unit, {known: size for table in tables.values() for known, size in table.items()})
        kinds.append(next(kind for kind, table in tables.items() if unit in table))
    if kinds[0] != kinds[1]:
        raise InputError(
            f"angular_unit {angular_unit!r} is of {kinds[0]}, specific_unit {specific_unit!r} of {kinds[1]}: a "
            "recording holds either rates (rad/s, m/s^2) or increments (rad, m/s); correct the unit that is wrong"
        )
    return kinds[0]


def recognised(text: str) -> str | None:
    """Return the unit that a header means, in our spelling, or None if it is none of ours."""
    unit = text.strip().replace("°", "deg").replace("²", "^2").replace("·", "*")
    unit = unit.replace(" s^-1", "/s").replace(" s^-2", "/s^2").replace(" ", "")
    unit = _SPELLINGS.get(unit, unit)
    return unit if unit in _ALL else None
