"""The recordings of `attitude-coning` and `attitude-manoeuvre`: three samples per update, and the best beside them."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from bench.errors import Array
from bench.experiment import Outcome
from bench.experiments import _attitude_coning_trials as coning
from bench.experiments import _attitude_manoeuvre_trials as manoeuvre
from bench.experiments._attitude_trials import (
    HYBRID,
    NEW,
    OPTIMISED,
    QUATERNION,
    READINGS,
    WINDOW,
    Algorithm,
    quantised,
    solve,
    update_times,
)
from bench.motion import Motion

SHOWN = (*((algorithm, 3) for algorithm in (*READINGS.values(), *NEW, HYBRID)), (WINDOW, 4))
SHOWN_QUANTISED = ((OPTIMISED, 3), (QUATERNION, 3))


def record_coning(outcome: Outcome, path: Path) -> None:
    """Write the recording at the lowest rate, where errors are largest; with two of quantised increments."""
    rate = min(outcome.options.rates)
    dtheta_b = coning.ideal(rate, outcome.options.duration)
    pulses = quantised(dtheta_b, 1 / rate, outcome.seed, 0)
    _record(outcome, path, coning.MOTION, rate, {"": (dtheta_b, SHOWN), ", quantised": (pulses, SHOWN_QUANTISED)})


def record_manoeuvre(outcome: Outcome, path: Path) -> None:
    """Write the recording of the manoeuvre; ideal, since quantisation hides all differences by orders."""
    rate = outcome.options.rate
    _record(outcome, path, manoeuvre.MOTION, rate, {"": (manoeuvre.ideal(rate), SHOWN)})


def _record(
    outcome: Outcome,
    path: Path,
    motion: Motion,
    rate: float,
    runs: Mapping[str, tuple[Array, Sequence[tuple[Algorithm, int]]]],
) -> None:
    """Write a recording of runs: increments and what solves them, by what is added to the names."""
    from bench.mjcf import compile_model
    from bench.record.attitude import AttitudeEstimate, AttitudeRun, write_attitude_recording
    from bench.report import configuration_markdown, figure_files, results_markdown

    estimates = {}
    for label, (dtheta_b, shown) in runs.items():
        for algorithm, samples in shown:
            t = update_times(len(dtheta_b), samples, rate)
            q_true = motion.kinematics(t).q_ib
            q = solve(algorithm, samples, dtheta_b, 1 / rate, q_true[0])
            estimates[f"{algorithm.label}, N = {samples}{label}"] = AttitudeEstimate(t, q, q_true)
    phase = f"; quantised: phase 0 of the quantiser, seed {outcome.seed}" if len(runs) > 1 else ""
    run = AttitudeRun(
        title=f"{outcome.experiment.name}, {rate:g} Hz",
        estimates=estimates,
        configuration=configuration_markdown(outcome, f"Shown: {rate:g} Hz, ideal increments{phase}."),
        results=results_markdown(outcome),
        parameters={"experiment": outcome.experiment.name, "seed": outcome.seed, "rate_hz": rate},
        model=compile_model("imu"),
        figures=figure_files(outcome, path),
    )
    write_attitude_recording(path, run)
