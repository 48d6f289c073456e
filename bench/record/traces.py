"""The lines that a recording plots over time, as plain arrays with their names and colours; knows no viewer."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.errors import Array

Colour = tuple[int, int, int]

TIMELINE = "sim_time"
FLOOR = 1e-12  # smallest error on a logarithmic axis
AXES = ("x", "y", "z")

# Mid-tones, readable on a dark and on a light background.
TRUTH_COLOUR: Colour = (140, 146, 156)
AXIS_COLOURS: tuple[Colour, ...] = ((222, 74, 66), (60, 168, 92), (66, 126, 230))
ESTIMATE_COLOURS: tuple[Colour, ...] = (
    (235, 137, 32),
    (32, 160, 176),
    (176, 92, 204),
    (150, 150, 40),
    (214, 84, 140),
    (110, 110, 220),
    (64, 176, 132),
    (168, 112, 72),
    (96, 152, 48),
    (222, 110, 96),
    (84, 148, 214),
    (196, 150, 200),
)


@dataclass(frozen=True, eq=False)
class Trace:
    """One plot of lines over time.

    Attributes
    ----------
    entity : str
        Where it is stored.
    title : str
        With the unit.
    series : tuple of str
        Name of each line.
    colours : tuple of Colour
    values : ndarray, shape (n, len(series))
    logarithmic : bool
        Whether the values are log10 of an error.
    """

    entity: str
    title: str
    series: tuple[str, ...]
    colours: tuple[Colour, ...]
    values: Array
    logarithmic: bool = False

    def display_range(self) -> tuple[float, float]:
        """Return whole decades that hold the values, but for the lowest 2 %.

        Estimates begin at the truth: the first samples would squeeze all others into a strip.
        """
        low, high = np.floor(np.quantile(self.values, 0.02)), np.ceil(self.values.max())
        return float(low), float(max(high, low + 1.0))

    def empty_corner(self) -> str:
        """Return the corner where a legend hides least: LeftTop, LeftBottom, RightTop or RightBottom."""
        low, high = self.display_range() if self.logarithmic else (self.values.min(), self.values.max())
        height = (self.values - low) / max(high - low, np.finfo(float).tiny)
        n = len(height)
        sides = {"Right": height[-max(1, n // 5) :], "Left": height[: max(1, n // 5)]}
        covered = {
            f"{side}{edge}": float(np.mean(part < 0.4 if edge == "Bottom" else part > 0.6))
            for side, part in sides.items()
            for edge in ("Bottom", "Top")
        }
        return min(covered, key=lambda corner: covered[corner])


def estimate_colours(names: Mapping[str, object]) -> dict[str, Colour]:
    """Return one colour per estimate, in their order."""
    return {name: ESTIMATE_COLOURS[k % len(ESTIMATE_COLOURS)] for k, name in enumerate(names)}
