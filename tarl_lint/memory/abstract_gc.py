"""Drop a returning function's variables, and the objects that are no longer reachable.

Abstract garbage collection, after Might and Shivers (ICFP 2006): states stay small, and unreachable objects do not
take part in joins.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Set
from typing import Final

from tarl_lint.memory.frames import Frame
from tarl_lint.memory.reads import Reads
from tarl_lint.memory.shared import BORN
from tarl_lint.memory.store import Delta
from tarl_lint.memory.values import Obj, Value

# kinds of objects that may be dropped when a call ends
TEMPORARY: Final = frozenset(["lib", "sequence", "mapping"])


def lasting(delta: Delta, frame: Frame, returned: Iterable[Obj], given: Set[Obj], reads: Reads) -> Delta:
    """Return the changes of a frame that are visible after it returns.

    `returned` are the objects that the frame returns, yields or raises; `given` are arguments of roots. Both stay
    reachable. The variables of the frame stay only if a reachable function is defined inside it.
    """
    local = {owner for owner, name in delta if name == BORN and owner.kind in TEMPORARY}
    if frame.captured:
        local.add(frame)
    elif not local:
        return {k: v for k, v in delta.items() if k[0] is not frame}
    kept: Delta = {}
    inside: dict[Obj, list[frozenset[Obj]]] = {}
    pending = [*returned, *(local & given)]
    followed: set[frozenset[Obj]] = set()  # points-to sets followed already; many values share one set
    for key, value in delta.items():
        owner = key[0]
        if owner is frame and not frame.captured:
            continue
        kept[key] = value
        root = owner.outermost or owner
        pts = value.pts
        if not pts:
            continue
        if root in local:
            inside.setdefault(root, []).append(pts)
        elif pts not in followed:
            followed.add(pts)
            pending += pts
    gone = local - _reached(pending, inside, followed)
    if not gone:
        return kept
    reads.ask(given.isdisjoint, frozenset(gone))
    return {k: v for k, v in kept.items() if (k[0].outermost or k[0]) not in gone}


def _reached(
    pending: list[Obj], inside: Mapping[Obj, list[frozenset[Obj]]], followed: set[frozenset[Obj]]
) -> set[Obj]:
    """Return the outermost objects that the given ones reach through fields and definitions."""
    seen: set[Obj] = set()
    while pending:
        obj = pending.pop()
        root = obj.outermost or obj
        if root not in seen:
            seen.add(root)
            for pts in inside.get(root, ()):
                if pts not in followed:
                    followed.add(pts)
                    pending += pts
            pending += _beyond(root)
    return seen


def together(objects: Iterable[Obj]) -> Set[Obj]:
    """Return the outermost objects that contain the given ones, and the objects to which their definitions refer."""
    found: set[Obj] = set()
    pending = [*objects]
    while pending:
        obj = pending.pop().whole
        if obj not in found:
            found.add(obj)
            pending += _beyond(obj)
    return found


def _beyond(obj: Obj) -> Iterator[Obj]:
    """Yield the objects to which an object refers outside its fields; a frame refers to the enclosing frame."""
    if obj.info is not None:
        yield from _about(obj.info)
    if isinstance(obj, Frame) and obj.outer is not None:
        yield obj.outer


def _about(info: object) -> Iterator[Obj]:
    """Yield the objects that an object's definition refers to, such as the receiver of a bound method."""
    if isinstance(info, Obj):
        yield info
    elif isinstance(info, Value):
        yield from info.pts
    elif isinstance(info, (tuple, list)):
        for part in info:
            yield from _about(part)
    elif isinstance(info, dict):
        for part in info.values():
            yield from _about(part)
