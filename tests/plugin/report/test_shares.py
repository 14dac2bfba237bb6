"""The note on a comparison's share of the episodes of a run."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pytest_tarl.report.shares import Share, sentence

SHARE = Share(total=100, comparisons=3, looks=((8, 0.0321), (20, 0.0004)), decided=True, missing=12, left=40)


def test_note_states_the_even_share_and_every_check() -> None:
    assert sentence(SHARE) == (
        "ran 20 of the 100 episodes for 3 comparisons (an even share is 33): decided, so the rest go to the others. "
        "Uncorrected p-value: 0.032 after 8, 0.0004 after 20 episodes."
    )


def test_the_note_counts_one_comparison_in_the_singular() -> None:
    assert "20 of the 100 episodes for 1 comparison (an even share is 100)" in sentence(
        replace(SHARE, comparisons=1)
    )
    assert "for 2 comparisons (an even share is 50)" in sentence(replace(SHARE, comparisons=2))


@pytest.mark.parametrize(
    ("decided", "missing", "end"),
    [
        (True, 12, "decided, so the rest go to the others"),
        (True, None, "decided"),
        (False, None, "undecided after its last look"),
        (False, 12, "undecided, but its next look needs 12 more episodes, and only 9 are left"),
    ],
)
def test_the_note_says_why_the_comparison_ended(decided: bool, missing: int | None, end: str) -> None:
    told = sentence(replace(SHARE, decided=decided, missing=missing, left=9))
    assert told.partition("): ")[2].startswith(f"{end}. Uncorrected")
