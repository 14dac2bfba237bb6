"""The interface of all searches."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

from pytest_tarl.model import OperandEffect
from pytest_tarl.searching.search import Candidate


class Strategy(Protocol):
    """Interface of a search."""

    def candidates(self) -> Iterator[Candidate]:
        """Yield confirmed candidates, best first. Raise BudgetSpentError."""

    def effects(self) -> dict[str, list[OperandEffect]]:
        """Return, for each site id, the best gain found for each of its operands."""
