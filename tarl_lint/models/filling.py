"""Arguments that libraries fill: lists and arrays that are passed to a call whose result is not used."""

from __future__ import annotations

from tarl_lint.interpret import call_contexts
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import Value
from tarl_lint.method_effects import fills_arrays
from tarl_lint.models import arrays, containers, sizes


def fill(ctx: Interpreter, name: str, base: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> None:
    """Let a library call fill its arguments; `base` is the object whose method `name` is called.

    Empty lists have no other purpose in such a call. Arrays that the program made without data are filled unless the
    name says that the call only uses its arguments.
    """
    deps = ctx.use(base) | call_contexts.all_used(ctx, arguments)
    if not deps:
        return
    plain, named = arguments
    for value in (*plain, *named.values()):
        if value.pts and sizes.unpacked(ctx, value) == []:
            containers.insert_elements(ctx, value, [Value(deps)], frame, call)
    for number, value in enumerate(plain) if fills_arrays(name) else ():
        if arrays.is_array(value):
            others = (plain[:number] + plain[number + 1 :], named)
            news = Value(ctx.use(base) | call_contexts.all_used(ctx, others))
            if news.deps:
                news = containers.through_statement(ctx, news, frame, call, number)
                containers.change(ctx, value, news, call.arguments[number:], frame)
