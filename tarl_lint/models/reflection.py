"""Models of reflection: `getattr`, `setattr`, `attrgetter`, `eval`."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from tarl_lint.interpret import call_contexts, calls, descriptors, expressions, operators
from tarl_lint.interpret.call_contexts import CALLABLE
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import function_attributes, heap, message_types, recency, updates
from tarl_lint.memory.heap import item_field
from tarl_lint.memory.values import BOTTOM, UNKNOWN, Obj, Value, const, join_all, lineage, pointer
from tarl_lint.models import containers, type_queries
from tarl_lint.models.rows import MAX_MEMBERS
from tarl_lint.models.text_ends import ends

OURS = frozenset(["instance", "class", "closure", "module"])


def get_attribute(ctx: Interpreter, it: Invocation) -> Value:
    """Return an attribute whose name is known, or at least the beginning of the name."""
    plain = it.arguments[0]
    names = plain[1].texts() if len(plain) > 1 else ()
    if not names and plain and not it.call.arguments:
        return plain[
            0
        ]  # `reduce(getattr, parts, message)` returns a part of the message; storing into it fills the message
    if not names and len(it.call.arguments) > 1:
        return _with_ends(ctx, it) or _any_part(ctx, it)
    if len(plain) > 2 and names and all(type_queries.lacks(ctx, plain[0], name) for name in names):
        return plain[2]
    found = [
        expressions.read_attribute(
            ctx, plain[0], _written(it, message_types.field(ctx, plain[0], name), number), it.frame
        )
        for number, name in enumerate(names)
    ]
    for default in plain[2:]:
        found = [
            function_attributes.with_default(ctx, plain[0], name, one, default)
            for name, one in zip(names, found, strict=True)
        ]
    both = join_all(found)
    return Value(both.deps | ctx.use(plain[1]), both.pts, both.consts) if len(names) > 1 else both


def _any_part(ctx: Interpreter, it: Invocation) -> Value:
    """Return an attribute of unknown name. A message also stands for its parts, so that stores into them are kept."""
    found = ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    known = (o for value in it.arguments[0][:1] for o in value.pts)
    whole = frozenset(o for o in known if message_types.MESSAGE_MODULE in o.whole.name)
    return Value(found.deps, found.pts | whole, found.consts) if whole else found


def fields_and_types(ctx: Interpreter, it: Invocation) -> Value:
    """Return `msg.get_fields_and_field_types()` of ROS 2: a mapping of the names of the fields to their types."""
    obj = recency.allocate(ctx, "mapping", it.frame, ("display", it.call.slot))
    for message in it.base.objects:
        names = message_types.field_names(ctx, message)
        for name in names:
            ctx.store.put((obj, item_field(name)), UNKNOWN)
        if not names:
            updates.add_element(ctx, pointer(obj), UNKNOWN)
    return pointer(obj)


def _written(it: Invocation, name: str, number: int = 0) -> ir.Attribute:
    """Return the attribute that a call of `getattr` accesses, as if it was written with a dot."""
    base = it.call.arguments[0] if it.call.arguments else ir.Const(None, it.call.pos)
    return ir.Attribute(base, name, it.call.pos, 1000 * (abs(it.call.slot) + 1) + number)


def _with_ends(ctx: Interpreter, it: Invocation) -> Value | None:
    """Return the attributes that `getattr(self, "do_" + verb)` may return; None if they are unknown."""
    if len(it.arguments[0]) < 2:  # `getattr(*unknown(), *unknown())`
        return None
    (holder, name, *rest), known = it.arguments[0], ends(ctx, it.call.arguments[1], it.frame)
    found = BOTTOM
    for obj in holder.objects if len(known.start) + len(known.end) > 1 else ():
        members = filter(known.fit, _attribute_names(ctx, obj))
        found = join_all([found, *(heap.read_field(ctx, obj, member) for member in members)])
    if found is BOTTOM:
        return None
    found = join_all([heap.arrive(ctx, found, holder.deps), *rest])
    return Value(found.deps | ctx.use(name), found.pts)


def _attribute_names(ctx: Interpreter, obj: Obj) -> list[str]:
    """Return the names of the known attributes of an instance, a class or a module, with those of base classes."""
    cls = obj.info if obj.kind == "instance" else obj if obj.kind == "class" else None
    found: dict[str, None] = {}
    for owner in [obj, *lineage(cls)] if isinstance(cls, Obj) else [obj] if obj.kind == "module" else []:
        ctx.store.reads.look(owner)
        found.update(dict.fromkeys(name for name in owner.fields if name.isidentifier()))
    return list(found)


def getter(ctx: Interpreter, it: Invocation) -> Value:
    """Return the function made by `attrgetter(...)` or `itemgetter(...)`."""
    obj = recency.intern(ctx, "partial", (it.frame.id, it.statement, it.call.slot, *it.frame.turn), it.name)
    obj.describe((expressions.external(ctx, f"{it.name}.<made>"), it.arguments[0], {}))
    return pointer(obj)


def bound_method(ctx: Interpreter, it: Invocation) -> Value:
    """Return `types.MethodType(function, obj)`."""
    if len(it.arguments[0]) != 2:
        return UNKNOWN
    function, receiver = it.arguments[0]
    owners = ((o, o.info) for o in receiver.objects if o.kind == "instance")
    ways = [heap.bind(ctx, function, obj, cls) for obj, cls in owners if isinstance(cls, Obj)]
    return join_all(ways) if ways else function


def member_names(ctx: Interpreter, it: Invocation) -> Value:
    """Return `dir(obj)`: the names of the attributes of an object of an analysed class, without special ones."""
    found = _members(ctx, it.arguments[0])
    if found is None:
        return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    return _listed(ctx, [const(name) for name in found], it)


def members(ctx: Interpreter, it: Invocation) -> Value:
    """Return `inspect.getmembers(obj)`: the names and values of the attributes; with a predicate, only the methods."""
    plain, named = it.arguments
    found, predicate = _members(ctx, plain), named.get("predicate", plain[1] if len(plain) > 1 else None)
    if found is None:
        return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    pairs: list[Value] = []
    for number, name in enumerate(found):
        value = heap.read(ctx, plain[0], name)
        if predicate is None or _fulfils(ctx, predicate, value, it, number):
            pair = recency.allocate(ctx, "sequence", it.frame, ("pair", it.call.slot, name))
            ctx.store.put((pair, item_field(0)), const(name))
            ctx.store.put((pair, item_field(1)), value)
            pairs.append(pointer(pair))
    return _listed(ctx, pairs, it)


def _fulfils(ctx: Interpreter, predicate: Value, value: Value, it: Invocation, number: int) -> bool:
    """Return whether a predicate may select a member.

    For a predicate of `inspect`, the member must be a method; any other predicate is called.
    """
    if any(o.kind == "ext" for o in predicate.pts):
        return any(o.kind in CALLABLE for o in value.pts)
    found = calls.call_value(ctx, predicate, ([value], {}), it.frame, it.call.inner(number))
    return found.constant() not in ((True, False), (True, None))


def _members(ctx: Interpreter, plain: Sequence[Value]) -> list[str] | None:
    """Return the names of an object's attributes; None if they are not known, or too many."""
    obj = next(iter(plain[0].pts)) if plain and len(plain[0].pts) == 1 else None
    cls = obj.info if obj is not None and obj.kind == "instance" else obj
    if obj is None or not isinstance(cls, Obj) or cls.kind != "class":
        return None
    found: set[str] = set()
    for owner in {obj, *lineage(cls)}:
        ctx.store.reads.look(owner)
        found.update(n for n in owner.fields if n.isidentifier() and not n.startswith("__"))
    return sorted(found) if 0 < len(found) <= MAX_MEMBERS else None


def _listed(ctx: Interpreter, values: Sequence[Value], it: Invocation) -> Value:
    """Return a new sequence over which a loop is executed element by element."""
    obj = recency.allocate(ctx, "sequence", it.frame, ("display", it.call.slot))
    obj.name = heap.MEMBERS
    for number, value in enumerate(values):
        ctx.store.put((obj, item_field(number)), value)
    return pointer(obj)


def partial_method(ctx: Interpreter, it: Invocation) -> Value:
    """Return a `functools.partialmethod`: a partial that is bound to an instance when it is looked up through it."""
    plain, named = it.arguments
    if not plain:
        return UNKNOWN
    obj = recency.intern(ctx, "partial", (it.frame.id, it.statement, it.call.slot, *it.frame.turn), it.name)
    obj.describe((plain[0], plain[1:], named, "method"))
    return pointer(obj)


def get_named(ctx: Interpreter, it: Invocation) -> Value:
    """Return the result of a function made by `attrgetter` or `itemgetter`; a tuple for several names."""
    *keys, given = it.arguments[0] or [UNKNOWN]
    found = [
        _by_path(ctx, given, k) if "attr" in it.name else expressions.read_item(ctx, given, k) for k in keys
    ]
    if len(found) == 1:
        return found[0]
    obj = recency.allocate(ctx, "sequence", it.frame, ("display", it.call.slot, it.name))
    for number, value in enumerate(found):
        ctx.store.put((obj, item_field(number)), value)
    return pointer(obj)


def _by_path(ctx: Interpreter, value: Value, name: Value) -> Value:
    for part in (name.texts() or ("",))[0].split("."):
        value = heap.read(ctx, value, part)
    return value


def set_attribute(ctx: Interpreter, it: Invocation) -> Value:
    """Store into the named attribute; into any attribute if the name is unknown."""
    plain = it.arguments[0]
    if len(plain) == 3:
        value = containers.through_statement(ctx, plain[2], it.frame, it.call)
        value = operators.into_chosen(ctx, plain[0], value, it.call.slot, it.frame)
        if ctx.thorough and value.deps != plain[2].deps:
            ctx.graph.copies |= value.deps
        names = plain[1].texts()
        for field in (message_types.field(ctx, plain[0], name) for name in names):
            plainly = it.name == "object.__setattr__" or it.name == "__setattr__"
            if plainly or not descriptors.write(ctx, plain[0], field, value, it.frame, it.call.pos):
                (updates.write_field if len(names) == 1 else updates.weaken_field)(
                    ctx, plain[0], field, value
                )
        if not names:
            libraries = any(o.kind in message_types.KINDS for o in plain[0].pts)
            updates.add_element(ctx, plain[0], Value(ctx.use(value), value.pts) if libraries else value)
            if it.name == "setattr":
                descriptors.write_some(ctx, plain[0], value, it.frame, it.call.pos)
    return UNKNOWN


def evaluated(ctx: Interpreter, it: Invocation) -> Value:
    """Return the value of `eval`: the data of the local variables that the expression may name."""
    deps = call_contexts.all_used(ctx, it.arguments)
    if len(it.arguments[0]) == 1:
        named = _names(it.arguments[0][0].texts())
        for name in [n for n in it.frame.fields if named is None or n in named]:
            value = ctx.store.get((it.frame, name))
            if value is not None and not any(o.kind in OURS for o in value.pts):
                deps |= ctx.use(value)
    return Value(deps)


def _names(texts: Sequence[str]) -> set[str] | None:
    """Return the names in expressions; None if the expressions are unknown."""
    try:
        trees = [ast.parse(text.strip(), mode="eval") for text in texts]
    except SyntaxError:
        return set()
    return {n.id for tree in trees for n in ast.walk(tree) if isinstance(n, ast.Name)} if trees else None
