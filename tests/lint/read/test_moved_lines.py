"""An edited text keeps a result if it differs only in what the analysis has not read."""

from __future__ import annotations

import ast
import operator
from textwrap import dedent

import pytest

from tarl_lint.read.moved_lines import moved_lines
from tarl_lint.read.source import Module, parse
from tarl_lint.read.watched import Reading, displayed, unwatched, watched

OLD = dedent("""\
    import a

    class C:
        def read(self, x):
            return x

        def unread(self):
            return 1

    def outer(y):
        if y:
            def inner():
                return 2
            return inner
        return y
""")
UNREAD = frozenset([(7, 4), (12, 8)])  # C.unread, outer.inner


def moved(new: str, old: str = OLD, *, unread=UNREAD, answers=(), whole: bool = False):
    return moved_lines(dedent(old), dedent(new), Reading(frozenset(unread), tuple(answers), whole))


def test_unchanged_text_keeps_its_line_numbers():
    found = moved(OLD)
    assert found == {line: line for line in (1, 3, 4, 5, 7, 10, 11, 12, 14, 15)}


def test_edits_that_the_analysis_ignores_only_shift_line_numbers():
    new = OLD.replace("import a\n", "# first\n\nimport a\n").replace("return 1", "z = 1\n        return z")
    found = moved(new)
    assert found is not None
    assert found[1] == 3
    assert found[5] == 7
    assert found[10] == 13, "two lines above, and one more in the unread body"
    assert found[15] == 18
    assert 8 not in found, "the body that nothing has read has no place"


@pytest.mark.parametrize(
    ("was", "now"),
    [
        ("import a", "import b"),
        ("return x", "return (x)"),
        ("return x", "return  x"),
        ("return x", "return x  # said"),
        ("return x", "return y"),
        ("return x", "return [x]"),
        ("        return x\n", "        return x\n        return x\n"),
        ("def read(self, x)", "def read(self, y)"),
        ("def read(self, x)", "def read(self, x=1)"),
        ("def unread(self)", "def unread(self, x)"),
        ("def unread(self)", "async def unread(self)"),
        ("class C:", "class D:"),
        ("class C:", "class C(B):"),
        ("    if y:", "    if y :"),
        ("return inner", "return 1"),
        ("return y\n", "return y\n\nz = 1\n"),
    ],
)
def test_changed_code_that_was_read_is_analysed_again(was, now):
    assert was in OLD
    assert moved(OLD.replace(was, now)) is None


def test_a_constant_of_another_type_is_another_constant():
    assert moved("x = 1.0\n", "x = 1\n", unread=()) is None
    assert moved("x = True\n", "x = 1\n", unread=()) is None
    assert moved("x = 1\n", "x = 1\n", unread=()) == {1: 1}


def test_indenting_a_statement_does_not_count_as_moving_it():
    assert moved("if 1:\n  x = 1\n", "if 1:\n    x = 1\n", unread=()) is None


def test_the_order_of_the_lines_must_stay_the_same():
    assert moved("y = 2\nx = 1\n", "x = 1\ny = 2\n", unread=()) is None


def test_a_header_over_several_lines_keeps_its_lines():
    old = "def f(\n    a,\n    b,\n):\n    return 1\n"
    assert moved("\n" + old.replace("1", "2"), old, unread=[(1, 0)]) == {1: 2, 2: 3, 3: 4, 4: 5}
    assert moved(old.replace("b,", "b, c,"), old, unread=[(1, 0)]) is None


def test_a_statement_over_several_lines_keeps_its_lines():
    old = "x = [\n    1,\n\n    2,\n]\ny = x\n"
    assert moved("# first\n" + old, old, unread=()) == {line: line + 1 for line in range(1, 7)}
    assert moved(old.replace("\n\n", "\n"), old, unread=()) is None
    assert moved(old.replace("[\n    1", "[\n    # one\n    1"), old, unread=()) is None


def test_changed_functions_of_equal_names_require_a_new_analysis():
    old = "def f():\n    return 1\n\ndef f():\n    return 2\n"
    assert moved(old.replace("2", "3"), old, unread=[(1, 0), (4, 0)]) is None
    assert moved(f"\n{old}", old, unread=[(1, 0), (4, 0)]) == {1: 2, 4: 5}
    other = old.replace("def f():\n    return 2", "def g():\n    return 2")
    assert moved(other.replace("2", "3"), other, unread=[(1, 0), (4, 0)]) == {1: 1, 4: 4}


def test_changed_answer_of_a_text_check_requires_a_new_analysis():
    asked = (lambda text: "unread" in text, True)
    new = OLD.replace("return 1", "return 3")
    assert moved(new, answers=[asked]) is not None
    assert moved(new, answers=[(asked[0], False)]) is None
    assert moved(new, answers=[asked, (lambda text: "return 3" in text, False)]) is None


def test_changed_unparsable_text_requires_a_new_analysis():
    assert moved(OLD, whole=True) is None
    assert moved(OLD + "\n(") is None
    assert moved(OLD, OLD + "\n(") is None


def module(text: str) -> Module:
    made = parse("node.py", dedent(text).encode(), "node")
    assert isinstance(made, Module)
    return made


FUNCTIONS = """\
    def f():
        return 1
    class C:
        async def g(self):
            return 2
    if 1:
        def h():
            pass
    else:
        def i():
            def j():
                pass
    try:
        pass
    except ValueError:
        def k():
            pass
    finally:
        def l():
            pass
    match 1:
        case 1:
            def m():
                pass
"""
PLACES = {
    "f": (1, 0),
    "g": (4, 4),
    "h": (7, 4),
    "i": (10, 4),
    "j": (11, 8),
    "k": (16, 4),
    "l": (19, 4),
    "m": (23, 8),
}


def functions(tree: ast.AST) -> dict[str, ast.FunctionDef | ast.AsyncFunctionDef]:
    """Return the functions of a tree by name, without reading the bodies of functions."""
    found, pending = {}, [tree]
    while pending:
        node = pending.pop()
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            found[node.name] = node
            pending += unwatched(node.body)
        else:
            pending += ast.iter_child_nodes(node)
    return found


def test_no_function_counts_as_read_at_first():
    assert watched(module(FUNCTIONS)).reading() == Reading(frozenset(PLACES.values()), (), whole=False)


@pytest.mark.parametrize(
    "read",
    [len, list, lambda body: body[0], lambda body: body[:1], lambda body: None in body,
     lambda body: operator.add(body, []), lambda body: [*reversed(body)], ast.unparse],
)  # fmt: skip
def test_using_a_function_body_counts_as_reading(read):
    watch = watched(module(FUNCTIONS))
    body = functions(watch.tree)["g"].body
    read(body if read is not ast.unparse else functions(watch.tree)["g"])
    assert watch.reading().unread == frozenset(PLACES.values()) - {PLACES["g"]}


def test_new_recording_forgets_read_bodies():
    first = watched(module("def f():\n    return 1\n"))
    len(functions(first.tree)["f"].body)
    second = watched(first)
    assert second.reading().unread == {(1, 0)}
    assert ast.unparse(second.tree) == "def f():\n    return 1"


def test_text_queries_and_whole_text_uses_are_recorded():
    watch = watched(module("x = 1\n"))
    assert displayed(watch) == "x = 1\n"
    assert watch.contains("x")
    assert not watch.contains("y")
    assert [known for _, known in watch.reading().answers] == [True, False]
    assert not watch.reading().whole
    assert watch.text
    assert watch.reading().whole
