"""Special methods of analysed classes, for operators, subscripts and built-in functions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, namespaces
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import BOTTOM, UNKNOWN, Obj, Value, join

METHOD_OF: Final[Mapping[str, str]] = {
    "+": "add", "-": "sub", "*": "mul", "/": "truediv", "//": "floordiv", "%": "mod", "**": "pow", "@": "matmul",
    "&": "and", "|": "or", "^": "xor", "<<": "lshift", ">>": "rshift", "neg": "neg", "pos": "pos",
    "invert": "invert", "==": "eq", "!=": "ne", "<": "lt", "<=": "le", ">": "gt", ">=": "ge", "in": "contains",
    "not in": "contains",
}  # fmt: skip
TEXTS: Final = ("__format__", "__str__", "__repr__")
FUNCTIONS: Final = frozenset(
    ["abs", "bool", "float", "int", "len", "next", "reversed", "round", "str", "format", "bytes", "hash"]
)  # built-in functions that call the special method of the same name


def special(
    ctx: Interpreter, value: Value, name: str, given: Sequence[Value], frame: Frame, pos: ir.Pos
) -> Value | None:
    """Return the result of a special method; None if one of the value's possible objects lacks it."""
    methods: list[Value] = []
    for obj in value.objects:
        method = _special_method(ctx, obj, name) if obj.kind == "instance" else None
        if method is None:
            return None
        methods.append(method)
    result = BOTTOM
    for method in methods:
        result = join(result, method)
    if not methods:
        return None
    call = ir.Call(ir.Const(None, pos), (), (), pos, slot(name, pos))
    made = ctx.ops.call_value(ctx, result, (list(given), {}), frame, call)
    return Value(made.deps | value.deps, made.pts, made.consts)


def _special_method(ctx: Interpreter, obj: Obj, name: str) -> Value | None:
    method = heap.through_class(ctx, obj, obj.info, name) if isinstance(obj.info, Obj) else None
    return method if method is not None and method.pts else None


def operated(ctx: Interpreter, expr: ir.Operation, values: Sequence[Value], frame: Frame) -> Value | None:
    """Return the result of an operator that an operand's class overloads, else None."""
    if len(values) > 2 or not any(o.kind == "instance" for v in values for o in v.pts):
        return None
    operator = expr.operator
    name = METHOD_OF.get(operator.removesuffix("=") if operator not in METHOD_OF else operator)
    if name is None:
        return None
    first, rest = values[0], list(values[1:])
    if name == "contains":
        said = special(ctx, rest[0], "__contains__", [first], frame, expr.pos)
        return namespaces.contains(ctx, rest[0], first, frame, expr.pos) if said is None else said
    made = None
    if operator not in METHOD_OF:
        made = special(ctx, first, f"__i{name}__", rest, frame, expr.pos)
    if made is None:
        made = special(ctx, first, f"__{name}__", rest, frame, expr.pos)
    if made is None and rest:
        made = special(ctx, rest[0], f"__r{name}__", [first], frame, expr.pos)
    return made


def as_text(ctx: Interpreter, value: Value, frame: Frame, pos: ir.Pos) -> Value:
    """Return the text of a value in an f-string, by its analysed class's method if there is one."""
    if not any(o.kind == "instance" for o in value.pts):
        return value
    for name in TEXTS:
        said = special(ctx, value, name, [UNKNOWN] if name == TEXTS[0] else [], frame, pos)
        if said is not None:
            return said
    return value


def slot(name: str, pos: ir.Pos) -> int:
    """Return a slot number for the call made by an operator, distinct from the slots of explicit calls."""
    return -(1_000_000 + pos[0] * 100_000 + pos[1] * 100 + len(name))
