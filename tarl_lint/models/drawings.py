"""Drawings of matplotlib: whatever is drawn into a part of a figure is also in the figure and in its image.

Axes, lines and canvases refer to their figure, and the functions of `pyplot` to the current one. All of them are
therefore one object, even where a program has several figures.
"""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret import call_contexts
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import Obj, Value, pointer
from tarl_lint.models import containers

PYPLOT: Final = frozenset(["matplotlib.pyplot", "matplotlib.pylab", "pylab"])
FIGURE: Final = ("Figure", "FigureCanvas")  # prefixes of class names
PLAIN: Final = frozenset(["get_cmap", "imread", "rc"])  # functions of pyplot that do not draw
SAVING: Final = frozenset(["savefig", "print_png", "print_figure", "print_raw", "print_rgba", "print_jpg"])
KEY: Final = ("drawing",)


def drawn(
    ctx: Interpreter, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call
) -> Value | None:
    """Return the drawing after a call of a function that draws or makes a figure; None for other functions."""
    module, _, name = qualified.rpartition(".")
    draws = module in PYPLOT and name not in PLAIN and not name[:1].isupper()
    if not draws and not (module.startswith("matplotlib.") and name.startswith(FIGURE)):
        return None
    obj = recency.intern(ctx, "lib", KEY, "matplotlib")
    obj.many = True
    return _changed(ctx, obj, pointer(obj), arguments, frame, call)


def is_drawing(obj: Obj) -> bool:
    """Return whether an object is a drawing, or a part of one."""
    return obj.whole.key == KEY


def drawn_into(
    ctx: Interpreter, base: Value, arguments: Arguments, frame: Frame, call: ir.Call
) -> Value | None:
    """Return the drawing after a call of a method of one of its parts; None for other objects."""
    whole = next((o.whole for o in base.pts if is_drawing(o)), None)
    if whole is None or not all(map(is_drawing, base.pts)):
        return None
    return _changed(ctx, whole, Value(base.deps, frozenset([whole])), arguments, frame, call)


def pass_to_function(ctx: Interpreter, arguments: Arguments, frame: Frame, call: ir.Call) -> None:
    """Draw data into a drawing that a library's function gets with the data, such as `show(image, ax=axes)`."""
    if ("lib", KEY) not in ctx.objects:
        return
    given = [*arguments[0], *arguments[1].values()]
    whole = next((o.whole for v in given for o in v.pts if is_drawing(o)), None)
    if whole is None:
        return
    others = [v for v in given if not any(map(is_drawing, v.pts))]
    learnt = Value(call_contexts.all_used(ctx, (others, {})))
    if learnt.deps:
        containers.insert_elements(ctx, pointer(whole), [learnt], frame, call)


def _changed(
    ctx: Interpreter, obj: Obj, base: Value, arguments: Arguments, frame: Frame, call: ir.Call
) -> Value:
    """Draw the arguments, and store the drawing into buffers that are written."""
    inside = ctx.use(pointer(obj))
    if isinstance(call.function, ir.Attribute) and call.function.name in SAVING:
        for value, expr in zip(arguments[0][:1], call.arguments[:1], strict=False):
            news = containers.through_statement(ctx, Value(inside), frame, call)
            containers.change(ctx, value, news, [expr], frame)
        return base
    if arguments[0] or arguments[1]:  # constants count too, because data can decide whether they are drawn
        learnt = Value(call_contexts.all_used(ctx, arguments))
        containers.insert_elements(ctx, pointer(obj), [learnt], frame, call)
    return base
