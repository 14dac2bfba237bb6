"""Transfer functions of expressions."""

from __future__ import annotations

import builtins
from collections.abc import Callable, Hashable, Mapping, Sequence
from typing import Any

from tarl_lint.catalog import fact
from tarl_lint.interpret import descriptors, dunder_methods, generators, literals, operators, short_circuits
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import enumerations, generations, heap, properties, recency, updates
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import ANY, GIVEN_KEYS, KEYS
from tarl_lint.memory.values import (
    ABSENT,
    BOTTOM,
    NONE,
    UNKNOWN,
    Nodes,
    Obj,
    Value,
    const,
    function_of,
    join,
    join_all,
    pointer,
)
from tarl_lint.models import environment, sizes

BUILTINS = frozenset(dir(builtins))
DEFINITIONS = frozenset(["msg", "srv", "action"])  # modules with classes generated from definition files


LOOKUP_ERRORS = ("KeyError", "IndexError")  # the exceptions raised for a missing element


def evaluate(ctx: Interpreter, expr: ir.Expr, frame: Frame) -> Value:
    """Return the abstract value of an expression."""
    value = EVALUATE[type(expr)](ctx, expr, frame)
    if ctx.probe is not None and frame.statement is not None:
        ctx.probe(ctx, frame, frame.statement, expr, value)
    return value


def _constant(ctx: Interpreter, expr: ir.Const, frame: Frame) -> Value:  # noqa: ARG001 - shared signature
    known: Value | None = expr.known
    if known is None:
        known = expr.known = const(expr.value)
    return known


def _name(ctx: Interpreter, expr: ir.Name, frame: Frame) -> Value:
    value = ctx.store.get((holder(expr, frame), expr.name))
    if value is not None:
        return value
    if expr.scope == "local" and not frame.owner_class():
        return BOTTOM
    return global_name(ctx, expr.name, frame)


def holder(expr: ir.Name, frame: Frame) -> Obj:
    """Return the object that holds a variable: a frame, a class under construction, or a module."""
    if expr.scope == "global":
        return frame.module
    if expr.scope == "local":
        return frame.owner_class() or frame
    holder: Frame | None = frame
    for _ in range(expr.level + (1 if frame.owner_class() else 0)):
        holder = holder.outer if holder is not None else None
    return holder or frame.module


def global_name(ctx: Interpreter, name: str, frame: Frame) -> Value:
    """Return the value of a name that the module does not bind: from `import *`, or a builtin."""
    value = ctx.store.get((frame.module, name))
    if value is None:
        value = heap.opened(ctx, frame.module, name)
    if value is not BOTTOM:
        return value
    stars = [s for s in heap.opened_by(ctx, frame.module) if s not in ctx.module_objects]
    for star in stars:
        if fact(f"{star}.{name}") is not None:
            return external(ctx, f"{star}.{name}")
    if name in BUILTINS:
        return external(ctx, f"builtins.{name}")
    return external(ctx, f"{_likely(stars, name)}.{name}") if stars else BOTTOM


def external(ctx: Interpreter, qualified: str) -> Value:
    """Return a function, class or module of a library."""
    return pointer(recency.intern(ctx, "ext", qualified, qualified))


def _attribute(ctx: Interpreter, expr: ir.Attribute, frame: Frame) -> Value:
    return read_attribute(ctx, evaluate(ctx, expr.base, frame), expr, frame)


def read_attribute(ctx: Interpreter, base: Value, expr: ir.Attribute, frame: Frame) -> Value:
    """Return an attribute of an evaluated object; call the getter of a property or descriptor."""
    if expr.name == "value" and base.consts and not base.pts:
        return base  # a member of an enumeration, which is represented by its value
    if expr.name == enumerations.MAPPING and (table := enumerations.by_name(ctx, base)) is not None:
        return table
    of_member = enumerations.attribute(ctx, base, expr.name) if ctx.members else None
    value = heap.read_or_hold(ctx, base, expr.name) if of_member is None else of_member
    for obj in value.objects:
        if obj.kind == "bound" and is_property(obj):
            call = ir.Call(expr, (), (), expr.pos, -expr.slot)
            if len(value.pts) == 1:
                return ctx.ops.call_object(ctx, obj, ([], {}), frame, call, base.deps)
            return ctx.ops.call_value(ctx, value, ([], {}), frame, call, base.deps)
    if (told := descriptors.read(ctx, base, value, expr.name, frame, expr.pos)) is not None:
        return told
    if value.consts == BOTTOM.consts and not value.pts:
        said = descriptors.computed(ctx, base, expr.name, frame, expr.pos)
        return value if said is None else said
    return value


def is_property(method: Obj) -> bool:
    """Return whether a bound method is a property's getter."""
    function = function_of(method)
    return function is not None and properties.is_property(function)


def _item(ctx: Interpreter, expr: ir.Item, frame: Frame) -> Value:
    base = evaluate(ctx, expr.base, frame)
    if isinstance(expr.index, ir.Slice):
        part = _part_of_text(ctx, base, expr.index.bounds, frame) if expr.index.bounds else None
        return part or sizes.sliced(ctx, base, expr.index, expr.pos, frame)
    index = evaluate(ctx, expr.index, frame)
    if (text := environment.text_of(base)) is not None:
        return Value(text.deps | ctx.use(index), consts=text.consts)
    keys = by_key(ctx, base, index, frame, expr.pos)
    if (frame.tries or len(ctx.stack) > 1) and (decides := ctx.use(index) | keys):
        for raises in LOOKUP_ERRORS:
            ctx.ops.may_fail(ctx, decides, raises, frame, named=True)
    said = dunder_methods.special(ctx, base, "__getitem__", [index], frame, expr.pos)
    if said is not None:
        return said
    found = read_item(ctx, base, index)
    for obj in base.objects if index.deps or index.pts else ():
        if obj.kind == "mapping" and _makes(ctx, obj) and (made := ctx.use(index)):
            updates.weaken(ctx, obj, KEYS, Value(made))  # a `defaultdict` adds the key
    return Value(found.deps | keys, found.pts) if keys else found


def by_key(ctx: Interpreter, base: Value, index: Value, frame: Frame, slot: Hashable) -> Nodes:
    """Return the node that decides a look-up in a mapping; empty if no data decides the keys.

    An entry with a constant key exists whatever the other keys are.
    """
    decides = NONE
    for obj in base.objects:
        if obj.kind == "mapping" and (stored := ctx.store.get((obj, KEYS))) is not None:
            fields = [heap.attribute_of_item(obj, key) for key in index.item_keys() or ()]
            held = [ctx.store.get((obj, field)) for field in fields]
            if not held or any(one is None or one == ABSENT for one in held):
                decides |= stored.deps
    if not decides:
        return NONE
    node = ctx.node(frame, ("key", slot), "condition")
    ctx.graph.depend(node, decides)
    return ctx.kept(node)


def _part_of_text(
    ctx: Interpreter, base: Value, bounds: Sequence[ir.Expr | None], frame: Frame
) -> Value | None:
    """Return `text[a:b]` of a known text; None if it is unknown."""
    known, text = base.constant()
    if not known or not isinstance(text, str):
        return None
    ends = [evaluate(ctx, one, frame).constant() if one is not None else (True, None) for one in bounds]
    numbers = [end for found, end in ends if found and (end is None or isinstance(end, int))]
    if len(numbers) < len(ends) or 0 in numbers[2:]:
        return None
    return Value(base.deps, consts=frozenset([text[slice(*numbers)]]))


def read_item(ctx: Interpreter, base: Value, index: Value) -> Value:
    """Return an element of a container; a tainted index taints the element."""
    extra = base.deps | ctx.use(index)
    if not base.pts:
        return Value(extra)
    result = Value(extra, consts=frozenset())
    for obj in base.objects:
        if obj.kind == "class":
            found = member(ctx, obj, index) if enumerations.enumerates(obj) else pointer(obj)
            result = join(result, heap.arrive(ctx, found, base.deps))
        elif keys := index.item_keys() or _default_keys(ctx, obj, index):
            for key in keys:
                result = join(result, heap.arrive(ctx, element(ctx, obj, key), base.deps))
        else:
            found = heap.read_any(ctx, obj)
            if found is BOTTOM and obj.kind == "mapping" and _makes(ctx, obj):
                found = ctx.ops.missing(ctx, obj, ANY)
            result = join(result, heap.arrive(ctx, found, base.deps))
    return Value(result.deps | extra, result.pts, result.consts)


def _default_keys(ctx: Interpreter, obj: Obj, index: Value) -> frozenset[str]:
    """Return a key's defaults (known only on the robot), if the mapping has an entry for each."""
    defaults = index.default_keys() if obj.kind == "mapping" else frozenset[str]()
    held = ctx.store.get((obj, GIVEN_KEYS)) if defaults else None
    stored = held.consts if held is not None else None
    return defaults if stored is not None and defaults <= stored else frozenset()


def member(ctx: Interpreter, cls: Obj, name: Value) -> Value:
    """Return the enumeration member `Class[name]`; all members if the name is unknown."""
    ctx.store.reads.look(cls)
    names = name.texts() or tuple(n for n in cls.fields if not n.startswith("_"))
    return join_all(v for n in names if not (v := heap.read_field(ctx, cls, n)).pts & functions(ctx, cls))


def functions(ctx: Interpreter, cls: Obj) -> frozenset[Obj]:
    """Return the functions in a class."""
    held = (ctx.store.get((cls, n)) for n in list(cls.fields))
    return frozenset(o for v in held if v is not None for o in v.pts if o.kind in ("closure", "bound"))


def element(ctx: Interpreter, obj: Obj, key: object) -> Value:
    """Return one element by a constant index or key."""
    name = heap.attribute_of_item(obj, key)
    if obj.kind == "sequence" and isinstance(key, int) and key < 0:
        known = sizes.unpacked(ctx, pointer(obj))
        return known[key] if known and -key <= len(known) else heap.read_any(ctx, obj)
    if obj.kind == "sequence" and ctx.store.get((obj, name)) is None and heap.content(ctx, obj) is BOTTOM:
        return BOTTOM
    value = descriptors.entry(ctx, obj, name) if obj.kind == "instance" else heap.read_field(ctx, obj, name)
    if value is BOTTOM and obj.kind == "mapping" and _makes(ctx, obj):
        return ctx.ops.missing(ctx, obj, name)
    return value


def _makes(ctx: Interpreter, mapping: Obj) -> bool:
    """Return whether a mapping creates missing values, as a `defaultdict` does."""
    ctx.store.reads.look(mapping)
    return mapping.info is not None


def _slice(ctx: Interpreter, expr: ir.Slice, frame: Frame) -> Value:
    deps = NONE
    for part in expr.parts:
        deps |= ctx.use(evaluate(ctx, part, frame))
    return Value(deps)


def _choice(ctx: Interpreter, expr: ir.Choice, frame: Frame) -> Value:
    test = evaluate(ctx, expr.test, frame)
    known, constant = test.constant()
    if known:
        return evaluate(ctx, expr.then if constant else expr.other, frame)
    guard = operators.guard(ctx, operators.truth(ctx, test, frame, expr.slot), frame, expr.slot)
    then = under_guard(ctx, expr.then, (guard, "then"), expr.test, frame)
    other = under_guard(ctx, expr.other, (guard, "other"), expr.test, frame)
    if ctx.thorough:
        then = literals.entry(ctx, expr.then, then, frame, ("then", expr.slot))
        other = literals.entry(ctx, expr.other, other, frame, ("other", expr.slot))
    node = ctx.node(frame, ("choice", expr.slot), "condition")
    if ctx.kept(guard):
        ctx.graph.depend(node, (guard,))
    both = join(then, other)
    return Value(both.deps | ctx.kept(node), both.pts, both.consts)


def under_guard(
    ctx: Interpreter, expr: ir.Expr, guard: tuple[int, str], test: ir.Expr, frame: Frame
) -> Value:
    """Evaluate an expression executed for one outcome of a decision, on which its value depends."""
    ctx.guards.append(guard)
    former = ctx.ops.narrow_part(ctx, test, frame, holds=guard[1] == "then")
    value = evaluate(ctx, expr, frame)
    ctx.ops.widen(ctx, former)
    ctx.guards.pop()
    return value


def _starred(ctx: Interpreter, expr: ir.Starred, frame: Frame) -> Value:
    return evaluate(ctx, expr.value, frame)


def _walrus(ctx: Interpreter, expr: ir.Walrus, frame: Frame) -> Value:
    node = ctx.node(frame, ("walrus", expr.slot), "assign")
    value = ctx.carry(evaluate(ctx, expr.value, frame), node)
    ctx.ops.assign(ctx, expr.target, value, frame)
    return value


def _yield(ctx: Interpreter, expr: ir.Yield, frame: Frame) -> Value:
    value = evaluate(ctx, expr.value, frame)
    if expr.kind == "await":
        # the caller of a coroutine in a task goes on here
        frame.pauses[expr.pos] = ctx.store.since(frame.depth_of_layers)
        ctx.ops.wait(ctx, frame)
        return _awaited(ctx, value)
    inner, value = value, heap.elements(ctx, value) if expr.kind == "from" else value
    value = ctx.carry(value, ctx.node(frame, ("yield", expr.pos), "return"))
    frame.yielded = join(frame.yielded, value)
    frame.pauses[expr.pos] = ctx.store.since(frame.depth_of_layers)
    if frame.caller is not None and frame.caller.statement is None:
        # a library runs the generator, and anything may happen before the generator continues
        ctx.ops.wait(ctx, frame)
        return UNKNOWN
    if expr.kind == "from":
        return generators.delegated(ctx, expr, inner, frame)
    return generators.suspended(ctx, expr, frame)


def _awaited(ctx: Interpreter, value: Value) -> Value:
    """Return the results of the futures of executors, and other objects as they are."""
    stored = [ctx.store.get((o, heap.RESULT)) if o.kind == "lib" else None for o in value.objects]
    if not any(stored):
        return value
    results = [heap.arrive(ctx, one, value.deps) for one in stored if one is not None]
    others = frozenset(o for o, one in zip(value.objects, stored, strict=True) if one is None)
    return join_all([*results, Value(value.deps, others)])


def _lambda(ctx: Interpreter, expr: ir.Lambda, frame: Frame) -> Value:
    return closure(ctx, expr.function, frame, expr.slot)


def closure(ctx: Interpreter, function: ir.Function, frame: Frame, slot: object) -> Value:
    """Return a function object that refers to its enclosing frame."""
    outer = frame.outer if frame.owner_class() else frame
    key = (function.module, frame.id, function.pos, slot, *frame.turn)
    obj = recency.intern(ctx, "closure", key, function.name)
    obj.info = (function, outer, frame.program, frame.owner_class())
    generations.note_closure(ctx, obj, function, frame)
    if outer is not None:
        around: Frame | None = outer
        while around is not None:
            around.captured = True
            around = around.outer
    for parameter in function.parameters:
        if parameter.default is not None:
            ctx.store.put((obj, parameter.name), default_value(ctx, parameter, obj, frame))
    return pointer(obj)


def default_value(ctx: Interpreter, parameter: ir.Parameter, closure: Obj, frame: Frame) -> Value:
    """Return a parameter's default value, attributed to the `def` statement."""
    assert parameter.default is not None  # noqa: S101 - the callers check this
    value = evaluate(ctx, parameter.default, frame)
    node = ctx.node(frame, ("default", closure.key, parameter.name), "assign")
    literals.mark(ctx, node, parameter.default, value, frame)
    return ctx.carry(value, node)


def _likely(stars: list[str], name: str) -> str:
    """Guess the module of a name: message modules for capitalised names, other modules otherwise."""
    message = name[:1].isupper() and not name.isupper()
    likely = [s for s in stars if (s.rpartition(".")[2] in DEFINITIONS) is message]
    return (likely or stars)[-1]


EVALUATE: Mapping[type, Callable[[Any, Any, Frame], Value]] = {
    ir.Const: _constant,
    ir.Name: _name,
    ir.Attribute: _attribute,
    ir.Item: _item,
    ir.Slice: _slice,
    ir.Call: lambda ctx, expr, frame: ctx.ops.call(ctx, expr, frame),
    ir.Operation: operators.operation,
    ir.Choice: _choice,
    ir.SequenceDisplay: literals.sequence_display,
    ir.MappingDisplay: literals.mapping_display,
    ir.Comprehension: short_circuits.comprehension,
    ir.Starred: _starred,
    ir.Walrus: _walrus,
    ir.Yield: _yield,
    ir.Lambda: _lambda,
}
