"""What is to run on its own, and what one that waits sees of the others."""

from __future__ import annotations

from collections.abc import Callable

from tarl_lint.interpret.budget import EXCHANGED
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.store import Root
from tarl_lint.memory.values import ABSENT


def add_root(ctx: Interpreter, root: Root, run: Callable[[Root], None], *, news: bool = False) -> None:
    """Have something run on its own; seen again, only if its arguments are news."""
    root = ctx.roots.get(root.key, (root,))[0]
    if root.key not in ctx.roots:
        root.number = len(ctx.roots)
        news = True
    if news:
        ctx.pending[root] = None
    ctx.roots[root.key] = (root, run)


def wait(ctx: Interpreter, frame: Frame) -> None:  # noqa: ARG001 - one signature for all
    """Let other roots see what was stored, and store what they may."""
    store, root = ctx.store, ctx.store.root
    own = store.own()
    ctx.spent += len(own) // EXCHANGED
    store.waited = True
    for key in own:
        value = store.now[key]
        if value is not ABSENT and store.exchanged.get(key) is not value:
            store.exchanged[key] = value
            mine = store.mine(key, value)
            if mine is not None:
                ctx.shared.leave(ctx.shared.pauses, root, key, mine)
        news = store.others(key) if key in root.heeds else None
        if news is not None:
            former = ctx.ops.default(ctx, *key) if value is ABSENT else value  # a field of a new object
            both = store.admit(key, former, news)
            if both is not value:
                store.put(key, both)


def root_frame(ctx: Interpreter, root: Root) -> Frame:
    """Return the frame that stands for ROS itself, calling."""
    key = ("root", root.key)
    frame = ctx.frames.get(key)
    if frame is None:
        program = next(iter(ctx.programs.values()))
        frame = Frame(key, len(ctx.frames) + 1, program.function, program, ctx.module_objects[program.name])
        ctx.frames[key] = frame
    frame.root_waits = root.once
    return frame
