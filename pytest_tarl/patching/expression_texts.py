"""Write expressions as a maintainer would, with rounded numbers and without needless parentheses."""

from __future__ import annotations

import ast

from pytest_tarl.patching.document import Document, called, parse_expression

DIGITS = 4  # significant digits of numbers in a repair

# operator precedence from loosest to tightest, as in the language reference
(
    TEST,
    OR,
    AND,
    NOT,
    COMPARISON,
    BIT_OR,
    BIT_XOR,
    BIT_AND,
    SHIFT,
    ARITHMETIC,
    TERM,
    FACTOR,
    POWER,
    AWAIT,
    ATOM,
) = range(15)

_OPERATORS: dict[type[ast.AST], int] = {
    ast.Or: OR, ast.And: AND, ast.Not: NOT, ast.BitOr: BIT_OR, ast.BitXor: BIT_XOR, ast.BitAnd: BIT_AND,
    ast.LShift: SHIFT, ast.RShift: SHIFT, ast.Add: ARITHMETIC, ast.Sub: ARITHMETIC, ast.Mult: TERM, ast.Div: TERM,
    ast.FloorDiv: TERM, ast.Mod: TERM, ast.MatMult: TERM, ast.UAdd: FACTOR, ast.USub: FACTOR, ast.Invert: FACTOR,
    ast.Pow: POWER,
}  # fmt: skip
_COUNTED_BY = {
    "range",
    "islice",
    "zeros",
    "ones",
    "empty",
    "eye",
    "chr",
    "hex",
    "bin",
    "insert",
    "pop",
    "rotate",
}
_COUNTS = {
    "queue_size",
    "maxlen",
    "maxsize",
    "depth",
    "ndigits",
    "start",
    "stop",
    "axis",
    "size",
    "shape",
    "index",
}
_INTEGRAL_OPERATORS = (ast.LShift, ast.RShift, ast.BitAnd, ast.BitOr, ast.BitXor)
_IDENTITIES = (ast.Eq, ast.NotEq, ast.In, ast.NotIn, ast.Is, ast.IsNot)


def rounded(value: float) -> float:
    """Round to `DIGITS` significant digits."""
    return float(f"{value:.{DIGITS}g}")


def number(value: float | int | bool) -> str:
    """Format a number: `12.0`, `0.75`, `3`, `True`."""
    return repr(rounded(value)) if isinstance(value, float) else repr(value)


def strength(code: str) -> int:
    """Return the precedence of an expression's outermost operator."""
    node = parse_expression(code)
    if isinstance(node, ast.BinOp | ast.UnaryOp | ast.BoolOp):
        return _OPERATORS[type(node.op)]
    if isinstance(node, ast.Compare):
        return COMPARISON
    if isinstance(node, ast.Await):
        return AWAIT
    tests = ast.IfExp | ast.Lambda | ast.NamedExpr | ast.Yield | ast.YieldFrom | ast.Starred
    return TEST if isinstance(node, tests) else ATOM


def enclosed(code: str, needed: int) -> str:
    """Return an expression, in parentheses if its precedence is below `needed`."""
    return code if strength(code) >= needed else f"({code})"


def fitted(source: Document, node: ast.expr, code: str) -> str:
    """Return the code to write in place of `node`, with parentheses if they are needed there."""
    before = source.text[: source.start(node)].rstrip(" \t")[-1:]
    after = source.text[source.end(node) :].lstrip(" \t")[:1]
    if before == "(" and after == ")":
        return code
    parent = source.parents[node]
    if isinstance(parent, ast.Attribute) and code[-1:].isdigit():
        return f"({code})"
    return enclosed(code, _needed(parent, node))


def scaled(code: str, factor: float) -> str:
    """Return `factor * code`."""
    return f"{number(factor)} * {enclosed(code, FACTOR)}"


def shifted(code: str, step: float) -> str:
    """Return `code + step`, or `code - |step|` for a negative step."""
    sign = "-" if step < 0 else "+"
    return f"{enclosed(code, ARITHMETIC)} {sign} {number(abs(step))}"


def negated(code: str) -> str:
    """Return `not code`."""
    return f"not {enclosed(code, NOT)}"


def choice(condition: str, then: str, otherwise: str) -> str:
    """Return a conditional expression."""
    return f"{enclosed(then, OR)} if {enclosed(condition, OR)} else {enclosed(otherwise, TEST)}"


def counting(source: Document, node: ast.expr) -> bool:
    """Return whether a place needs an integer: an index, a length, or a number compared for equality."""
    child: ast.AST = node
    for parent in source.ancestors(node):
        if isinstance(parent, ast.BinOp) and not isinstance(parent.op, ast.Div | ast.Pow | ast.Mod):
            if isinstance(parent.op, _INTEGRAL_OPERATORS) or _repeats(parent):
                return True
        elif not isinstance(parent, ast.UnaryOp | ast.Slice | ast.Tuple | ast.List):
            return _counts(parent, child)
        child = parent
    return False


def _repeats(operation: ast.BinOp) -> bool:
    """Return whether a product repeats a sequence."""
    sides = (operation.left, operation.right)
    texts = any(isinstance(side, ast.Constant) and isinstance(side.value, str | bytes) for side in sides)
    return isinstance(operation.op, ast.Mult) and (
        texts or any(isinstance(side, ast.List | ast.Tuple) for side in sides)
    )


def _counts(parent: ast.AST, child: ast.AST) -> bool:
    if isinstance(parent, ast.Subscript):
        return child is parent.slice
    if isinstance(parent, ast.Call):
        return _is_integer_vector(child) or called(parent) in _COUNTED_BY
    if isinstance(parent, ast.keyword):
        return parent.arg in _COUNTS
    return isinstance(parent, ast.Compare) and any(isinstance(op, _IDENTITIES) for op in parent.ops)


def _is_integer_vector(node: ast.AST) -> bool:
    """Return whether a node is a literal list of two or more integers, such as a colour, pixel or shape."""
    elements = node.elts if isinstance(node, ast.List | ast.Tuple) else []
    numbers = [each.operand if isinstance(each, ast.UnaryOp) else each for each in elements]
    return len(numbers) > 1 and all(
        isinstance(each, ast.Constant) and type(each.value) is int for each in numbers
    )


def _needed(parent: ast.AST, child: ast.expr) -> int:
    """Return the lowest precedence that `child` may have under `parent` without parentheses."""
    if isinstance(parent, ast.BinOp):
        return _beside(parent, child)
    if isinstance(parent, ast.UnaryOp):
        return _OPERATORS[type(parent.op)]
    if isinstance(parent, ast.BoolOp):
        return _OPERATORS[type(parent.op)] + 1
    if isinstance(parent, ast.Compare | ast.Starred):
        return BIT_OR
    if isinstance(parent, ast.IfExp):
        return TEST if child is parent.orelse else OR
    if isinstance(parent, ast.comprehension):
        return OR
    if isinstance(parent, ast.Dict):
        unpacked = any(
            key is None and value is child for key, value in zip(parent.keys, parent.values, strict=True)
        )
        return BIT_OR if unpacked else TEST
    if isinstance(parent, ast.Call):
        return ATOM if child is parent.func else TEST
    if isinstance(parent, ast.Subscript):
        return ATOM if child is parent.value else TEST
    tight = ast.Attribute | ast.Await | ast.FormattedValue | ast.MatchValue
    return ATOM if isinstance(parent, tight) else TEST


def _beside(operation: ast.BinOp, child: ast.expr) -> int:
    level = _OPERATORS[type(operation.op)]
    if isinstance(operation.op, ast.Pow):
        return AWAIT if child is operation.left else FACTOR
    return level if child is operation.left else level + 1
