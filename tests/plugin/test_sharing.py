"""How the comparisons of a run share its episodes."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl import accounts
from pytest_tarl.accounts import Compared, jointly
from pytest_tarl.learning.sequential import FEWEST
from pytest_tarl.sharing import SharedEpisodes, shortage


def compared(episodes: int, p_worse: float = 0.5, decided: bool = False) -> Compared:
    online: Any = SimpleNamespace(looks=((10, 0.9), (episodes, p_worse)), decided=decided)
    none: Any = None
    return Compared("t", Path(), 80, none, online, {})


SHARED = SharedEpisodes(120, 3, 3)  # an even share is 40, and a comparison has at most 60


def test_ten_episodes_are_needed_for_each_comparison() -> None:
    assert FEWEST == 10
    assert shortage(30, 3) == ""
    assert shortage(29, 3).startswith(
        "--tarl-total=29 is too small: this run has 3 comparisons, and each needs at"
    )
    assert "Raise it to 30 or more" in shortage(29, 3)


def test_all_comparisons_begin_with_the_first_check() -> None:
    assert [look.episodes for look in SHARED.looks] == [10, 20, 40, 60]
    assert (SHARED.first.looks, SHARED.first.episodes) == (SHARED.looks, 10)


def test_the_undecided_comparison_with_the_smallest_p_value_continues() -> None:
    found = SHARED.following([compared(10, 0.3), compared(10, 0.1), compared(10, 0.01, decided=True)])
    assert found is not None
    assert (found[0], found[1].episodes, found[1].looks) == (1, 20, SHARED.looks)
    assert SHARED.following([compared(60), compared(10, decided=True), "error"]) is None


def test_the_next_check_must_fit_into_the_episodes_left() -> None:
    found = SHARED.following([compared(40, 0.01), compared(20, 0.2), compared(40, decided=True)])
    assert found is not None  # twenty are left, and either comparison needs twenty
    assert (found[0], found[1].episodes) == (0, 60)
    assert SHARED.following([compared(40, 0.01), compared(20, 0.2), compared(41, decided=True)]) is None


def test_a_note_states_how_each_comparison_ended() -> None:
    outcomes = [compared(60), compared(20, 0.01, decided=True), compared(21), "error"]
    notes = SHARED.notes(outcomes)
    assert notes[3] == ""
    assert (
        "ran 60 of the 120 episodes for 3 comparisons (an even share is 40): undecided after its last"
        in notes[0]
    )
    assert "Uncorrected p-value: 0.9 after 10, 0.5 after 60 episodes." in notes[0]
    assert "decided, so the rest go to the others" in notes[1]
    assert "its next look needs 19 more episodes, and only 19 are left" in notes[2]


def test_comparisons_are_corrected_together(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: Any = []
    monkeypatch.setattr(
        accounts, "corrected", lambda many, alpha: asked.append((many, alpha)) or ["new", "other"]
    )
    found: list[Any] = jointly([compared(10), compared(20)], 0.05)
    assert asked == [([None, None], 0.05)]
    assert [one.comparison for one in found] == ["new", "other"]
    assert [one.online.looks[-1][0] for one in found] == [10, 20]
