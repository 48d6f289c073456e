"""Damping a solved recording: a filter, fed with an external velocity, corrects the free INS from outside.

::

    solution = solve_recording(recording, bench.solver("navigation", "navigation-frame", height="held"), initial)
    damped = damp(solution, aiding, bench.solver("damping", "bias-augmented"))
    damped.trajectory, damped.estimate.x  # corrected, at the solution's times; estimated errors, once a second
"""

import warnings
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.aiding import VelocityAiding
from bench.errors import Array, BenchWarning, InputError, require_instance, require_scalar
from bench.interpolation import SAME_TIME, Comparison, sampled
from bench.rotation import quat_conjugate, quat_from_rotvec, quat_multiply, quat_normalize, rotvec_from_quat
from bench.solve import Solution
from bench.solvers.attitude import AttitudeSolver
from bench.solvers.damping import DampingFilter, DampingSolution, InsSamples, error_states
from bench.solvers.navigation import NavigationSolver
from bench.trajectory import Trajectory

STEP = 1.0  # s, of the filter
EXPECTED_NIS = 2.0  # mean of chi-square of 2 degrees
FAR = 100.0  # NIS of the first velocity: a filter takes what stays for errors of the INS, and the mean tells nothing
TOLERABLE = 10.0  # a velocity in knots taken for m/s, or a time that is off, makes far more of it than a wrong noise


@dataclass(frozen=True, eq=False)
class Damped:
    """What a damping filter made of a free solution.

    Attributes
    ----------
    filter : DampingFilter
    aiding : VelocityAiding
    ins : InsSamples
        The free solution at the steps of the filter.
    v_ref : ndarray, shape (m, 2), m/s
        External velocity east and north at those steps; NaN where there is none.
    estimate : DampingSolution
    trajectory : Trajectory
        Corrected, at all times of the free solution: the corrections are taken linearly between the steps, and the
        last one is held.
    comparison : Comparison or None
        Of the corrected trajectory, with the reference of the free solution.
    true_errors : ndarray, shape (n, 7), or None
        Of the free solution at the times of `comparison`, in the definition of the first columns of ``estimate.x``.
    """

    filter: DampingFilter
    aiding: VelocityAiding
    ins: InsSamples
    v_ref: Array
    estimate: DampingSolution
    trajectory: Trajectory
    comparison: Comparison | None = None
    true_errors: Array | None = None

    @property
    def stages(self) -> dict[str, DampingSolution]:
        """The Kalman filters with innovations of their own, by name: those that are fused, or the filter itself."""
        first, *rest = [*self.estimate.parts, self.estimate]
        if not rest:
            return {self.filter.name: first}
        return {"velocity-error": first, "velocity-change": rest[0]}

    @property
    def with_reference(self) -> int:
        """Steps at which there is an external velocity."""
        return int(np.count_nonzero(np.isfinite(self.v_ref[:, 0])))

    def rejected(self, stage: DampingSolution) -> int:
        """Return how many measurements of a stage did not pass its gate."""
        return int(np.count_nonzero(np.isfinite(stage.nis) & np.logical_not(stage.used)))

    def doubts(self) -> Iterator[str]:
        """Yield what makes the external velocity doubtful: too little of it, or too far from the INS."""
        steps, source = len(self.ins), self.aiding.source
        if 2 * self.with_reference < steps:
            yield (
                f"{source}: a velocity was available at {self.with_reference} of {steps} steps only; check its time "
                f"unit, clock and offset, and longest_gap = {self.aiding.longest_gap:g} s"
            )
        check = "check the velocity's unit, axes, time unit, clock and offset, and the noises that the filter supposes"
        for name, stage in self.stages.items():
            taken = stage.used & np.isfinite(stage.nis)
            used, rejected = stage.nis[taken], self.rejected(stage)
            if len(used) and (mean := float(used.mean())) > TOLERABLE * EXPECTED_NIS:
                yield f"{source}: the mean NIS of {name} is {mean:.0f}, {EXPECTED_NIS:g} is expected; {check}"
            elif rejected > len(used):
                total = rejected + len(used)
                yield f"{source}: {rejected} of {total} measurements did not pass the gate of {name}; {check}"
            elif name != "velocity-change" and len(used) and used[0] > FAR:
                apart = float(np.hypot(*stage.innovation[taken][0]))
                yield f"{source}: the first velocity is {apart:.3g} m/s off that of the INS, NIS {used[0]:.0f}; {check}"


def damp(solution: Solution, aiding: VelocityAiding, damping: DampingFilter, *, step: float = STEP) -> Damped:
    """Return the solution of a navigation solver with its errors estimated and taken off.

    Parameters
    ----------
    solution : Solution
        Of a navigation solver with ``height="held"``: it runs free, nothing is fed back.
    aiding : VelocityAiding
        In the recording's times.
    damping : DampingFilter
        It begins with the first update of the solution.
    step : float, s
        Of the filter.

    Raises
    ------
    InputError
        If an argument breaks a rule, the height is not held, the solution is shorter than one step, or the velocity
        is there at none of the steps.
    AccuracyError
        If an estimate is no longer finite.

    Warns
    -----
    BenchWarning
        If a velocity is available at fewer than half of the steps, if most measurements do not pass the gate, if the
        mean NIS of those that do is ten times what is expected, or if the first one is ten standard deviations off:
        often a wrong unit or clock.
    """
    for name, value, cls in (
        ("solution", solution, Solution),
        ("aiding", aiding, VelocityAiding),
        ("damping", damping, DampingFilter),
    ):
        require_instance(name, value, cls)
    require_held_height(solution.solver)
    free = solution.trajectory
    step = require_scalar("step", step, positive=True)
    count = int((free.t[-1] - free.t[0] + SAME_TIME) // step)
    if count < 1:
        raise InputError(f"solution must last one step of the filter, {step:g} s, got {free.t[-1] - free.t[0]:g} s")
    samples = sampled(free, free.t[0] + step * np.arange(count + 1))
    v_ref = aiding.at(samples.t)
    if not np.isfinite(v_ref).any():
        raise InputError(
            f"{aiding.source}: no velocity at any of the {len(v_ref)} steps of the filter; its times are {aiding.t[0]} "
            f"to {aiding.t[-1]} s, those of the solution {free.t[0]} to {free.t[-1]} s (in the same clock?), and rows "
            f"more than longest_gap = {aiding.longest_gap:g} s apart are not interpolated"
        )
    ins = InsSamples.of(samples)
    estimate = damping.solve(ins, v_ref)
    trajectory = _carried(free, samples, estimate.corrected(ins))
    judged = solution.comparison
    comparison, true = None, None
    if judged is not None:
        comparison = Comparison.of(trajectory, judged.reference)
        true = error_states(judged.estimate, judged.reference)
    damped = Damped(damping, aiding, ins, v_ref, estimate, trajectory, comparison, true)
    for doubt in damped.doubts():
        warnings.warn(doubt, BenchWarning, stacklevel=2)
    return damped


def require_held_height(solver: NavigationSolver | AttitudeSolver) -> None:
    """Check that the errors of a solver are those of the filters' model.

    Raises
    ------
    InputError
        If it solves the attitude only, or integrates the height.
    """
    if not isinstance(solver, NavigationSolver):
        raise InputError(
            f"solver must be a navigation solver for a damping filter, got the attitude solver {solver.name!r}"
        )
    if solver.height != "held":
        raise InputError(
            "solver must hold its height for a damping filter, whose model has no vertical channel: set height to "
            f"'held' (--solver.height held), got {solver.height!r}"
        )


def _carried(fine: Trajectory, before: Trajectory, after: Trajectory) -> Trajectory:
    """Return `fine` changed as `after` differs from `before`, linearly between their rows.

    The correction changes slowly, unlike the vehicle's attitude and velocity, which may sway within a step.
    """

    def at(change: Array) -> Array:
        return np.stack([np.interp(fine.t, before.t, column) for column in change.T], axis=1)

    turn = at(rotvec_from_quat(quat_multiply(after.q_eb, quat_conjugate(before.q_eb))))
    q_eb = quat_normalize(quat_multiply(quat_from_rotvec(turn), fine.q_eb))
    v_e, r_e = (at(new - old) for new, old in ((after.v_e, before.v_e), (after.r_e, before.r_e)))
    return Trajectory(fine.earth, fine.t, q_eb, fine.v_e + v_e, fine.r_e + r_e)
