"""The recording of `gyro-free-circular`: the trial that is nearest to the printed numbers."""

from pathlib import Path

from bench.experiment import Outcome
from bench.experiments._gyro_free_trials import SYSTEMS, ideal, solve_trial


def record(outcome: Outcome, path: Path) -> None:
    """Write the recording of the focused trial, both systems in one scene."""
    from bench.mjcf import compile_model
    from bench.record.gyro_free import GyroFreeRun, write_gyro_free_recording
    from bench.report import configuration_markdown, results_markdown

    options, focus = outcome.options, outcome.evaluation.focus
    fixed = ideal(options, focus.reading.gravity)
    found = {s: solve_trial(focus.work(options, outcome.seed), focus.trial, s) for s in SYSTEMS}
    shown = f"Reading of the conditions: **{focus.reading.label}**; trial {focus.trial}, seed {outcome.seed}."
    run = GyroFreeRun(
        title=f"{outcome.experiment.name}, trial {focus.trial}",
        model=compile_model(SYSTEMS["nine"]),
        accelerometers=fixed.accelerometers["nine"],
        readings=found["nine"][0],
        truth=fixed.truth,
        estimates={f"{system} accelerometers": solution for system, (_, solution) in found.items()},
        configuration=configuration_markdown(outcome, shown),
        results=results_markdown(outcome),
        parameters={"experiment": outcome.experiment.name, "seed": outcome.seed, "trial": focus.trial},
    )
    write_gyro_free_recording(path, run)
