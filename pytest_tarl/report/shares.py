"""Describe how many of the shared episodes (--tarl-total) a comparison got, and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Share:
    """A comparison's share of `total` episodes, and why it ended.

    A look is one test of the verdict. `looks` holds two numbers for each look: its number of episodes, and the smaller
    of two uncorrected p-values (of a loss, and of more failures). `missing` is the number of further episodes that the
    next look needs, or None after the last look. `left` is the number of episodes of `total` that were not run.
    """

    total: int
    comparisons: int
    looks: Sequence[tuple[int, float]]
    decided: bool
    missing: int | None
    left: int


def sentence(share: Share) -> str:
    """Return the note about a comparison's share."""
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
