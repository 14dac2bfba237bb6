"""Control dependence on statements that wait inside loops."""

from __future__ import annotations

import ast

import pytest

from tarl_lint.ir.control_dependence import BLOCKED, control_dependence
from tarl_lint.ir.lower_statements import lower_module
from tarl_lint.read.source import Module

# code whose calls of `wait()` wait, and the lines of the other statements that depend on one of these calls
CASES = {
    "a loop over elements": ("for x in xs:\n    before()\n    wait()\n    behind()\nafter()", [4, 5]),
    "an endless loop": (
        "while True:\n    before()\n    wait()\n    if a:\n        break\nafter()",
        [1, 2, 4, 5, 6],
    ),
    "a loop with a condition": ("while c:\n    before()\n    wait()\n    behind()\nafter()", [4]),
    "nested loops": (
        "for x in xs:\n    before()\n    for y in ys:\n        first()\n        wait()\n    behind()\nafter()",
        [6, 7],
    ),
    "a loop over elements in one with a condition": (
        "while c:\n    before()\n    for y in ys:\n        wait()\n    behind()\nafter()",
        [5],
    ),
    "a loop with a condition in one over elements": (
        "for y in ys:\n    while c:\n        wait()\n        behind()\n    last()\nafter()",
        [4],
    ),
    "a `try` in a loop": (
        "for x in xs:\n    try:\n        wait()\n        behind()\n    except E:\n        handle()\nafter()",
        [4, 7],
    ),
    "no loop": ("before()\nif c:\n    wait()\nafter()", [4]),
}


@pytest.mark.parametrize(("text", "depending"), CASES.values(), ids=CASES)
def test_what_follows_a_wait_depends_on_it(text: str, depending: list[int]) -> None:
    lowered = lower_module(Module("m.py", "m", text, ast.parse(text))).body
    line_of = {number: one.pos[0] for number, one in control_dependence(lowered).statements.items()}
    waiting = {number for number, line in line_of.items() if "wait()" in text.split("\n")[line - 1]}
    control = control_dependence(lowered, {number: {BLOCKED: None} for number in waiting})
    found = {
        line_of[number]
        for number, branches in control.closure.items()
        if number not in waiting and any(branch[0] in waiting for branch in branches)
    }
    assert sorted(found) == depending
