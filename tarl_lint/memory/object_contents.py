"""The parts of one object that the search for data reads, kept until something is stored in the object."""

from __future__ import annotations

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import heap
from tarl_lint.memory.cached_data import Contents, State
from tarl_lint.memory.heap import ANY
from tarl_lint.memory.reads import Reads, complete
from tarl_lint.memory.shared import BORN
from tarl_lint.memory.values import NONE, Obj, Value
from tarl_lint.message_fields import FIELDS


def contents(ctx: Interpreter, obj: Obj) -> Contents:
    """Return the contents of an object that may hold data. `note` records the facts on which the contents depend."""
    store = ctx.store
    whole = obj.outermost or obj
    state = (store.versions.get(whole, 0), whole.edition, store.waited, whole.defined)
    known = store.contents.get(obj)
    if known is None or known.state != state:
        known = store.contents[obj] = _read(ctx, obj, state)
    return known


def note(ctx: Interpreter, known: Contents) -> None:
    """Make the running call depend on the contents of an object."""
    whole = known.obj.whole
    store, reads = ctx.store, ctx.store.reads
    written = reads.written
    if not written:
        reads.keys |= known.keys
    elif store.waited or (whole, BORN) not in written or not store.isolated(whole):
        reads.keys |= known.keys - written
    if known.stored:
        reads.stored |= known.stored - written
    complete(reads.objects, known.objects)


def _read(ctx: Interpreter, obj: Obj, state: State) -> Contents:
    """Read the contents of an object, and record the reads for this object alone."""
    store = ctx.store
    outer = store.reads
    reads = store.reads = ctx.graph.reads = Reads()
    store.look(obj)
    definition = defined(ctx, obj)
    overwritten = definition != "" and replaced(ctx, obj, definition)
    summary = NONE if overwritten else heap.content(ctx, obj).deps
    nodes: set[int] = set()
    steps: list[Value] = []
    constants: set[int] = set()
    for name in list(obj.fields):
        value = store.get((obj, name)) if name != ANY or not overwritten else None
        if value is None:
            continue
        if value.deps and name.isidentifier() and value.fixed():
            constants.add(len(steps))
            steps.append(value)
        else:
            nodes |= value.deps
            if value.pts:
                steps.append(value)
    parts = _parts(ctx, obj, overwritten)
    store.reads = ctx.graph.reads = outer
    own = frozenset(nodes)
    return Contents(
        obj, state, own, summary, own | summary if own else summary, ANY in obj.fields, overwritten, tuple(steps),
        frozenset(constants), tuple(parts), reads.keys, reads.stored, reads.objects,
    )  # fmt: skip


def _parts(ctx: Interpreter, obj: Obj, overwritten: bool) -> list[Obj]:
    """Return the parts of an object that can hold data of their own.

    Parts without fields are left out, since they hold only data of the enclosing object. If such a part gets
    a field later, readers of the enclosing object are notified.
    """
    if not obj.subs:
        return []
    ctx.look(obj.subs.values())
    return [
        sub
        for name, sub in obj.subs.items()
        if (sub.fields or sub.subs or overwritten or not sub.laden)
        and sub is not obj
        and ctx.store.get((obj, name)) is None
    ]


def defined(ctx: Interpreter, obj: Obj) -> str:
    """Return the name of the definition of a message, which may be nested in another one; empty if unknown."""
    if obj.parent is None or not obj.whole.defined:
        return obj.whole.defined
    outer = FIELDS.get(defined(ctx, obj.parent), {})
    return outer.get(obj.name, "")


def replaced(ctx: Interpreter, obj: Obj, kind: str) -> bool:
    """Return whether this run has overwritten every field of a message, or of a copy of it."""
    fields = FIELDS.get(kind)
    if fields is not None:
        ctx.store.reads.look(obj)
    return fields is not None and all(
        heap.written_here(ctx, obj, name)
        or (inner != "" and name in obj.subs and replaced(ctx, obj.subs[name], inner))
        for name, inner in fields.items()
    )
