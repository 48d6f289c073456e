"""The attitude solvers that experiments compare: everything that discovery finds, in its sensible variants."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from bench.errors import InputError
from bench.solvers import solver, solvers
from bench.solvers.attitude import MAX_SAMPLES, AttitudeSolver

ALL = range(1, MAX_SAMPLES + 1)

# Options worth comparing, and for which N; a solver without an entry is taken with its defaults and every N.
CHOICES: Mapping[str, tuple[tuple[dict[str, Any], range], ...]] = {
    "rotation-vector": (
        ({"coefficients": "polynomial"}, ALL),
        # For N = 1 and 2 the three sets are one.
        ({"coefficients": "coning-optimised"}, range(3, MAX_SAMPLES + 1)),
        ({"coefficients": "coning-manoeuvre-exact"}, range(3, MAX_SAMPLES + 1)),
    ),
    "windowed-taylor": (
        ({"window": 8}, range(2, 5, 2)),
        ({"window": 12}, range(2, 5, 2)),
        ({"window": 8, "causal": True}, range(2, 5, 2)),
        ({"window": 12, "causal": True}, range(2, 5, 2)),
    ),
    "functional-iteration": (
        ({"form": "quaternion"}, ALL),
        # The same to rounding, and much slower: two N show it.
        ({"form": "rodrigues"}, range(4, 9, 4)),
        ({"form": "rotation-vector"}, range(4, 9, 4)),
    ),
}
# Letters for the cells of a map; the simplest algorithm first.
SHORT_NAMES = {
    "picard": "P",
    "rotation-vector": "RV",
    "rotation-vector polynomial": "RVp",
    "rotation-vector coning-optimised": "RVo",
    "rotation-vector coning-manoeuvre-exact": "RVe",
    "runge-kutta-quaternion": "RKq",
    "runge-kutta-dcm": "RKd",
    "taylor-quaternion": "TQ",
    "taylor-dcm": "TD",
    "hybrid": "H",
    "windowed-taylor window 8 causal": "C8/",
    "windowed-taylor window 12 causal": "C12/",
    "functional-iteration quaternion": "FQ",
    "functional-iteration rodrigues": "FR",
    "functional-iteration rotation-vector": "FV",
    "windowed-taylor window 8": "W8/",
    "windowed-taylor window 12": "W12/",
}


@dataclass(frozen=True)
class Variant:
    """One solver with its options.

    Attributes
    ----------
    name : str
        Of the solver.
    samples : int
    choice : tuple of (str, value)
        The other options that are not the default.
    """

    name: str
    samples: int
    choice: tuple[tuple[str, Any], ...] = ()

    def build(self) -> AttitudeSolver:
        """Return the solver."""
        made: AttitudeSolver = solver("attitude", self.name, samples=self.samples, **dict(self.choice))
        return made

    @property
    def family(self) -> str:
        """The solver and its options in words, without N."""
        words = [
            str(value) if isinstance(value, str) else key if value is True else f"{key} {value}"
            for key, value in self.choice
        ]
        return " ".join([self.name, *words])

    @property
    def label(self) -> str:
        """The variant in words, unique."""
        return f"{self.family}, N = {self.samples}"

    @property
    def code(self) -> str:
        """A few letters for a cell of a map: those of the family, then N; W12/4 for a window of 12 and N = 4."""
        initials = "".join(word[0].upper() for word in self.family.replace("-", " ").split())
        return f"{SHORT_NAMES.get(self.family, initials)}{self.samples}"


def _candidates() -> Iterator[Variant]:
    for name in solvers("attitude"):
        for options, samples in CHOICES.get(name, (({}, ALL),)):
            yield from (Variant(name, N, tuple(options.items())) for N in samples)


def variants(max_samples: int = MAX_SAMPLES) -> list[Variant]:
    """Return all variants with at most `max_samples` increments per update, in a fixed order."""
    found = []
    for variant in _candidates():
        try:
            variant.build()
        except InputError:  # an N that this solver does not offer
            continue
        if variant.samples <= max_samples:
            found.append(variant)
    return found
