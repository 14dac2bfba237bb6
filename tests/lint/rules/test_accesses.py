"""Which locks are held at a place, and how a function accesses shared state, by syntax."""

from __future__ import annotations

import ast
from textwrap import dedent, indent

import pytest

from tarl_lint.evidence import Outline
from tarl_lint.rules.races.accesses import accesses
from tarl_lint.rules.races.held_locks import asked_before, in_loop, lock_name, locks_around, tried_around

CLASS = """\
import threading
from other import shared
mutex = threading.Lock()
table = {}
names = []
level = 0.0
limit = shared
class C:
    def __init__(self):
        self.a = threading.RLock()
        self.b = threading.Condition(self.a)
        self.x = self.y = None
        self.l, self.d = [], {}
        self.l = []
        self.other = Other()
    def f(self, given):
"""


def method(body: str) -> tuple[ast.FunctionDef, Outline]:
    """Return a method with this body, and the outline of its module."""
    tree = ast.parse(CLASS + indent(dedent(body), " " * 8))
    outline = Outline(tree)
    found = [one for one in outline.definitions if one.name == "f"]
    assert isinstance(found[0], ast.FunctionDef)
    return found[0], outline


def place(body: str) -> tuple[ast.AST, Outline]:
    """Return the first use of `here` in a method."""
    function, outline = method(body)
    return next(n for n in ast.walk(function) if isinstance(n, ast.Name) and n.id == "here"), outline


HELD = [
    ("here", set(), set()),
    ("with self.a:\n    here", {"a"}, set()),
    ("with self.b:\n    here", {"a"}, set()),
    ("with mutex, self.a:\n    here", {"mutex", "a"}, set()),
    ("with mutex:\n    with self.a:\n        here", {"mutex", "a"}, set()),
    ("async with self.a:\n    here", {"a"}, set()),
    ("with open(x):\n    here", set(), set()),
    ("with self.data_lock:\n    here", {"data_lock"}, set()),
    ("with self.a:\n    pass\nhere", set(), set()),
    ("with self.a:\n    def g():\n        here", set(), set()),
    ("self.a.acquire()\nhere\nself.a.release()", {"a"}, set()),
    ("self.a.acquire()\ntry:\n    here\nfinally:\n    self.a.release()", {"a"}, set()),
    ("self.a.acquire()\nself.a.release()\nhere", set(), set()),
    ("here\nself.a.acquire()\nself.a.release()", set(), set()),
    ("self.a.acquire()\nhere", set(), set()),
    ("self.a.acquire()\nhere\nmutex.release()", set(), set()),
    ("if self.a.acquire(blocking=False):\n    here\n    self.a.release()", {"a"}, {"a"}),
    ("if self.a.acquire(False):\n    here\n    self.a.release()", {"a"}, {"a"}),
    ("if self.a.acquire(True):\n    here\n    self.a.release()", {"a"}, set()),
    ("self.a.acquire(timeout=1)\nhere\nself.a.release()", {"a"}, set()),
    ("self.a.acquire(False)\nwith mutex:\n    here\nself.a.release()", {"a", "mutex"}, {"a"}),
]


@pytest.mark.parametrize(("body", "held", "tried"), HELD)
def test_held_and_tried_locks_of_a_statement_are_found(body, held, tried):
    node, outline = place(body)
    assert locks_around(node, outline) == held
    assert tried_around(node, outline) == tried
    assert locks_around(node, outline) is locks_around(node, outline), "the answer is kept"


def test_a_with_statement_at_module_level_holds_its_lock():
    outline = Outline(ast.parse("import threading\nl = threading.Lock()\nwith l:\n    here"))
    node = next(n for n in ast.walk(outline.tree) if isinstance(n, ast.Name) and n.id == "here")
    assert (locks_around(node, outline), tried_around(node, outline)) == ({"l"}, set())


@pytest.mark.parametrize(
    ("text", "name"),
    [("self.a", "a"), ("self.b", "a"), ("mutex", "mutex"), ("self.b.acquire()", "a"), ("lock_of()", "lock_of"),
     ("self.my_mutex", "my_mutex"), ("self.x", ""), ("f()[0]", "")],
)  # fmt: skip
def test_a_lock_has_the_name_of_its_variable(text, name):
    _, outline = method("pass")
    assert lock_name(ast.parse(text, mode="eval").body, outline) == name


@pytest.mark.parametrize(
    ("body", "asked"),
    [
        ("if here == 1:\n    return\nwith self.a:\n    pass", {"a"}),
        ("if not here:\n    return\nself.a.acquire()", {"a"}),
        ("for i in j:\n    if here > 1 and k:\n        continue\n    with mutex:\n        pass", {"mutex"}),
        ("if here:\n    raise E\nwith self.b:\n    pass", {"a"}),
        ("with self.a:\n    pass\nif here:\n    return", set()),
        ("if here:\n    x = 1\nwith self.a:\n    pass", set()),
        ("if x:\n    here\n    return\nwith self.a:\n    pass", set()),
        ("y = here\nwith self.a:\n    pass", set()),
        ("while here:\n    pass\nwith self.a:\n    pass", set()),
    ],
)
def test_locks_after_an_early_return_are_found(body, asked):
    node, outline = place(body)
    assert asked_before(node, outline) == asked


@pytest.mark.parametrize(
    ("body", "loops"),
    [("here", False), ("while x:\n    here", True), ("while here:\n    pass", True), ("for i in j:\n    here", False),
     ("while x:\n    def g():\n        here", False), ("while x:\n    pass\nhere", False)],
)  # fmt: skip
def test_code_inside_a_while_loop_is_recognised(body, loops):
    node, outline = place(body)
    assert in_loop(node, outline) is loops


def found(body: str) -> list[tuple[str, str]]:
    """Return the accesses of a method to self and globals: (name, how), with `constant` for a stored constant."""
    function, outline = method(body)
    made = sorted(accesses(function, "self", outline), key=lambda one: (one.node.lineno, one.node.col_offset))
    return [
        (f"{'' if one.is_global else 'self.'}{one.name}", f"{one.how}{' constant' * one.constant}")
        for one in made
    ]


ACCESSES = [
    ("y = self.x", [("self.x", "reads")]),
    ("self.x = given", [("self.x", "replaces")]),
    ("self.x = True", [("self.x", "replaces constant")]),
    ("self.x += 1", [("self.x", "adds")]),
    ("self.l.append(given)", [("self.l", "inside")]),
    ("self.d['k'] = given", [("self.d", "inside")]),
    ("self.d['k'].append(1)", [("self.d", "inside")]),
    ("del self.d['k']", [("self.d", "inside")]),
    ("self.x.y = given", [("self.x", "inside")]),
    ("n = len(self.l)", [("self.l", "length")]),
    ("n = self.l[0]", [("self.l", "reads")]),
    ("self.l.index(1)", [("self.l", "reads")]),
    ("other.x = 1", []),
    ("given.append(1)", []),
    ("table['k'] = given", [("table", "inside")]),
    ("names.append(given)", [("names", "inside")]),
    ("y = level", []),
    ("global level\nlevel = given", [("level", "replaces")]),
    ("names = []\nnames.append(1)", []),
    ("def g():\n    self.x = 1", []),
    ("if given:\n    def g():\n        self.x = 1", []),
    ("g = lambda: self.x", []),
    ("if self.x is None:\n    pass", []),
    ("if not self.x:\n    pass", []),
    ("while self.x:\n    pass", []),
    ("y = given and self.x", []),
    ("if self.x == 1:\n    pass", [("self.x", "reads")]),
    ("self.other.append(1)", [("self.other", "reads")]),
    ("self.other.held.append(1)", [("self.other", "inside")]),
]


@pytest.mark.parametrize(("body", "expected"), ACCESSES)
def test_access_is_a_read_a_replacement_or_a_change(body, expected):
    assert found(body) == expected
