"""Expressions of literals, and postdominators: pure functions, without an analysis."""

from __future__ import annotations

import random

import pytest

from tarl_lint.ir import nodes as ir
from tarl_lint.ir.constant_expressions import computed, numbers, of_literals
from tarl_lint.ir.postdominance import EXIT, passed, postdominators

WHOLE, FIRST, SECOND = (1, 0, 1, 9), (1, 0, 1, 1), (1, 4, 1, 5)


def sum_of(*parts: ir.Expr) -> ir.Operation:
    return ir.Operation("+", parts, WHOLE)


def const(value: object, pos: ir.Pos = FIRST) -> ir.Const:
    return ir.Const(value, pos)


PI = ir.Attribute(ir.Name("math", "global", 0, SECOND), "pi", SECOND)


def test_number_from_one_literal_has_its_position():
    assert computed(sum_of(PI, const(6))) == FIRST
    assert computed(sum_of(const(1), const(2, SECOND))) == WHOLE
    assert computed(sum_of(PI, PI)) == WHOLE
    assert computed(const(1)) is None
    assert computed(sum_of(const(1), ir.Name("x", "global", 0, SECOND))) is None


@pytest.mark.parametrize(
    ("expr", "literal"),
    [
        (const(1.0), True),
        (const("text"), True),
        (const(None), False),
        (PI, True),
        (ir.Attribute(PI, "pi", SECOND), False),
        (ir.Attribute(PI.base, "other", SECOND), False),
        (ir.Operation("text", (const(1),), WHOLE), False),
        (ir.SequenceDisplay((const(1), const(2)), WHOLE, 0), True),
        (ir.SequenceDisplay((const(1), const(None)), WHOLE, 0), False),
        (ir.Call(PI, (const(1),), (), WHOLE, 0), True),
        (ir.Call(PI, (), (), WHOLE, 0), False),
        (ir.Call(PI, (const(1),), (("k", const(1)),), WHOLE, 0), False),
    ],
)
def test_expression_of_literals_counts_as_a_literal(expr, literal):
    assert of_literals(expr) is literal


def test_numbers_are_listed_in_source_order_without_booleans():
    one, two, three = const(1), const(2.0), const(3)
    listed = ir.SequenceDisplay((two, const(True), const("x")), WHOLE, 0)
    assert numbers(sum_of(one, ir.Call(PI, (listed, three), (), WHOLE, 0), PI)) == [one, two, three]


def test_postdominator_of_a_branch_joins_both_paths():
    # 1 branches to 2 and 3, which meet in 4
    edges = {1: {"then": 2, "else": 3}, 2: {"": 4}, 3: {"": 4}, 4: {"": EXIT}}
    nearest = postdominators(edges, [1, 2, 3, 4])
    assert nearest == {EXIT: EXIT, 1: 4, 2: 4, 3: 4, 4: EXIT}
    assert list(passed(2, nearest[1], nearest)) == [2]
    assert list(passed(4, nearest[1], nearest)) == []
    assert list(passed(1, EXIT, nearest)) == [1, 4]


def test_exit_postdominates_an_endless_loop():
    edges = {1: {"": 2}, 2: {"": 3}, 3: {"": 2}}
    assert postdominators(edges, [1, 2, 3]) == {EXIT: EXIT, 1: 2, 2: 3, 3: EXIT}


def ends_without(edges: dict[int, dict[str, int]], start: int, left_out: int) -> bool:
    """Return whether a path from a statement reaches the exit without another statement."""
    seen, pending = {left_out}, [start]
    while pending:
        node = pending.pop()
        if node == EXIT:
            return True
        if node not in seen:
            seen.add(node)
            pending += edges[node].values()
    return False


@pytest.mark.parametrize("seed", range(20))
def test_postdominators_are_on_every_path_to_the_exit(seed):
    chance, size = random.Random(seed), 9
    edges = {
        n: {str(way): chance.choice([EXIT, *range(1, size)]) for way in range(chance.randint(1, 2))}
        for n in range(1, size)
    }
    for node in edges:  # make each statement reach the exit
        if not ends_without(edges, node, -1):
            edges[node]["end"] = EXIT
    nearest = postdominators(edges, list(edges))
    for node in edges:
        expected = {other for other in edges if other == node or not ends_without(edges, node, other)}
        assert set(passed(node, EXIT, nearest)) == expected
