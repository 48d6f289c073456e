"""The work of `damping-external-velocity` in parts: which there are, and what does each."""

from bench.campaign import Item
from bench.experiments._damping_consistency import measure_consistency
from bench.experiments._damping_runs import measure_fast, measure_ins
from bench.experiments._damping_scan import measure_scan
from bench.experiments._damping_trials import TRIALS_AN_ITEM, Options, Work
from bench.experiments._damping_undamped import measure_undamped
from bench.table import Table

PARTS = {
    "ins": measure_ins,
    "fast": measure_fast,
    "scan": measure_scan,
    "consistency": measure_consistency,
    "undamped": measure_undamped,
}


def items(options: Options, seed: int) -> list[Item]:
    """Return the INS on the rig first (the longest), then scans and trials of the fast mode."""
    work = [Work(options, seed, "ins")]
    work += [Work(options, seed, "scan", k) for k in range(len(options.latitudes))]
    work += [Work(options, seed, "consistency", k) for k in range(0, options.trials, TRIALS_AN_ITEM)]
    work += [Work(options, seed, "undamped"), Work(options, seed, "fast")]
    return [Item(f"{k:02d}-{one.part}", one) for k, one in enumerate(work)]


def measure(work: Work) -> Table:
    """Do one item."""
    return PARTS[work.part](work)
