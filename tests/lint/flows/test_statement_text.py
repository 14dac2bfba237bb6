"""The text, span and identity of each statement; a compound statement has those of its header."""

from __future__ import annotations

import ast
from textwrap import dedent

import pytest

from tarl_lint.flows.statement_text import Text
from tarl_lint.model import Span
from tarl_lint.read.source import Module


def text_of(source: str) -> Text:
    source = dedent(source)
    return Text(Module("node.py", "node", source, ast.parse(source)))


HEADERS = [
    ("x = 1", "x = 1", "x = 1"),
    ("x = (1,\n     2)", "x = (1, 2)", "x = (1,\n     2)"),
    ("if x:\n    y = 1\nelse:\n    y = 2", "if x:", "if x:"),
    ("if (x and\n        z):  # why\n    y = 1", "if x and z:", "if (x and\n        z):"),
    ("if x  :\n    y = 1", "if x:", "if x  :"),
    ("while x: y = 1", "while x:", "while x:"),
    ("for a, b in c:\n    y = 1", "for a, b in c:", "for a, b in c:"),
    ("async def f():\n    async for a in b:\n        y = 1", None, None),
    ("with a as b, c:\n    y = 1", "with a as b, c:", "with a as b, c:"),
    ("try:\n    y = 1\nexcept E:\n    y = 2", "try:", "try:"),
    ("match x:\n    case 1:\n        y = 1", "match x:", "match x:"),
    ("assert x, 'y: z'", "assert x, 'y: z'", "assert x, 'y: z'"),
    ("x = {'a': 1}", "x = {'a': 1}", "x = {'a': 1}"),
    ("if x[1:2]:\n    y = 1", "if x[1:2]:", "if x[1:2]:"),
]


@pytest.mark.parametrize(("source", "found"), [("x = 1", False), ("x = lambda: 1", True)])
def test_expressions_are_searched_for_lambdas_only_if_the_text_has_the_word(source, found):
    assert text_of(source).has_lambdas is found


@pytest.mark.parametrize(("source", "shown", "code"), HEADERS)
def test_a_compound_statement_is_shown_by_its_header(source, shown, code):
    text = text_of(source)
    written = text.statement((1, 0, 0, 0))
    if shown is None:
        assert written is None, "a function is no statement of a flow"
        return
    assert written is not None
    assert text.text(written) == shown
    assert text.code(text.span(written)) == code
    assert text.text(written) is text.text(written)


FUNCTIONS = """\
    def f(a,
          b=lambda q: q):
        return a
    class C:
        @staticmethod
        def g(x: int) -> int:
            if x:
                return 1
            return [y for y in x]
    h = lambda z: z + 1
    async def k(): pass
"""


def test_functions_and_lambdas_are_found_by_position():
    text = text_of(FUNCTIONS)
    names = {pos: written.qualname for pos, written in text.functions.items()}
    assert names == {(1, 0): "f", (2, 8): "<lambda>", (6, 4): "C.g", (10, 4): "<lambda>", (11, 0): "k"}
    written = text.function((1, 0, 0, 0))
    assert written is not None
    assert text.code(text.span(written)) == "def f(a,\n      b=lambda q: q):"
    body = text.statement((10, 14, 0, 0))
    assert body is not None
    assert (text.text(body), body.qualname) == ("z + 1", "<lambda>")
    assert text.function((3, 4, 0, 0)) is None


def test_equal_statements_of_a_function_are_numbered():
    text = text_of("x = 1\nif y:\n    x = 1\ndef f():\n    x = 1\n    x = 2\n    x = 1\n")
    sites = [text.site(text.by_start[place]) for place in ((1, 0), (3, 4), (5, 4), (6, 4), (7, 4))]
    assert [(one.module, one.qualname, one.text, one.ordinal) for one in sites] == [
        ("node", "", "x = 1", 0),
        ("node", "", "x = 1", 1),
        ("node", "f", "x = 1", 0),
        ("node", "f", "x = 2", 0),
        ("node", "f", "x = 1", 1),
    ]


def test_the_enclosing_statement_of_a_statement_is_known():
    text = text_of("for a in b:\n    if c:\n        x = 1\n")
    inner = text.by_start[3, 8]
    assert inner.around is text.by_start[2, 4]
    assert inner.around is not None
    assert inner.around.around is text.by_start[1, 0]
    assert text.by_start[1, 0].around is None


def test_columns_are_counted_in_characters_from_one():
    text = text_of("x = 'ä'; y = 'ö' + z\n")
    assert text.stretch((1, 0, 1, 7)) == Span("node.py", 1, 1, 1, 7)
    written = text.by_start[1, 10]
    assert text.span(written) == Span("node.py", 1, 10, 1, 21)
    assert text.code(text.span(written)) == "y = 'ö' + z"
    assert text.stretch((9, 4, 9, 5)) == Span("node.py", 9, 5, 9, 6), "a line that does not exist"
