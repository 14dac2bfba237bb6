"""Changes that are tried during the search of constants, depending on its episodes so far and its best gain."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.repairing import early
from pytest_tarl.repairing.early import FROM, LATER, MOST, SOON, Early

WANTED = 10.0  # so that a constant counts as helpful in part from a gain of 2, and readings are right from 5


class Phases(Early):
    """Yields the names of its phases in place of candidates."""

    def __init__(self, spent: int, recorded: bool) -> None:
        order: Any = SimpleNamespace(goal=SimpleNamespace(wanted=WANTED))
        trials: Any = SimpleNamespace(spent=spent)
        super().__init__(order, (), trials)
        self._recorded = ("pair",) if recorded else ()  # type: ignore[assignment]

    def corrected(self) -> Iterator[Any]:
        yield "readings"

    def _surely(self, symptoms: bool) -> Iterator[Any]:
        yield "clearest symptoms" if symptoms else "factors"

    def signs(self, trials: Any) -> Any:
        trials.spent += 2  # recording the missions takes episodes
        return None


class Structures:
    def __init__(self, *_: Any, **__: Any) -> None:
        pass

    def early(self, most: int, once: bool) -> Iterator[Any]:
        yield f"changes {most} {once}"


@pytest.mark.parametrize(
    ("best", "spent", "recorded", "expected"),
    [
        (0.0, 0, False, []),
        (0.0, 0, True, ["readings"]),
        (4.9, 0, True, ["readings"]),
        (5.0, 0, True, []),
        (0.0, SOON - 1, True, ["readings"]),
        (0.0, SOON, True, ["readings", "clearest symptoms"]),
        (0.0, SOON, False, []),
        (1.9, SOON, True, ["readings", "clearest symptoms"]),
        (2.0, SOON, True, ["readings", "factors"]),
        (1.9, FROM - 1, False, []),
        (1.9, FROM, False, [f"changes {MOST} True"]),
        (2.0, FROM, False, []),
        (2.0, LATER - 1, False, []),
        (2.0, LATER, False, [f"changes {MOST} False"]),
        (9.0, LATER, True, ["factors", f"changes {MOST} False"]),
    ],
)
def test_phases_begin_late_if_a_constant_helps(
    best: float, spent: int, recorded: bool, expected: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(early, "Structures", Structures)
    assert [*Phases(spent, recorded).candidates(best)] == expected


def test_changes_are_tried_once_and_their_episodes_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(early, "Structures", Structures)
    found = Phases(FROM, recorded=False)
    states = [(found.waiting, found.spent) for _ in found.candidates()]
    assert (states, found.waiting, found.spent) == ([(True, 2)], False, 2)
    assert [*found.candidates()] == []
