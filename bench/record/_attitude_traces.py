"""The plots of an attitude run: errors of every estimate at its own times; knows no viewer."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.errors import Array, InputError, require_times, require_unit_quaternion
from bench.evaluation import attitude_error, euler_error
from bench.record.traces import FLOOR, Colour, Trace, estimate_colours
from bench.units import ARCSEC

ANGLES = ("pitch", "roll", "yaw")
OVERVIEW = 500  # rows from which range and legend of a plot follow


@dataclass(frozen=True, eq=False)
class AttitudeEstimate:
    """The attitude of one algorithm beside the truth, at the algorithm's own update times.

    Attributes
    ----------
    t : ndarray, shape (u,), s
    q, q_true : ndarray, shape (u, 4)
        Estimated and true q_ib (or q_nb), wxyz, unit.

    Raises
    ------
    InputError
        If the times do not increase, a quaternion is not unit, or the numbers of rows differ.
    """

    t: Array
    q: Array
    q_true: Array

    def __post_init__(self) -> None:
        require_times("t", self.t)
        for name, q in (("q", self.q), ("q_true", self.q_true)):
            if len(require_unit_quaternion(name, q, (None, 4))) != len(self.t):
                raise InputError(f"{name} must have one row per time, {len(self.t)}, got {len(q)}")

    @property
    def error(self) -> Array:
        """Rotation vector from the true to the estimated attitude, in i (or n), shape (u, 3), rad."""
        return attitude_error(self.q, self.q_true)


@dataclass(frozen=True, eq=False)
class Plot:
    """Lines with their own times in one pair of axes.

    Attributes
    ----------
    overview : Trace
        All lines at a few of their rows: gives the place, the title, the range and the legend's corner.
    lines : tuple of Trace
        One per estimate, stored below the overview's entity.
    """

    overview: Trace
    lines: tuple[Trace, ...]


def attitude_plots(estimates: Mapping[str, AttitudeEstimate], entity_names: Mapping[str, str]) -> dict[str, Plot]:
    """Return the plots of the errors, by the end of their entity.

    Parameters
    ----------
    estimates : mapping of str to AttitudeEstimate
    entity_names : mapping of str to str
        Of the estimates.

    Returns
    -------
    dict of str to Plot
        ``rotation``; ``pitch``, ``roll``, ``yaw``; ``largest_pitch``, ``largest_roll``, ``largest_yaw``.
    """
    colours = estimate_colours(estimates)
    sizes, angles, largest = {}, {}, {}
    for name, estimate in estimates.items():
        sizes[name] = _log10(np.linalg.norm(estimate.error, axis=1) / ARCSEC)
        angles[name] = euler_error(estimate.q, estimate.q_true)[:, [1, 2, 0]] / ARCSEC
        largest[name] = _log10(np.maximum.accumulate(np.abs(angles[name]), axis=0))

    def plot(key: str, title: str, values: Mapping[str, Array], *, logarithmic: bool) -> Plot:
        entity = f"error/{key}"
        lines = tuple(
            _line(f"{entity}/{entity_names[name]}", title, name, colours[name], values[name], logarithmic)
            for name in estimates
        )
        few = [line.values[np.linspace(0, len(line.values) - 1, OVERVIEW).astype(int)] for line in lines]
        shown = Trace(
            entity, title, tuple(estimates), tuple(colours.values()), np.concatenate(few, axis=1), logarithmic
        )
        return Plot(shown, lines)

    plots = {"rotation": plot("rotation", "log10 of rotation-vector error, arcsec", sizes, logarithmic=True)}
    for k, angle in enumerate(ANGLES):
        linear = {name: values[:, k] for name, values in angles.items()}
        plots[angle] = plot(angle, f"{angle.capitalize()} error, arcsec", linear, logarithmic=False)
        so_far = {name: values[:, k] for name, values in largest.items()}
        title = f"log10 of largest {angle} error so far, arcsec"
        plots[f"largest_{angle}"] = plot(f"largest_{angle}", title, so_far, logarithmic=True)
    return plots


def _line(entity: str, title: str, name: str, colour: Colour, values: Array, logarithmic: bool) -> Trace:
    return Trace(entity, title, (name,), (colour,), values[:, None], logarithmic)


def _log10(error: Array) -> Array:
    return np.log10(np.maximum(error, FLOOR))
