"""The first code of a block, the parameters of functions, and where statements are inserted."""

from __future__ import annotations

import ast
from typing import Any

import pytest

from pytest_tarl.instrumentation.blocks import (
    enter,
    entry_of,
    first_evaluated_in,
    message_parameter,
    parameters,
)


def body(text: str) -> list[ast.stmt]:
    return ast.parse(text).body


def function(text: str) -> Any:
    return body(text)[0]


@pytest.mark.parametrize(
    ("text", "first"),
    [
        ("x = f()", "f()"),
        ("x: int = f()", "f()"),
        ("x: int\ny = g()", "g()"),
        ("global x\nx = h()", "h()"),
        ("if a: pass", "a"),
        ("while b: pass", "b"),
        ("for i in c: pass", "c"),
        ("return", "return"),
        ("return d", "d"),
        ("pass\nx = 1", "pass"),
        ("@e\n@f\ndef g(): pass", "e"),
        ("def g(): pass", "def g():\n    pass"),
        ("global x", "global x"),
        ("x: int\ny: int", "x: int"),
    ],
)
def test_the_first_code_of_a_block_skips_declarations(text: str, first: str) -> None:
    assert ast.unparse(first_evaluated_in(body(text))) == first


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("def f():\n    x = 1\n", 2),
        ('def f():\n    "doc"\n    x = 1\n', 3),
        ('def f():\n    "doc"\n    global x\n    y: int\n    x = 1\n', 5),
        ('def f():\n    "doc"\n', 1),
        ("def f():\n    global x\n", 1),
        ("async def f():\n    nonlocal_ = 1\n", 2),
    ],
)
def test_function_entry_follows_docstring_and_declarations(text: str, line: int) -> None:
    assert entry_of(function(text))["lineno"] == line


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def f():\n    x = 1", "def f():\n    new()\n    x = 1"),
        (
            'def f():\n    "doc"\n    global x\n    x = 1',
            "def f():\n    'doc'\n    global x\n    new()\n    x = 1",
        ),
        ('class A:\n    "doc"', "class A:\n    'doc'\n    new()"),
        ("class A:\n    x: int\n    y = 1", "class A:\n    x: int\n    new()\n    y = 1"),
    ],
)
def test_statement_is_inserted_at_function_entry(text: str, expected: str) -> None:
    node = function(text)
    enter(node, body("new()")[0])
    assert ast.unparse(ast.parse(ast.unparse(node))) == ast.unparse(ast.parse(expected))


def test_all_kinds_of_parameters_of_a_function_are_found() -> None:
    found = parameters(function("def f(a, /, b, c=1, *d, e, g=2, **h): pass").args)
    assert sorted(one.arg for one in found) == list("abcdegh")
    assert [one.arg for one in parameters(function("def f(a, *, b): pass").args)] == ["a", "b"]


@pytest.mark.parametrize(
    ("text", "in_class", "name"),
    [
        ("def f(message): pass", False, "message"),
        ("def f(self, message): pass", True, "message"),
        ("def f(self, message): pass", False, "self"),
        ("@staticmethod\ndef f(message): pass", True, "message"),
        ("@other\ndef f(self, message): pass", True, "message"),
        ("def f(self, /, message): pass", True, "message"),
        ("def f(self, *messages): pass", True, "messages"),
        ("def f(self, *, message): pass", True, "message"),
        ("def f(self, *rest, message): pass", True, "rest"),
        ("def f(self): pass", True, None),
        ("def f(**named): pass", False, None),
    ],
)
def test_the_message_is_the_first_parameter_after_self(text: str, in_class: bool, name: str | None) -> None:
    assert message_parameter(function(text), in_class=in_class) == name
