"""Code that a repair writes into expressions: rounded numbers, and parentheses where the grammar needs them."""

from __future__ import annotations

import ast

import pytest

from pytest_tarl.patching.document import Document, document, parse_expression
from pytest_tarl.patching.expression_texts import (
    choice,
    counting,
    enclosed,
    fitted,
    negated,
    number,
    rounded,
    scaled,
    shifted,
)

HOLE = "hole"
CODES = (
    "a",
    "a.b",
    "a[0]",
    "f(a)",
    "12.0",
    "-a",
    "not a",
    "a ** b",
    "a * b",
    "a % b",
    "a + b",
    "a - b",
    "a << b",
    "a & b",
    "a ^ b",
    "a | b",
    "a < b",
    "a and b",
    "a or b",
    "a if b else c",
    "lambda: a",
    "(a, b)",
)
PLACES = (
    "x = {}",
    "x = {} + d",
    "x = d + {}",
    "x = {} - d",
    "x = d - {}",
    "x = {} * d",
    "x = d * {}",
    "x = d / {}",
    "x = {} ** d",
    "x = d ** {}",
    "x = -{}",
    "x = not {}",
    "x = ~{}",
    "x = {} << d",
    "x = d & {}",
    "x = {} | d",
    "x = d ^ {}",
    "x = {} < d",
    "x = d < {}",
    "x = d in {}",
    "x = {} and d",
    "x = d or {}",
    "x = {} or d",
    "x = {} if d else e",
    "x = d if {} else e",
    "x = d if e else {}",
    "f({})",
    "f(x={})",
    "f(*{})",
    "f(**{})",
    "{}(d)",
    "x = {}.d",
    "x = {}[d]",
    "x = d[{}]",
    "x = d[{}:e]",
    "x = [{}, d]",
    "x = {{d: {}}}",
    "x = {{**{}}}",
    "x = [d for d in {}]",
    "x = [d for d in e if {}]",
    "x = [{} for d in e]",
    "x = ({})",
    "x = ( {} )",
    "return {}",
    "assert {}",
    "if {}: pass",
    "while {}: pass",
)
CLEARER = ("f(*{})", "x = {}.d")  # parentheses that readers want: `f(*(not a))`, `(12.0).d`


def body(text: str) -> str:
    return f"def f():\n    {text}\n"


def hole(source: Document) -> ast.expr:
    return next(node for node in ast.walk(source.tree) if isinstance(node, ast.Name) and node.id == HOLE)


class Filled(ast.NodeTransformer):
    """Replace the hole by an expression."""

    def __init__(self, code: str) -> None:
        self.code = code

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return parse_expression(self.code) if node.id == HOLE else node


def dump(text: str) -> str | None:
    try:
        return ast.dump(ast.parse(text))
    except SyntaxError:
        return None


@pytest.mark.parametrize("place", PLACES)
def test_inserted_code_has_no_needless_parentheses(place: str) -> None:
    text = body(place.format(HOLE))
    source = document("a.py", text)
    node = hole(source)
    start, end = source.start(node), source.end(node)
    for code in CODES:
        wanted = ast.dump(Filled(code).visit(ast.parse(text)))
        written = fitted(source, node, code)
        assert written in (code, f"({code})")
        assert dump(text[:start] + written + text[end:]) == wanted, code
        if written != code and place not in CLEARER:
            assert dump(text[:start] + code + text[end:]) != wanted, f"{code}: needless parentheses"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (12.0, "12.0"),
        (0.123456, "0.1235"),
        (123456.0, "123500.0"),
        (-2.00004, "-2.0"),
        (3, "3"),
        (123456, "123456"),
        (True, "True"),
    ],
)
def test_numbers_are_written_with_four_digits(value: float, text: str) -> None:
    assert number(value) == text


def test_rounding_keeps_significant_digits() -> None:
    assert [rounded(x) for x in (0.000123456, 99999.0, -1.00049, 0.0)] == [0.0001235, 100000.0, -1.0, 0.0]


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        (scaled("a", 1.5), "1.5 * a"),
        (scaled("a + b", 1.5), "1.5 * (a + b)"),
        (scaled("-a", 2.0), "2.0 * -a"),
        (scaled("a * b", 2.0), "2.0 * (a * b)"),
        (shifted("a", 1.5), "a + 1.5"),
        (shifted("a", -1.5), "a - 1.5"),
        (shifted("a - b", 1), "a - b + 1"),
        (shifted("a < b", 1), "(a < b) + 1"),
        (shifted("a", 0.0), "a + 0.0"),
        (negated("a"), "not a"),
        (negated("a == b"), "not a == b"),
        (negated("a and b"), "not (a and b)"),
        (negated("not a"), "not not a"),
        (choice("a", "b", "c"), "b if a else c"),
        (choice("a or b", "c or d", "e if f else g"), "c or d if a or b else e if f else g"),
        (choice("a if b else c", "d if e else f", "g"), "(d if e else f) if (a if b else c) else g"),
        (enclosed("a + b", 0), "a + b"),
        (enclosed("await a", 14), "(await a)"),
    ],
)
def test_expressions_are_written_in_the_style_of_a_maintainer(written: str, expected: str) -> None:
    assert written == expected
    parse_expression(written)


@pytest.mark.parametrize(
    ("text", "counts"),
    [
        ("x[hole]", True),
        ("hole[0]", False),
        ("x[hole:3]", True),
        ("x[1, hole]", True),
        ("x[hole + 1]", True),
        ("x[-hole]", True),
        ("x[hole / 2]", False),
        ("range(hole)", True),
        ("np.zeros(hole)", True),
        ("np.zeros((hole, 3))", True),
        ("math.sin(hole)", False),
        ("f([1, hole])", False),
        ("f(queue_size=hole)", True),
        ("f(rate=hole)", False),
        ("x == hole", True),
        ("hole in x", True),
        ("hole is x", True),
        ("x < hole", False),
        ("x << hole", True),
        ("hole & x", True),
        ("[0] * hole", True),
        ("'a' * hole", True),
        ("x * hole", False),
        ("[x] + hole", False),
        ("hole", False),
    ],
)
def test_indices_lengths_and_codes_are_integers(text: str, counts: bool) -> None:
    source = document("a.py", f"{text}\n")
    assert counting(source, hole(source)) is counts


@pytest.mark.parametrize(
    ("text", "counts"),
    [
        ("f((255, 1))", True),
        ("f([1, -2, 3])", True),
        ("f([1])", False),
        ("f([1, 2.0])", False),
        ("f([1, True])", False),
        ("f([1, a])", False),
        ("x = [1, 2]", False),
    ],
)
def test_literal_integer_vector_stays_one(text: str, counts: bool) -> None:
    source = document("a.py", f"{text}\n")
    one = next(
        node for node in ast.walk(source.tree) if isinstance(node, ast.Constant) and node.value in (1, 255)
    )
    assert counting(source, one) is counts
