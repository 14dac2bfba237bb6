"""Transfer functions of statements."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from tarl_lint import catalog
from tarl_lint.interpret import (
    branches,
    calls,
    definitions,
    descriptors,
    dunder_methods,
    exceptions,
    expressions,
    literals,
    nullness,
    operators,
    tags,
    try_statements,
)
from tarl_lint.interpret.budget import READS_PER_STATEMENT
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.interpret.nullness import RETURNED
from tarl_lint.interpret.run_order import Part
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.exception_types import raised
from tarl_lint.ir.lower_statements import lower_body
from tarl_lint.memory import heap, updates
from tarl_lint.memory.frames import Escape, Frame
from tarl_lint.memory.values import BOTTOM, UNKNOWN, Value, const, join
from tarl_lint.models import removal, unpacking
from tarl_lint.models.ros import publications
from tarl_lint.models.ros.endpoints import Acceptance, Publisher


def run(ctx: Interpreter, frame: Frame) -> Value:
    """Execute a frame's body and return its result.

    A generator or coroutine that never ends leaves the stores that it had made when it paused.
    """
    frame.returns, frame.pauses = [], {}
    depth = len(ctx.store.layers) - 1
    if block(ctx, lower_body(frame.function, frame.program.package), frame):
        frame.returns.append((ctx.store.since(depth), const(None)))
    elif not frame.returns:
        frame.returns = [(state, BOTTOM) for state in frame.pauses.values()]
    result = BOTTOM
    for _, value in frame.returns:
        result = join(result, value)
    frame.result = join(frame.result, result)
    return result


def block(ctx: Interpreter, body: Sequence[ir.Stmt], frame: Frame) -> bool:
    """Execute statements in order."""
    for statement in body:
        frame.statement = statement
        ctx.work.spent += 1
        if ctx.graph.asked > READS_PER_STATEMENT:
            ctx.count()
        if ctx.watch is not None:
            ctx.watch(frame, statement)
        if not EXECUTE[type(statement)](ctx, statement, frame):
            return False
    return True


# --- simple statements --------------------------------------------------------------------------------


def _assignment(ctx: Interpreter, s: ir.Assign, frame: Frame) -> bool:
    value = expressions.evaluate(ctx, s.value, frame)
    frame.statement = s
    for number, target in enumerate(s.targets):
        bind_target(ctx, target, value, frame, str(number), s.value)
    return True


def bind_target(
    ctx: Interpreter, target: ir.Expr, value: Value, frame: Frame, slot: str, source: ir.Expr
) -> None:
    """Bind a target to a value through a node of the statement, element by element."""
    if isinstance(target, ir.SequenceDisplay):
        unpack(ctx, target, value, frame, slot, source)
        return
    if isinstance(target, ir.Starred):
        target = target.value
    nullness.note_absence(ctx, target, source, value, frame)
    node = ctx.node(frame, ("target", slot), "assign")
    literals.mark(ctx, node, source, value, frame)
    assign(ctx, target, ctx.carry(value, node), frame)
    tags.note(ctx, target, source, value, slot, frame)


def unpack(
    ctx: Interpreter, target: ir.SequenceDisplay, value: Value, frame: Frame, slot: str, source: ir.Expr
) -> None:
    """Unpack a value into several targets."""
    starred = next((n for n, t in enumerate(target.items) if isinstance(t, ir.Starred)), None)
    parts = unpacking.parts(ctx, value, len(target.items), starred, frame, slot)
    for number, (item, part) in enumerate(zip(target.items, parts, strict=True)):
        expr = source
        if isinstance(source, ir.SequenceDisplay) and number < len(source.items) and starred is None:
            expr = source.items[number]
        bind_target(ctx, item, part, frame, f"{slot}.{number}", expr)
        if starred is None or number < starred:
            nullness.note_taken(ctx, item, value, number, part, frame)
        place = unpacking.place(number, len(target.items), starred)
        tags.note_element(ctx, item, value, place, f"{slot}.{number}", frame)


def assign(ctx: Interpreter, target: ir.Expr, value: Value, frame: Frame) -> None:
    """Store into a target."""
    if isinstance(target, ir.Name):
        ctx.store.put((expressions.holder(target, frame), target.name), value)
    elif isinstance(target, ir.Attribute):
        base = expressions.evaluate(ctx, target.base, frame)
        if not base.pts:
            assign_fallback(ctx, target.base, value, frame)
        elif not descriptors.write(ctx, base, target.name, value, frame, target.pos):
            updates.write_field(
                ctx, base, target.name, operators.into_chosen(ctx, base, value, target.pos, frame)
            )
    elif isinstance(target, ir.Item):
        _assign_item(ctx, target, value, frame)
    elif isinstance(target, ir.SequenceDisplay):
        starred = next((n for n, t in enumerate(target.items) if isinstance(t, ir.Starred)), None)
        parts = unpacking.parts(ctx, value, len(target.items), starred, frame, str(target.pos))
        for number, item in enumerate(target.items):
            assign(ctx, item, parts[number], frame)
            place = unpacking.place(number, len(target.items), starred)
            tags.note_element(ctx, item, value, place, f"{target.pos}.{number}", frame)
    elif isinstance(target, ir.Starred):
        assign(ctx, target.value, value, frame)


def _assign_item(ctx: Interpreter, target: ir.Item, value: Value, frame: Frame) -> None:
    base, index = (
        expressions.evaluate(ctx, target.base, frame),
        expressions.evaluate(ctx, target.index, frame),
    )
    if dunder_methods.special(ctx, base, "__setitem__", [index, value], frame, target.pos) is not None:
        return
    if (index.deps or index.pts) and any(o.kind == "mapping" for o in base.pts):
        index = ctx.carry(index, ctx.node(frame, ("key", target.pos), "assign"))
    if isinstance(target.index, ir.Slice):
        remove(ctx, base, target.index, frame)
        value = heap.elements(ctx, value)
    if where := ctx.use(index):
        chosen = Value(value.deps | where, value.pts)
        value = ctx.carry(chosen, ctx.node(frame, ("at", target.pos), "assign"))
    if (whole := _indexed(ctx, target.base, frame)) is not None:
        updates.add_element(ctx, whole, Value(ctx.use(value)))  # the table gets a copy
    elif base.pts:
        updates.write_item(ctx, base, index, operators.into_chosen(ctx, base, value, target.pos, frame))
    else:
        assign_fallback(ctx, target.base, value, frame)


def _indexed(ctx: Interpreter, expr: ir.Expr, frame: Frame) -> Value | None:
    """Return the table or array of a library that an indexer such as `table.loc` accesses; None for other objects."""
    if not isinstance(expr, ir.Attribute) or expr.name not in catalog.INDEXERS:
        return None
    owner = expressions.evaluate(ctx, expr.base, frame)
    return owner if owner.pts and all(o.kind == "lib" for o in owner.pts) else None


def assign_fallback(ctx: Interpreter, expr: ir.Expr, value: Value, frame: Frame) -> None:
    """Add data to the variable that holds an unknown object."""
    if ctx.nothing_yet(expressions.evaluate(ctx, expr, frame)):
        return
    while isinstance(expr, (ir.Item, ir.Attribute)):
        if isinstance(expr, ir.Attribute) and expressions.evaluate(ctx, expr.base, frame).pts:
            break
        expr = expr.base
    if isinstance(expr, (ir.Name, ir.Attribute)):
        before = expressions.evaluate(ctx, expr, frame)
        assign(ctx, expr, Value(before.deps | ctx.use(value), before.pts), frame)


def _expression(ctx: Interpreter, s: ir.Evaluate, frame: Frame) -> bool:
    expressions.evaluate(ctx, s.value, frame)
    return True


def _returned(ctx: Interpreter, s: ir.Return, frame: Frame) -> bool:
    value = expressions.evaluate(ctx, s.value, frame) if s.value is not None else const(None)
    frame.statement = s
    if s.value is not None:
        node = ctx.node(frame, ("return",), "return")
        literals.mark(ctx, node, s.value, value, frame)
        nullness.note_passed(ctx, (frame, RETURNED), s.value, value, frame)
        value = ctx.carry(value, node)
        if isinstance(frame.answer, Publisher):
            publications.send(
                ctx, Invocation("response", BOTTOM, ([value], {}), frame, _answer(s)), frame.answer
            )
        elif isinstance(frame.answer, Acceptance):
            it = Invocation("goal", BOTTOM, ([], {}), frame, _answer(s))
            publications.accept(ctx, it, value, frame.answer)
        elif isinstance(frame.answer, Part):
            publications.end(
                ctx, Invocation("outcome", BOTTOM, ([], {}), frame, _answer(s)), value, frame.answer
            )
    try_statements.returned(ctx, value, frame)
    return False


def _raised(ctx: Interpreter, s: ir.Raise, frame: Frame) -> bool:
    value = UNKNOWN
    if s.value is not None:
        value = expressions.evaluate(ctx, s.value, frame)
        frame.statement = s
        if any(o.kind == "class" for o in value.pts):
            value = calls.call_value(ctx, value, ([], {}), frame, ir.Call(s.value, (), (), s.pos, -1))
        value = ctx.carry(value, ctx.node(frame, ("raise", s.pos), "call"))
    elif frame.handling:
        for name, one in frame.handling[-1].items():
            exceptions.leave(ctx, Escape(frame, s, name, one), frame)
    exceptions.leave(ctx, Escape(frame, s, raised(s.value), value), frame)
    return False


def _jump(ctx: Interpreter, s: ir.Jump, frame: Frame) -> bool:
    try_statements.jumped(ctx, s.kind, frame)
    return False


def _delete(ctx: Interpreter, s: ir.Delete, frame: Frame) -> bool:
    for target in s.targets:
        if isinstance(target, ir.Name):
            ctx.store.put((expressions.holder(target, frame), target.name), UNKNOWN)
        elif isinstance(target, ir.Attribute):
            base = expressions.evaluate(ctx, target.base, frame)
            removal.attribute(
                ctx, base, target.name, removal.decision(ctx, frame, target.pos, base=base.deps)
            )
        elif isinstance(target, ir.Item):
            remove(ctx, expressions.evaluate(ctx, target.base, frame), target.index, frame)
    return True


def remove(ctx: Interpreter, base: Value, index: ir.Expr, frame: Frame) -> None:
    """Remove an element of a container, or the elements that a slice selects."""
    key = expressions.evaluate(ctx, index, frame)
    if dunder_methods.special(ctx, base, "__delitem__", [key], frame, index.pos) is not None:
        return
    single = not isinstance(index, ir.Slice)
    decided = removal.decision(ctx, frame, index.pos, ctx.use(key), base=base.deps, finds=single)
    if not isinstance(index, ir.Slice):
        removal.take(ctx, base, key, decided)
    elif not index.parts:
        removal.empty(ctx, base, decided)
    else:
        for obj in base.objects:
            if obj.kind == "sequence":
                removal.scatter(ctx, obj, decided)


def _answer(s: ir.Return) -> ir.Call:
    """Return a call that represents the code of ROS that sends the result of a handler."""
    return ir.Call(ir.Const(None, s.pos), (), (), s.pos, 0)


EXECUTE: Mapping[type, Callable[..., bool]] = {
    ir.Assign: _assignment,
    ir.Evaluate: _expression,
    ir.If: branches.if_statement,
    ir.Loop: branches.loop,
    ir.Try: try_statements.try_statement,
    ir.With: branches.with_statement,
    ir.Return: _returned,
    ir.Raise: _raised,
    ir.Jump: _jump,
    ir.Define: definitions.define,
    ir.Class: definitions.define_class,
    ir.Import: definitions.import_names,
    ir.Delete: _delete,
}
