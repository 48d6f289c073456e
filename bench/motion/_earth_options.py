"""What motions on the Earth share in checking where they start."""

import math
from typing import Any

import numpy as np

from bench.earth import Earth, require_latitude
from bench.errors import Array, InputError, require_instance, require_scalar

NEAR_POLE = 1e-6  # rad; 6 m, where a longitude no longer describes a path


def check_place(earth: Any, latitude: Any, longitude: Any, height: Any, *, poles: bool = True) -> None:
    """Check a geodetic place on an Earth, rad and m, and that it is not at a pole unless `poles`.

    Raises
    ------
    InputError
        If a value is not finite, the latitude or longitude out of range, or `earth` not an Earth.
    """
    check_earth(earth)
    require_latitude(require_scalar("latitude", latitude))
    if not poles:
        check_off_poles("latitude", np.array([latitude]))
    if abs(require_scalar("longitude", longitude)) > 2 * math.pi:
        raise InputError(f"longitude must be within +-2 pi rad, got {longitude!r} (degrees?)")
    require_scalar("height", height)


def check_earth(earth: Any) -> None:
    """Check that an option is an Earth.

    Raises
    ------
    InputError
        Otherwise.
    """
    require_instance("earth", earth, Earth)


def check_off_poles(name: str, latitude: Array) -> None:
    """Check that latitudes, rad, stay `NEAR_POLE` away from the poles.

    Raises
    ------
    InputError
        Otherwise.
    """
    nearest = float(np.abs(latitude).max())
    if nearest > math.pi / 2 - NEAR_POLE:
        raise InputError(f"{name} must stay {NEAR_POLE:g} rad away from the poles, got {nearest!r} rad")
