"""Small faults in a source file: where they are possible, and the text with one of them inserted."""

from __future__ import annotations

import ast
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

_COMPARED: dict[type[ast.cmpop], str] = {
    ast.Lt: "<=",
    ast.LtE: "<",
    ast.Gt: ">=",
    ast.GtE: ">",
    ast.Eq: "!=",
    ast.NotEq: "==",
    ast.Is: "is not",
    ast.IsNot: "is",
    ast.In: "not in",
    ast.NotIn: "in",
}
_SIGNS: dict[type[ast.operator], str] = {
    ast.Add: "-",
    ast.Sub: "+",
    ast.Mult: "/",
    ast.Div: "*",
    ast.FloorDiv: "*",
    ast.Mod: "*",
    ast.Pow: "*",
}
_EXTREMES = {"min": "max", "max": "min", "any": "all", "all": "any"}
_TEXT: dict[type[ast.cmpop] | type[ast.operator] | type[ast.boolop], str] = {
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Is: "is",
    ast.IsNot: "is not",
    ast.In: "in",
    ast.NotIn: "not in",
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.FloorDiv: "//",
    ast.Mod: "%",
    ast.Pow: "**",
    ast.And: "and",
    ast.Or: "or",
}
# statements of these kinds get no faults, because not every message needs a test
_UNSEEN = (ast.Import, ast.ImportFrom, ast.Assert, ast.Raise)


@dataclass(frozen=True, order=True)
class Fault:
    """The replacement of a piece of a file, given by byte offsets."""

    path: str
    line: int
    start: int
    end: int
    kind: str
    was: str
    now: str
    lines: tuple[int, ...] = ()  # line numbers of the statement without its body, as in coverage data

    @property
    def name(self) -> str:
        """Return a name that does not change when the file is edited elsewhere."""
        return f"{self.path}: {self.kind}: {' '.join(self.was.split())} → {' '.join(self.now.split())}"

    def sown(self, text: bytes) -> bytes:
        """Return the file's text with the fault."""
        return text[: self.start] + self.now.encode() + text[self.end :]


def faults(path: Path, name: str) -> list[Fault]:
    """Return all faults in a file that still compile."""
    data = path.read_bytes()
    tree = ast.parse(data)
    found = sorted(set(_Finder(data, name).module(tree)))
    functions = _outermost(tree, data)
    return [one for one in found if one.was != one.now and _compiles(one, data, functions)]


def _last_line(statement: ast.stmt) -> int:
    """Return a statement's last line, without the statements inside it."""
    if isinstance(statement, ast.Match):
        return statement.subject.end_lineno or statement.lineno
    inside: list[ast.stmt] = getattr(statement, "body", [])
    return max(statement.lineno, inside[0].lineno - 1 if inside else statement.end_lineno or statement.lineno)


def _outermost(tree: ast.Module, data: bytes) -> list[tuple[int, int]]:
    """Return the byte offsets of the lines of each outermost function, in order."""
    lines = [0, *(at + 1 for at, byte in enumerate(data) if byte == ord("\n")), len(data)]
    found: list[tuple[int, int]] = []
    waiting: list[ast.AST] = [tree]
    while waiting:
        for node in ast.iter_child_nodes(waiting.pop()):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                first = min([node.lineno, *(one.lineno for one in node.decorator_list)])
                found.append((lines[first - 1], lines[node.end_lineno or node.lineno]))
            else:
                waiting.append(node)
    return sorted(found)


def _compiles(fault: Fault, data: bytes, functions: list[tuple[int, int]]) -> bool:
    """Return whether the fault's outermost function compiles, which is much faster than compiling the file."""
    start, end = functions[bisect_right(functions, (fault.start, len(data))) - 1]
    text = data[start : fault.start] + fault.now.encode() + data[fault.end : end]
    if text[:1].isspace():
        text = b"if True:\n" + text  # an indented method needs a block around it
    try:
        compile(text, "<mutant>", "exec", dont_inherit=True)
    except (SyntaxError, ValueError):
        return False
    return True


class _Finder:
    """Collect a module's faults in one pass."""

    def __init__(self, data: bytes, name: str) -> None:
        self._data = data
        self._name = name
        self._lines = [0]
        for line in data.split(b"\n"):
            self._lines.append(self._lines[-1] + len(line) + 1)

    def module(self, tree: ast.Module) -> Iterator[Fault]:
        """Yield the faults of all functions; code outside functions is mostly declarations."""
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and not node.name.startswith(
                "__repr"
            ):
                yield from self._block(node.body)

    def _block(self, body: list[ast.stmt]) -> Iterator[Fault]:
        for statement in body:
            if isinstance(statement, (*_UNSEEN, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
                continue
            lines = tuple(range(statement.lineno, _last_line(statement) + 1))
            for fault in self._statement(statement, alone=len(body) == 1):
                yield replace(fault, lines=lines)
            for inner in (getattr(statement, name, []) for name in ("body", "orelse", "finalbody")):
                if inner and isinstance(inner[0], ast.stmt):
                    yield from self._block(inner)
            for handler in getattr(statement, "handlers", []):
                yield from self._block(handler.body)
            for case in getattr(statement, "cases", []):
                if case.guard is not None:
                    yield from self._guard(case)
                yield from self._block(case.body)

    def _guard(self, case: ast.match_case) -> Iterator[Fault]:
        """Yield the faults in the guard of a `case` (the condition after `if`)."""
        assert case.guard is not None
        lines = tuple(range(case.pattern.lineno, (case.guard.end_lineno or case.guard.lineno) + 1))
        for fault in (
            self._turned(case.guard),
            *(one for inner in ast.walk(case.guard) for one in self._expression(inner)),
        ):
            yield replace(fault, lines=lines)

    def _statement(self, node: ast.stmt, *, alone: bool) -> Iterator[Fault]:
        called = isinstance(node, ast.Expr) and isinstance(node.value, ast.Call | ast.Await)
        stored = isinstance(node, ast.Assign | ast.AugAssign) and isinstance(
            node.targets[0] if isinstance(node, ast.Assign) else node.target, ast.Attribute | ast.Subscript
        )
        if called or stored or (isinstance(node, ast.Continue | ast.Break) and not alone):
            yield self._fault(node, "statement dropped", "pass")
        if isinstance(node, ast.If | ast.While) and not isinstance(node.test, ast.Constant):
            yield self._turned(node.test)
        if (
            isinstance(node, ast.Return)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, bool)
        ):
            yield self._fault(node.value, "answer turned", str(not node.value.value))
        if isinstance(node, ast.AugAssign) and type(node.op) in _SIGNS:
            yield from self._between(
                node.target, node.value, type(node.op), _SIGNS[type(node.op)], "arithmetic in place"
            )
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.expr | ast.withitem) and child is not getattr(node, "annotation", None):
                for inner in ast.walk(child):
                    yield from self._expression(inner)

    def _expression(self, node: ast.AST) -> Iterator[Fault]:
        if isinstance(node, ast.Compare):
            for left, compared, right in zip(
                (node.left, *node.comparators), node.ops, node.comparators, strict=False
            ):
                operator = type(compared)
                yield from self._between(left, right, operator, _COMPARED[operator], "comparison")
        elif isinstance(node, ast.BinOp) and type(node.op) in _SIGNS and not _of_texts(node):
            yield from self._between(
                node.left, node.right, type(node.op), _SIGNS[type(node.op)], "arithmetic"
            )
        elif isinstance(node, ast.BoolOp):
            other = "or" if isinstance(node.op, ast.And) else "and"
            yield from self._between(node.values[0], node.values[1], type(node.op), other, "connective")
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            yield self._fault(node, "negation dropped", self._text(node.operand))
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            yield self._fault(node, f"sign dropped in {self._line(node)}", self._text(node.operand))
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _EXTREMES:
            kind = f"extreme in {self._line(node)}"
            yield self._fault(node.func, kind, _EXTREMES[node.func.id])
        elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
            yield self._fault(node, f"truth in {self._line(node)}", repr(not node.value))
        elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            yield self._fault(node, f"number in {self._line(node)}", repr(node.value + 1))

    def _between(
        self,
        left: ast.expr,
        right: ast.expr,
        operator: type[ast.cmpop] | type[ast.operator] | type[ast.boolop],
        now: str,
        kind: str,
    ) -> Iterator[Fault]:
        """Yield the fault at the operator between two operands, keeping parentheses and line breaks."""
        start, end = self._offsets(left)[1], self._offsets(right)[0]
        gap, was = self._data[start:end].decode(), _TEXT[operator]
        if gap.count(was) == 1 and "#" not in gap:
            at = start + len(gap[: gap.index(was)].encode())
            context = f"{self._text(left)[-30:]} {was} {self._text(right)[:30]}".replace("\n", " ")
            line = self._data.count(b"\n", 0, at) + 1
            yield Fault(self._name, line, at, at + len(was), f"{kind} in {context}", was, now)

    def _turned(self, condition: ast.expr) -> Fault:
        return self._fault(condition, "condition turned", f"not ({self._text(condition)})")

    def _fault(self, node: ast.expr | ast.stmt, kind: str, now: str) -> Fault:
        start, end = self._offsets(node)
        return Fault(self._name, node.lineno, start, end, kind, self._text(node), now)

    def _offsets(self, node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return self._lines[node.lineno - 1] + node.col_offset, self._lines[
            node.end_lineno - 1
        ] + node.end_col_offset

    def _line(self, node: ast.expr) -> str:
        return self._data.split(b"\n")[node.lineno - 1].decode().strip()

    def _text(self, node: ast.expr | ast.stmt) -> str:
        start, end = self._offsets(node)
        return self._data[start:end].decode()


def _of_texts(node: ast.BinOp) -> bool:
    return any(
        isinstance(one, ast.JoinedStr) or (isinstance(one, ast.Constant) and isinstance(one.value, str))
        for one in (node.left, node.right)
    )
