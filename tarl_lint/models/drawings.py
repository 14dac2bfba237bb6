"""Drawings of matplotlib: what is drawn into a part is also in the figure and its image.

Axes, lines and canvases refer to their figure, and the functions of `pyplot` to the current one. One object
therefore represents all of them, even if a program has several figures. Each program that is run has its own
object, because programs are separate processes. Drawings of other modules are represented by one object that all
programs share.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Final

from tarl_lint.interpret import call_contexts
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments, Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import Obj, Value
from tarl_lint.models import containers

PYPLOT: Final = frozenset(["matplotlib.pyplot", "matplotlib.pylab", "pylab"])
FIGURE: Final = ("Figure", "FigureCanvas")  # prefixes of the names of classes that draw
PLAIN: Final = frozenset(["get_cmap", "imread", "rc"])  # functions of pyplot that do not draw
SAVING: Final = frozenset(["savefig", "print_png", "print_figure", "print_raw", "print_rgba", "print_jpg"])
KEY: Final = ("drawing",)
DRAWS: Final = re.compile(
    r"(?:vis|visuali[sz]e|plot|draw|show)(?:_|[A-Z]|$)|\w+plot$"
)  # names of functions that draw
OTHER_WINDOWS: Final = frozenset(
    ["cv2", "PIL", "open3d", "pygame", "tkinter", "turtle"]
)  # functions that draw without matplotlib
RUN: Final = "__main__"  # a file that is run as a program contains this text


def drawn(
    ctx: Interpreter, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call
) -> Value | None:
    """Return the drawing after a call of a function that draws or makes a figure; None for other functions."""
    module, _, name = qualified.rpartition(".")
    draws = module in PYPLOT and name not in PLAIN and not name[:1].isupper()
    if not draws and not (module.startswith("matplotlib.") and name.startswith(FIGURE)):
        return None
    return _changed(ctx, Value(pts=_of_program(ctx)), arguments, frame, call)


def is_drawing(obj: Obj) -> bool:
    """Return whether an object is a drawing, or a part of one."""
    key = obj.whole.key
    return isinstance(key, tuple) and key[:1] == KEY


def _of_program(ctx: Interpreter) -> frozenset[Obj]:
    """Return the drawing of the current program, and the drawing of modules that several programs import."""
    module = ctx.modules.get(ctx.program)
    runs = module is not None and module.contains(RUN)
    own = recency.intern(ctx, "lib", (*KEY, ctx.program if runs else ""), "matplotlib")
    own.many = True
    shared = ctx.objects.get(("lib", (*KEY, "")), own)
    return frozenset((own, shared))


def drawn_into(
    ctx: Interpreter, base: Value, arguments: Arguments, frame: Frame, call: ir.Call
) -> Value | None:
    """Return the drawing after a call of a method of a part of the drawing; None for other objects."""
    if not base.pts or not all(map(is_drawing, base.pts)):
        return None
    return _changed(ctx, Value(base.deps, _wholes(base.pts)), arguments, frame, call)


def pass_to_function(ctx: Interpreter, it: Invocation, *, unused: bool) -> None:
    """Draw data that a library's function draws into the axes that it gets, or into the current figure.

    Examples are `show(image, ax=axes)` and `vis_image(image)`. A function that gets no axes is assumed to draw if
    its name says so, its result is unused, and the module imports `pyplot`.
    """
    given = [*it.arguments[0], *it.arguments[1].values()]
    wholes = _wholes(o for v in given for o in v.pts if is_drawing(o))
    if not wholes and unused and _draws(ctx, it):
        wholes = _of_program(ctx)
    if not wholes:
        return
    others = [v for v in given if not any(map(is_drawing, v.pts))]
    learnt = Value(call_contexts.all_used(ctx, (others, {})))
    if learnt.deps:
        containers.insert_elements(ctx, Value(pts=wholes), [learnt], it.frame, it.call)


def _draws(ctx: Interpreter, it: Invocation) -> bool:
    if DRAWS.match(it.name.rpartition(".")[2]) is None or it.name.partition(".")[0] in OTHER_WINDOWS:
        return False
    return ctx.modules[it.frame.program.path].contains("pyplot")


def _wholes(parts: Iterable[Obj]) -> frozenset[Obj]:
    return frozenset(part.whole for part in parts)


def _changed(ctx: Interpreter, base: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
    """Draw the arguments; if the call writes into buffers, store the drawing into these."""
    inside = ctx.use(Value(pts=base.pts))
    if isinstance(call.function, ir.Attribute) and call.function.name in SAVING:
        for value, expr in zip(arguments[0][:1], call.arguments[:1], strict=False):
            news = containers.through_statement(ctx, Value(inside), frame, call)
            containers.change(ctx, value, news, [expr], frame)
        return base
    if arguments[0] or arguments[1]:  # constants count too, because data can decide whether they are drawn
        learnt = Value(call_contexts.all_used(ctx, arguments))
        containers.insert_elements(ctx, Value(pts=base.pts), [learnt], frame, call)
    return base
