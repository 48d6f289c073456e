"""A start on the reference trajectory."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.errors import InputError
from bench.interpolation import SAME_TIME, sampled
from bench.starts import Beginning, Given, Start


@dataclass(frozen=True)
class StartReference(Start):
    """The reference's first row within the recording; increments before it are skipped."""

    name: ClassVar[str] = "reference"

    def find(self, given: Given) -> Beginning:
        """Return the reference at the boundary of increments nearest to its first row within the recording."""
        made, reference = given.increments, given.reference
        if reference is None:
            raise InputError("initial 'reference' needs a reference, got none")
        bounds = np.append(made.start, made.t)
        half = 0.5 * made.dt
        inside = np.flatnonzero((reference.t >= bounds[0] - half) & (reference.t < bounds[-1] - half))
        if not len(inside):
            raise InputError(
                f"initial 'reference' needs a reference with rows within the recording: its times are "
                f"{reference.t[0]} to {reference.t[-1]} s, the recording's {bounds[0]} to {bounds[-1]} s; "
                "are both in the same scale of time?"
            )
        row = int(inside[0])
        k = int(np.argmin(np.abs(bounds - reference.t[row])))
        at = float(np.clip(bounds[k], reference.t[0], reference.t[-1]))
        apart = abs(at - float(reference.t[row]))
        how = "" if apart <= SAME_TIME else f", interpolated by {apart:.3g} s to the end of an increment"
        initial = sampled(reference, [at]).initial()
        return Beginning(k, initial, f"row {row} of the reference, t = {reference.t[row]:.6f} s{how}")
