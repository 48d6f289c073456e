"""What a solved recording leaves in its folder: tables, figures, recording, report and result."""

from pathlib import Path
from typing import Any

from bench._solve_report import (
    error_table,
    facts_table,
    report_blocks,
    solution_figures,
    state_table,
    states,
    summary_table,
    trajectory_table,
)
from bench.errors import Array
from bench.experiment import versions
from bench.output import Content
from bench.solve_job import SolveOutcome
from bench.table import Table
from bench.trajectory import Trajectory


def content_of(outcome: SolveOutcome, *, record: bool) -> Content:
    """Return tables, figures, recording, report and result of a solved job."""
    solution = outcome.solution
    tables = {"trajectory": trajectory_table(solution)}
    if solution.comparison is not None:
        tables["errors"] = error_table(solution.comparison.errors, attitude_only=solution.attitude_only)
    inputs, packages = outcome.inputs, versions()
    facts: dict[str, Table] = {
        "Recording": facts_table("Recording", {**inputs["recording"], **outcome.timing, **outcome.counts}),
        "Options": facts_table("Options", {key: value for key, value in inputs.items() if key != "recording"}),
        "Versions": facts_table("Versions", packages),
    }
    return Content(
        title=outcome.job.title,
        tables=tables,
        figures=solution_figures(solution),
        record=(lambda path, files: _record(outcome, facts, path, files)) if record else None,
        report=lambda files: report_blocks(outcome.job.title, outcome.summary, solution, facts, files),
        result=lambda: _result(outcome, packages),
    )


def _result(outcome: SolveOutcome, packages: dict[str, str]) -> dict[str, Any]:
    solution = outcome.solution
    errors = None
    if solution.comparison is not None:
        errors = _rows(summary_table(solution.comparison.errors, attitude_only=solution.attitude_only))
    return {
        **outcome.inputs,
        "versions": packages,
        "times": outcome.timing,
        "increments": outcome.counts,
        "warnings": list(outcome.warnings),
        "initial_found": outcome.beginning.note,
        "states": states(solution),
        "errors": errors,
        "summary": outcome.summary,
    }


def _rows(table: Table) -> list[dict[str, Any]]:
    columns = {name: column.tolist() for name, column in table.columns.items()}
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def _record(outcome: SolveOutcome, facts: dict[str, Table], path: Path, files: dict[str, Path]) -> None:
    from bench.record.navigation import NavigationEstimate, NavigationRun, write_navigation_recording

    solution = outcome.solution
    start, compared = float(solution.trajectory.t[0]), solution.comparison
    results = [f"# {outcome.job.title}", outcome.summary]
    if compared is not None:
        results.append(summary_table(compared.errors, attitude_only=solution.attitude_only).markdown())
    results.append(state_table(solution).markdown())
    estimate = NavigationEstimate(
        _since(solution.trajectory, start),
        *((None, None) if compared is None else (_since(compared.reference, start), _since(compared.estimate, start))),
    )
    run = NavigationRun(
        title=outcome.job.title,
        estimates={solution.solver.name: estimate},
        configuration=f"t = 0 here is t = {start:.6f} s of the recording.\n\n"
        + "\n\n".join(f"## {heading}\n\n{table.markdown()}" for heading, table in facts.items()),
        results="\n\n".join(results),
        truth=estimate.truth,
        truth_name="reference",
        parameters={
            "recording": str(outcome.job.imu),
            "solver": solution.solver.name,
            "initial": outcome.beginning.note,
        },
        attitude_only=solution.attitude_only,
        figures={figure.title: files[f"figure {figure.name}"] for figure in solution_figures(solution)},
    )
    write_navigation_recording(path, run)


def _since(trajectory: Trajectory, start: float) -> Trajectory:
    t: Array = trajectory.t - start
    return Trajectory(trajectory.earth, t, trajectory.q_eb, trajectory.v_e, trajectory.r_e)
