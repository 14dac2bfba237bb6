"""The function that stores fields of a message, and the place of module variables."""

from __future__ import annotations

import ast
from typing import Any

import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.document import document
from pytest_tarl.patching.stores import (
    Callback,
    Store,
    _above_comments,
    _field,
    _gap,
    _state,
    first_statement,
)


@pytest.mark.parametrize(
    ("field", "expected"),
    [
        ("data", "message.data"),
        ("pose.position.x", "message.pose.position.x"),
        ("ranges.0", "message.ranges[0] if len(message.ranges) > 0 else None"),
        ("ranges.-1.x", "message.ranges[-1].x if len(message.ranges) >= 1 else None"),
        (
            "rows.2.cells.-3",
            "message.rows[2].cells[-3] if len(message.rows) > 2 and len(message.rows[2].cells) >= 3 else None",
        ),
    ],
)
def test_field_index_is_checked_against_the_length(field: str, expected: str) -> None:
    assert _field("message", field) == expected


@pytest.mark.parametrize("field", ["a b", "", "a..b", "ranges()", "1.5x"])
def test_a_field_that_is_not_a_path_is_refused(field: str) -> None:
    with pytest.raises(RepairError, match="not a dotted path"):
        _field("message", field)


def lines(instance: str = "", annotation: str = "", **names: str) -> list[str]:
    source = document("node.py", "def f():\n  pass\n")
    anchor: Any = None
    fields = {name.replace("__", "."): variable for name, variable in names.items()}
    return Callback(Store(source), anchor, "on_scan", fields, annotation).lines(instance)


def test_functions_store_in_globals_and_methods_in_attributes() -> None:
    assert lines(data="near", pose__x="x") == [
        "def on_scan(message):",
        "  global near, x",
        "  near = message.data",
        "  x = message.pose.x",
    ]
    assert lines("self", "LaserScan", data="near") == [
        "def on_scan(self, message: LaserScan) -> None:",
        "  self.near = message.data",
    ]


def test_the_parameter_has_another_name_than_the_variables() -> None:
    assert lines(data="message")[::2] == ["def on_scan(received):", "  message = received.data"]


def test_value_is_read_from_instance_or_module() -> None:
    source = document("node.py", "class A:\n    pass\n")
    owner = source.tree.body[0]
    assert isinstance(owner, ast.ClassDef)
    assert Store(source, owner, "self").variable("near") == "self.near"
    assert Store(source).variable("near") == "near"


def test_first_statement_skips_the_docstring() -> None:
    def first(body: str) -> str:
        (found,) = ast.parse(f"def f():\n{body}").body
        assert isinstance(found, ast.FunctionDef)
        return ast.unparse(first_statement(found))

    assert first('    "x"\n    y = 1\n') == "y = 1"
    assert first('    "x"\n') == "'x'"
    assert first("    y = 1\n    z = 2\n") == "y = 1"


@pytest.mark.parametrize(
    ("text", "limit", "expected"),
    [
        ("import os\nA = 1\ndef f(): pass\n", 16, "A = 1"),
        ("A = 1\nimport os\ndef f(): pass\n", 16, None),
        ("A: int = 1\ndef f(): pass\n", 11, "A: int = 1"),
        ("A = 1; B = 2\ndef f(): pass\n", 13, None),
        ("A = 1\nB = 2\n", 6, "A = 1"),
        ("def f(): pass\n", 0, None),
    ],
)
def test_new_variables_follow_a_preceding_module_variable(
    text: str, limit: int, expected: str | None
) -> None:
    found = _state(document("node.py", text), limit)
    assert (None if found is None else ast.unparse(found)) == expected


@pytest.mark.parametrize(
    ("text", "line", "expected"),
    [
        ("import os\n\n\n# one\n# two\ndef f(): pass\n", 6, 4),
        ("import os\n\n  # one\ndef f(): pass\n", 4, 3),
        ("import os\n\n\ndef f(): pass\n", 4, 4),
        ("#!python\n# coding\n# about f\ndef f(): pass\n", 4, 3),  # the first two lines stay first
        ("#!python\n# coding\ndef f(): pass\n", 3, 3),
    ],
)
def test_a_comment_stays_with_its_definition(text: str, line: int, expected: int) -> None:
    source = document("node.py", text)
    starts = source.line_starts
    assert _above_comments(source, starts[line - 1]) == starts[expected - 1]


@pytest.mark.parametrize(
    ("before", "expected"),
    [("A = 1\n\n\n", ""), ("A = 1\r\n\r\n", ""), ("A = 1\n", "\n\n"), ("", ""), ("\n", "")],
)
def test_two_empty_lines_precede_a_definition(before: str, expected: str) -> None:
    source = document("node.py", f"{before}def f(): pass\n")
    assert _gap(source, len(before)) == expected
