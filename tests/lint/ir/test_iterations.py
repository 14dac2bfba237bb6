"""Control dependence inside one iteration of a loop."""

from __future__ import annotations

import ast
from textwrap import indent

import pytest

from tarl_lint.ir import nodes as ir
from tarl_lint.ir.control_dependence import control_dependence
from tarl_lint.ir.lower_statements import lower_module
from tarl_lint.read.source import Module

# the body of a loop, the lines of the branches that decide whether the next iteration begins, the statements that run
# whenever an iteration begins, and the lines of the branches on which the last statement depends
BODIES = {
    "nothing decides": ("a()\nif b:\n    c()\nd()", [], [2, 3, 5], []),
    "a break": ("if a:\n    break\nb()", [2], [2], [2]),
    "a return": ("b()\nif a:\n    return\nd()", [3], [2, 3], [3]),
    "continue": ("if a:\n    continue\nb()", [], [2], [2]),
    "a return below another condition": ("if a:\n    if b:\n        return\nc()", [2, 3], [2], [2, 3]),
    "an inner loop that ends only itself": ("for y in z:\n    if a:\n        break\nb()", [], [2, 5], []),
    "an inner loop that returns": ("for y in z:\n    if a:\n        return\nb()", [2, 3], [2], [2, 3]),
    "an exception that the body handles": (
        "try:\n    if a:\n        raise ValueError\nexcept ValueError:\n    pass\nb()",
        [],
        [2, 7],
        [],
    ),
    "an exception that leaves": ("if a:\n    raise ValueError\nb()", [2], [2], [2]),
}


@pytest.mark.parametrize(("body", "onward", "always", "last"), BODIES.values(), ids=BODIES)
def test_branches_inside_an_iteration_are_numbered(
    body: str, onward: list[int], always: list[int], last: list[int]
) -> None:
    text = "for x in xs:\n" + indent(body, "    ") + "\nafter()"
    lowered = lower_module(Module("m.py", "m", text, ast.parse(text))).body
    loop = lowered[0]
    assert isinstance(loop, ir.Loop)
    control = control_dependence(lowered)
    iteration = control.iteration(loop)
    assert iteration is control.iteration(loop)
    line_of = {number: one.pos[0] for number, one in control.statements.items()}
    assert sorted({line_of[number] for number, _ in iteration.onward}) == onward
    assert sorted({line_of[n] for n in iteration.always if n > 0} - {line_of[lowered[-1].id]}) == always
    branches = iteration.closure[loop.body[-1].id]
    assert sorted({line_of[number] for number, _ in branches}) == last


def test_a_loop_has_the_numbers_of_the_statements_in_its_body() -> None:
    text = "for x in xs:\n    if a:\n        b()\nelse:\n    c()\nd()"
    loop, after = lower_module(Module("m.py", "m", text, ast.parse(text))).body
    assert isinstance(loop, ir.Loop)
    (test,) = loop.body
    assert isinstance(test, ir.If)
    assert all(loop.has(number) for number in (loop.id, test.id, test.body[0].id))
    assert not any(loop.has(number) for number in (loop.orelse[0].id, after.id))
