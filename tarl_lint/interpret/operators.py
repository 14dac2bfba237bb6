"""Transfer functions of operators: dependencies, and constant folding."""

from __future__ import annotations

import itertools
import math
import operator
from collections.abc import Callable, Hashable, Mapping

from tarl_lint.interpret import class_patterns, dunder_methods, nullness
from tarl_lint.interpret.interpreter import NONE_ONLY, Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import enumerations, heap, object_contents
from tarl_lint.memory.frames import Former, Frame
from tarl_lint.memory.values import (
    BOTTOM,
    BY_CLASS,
    MAX_CONSTS,
    MAX_TEXTS,
    NO_CONSTANTS,
    NONE,
    Nodes,
    Obj,
    Symbolic,
    Value,
    in_order,
    join,
    lineage,
)
from tarl_lint.models import arrays, sizes
from tarl_lint.models.sizes import COMBINING

FOLDED: Mapping[str, Callable[..., object]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "%": operator.mod,
    "neg": operator.neg,
    "not": operator.not_,
    "==": operator.eq,
    "!=": operator.ne,
    "is": lambda a, b: a is b or a == b,
    "is not": lambda a, b: not (a is b or a == b),
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "formatted": lambda value, spec: format(value, spec),
    "in": lambda part, text: part in text,
    "not in": lambda part, text: part not in text,
}
MEMBER = frozenset(["in", "not in"])
PRESENT = frozenset(["is", "is not", "==", "!="])  # operators that can test for None
CALLING = (
    ir.Call,
    ir.Choice,
    ir.Operation,
)  # kinds of operands that may contain calls; whether these calls run depends on the earlier operands
OURS = frozenset(
    ["instance", "sequence", "mapping"]
)  # kinds of objects whose type is known from the code and does not depend on data
MESSAGES = frozenset(["message", "goal"])
THERE = frozenset([*MESSAGES, *OURS])  # kinds of objects that are never None
SCALARS = frozenset(["str", "int", "float", "bool", "bytes"])
MAX_TEXT = 300
FALSE = frozenset([False, None, ""])  # possible values of `a and False` if `a` is unknown and not a container


def operation(ctx: Interpreter, expr: ir.Operation, frame: Frame) -> Value:
    """Return the result of an operator."""
    if expr.operator in ("or", "and"):
        return boolean(ctx, expr, frame)
    values = [ctx.ops.evaluate(ctx, p, frame) for p in expr.parts]
    if expr.operator == "as":
        return narrowed(*values)
    if expr.operator == "part":
        number = values[2].constant()[1]
        return class_patterns.part(ctx, values[0], values[1], number if isinstance(number, int) else 0)
    if expr.operator in ("text", "formatted"):
        values = [
            dunder_methods.as_text(ctx, value, frame, part.pos)
            for value, part in zip(values, expr.parts, strict=True)
        ]
    said = dunder_methods.operated(ctx, expr, values, frame)
    if said is not None:
        return said
    if expr.operator in ("+=", "|=") and values[0].pts:
        return sizes.grown(ctx, expr, values, frame)
    if expr.operator in COMBINING and any(v.pts for v in values):
        made = sizes.combined(ctx, expr, values, frame)
        if made is not None:
            return made
    arrivals = ctx.config.arrivals
    if (
        expr.operator in PRESENT
        and not arrivals
        and (decides := nullness.only_presence(ctx, expr, frame)) is not None
    ):
        there = ctx.node(frame, ("there", expr.pos), "condition")
        ctx.graph.choice(values[0].deps, there)
        ctx.graph.flow(decides, there)
        return Value(ctx.kept(there), consts=fold(ctx, expr.operator, values))
    deps, name = NONE, _asked(expr)
    for number, value in enumerate(values):
        deps |= tested(ctx, name, value, frame, (expr.pos, number))
    if (array := arrays.computed(ctx, expr, values, deps, frame)) is not None:
        return array
    return Value(deps, consts=fold(ctx, expr.operator, values))


def narrowed(value: Value, classes: Value) -> Value:
    """Remove from a value the objects that cannot be instances of the classes in a pattern."""
    if not classes.pts or any(c.kind not in ("class", "ext") for c in classes.pts):
        return value
    scalar = all(c.name.removeprefix("builtins.") in SCALARS for c in classes.pts)
    ours = frozenset(c for c in classes.pts if c.kind == "class")
    exact = scalar or len(ours) == len(classes.pts)
    kept = frozenset(o for o in value.pts if _may_be(o, ours, exact=exact))
    return Value(value.deps, kept, value.consts)


def _may_be(obj: Obj, classes: frozenset[Obj], *, exact: bool) -> bool:
    """Return whether an object may be an instance of one of the classes.

    `exact` means that the analysis knows all classes, except those of numbers and strings.
    """
    if obj.kind == "instance" and isinstance(obj.info, Obj):
        return not exact or not classes.isdisjoint(lineage(obj.info))
    return not exact or obj.kind not in OURS


def tested(ctx: Interpreter, name: str, value: Value, frame: Frame, slot: tuple[ir.Pos, int]) -> Nodes:
    """Return the nodes whose data an operator uses. Whether a message has arrived is not data."""
    if name == "shape":
        return sizes.length(ctx, value)
    if name == "type":
        return ctx.use(Value(value.deps, frozenset(o for o in value.pts if o.kind not in OURS)))
    if name == "none in":
        parts = sizes.unpacked(ctx, value) or [heap.elements(ctx, value)]
        return frozenset().union(*(tested(ctx, "is none", p, frame, slot) for p in parts))
    if name in MEMBER and slot[1] == 1:
        return membership(ctx, value, frame, slot)
    if name in ("is", "is none") and not ctx.config.arrivals:
        hollow = _there if name == "is none" else _whole
        return ctx.use(Value(value.deps, frozenset(o for o in value.pts if not hollow(o))))
    return truth(ctx, value, frame, slot) if name == "not" else ctx.use(value)


def membership(ctx: Interpreter, value: Value, frame: Frame, slot: Hashable) -> Nodes:
    """Return the nodes that decide membership in a container; for a mapping, the nodes of its keys."""
    mappings = frozenset(o for o in value.pts if o.kind == "mapping")
    deps = ctx.use(Value(value.deps, value.pts - mappings))
    for obj in in_order(mappings):
        deps |= heap.keys(ctx, obj, value.deps).deps
    return deps | chosen(ctx, mappings, frame, ("member", slot), counted=False) if mappings else deps


def chosen(
    ctx: Interpreter, objects: frozenset[Obj], frame: Frame, slot: Hashable, *, counted: bool = True
) -> Nodes:
    """Return a node of the decisions to add container elements, without the elements' data.

    With `counted`, only the number of elements matters.
    """
    node = ctx.node(frame, slot, "condition")
    ctx.graph.choice(sizes.placed(ctx, objects), node, counted=counted)
    return ctx.kept(node)


def truth(ctx: Interpreter, value: Value, frame: Frame, slot: Hashable) -> Nodes:
    """Return the nodes that decide whether a value counts as true.

    A message is always true, even as a field of another message; so is an object without `__bool__` and `__len__`.
    The truth of a container depends on its length.
    """
    if not value.pts:
        return value.deps
    said = dunder_methods.special(ctx, value, "__bool__", (), frame, frame.function.pos)
    if said is not None:
        return ctx.use(said)
    ours = frozenset(o for o in value.pts if sizes.sized(ctx, o))
    arrivals = ctx.config.arrivals
    kept = frozenset(o for o in value.pts - ours if arrivals or not _always_true(ctx, o))
    deps = ctx.use(Value(value.deps, kept)) | sizes.length(ctx, Value(pts=ours))
    if ours:
        deps |= chosen(ctx, ours, frame, ("truth", slot))
    return deps


def _always_true(ctx: Interpreter, obj: Obj) -> bool:
    if obj.kind == "instance":
        return not any(heap.read_field(ctx, obj, name).pts for name in ("__bool__", "__len__"))
    if obj.kind in MESSAGES:
        return obj.parent is None or object_contents.defined(ctx, obj) != ""
    return obj.info is BY_CLASS


def boolean(ctx: Interpreter, expr: ir.Operation, frame: Frame) -> Value:
    """Return the value of `a or b`.

    The first operand decides which operand is the result. Calls in the second operand depend on this decision.
    """
    result, deps, guards, decided = BOTTOM, NONE, len(ctx.guards), False
    former: Former = []
    for number, part in enumerate(expr.parts):
        value = ctx.ops.evaluate(ctx, part, frame)
        last = number + 1 == len(expr.parts)
        known, constant = value.constant()
        decided = known and bool(constant) is (expr.operator == "or")
        decides = truth(ctx, value, frame, (expr.pos, number))
        deps |= decides
        if last or decided or not known:
            result = join(result, value)
        if decided:
            break
        if not last and not known:
            if isinstance(expr.parts[number + 1], CALLING):
                ctx.guards.append((guard(ctx, decides, frame, (expr.pos, number)), "rest"))
            former += ctx.ops.narrow_part(ctx, part, frame, holds=expr.operator == "and")
    ctx.ops.widen(ctx, former)
    del ctx.guards[guards:]
    false = decided and expr.operator == "and" and result.consts is None and not result.pts
    return Value(result.deps | deps, result.pts, FALSE if false else result.consts)


def guard(ctx: Interpreter, decides: Nodes, frame: Frame, slot: Hashable) -> int:
    """Return the node of a decision inside an expression."""
    node = ctx.node(frame, ("guard", slot), "condition")
    ctx.graph.flow(decides, node)
    return node


def into_chosen(ctx: Interpreter, base: Value, value: Value, slot: Hashable, frame: Frame) -> Value:
    """Return a value as it is stored into one of several objects; what chooses the object decides their content."""
    if len(base.pts) == 1 or not base.deps:
        return value
    node = ctx.node(frame, ("into", slot), "assign")
    ctx.graph.depend(node, (guard(ctx, base.deps, frame, ("into", slot)),))
    return ctx.carry(value, node)


def fold(ctx: Interpreter, name: str, values: list[Value]) -> frozenset[object] | None:
    """Fold an operator over constants."""
    if name == "text":
        return _fold_text(values)
    if name == "%" and len(values) == 2 and values[1].pts:
        return ctx.ops.remainder(ctx, values)
    if name in MEMBER and ctx.exact and (several := sizes.constants(ctx, values[1])) is not None:
        found, constant = values[0].constant()
        there = constant in [one.constant()[1] for one in several]
        return frozenset([there is (name == "in")]) if found else None
    function = FOLDED.get(name)
    if name in PRESENT and _certainly_set(values):
        return frozenset([name in ("is not", "!=")])
    if name in PRESENT and (same := _same_member(values)) is not None:
        return frozenset([same is (name in ("is", "=="))])
    if function is None or any(v.pts for v in values):
        return None if any(v.pts or v.consts is None for v in values) or function is None else frozenset()
    if not all(v.consts for v in values):
        return None
    known = [sorted(v.consts, key=str) for v in values if v.consts]
    if math.prod(map(len, known)) > MAX_TEXTS:
        return None
    try:
        results = frozenset(function(*constants) for constants in itertools.product(*known))
    except Exception:  # the analysed program would raise this error when it runs
        return None
    if len(results) > MAX_CONSTS and not all(isinstance(r, str) for r in results):
        return None
    if any(v.keys() is None for v in values):
        return _symbolic(results)
    return None if any(isinstance(r, (str, bytes)) and len(r) > MAX_TEXT for r in results) else results


def _certainly_set(values: list[Value]) -> bool:
    """Return whether the operation compares its first value with None, and this value is certainly an instance."""
    first, second = values
    none = second.consts == NONE_ONLY and not second.pts
    return (
        none
        and first.consts == NO_CONSTANTS
        and bool(first.pts)
        and all(o.kind == "instance" for o in first.pts)
    )


def _same_member(values: list[Value]) -> bool | None:
    """Return whether two members of enumerations are the same one; None if that is not known."""
    if not all(
        v.pts and v.consts == NO_CONSTANTS and all(map(enumerations.is_member, v.pts)) for v in values
    ):
        return None
    first, second = (v.pts for v in values)
    return False if first.isdisjoint(second) else True if len(first | second) == 1 else None


def _fold_text(values: list[Value]) -> frozenset[object] | None:
    texts = [""]
    for value in values:
        if not value.consts or value.pts:
            return None
        texts = [t + str(c) for t in texts for c in sorted(value.consts, key=str)]
        if len(texts) > MAX_TEXTS or len(texts[0]) > MAX_TEXT:
            return None
    return frozenset(texts) if all(v.keys() is not None for v in values) else _symbolic(frozenset(texts))


def _symbolic(results: frozenset[object]) -> frozenset[object] | None:
    """Mark an operator's results on strings of the launch; None if a result is no string."""
    if not all(isinstance(one, str) for one in results):
        return None
    return frozenset(Symbolic(one) for one in results)


def _asked(expr: ir.Operation) -> str:
    """Return an operator's name; for `is` and `in`, distinguish tests for None."""
    first = expr.parts[0]
    if expr.operator in MEMBER and isinstance(first, ir.Const) and first.value is None:
        return "none in"
    if expr.operator not in ("is", "is not"):
        return expr.operator
    return "is none" if any(isinstance(p, ir.Const) and p.value is None for p in expr.parts) else "is"


def _whole(obj: Obj) -> bool:
    """Return whether an object is part of no other object, so that its identity reveals no data of another object."""
    return _there(obj) and obj.parent is None


def _there(obj: Obj) -> bool:
    """Return whether an object is never None, such as an instance of a class."""
    return obj.kind in THERE or obj.info is BY_CLASS
