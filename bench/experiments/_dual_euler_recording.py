"""The recordings of `dual-euler-swing` and `dual-euler-turntable`: trial 0 on the three-axis table."""

from pathlib import Path

import numpy as np

from bench.experiment import Outcome
from bench.experiments._dual_euler_angle_trials import DUAL_INS, QUATERNION_INS
from bench.experiments._dual_euler_angles import NAMES, SETS
from bench.units import ARCMIN, DEG


def record(outcome: Outcome, path: Path) -> None:
    """Write the recording of trial 0 with the stated IMU, in the last of the cases."""
    from bench.mjcf import compile_model
    from bench.record.dual_euler import DualEulerRun, write_dual_euler_recording
    from bench.report import configuration_markdown, figure_files, results_markdown

    rows = outcome.rows.where(part="series", trial=0)
    case = str(rows["case"][-1])
    own = {name: rows.where(case=case, algorithm=name) for name in (DUAL_INS, QUATERNION_INS)}
    dual, quaternion = own[DUAL_INS], own[QUATERNION_INS]
    angles = {kind: DEG * np.stack([dual[f"{kind}_{name}_deg"] for name in NAMES], axis=1) for kind in SETS}
    shown = f"Shown: {case}, trial 0, seed {outcome.seed}, the stated IMU, pure inertial navigation."
    run = DualEulerRun(
        title=f"{outcome.experiment.name}, {case}",
        t=dual["t_s"],
        angles=angles,
        errors=ARCMIN * np.stack([dual[f"{name}_arcmin"] for name in NAMES], axis=1),
        flag=dual["flag"],
        plain_t=quaternion["t_s"],
        plain=DEG * np.stack([quaternion[f"plain_{name}_deg"] for name in NAMES], axis=1),
        model=compile_model("turntable"),
        configuration=configuration_markdown(outcome, shown),
        results=results_markdown(outcome),
        parameters={"experiment": outcome.experiment.name, "seed": outcome.seed, "case": case, "trial": 0},
        figures=figure_files(outcome, path),
    )
    write_dual_euler_recording(path, run)
