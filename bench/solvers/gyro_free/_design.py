"""What an accelerometer array can tell, from its geometry alone: linear design, rank, unobservable directions.

One reading is linear in twelve unknowns: f, alpha and the six products of two rates,
``A = d . f + (r x d) . alpha + d . (omega x (omega x r))``. Ranks are those of columns in one unit (m/s^2: alpha and
the products times the array's radius) about the array's centroid, so that neither the choice of the body origin nor
the unit of length matters.
"""

from dataclasses import dataclass

import numpy as np

from bench.errors import Array, ObservabilityError
from bench.rotation import cross
from bench.signals import Accelerometers

UNKNOWNS = (
    *("f_x", "f_y", "f_z"),
    *("alpha_x", "alpha_y", "alpha_z"),
    *("w_x^2", "w_y^2", "w_z^2"),
    *("w_x w_y", "w_x w_z", "w_y w_z"),
)
# Relative to the largest singular value. Weaker directions amplify noise a million times, and geometry typed with
# seven digits makes such directions by rounding alone.
TOLERANCE = 1e-6


@dataclass(frozen=True)
class Observability:
    """What an array determines from one reading of each channel.

    Attributes
    ----------
    rank : int
        Of the design for all twelve unknowns (f, alpha, products of two rates).
    motion_rank : int
        Of the design for f and alpha alone, the rates being known; 6 or the array cannot navigate.
    condition : float
        Largest over smallest nonzero singular value of the design for all twelve unknowns.
    estimable : tuple of str
        The unknowns that follow linearly from one reading.
    mode : {"rank-one", "squares", "integral", "none"}
        How `array-least-squares` finds the rate: from all six products; from the three squares; by integrating
        alpha; not at all.
    unobservable : tuple of str
        Directions in the space of the unknowns that change no reading.
    """

    rank: int
    motion_rank: int
    condition: float
    estimable: tuple[str, ...]
    mode: str
    unobservable: tuple[str, ...]

    def __str__(self) -> str:
        how = {
            "rank-one": "rate from all products of two rates, one sign from integrated alpha",
            "squares": "rate from its squares, signs from integrated alpha",
            "integral": "rate by integrating alpha",
            "none": "does not determine f and alpha",
        }[self.mode]
        lost = "; ".join(self.unobservable) or "nothing"
        return f"rank {self.rank} of 12, condition {self.condition:.3g}: {how}; changes no reading: {lost}"


@dataclass(frozen=True, eq=False)
class Design:
    """The matrices of `array-least-squares`; q is the vector of the six products of two rates.

    Attributes
    ----------
    M : ndarray, shape (6, m)
        [f, alpha] = M A - K q.
    K : ndarray, shape (6, 6)
    B : ndarray, shape (6, m)
        What is left of a reading when f and alpha are free: G q = B A in the least-squares sense.
    G : ndarray, shape (6, 6), m^2
    S : ndarray, shape (6, m), 1/m
        q = S A, of smallest norm where G is singular.
    """

    M: Array
    K: Array
    B: Array
    G: Array
    S: Array


def design_matrix(position: Array, direction: Array) -> Array:
    """Return the rows [d | r x d | coefficients of the products] in the order of `UNKNOWNS`, shape (m, 12)."""
    r, d = np.asarray(position, dtype=float), np.asarray(direction, dtype=float)
    along = (d * r).sum(axis=1, keepdims=True)
    products = [d[:, i] * r[:, j] + d[:, j] * r[:, i] for i, j in ((0, 1), (0, 2), (1, 2))]
    return np.column_stack([d, cross(r, d), d * r - along, *products])


def _scaled(accelerometers: Accelerometers) -> tuple[Array, Array, float]:
    """Return the design about the centroid with all columns in m/s^2, the centroid and the radius."""
    centroid = accelerometers.position.mean(axis=0)
    offset = accelerometers.position - centroid
    radius = float(np.sqrt((offset**2).sum(axis=1).mean()))
    if radius <= 1e-9 * np.abs(accelerometers.position).max():  # all at one point, up to rounding
        radius, offset = 1.0, np.zeros_like(offset)
    return design_matrix(offset / radius, accelerometers.direction), centroid, radius


def _singular(design: Array) -> Array:
    return np.asarray(np.linalg.svd(design, compute_uv=False), dtype=np.float64)


def _rank(design: Array) -> int:
    singular = _singular(design)
    return int((singular > TOLERANCE * singular[0]).sum())


def _echelon(basis: Array) -> Array:
    """Return the reduced row echelon form of independent rows, products leading, then alpha, then f."""
    basis = basis.copy()
    row = 0
    for column in (*range(6, 12), *range(3, 6), *range(3)):
        if row == len(basis):
            break
        pivot = row + int(np.argmax(np.abs(basis[row:, column])))
        if np.abs(basis[pivot, column]) < TOLERANCE:
            continue
        basis[[row, pivot]] = basis[[pivot, row]]
        basis[row] /= basis[row, column]
        others = np.arange(len(basis)) != row
        basis[others] -= np.outer(basis[others, column], basis[row])
        row += 1
    return basis


def _null_space(design: Array, rank: int, centroid: Array, radius: float) -> Array:
    """Return directions that change no reading, shape (k, 12), f at the body origin, all in m/s^2."""
    basis = np.linalg.svd(design)[2][rank:]
    # f at the origin = f at the centroid minus what alpha and the rates add between the two.
    between = design_matrix(np.tile(centroid / radius, (3, 1)), np.eye(3))[:, 3:]
    basis[:, :3] -= basis[:, 3:] @ between.T
    return _echelon(basis)


def _in_words(direction: Array, radius: float) -> str:
    """Write a direction of the scaled unknowns in SI, its leading coefficient 1."""
    order = [*range(6, 12), *range(3, 6), *range(3)]
    named = [(UNKNOWNS[i], direction[i] / (radius if i >= 3 else 1.0)) for i in order if abs(direction[i]) > TOLERANCE]
    words = named[0][0]
    for name, coefficient in named[1:]:
        size = abs(coefficient / named[0][1])
        sign = "-" if coefficient * named[0][1] < 0 else "+"
        words += f" {sign} {'' if abs(size - 1) < TOLERANCE else f'{size:.4g} '}{name}"
    return words


def observability(accelerometers: Accelerometers) -> Observability:
    """Return what the array determines from one reading of each channel."""
    design, centroid, radius = _scaled(accelerometers)
    singular, rank, motion_rank = _singular(design), _rank(design), _rank(design[:, :6])
    null = _null_space(design, rank, centroid, radius)
    seen = np.asarray((np.abs(null) < TOLERANCE).all(axis=0))
    mode = "rank-one" if seen[6:].all() else "squares" if seen[6:9].all() else "integral"
    return Observability(
        rank=rank,
        motion_rank=motion_rank,
        condition=float(singular[0] / singular[rank - 1]),
        estimable=tuple(name for name, ok in zip(UNKNOWNS, seen, strict=True) if ok),
        mode=mode if motion_rank == 6 else "none",
        unobservable=tuple(_in_words(direction, radius) for direction in null),
    )


def require_motion(accelerometers: Accelerometers) -> Observability:
    """Return the observability of an array that determines f and alpha.

    Raises
    ------
    ObservabilityError
        If it does not; with the rank and what is lost.
    """
    found = observability(accelerometers)
    if found.motion_rank < 6:
        design, centroid, radius = _scaled(accelerometers)
        design[:, 6:] = 0.0  # the rates being known
        directions = _null_space(design, found.motion_rank, centroid, radius)
        lost = "; ".join(_in_words(row, radius) for row in directions if np.abs(row[6:]).max() < TOLERANCE)
        raise ObservabilityError(
            f"{len(accelerometers)} accelerometers do not determine f and alpha, even with the rate known: "
            f"[d | r x d] has rank {found.motion_rank}, not 6; these changes leave every reading as it is: {lost}"
        )
    return found


def _known_rate(design: Array) -> tuple[Array, Array]:
    """Return M, K of [f, alpha] = M A - K q from a scaled design of full motion rank, the rate being known."""
    M: Array = np.asarray(np.linalg.pinv(design[:, :6]), dtype=np.float64)
    return M, M @ design[:, 6:]


def _integrated_rate(design: Array) -> tuple[Array, Array]:
    """Return M, K of [f, alpha] = M A - K q where q serves only for what the readings do not tell of the products.

    The least-noisy M, K feed the error of the integrated rate back into alpha through products that the array
    measures, and the error then grows exponentially (Padgaonkar's nine) rather than with t.
    """
    Vt = np.linalg.svd(design)[2]
    lost = Vt[_rank(design) :]
    N = lost.T @ lost
    # All twelve unknowns y = design^+ A + N y; solved for f and alpha.
    solve: Array = np.asarray(np.linalg.inv(np.eye(6) - N[:6, :6]), dtype=np.float64)
    everything: Array = np.asarray(np.linalg.pinv(design, rcond=TOLERANCE), dtype=np.float64)
    return solve @ everything[:6], -solve @ N[:6, 6:]


def solver_design(accelerometers: Accelerometers, mode: str) -> Design:
    """Return the matrices for an array that determines f and alpha (not checked)."""
    design, centroid, radius = _scaled(accelerometers)
    M, K = _integrated_rate(design) if mode == "integral" else _known_rate(design)
    M[3:] /= radius
    K[:3] *= radius
    # From the centroid c to the body origin: f = f_c + c x alpha - omega x (omega x c).
    M[:3] += cross(centroid, M[3:].T).T
    K[:3] += cross(centroid, K[3:].T).T + design_matrix(np.tile(centroid, (3, 1)), np.eye(3))[:, 6:]
    basis = np.linalg.svd(design[:, :6], full_matrices=False)[0]
    projected = (design[:, 6:] - basis @ (basis.T @ design[:, 6:])) * radius
    U, singular, Vt = np.linalg.svd(projected, full_matrices=False)
    kept = singular > TOLERANCE * radius
    U, singular, Vt = U[:, kept], singular[kept], Vt[kept]
    return Design(
        M=np.ascontiguousarray(M),
        K=np.ascontiguousarray(K),
        B=np.ascontiguousarray((Vt.T * singular) @ U.T),
        G=np.ascontiguousarray((Vt.T * singular**2) @ Vt),
        S=np.ascontiguousarray((Vt.T / singular) @ U.T),
    )
