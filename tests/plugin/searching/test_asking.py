"""Plugged-in searches: the ask/tell calls, and messages for faulty plug-ins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.errors import SearchError, SettingsError
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.ask_tell import Asking, Constant, factory
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Trials
from tests.plugin.searching.test_search import GAIN, GOAL, NEEDED, OPERANDS, reward, run


class Grid:
    """Move one constant after the other, without random numbers."""

    def __init__(self, constants: Sequence[Constant], seed: int) -> None:
        self.constants = constants
        self.seed = seed
        self.points = [
            [factor if i == at else 1.0 for i in range(len(constants))]
            for factor in (2.0, 3.0, 0.4)
            for at in range(len(constants))
        ]
        self.told: list[tuple[Sequence[float], float]] = []

    def ask(self) -> Sequence[float]:
        if not self.points:
            raise StopIteration
        return self.points.pop(0)

    def tell(self, factors: Sequence[float], gain: float) -> None:
        self.told.append((factors, gain))


def asking(make: Any, trials: Trials) -> Asking:
    return Asking("own:search", make, OPERANDS, mutations, (ALWAYS,), trials, GOAL, seed=7)


def test_optimiser_gets_constants_and_gains() -> None:
    made: list[Grid] = []

    def make(constants: Sequence[Constant], seed: int) -> Grid:
        made.append(Grid(constants, seed))
        return made[0]

    found = next(asking(make, Trials(run, 100)).candidates())
    assert [mutation.operand for mutation in found.mutations] == [GAIN]
    (grid,) = made
    assert grid.seed == 7
    assert grid.constants[-1] == Constant("node.py", 3, "2.0", 2.0)
    by_point = {tuple(point): gain for point, gain in grid.told}
    assert by_point[1.0, 2.0, 1.0] == pytest.approx(0.0, abs=1e-12)  # same seed, so no noise
    assert by_point[1.0, 1.0, 2.0] == pytest.approx(6 * math.log(2.0))


def test_unneeded_mutations_are_left_out() -> None:
    class All(Grid):
        def ask(self) -> Sequence[float]:
            return [1.0, 1.7, NEEDED]

    def last(candidate: Candidate, seed: int) -> Outcome:
        return run(Candidate(candidate.mutations[-1:], candidate.guard), seed)

    search = asking(All, Trials(last, 100))
    found = next(search.candidates())
    assert [mutation.operand for mutation in found.mutations] == [GAIN]
    assert list(search.effects()) == [str(GAIN.site)]


def test_whole_batch_is_requested_before_gains_are_told() -> None:
    seen: list[str] = []

    class Batch(Grid):
        batch = 3

        def ask(self) -> Sequence[float]:
            seen.append("ask")
            return super().ask()

        def tell(self, factors: Sequence[float], gain: float) -> None:
            seen.append("tell")

    foreseen: list[int] = []
    trials = Trials(run, 100, foresee=lambda wanted: foreseen.append(len(wanted)))
    next(asking(Batch, trials).candidates())
    assert seen[:6] == ["ask"] * 3 + ["tell"] * 3
    assert foreseen[0] == 3


def test_stop_iteration_ends_the_search() -> None:
    def never(candidate: Candidate, seed: int) -> Outcome:
        return Outcome(reward(None, seed), passed=False)

    trials = Trials(never, 100)
    assert list(asking(Grid, trials).candidates()) == []
    assert trials.spent < 100


def test_repeated_proposals_end_the_search() -> None:
    class Still(Grid):
        def ask(self) -> Sequence[float]:
            return [1.0, 1.0, 1.0]

    trials = Trials(run, 100)
    assert list(asking(Still, trials).candidates()) == []
    assert trials.spent == 0


def test_spent_budget_ends_a_batch() -> None:
    class Away(Grid):
        batch = 5

        def ask(self) -> Sequence[float]:
            self.turn = getattr(self, "turn", 0) + 1
            return [2.0 + self.turn, 1.0, 1.0]

    trials = Trials(run, 12)
    with pytest.raises(BudgetSpentError):
        list(asking(Away, trials).candidates())
    assert trials.spent == 12


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ([1.0], "a finite factor for each of the 3 constants"),
        ([1.0, 1.0, math.nan], "a finite factor for each of the 3 constants"),
        (["one", 1.0, 1.0], r"ask\(\) raised ValueError"),
        (None, r"ask\(\) raised TypeError"),
    ],
)
def test_an_invalid_proposal_is_reported(asked: Any, words: str) -> None:
    class Wrong(Grid):
        def ask(self) -> Sequence[float]:
            return asked  # type: ignore[no-any-return]

    with pytest.raises(SearchError, match=words):
        next(asking(Wrong, Trials(run, 10)).candidates())


def test_plug_in_exception_is_reported_with_its_line() -> None:
    class Broken(Grid):
        def tell(self, factors: Sequence[float], gain: float) -> None:
            raise ZeroDivisionError("by nothing")

    with pytest.raises(
        SearchError, match=r"tell\(\) raised ZeroDivisionError: by nothing \(test_asking.py, line"
    ):
        next(asking(Broken, Trials(run, 10)).candidates())


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda constants, seed: object(), "no method ask and no tell"),
        (lambda constants: None, "its factory raised TypeError"),
        (type("Odd", (Grid,), {"batch": 0}), "batch must be a whole number"),
    ],
)
def test_an_object_that_is_not_an_optimiser_is_reported(make: Any, words: str) -> None:
    with pytest.raises(SearchError, match=words):
        asking(make, Trials(run, 10))


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("nowhere_to_be_found:Search", "No module named 'nowhere_to_be_found'"),
        ("plugged_mine:Serach", "plugged_mine has no 'Serach'"),
        ("plugged_mine:NUMBER", "not a function or a class"),
        (
            "plugged_torn:Search",
            r"plugged_torn cannot be imported: NameError: .* \(plugged_torn.py, line 1\)",
        ),
    ],
)
def test_an_unknown_module_or_factory_is_reported(tmp_path: Path, name: str, words: str) -> None:
    (tmp_path / "plugged_mine.py").write_text("NUMBER = 3\n")
    (tmp_path / "plugged_torn.py").write_text("nothing\n")
    with pytest.raises(SettingsError, match=words):
        factory(name, (tmp_path,))
