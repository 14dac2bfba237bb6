"""Statements for display: position, text, and an identity that survives moved lines."""

from __future__ import annotations

import ast
import copy
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from tarl_lint.ir.nodes import Pos
from tarl_lint.model import SiteId, Span
from tarl_lint.read.source import Module
from tarl_lint.read.watched import displayed, unwatched
from tarl_lint.trees import children

COMPOUND = (ast.If, ast.For, ast.AsyncFor, ast.While, ast.With, ast.AsyncWith, ast.Try, ast.Match)
LOOPS = (ast.For, ast.AsyncFor, ast.While)
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


@dataclass(slots=True, eq=False)
class Written:
    """A statement (or the body of a lambda, or a `case` of `match`) and the statements that enclose it."""

    node: ast.AST
    qualname: str
    around: Written | None
    start: tuple[int, int]
    text: Text

    @property
    def defines(self) -> bool:
        """Return whether this is a function or class.

        A statement around a definition does not enclose the calls of the defined function or class.
        """
        return isinstance(self.node, (*FUNCTIONS, ast.ClassDef))

    @property
    def shown(self) -> bool:
        """Return whether this is a loop or the `__main__` guard, which are shown as context of the steps inside."""
        return isinstance(self.node, LOOPS) or (
            isinstance(self.node, ast.If) and _guards_main(self.node.test)
        )


@dataclass(slots=True)
class Text:
    """Finds the statements of one module by position."""

    module: Module
    by_start: dict[tuple[int, int], Written] = field(default_factory=dict)
    functions: dict[tuple[int, int], Written] = field(default_factory=dict)
    by_name: dict[str, list[Written]] = field(default_factory=dict)
    texts: dict[int, str] = field(default_factory=dict)
    ordinals: dict[int, int] = field(default_factory=dict)
    spans: dict[int, Span] = field(default_factory=dict)
    lines: list[str] = field(default_factory=list)
    has_lambdas: bool = True

    def __post_init__(self) -> None:
        text = displayed(self.module)
        self.lines = text.split("\n")
        self.has_lambdas = "lambda" in text
        self._body(self.module.tree.body, "", None)

    def _body(self, body: Sequence[ast.stmt], qualname: str, around: Written | None) -> None:
        for node in body:
            self._enter(node, qualname, around)

    def _enter(self, node: ast.stmt | ast.match_case, qualname: str, around: Written | None) -> None:
        start = _start(node)
        written = Written(node, qualname, around, start, self)
        if isinstance(node, FUNCTIONS):
            inner = f"{qualname}.{node.name}" if qualname else node.name
            arriving = Written(node, inner, around, start, self)
            self.functions[start] = arriving
            self.by_name.setdefault(inner, []).append(arriving)
            self._lambdas([*node.decorator_list, *node.args.defaults], qualname, written)
            self._body(unwatched(node.body), inner, written)
            return
        if isinstance(node, ast.ClassDef):
            self._body(node.body, f"{qualname}.{node.name}" if qualname else node.name, written)
            return
        self.by_start[start] = written
        self.by_name.setdefault(qualname, []).append(written)
        for child in children(node):
            if isinstance(child, (ast.stmt, ast.match_case)):
                self._enter(child, qualname, written)
            elif isinstance(child, ast.excepthandler):
                self._body(getattr(child, "body", []), qualname, written)
            elif isinstance(child, ast.expr):
                self._lambdas([child], qualname, written)
            elif isinstance(child, ast.withitem):
                self._lambdas([child.context_expr], qualname, written)

    def _lambdas(self, nodes: list[ast.expr], qualname: str, around: Written) -> None:
        if not self.has_lambdas:
            return
        for node in nodes:
            for child in _outer_lambdas(node):
                inner = f"{qualname}.<lambda>" if qualname else "<lambda>"
                written = Written(child.body, inner, around, _start(child.body), self)
                self.functions[_start(child)] = written
                self.by_start.setdefault(written.start, written)
                self.by_name.setdefault(inner, []).append(written)
                self._lambdas([child.body], inner, written)

    def statement(self, pos: Pos) -> Written | None:
        """Return the statement that starts here."""
        return self.by_start.get((pos[0], pos[1]))

    def function(self, pos: Pos) -> Written | None:
        """Return the function whose header starts here; a message arrives at this header."""
        return self.functions.get((pos[0], pos[1]))

    def site(self, written: Written) -> SiteId:
        """Return a statement's identity."""
        if id(written) not in self.ordinals:
            self._count(written.qualname)
        return SiteId(
            self.module.name, written.qualname, self.text(written), self.ordinals.get(id(written), 0)
        )

    def _count(self, qualname: str) -> None:
        """Number the statements of a function that have equal texts."""
        seen: Counter[str] = Counter()
        for written in self.by_name.get(qualname, ()):
            text = self.text(written)
            self.ordinals[id(written)] = seen[text]
            seen[text] += 1

    def text(self, written: Written) -> str:
        """Return a statement as `ast.unparse` formats it; for a compound statement, its header."""
        known = self.texts.get(id(written))
        if known is None:
            known = self.texts[id(written)] = ast.unparse(_header(written.node)).strip()
        return known

    def span(self, written: Written) -> Span:
        """Return the span of a statement; for a compound statement, the span of its header."""
        known = self.spans.get(id(written))
        if known is None:
            known = self.spans[id(written)] = self.stretch((*written.start, *self._end(written.node)))
        return known

    def stretch(self, pos: Pos) -> Span:
        """Return a range of positions as a span."""
        line, column, end_line, end_column = pos
        return Span(
            self.module.path, line, self._column(line, column), end_line, self._column(end_line, end_column)
        )

    def code(self, span: Span) -> str:
        """Return the source text of a span."""
        if span.line == span.end_line:
            return self.lines[span.line - 1][span.column - 1 : span.end_column - 1]
        first = self.lines[span.line - 1][span.column - 1 :]
        last = self.lines[span.end_line - 1][: span.end_column - 1]
        return "\n".join([first, *self.lines[span.line : span.end_line - 1], last])

    def _column(self, line: int, offset: int) -> int:
        """Convert an offset in UTF-8 bytes to a column in characters, counted from 1."""
        text = self.lines[line - 1] if 0 < line <= len(self.lines) else ""
        return offset + 1 if text.isascii() else len(text.encode()[:offset].decode(errors="replace")) + 1

    def _end(self, node: ast.AST) -> tuple[int, int]:
        """Return the end of a statement; for a compound statement, the end of its header including the colon."""
        last = _last_of_header(node)
        if last is None:
            return _ends(node)
        line, offset = last
        while line <= len(self.lines):
            raw = self.lines[line - 1].encode()
            for index in range(offset, len(raw)):
                if raw[index : index + 1] == b":":
                    return line, index + 1
                if raw[index : index + 1] == b"#":
                    break
            line, offset = line + 1, 0
        return last


class Texts:
    """The texts of all modules, each parsed on first use."""

    def __init__(self, modules: Mapping[str, Module]) -> None:
        self.modules = modules
        self.known: dict[str, Text] = {}

    def release(self) -> None:
        """Drop the statements and their references to the texts."""
        for text in self.known.values():
            for table in (text.by_start, text.functions, text.by_name):
                table.clear()

    def __getitem__(self, path: str) -> Text:
        """Return the text of a file."""
        if path not in self.known:
            self.known[path] = Text(self.modules[path])
        return self.known[path]


def _guards_main(test: ast.expr) -> bool:
    """Return whether a test is `__name__ == "__main__"`."""
    return isinstance(test, ast.Compare) and isinstance(test.left, ast.Name) and test.left.id == "__name__"


def _start(node: ast.AST) -> tuple[int, int]:
    if isinstance(node, ast.match_case):
        return node.pattern.lineno, node.pattern.col_offset
    return getattr(node, "lineno", 1), getattr(node, "col_offset", 0)


def _header(node: ast.AST) -> ast.AST:
    """Return a copy of a compound statement without its body."""
    if isinstance(node, ast.match_case):
        return ast.match_case(pattern=node.pattern, guard=node.guard, body=[])
    if not isinstance(node, (*COMPOUND, *FUNCTIONS)):
        return node
    header = copy.copy(node)
    for name in ("body", "orelse", "finalbody", "handlers", "cases", "decorator_list"):
        if hasattr(header, name):
            setattr(header, name, [])
    return header


def _last_of_header(node: ast.AST) -> tuple[int, int] | None:
    """Return the end of the last expression of a header; None for simple statements."""
    if isinstance(node, FUNCTIONS):
        parts: list[ast.AST] = [*ast.walk(node.args)]
        parts += [node.returns] if node.returns is not None else []
        ends = [_ends(p) for p in parts if hasattr(p, "end_lineno")]
        return max(ends, default=(node.lineno, node.col_offset))
    if isinstance(node, (ast.If, ast.While)):
        return _ends(node.test)
    if isinstance(node, (ast.For, ast.AsyncFor)):
        return _ends(node.iter)
    if isinstance(node, (ast.With, ast.AsyncWith)):
        item = node.items[-1]
        return _ends(item.optional_vars or item.context_expr)
    if isinstance(node, ast.Match):
        return _ends(node.subject)
    if isinstance(node, ast.match_case):
        return _ends(node.guard or node.pattern)
    return (node.lineno, node.col_offset) if isinstance(node, ast.Try) else None


def _ends(node: ast.AST) -> tuple[int, int]:
    return getattr(node, "end_lineno", 1) or 1, getattr(node, "end_col_offset", 0) or 0


def _outer_lambdas(node: ast.expr) -> Iterator[ast.Lambda]:
    """Yield the lambdas in an expression that are not inside another lambda."""
    pending: list[ast.AST] = [node]
    while pending:
        current = pending.pop(0)
        if isinstance(current, ast.Lambda):
            yield current
        else:
            pending.extend(children(current))
