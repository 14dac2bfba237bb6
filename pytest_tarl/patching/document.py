"""A source text with its syntax tree, and edits that leave all other text unchanged."""

from __future__ import annotations

import ast
import re
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise

from pytest_tarl.errors import RepairError
from tarl_lint.model import Span

Function = ast.FunctionDef | ast.AsyncFunctionDef
Loop = ast.For | ast.AsyncFor | ast.While
_NEWLINE = re.compile(r"\r\n|\r|\n")
_COMMENT = re.compile(r"[ \t\f]*(#[^\r\n]*)?")


def called(call: ast.Call) -> str:
    """Return the last part of the called function's name."""
    return ast.unparse(call.func).rpartition(".")[2]


def argument_names(function: Function | ast.Lambda) -> list[str]:
    """Return the names of a function's positional arguments, without `self` and `cls`."""
    return [one.arg for one in function.args.args if one.arg not in ("self", "cls")]


def strings(nodes: Iterable[ast.AST]) -> list[str]:
    """Return the values of the string literals among these nodes."""
    return [one.value for one in nodes if isinstance(one, ast.Constant) and isinstance(one.value, str)]


@dataclass(frozen=True, slots=True)
class Edit:
    """Replace the characters from `start` to `end` by `text`, whose line endings are line feeds."""

    start: int
    end: int
    text: str


@dataclass(frozen=True, eq=False)
class Document:
    """Text and syntax tree of a module; offsets count characters."""

    path: str
    text: str
    tree: ast.Module

    @cached_property
    def newline(self) -> str:
        """Return the most frequent line ending."""
        windows = self.text.count("\r\n")
        return "\r\n" if windows * 2 > self.text.count("\n") else "\n"

    @cached_property
    def line_starts(self) -> tuple[int, ...]:
        """Return the offset of every line's first character."""
        return (0, *(match.end() for match in _NEWLINE.finditer(self.text)))

    @cached_property
    def parents(self) -> dict[ast.AST, ast.AST]:
        """Map every node to its parent."""
        return {child: node for node in ast.walk(self.tree) for child in ast.iter_child_nodes(node)}

    @cached_property
    def statements_at(self) -> Mapping[int, Sequence[ast.stmt]]:
        """Map each line to the statements that start there, in the order of `ast.walk`."""
        found: dict[int, list[ast.stmt]] = {}
        for node in ast.walk(self.tree):
            if isinstance(node, ast.stmt):
                found.setdefault(node.lineno, []).append(node)
        return found

    @cached_property
    def expressions(self) -> dict[tuple[int, int], ast.expr]:
        """Map (start, end) offsets to the innermost expression there."""
        nodes = (node for node in ast.walk(self.tree) if isinstance(node, ast.expr))
        return {(self.start(node), self.end(node)): node for node in nodes}

    @cached_property
    def unit(self) -> str:
        """Return one level of this file's indentation; four spaces by default."""
        for node in ast.walk(self.tree):
            body = getattr(node, "body", None)
            if isinstance(node, ast.stmt) and isinstance(body, list) and self.alone(body[0]):
                outer, inner = self.indentation(node), self.indentation(body[0])
                if inner.startswith(outer) and len(inner) > len(outer):
                    return inner[len(outer) :]
        return "    "

    def start(self, node: ast.expr | ast.stmt) -> int:
        """Return the offset of a node's first character, without decorators."""
        return self.offset(node.lineno, node.col_offset)

    def end(self, node: ast.expr | ast.stmt) -> int:
        """Return the offset after a node's last character."""
        return self.offset(node.end_lineno or node.lineno, node.end_col_offset or node.col_offset)

    def source(self, node: ast.expr | ast.stmt) -> str:
        """Return the text of a node."""
        return self.text[self.start(node) : self.end(node)]

    def line_start(self, node: ast.expr | ast.stmt) -> int:
        """Return the offset at which a node's first line (including decorators) starts."""
        decorators: list[ast.expr] = getattr(node, "decorator_list", [])
        return self.line_starts[min([node.lineno, *(each.lineno for each in decorators)]) - 1]

    def line_end(self, node: ast.expr | ast.stmt) -> int:
        """Return the offset at which a node's last line ends, before the line ending."""
        match = _NEWLINE.search(self.text, self.end(node))
        return match.start() if match else len(self.text)

    def indentation(self, node: ast.stmt) -> str:
        """Return the white space before a statement's first line."""
        line = self.text[self.line_starts[node.lineno - 1] : self.start(node)]
        return line[: len(line) - len(line.lstrip(" \t\f"))]

    def comment(self, node: ast.stmt) -> str:
        """Return the comment after a statement, or an empty text."""
        match = _COMMENT.match(self.text, self.end(node))
        return (match and match.group(1)) or ""

    def alone(self, node: ast.stmt) -> bool:
        """Return whether a statement has its lines to itself."""
        after = self.text[self.end(node) : self.line_end(node)].strip(" \t\f")
        return self.leads(node) and after[:1] in ("", "#")

    def leads(self, node: ast.stmt) -> bool:
        """Return whether a statement is the first on its line."""
        return not self.text[self.line_starts[node.lineno - 1] : self.start(node)].strip(" \t\f")

    def at(self, span: Span) -> ast.expr | None:
        """Return the expression at a span, or None if there is none."""
        first, last = (span.line, span.column), (span.end_line, span.end_column)
        return self.expressions.get((self._characters(*first), self._characters(*last)))

    def span(self, node: ast.expr) -> Span:
        """Return the place of an expression."""
        last = node.end_lineno or node.lineno
        start = self.start(node) - self.line_starts[node.lineno - 1]
        end = self.end(node) - self.line_starts[last - 1]
        return Span(self.path, node.lineno, start + 1, last, end + 1)

    def find(self, span: Span) -> ast.expr:
        """Return the expression at a span. Raise RepairError if there is none."""
        node = self.at(span)
        if node is None:
            raise RepairError(
                f"{span.path}:{span.line}:{span.column} holds no expression that can be replaced: if the file was "
                "edited during the run, run again."
            )
        return node

    def ancestors(self, node: ast.AST) -> Iterator[ast.AST]:
        """Yield the nodes around a node, innermost first."""
        while node in self.parents:
            node = self.parents[node]
            yield node

    def statement(self, node: ast.expr) -> ast.stmt:
        """Return the innermost statement around an expression."""
        return next(each for each in self.ancestors(node) if isinstance(each, ast.stmt))

    def function(self, node: ast.AST) -> Function | None:
        """Return the innermost named function around a node."""
        return next((each for each in self.ancestors(node) if isinstance(each, Function)), None)

    def method(self, node: ast.AST) -> tuple[ast.ClassDef, Function, str] | None:
        """Return class, method and name of `self` around a node, or None."""
        for method, owner in pairwise([node, *self.ancestors(node)]):
            if isinstance(method, Function) and isinstance(owner, ast.ClassDef):
                return _bound(owner, method)
        return None

    def top_level(self, node: ast.AST) -> ast.stmt:
        """Return the top-level statement that contains a node."""
        inside = [node, *self.ancestors(node)]
        return next(each for each in reversed(inside[:-1]) if isinstance(each, ast.stmt))

    def block(self, statement: ast.stmt) -> list[ast.stmt]:
        """Return the list of statements to which a statement belongs."""
        holder = self.parents[statement]
        for _, value in ast.iter_fields(holder):
            if isinstance(value, list) and any(each is statement for each in value):
                return value
        return [statement]

    def _characters(self, line: int, column: int) -> int:
        return self.line_starts[line - 1] + column - 1 if 0 < line <= len(self.line_starts) else -1

    def offset(self, line: int, byte: int) -> int:
        """Return the character offset of a position whose column counts UTF-8 bytes."""
        start = self.line_starts[line - 1]
        if self.text.isascii():
            return start + byte
        stop = self.line_starts[line] if line < len(self.line_starts) else len(self.text)
        return start + len(self.text[start:stop].encode()[:byte].decode())


@cache
def document(path: str, text: str) -> Document:
    """Parse a text, with caching. Raise RepairError if it is not Python."""
    try:
        return Document(path, text, parse(text))
    except SyntaxError as error:
        raise RepairError(f"{path}:{error.lineno} cannot be parsed as Python: {error.msg}.") from error


def parse(text: str) -> ast.Module:
    """Parse a text without compiler warnings. Raise SyntaxError."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return ast.parse(text)


def parse_expression(code: str) -> ast.expr:
    """Parse an expression that may have several lines or a comment. Raise SyntaxError."""
    statement = parse(f"({code}\n)").body[0]
    assert isinstance(statement, ast.Expr)  # noqa: S101  (parentheses hold nothing else)
    return statement.value


def apply_edits(source: Document, edits: Iterable[Edit]) -> str:
    """Return the text with all edits made. Insertions at the same offset keep their order.

    Raise RepairError if two edits overlap or the result is not valid Python.
    """
    changed = apply_plain_edits(source.path, source.text, edits, source.newline)
    _check(source.path, changed)
    return changed


def apply_plain_edits(path: str, text: str, edits: Iterable[Edit], newline: str = "\n") -> str:
    """Return a text with all edits made. Raise RepairError if two overlap."""
    pieces, position = [], 0
    for edit in sorted(edits, key=lambda each: (each.start, each.end)):
        if edit.start < position:
            line = text.count("\n", 0, edit.start) + 1
            raise RepairError(f"{path}:{line}: two changes to this code conflict: choose one of them.")
        written = edit.text.replace("\r\n", "\n").replace("\n", newline)
        pieces += [text[position : edit.start], written]
        position = edit.end
    return "".join([*pieces, text[position:]])


def _check(path: str, text: str) -> None:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            compile(text, path, "exec", dont_inherit=True)
    except SyntaxError as error:
        reason = f"{path}:{error.lineno} would no longer parse as Python: {error.msg}."
        raise RepairError(reason) from error


def _bound(owner: ast.ClassDef, method: Function) -> tuple[ast.ClassDef, Function, str] | None:
    unbound = {"staticmethod", "classmethod"}
    arguments = [*method.args.posonlyargs, *method.args.args]
    decorated = any(isinstance(each, ast.Name) and each.id in unbound for each in method.decorator_list)
    return (owner, method, arguments[0].arg) if arguments and not decorated else None
