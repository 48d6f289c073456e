"""The runs of `damping-external-velocity`: a free INS on the rig's increments or by its error model, and filters."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from bench.errors import Array, Indices
from bench.evaluation import nees
from bench.experiments._damping_trials import (
    AUGMENTED,
    COLUMNS,
    ERRORS,
    EVERY,
    FILTERS,
    FIRST,
    FREE,
    FUSION,
    HOUR,
    SECOND,
    SIGMAS,
    TEXTS,
    WEIGHTS,
    Options,
    Work,
    filters,
    ship,
)
from bench.motion._earth_motion import EarthMotion
from bench.rotation import quat_from_rotvec, quat_multiply
from bench.solvers.damping import DampingFilter, DampingModel, DampingSolution, InsSamples, error_states
from bench.table import Table
from bench.trajectory import NavigationInitial, Trajectory

# Of the truth: errors that stay as they are.
CONSTANT = DampingModel(
    accelerometer_drift=0.0, gyro_drift=0.0, velocity_noise=0.0, attitude_noise=0.0, tau_f=1e12, tau_g=1e12
)
NOISE = 7  # spawn key of the reference's noise


class Samples(NamedTuple):
    """A chunk of a run: the INS once a second, the truth at the same times, and the true errors (m, 13)."""

    ins: InsSamples
    truth: Trajectory
    errors: Array


def told_initial(true: NavigationInitial, errors: Array) -> NavigationInitial:
    """Return what the INS is told at the start: the truth with errors dv, dL, dlambda, phi (7,)."""
    q_nb = quat_multiply(quat_from_rotvec(-errors[4:7]), true.q_nb)
    place = {"latitude": true.latitude + errors[2], "longitude": true.longitude + errors[3], "height": true.height}
    return NavigationInitial(q_nb / np.linalg.norm(q_nb), true.v_n + np.append(errors[:2], 0.0), **place)


def free_ins(
    motion: EarthMotion, rate: float, duration: float, errors: Array, seed: int, every: float = 1.0
) -> Iterator[Samples]:
    """Yield the free INS on the rig's increments, hour by hour, in samples `every` seconds apart.

    Parameters
    ----------
    motion : EarthMotion
    rate : float, Hz
    duration : float, s
    errors : ndarray, shape (13,)
        True errors at the start; those of the sensors are constant.
    seed : int
        Of the sensor errors' own noises.
    every : float, s
        A whole number of updates of two increments.
    """
    from bench.imu import SensorErrors
    from bench.imu.turn_on_bias import TurnOnBias
    from bench.rig import Rig
    from bench.solvers import solver

    biases = {"dtheta_b": -errors[10:], "dvel": errors[7:10]}  # eps is minus the gyro's error
    sensors = {name: SensorErrors((TurnOnBias(value=tuple(bias.tolist())),)) for name, bias in biases.items()}
    states = {
        name: sensor.start(3, 1 / rate, "increments", seed=seed, sensor=k)
        for k, (name, sensor) in enumerate(sensors.items())
    }
    navigation = solver("navigation", "navigation-frame", samples=2, height="held")
    told = told_initial(motion.navigation_initial(), errors)
    state = navigation.start(1 / rate, told, motion.earth)
    place = ([told.latitude], [told.longitude], [told.height])
    parts = [Trajectory.from_geodetic(motion.earth, [0.0], [told.q_nb], [told.v_n], *place)]
    step, previous = round(every * rate / 2), None
    for increments in Rig.load("imu").stream(motion, rate, duration, chunk=round(HOUR * rate)):
        read = {}
        for name, sensor in sensors.items():
            states[name], read[name] = sensor.advance(states[name], getattr(increments, name))
        state, found = navigation.advance(state, read["dtheta_b"], read["dvel"])
        parts.append(found[step - 1 :: step])
        ins = InsSamples.of(_joined(parts), previous)
        parts, previous = [], ins[-2:]
        yield _samples(ins, motion, errors)


def _joined(parts: Sequence[Trajectory]) -> Trajectory:
    names = ("t", "q_eb", "v_e", "r_e")
    return Trajectory(parts[0].earth, *(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def _samples(ins: InsSamples, motion: EarthMotion, errors: Array) -> Samples:
    truth = motion.trajectory(ins.t)
    sensors = np.tile(errors[7:], (len(ins), 1))
    return Samples(ins, truth, np.concatenate([error_states(ins, truth), sensors], axis=1))


def simulated_ins(motion: EarthMotion, duration: float, errors: Array) -> Iterator[Samples]:
    """Yield what `free_ins` does, with errors propagated by the error model instead of an INS at work."""
    from bench.error_simulation import ErrorSimulation, disturbed

    simulation = ErrorSimulation(CONSTANT)
    state, previous = simulation.start(errors), None
    for begin in range(0, round(duration) + 1, round(HOUR)):
        t = np.arange(begin, min(begin + round(HOUR), round(duration) + 1), dtype=np.float64)
        true = motion.trajectory(t)
        truth = InsSamples.of(true, previous)
        previous = truth[-2:] if previous is None or len(truth) > 1 else InsSamples.joined(previous, truth)[-2:]
        state, x = simulation.advance(state, truth)
        ins = disturbed(truth, x[:, 0])
        yield Samples(ins, true, np.concatenate([error_states(ins, true), x[:, 0, 7:]], axis=1))


class Damped(NamedTuple):
    """One filter's solution of a chunk, beside what it started from."""

    samples: Samples
    reference_error: float | Array  # east and north, if they differ
    solutions: Mapping[str, DampingSolution]


def damp(options: Options, chunks: Iterable[Samples], seed: int, errors: Sequence[float]) -> Iterator[list[Damped]]:
    """Yield the solutions of all filters for every constant error of the reference, chunk by chunk.

    All references have the same white noise, drawn from ``SeedSequence(seed, spawn_key=(NOISE,))``.
    """
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(NOISE,)))
    chain: tuple[DampingFilter, ...] = filters(options)
    states: dict[tuple[float, DampingFilter], Any] = {}
    for samples in chunks:
        noise = options.reference_noise * rng.standard_normal((len(samples.ins), 2))
        found = []
        for constant in errors:
            v_ref = samples.truth.v_n[:, :2] + constant + noise
            solutions = []
            for damping in chain:
                state = states.get((constant, damping)) or damping.start(1.0)
                states[constant, damping], solution = damping.advance(state, samples.ins, v_ref)
                solutions.append(solution)
            double, augmented = solutions
            named = {FIRST: double.parts[0], SECOND: double.parts[1], FUSION: double, AUGMENTED: augmented}
            found.append(Damped(samples, constant, named))
        yield found


def measure_ins(work: Work) -> Table:
    """Return errors, claimed standard deviations, weights and consistency of all filters behind the INS on the rig."""
    options = work.options
    chunks = free_ins(ship(options), options.rate, options.duration * HOUR, options.initial, work.seed)
    return table_of(work, damp(options, chunks, work.seed, (0.0, *options.reference_errors)))


def measure_fast(work: Work) -> Table:
    """Return the same for one reference error, by the fast mode."""
    options = work.options
    chunks = simulated_ins(ship(options), options.duration * HOUR, options.initial)
    return table_of(work, damp(options, chunks, work.seed, (options.focus,)))


def table_of(work: Work, chunks: Iterable[list[Damped]]) -> Table:
    """Return the rows of every `EVERY`-th sample."""
    tables = []
    for chunk in chunks:
        samples = chunk[0].samples
        rows = np.flatnonzero(np.round(samples.ins.t).astype(int) % EVERY == 0)
        tables.append(_free_rows(work, samples, rows))
        tables += [_rows_of(work, one, name, rows) for one in chunk for name in FILTERS]
    return Table.concatenate(tables)


def make_rows(count: int, **columns: Any) -> Table:
    """Return a table with all columns; those not given are NaN or empty."""
    empty = {name: np.full(count, "" if name in TEXTS else np.nan) for name in COLUMNS}
    given = {name: np.full(count, value) if np.ndim(value) == 0 else value for name, value in columns.items()}
    return Table({**empty, **given})


def _states(names: Sequence[str], values: Array) -> dict[str, Array]:
    return {name: values[:, k].copy() for k, name in enumerate(names[: values.shape[1]])}


def _free_rows(work: Work, samples: Samples, rows: Indices) -> Table:
    errors = _states(ERRORS, samples.errors[rows])
    return make_rows(len(rows), part=work.part, name=FREE, t_h=samples.ins.t[rows] / HOUR, **errors)


def _rows_of(work: Work, damped: Damped, name: str, rows: Indices) -> Table:
    solution, constant = damped.solutions[name], damped.reference_error
    errors = remaining(damped, name)[rows]
    more: dict[str, Any] = {}
    if solution.weight is not None and solution.gamma is not None:
        more = {**_states(WEIGHTS, solution.weight[rows]), "gamma": solution.gamma[rows]}
    return make_rows(
        len(rows),
        part=work.part,
        name=name,
        t_h=solution.t[rows] / HOUR,
        reference_m_per_s=constant,
        nees=nees(errors, solution.covariance) if len(rows) else np.empty(0),
        nis=solution.nis[rows],
        **_states(ERRORS, errors),
        **_states(SIGMAS, solution.sigma[rows]),
        **more,
    )


def remaining(damped: Damped, name: str) -> Array:
    """Return the true errors less the estimated ones: what is left in the corrected INS, shape (m, k)."""
    x = damped.solutions[name].x
    true = damped.samples.errors
    if x.shape[1] > true.shape[1]:
        reference = np.full((len(true), x.shape[1] - true.shape[1]), damped.reference_error)
        true = np.concatenate([true, reference], axis=1)
    return np.asarray(true - x)
