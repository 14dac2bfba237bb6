"""Describe how many of the shared episodes (--tarl-total) each comparison got, and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Share:
    """How many of `total` episodes a comparison got, and why it ended.

    A look is one test of the verdict. For each look, `looks` has the number of episodes and the smaller of two
    uncorrected p-values: for a loss and for more failures. `missing` is the number of further episodes needed for the
    next look, or None after the last one. `left` is how many of the `total` episodes did not run.
    """

    total: int
    comparisons: int
    looks: Sequence[tuple[int, float]]
    decided: bool
    missing: int | None
    left: int


def sentence(share: Share) -> str:
    """Return a note on the episodes that a comparison got."""
    got, even = share.looks[-1][0], share.total // share.comparisons
    seen = ", ".join(f"{p_value:.2g} after {episodes}" for episodes, p_value in share.looks)
    among = f"{share.comparisons} comparisons" if share.comparisons > 1 else "1 comparison"
    return (
        f"ran {got} of the {share.total} episodes for {among} (an even share is {even}): {_end(share)}. Uncorrected "
        f"p-value: {seen} episodes."
    )


def _end(share: Share) -> str:
    if share.decided:
        return "decided" if share.missing is None else "decided, so the rest go to the others"
    if share.missing is None:
        return "undecided after its last look"
    return f"undecided, but its next look needs {share.missing} more episodes, and only {share.left} are left"
