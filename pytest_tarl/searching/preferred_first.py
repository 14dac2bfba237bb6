"""Yield the changes preferred to a confirmed change, then the change itself, even if the budget ends in between."""

from __future__ import annotations

from collections.abc import Iterator

from pytest_tarl.searching.search import BudgetSpentError, Candidate


def then(found: Candidate, preferred: Iterator[Candidate]) -> Iterator[Candidate]:
    """Yield the candidates of `preferred`, then `found`. Raise BudgetSpentError, but only after `found`.

    Looking for preferred changes may spend the last episodes of a search. `found` is confirmed by then, and its
    examination may use episodes that the search may not (see `Trials.granting`).
    """
    try:
        yield from preferred
    except BudgetSpentError:
        yield found
        raise
    yield found
