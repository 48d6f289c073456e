"""The recording of `ins-frames`: the algorithms in the hard weave with attitude motion, where most is to be seen."""

from pathlib import Path

from bench.experiment import Outcome
from bench.experiments._ins_frames_trials import (
    BEST,
    BEST_SAMPLES,
    CONVENTIONAL,
    DUAL,
    HARSH,
    IMPROVED,
    IMPROVED_FIRST,
    SAMPLES,
    Flight,
    fly,
    postponed,
    truth,
)


def record(outcome: Outcome, path: Path) -> None:
    """Write the recording of one flight, at the middle one of the speeds."""
    from bench.record.navigation import NavigationEstimate, NavigationRun, write_navigation_recording
    from bench.report import configuration_markdown, figure_files, results_markdown

    options = outcome.options
    flight = Flight(sorted(options.speeds)[len(options.speeds) // 2], HARSH, True)
    estimates = {}
    for algorithm in (CONVENTIONAL, IMPROVED, DUAL, IMPROVED_FIRST, postponed(max(options.postponed)), BEST):
        samples = BEST_SAMPLES if algorithm is BEST else SAMPLES
        found = fly(flight, algorithm, options.rate, options.duration, samples)
        true = truth(flight, options.rate, len(found) - 1, samples)
        estimates[algorithm.label] = NavigationEstimate(found, true)
    run = NavigationRun(
        title=f"{outcome.experiment.name}, {flight.label}",
        estimates=estimates,
        truth=estimates[DUAL.label].truth,
        configuration=configuration_markdown(outcome, f"Shown: {flight.label}, {options.rate:g} Hz."),
        results=results_markdown(outcome),
        parameters={"experiment": outcome.experiment.name, "flight": flight.label, "rate_hz": options.rate},
        figures=figure_files(outcome, path),
    )
    write_navigation_recording(path, run)
