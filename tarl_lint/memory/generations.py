"""Chains of instances, each made by a method of the previous one, and chains of closures.

A method has a separate context for each receiver, and each context makes objects of its own. Suppose a callback
replaces an object with a new one that a method of the object makes. Without a limit, the analysis would then make
new abstract objects for ever. The same holds for closures that make closures, as in `self.state = self.state(msg)`.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import Obj, in_order

# maximum number of objects of one site in a chain; the last object represents all further ones
MAX_ALIKE: Final = 3
# maximum number of closures in a chain; each closure is made while the previous one runs
MAX_CLOSURES: Final = 4

# an object's allocation site and the object, from the oldest maker to the object itself
Chain = tuple[tuple[Hashable, Obj], ...]


def last_of_line(ctx: Interpreter, site: Hashable, frame: Frame) -> Obj | None:
    """Return the object that represents all of a site if its chain of makers is too long, else None."""
    alike = [obj for known, obj in _makers(ctx, frame) if known == site]
    if len(alike) < MAX_ALIKE:
        return None
    recency.one_of_many(ctx, alike[-1])
    return alike[-1]


def note(ctx: Interpreter, obj: Obj, site: Hashable, frame: Frame) -> None:
    """Record which objects' methods made an instance."""
    if obj not in ctx.chains:
        ctx.chains[obj] = (*_makers(ctx, frame), (site, obj))


def site_of(cls: Obj, frame: Frame, call: ir.Call) -> Hashable:
    """Return the place in the code at which instances are made, without its call context."""
    return frame.function, frame.statement, call.slot, cls.key


def _makers(ctx: Interpreter, frame: Frame) -> Chain:
    """Return the longest chain of the receivers of the methods that are running."""
    receivers = (obj for _, made in _running(frame) if isinstance(made, frozenset) for obj in in_order(made))
    return max((ctx.chains.get(obj, ()) for obj in receivers), key=len, default=())


def note_closure(ctx: Interpreter, closure: Obj, function: ir.Function, frame: Frame) -> None:
    """Record which closures were running when a closure was made."""
    if frame.caller is not None and closure.key not in ctx.closure_chains:
        ctx.closure_chains[closure.key] = (*_closures(ctx, frame), function)


def too_many_closures(ctx: Interpreter, frame: Frame) -> bool:
    """Return whether the calls of a frame may make closures for ever; they then have to share their contexts."""
    running = _closures(ctx, frame)
    return len(running) > MAX_CLOSURES or len(set(running)) < len(running)


def _closures(ctx: Interpreter, frame: Frame) -> tuple[ir.Function, ...]:
    """Return the longest chain of the closures that are running."""
    return max((ctx.closure_chains.get(key, ()) for key, _ in _running(frame)), key=len, default=())


def _running(frame: Frame) -> Iterator[tuple[Hashable, Hashable]]:
    """Yield the key of the closure and the receivers of each running call, innermost first."""
    inner: Frame | None = frame
    while inner is not None:
        if isinstance(inner.key, tuple) and len(inner.key) > 4:
            yield inner.key[3], inner.key[4]
        inner = inner.caller
