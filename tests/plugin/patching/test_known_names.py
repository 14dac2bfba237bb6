"""What a condition may read at a place: bound names and attributes, their first values, and values other than None."""

from __future__ import annotations

import ast
import builtins
from textwrap import dedent

import pytest

from pytest_tarl.patching.absence import is_checked
from pytest_tarl.patching.bindings import bindings, initial, is_bound, local_names, scope
from pytest_tarl.patching.document import Document, document
from pytest_tarl.patching.vocabulary import class_attributes, free, names

NODE = dedent(
    """
    import math, os.path as places
    from sys import argv
    import xml.dom

    limit = 3.0
    ready = None
    first, (second, third) = 1, (True, None)
    pair = 1, 2
    speed = Speed()
    other = Other(1)
    offset: float = -2.5
    bare: int


    class Node:
        gain = 2.0
        items = []

        def __init__(self, name, *rest, flag=False, **more):
            self.state = None
            self.state = State()
            self.name = name

        def late(self):
            self.speed = 1.0

        def callback(self, message):
            global ready
            local = message.data
            ready = local
            HERE

        @staticmethod
        def helper(self):
            STATIC


    def outer(a, b=1, /, *, c):
        x = 1
        def inner(y):
            nonlocal x
            z = x
            INNER
        return lambda w: w + x
    """
)


@pytest.fixture
def source() -> Document:
    return document("node.py", NODE)


def place(source: Document, name: str = "HERE") -> ast.stmt:
    return next(
        node
        for node in ast.walk(source.tree)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Name) and node.value.id == name
    )


def test_names_are_found_in_every_kind_of_binding(source: Document) -> None:
    found = {one.target for one in bindings(source)}
    assert {
        "math",
        "places",
        "argv",
        "xml",
        "limit",
        "first",
        "second",
        "third",
        "pair",
        "speed",
        "offset",
    } <= found
    assert {"Node", "__init__", "self.state", "local", "gain", "outer", "inner"} <= found
    assert "dom" not in found
    constants = {
        (one.target, one.constants, one.fresh) for one in bindings(source) if one.constants or one.fresh
    }
    assert constants >= {
        ("limit", (3.0,), False),
        ("ready", (None,), False),
        ("first", (1,), False),
        ("second", (True,), False),
        ("third", (None,), False),
        ("offset", (-2.5,), False),
        ("speed", (), True),
        ("self.state", (None,), False),
        ("self.state", (), True),
    }
    assert not {target for target, *_ in constants} & {"other", "pair", "items"}


@pytest.mark.parametrize(
    ("code", "at", "bound"),
    [
        ("limit", "HERE", True),
        ("local", "HERE", True),
        ("message", "HERE", True),
        ("self", "HERE", True),
        ("self.state", "HERE", True),
        ("self.gain", "HERE", True),
        ("self.items", "HERE", True),
        ("self.speed", "HERE", False),
        ("self.unknown", "HERE", False),
        ("message.anything", "HERE", True),
        ("unknown", "HERE", False),
        ("x", "HERE", False),
        ("HERE", "HERE", True),
        ("message.items[0]", "HERE", False),
        ("self.unknown", "STATIC", True),
        ("z", "INNER", True),
        ("y", "INNER", True),
        ("x", "INNER", True),
        ("a", "INNER", True),
        ("w", "INNER", False),
    ],
)
def test_local_or_imported_name_is_bound(source: Document, code: str, at: str, bound: bool) -> None:
    assert is_bound(source, place(source, at), code) is bound


def test_names_read_by_a_statement_are_bound_in_it() -> None:
    source = document("a.py", "def f():\n    print(a.b[0].c, key=d)\n    if e:\n        g\n")
    call, branch = source.tree.body[0].body  # type: ignore[attr-defined]
    for code in ("a", "a.b", "a.b[0]", "a.b[0].c", "d"):
        assert is_bound(source, call, code) is True
    assert is_bound(source, branch, "e") is True
    assert is_bound(source, branch, "g") is False


@pytest.mark.parametrize(
    ("code", "at", "values", "fresh"),
    [
        ("limit", "HERE", {3.0}, False),
        ("ready", "HERE", {None}, False),
        ("speed", "HERE", set(), True),
        ("self.state", "HERE", {None}, True),
        ("self.gain", "HERE", {2.0}, False),
        ("local", "HERE", set(), False),
        ("x", "INNER", {1}, False),
        ("gain", "HERE", set(), False),
    ],
)
def test_first_value_of_a_name_is_its_module_value(
    source: Document, code: str, at: str, values: set[object], fresh: bool
) -> None:
    if code == "gain":  # a name of the class is no global one; its own binding is inside the class
        assert scope(source, place(source, at), code) is None
        return
    assert initial(source, place(source, at), code) == (values, fresh)


def test_names_belong_to_the_innermost_binding_function(source: Document) -> None:
    functions = {node.name: node for node in ast.walk(source.tree) if isinstance(node, ast.FunctionDef)}
    assert local_names(source, functions["__init__"]) >= {"self", "name", "rest", "flag", "more"}
    assert "ready" not in local_names(source, functions["callback"])
    assert {"a", "b", "c", "x", "inner"} <= local_names(source, functions["outer"])
    assert "x" not in local_names(source, functions["inner"])
    inner = place(source, "INNER")
    assert scope(source, inner, "z") is functions["inner"]
    assert scope(source, inner, "x") is functions["outer"]
    assert scope(source, inner, "limit") is None
    read = next(node for node in ast.walk(source.tree) if isinstance(node, ast.Name) and node.id == "w")
    assert isinstance(scope(source, read, "w"), ast.Lambda)


def test_used_names_include_scopes_and_builtins(source: Document) -> None:
    found = names(source)
    assert {"math", "places", "argv", "xml", "Node", "outer", "inner", "w", "message", "ready", "x"} <= found
    assert set(dir(builtins)) <= found
    assert not {"dom", "state", "path"} & found
    assert {"state", "name", "speed", "gain", "callback", "late"} <= class_attributes(source)
    assert "limit" not in class_attributes(source)


@pytest.mark.parametrize(
    ("base", "taken", "found"),
    [
        ("level", set(), "level"),
        ("level", {"level"}, "level_reading"),
        ("level", {"level", "level_reading"}, "level_2"),
        ("level", {"level", "level_reading", "level_2", "level_3"}, "level_4"),
        ("class", set(), "class_reading"),
    ],
)
def test_unused_name_similar_to_the_request_is_chosen(base: str, taken: set[str], found: str) -> None:
    assert free(base, taken) == found


CHECKED = [
    ("x + 1\nHERE", True),
    ("1 - x\nHERE", True),
    ("-x\nHERE", True),
    ("not x\nHERE", False),
    ("x.y\nHERE", True),
    ("x[0]\nHERE", True),
    ("a[x]\nHERE", False),
    ("f(x)\nHERE", False),
    ("x < 1\nHERE", True),
    ("1 >= x\nHERE", True),
    ("x == 1\nHERE", False),
    ("0 < 1 < x\nHERE", False),
    ("a and x + 1\nHERE", False),
    ("x + 1 and a\nHERE", True),
    ("x + 1 if a else b\nHERE", False),
    ("b if x > 1 else c\nHERE", True),
    ("f(lambda: x + 1)\nHERE", False),
    ("[x + 1 for _ in a]\nHERE", False),
    ("if a: x + 1\nHERE", False),
    ("if x is None: return\nHERE", True),
    ("if x is None: raise E\nHERE", True),
    ("if x is None: pass\nHERE", False),
    ("if x is not None: return\nHERE", False),
    ("if x is None or a: return\nHERE", True),
    ("if x is None and a: return\nHERE", False),
    ("if not x: return\nHERE", True),
    ("if x: return\nHERE", False),
    ("if not (x is not None): return\nHERE", True),
    ("if x is 1: return\nHERE", False),
    ("if x == None: return\nHERE", False),
    ("if y is None: return\nHERE", False),
    ("if x is None:\n    print()\n    return\nHERE", True),
    ("while x is None: pass\nHERE", True),
    ("while x is None:\n    if a: break\nHERE", False),
    ("while not x: sleep()\nHERE", True),
    ("HERE\nx + 1", False),
    ("if x is not None:\n    HERE", True),
    ("if x:\n    HERE", True),
    ("if x and a:\n    HERE", True),
    ("if x or a:\n    HERE", False),
    ("if x is None:\n    HERE", False),
    ("if x is not None:\n    pass\nelse:\n    HERE", False),
    ("while x is not None:\n    HERE", True),
    ("for i in a:\n    if x is None: continue\n    HERE", True),
    ("for i in a:\n    if x is None: break\n    HERE", True),
    ("x + 1\nfor i in a:\n    HERE", True),
    ("if x is not None:\n    def g():\n        HERE", False),
    ("x + 1\ndef g():\n    HERE", False),
]


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@pytest.mark.parametrize(("text", "checked"), CHECKED, ids=[text for text, _ in CHECKED])
def test_statement_after_the_assignment_is_checked(text: str, checked: bool) -> None:
    source = document("a.py", "def f():\n" + "".join(f"    {line}\n" for line in text.split("\n")))
    assert is_checked(source, place(source), "x") is checked


def test_computing_statement_counts_as_checked() -> None:
    source = document("a.py", "def f():\n    y = x * 2\n    z = x\n")
    relies, reads = source.tree.body[0].body  # type: ignore[attr-defined]
    assert is_checked(source, relies, "x") is True
    assert is_checked(document("b.py", "z = x\n"), document("b.py", "z = x\n").tree.body[0], "x") is False
    assert is_checked(source, reads, "x") is True  # after the first statement
