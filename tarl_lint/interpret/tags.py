"""Tags: in the branches of an `if` that tests one, variables hold only the objects with a matching tag.

A tag tells objects of different kinds apart, as in `kind, value = queue.get()` with `if kind == "stop"`: the first
element of a tuple, an entry of a mapping, an attribute, or the class of an object. Local variables that got their
values from such objects are narrowed, for example `value`. After the `if`, they have their former values again.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from tarl_lint.interpret import expressions, operators
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import enumerations, heap
from tarl_lint.memory.frames import Former, Frame, Taken
from tarl_lint.memory.store import Delta
from tarl_lint.memory.values import NO_CONSTANTS, NONE, Key, Nodes, Obj, Value, const, lineage, pointer
from tarl_lint.models import sizes

TAGGED: Final = frozenset(["sequence", "mapping", "instance"])  # kinds of objects that are told apart by tags
MAX_TAKEN: Final = 16  # maximum number of values of a variable whose origin is known
EQUAL: Final = frozenset(["==", "is"])
UNEQUAL: Final = frozenset(["!=", "is not"])
Tags = frozenset[object]  # constants, and members of enumerations
Narrowed = dict[Key, Value]  # variable → its value in a branch


@dataclass(frozen=True)
class Test:
    """The condition that an expression is, or is not, one of several tags, or an instance of classes."""

    expr: ir.Expr
    tags: Tags
    holds: bool
    exact: bool = (
        True  # whether the expression is compared with all tags, so that it is none of them if this fails
    )
    classes: Value | None = None


def note(ctx: Interpreter, target: ir.Expr, source: ir.Expr, value: Value, slot: str, frame: Frame) -> None:
    """Record that the current statement assigned a value to a variable: `job = queue.get()` or `kind = job[0]`."""
    if not isinstance(target, ir.Name):
        return
    if _several(value):
        _remember(ctx, target, value, None, slot, frame)
    elif (of := _of_variable(source)) is not None:
        key = (expressions.holder(of[0], frame), of[0].name)
        whole = ctx.store.get(key)
        if whole is not None and _several(whole):
            _remember(ctx, target, whole, of[1], slot, frame, key)


def note_element(
    ctx: Interpreter, target: ir.Expr, whole: Value, number: int, slot: str, frame: Frame
) -> None:
    """Record that the current statement assigned an element of a value to a variable."""
    if isinstance(target, ir.Name) and _several(whole):
        _remember(ctx, target, whole, const(number), slot, frame)


def _several(value: Value) -> bool:
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
    key = (expressions.holder(target, frame), target.name)
    now = ctx.store.get(key)
    if now is not None and frame.statement is not None:
        _keep(frame, key, Taken(now, before, frame.statement, slot, field, of))


def _keep(frame: Frame, key: Key, taken: Taken) -> None:
    known = frame.taken.setdefault(key, [])
    known[:] = [*[one for one in known if one.value is not taken.value][1 - MAX_TAKEN :], taken]


def narrow(
    ctx: Interpreter, test: ir.Expr, frame: Frame, before: dict[Key, Value], *, holds: bool
) -> Narrowed:
    """Narrow variables in the current state, in which a condition holds or not; return their new values.

    The former values are added to `before`.
    """
    found: Narrowed = {}
    statement = frame.statement
    for one in _tests(ctx, test, frame, holds=holds):
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

    The conditions under which other objects came into the same queue do not decide whether the branch runs. If the
    test excludes constants, what chose among them decides both branches.
    """
    if not _without_calls(s.test) or any(
        not value.pts and _taken(ctx, key, frame) is None for key, value in narrowed.items()
    ):
        return
    node = ctx.way(frame, s, "then" if holds else "else")
    value = ctx.ops.evaluate(ctx, s.test, frame)
    frame.statement = s
    ctx.graph.flow(operators.truth(ctx, value, frame, ("test", holds)), node)
    for key in narrowed:
        taken = _taken(ctx, key, frame)
        ctx.graph.flow(narrowed[key].deps if taken is None else taken.before.deps, node)


def _without_calls(test: ir.Expr) -> bool:
    if isinstance(test, ir.Call):
        named = isinstance(test.function, ir.Name) and test.function.name == "isinstance"
        return named or _of_variable(test) is not None
    if isinstance(test, ir.Operation):
        return all(map(_without_calls, test.parts))
    if isinstance(test, (ir.Attribute, ir.Item)):
        return _without_calls(test.base)
    return isinstance(test, (ir.Const, ir.Name, ir.SequenceDisplay))


def restore(ctx: Interpreter, before: Narrowed, ways: Sequence[tuple[Narrowed, Delta]]) -> None:
    """After both branches of an `if`, give each variable that neither has assigned its former value again."""
    for key, value in before.items() if len(ways) > 1 else ():
        if all(key not in state or state[key] is narrowed.get(key) for narrowed, state in ways):
            ctx.store.put(key, value)


def narrow_part(ctx: Interpreter, test: ir.Expr, frame: Frame, *, holds: bool) -> Former:
    """Narrow variables for the rest of an expression; return their former and their new values."""
    before: Narrowed = {}
    found = narrow(ctx, test, frame, before, holds=holds)
    return [(key, before[key], value) for key, value in found.items() if key in before]


def widen(ctx: Interpreter, former: Former) -> None:
    """After an expression, give each variable that it has not assigned its former value again."""
    for key, before, value in reversed(former):
        if ctx.store.get(key) is value:
            ctx.store.put(key, before)


# --- conditions ---------------------------------------------------------------------------------------


def _tests(ctx: Interpreter, test: ir.Expr, frame: Frame, *, holds: bool) -> Iterator[Test]:
    """Yield the tests of tags that certainly hold or fail if a condition does."""
    if isinstance(test, ir.Call):
        yield from _of_class(ctx, test, frame, holds=holds)
    if not isinstance(test, ir.Operation):
        return
    parts = test.parts
    if test.operator == "not":
        yield from _tests(ctx, parts[0], frame, holds=not holds)
    elif test.operator == ("and" if holds else "or"):
        for part in parts:
            yield from _tests(ctx, part, frame, holds=holds)
    elif test.operator == ("or" if holds else "and"):
        yield from _alternatives([list(_tests(ctx, part, frame, holds=holds)) for part in parts])
    elif test.operator in EQUAL | UNEQUAL and len(parts) == 2:
        yield from _equal(ctx, parts[0], parts[1], frame, holds=holds is (test.operator in EQUAL))
    elif test.operator in operators.MEMBER and len(parts) == 2 and _names(parts[0]):
        tags = [_tags(one) for one in sizes.unpacked(ctx, _evaluate(ctx, parts[1], frame)) or ()]
        if tags and all(tags):
            known = frozenset[object]().union(*(one for one in tags if one))
            exact = all(len(one or ()) == 1 for one in tags)
            yield Test(parts[0], known, holds is (test.operator == "in"), exact)


def _alternatives(ways: list[list[Test]]) -> Iterator[Test]:
    """Yield the test that one of several alternatives makes, if all of them compare the same expression."""
    if all(len(way) == 1 and way[0].holds and way[0].classes is None for way in ways):
        first = ways[0][0]
        if all(_same(way[0].expr, first.expr) for way in ways):
            yield replace(first, tags=frozenset[object]().union(*(way[0].tags for way in ways)))


def _equal(ctx: Interpreter, first: ir.Expr, second: ir.Expr, frame: Frame, *, holds: bool) -> Iterator[Test]:
    for expr, other in ((first, second), (second, first)):
        if _names(expr) and isinstance(other, (ir.Const, ir.Name, ir.Attribute)):
            tags = _tags(_evaluate(ctx, other, frame))
            if tags:
                yield Test(expr, tags, holds, len(tags) == 1)
                return


def _of_class(ctx: Interpreter, call: ir.Call, frame: Frame, *, holds: bool) -> Iterator[Test]:
    name = call.function
    if isinstance(name, ir.Name) and name.name == "isinstance" and len(call.arguments) == 2:
        if not isinstance(call.arguments[0], ir.Name):
            return
        asked = _evaluate(ctx, call.arguments[1], frame)
        classes = frozenset(o for one in sizes.unpacked(ctx, asked) or [asked] for o in one.pts)
        if classes and all(o.kind in ("class", "ext") for o in classes):
            yield Test(call.arguments[0], frozenset(), holds, classes=Value(pts=classes))


def _names(expr: ir.Expr) -> bool:
    """Return whether an expression may be a tag: a variable, or an entry or attribute of one."""
    return isinstance(expr, ir.Name) or _of_variable(expr) is not None


def _of_variable(expr: ir.Expr) -> tuple[ir.Name, str | Value] | None:
    """Return the variable of `x.name`, `x[0]` or `x.get("key")`, with the attribute or the index."""
    if isinstance(expr, ir.Attribute) and isinstance(expr.base, ir.Name):
        return expr.base, expr.name
    if isinstance(expr, ir.Item) and isinstance(expr.base, ir.Name) and isinstance(expr.index, ir.Const):
        return expr.base, const(expr.index.value)
    if isinstance(expr, ir.Call) and isinstance(expr.function, ir.Attribute) and expr.function.name == "get":
        base, given = expr.function.base, expr.arguments
        if isinstance(base, ir.Name) and len(given) == 1 and isinstance(given[0], ir.Const):
            return base, const(given[0].value)
    return None


def _same(first: ir.Expr, second: ir.Expr) -> bool:
    if isinstance(first, ir.Name) and isinstance(second, ir.Name):
        return (first.name, first.scope, first.level) == (second.name, second.scope, second.level)
    one, other = _of_variable(first), _of_variable(second)
    return one is not None and other is not None and _same(one[0], other[0]) and one[1] == other[1]


def _evaluate(ctx: Interpreter, expr: ir.Expr, frame: Frame) -> Value:
    """Evaluate an expression without calls: a constant, a name, an attribute of names, or a display of these."""
    plain = isinstance(expr, (ir.Const, ir.Name))
    if isinstance(expr, ir.Attribute):
        plain = isinstance(expr.base, (ir.Name, ir.Attribute))
    if isinstance(expr, ir.SequenceDisplay):
        plain = all(isinstance(part, (ir.Const, ir.Name, ir.Attribute)) for part in expr.items)
    return ctx.ops.evaluate(ctx, expr, frame) if plain else Value()


def _tags(value: Value) -> Tags | None:
    """Return the tags that a value may be; None if it may be anything else."""
    if value.pts:
        known = value.consts == NO_CONSTANTS and all(map(enumerations.is_member, value.pts))
        return frozenset(value.pts) if known else None
    keys = value.keys()
    return keys if keys and None not in keys else None  # whether a value is set is not a tag, see nullness.py


# --- variables ----------------------------------------------------------------------------------------


def _narrow(ctx: Interpreter, test: Test, frame: Frame) -> Iterator[tuple[Key, Value]]:
    """Yield the variables that a test narrows, with their new values."""
    of_variable = _of_variable(test.expr)
    if of_variable is not None:
        name, field = of_variable
        yield from _objects(ctx, name, field, test, frame)
    elif isinstance(test.expr, ir.Name):
        if test.classes is not None:
            yield from _objects(ctx, test.expr, "", test, frame)
        else:
            yield from _constants(ctx, test.expr, test, frame)
            yield from _companions(ctx, test.expr, test, frame)


def _constants(ctx: Interpreter, name: ir.Name, test: Test, frame: Frame) -> Iterator[tuple[Key, Value]]:
    """Yield a variable without the constants that do not match."""
    key = (expressions.holder(name, frame), name.name)
    now = ctx.store.get(key)
    if now is None or now.pts or not now.keys() or _taken(ctx, key, frame) is not None:
        return
    known = now.keys() or frozenset()
    kept = known & test.tags if test.holds else known - test.tags if test.exact else known
    if kept and kept != known:
        # a single constant is the same for all data for which the branch runs
        yield key, Value(NONE if len(kept) == 1 else now.deps, consts=kept)


def _objects(
    ctx: Interpreter, name: ir.Name, field: str | Value, test: Test, frame: Frame
) -> Iterator[tuple[Key, Value]]:
    """Yield a variable without the objects whose tag does not match."""
    key = (expressions.holder(name, frame), name.name)
    now = ctx.store.get(key)
    if now is None or not _several(now):
        return
    kept = frozenset(o for o in now.pts if _matches(ctx, o, field, test))
    if kept and kept != now.pts:
        yield key, _with(ctx, key, now, kept, frame)


def _companions(ctx: Interpreter, name: ir.Name, test: Test, frame: Frame) -> Iterator[tuple[Key, Value]]:
    """Yield the variables that were taken from the same objects as a variable that is a tag."""
    taken = _taken(ctx, (expressions.holder(name, frame), name.name), frame)
    if taken is None or taken.field is None:
        return
    before, field = taken.before, taken.field
    kept = frozenset(o for o in before.pts if _matches(ctx, o, field, test))
    if not kept or kept == before.pts:
        return
    for key in list(frame.taken):
        its = _taken(ctx, key, frame)
        if its is not None and its.field is not None and its.before == before:
            yield key, _with(ctx, key, its.value, kept, frame)
    if taken.of is not None and ctx.store.get(taken.of) is before:
        yield taken.of, _with(ctx, taken.of, before, kept, frame)


def _taken(ctx: Interpreter, key: Key, frame: Frame) -> Taken | None:
    """Return where a variable got its value; None if that is not known."""
    now = ctx.store.get(key) if key in frame.taken else None
    return next((one for one in frame.taken.get(key, ()) if one.value is now), None)


def _with(ctx: Interpreter, key: Key, now: Value, kept: frozenset[Obj], frame: Frame) -> Value:
    """Return the value of a variable if it is one of some objects, or was taken from one of them."""
    taken = _taken(ctx, key, frame)
    if taken is None:
        return Value(now.deps, kept, now.consts)
    before = Value(taken.before.deps - _passed_only(ctx, taken.before.pts, kept), kept, taken.before.consts)
    frame.statement = taken.statement
    slot = ("target", taken.slot, "of", tuple(sorted(o.number for o in kept)))
    part = before if taken.field is None else _field(ctx, before, taken.field)
    value = ctx.carry(part, ctx.node(frame, slot, "assign"))
    _keep(frame, key, replace(taken, value=value, before=before))
    return value


def _field(ctx: Interpreter, value: Value, field: str | Value) -> Value:
    return (
        heap.read(ctx, value, field) if isinstance(field, str) else expressions.read_item(ctx, value, field)
    )


def _passed_only(ctx: Interpreter, all_of_them: frozenset[Obj], kept: frozenset[Obj]) -> Nodes:
    """Return the nodes that put only those objects into a container that are not kept."""
    for obj in all_of_them:
        ctx.store.reads.ask(ctx.inserted_by, obj)
    ours = [ctx.inserted.get(obj.site) for obj in kept]
    if None in ours:
        return NONE
    theirs = (ctx.inserted.get(obj.site, ()) for obj in all_of_them - kept)
    return NONE.union(*theirs).difference(*(nodes for nodes in ours if nodes is not None))


def _matches(ctx: Interpreter, obj: Obj, field: str | Value, test: Test) -> bool:
    """Return whether an object may have a tag as a test asks for."""
    if obj.kind not in TAGGED or enumerations.is_member(obj):
        return True
    if test.classes is not None:
        return _of_classes(obj, test.classes, holds=test.holds)
    if isinstance(field, str) and obj.kind != "instance":
        return True
    found = _field(ctx, pointer(obj), field)
    tags = _tags(found)
    if tags is None:
        return True
    return not tags.isdisjoint(test.tags) if test.holds else not (test.exact and tags <= test.tags)


def _of_classes(obj: Obj, classes: Value, *, holds: bool) -> bool:
    """Return whether an object may be, or may not be, an instance of one of some classes."""
    if holds:
        return obj in operators.narrowed(Value(pts=frozenset([obj])), classes).pts
    if obj.kind != "instance" or not isinstance(obj.info, Obj):
        return True
    return frozenset(classes.pts).isdisjoint(lineage(obj.info))
