"""What every experiment does with its verdicts: count them, and withhold those that a run cannot judge."""

from typing import Any

from bench.experiment import Verdict


def withhold(verdicts: dict[str, Verdict], reason: str) -> dict[str, Verdict]:
    """Return the verdicts of a run that is not at the paper's conditions: none, with the measured values kept."""
    if not reason:
        return verdicts
    return {key: Verdict("cannot be judged", verdict.measured, reason) for key, verdict in verdicts.items()}


def tally(verdicts: dict[str, Verdict]) -> str:
    """Return how many claims hold, in words."""
    count: dict[str, Any] = {
        word: sum(v.judgement == word for v in verdicts.values())
        for word in ("holds", "does not hold", "cannot be judged")
    }
    return (
        f"Of {len(verdicts)} claims {count['holds']} hold, {count['does not hold']} do not hold and "
        f"{count['cannot be judged']} cannot be judged."
    )
