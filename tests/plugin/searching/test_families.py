"""Constants of several axes or sides change together."""

from __future__ import annotations

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.families import families, shared_name
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit, units
from tarl_lint.model import Operand, SiteId, Span


def constant(line: int, code: str, value: float | bool | None, path: str = "node.py") -> Operand:
    """Return the use of a constant that is defined far below its use."""
    span = Span(path, line, 5, line, 5 + len(code))
    defined = Span(path, 90 + line, 1, 90 + line, 4)
    return Operand(SiteId(path, "run", f"line {line}"), span, code, value, defined)


@pytest.mark.parametrize(
    ("code", "shared"),
    [
        ('GAINS["x"]', "GAINS[*]"),
        ("self.gains[2]", "self.gains[*]"),
        ("self.gains[-1]", "self.gains[*]"),
        ("self.kp_x", "self.kp_*"),
        ("KP_LEFT", "kp_*"),
        ("left_kp", "*_kp"),
        ("joint_3_stiffness", "joint_*_stiffness"),
        ("self.kp", ""),
        ("X", ""),
        ("self.exit_speed", ""),
        ("self.gains[i]", ""),
    ],
)
def test_family_name_has_a_star(code: str, shared: str) -> None:
    assert shared_name(code) == shared


def test_constants_of_three_axes_are_a_family_across_statements() -> None:
    three = [constant(n, f'K["{axis}"]', 2.0 + n) for n, axis in enumerate("xyz", start=1)]
    (family,) = families(units([three[0], constant(7, "MOST", 3.0), *three[1:]]))
    assert family.operands == tuple(three)


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ((2.0, 8.0), 1),
        ((2.0, 8.1), 0),
        ((2.0, -2.0), 0),
        ((0.5, 2.0), 1),
        ((2.0, 0.5), 1),
        ((-0.5, -2.0), 1),
        ((-0.5, 2.0), 0),
        ((-2.0, -8.1), 0),
        ((0.0, 2.0), 0),
        ((True, True), 0),
        ((None, 2.0), 0),
    ],
)
def test_the_values_of_a_family_are_similar(values: tuple[float | bool | None, ...], expected: int) -> None:
    found = families([Unit((constant(n, f"K[{n}]", value),)) for n, value in enumerate(values, start=1)])
    assert len(found) == expected


def test_uses_of_one_constant_are_not_a_family() -> None:
    one = constant(1, "K[0]", 2.0)
    again = Operand(
        SiteId("node.py", "run", "line 2"), Span("node.py", 2, 5, 2, 9), "K[0]", 2.0, one.definition
    )
    assert not families([Unit((one,)), Unit((again,))])
    assert not families([Unit((one,)), Unit((constant(2, "K[1]", 2.0, "other.py"),))])


def test_nine_constants_are_a_table_and_not_a_family() -> None:
    many = [Unit((constant(n, f"K[{n}]", 2.0),)) for n in range(1, 10)]
    assert len(families(many[:8])) == 1
    assert not families(many)


def test_sweep_finds_constants_that_help_together() -> None:
    axes = tuple(constant(n, f'K["{axis}"]', 2.0 + n) for n, axis in enumerate("xyz", start=1))
    others = tuple(constant(n, f"C{n}", 1.0) for n in range(10, 20))

    def blown(candidate: Candidate, _: int) -> Outcome:
        factors = {one.operand: float(one.value) for one in candidate.mutations}
        good = all(3.0 < factors.get(axis, 1.0) < 7.0 for axis in axes)
        return Outcome(10.0 if good else 0.0, good)

    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(6)), near=9.0, enough=9.0, online=0.0)
    trials = Trials(blown, 300)
    found = next(Sweep((*others, *axes), mutations, (ALWAYS,), trials, goal).candidates())
    assert {one.operand for one in found.mutations} == set(axes)
    assert trials.spent < 60
