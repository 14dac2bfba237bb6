"""What hazard rules know of a module: enclosing definitions, locks, assigned values, and look-ups by text."""

from __future__ import annotations

import ast
from textwrap import dedent

import pytest

from tarl_lint.evidence import Outline

TEXT = dedent("""\
    import threading
    lock = threading.Lock()
    class C:
        ready: bool = False
        count: int
        def __init__(self):
            self.first = self.second = threading.RLock()
            self.changed = threading.Condition(self.first)
            self.own = threading.Condition()
            self.gate = threading.Event()
            self.ready = True
        def run(self):
            global total
            def inner():
                return f(g(1))
            return inner
    total = f(2)
""")


def outline(text: str = TEXT) -> Outline:
    return Outline(ast.parse(dedent(text)))


def test_condition_variables_have_the_name_of_their_lock():
    assert outline().locks == {
        "lock": "lock",
        "first": "first",
        "second": "second",
        "changed": "first",
        "own": "own",
    }


def test_assigned_values_are_listed_by_name():
    found = {name: [*map(ast.unparse, values)] for name, values in outline().assigned.items()}
    assert found["ready"] == ["False", "True"]
    assert found["second"] == ["threading.RLock()"]
    assert found["total"] == ["f(2)"]
    assert "count" not in found
    assert outline().declared == {"total"}


@pytest.mark.parametrize(
    ("line", "name"), [(1, ""), (2, ""), (4, "C"), (7, "C.__init__"), (14, "C.run.inner"), (15, "C.run.inner"),
     (16, "C.run"), (17, "")]
)  # fmt: skip
def test_a_line_is_named_after_its_function(line, name):
    assert outline().qualname(line) == name


def test_call_is_found_only_if_start_and_end_match():
    found = outline()
    call = found.call((15, 19, 15, 26))
    assert call is not None
    assert ast.unparse(call) == "f(g(1))"
    assert found.call((15, 19, 15, 25)) is None
    assert found.call((15, 18, 15, 26)) is None
    inner = found.call((15, 21, 15, 25))
    assert inner is not None
    assert ast.unparse(inner) == "g(1)"
    assert [type(one).__name__ for one in found.around(inner)] == [
        "Call",
        "Return",
        "FunctionDef",
        "FunctionDef",
        "ClassDef",
        "Module",
    ]
    nearest, cls = found.scope(inner, (ast.FunctionDef,)), found.scope(inner, (ast.ClassDef, ast.Lambda))
    assert isinstance(nearest, ast.FunctionDef)
    assert nearest.name == "inner"
    assert isinstance(cls, ast.ClassDef)
    assert found.scope(found.tree, (ast.Module,)) is None


@pytest.mark.parametrize(
    ("text", "by_text"),
    [
        ("getattr(a, name)", True),
        ("hasattr(a, name)", True),
        ("getattr(a, 'name')", False),
        ("getattr(a)", False),
        ("vars(a)", True),
        ("globals()", True),
        ("eval('x')", True),
        ("a.__dict__", True),
        ("a.getattr(b, name)", False),
        ("f(name)", False),
    ],
)
def test_look_ups_of_names_by_computed_text_are_detected(text, by_text):
    assert outline(text).by_text is by_text
