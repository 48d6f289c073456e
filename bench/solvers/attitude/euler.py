"""Euler: the forward Euler angles alone, which are singular at pitch +-90 degrees."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bench.errors import AccuracyError, Array, InputError, require_integer
from bench.references import LYU, Source
from bench.rotation import euler_from_quat
from bench.solvers.attitude import AttitudeSolver, require_samples
from bench.solvers.attitude._rate_fit import difference_tables

MOST_HALVINGS = 60


@dataclass(frozen=True)
class Euler(AttitudeSolver):
    """Euler: the forward Euler angles alone, which are singular at pitch +-90 degrees.

    C = Rz(psi) Rx(P) Ry(R): P' = wx cR + wz sR, psi' = (wz cR - wx sR)/cP, R' = wy - tanP (wz cR - wx sR), with the
    polynomial rate that reproduces the N increments of an update, by the power series of the angles. It is here to show
    the singularity. Near a pole psi and R turn by up to 180 degrees while the body hardly moves: the series converges
    over ever shorter steps, so the updates are halved; where halving does not help any more the solver gives up. With
    `halvings=0` it does what an integration with a fixed step does: it goes on, and comes out wrong.

    Parameters
    ----------
    samples : int
        N, increments per update, 1 to 8.
    halvings : int
        How often an update may be halved, 0 to 60; with 0 every update is one step, right or wrong.

    Raises
    ------
    InputError
        If an option is out of range; in use, AccuracyError, naming the update, where the path meets a pole.

    Notes
    -----
    Order N + 1 for odd and N + 2 for even N, that of the fitted rate, away from the poles. `dual-euler` has no such
    points.

    References
    ----------
    [Lyu] Lyu, Cheng, Qiu: Dual-Euler full-attitude method, Aerospace Shanghai 2019(1).
    """

    name: ClassVar[str] = "euler"
    source: ClassVar[Source] = LYU.at("section 1.2, equations 3 to 10")

    samples: int = 4
    halvings: int = 30

    def __post_init__(self) -> None:
        require_samples(self)
        if require_integer("halvings", self.halvings, minimum=0) > MOST_HALVINGS:
            raise InputError(f"halvings must be an integer from 0 to {MOST_HALVINGS}, got {self.halvings}")

    @property
    def order_periodic(self) -> int:
        """N + 1 or N + 2, the even one."""
        return self.samples + 2 - self.samples % 2

    @property
    def order_drift(self) -> int:
        """The same as the periodic order."""
        return self.order_periodic

    @property
    def constant_rate_tolerance(self) -> float:
        """What a series leaves out, and rounding of three angles of up to pi."""
        return 2e-15

    def _constants(self) -> tuple[Any, ...]:
        return difference_tables(self.samples)[0], self.halvings

    def _carry(self, q0: Array) -> Array:
        # The angles, q with its sign, and the updates done
        return np.concatenate([*np.atleast_1d(*euler_from_quat(q0)), q0, [0.0]])

    def _update(
        self,
        constants: tuple[Any, ...],
        dtheta: Array,
        starts: NDArray[np.int64],
        offsets: NDArray[np.int64],
        dt: float,
        carry: Array,
        out: Array,
    ) -> None:
        from bench.solvers.attitude._euler_kernels import euler

        tables, halvings = constants
        done = euler(tables, halvings, dtheta, starts, carry, out)
        carry[7] += done
        if done < len(out):
            raise AccuracyError(
                f"{self.name} fails in update {carry[7]:.0f}, at pitch {np.degrees(carry[1]):.9g} deg: its angles are "
                "singular at +-90 deg (or the increments are too large); dual-euler passes there"
            )
