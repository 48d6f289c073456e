"""Solving a recording: recorded rates or increments, a solver and a start give a trajectory, and errors if judged.

::

    recording = file_format("kf-gins").read_imu("imu.txt")
    solution = solve_recording(recording, bench.solver("navigation", "navigation-frame"), initial)

``bench.solve_job`` does the same from files to a folder with a report; ``bench.starts`` finds the initial state.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bench.earth import WGS84, Earth
from bench.errors import Array, InputError, UnknownNameError, require_array, require_instance
from bench.interpolation import Comparison
from bench.recording import Recording
from bench.rotation import quat_conjugate, quat_multiply, quat_normalize
from bench.solvers import solvers
from bench.solvers.attitude import AttitudeSolver
from bench.solvers.navigation import NavigationSolver
from bench.trajectory import NavigationInitial, Trajectory

KINDS = ("navigation", "attitude")  # of solvers that take increments of one gyro and accelerometer triad
ORIGIN = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Solution:
    """What a solver made of a recording.

    Attributes
    ----------
    solver : NavigationSolver or AttitudeSolver
    initial : NavigationInitial
    earth : Earth
    trajectory : Trajectory
        At the start and at every update, at the times of the recording. An attitude solver knows neither velocity nor
        position: there the velocity is zero and the position the initial one, which also says where n is.
    used, left_over : int
        Increments that were solved, and those at the end that do not fill an update.
    comparison : Comparison or None
        With the reference.
    """

    solver: NavigationSolver | AttitudeSolver
    initial: NavigationInitial
    earth: Earth
    trajectory: Trajectory
    used: int
    left_over: int
    comparison: Comparison | None = None

    @property
    def attitude_only(self) -> bool:
        """Whether only the attitude was solved."""
        return isinstance(self.solver, AttitudeSolver)


def solve_recording(
    recording: Recording,
    solver: NavigationSolver | AttitudeSolver,
    initial: NavigationInitial,
    earth: Earth = WGS84,
    *,
    rule: str | None = None,
    gyro_bias: ArrayLike = ORIGIN,
    accelerometer_bias: ArrayLike = ORIGIN,
    reference: Trajectory | None = None,
    interpolate: bool = True,
) -> Solution:
    """Return the trajectory of a recording, and its errors if there is a reference.

    Parameters
    ----------
    recording : Recording
    solver : NavigationSolver or AttitudeSolver
        The attitude of an attitude solver is turned from the inertial to the Earth frame by the Earth's rate.
    initial : NavigationInitial
        At the start of the first interval, `Recording.start`.
    earth : Earth
    rule : str, optional
        How to integrate rates, see `Recording.as_increments`; needed for rates, refused for increments.
    gyro_bias, accelerometer_bias : array_like, shape (3,), rad/s, m/s^2
        Subtracted, in body axes (right, forward, up).
    reference : Trajectory, optional
        In the recording's times; the solution is compared with it at its rows, see `Comparison`.
    interpolate : bool
        Whether at all its rows, or only at those at times of the solution.

    Raises
    ------
    InputError
        If an argument breaks a rule, there are too few increments for one update, or reference and solution have no
        times in common.
    AccuracyError
        If the solution is no longer finite.
    """
    for name, value, cls in (
        ("recording", recording, Recording),
        ("solver", solver, (NavigationSolver, AttitudeSolver)),
        ("initial", initial, NavigationInitial),
        ("earth", earth, Earth),
    ):
        require_instance(name, value, cls)
    made = without_bias(recording.as_increments(rule), gyro_bias, accelerometer_bias)
    used = len(made) // solver.samples * solver.samples
    if not used:
        raise InputError(f"recording must hold at least samples = {solver.samples} increments, got {len(made)}")
    # The times of the trajectory are the recording's own, which a drifting clock moves away from k dt.
    t = np.append(made.start, made.t[solver.samples - 1 : used : solver.samples])
    if isinstance(solver, NavigationSolver):
        found = solver.solve(made.angular[:used], made.specific[:used], made.dt, initial, earth)
        trajectory = replace(found, t=t)
    else:
        trajectory = _attitude(solver, made.angular[:used], made.dt, initial, earth, t)
    comparison = None if reference is None else Comparison.of(trajectory, reference, interpolate=interpolate)
    return Solution(solver, initial, earth, trajectory, used, len(made) - used, comparison)


def without_bias(increments: Recording, gyro_bias: ArrayLike, accelerometer_bias: ArrayLike) -> Recording:
    """Return increments less constant biases, shape (3,), rad/s and m/s^2, in body axes."""
    gyro = require_array("gyro_bias", gyro_bias, (3,)) * increments.dt
    accelerometer = require_array("accelerometer_bias", accelerometer_bias, (3,)) * increments.dt
    if not (gyro.any() or accelerometer.any()):
        return increments
    return Recording(
        increments.t,
        increments.angular - gyro,
        increments.specific - accelerometer,
        increments.kind,
        increments.dt,
        source=increments.source,
        epoch_ns=increments.epoch_ns,
        jitter=increments.jitter,
    )


def find_solver(name: str) -> tuple[str, type[Any]]:
    """Return kind and class of a navigation or attitude solver, by name or ``kind/name``.

    Raises
    ------
    UnknownNameError
        If there is none of that name; it lists the names.
    InputError
        If there is one of either kind.
    """
    kind, slash, bare = name.partition("/")
    known = {kind: solvers(kind) for kind in KINDS}
    if slash and kind in known and bare in known[kind]:
        return kind, known[kind][bare]
    found = [kind for kind in KINDS if name in known[kind]]
    if len(found) > 1:
        raise InputError(f"solver must say which kind, {' or '.join(f'{kind}/{name}' for kind in found)}, got {name!r}")
    if not found:
        names = [name for kind in KINDS for name in known[kind]]
        choices = [name if names.count(name) == 1 else f"{kind}/{name}" for kind in KINDS for name in known[kind]]
        raise UnknownNameError("solver", name, choices)
    return found[0], known[found[0]][name]


def _attitude(
    solver: AttitudeSolver, dtheta_b: Array, dt: float, initial: NavigationInitial, earth: Earth, t: Array
) -> Trajectory:
    """Return the attitude in e at a place that does not move; i agrees with e at the start."""
    q_en = earth.q_en(initial.latitude, initial.longitude)
    q_ib = solver.solve(dtheta_b, dt, quat_normalize(quat_multiply(q_en, initial.q_nb)))
    turned = earth.q_ie(np.arange(len(q_ib)) * (solver.samples * dt))
    q_eb = quat_normalize(quat_multiply(quat_conjugate(turned), q_ib))
    r_e = earth.position(initial.latitude, initial.longitude, initial.height)
    return Trajectory(earth, t, q_eb, np.zeros((len(t), 3)), np.tile(r_e, (len(t), 1)))
