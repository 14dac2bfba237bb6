"""Tokenise and parse formulas with rtamt's grammar; explain syntax errors."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Any

from pytest_tarl.formulas import quietly  # noqa: F401

# isort: split

from antlr4.error.ErrorListener import ErrorListener
from antlr4.InputStream import InputStream
from rtamt.antlr.parser.stl.LtlLexer import LtlLexer
from rtamt.exception.exception import RTAMTException
from rtamt.syntax.ast.parser.stl.specification_parser import StlAst
from rtamt.syntax.node.abstract_node import AbstractNode
from rtamt.syntax.node.ltl.conjunction import Conjunction
from rtamt.syntax.node.ltl.constant import Constant
from rtamt.syntax.node.ltl.disjunction import Disjunction
from rtamt.syntax.node.ltl.fall import Fall
from rtamt.syntax.node.ltl.iff import Iff
from rtamt.syntax.node.ltl.implies import Implies
from rtamt.syntax.node.ltl.neg import Neg
from rtamt.syntax.node.ltl.next import Next
from rtamt.syntax.node.ltl.previous import Previous
from rtamt.syntax.node.ltl.rise import Rise
from rtamt.syntax.node.ltl.strong_next import StrongNext
from rtamt.syntax.node.ltl.strong_previous import StrongPrevious
from rtamt.syntax.node.ltl.variable import Variable
from rtamt.syntax.node.ltl.xor import Xor

from pytest_tarl.formulas.semantics import CONNECTIVES, TIMED, bounds, operands

COUNTING = (Rise, Fall, Next, Previous, StrongNext, StrongPrevious)
WORDS = (
    "always", "eventually", "until", "unless", "once", "historically", "since", "not", "and", "or", "implies", "abs",
    "sqrt", "exp", "pow",
)  # fmt: skip
HINTS = (
    (r"(true|false)\b", "booleans are 1 and -1, so write (delivered > 0)"),
    (r"=[^=]", "write == to compare two values"),
    (r"[&|]", "write and, or"),
)  # first token that the parser rejects → hint for the user
MINUS = "write (0 - gap) for -gap"
_PLACE = re.compile(r"^(?:RTAMT Exception: )?\d+:(?P<column>\d+): Syntax ERROR, ")


class ReadingError(Exception):
    """A string is not a formula; the message is the reason, without a full stop."""


class _Strict(ErrorListener):  # type: ignore[misc]
    """Raise on syntax errors, which antlr would only print."""

    def syntaxError(self, *told: Any) -> None:  # noqa: N802
        """Raise ReadingError for characters outside the grammar; the fifth argument is antlr's message."""
        msg: str = told[4]
        raise ReadingError(f"{msg.partition(': ')[2]} has no meaning in a formula")


def words(text: str) -> tuple[list[str], list[str]]:
    """Return the names and the other tokens in a string. Raise ReadingError for characters outside the grammar."""
    lexer = LtlLexer(InputStream(text))
    lexer.removeErrorListeners()
    lexer.addErrorListener(_Strict())
    tokens = lexer.getAllTokens()
    names = [token.text for token in tokens if token.type == LtlLexer.Identifier]
    return names, [token.text for token in tokens if token.type != LtlLexer.Identifier]


def tree(text: str, names: Sequence[str]) -> Any:
    """Parse a formula over these names into a tree of rtamt's nodes. Raise ReadingError."""
    ast = StlAst()
    for name in names:
        ast.declare_var(name, "float")
    ast.spec = text
    try:
        ast.parse()
    except RTAMTException as problem:
        raise ReadingError(_reason(text, str(problem))) from None
    except AttributeError:  # raised by rtamt for `unless` without bounds
        raise ReadingError("unless needs bounds, such as unless[0:10]") from None
    except (ValueError, KeyError, RecursionError) as problem:
        raise ReadingError(f"{problem}".strip("'") or "it is nested too deeply") from None
    if len(ast.specs) != 1:
        raise ReadingError("it holds more than one formula: join them with `and`, or list them separately")
    return _connected(ast.specs[0])


def nodes(node: Any) -> Iterator[Any]:
    """Yield a node and all its descendants."""
    yield node
    for child in node.children:
        yield from nodes(child)


def atoms(node: Any) -> Iterator[Any]:
    """Yield a formula's atoms: the nodes that are not connectives, such as comparisons."""
    if not isinstance(node, CONNECTIVES):
        yield node
        return
    for child in operands(node):
        yield from atoms(child)


def signals(node: Any) -> tuple[str, ...]:
    """Return the names in a formula, in order of appearance."""
    return tuple(dict.fromkeys(one.var for one in nodes(node) if isinstance(one, Variable)))


def _reason(text: str, problem: str) -> str:
    place = _PLACE.search(problem)
    if place is None:
        return problem.removeprefix("RTAMT Exception: ").rstrip()
    column = int(place["column"])
    rest = text[column:].strip()
    if not rest:
        return "it ends too early"
    negated = text[:column].endswith("-")
    hint = next((hint for start, hint in HINTS if re.match(start, rest)), MINUS if negated else "")
    return f"it cannot be parsed from {rest!r} on{hint and '; '}{hint}"


def _connected(node: AbstractNode) -> Any:
    """Check a tree, and replace `iff` and `xor` by other connectives. Raise ReadingError."""
    if isinstance(node, COUNTING):
        raise ReadingError(
            "next, prev, rise and fall count samples, but steps may differ in length: give a time in "
            "seconds, such as "
            "eventually[0:0.1] (…)"
        )
    if isinstance(node, (Iff, Xor)):
        left, right = (_connected(child) for child in node.children[:2])
        if isinstance(node, Iff):
            return Conjunction(Implies(left, right), Implies(right, left))
        return Disjunction(Conjunction(left, Neg(right)), Conjunction(Neg(left), right))
    if not isinstance(node, CONNECTIVES):
        return _numeric(node)
    if isinstance(node, TIMED):
        _check(node)
    node.children = [_connected(child) for child in operands(node)]
    return node


def _check(node: Any) -> None:
    begin, end = bounds(node)
    if not 0 <= begin <= end:
        raise ReadingError(
            f"the bounds [{begin / 1e9:g}:{end / 1e9:g}] s must increase and must not be negative"
        )


def _numeric(node: Any) -> Any:
    """Return the atom. Raise ReadingError if it compares formulas or has no signal."""
    if any(isinstance(one, (*CONNECTIVES, *COUNTING, Iff, Xor)) for one in nodes(node)):
        raise ReadingError("it uses a formula as a number: only numbers can be compared")
    if isinstance(node, Constant) or not signals(node):
        raise ReadingError("a part of it names no signal, so its value could never change")
    return node
