"""A trajectory at other times: rows that match stand for themselves, others are interpolated by cubics."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bench.errors import Array, InputError, require_array, require_flag
from bench.rotation import quat_conjugate, quat_from_rotvec, quat_multiply, quat_normalize, rotvec_from_quat
from bench.trajectory import NavigationErrors, Trajectory, navigation_errors

SAME_TIME = 1e-6  # s; closer times are the same: a vehicle at 100 m/s moves 0.1 mm
POINTS = 4


def sampled(trajectory: Trajectory, t: ArrayLike) -> Trajectory:
    """Return a trajectory at times t, shape (n,), s, increasing, within its own (within `SAME_TIME`).

    A row within `SAME_TIME` of a time stands for it. Between rows, position and velocity in e and the rotation vector
    from the row before are the cubics through the four nearest rows (two on either side, fewer at the ends): the error
    goes with the fourth power of the interval between rows. Attitude may turn by less than pi over four rows.

    Raises
    ------
    InputError
        If a time is outside of the trajectory.
    """
    t, own = require_array("t", t, (None,)), trajectory.t
    outside = (t < own[0] - SAME_TIME) | (t > own[-1] + SAME_TIME)
    if outside.any():
        k = int(np.argmax(outside))
        raise InputError(f"t must be within the trajectory, {own[0]} to {own[-1]} s, got t[{k}] = {t[k]}")
    nearest = _nearest(own, t)
    between = np.flatnonzero(np.abs(own[nearest] - t) > SAME_TIME)
    q_eb, v_e, r_e = trajectory.q_eb[nearest], trajectory.v_e[nearest], trajectory.r_e[nearest]
    if len(between):
        rows, weights = _weights(own, t[between])
        before = rows[:, (rows.shape[1] - 1) // 2]
        for values, whole in ((v_e, trajectory.v_e), (r_e, trajectory.r_e)):
            # Relative to a near row, so that 6.4e6 m keep their digits.
            base = whole[before]
            values[between] = base + np.einsum("nk,nkj->nj", weights, whole[rows] - base[:, None])
        base = trajectory.q_eb[before]
        turns = rotvec_from_quat(quat_multiply(quat_conjugate(base)[:, None], trajectory.q_eb[rows]))
        turn = quat_from_rotvec(np.einsum("nk,nkj->nj", weights, turns))
        q_eb[between] = quat_normalize(quat_multiply(base, turn))
    return Trajectory(trajectory.earth, t, q_eb, v_e, r_e)


@dataclass(frozen=True, eq=False)
class Comparison:
    """An estimate beside a reference, at the reference's times within the estimate.

    Attributes
    ----------
    estimate, reference : Trajectory
        At the same times.
    errors : NavigationErrors
    matched : int
        Rows at times of the estimate; the others were interpolated.
    """

    estimate: Trajectory
    reference: Trajectory
    errors: NavigationErrors
    matched: int

    @classmethod
    def of(cls, estimate: Trajectory, reference: Trajectory, *, interpolate: bool = True) -> "Comparison":
        """Return the comparison at the reference's rows; the estimate, as a rule the denser one, is interpolated.

        Parameters
        ----------
        estimate, reference : Trajectory
        interpolate : bool
            False takes only the rows within `SAME_TIME` of one of the estimate.

        Raises
        ------
        InputError
            If no row is left.
        """
        require_flag("interpolate", interpolate)
        first, last = estimate.t[0], estimate.t[-1]
        inside = (reference.t >= first - SAME_TIME) & (reference.t <= last + SAME_TIME)
        matches = np.abs(estimate.t[_nearest(estimate.t, reference.t)] - reference.t) <= SAME_TIME
        rows = np.flatnonzero(inside if interpolate else matches)
        if not len(rows):
            matching = "" if interpolate else " at equal times"
            raise InputError(
                f"reference must overlap the solution{matching}: its times are {reference.t[0]} to {reference.t[-1]} s"
                f", those of the solution {first} to {last} s; are both in the same scale of time?"
            )
        parts = (reference.t, reference.q_eb, reference.v_e, reference.r_e)
        kept = Trajectory(reference.earth, *(part[rows] for part in parts))
        at = sampled(estimate, kept.t)
        return cls(at, kept, navigation_errors(at, kept), int(np.count_nonzero(matches[rows])))


def _nearest(own: Array, t: Array) -> NDArray[np.intp]:
    """Return the row of `own` nearest to each time."""
    after = np.clip(np.searchsorted(own, t), 1, max(len(own) - 1, 1))
    if len(own) == 1:
        return np.zeros(len(t), dtype=np.intp)
    return np.where(t - own[after - 1] <= own[after] - t, after - 1, after)


def _weights(own: Array, t: Array) -> tuple[NDArray[np.intp], Array]:
    """Return the rows (n, k) around each time and the weights of Lagrange's polynomial through them."""
    k = min(POINTS, len(own))
    first = np.clip(np.searchsorted(own, t, side="right") - k // 2, 0, len(own) - k)
    rows = first[:, None] + np.arange(k)
    x = own[rows]
    weights = np.ones(rows.shape)
    for i in range(k):
        for j in range(k):
            if i != j:
                weights[:, i] *= (t - x[:, j]) / (x[:, i] - x[:, j])
    return rows, weights
