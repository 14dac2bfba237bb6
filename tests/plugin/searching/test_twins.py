"""Constants that a program writes several times change together."""

from __future__ import annotations

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.twins import assigned_alone, twin_of, twins
from pytest_tarl.searching.units import Unit, units
from tarl_lint.model import Operand, SiteId, Span


def literal(line: int, text: str, value: float, path: str = "node.py") -> Operand:
    """Return the number of a statement such as `turn = 0.1`."""
    span = Span(path, line, 8, line, 11)
    return Operand(SiteId("node", "path", text, line), span, str(value), value, span)


def name(line: int, code: str, function: str = "drive") -> Operand:
    """Return the use of a name that stands for several constants."""
    span = Span("node.py", line, 8, line, 8 + len(code))
    return Operand(SiteId("node", function, f"x = -{code}", line), span, code, None)


FIRST, SECOND = literal(4, "turn = 0.1", 0.1), literal(20, "turn = 0.1", 0.1)


@pytest.mark.parametrize(
    ("text", "target"),
    [
        ("turn = 0.1", "turn"),
        ("self.turn = -0.1", "self.turn"),
        ("turn: float = 0.1", "turn"),
        ("turn: float", ""),
        ("turn = 2 * x", ""),
        ("a = b = 0.1", ""),
        ("turn += 0.1", ""),
        ("if turn < 0.1:", ""),
        ("", ""),
    ],
)
def test_storing_statement_assigns_one_number(text: str, target: str) -> None:
    assert assigned_alone(text) == target


def test_equal_numbers_assigned_to_one_name_are_twins() -> None:
    (twin,) = twins(units([FIRST, literal(9, "speed = 0.1", 0.1), SECOND]))
    assert twin.operands == (FIRST, SECOND)
    assert twin_of(Unit((SECOND,)), (twin,)) == twin
    assert twin_of(twin, (twin,)) is None


@pytest.mark.parametrize(
    "other",
    [
        literal(20, "turn = 0.2", 0.2),
        literal(20, "turn = 0.1", 0.1, "other.py"),
        literal(20, "turn = 0.1 * x", 0.1),
        literal(20, "self.turn = 0.1", 0.1),
    ],
    ids=["another value", "another file", "a product", "another name"],
)
def test_unrelated_numbers_are_no_twins(other: Operand) -> None:
    assert twins(units([FIRST, other])) == ()


def test_parameter_uses_are_twins_in_a_function() -> None:
    mine = [name(3, "turn"), name(5, "turn")]
    (twin,) = twins(units([*mine, name(9, "turn", "stop")]))
    assert twin.operands == tuple(mine)


def test_twins_are_tried_once_one_gains() -> None:
    """Each turn needs twice the speed: one alone earns a part, both together the designed reward."""
    seen: list[int] = []

    def run(candidate: Candidate, _: int) -> Outcome:
        moved = {mutation.operand for mutation in candidate.mutations if float(mutation.value) > 0.15}
        total = {0: 0.0, 1: 4.0 if FIRST in moved else 0.0, 2: 10.0}[len(moved & {FIRST, SECOND})]
        seen.append(len(candidate.mutations))
        return Outcome(total, total > 9.0)

    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(8)), near=9.0, enough=9.5, online=0.0)
    others = [literal(line, f"v{line} = 1.0", 1.0) for line in range(30, 34)]
    search = Sweep([FIRST, *others, SECOND], mutations, (ALWAYS,), Trials(run, 100), goal)
    found = next(search.candidates())
    assert {mutation.operand for mutation in found.mutations} == {FIRST, SECOND}
    assert seen.index(2) == 6  # right after the six single constants
