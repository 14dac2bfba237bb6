"""Tags: in an `if` that tests one, variables hold only the objects with a matching tag.

A tag tells objects of different kinds apart, as in `kind, value = queue.get()` with `if kind == "stop"`: the first
element of a tuple, an entry of a mapping, an attribute, or the class of an object. Local variables that got their
values from such objects are narrowed, for example `value`. After the `if`, the variables have their former values
again.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

from tarl_lint.interpret import expressions, operators
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.tag_tests import Test, calls_nothing, of_variable, tags_of, tests
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.control_dependence import every_statement
from tarl_lint.memory import enumerations, heap
from tarl_lint.memory.frames import REST, Former, Frame, Settled, Taken
from tarl_lint.memory.store import Delta
from tarl_lint.memory.values import NONE, Key, Nodes, Obj, Value, const, lineage, pointer

TAGGED: Final = frozenset(["sequence", "mapping", "instance"])  # kinds of objects that are told apart by tags
MAX_TAKEN: Final = 16  # maximum number of values of a variable whose origin is known
Narrowed = dict[Key, Value]  # variable → its value in a branch


def note(ctx: Interpreter, target: ir.Expr, source: ir.Expr, value: Value, slot: str, frame: Frame) -> None:
    """Record that the current statement assigned a value to a variable: `job = queue.get()` or `kind = job[0]`."""
    if not isinstance(target, ir.Name):
        return
    frame.settled.pop(key_of(target, frame), None)
    if several(value):
        _remember(ctx, target, value, None, slot, frame)
    elif (of := of_variable(source)) is not None:
        key = key_of(of[0], frame)
        whole = ctx.store.get(key)
        if whole is not None and several(whole):
            _remember(ctx, target, whole, of[1], slot, frame, key)


def note_element(
    ctx: Interpreter, target: ir.Expr, whole: Value, number: int, slot: str, frame: Frame
) -> None:
    """Record that a statement assigned an element, or the other elements, of a value to a variable."""
    if isinstance(target, ir.Starred):
        if isinstance(target.value, ir.Name) and several(whole):
            _remember(ctx, target.value, whole, REST, slot, frame)
    elif isinstance(target, ir.Name) and several(whole):
        _remember(ctx, target, whole, const(number), slot, frame)


def key_of(name: ir.Name, frame: Frame) -> Key:
    """Return the key of a variable in the heap."""
    return expressions.holder(name, frame), name.name


def several(value: Value) -> bool:
    """Return whether a value may be one of several objects, which tags can tell apart."""
    return len(value.pts) > 1 and any(o.kind in TAGGED for o in value.pts)


def _remember(
    ctx: Interpreter,
    target: ir.Name,
    before: Value,
    field: str | Value | None,
    slot: str,
    frame: Frame,
    of: Key | None = None,
) -> None:
    key = key_of(target, frame)
    now = ctx.store.get(key)
    if now is not None and frame.statement is not None:
        keep(frame, key, Taken(now, before, frame.statement, slot, field, of))


def keep(frame: Frame, key: Key, taken: Taken) -> None:
    """Record where a variable got its current value."""
    known = frame.taken.setdefault(key, [])
    known[:] = [*[one for one in known if one.value is not taken.value][1 - MAX_TAKEN :], taken]


def narrow(ctx: Interpreter, test: ir.Expr, frame: Frame, before: Narrowed, *, holds: bool) -> Narrowed:
    """Narrow variables in the current state, in which a condition holds or fails; return their new values.

    The former values are added to `before`.
    """
    found: Narrowed = {}
    statement = frame.statement
    for one in tests(ctx, test, frame, holds=holds):
        for key, value in list(_narrow(ctx, one, frame)):
            former = ctx.store.get(key)
            if former is not None and key not in found:
                before[key] = former
            found[key] = value
            ctx.store.put(key, value)
    frame.statement = statement
    return found


def decide(ctx: Interpreter, s: ir.If, frame: Frame, narrowed: Narrowed, *, holds: bool) -> None:
    """Let a branch depend on the objects with a matching tag, and not on the others.

    The conditions under which the other objects came into the same queue do not decide whether the branch runs. If
    the test excludes constants, the conditions that chose among the constants decide both branches.
    """
    if not calls_nothing(s.test) or any(
        not value.pts and taken_from(ctx, key, frame) is None for key, value in narrowed.items()
    ):
        return
    node = ctx.way(frame, s, "then" if holds else "else")
    value = ctx.ops.evaluate(ctx, s.test, frame)
    frame.statement = s
    ctx.graph.flow(operators.truth(ctx, value, frame, ("test", holds)), node)
    for key, now in narrowed.items():
        taken = taken_from(ctx, key, frame)
        ctx.graph.flow((now if taken is None else taken.before).deps, node)


def settle(
    s: ir.If, frame: Frame, before: Narrowed, ways: Sequence[tuple[Narrowed, Sequence[ir.Stmt]]]
) -> None:
    """Record the objects for which the test of an `if` is certainly false, or certainly true."""
    for key, former in before.items():
        for narrowed, body in ways:
            objects = former.pts - narrowed[key].pts if key in narrowed else frozenset()
            if objects:
                spared = frozenset([(s.id, False), *((one.id, True) for one in every_statement(body))])
                frame.settled.setdefault(key, []).append(Settled(former, objects, spared))


def restore(ctx: Interpreter, before: Narrowed, ways: Sequence[tuple[Narrowed, Delta]]) -> None:
    """After an `if`, restore each narrowed variable that no branch has assigned."""
    for key, value in before.items() if len(ways) > 1 else ():
        if all(key not in state or state[key] is narrowed.get(key) for narrowed, state in ways):
            ctx.store.put(key, value)


def narrow_part(ctx: Interpreter, test: ir.Expr, frame: Frame, *, holds: bool) -> Former:
    """Narrow variables for the rest of an expression. Return the values from before, and the new values."""
    before: Narrowed = {}
    found = narrow(ctx, test, frame, before, holds=holds)
    return [(key, before[key], value) for key, value in found.items() if key in before]


def widen(ctx: Interpreter, former: Former) -> None:
    """After an expression, restore the value of each narrowed variable to which the expression has not assigned."""
    for key, before, value in reversed(former):
        if ctx.store.get(key) is value:
            ctx.store.put(key, before)


def _narrow(ctx: Interpreter, test: Test, frame: Frame) -> Iterator[tuple[Key, Value]]:
    """Yield the variables that a test narrows, with their new values."""
    if (of := of_variable(test.expr)) is not None:
        yield from _objects(ctx, *of, test, frame)
    elif isinstance(test.expr, ir.Name):
        if test.classes is not None:
            yield from _objects(ctx, test.expr, "", test, frame)
        else:
            yield from _constants(ctx, test.expr, test, frame)
            yield from _companions(ctx, test.expr, test, frame)


def _constants(ctx: Interpreter, name: ir.Name, test: Test, frame: Frame) -> Iterator[tuple[Key, Value]]:
    """Yield a variable without the constants that do not match."""
    key = key_of(name, frame)
    now = ctx.store.get(key)
    known = now.keys() if now is not None else None
    if now is None or now.pts or not known or taken_from(ctx, key, frame) is not None:
        return
    kept = known & test.tags if test.holds else known - test.tags if test.exact else known
    if kept and kept != known:
        # a single constant does not depend on the data with which the branch is entered
        yield key, Value(NONE if len(kept) == 1 else now.deps, consts=kept)


def _objects(
    ctx: Interpreter, name: ir.Name, field: str | Value, test: Test, frame: Frame
) -> Iterator[tuple[Key, Value]]:
    """Yield a variable without the objects whose tag does not match."""
    key = key_of(name, frame)
    now = ctx.store.get(key)
    if now is None or not several(now):
        return
    kept = frozenset(o for o in now.pts if _matches(ctx, o, field, test))
    if not kept or kept == now.pts:
        return
    yield key, _with(ctx, key, now, kept, frame)
    taken = taken_from(ctx, key, frame)
    befores = [now, taken.before] if taken is not None and taken.frame is not None else [now]
    for other in list(frame.taken):
        its = taken_from(ctx, other, frame)
        if its is not None and its.field is not None and its.before in befores:
            yield other, _with(ctx, other, its.value, kept, frame)


def _companions(ctx: Interpreter, name: ir.Name, test: Test, frame: Frame) -> Iterator[tuple[Key, Value]]:
    """Yield the variables that were taken from the same objects as a variable that is a tag."""
    taken = taken_from(ctx, key_of(name, frame), frame)
    if taken is None or taken.field is None:
        return
    before, field = taken.before, taken.field
    kept = frozenset(o for o in before.pts if _matches(ctx, o, field, test))
    if not kept or kept == before.pts:
        return
    for key in list(frame.taken):
        its = taken_from(ctx, key, frame)
        if its is None or (its.field is None and its.frame is None):
            continue
        if its.before == before:
            yield key, _with(ctx, key, its.value, kept, frame)
    if taken.of is not None and ctx.store.get(taken.of) is before:
        yield taken.of, _with(ctx, taken.of, before, kept, frame)


def taken_from(ctx: Interpreter, key: Key, frame: Frame) -> Taken | None:
    """Return where a variable got its value; None if that is not known."""
    now = ctx.store.get(key) if key in frame.taken else None
    return next((one for one in frame.taken.get(key, ()) if one.value is now), None)


def _with(ctx: Interpreter, key: Key, now: Value, kept: frozenset[Obj], frame: Frame) -> Value:
    """Return a variable's value if it is, or was taken from, one of some objects."""
    taken = taken_from(ctx, key, frame)
    if taken is None:
        return Value(now.deps, kept, now.consts)
    before = _only(ctx, taken.before, kept, taken.frame or frame)
    if taken.field is REST:
        part = Value(before.deps, frozenset(o for o in now.pts if o.info in kept), now.consts)
    else:
        part = before if taken.field is None else _field(ctx, before, taken.field)
    value = ctx.carry(part, _node(ctx, taken, kept, frame))
    keep(frame, key, replace(taken, value=value, before=before))
    return value


def _only(ctx: Interpreter, value: Value, kept: frozenset[Obj], frame: Frame) -> Value:
    """Reduce a value to some of its possible objects, also in the variable from which it was taken.

    This is a variable of the function, or of a caller that passed a part of the object.
    """
    if (found := whole_of(value, frame)) is None:
        return Value(value.deps - _passed_only(ctx, value.pts, kept), kept, value.consts)
    place, key, whole = found
    before = _only(ctx, whole.before, kept, whole.frame or place)
    narrowed = ctx.carry(before, _node(ctx, whole, kept, place))
    keep(place, key, replace(whole, value=narrowed, before=before))
    return narrowed


def whole_of(value: Value, frame: Frame) -> tuple[Frame, Key, Taken] | None:
    """Return the variable, here or in callers, with a value, and its origin; None without one."""
    place: Frame | None = frame
    while place is not None:
        for key, known in place.taken.items():
            for whole in known:
                if whole.value is value and whole.field is None and whole.before is not value:
                    return place, key, whole
        place = place.caller
    return None


def _node(ctx: Interpreter, taken: Taken, kept: frozenset[Obj], frame: Frame) -> int:
    """Return the node of the statement that gave a variable its value, for only some of the objects."""
    slot = ("target", taken.slot, "of", tuple(sorted(o.number for o in kept)))
    if taken.frame is not None:
        return ctx.node(taken.frame, slot, "call")  # the statement of the caller is still the call
    frame.statement, statement = taken.statement, frame.statement
    node = ctx.node(frame, slot, "assign")
    frame.statement = statement
    return node


def _field(ctx: Interpreter, value: Value, field: str | Value) -> Value:
    return (
        heap.read(ctx, value, field) if isinstance(field, str) else expressions.read_item(ctx, value, field)
    )


def _passed_only(ctx: Interpreter, all_of_them: frozenset[Obj], kept: frozenset[Obj]) -> Nodes:
    """Return the nodes that put objects into a container, if none of these objects is kept."""
    for obj in all_of_them:
        ctx.store.reads.ask(ctx.inserted_by, obj)
    ours = [ctx.inserted.get(obj.site) for obj in kept]
    if None in ours:
        return NONE
    theirs = (ctx.inserted.get(obj.site, ()) for obj in all_of_them - kept)
    return NONE.union(*theirs).difference(*(nodes for nodes in ours if nodes is not None))


def _matches(ctx: Interpreter, obj: Obj, field: str | Value, test: Test) -> bool:
    """Return whether an object may have a tag for which a test asks."""
    if obj.kind not in TAGGED or enumerations.is_member(obj):
        return True
    if test.classes is not None:
        return _of_classes(obj, test.classes, holds=test.holds)
    if isinstance(field, str) and obj.kind != "instance":
        return True
    found = _field(ctx, pointer(obj), field)
    tags = tags_of(found)
    if tags is None:
        return True
    return not tags.isdisjoint(test.tags) if test.holds else not (test.exact and tags <= test.tags)


def _of_classes(obj: Obj, classes: Value, *, holds: bool) -> bool:
    """Return whether an object may be, and may not be, an instance of one of the classes."""
    if holds:
        return obj in operators.narrowed(Value(pts=frozenset([obj])), classes).pts
    if obj.kind != "instance" or not isinstance(obj.info, Obj):
        return True
    return frozenset(classes.pts).isdisjoint(lineage(obj.info))
