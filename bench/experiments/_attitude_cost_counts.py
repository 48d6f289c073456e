"""The counts of `attitude-cost`: options, items, and the operations of one solver or one printed formula."""

import warnings
from dataclasses import astuple, dataclass, fields
from functools import cache

import numpy as np

from bench.campaign import Item
from bench.errors import Array, BenchWarning, InputError, require_integer
from bench.experiments._attitude_limits_solvers import Variant, variants
from bench.motion.coning import Coning
from bench.operation_count import Operations, Tally, counting
from bench.rotation import matrix_from_quat, quat_from_rotvec, quat_rotate
from bench.solvers.attitude import MAX_SAMPLES, AttitudeSolver
from bench.table import Table

RATE = 100.0  # Hz
COUNTED = 2  # updates, behind those that fill the first window
PAPER_TERMS, PAPER_SAMPLES = 10, 3
SKEW = quat_from_rotvec([0.5, 0.7, 0.9])  # turns the axes: no increment is constant, equal or zero
START = quat_from_rotvec([0.4, -0.6, 1.1])  # initial attitude, without zeros and ones
KINDS = tuple(f.name for f in fields(Operations))
COLUMNS = ("source", "label", "solver", "samples", *KINDS, "total", "largest_difference")

AS_PRINTED = (
    Variant("rotation-vector", PAPER_SAMPLES),
    Variant("taylor-quaternion", PAPER_SAMPLES, (("terms", PAPER_TERMS),)),
    Variant("taylor-dcm", PAPER_SAMPLES, (("terms", PAPER_TERMS), ("orthonormalise", False))),
)
FORMULAS = ("rotation vector", "quaternion", "DCM")
LAST_STEP = "matrix to quaternion"
TO_QUATERNION = "_taylor_kernels.quaternion_of"  # the last step of Taylor's DCM, which the paper does not need


@dataclass(frozen=True)
class Options:
    """Options of the experiment; the defaults are the paper's conditions.

    Attributes
    ----------
    max_samples : int
        Largest number of increments per update to be counted, 1 to 8; table 1 needs 3.
    repeats : int
        Timings of which the best is reported; 0 for none.
    timed_updates : int
        Updates in one timing.
    """

    max_samples: int = MAX_SAMPLES
    repeats: int = 5
    timed_updates: int = 1024

    def __post_init__(self) -> None:
        if require_integer("max_samples", self.max_samples, minimum=1) > MAX_SAMPLES:
            raise InputError(f"max_samples must be an integer from 1 to {MAX_SAMPLES}, got {self.max_samples}")
        require_integer("repeats", self.repeats, minimum=0)
        require_integer("timed_updates", self.timed_updates, minimum=1)


@cache
def increments(n: int) -> Array:
    """Return n increments of the paper's coning, 5 degrees and 2 Hz at 100 Hz, in skew axes, shape (n, 3), rad."""
    return quat_rotate(SKEW, Coning().increments(RATE, n))


def items(options: Options, seed: int) -> list[Item]:
    """Return one item per printed formula, per solver as in the paper, and per variant of every solver."""
    work: list[str | Variant] = [*FORMULAS, *AS_PRINTED]
    work += [v for v in variants(options.max_samples) if v not in AS_PRINTED]
    return [Item(f"{k:03d}", one) for k, one in enumerate(work)]


def measure(work: str | Variant) -> Table:
    """Count the operations per update of a printed formula or of a solver."""
    if isinstance(work, str):
        counted, difference = count_formula(work)
        return _row("formula", f"{work}, printed formulas", "", PAPER_SAMPLES, counted, difference)
    tally, difference = count_solver(work.build())
    where = "as printed" if work in AS_PRINTED else "solver"
    rows = [_row(where, work.label, work.name, work.samples, per_update(tally), difference)]
    if work in AS_PRINTED and work.name == "taylor-dcm":
        last = per_update(tally, TO_QUATERNION)
        rows.append(_row(f"{where}, last step", f"{work.label}, {LAST_STEP}", work.name, work.samples, last, 0))
    return Table.concatenate(rows)


def _row(source: str, label: str, name: str, samples: int, counted: Operations, difference: float) -> Table:
    values = (source, label, name, samples, *astuple(counted), counted.total, float(difference))
    return Table.from_rows(COLUMNS, [values], "Operations per update")


def count_solver(solver: AttitudeSolver) -> tuple[tuple[Tally, Tally], float]:
    """Return the tallies of two runs that differ by COUNTED updates, and how far counted and compiled attitude differ.

    The difference of the tallies is free of what is done once a call.
    """
    N = solver.samples
    first = -(-(N + sum(solver.borrowed)) // N)  # updates that the first window waits for
    tallies = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", BenchWarning)  # too few terms: as in the paper
        data, dt, q0 = increments(N * (first + COUNTED)), 1 / RATE, START
        compiled = solver.solve(data, dt, q0)  # loads the kernels, too
        for updates in (first, first + COUNTED):
            with counting() as tally:
                counted = solver.solve(data[: N * updates], dt, q0)
            tallies.append(tally)
    return (tallies[0], tallies[1]), float(np.abs(counted - compiled).max())


def per_update(tallies: tuple[Tally, Tally], kernel: str | None = None) -> Operations:
    """Return the operations per update, of all kernels or of one."""
    short, long = (tally.operations if kernel is None else tally.of(kernel) for tally in tallies)
    return long.combine(short, -1.0).scaled(1 / COUNTED)


def count_formula(name: str) -> tuple[Operations, float]:
    """Return the operations of a printed formula for one update, and how far its matrix is from the solver's."""
    from bench.experiments import _attitude_cost_formulas as formulas

    dtheta, q, C = increments(PAPER_SAMPLES), START.copy(), matrix_from_quat(START).ravel()
    with counting() as tally:
        if name == "rotation vector":
            formulas.rotation_vector(dtheta, q, C)
        elif name == "quaternion":
            formulas.quaternion(dtheta, PAPER_TERMS, q, C)
        else:
            formulas.matrix(dtheta, PAPER_TERMS, C)
    solver = AS_PRINTED[FORMULAS.index(name)].build()
    expected = matrix_from_quat(solver.solve(dtheta, 1 / RATE, START)[-1])
    return tally.operations, float(np.abs(C - expected.ravel()).max())
