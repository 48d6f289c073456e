"""Fast second mode of the damping experiments: errors of an INS simulated by their model instead of running the INS.

A free INS at 100 Hz is the truth of the matter; where thousands of hours are needed, as for consistency over Monte
Carlo trials, the 13 errors are propagated along the true path once a second, X' = F X + w, for many trials at once. F
is taken half-way between truth and INS, where all terms of second order vanish: with F of the true path alone, filters
seem inconsistent after 10 h that are not::

    truth = InsSamples.of(motion.trajectory(t))
    simulation = ErrorSimulation(DampingModel(), trials=50, seed=1)
    _, x = simulation.advance(simulation.start(), truth)      # (m, 50, 13)
    solution = damping.solve(disturbed(truth, x[:, 7]), reference_velocity(truth, noise=0.05, seed=1, trial=7))
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, require_array, require_instance, require_integer, require_scalar
from bench.imu._options import fork
from bench.rotation import quat_from_rotvec, quat_multiply, quat_normalize
from bench.solvers.damping import DampingModel, InsSamples
from bench.solvers.damping._model import PUBLISHED
from bench.trajectory import Trajectory

SIZE = 13
NOISE, REFERENCE = 0, 1  # last part of the spawn keys


class SimulationState(NamedTuple):
    """Where a simulation stands between two chunks: generators, errors (trials, 13) and the last sample."""

    generators: tuple[np.random.Generator, ...]
    x: Array
    last: InsSamples | None


@dataclass(frozen=True)
class ErrorSimulation:
    """Errors of an INS of held height along a true path, in many trials.

    Trial k draws from ``SeedSequence(seed, spawn_key=(k, 0))``: alone or among others it has the same errors, and
    so for any chunks.

    Parameters
    ----------
    model : DampingModel
        Of the truth: initial errors are normal with its standard deviations, unless they are given to `start`; white
        noises and Markov drifts are its own. Constant sensor errors are those of a very long tau.
    trials : int
    seed : int

    Raises
    ------
    InputError
        If an option is out of range.
    """

    model: DampingModel = PUBLISHED
    trials: int = 1
    seed: int = 0

    def __post_init__(self) -> None:
        require_instance("model", self.model, DampingModel)
        require_integer("trials", self.trials, minimum=1)
        require_integer("seed", self.seed, minimum=0)

    def start(self, initial: ArrayLike | None = None) -> SimulationState:
        """Return the state before the first sample.

        Parameters
        ----------
        initial : array_like, shape (13,) or (trials, 13), optional
            Errors at the first sample; drawn if not given.

        Raises
        ------
        InputError
            If `initial` has another shape.
        """
        generators = tuple(_generator(self.seed, trial, NOISE) for trial in range(self.trials))
        x = self.model.initial_std * np.stack([rng.standard_normal(SIZE) for rng in generators])
        if initial is not None:
            shape: tuple[int, ...] = (SIZE,) if np.ndim(initial) == 1 else (self.trials, SIZE)
            x = np.array(np.broadcast_to(require_array("initial", initial, shape), x.shape))
        return SimulationState(generators, x, None)

    def advance(self, state: SimulationState, truth: InsSamples) -> tuple[SimulationState, Array]:
        """Return the next state and the errors at the true samples of a chunk, shape (m, trials, 13).

        The first sample of a run has the initial errors.

        Raises
        ------
        InputError
            If an argument is of another class, or the samples do not follow those of the chunk before.
        """
        require_instance("state", state, SimulationState)
        require_instance("truth", truth, InsSamples)
        from bench._error_simulation_kernels import propagate
        from bench.solvers.damping._samples import deflection
        from bench.solvers.damping._serial import path_rows, rates, shares

        path = truth if state.last is None else InsSamples.joined(state.last, truth)
        steps, first = len(path) - 1, 1 if state.last is None else 0
        generators, out = tuple(fork(rng) for rng in state.generators), np.empty((steps + first, self.trials, SIZE))
        x = state.x.copy()
        out[:first] = x
        if steps:
            dt = float(path.t[-1] - path.t[0]) / steps
            normals = np.stack([rng.standard_normal((steps, SIZE)) for rng in generators], axis=1)
            gain = np.sqrt(self.model.density * dt)
            rate, earth = rates(self.model), truth.earth
            propagate(
                *(earth.parameters, deflection(earth), dt, path_rows(path), path.f_n[1:]),
                *(rate, shares(rate, dt), gain, normals, x, out[first:]),
            )
        return SimulationState(generators, x, truth[-1:]), out


def disturbed(truth: InsSamples, x: ArrayLike) -> InsSamples:
    """Return what an INS with errors x (m, 13) or (m, 7) says on the true path.

    Raises
    ------
    InputError
        If `truth` is of another class, or the errors have another shape or are not finite.
    """
    require_instance("truth", truth, InsSamples)
    columns = np.shape(x)[-1] if np.ndim(x) == 2 else SIZE
    x = require_array("x", x, (len(truth), columns if columns in (7, 15) else SIZE))
    v_n = truth.v_n.copy()
    v_n[:, :2] += x[:, :2]
    q_nb = quat_normalize(quat_multiply(quat_from_rotvec(-x[:, 4:7]), truth.q_nb))
    latitude, longitude = truth.latitude + x[:, 2], truth.longitude + x[:, 3]
    return InsSamples.of(Trajectory.from_geodetic(truth.earth, truth.t, q_nb, v_n, latitude, longitude, truth.height))


def reference_velocity(
    truth: InsSamples, *, error: ArrayLike = (0.0, 0.0), noise: float, seed: int, trial: int = 0
) -> Array:
    """Return a reference velocity east and north, shape (m, 2), m/s: truth, a constant error and white noise (Eq. 11).

    Parameters
    ----------
    truth : InsSamples
        Of the whole run.
    error : array_like, shape (2,), m/s
        C_E, C_N.
    noise : float, m/s
        Standard deviation of each value.
    seed, trial : int

    Raises
    ------
    InputError
        If an argument breaks its rule.
    """
    require_instance("truth", truth, InsSamples)
    error = require_array("error", error, (2,))
    noise = require_scalar("noise", noise, minimum=0.0)
    rng = _generator(require_integer("seed", seed, minimum=0), require_integer("trial", trial, minimum=0), REFERENCE)
    return truth.v_n[:, :2] + error + noise * rng.standard_normal((len(truth), 2))


def _generator(seed: int, trial: int, use: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(trial, use)))
