"""Compare the state with recorded reads."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import islice

from tarl_lint.memory.reads import NEW, Reads
from tarl_lint.memory.store import Store
from tarl_lint.memory.value_flow_graph import Graph
from tarl_lint.memory.values import ABSENT, DATA, Key, Obj, Value


def unchanged(
    reads: Reads, found: Mapping[Key, Value | None], stored: Mapping[Key, bool], store: Store, graph: Graph
) -> bool:
    """Return whether all recorded reads would give the same results now: the values `found` and the flags `stored`."""
    if not (reads.unreached.isdisjoint(graph.live) and reads.single.isdisjoint(store.shared.several)):
        return False
    current, waited = store.now, store.waited
    for key, value in found.items():
        now = current.get(key)
        if now is None or waited or now is ABSENT:
            now = store.peek(key)
        if now is not value and now != value:
            return False
    for key, there in stored.items():
        if (key in current) is not there:
            return False
    if reads.held and not graph.as_passed(reads.held):
        return False
    for (question, of), answer in reads.facts.items():
        if question(of) != answer:
            return False
    if reads.holders and any(_held(obj, store, places) for obj, places in reads.holders.items()):
        return False
    changed = ((obj, stamp) for obj, stamp in reads.objects.items() if obj.stamp != stamp)
    if reads.waits:  # other roots may store to the new fields during the wait
        return next(changed, None) is None
    return all(_as_it_was(obj, stamp, store) for obj, stamp in changed)


def _as_it_was(obj: Obj, stamp: int, store: Store) -> bool:
    """Return whether all changes of an object since a stamp are invisible in the current state.

    Fields that the call itself added are visible only if another run left them in the shared memory.
    """
    if stamp == NEW:  # the call allocated the object, which clears all its fields
        return _empty(obj, store) and not _held(obj, store)
    return all(_unseen(obj, what, store) for what in obj.changes[stamp:])


def _unseen(obj: Obj, change: str | Obj | None, store: Store) -> bool:
    """Return whether a change of an object is not visible in the current state."""
    if change is None:
        return False
    if isinstance(change, Obj):  # a read of the elements covers all of them, even those without content
        return not change.name.startswith("[") and _empty(change, store)
    return not _data(obj, store) if change == DATA else store.peek((obj, change)) is None


def _empty(obj: Obj, store: Store) -> bool:
    """Return whether no field of an object or of its parts is set."""
    return all(store.peek((obj, name)) is None for name in obj.fields) and all(
        part is obj or _empty(part, store) for part in obj.subs.values()
    )


def _data(obj: Obj, store: Store) -> bool:
    """Return whether an object may hold data in the current state; parts with any field count as data."""
    outer: Obj | None = obj.parent
    while outer is not None:
        if store.peek((outer, "*")) is not None:
            return True
        outer = outer.parent
    values = [store.peek((obj, name)) for name in obj.fields]
    if any(v is not None and (v.deps or any(o.laden for o in v.pts)) for v in values):
        return True
    return not all(part is obj or _empty(part, store) for part in obj.subs.values())


def _held(obj: Obj, store: Store, beyond: int = 0) -> bool:
    """Return whether a key points to `obj` now; skip the first `beyond` keys that ever did."""
    values = (store.peek(key) for key in islice(obj.holders, beyond, None))
    return any(value is not None and obj in value.pts for value in values)
