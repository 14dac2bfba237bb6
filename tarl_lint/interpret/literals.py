"""Transfer functions of list, tuple, set and dict literals and of comprehensions."""

from __future__ import annotations

from tarl_lint.interpret import fallbacks, nullness
from tarl_lint.interpret.budget import MAX_ROWS
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.constant_expressions import computed
from tarl_lint.memory import heap, recency, updates
from tarl_lint.memory.frames import Former, Frame
from tarl_lint.memory.heap import LENGTH, item_field
from tarl_lint.memory.shared import BORN
from tarl_lint.memory.store import AGING
from tarl_lint.memory.values import NONE, Nodes, Value, certain_pointer, pointer
from tarl_lint.models import rows, sizes

MAX_EACH = 4  # maximum number of known elements over which a comprehension is unrolled
# value of MAX_EACH in a thorough analysis; large enough for a list of all parameters of a node
MAX_ENTRIES = 32

READING = frozenset(["get", "getattr", "get_param"])  # calls that return a stored value unchanged


def sequence_display(ctx: Interpreter, expr: ir.SequenceDisplay, frame: Frame) -> Value:
    """Return the value of a list, tuple or set literal; an empty one has no constants.

    Joining an empty literal with an unknown value gives unknown constants, so that a loop over the result is not
    skipped.
    """
    obj = recency.allocate(ctx, "sequence", frame, ("display", expr.slot))
    if not expr.items:
        return certain_pointer(obj)
    items = [
        (i, ctx.ops.evaluate(ctx, i.value if isinstance(i, ir.Starred) else i, frame)) for i in expr.items
    ]
    where = certain_pointer(obj)
    exact, count = True, 0
    for number, (item, value) in enumerate(items):
        value = entry(ctx, item, value, frame, (expr.slot, number))
        nullness.note_passed(ctx, (obj, item_field(number)), item, value, frame)
        given = [value]
        if isinstance(item, ir.Starred):
            sizes.lengthen(ctx, obj, value)
            known = sizes.unpacked(ctx, value)
            if known is None or count + len(known) > sizes.MAX_KNOWN:
                exact, given = False, [heap.elements(ctx, value)]
            else:
                given = known
        for one in given:
            if exact:
                ctx.store.put((obj, item_field(count)), one)
            else:
                updates.add_element(ctx, where, one)
            count += 1
    return where


def mapping_display(ctx: Interpreter, expr: ir.MappingDisplay, frame: Frame) -> Value:
    """Return the value of a dict literal."""
    obj = recency.allocate(ctx, "mapping", frame, ("display", expr.slot))
    where = pointer(obj)
    for key, item in expr.items:
        value = entry(ctx, item, ctx.ops.evaluate(ctx, item, frame), frame, (expr.slot, item.pos))
        if key is None:
            sizes.absorb(ctx, obj, value)
        else:
            updates.write_item(ctx, where, ctx.ops.evaluate(ctx, key, frame), value)
    return where


def entry(ctx: Interpreter, expr: ir.Expr, value: Value, frame: Frame, slot: object) -> Value:
    """Return an element of a literal; a number gets its own node, so that queries find it."""
    if not isinstance(expr, ir.Const) or not isinstance(expr.value, (int, float)):
        return value
    node = ctx.node(frame, ("entry", slot), "assign")
    mark(ctx, node, expr, value, frame)
    return ctx.carry(value, node)


def comprehension(ctx: Interpreter, expr: ir.Comprehension, frame: Frame) -> Value:
    """Return the container that a comprehension makes."""
    kind = "mapping" if expr.key is not None else "sequence"
    single = len(expr.loops) == 1
    registers = single and ctx.registrations.inside(expr, (expr.node,))
    first = sizes.counted(ctx, expr.loops[0][1], frame, each=registers)
    if single and not registers:
        calls = ctx.registrations.calls_element(expr, expr.loops[0][0], (expr.node,))
        registers = calls and rows.hold_classes(ctx, first)
    known = sizes.unpacked(ctx, first)
    limit = MAX_ENTRIES if ctx.thorough else MAX_ROWS if registers else MAX_EACH
    if single and not expr.loops[0][2] and known and len(known) <= limit:
        return _one_by_one_of(ctx, expr, known, frame)
    if single and known and any(o.name == heap.MEMBERS for o in first.pts):
        return _one_by_one_of(ctx, expr, known, frame, heap.MEMBERS)
    if registers and (different := rows.of(ctx, first)):
        return _of_rows(ctx, expr, different, sizes.length(ctx, first), frame)
    if single and expr.key is None and ctx.exact and known and (chosen := _selected(ctx, expr, known, frame)):
        return _one_by_one_of(ctx, expr, chosen, frame)
    obj = recency.allocate(ctx, kind, frame, ("display", expr.slot))
    deps, lengths = NONE, NONE
    former: Former = []
    for number, (target, source, conditions) in enumerate(expr.loops):
        several = ctx.ops.evaluate(ctx, source, frame) if number else first
        lengths |= sizes.length(ctx, several)
        ctx.ops.assign(ctx, target, heap.elements(ctx, several), frame)
        for condition in conditions:
            deps |= ctx.use(ctx.ops.evaluate(ctx, condition, frame))
            former += ctx.ops.narrow_part(ctx, condition, frame, holds=True)
    element = ctx.ops.evaluate(ctx, expr.element, frame)
    gate = ctx.ops.gate(ctx, deps, frame, expr.slot)
    element = Value(element.deps | gate, element.pts, element.consts)
    ctx.store.put((obj, LENGTH), Value(lengths | gate))
    if expr.key is not None:
        updates.write_item(ctx, pointer(obj), ctx.ops.evaluate(ctx, expr.key, frame), element)
    else:
        updates.add_element(ctx, pointer(obj), element)
        if not ctx.repeating and _makes_objects(ctx, element):
            # only the outermost of nested comprehensions repeats: otherwise each level would double the time
            ctx.repeating = True
            # the second evaluation tells the analysis that this code makes several objects
            again = ctx.ops.evaluate(ctx, expr.element, frame)
            ctx.repeating = False
            updates.add_element(ctx, pointer(obj), Value(again.deps | gate, again.pts, again.consts))
    ctx.ops.widen(ctx, former)
    return pointer(obj)


def _makes_objects(ctx: Interpreter, value: Value) -> bool:
    """Return whether a value may be an object that the current function has made."""
    made = ctx.store.layers[-1]
    return any(o.kind in AGING and o.kind != "lib" and (o, BORN) in made for o in value.pts)


def _one_by_one_of(
    ctx: Interpreter, expr: ir.Comprehension, known: list[Value], frame: Frame, name: str = ""
) -> Value:
    """Unroll a comprehension over few known elements; return the sequence or mapping that it makes.

    `name` is the name of the sequence. An element stays in the sequence if none of the conditions is certainly
    false.
    """
    kind = "mapping" if expr.key is not None else "sequence"
    obj = recency.allocate(ctx, kind, frame, ("display", expr.slot))
    obj.name = name or obj.name
    turn, (target, _, conditions) = frame.turn, expr.loops[0]
    length, count = NONE, 0
    for number, value in enumerate(known):
        frame.turn = (*turn, expr.slot, number)
        ctx.ops.assign(ctx, target, value, frame)
        tests = [ctx.ops.evaluate(ctx, condition, frame) for condition in conditions]
        if any(known and not said for known, said in (test.constant() for test in tests)):
            continue
        gate = ctx.ops.gate(ctx, NONE.union(*map(ctx.use, tests)), frame, expr.slot) if tests else NONE
        element = ctx.ops.evaluate(ctx, expr.element, frame)
        element = Value(element.deps | gate, element.pts, element.consts)
        if expr.key is None:
            ctx.store.put((obj, item_field(count)), element)
        else:
            updates.write_item(ctx, pointer(obj), ctx.ops.evaluate(ctx, expr.key, frame), element)
        length, count = length | gate, count + 1
    frame.turn = turn
    if length:
        ctx.store.put((obj, LENGTH), Value(length))
    return pointer(obj)


def _of_rows(
    ctx: Interpreter, expr: ir.Comprehension, elements: list[Value], length: Nodes, frame: Frame
) -> Value:
    """Unroll a comprehension over elements whose order is unknown; the conditions may hold for each element."""
    kind = "mapping" if expr.key is not None else "sequence"
    obj = recency.allocate(ctx, kind, frame, ("display", expr.slot))
    turn, (target, _, conditions) = frame.turn, expr.loops[0]
    for number, value in enumerate(elements):
        frame.turn = (*turn, expr.slot, number)
        ctx.ops.assign(ctx, target, value, frame)
        tests = [ctx.ops.evaluate(ctx, condition, frame) for condition in conditions]
        if any(test.constant() == (True, False) for test in tests):
            continue
        gate = ctx.ops.gate(ctx, NONE.union(*map(ctx.use, tests)), frame, expr.slot)
        made = ctx.ops.evaluate(ctx, expr.element, frame)
        made = Value(made.deps | gate, made.pts, made.consts)
        if expr.key is None:
            updates.add_element(ctx, pointer(obj), made)
        else:
            updates.write_item(ctx, pointer(obj), ctx.ops.evaluate(ctx, expr.key, frame), made)
        length |= gate
    frame.turn = turn
    ctx.store.put((obj, LENGTH), Value(length))
    return pointer(obj)


def _selected(
    ctx: Interpreter, expr: ir.Comprehension, known: list[Value], frame: Frame
) -> list[Value] | None:
    """Return the constants of a known command line for which the conditions hold; None if one is undecided."""
    chosen: list[Value] = []
    target, _, conditions = expr.loops[0]
    for value in known if all(one.fixed() for one in known) and len(known) <= sizes.MAX_KNOWN else ():
        ctx.ops.assign(ctx, target, value, frame)
        decided = [ctx.ops.evaluate(ctx, condition, frame).constant() for condition in conditions]
        if not all(found for found, _ in decided):
            return None
        if all(holds for _, holds in decided):
            chosen.append(value)
    return chosen or None


def mark(ctx: Interpreter, node: int, expr: ir.Expr, value: Value, frame: Frame) -> None:
    """Record that a node is a constant, or a copy of its only input."""
    known, constant = value.constant()
    default = fallbacks.of_entry(ctx, expr, value) if ctx.thorough else None
    if default is not None:
        ctx.graph.literals[node] = (default.value, default.pos, frame.program.path)
    elif ctx.thorough and (pos := fallbacks.entry(ctx, expr, value)) is not None:
        ctx.graph.copies.add(node)  # an entry of this entry is an entry of a parameter, too
        ctx.graph.literals[node] = (None, pos, frame.program.path)
    elif (_passes_on(ctx, expr) or _parameter_call(ctx, expr, value)) and not (
        isinstance(expr, (ir.Call, ir.Choice)) and known and not value.deps
    ):
        ctx.graph.copies.add(node)
    elif known and isinstance(constant, (bool, int, float)):
        ctx.graph.literals[node] = (constant, expr.pos, frame.program.path)
    elif ctx.thorough and not value.deps and not value.pts and (pos := computed(expr)):
        ctx.graph.literals[node] = (None, pos, frame.program.path)


def _passes_on(ctx: Interpreter, expr: ir.Expr) -> bool:
    """Return whether an expression only returns one of several stored values, unchanged."""
    if isinstance(expr, ir.Choice):
        return ctx.thorough and all(
            isinstance(arm, ir.Const) or _passes_on(ctx, arm) for arm in (expr.then, expr.other)
        )
    if not isinstance(expr, ir.Call):
        return isinstance(expr, (ir.Name, ir.Attribute, ir.Item))
    named = expr.function.name if isinstance(expr.function, (ir.Name, ir.Attribute)) else ""
    return named == "float" or (ctx.thorough and (named in READING or expr in ctx.unchanged))


def _parameter_call(ctx: Interpreter, expr: ir.Expr, value: Value) -> bool:
    """Return whether an expression is a call that returns a ROS parameter."""
    if not isinstance(expr, ir.Call) or not value.deps:
        return False
    ctx.graph.reads.ask(ctx.graph.parameters.issuperset, value.deps)
    return value.deps <= ctx.graph.parameters
