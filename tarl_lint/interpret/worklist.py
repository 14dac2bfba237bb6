"""The worklist of roots, and the exchange of values between them at waits."""

from __future__ import annotations

from collections.abc import Callable, Set

from tarl_lint.interpret.budget import VALUES_PER_STATEMENT
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.shared import Root
from tarl_lint.memory.store import private
from tarl_lint.memory.values import ABSENT, Key


def add_root(ctx: Interpreter, root: Root, run: Callable[[Root], None], *, news: bool = False) -> None:
    """Queue a root; re-queue a known one only if its arguments changed."""
    root = ctx.roots.get(root.key, (root,))[0]
    if root.key not in ctx.roots:
        root.number = len(ctx.roots)
        news = True
    if news:
        ctx.pending[root] = None
    ctx.roots[root.key] = (root, run)


def wait(ctx: Interpreter, frame: Frame) -> None:  # noqa: ARG001 - shared signature
    """Exchange stored values with other roots, at a wait."""
    store, heeds = ctx.store, ctx.store.root.heeds
    reads = store.reads
    reads.wait(len(store.heard()))
    reads.keys.update((heeds & store.now.keys()) - reads.written)
    changed = show(ctx)
    ctx.work.spent += len(changed) // VALUES_PER_STATEMENT
    for key in changed:
        news = store.others(key) if key in heeds else None
        if news is None:
            continue
        value = store.now[key]
        # a field of a new object has its default value until it is set
        former = ctx.ops.default(ctx, *key) if value is ABSENT else value
        both = store.admit(key, former, news)
        if both is not value:
            store.put(key, both)
            store.exchanged[key] = both


def show(ctx: Interpreter, but: Set[Key] = frozenset()) -> list[Key]:
    """Publish the stores made since the last wait to other roots; return their keys."""
    store, root, exchanged = ctx.store, ctx.store.root, ctx.store.exchanged
    store.waited = True
    changed = [
        key for key, value in store.now.items() if exchanged.get(key) is not value and not private(key)
    ]
    changed = [key for key in changed if key not in but] if but else changed
    for key in changed:
        value = exchanged[key] = store.now[key]
        mine = store.mine(key, value) if value is not ABSENT else None
        if mine is not None:
            ctx.shared.leave(ctx.shared.pauses, root, key, mine)
    return changed


def root_frame(ctx: Interpreter, root: Root) -> Frame:
    """Return the frame that represents ROS as the caller."""
    key = ("root", root.key)
    frame = ctx.frames.get(key)
    if frame is None:
        program = next(iter(ctx.programs.values()))
        frame = Frame(key, len(ctx.frames) + 1, program.function, program, ctx.module_objects[program.name])
        ctx.frames[key] = frame
    frame.root_waits = root.once
    return frame
