"""Arguments that libraries fill: lists and arrays that are passed to a call whose result is not used."""

from __future__ import annotations

from tarl_lint.interpret import call_contexts
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments, Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import updates
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import Value
from tarl_lint.method_effects import only_tells, reads
from tarl_lint.models import arrays, containers, sizes


def fill(ctx: Interpreter, name: str, base: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> None:
    """Let a library call fill its arguments; `base` is the object whose method `name` is called.

    Empty lists have no other purpose in such a call: they receive the data of all arguments. Arrays that the program
    made without data receive the data of the other arguments, unless the name says that the call only uses them.
    Streams in memory receive them, too, unless the call reads from the stream.
    """
    plain, named = arguments
    by_place: dict[int | str, Value] = dict(enumerate(plain))
    by_place.update(named)
    for place, value in by_place.items():
        if not value.pts:
            continue
        if sizes.unpacked(ctx, value) == []:
            given = list(by_place.values())
        elif (arrays.is_array(value) and not only_tells(name)) or (_is_stream(value) and not reads(name)):
            given = [other for where, other in by_place.items() if where != place]
        else:
            continue
        news = Value(ctx.use(base) | call_contexts.all_used(ctx, (given, {})))
        if news.deps:
            updates.add_element(ctx, value, containers.through_statement(ctx, news, frame, call, place))


def _is_stream(value: Value) -> bool:
    """Return whether a value is a stream in memory, such as an `io.StringIO`."""
    return all(o.kind == "lib" and o.name.startswith(containers.IN_MEMORY) for o in value.pts)


def stream_itself(ctx: Interpreter, it: Invocation) -> Value:
    """Return the stream of `csv.writer(stream)`: what the writer gets is in the stream."""
    given = it.arguments[0]
    if given and given[0].pts and _is_stream(given[0]):
        return given[0]
    return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
