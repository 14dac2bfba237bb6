"""Numbers that are fixed when a node starts: read from a file or the environment, or computed from constants.

Flows do not need these numbers. A thorough run records them, so that a repair can change them like constants.
"""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret import call_contexts
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.constant_expressions import computed, numbers
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import Value

LOADERS: Final = frozenset(
    [
        *(f"yaml.{name}" for name in ("load", "safe_load", "full_load", "unsafe_load")),
        *(f"{module}.{name}" for module in ("json", "toml", "tomli", "tomllib") for name in ("load", "loads")),
        "rosparam.load_file", "os.getenv", "os.environ.get",
    ]
)  # fmt: skip
COMPUTING: Final = frozenset(
    [
        "float", "int", "abs", "round", "pow", "min", "max", "sum", "numpy.deg2rad", "numpy.radians", "numpy.rad2deg",
        "numpy.degrees", "numpy.sqrt", "numpy.abs", "numpy.sin", "numpy.cos", "numpy.tan", "numpy.float64",
    ]
)  # fmt: skip
ARRAYS: Final = frozenset(["numpy.array", "numpy.asarray"])


def noted(
    ctx: Interpreter, qualified: str, found: Value, arguments: Arguments, frame: Frame, call: ir.Call
) -> Value:
    """Return a library function's result; a fixed number gets a node."""
    if not ctx.thorough:
        return found
    name = qualified.removeprefix("builtins.")
    if name in LOADERS and ctx.graph.live.isdisjoint(call_contexts.all_used(ctx, arguments)):
        return loaded(ctx, found, frame, call)
    if name in ARRAYS and computed(call) and numbers(call):
        return loaded(ctx, found, frame, call)
    # `float` passes on a loaded value instead of computing a new one
    fixed = not found.deps or (name != "float" and _are_loaded(ctx, found))
    if (name in COMPUTING or name.startswith("math.")) and fixed and (pos := computed(call)):
        ctx.unchanged.add(call)
        node = ctx.node(frame, ("fixed", call.slot), "assign")
        ctx.graph.literals[node] = (None, pos, frame.program.path)
        return Value(frozenset([node]), found.pts, found.consts)
    return found


def _are_loaded(ctx: Interpreter, found: Value) -> bool:
    """Return whether a value depends only on loaded values."""
    return all(ctx.graph.literals.get(node, (0,))[0] is None for node in found.deps)


def loaded(ctx: Interpreter, found: Value, frame: Frame, call: ir.Call) -> Value:
    """Return a loaded value, which is an unknown constant or an object made of unknown constants."""
    ctx.unchanged.add(call)
    for obj in found.objects:
        ctx.settings[obj] = (frame.program.path, call.pos)
    if found.pts:
        return Value(pts=found.pts)
    node = ctx.node(frame, ("settings", call.slot), "assign")
    ctx.graph.literals[node] = (None, call.pos, frame.program.path)
    return Value(frozenset([node]))
