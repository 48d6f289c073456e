"""What the attitude experiments share: the algorithms, the quantised increments, and errors as rows and arrays."""

import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bench.errors import Array, BenchWarning
from bench.evaluation import attitude_error
from bench.imu import SensorErrors
from bench.imu.quantisation import Quantisation
from bench.motion import Motion
from bench.solvers.attitude import AttitudeSolver
from bench.table import Table
from bench.units import ARCSEC

ANGLES = ("pitch", "roll", "yaw")
SAMPLES = (3, 4, 5, 6)
QUANTUM = ARCSEC  # one pulse, stated
ENOUGH_PHASES = 20  # of the quantiser, to judge by
ERRORS = SensorErrors((Quantisation(quantum=QUANTUM, random_phase=True),))


@dataclass(frozen=True)
class Algorithm:
    """An attitude solver with its options, under the name that it has in rows and figures.

    Attributes
    ----------
    label : str
        Unique.
    solver : str
        Registered name.
    options : tuple of (str, value)
    samples : tuple of int
        N, for which it is run.
    quantised : bool
        Whether it is run on quantised increments too.
    """

    label: str
    solver: str
    options: tuple[tuple[str, Any], ...] = ()
    samples: tuple[int, ...] = SAMPLES
    quantised: bool = True

    def make(self, samples: int) -> AttitudeSolver:
        """Return the solver for N samples."""
        from bench.solvers import solver

        made: AttitudeSolver = solver("attitude", self.solver, samples=samples, **dict(self.options))
        return made


PRINTED = Algorithm("rotation vector, Eq. 4", "rotation-vector", (("coefficients", "polynomial"),))
OPTIMISED = Algorithm("rotation vector, coning-optimised", "rotation-vector", (("coefficients", "coning-optimised"),))
SONG = Algorithm("rotation vector, Song", "rotation-vector", (("coefficients", "coning-manoeuvre-exact"),))
QUATERNION = Algorithm("Taylor quaternion", "taylor-quaternion", (("terms", 10),))
DCM = Algorithm("Taylor DCM", "taylor-dcm", (("terms", 10), ("orthonormalise", False)))
# For 3 and 4 samples ten terms are enough.
FULL_QUATERNION = Algorithm("Taylor quaternion, enough terms", "taylor-quaternion", samples=(5, 6))
FULL_DCM = Algorithm("Taylor DCM, enough terms", "taylor-dcm", (("orthonormalise", False),), samples=(5, 6))
HYBRID = Algorithm("hybrid", "hybrid", quantised=False)
ITERATION = Algorithm("functional iteration", "functional-iteration", samples=(8,), quantised=False)
WINDOW = Algorithm("12-sample window", "windowed-taylor", (("window", 12),), samples=(4,), quantised=False)

READINGS = {"Eq. 4": PRINTED, "optimised": OPTIMISED, "Song": SONG}  # of "rotation vector"
NEW = (QUATERNION, DCM)
PAPERS = (*READINGS.values(), *NEW)
BEST = (HYBRID, ITERATION, WINDOW)
ALL = (*PAPERS, FULL_QUATERNION, FULL_DCM, *BEST)
UPDATE = 120  # every number of increments that all of them can take is a multiple of this
COLUMNS = ("rate_hz", "algorithm", "samples", "data", "phase")
MEASURES = ("pitch", "roll", "yaw", "rotation", "drift")


def quantised(dtheta_b: Array, dt: float, seed: int, phase: int) -> Array:
    """Return the increments as a pulse counter of 1 arcsec reports them; the phase is a trial of its residue."""
    return ERRORS.apply(dtheta_b, dt, "increments", seed=seed, trial=phase)


def solve(algorithm: Algorithm, samples: int, dtheta_b: Array, dt: float, q0: Array) -> Array:
    """Return the attitude at every update; ten terms may be too few, which is what is to be shown."""
    with warnings.catch_warnings():
        if ("terms", 10) in algorithm.options:
            warnings.simplefilter("ignore", BenchWarning)
        return algorithm.make(samples).solve(dtheta_b, dt, q0)


def update_times(n: int, samples: int, rate: float) -> Array:
    """Return the times of all updates of n increments, the start included, s."""
    return samples * np.arange(n // samples + 1) / rate


@dataclass(frozen=True, eq=False)
class Truth:
    """True attitudes at the updates, and their pitch, roll and yaw (n, 3), rad."""

    q: Array
    angles: Array

    @classmethod
    def of(cls, motion: Motion, t: Array) -> "Truth":
        """Return the truth of a motion at times t."""
        from bench.experiments._attitude_kernels import angles

        q = motion.kinematics(t).q_ib
        found = np.empty((len(q), 3))
        angles(q, found)
        return cls(q, found)


def errors(q: Array, truth: Truth) -> Array:
    """Return the largest |pitch|, |roll|, |yaw| error, the largest rotation error, and the drift, shape (5,), rad.

    The drift is the error about the vertical at the last update, with its sign.
    """
    from bench.experiments._attitude_kernels import largest_errors

    found = np.empty(5)
    largest_errors(q, truth.q, truth.angles, found[:4])
    found[4] = attitude_error(q[-1:], truth.q[-1:])[0, 2]
    return found


def error_rows(
    motion: Motion, dtheta_b: Array, rate: float, algorithms: Iterable[Algorithm], seed: int, phases: int
) -> Table:
    """Return the errors of all algorithms, from ideal increments and from each phase of the quantiser."""
    n, dt = len(dtheta_b), 1 / rate
    truth = {N: Truth.of(motion, update_times(n, N, rate)) for a in algorithms for N in a.samples}
    rows = []
    for phase in range(-1, phases):
        data = "ideal" if phase < 0 else "quantised"
        reported = dtheta_b if phase < 0 else quantised(dtheta_b, dt, seed, phase)
        for algorithm in (a for a in algorithms if a.quantised or phase < 0):
            for N in algorithm.samples:
                q = solve(algorithm, N, reported, dt, truth[N].q[0])
                rows.append((rate, algorithm.label, N, data, max(phase, 0), *(errors(q, truth[N]) / ARCSEC).tolist()))
    return error_table(rows)


def error_table(rows: Sequence[Sequence[Any]]) -> Table:
    """Return rows of errors as a table."""
    names = (*COLUMNS, *(f"{measure}_arcsec" for measure in MEASURES))
    return Table.from_rows(names, rows, "Largest errors over the run; drift: the error about the vertical at its end")


@dataclass(frozen=True, eq=False)
class Errors:
    """The rows as arrays.

    Attributes
    ----------
    rates : ndarray, shape (F,), Hz
        Rising.
    cells : dict of (label, samples, data) to ndarray, shape (phases, F, 5), arcsec
        In the order of `MEASURES`.
    """

    rates: Array
    cells: dict[tuple[str, int, str], Array]

    @classmethod
    def of(cls, rows: Table) -> "Errors":
        """Sort the rows into arrays."""
        rates = np.unique(rows["rate_hz"])
        values = np.stack([rows[f"{measure}_arcsec"] for measure in MEASURES], axis=1)
        cells: dict[tuple[str, int, str], Array] = {}
        keys = list(zip(rows["algorithm"].tolist(), rows["samples"].tolist(), rows["data"].tolist(), strict=True))
        place = np.searchsorted(rates, rows["rate_hz"])
        for key in dict.fromkeys(keys):
            keep = np.array([k == key for k in keys])
            cell = np.empty((int(rows["phase"][keep].max()) + 1, len(rates), len(MEASURES)))
            cell[rows["phase"][keep], place[keep]] = values[keep]
            cells[key] = cell
        return cls(rates, cells)

    def phases(self, algorithm: Algorithm, samples: int, data: str) -> Array:
        """Return pitch, roll, yaw errors in every phase, shape (phases, F, 3), arcsec."""
        return self.cells[algorithm.label, samples, data][:, :, :3]

    def middle(self, algorithm: Algorithm, samples: int, data: str) -> Array:
        """Return the medians over the phases of the quantiser, shape (F, 3), arcsec."""
        return np.median(self.phases(algorithm, samples, data), axis=0)
