"""The recording of `damping-external-velocity`: all filters at the middle one of the reference errors."""

from pathlib import Path

import numpy as np

from bench.errors import Array
from bench.experiment import Outcome
from bench.experiments._damping_results import Results
from bench.experiments._damping_trials import ERRORS, FILTERS, FREE, FUSION, HOUR, SIGMAS, WEIGHTS, ship
from bench.table import Table
from bench.units import DEG


def record(outcome: Outcome, path: Path) -> None:
    """Write the recording from the rows of the run with the INS."""
    from bench.record.damping import DampingRun, Estimate, write_damping_recording
    from bench.report import configuration_markdown, figure_files, results_markdown

    results: Results = outcome.evaluation.focus
    options = outcome.options
    found = {name: results.table("ins", name, constant=options.focus) for name in FILTERS}
    free = results.table("ins", FREE)
    t = free["t_h"] * HOUR
    truth = ship(options).trajectory(t)
    place = np.stack([truth.latitude, truth.longitude], axis=1) / DEG

    def estimate(table: Table) -> Estimate:
        errors, sigma = _stacked(table, ERRORS), _stacked(table, SIGMAS)
        return Estimate(errors, sigma, place + errors[:, 2:4] / DEG)

    fusion = found[FUSION]
    run = DampingRun(
        title=f"{outcome.experiment.name}, C = {options.focus:g} m/s",
        t=t,
        estimates={name: estimate(table) for name, table in found.items()},
        undamped=estimate(free),
        true_place=place,
        gamma=fusion["gamma"],
        weight=_stacked(fusion, WEIGHTS),
        configuration=configuration_markdown(outcome, f"Shown: C = {options.focus:g} m/s."),
        results=results_markdown(outcome),
        parameters={"experiment": outcome.experiment.name, "seed": outcome.seed, "reference_error": options.focus},
        figures=figure_files(outcome, path),
    )
    write_damping_recording(path, run)


def _stacked(table: Table, names: tuple[str, ...]) -> Array:
    values = np.stack([table[name] for name in names], axis=1)
    return np.asarray(values[:, ~np.isnan(values).all(axis=0)])
