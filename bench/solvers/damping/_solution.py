"""What a damping filter gives: estimated errors with their uncertainty, innovations, and the corrected trajectory."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bench.errors import Array, Indices, InputError, require_instance
from bench.rotation import quat_from_rotvec, quat_multiply, quat_normalize
from bench.solvers.damping._samples import STEP_TOLERANCE, InsSamples
from bench.trajectory import Trajectory

STATES = (
    "dv_E",
    "dv_N",
    "dL",
    "dlambda",
    "phi_E",
    "phi_N",
    "phi_U",
    "nabla_x",
    "nabla_y",
    "nabla_z",
    "eps_x",
    "eps_y",
    "eps_z",
    "reference_E",
    "reference_N",
)


@dataclass(frozen=True, eq=False)
class DampingSolution:
    """Estimates of a damping filter at m times, after the measurement of each.

    Attributes
    ----------
    t : ndarray, shape (m,), s
    x : ndarray, shape (m, k)
        Estimated errors of the INS in the order of `STATES`, k = 13 or 15: dv (m/s), dL, dlambda, phi (rad), nabla
        (m/s^2, accelerometer error), eps (rad/s, minus the gyro's error), error of the reference velocity (m/s).
        C_c = (I - [phi x]) C_nb.
    sigma : ndarray, shape (m, k)
        Standard deviations that the filter claims.
    innovation : ndarray, shape (m, 2)
        Measurement minus its prediction, m/s (m/s^2 for `velocity-change`); NaN at rows without a measurement, and
        all through for the fusion, which has none of its own.
    nis : ndarray, shape (m,)
        Innovation squared, normalised by its predicted covariance; chi-square of 2 degrees if consistent.
    used : ndarray of bool, shape (m,)
        Whether a measurement was there and passed the gate.
    covariance : ndarray, shape (j, k, k)
        Full covariances of `x` at `covariance_rows`; diagonal for the fusion.
    covariance_rows : ndarray of int, shape (j,)
        Rows of this solution.
    gamma : ndarray, shape (m,), or None
        Weight of the distrust in filter 1 (fusion only).
    weight : ndarray, shape (m, k), or None
        Share of filter 1 in each fused state; the rest is filter 2's (fusion only).
    parts : tuple of DampingSolution
        Solutions of filter 1 and filter 2 (`double-filter`), of filter 1 (`velocity-change`), else empty.
    """

    t: Array
    x: Array
    sigma: Array
    innovation: Array
    nis: Array
    used: NDArray[np.bool_]
    covariance: Array
    covariance_rows: Indices
    gamma: Array | None = None
    weight: Array | None = None
    parts: tuple["DampingSolution", ...] = ()

    def __len__(self) -> int:
        return len(self.t)

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return STATES[: self.x.shape[1]]

    @cached_property
    def covariance_t(self) -> Array:
        """Times of the full covariances, shape (j,), s."""
        return np.asarray(self.t[self.covariance_rows])

    def corrected(self, ins: InsSamples) -> Trajectory:
        """Return the trajectory of the INS without the estimated errors (output correction; the INS runs free).

        v_n - dv, L - dL, lambda - dlambda, C_nb = exp([phi x]) C_c.

        Raises
        ------
        InputError
            If `ins` is of another class or has other times.
        """
        require_instance("ins", ins, InsSamples)
        if len(ins) != len(self) or np.abs(ins.t - self.t).max() > STEP_TOLERANCE:
            raise InputError(f"ins must have the times of the solution ({len(self)} rows), got {len(ins)} rows")
        v_n = ins.v_n.copy()
        v_n[:, :2] -= self.x[:, :2]
        q_nb = quat_normalize(quat_multiply(quat_from_rotvec(self.x[:, 4:7]), ins.q_nb))
        latitude, longitude = ins.latitude - self.x[:, 2], ins.longitude - self.x[:, 3]
        return Trajectory.from_geodetic(ins.earth, self.t, q_nb, v_n, latitude, longitude, ins.height)
