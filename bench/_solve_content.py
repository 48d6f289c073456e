"""What a solved recording leaves in its folder: tables, figures, recording, report and result."""

from pathlib import Path
from typing import Any

from bench._damp_report import consistency_table, filter_table
from bench._solve_report import (
    error_table,
    facts_table,
    report_blocks,
    solution_figures,
    state_table,
    states,
    summary_tables,
    trajectory_table,
)
from bench.errors import Array
from bench.experiment import versions
from bench.interpolation import Comparison
from bench.output import Content
from bench.solve_job import SolveOutcome
from bench.table import Table
from bench.trajectory import Trajectory


def content_of(outcome: SolveOutcome, *, record: bool) -> Content:
    """Return tables, figures, recording, report and result of a solved job."""
    solution, damped = outcome.solution, outcome.damped
    tables = {"trajectory": trajectory_table(solution.trajectory, attitude_only=solution.attitude_only)}
    if solution.comparison is not None:
        tables["errors"] = error_table(solution.comparison.errors, attitude_only=solution.attitude_only)
    if damped is not None:
        tables |= {"damped": trajectory_table(damped.trajectory), "filter": filter_table(damped)}
        if damped.comparison is not None:
            tables["damped_errors"] = error_table(damped.comparison.errors, attitude_only=False)
    inputs, packages = outcome.inputs, versions()
    facts: dict[str, Table] = {
        "Recording": facts_table("Recording", {**inputs["recording"], **outcome.timing, **outcome.counts}),
        "Options": facts_table("Options", {key: value for key, value in inputs.items() if key != "recording"}),
        "Versions": facts_table("Versions", packages),
    }
    return Content(
        title=outcome.job.title,
        tables=tables,
        figures=solution_figures(solution, damped),
        record=(lambda path, files: _record(outcome, facts, path, files)) if record else None,
        report=lambda files: report_blocks(outcome.job.title, outcome.summary, solution, damped, facts, files),
        result=lambda: _result(outcome, packages),
    )


def _result(outcome: SolveOutcome, packages: dict[str, str]) -> dict[str, Any]:
    solution, damped = outcome.solution, outcome.damped
    errors = [_rows(table) for table in summary_tables(solution, damped)]
    return {
        **outcome.inputs,
        "versions": packages,
        "times": outcome.timing,
        "increments": outcome.counts,
        "warnings": list(outcome.warnings),
        "initial_found": outcome.beginning.note,
        "states": states(solution, damped),
        "errors": errors[0] if errors else None,
        "damping": damped and {"stages": _rows(consistency_table(damped)), "errors": errors[1] if errors else None},
        "summary": outcome.summary,
    }


def _rows(table: Table) -> list[dict[str, Any]]:
    columns = {name: [None if x != x else x for x in column.tolist()] for name, column in table.columns.items()}
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def _record(outcome: SolveOutcome, facts: dict[str, Table], path: Path, files: dict[str, Path]) -> None:
    from bench.record._filter_traces import filter_plots
    from bench.record.navigation import NavigationEstimate, NavigationRun, write_navigation_recording

    solution = outcome.solution
    damped, start = outcome.damped, float(solution.trajectory.t[0])
    tables = [
        *summary_tables(solution, damped),
        *([consistency_table(damped)] if damped else []),
        state_table(solution, damped),
    ]
    results = [f"# {outcome.job.title}", outcome.summary, *(f"{table.title}\n\n{table.markdown()}" for table in tables)]

    def estimate(trajectory: Trajectory, compared: Comparison | None) -> NavigationEstimate:
        if compared is None:
            return NavigationEstimate(_since(trajectory, start))
        return NavigationEstimate(
            *(_since(track, start) for track in (trajectory, compared.reference, compared.estimate))
        )

    estimates = {solution.solver.name: estimate(solution.trajectory, solution.comparison)}
    if damped is not None:
        estimates[damped.filter.name] = estimate(damped.trajectory, damped.comparison)
    run = NavigationRun(
        title=outcome.job.title,
        estimates=estimates,
        configuration=f"t = 0 here is t = {start:.6f} s of the recording.\n\n"
        + "\n\n".join(f"## {heading}\n\n{table.markdown()}" for heading, table in facts.items()),
        results="\n\n".join(results),
        truth=estimates[solution.solver.name].truth,
        truth_name="reference",
        parameters={
            "recording": str(outcome.job.imu),
            "solver": solution.solver.name,
            "initial": outcome.beginning.note,
        },
        attitude_only=solution.attitude_only,
        figures={figure.title: files[f"figure {figure.name}"] for figure in solution_figures(solution, damped)},
        pages={} if damped is None else filter_plots(damped, start),
    )
    write_navigation_recording(path, run)


def _since(trajectory: Trajectory, start: float) -> Trajectory:
    t: Array = trajectory.t - start
    return Trajectory(trajectory.earth, t, trajectory.q_eb, trajectory.v_e, trajectory.r_e)
