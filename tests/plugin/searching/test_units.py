"""Uses of constants that change together in a search, their scales, and their best gains."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from pytest_tarl.model import OperandEffect
from pytest_tarl.patching.charts import SHARE
from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.searching.calls_apart import calls_of
from pytest_tarl.searching.units import Unit, best_effects, charted, units, whole_constants
from tarl_lint.model import Operand, SiteId, Span


def use(
    code: str, value: Any, line: int = 3, *, named: int | None = None, column: int = 5, site: str = "s"
) -> Operand:
    """Return a use of a literal, or of the constant that line `named` defines."""
    span = Span("node.py", line, column, line, column + len(code))
    definition = span if named is None else Span("node.py", named, 1, named, 9)
    return Operand(SiteId("node", "run", site), span, code, value, definition)


LOW, HIGH, OTHER = use("-2", -2), use("2", 2, column=20), use("3", 3, column=30)
FIRST, SECOND = use("LIMIT", 2.0, named=1), use("LIMIT", 2.0, named=1, column=20)

MOVED = replace(SECOND, site=SiteId("node", "run", "t"))


@pytest.mark.parametrize(
    ("operands", "groups"),
    [
        ((LOW, OTHER, HIGH), [(LOW, HIGH), (OTHER,)]),
        ((LOW, LOW), [(LOW,), (LOW,)]),
        ((FIRST, OTHER, SECOND), [(FIRST, SECOND), (OTHER,)]),
        (
            (FIRST, use("LIMIT", 2.0, named=9, column=20)),
            [(FIRST,), (use("LIMIT", 2.0, named=9, column=20),)],
        ),
        ((FIRST, use("MOST", 2.0, named=1, column=20)), [(FIRST,), (use("MOST", 2.0, named=1, column=20),)]),
        ((FIRST, MOVED), [(FIRST,), (MOVED,)]),
        ((use("0", 0), use("0", 0, column=20)), [(use("0", 0),), (use("0", 0, column=20),)]),
        (
            (use("True", True), use("True", True, column=9)),
            [(use("True", True),), (use("True", True, column=9),)],
        ),
        ((FIRST, HIGH), [(FIRST,), (HIGH,)]),
        ((LOW, use("x", None, named=1)), [(LOW,), (use("x", None, named=1),)]),
        ((), []),
    ],
)
def test_uses_of_one_constant_and_opposite_limits_change_together(operands: Any, groups: Any) -> None:
    assert [unit.operands for unit in units(operands)] == groups


def test_constant_is_also_tried_on_its_second_scale() -> None:
    zero = Unit((use("0.0", 0.0),))
    plain, pair, none = Unit((use("0.5", 0.5, column=9),)), Unit((FIRST, SECOND)), Unit((OTHER,))
    charts = {zero.operands[0]: SHARE, plain.operands[0]: SHARE, FIRST: SHARE}
    assert charted([zero, plain, pair, none], charts) == (
        Unit(zero.operands, SHARE),
        plain,
        Unit(plain.operands, SHARE),
        pair,  # its second use has no chart
        none,
    )
    assert charted([zero], {}) == (zero,)


def test_named_constant_changes_at_all_uses() -> None:
    elsewhere = replace(SECOND, site=SiteId("node", "run", "t"))
    other_file = replace(SECOND, span=replace(SECOND.span, path="b.py"))
    flag = use("FLAG", True, named=2)
    given = [
        Unit((FIRST,)),
        Unit((OTHER,)),
        Unit((elsewhere, FIRST)),
        Unit((FIRST,), SHARE),
        Unit((other_file,)),
        Unit((flag,)),
        Unit((flag,)),
        Unit((replace(OTHER, value=4),)),
        Unit((use("LIMIT", 2.0, named=7),)),
        Unit((replace(FIRST, definition=None),)),
        Unit((replace(FIRST, definition=None),)),
    ]
    assert whole_constants(given) == (Unit((FIRST, elsewhere)), *given[1:2], *given[3:])


def test_best_gain_is_stored_by_site() -> None:
    one, two = (
        Unit((use("2.0", 2.0),)),
        Unit((use("3.0", 3.0, column=20), use("4.0", 4.0, column=30, site="t"))),
    )
    found = best_effects(
        [
            (one, {2.2: 1.0, 0.4: 3.0}),
            (two, {5.0: 2.0, 1.5: 2.0}),  # on ties, the smaller factor
            (Unit(two.operands[:1]), {10.0: 1.0}),
            (Unit((use("5.0", 5.0, column=40),)), {}),
        ],
        mutations,
    )
    assert found == {
        str(one.operands[0].site): [
            OperandEffect("2.0", 2.0, 0.8, 3.0),
            OperandEffect("3.0", 3.0, 4.5, 2.0),
        ],
        str(two.operands[1].site): [OperandEffect("4.0", 4.0, 6.0, 2.0)],
    }


def test_a_factor_that_changes_nothing_is_not_a_mutation() -> None:
    def mutate(operand: Operand, factor: float) -> Mutation | None:
        return None if operand == OTHER else Mutation(operand, factor)

    assert Unit((LOW, OTHER)).mutations(mutate, 2.0) == (Mutation(LOW, 2.0),)
    assert Unit((OTHER,)).mutations(mutate, 2.0) == ()


def returned(text: str, qualname: str = "Node.gain") -> Unit:
    return Unit((replace(OTHER, site=SiteId("node", qualname, text)),))


@pytest.mark.parametrize(
    ("code", "called"),
    [
        ("gain()", True),
        ("self.gain('kp')", True),
        ("self.other.gain(1)", True),
        ("self.other(gain)", False),
        ("gain", False),
        ("gain() + 1", False),
        ("gain(", False),
    ],
)
def test_changes_at_the_calls_replace_a_changed_return_value(code: str, called: bool) -> None:
    call = Unit((use(code, None),))
    among = [call, Unit(call.operands, SHARE)]
    assert calls_of(returned("return self.kp"), among) == ([call] if called else [])
    assert calls_of(returned("x = self.kp"), among) == []
    assert calls_of(returned("return 1", ""), [Unit((use("a", 1.0),))]) == []
