"""Arguments that libraries fill: streams, and containers passed to a call without used result."""

from __future__ import annotations

from collections.abc import Sequence

from tarl_lint.interpret import call_contexts
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments, Invocation
from tarl_lint.memory import updates
from tarl_lint.memory.heap import STREAM
from tarl_lint.memory.values import Value, join_all
from tarl_lint.method_effects import only_tells, reads, writes
from tarl_lint.models import arrays, containers, sizes


def fill(ctx: Interpreter, it: Invocation, *, dropped: bool) -> None:
    """Let a library call fill its arguments; `dropped` means that the result of the call is not used.

    Empty lists have no other purpose in such a call: they receive the data of all arguments. Arrays that the program
    made without data receive the data of the other arguments, unless the name says that the call only uses them.
    Streams in memory receive them, too, unless the call reads from the stream.
    """
    plain, named = it.arguments
    by_place: dict[int | str, Value] = dict(enumerate(plain))
    by_place.update(named)
    for place, value in by_place.items():
        if not value.pts:
            continue
        others = [other for where, other in by_place.items() if where != place]
        if dropped and sizes.unpacked(ctx, value) == []:
            _receive(ctx, value, [*others, value], it, place)
        elif dropped and arrays.is_array(value) and not only_tells(it.name):
            _receive(ctx, value, others, it, place)
        elif (writes(it.name) or (dropped and not reads(it.name))) and (stream := _stream(ctx, value)).pts:
            _receive(ctx, stream, others, it, place)


def pass_on(ctx: Interpreter, it: Invocation) -> None:
    """Let a writer into a memory stream, such as a `ZipFile`, pass on its method's data."""
    streams = join_all(held for obj in it.base.objects if (held := ctx.store.get((obj, STREAM))) is not None)
    if streams.pts and not reads(it.name):
        news = Value(call_contexts.all_used(ctx, it.arguments))
        if news.deps:
            passed = containers.through_statement(ctx, news, it.frame, it.call, "stream")
            updates.add_element(ctx, streams, passed)


def note_streams(ctx: Interpreter, made: Value, arguments: Arguments) -> None:
    """Record the streams in memory that a new object of a library got."""
    streams = join_all(_stream(ctx, value) for value in (*arguments[0], *arguments[1].values()) if value.pts)
    for obj in made.objects if streams.pts else ():
        ctx.store.put((obj, STREAM), streams)


def writes_itself(ctx: Interpreter, it: Invocation) -> bool:
    """Return whether `obj.write(stream)` writes an object that is no stream itself into a stream in memory."""
    into = it.name == "write" and any(_stream(ctx, value).pts for value in it.arguments[0])
    return into and not _is_stream(it.base)


def _receive(
    ctx: Interpreter, value: Value, given: Sequence[Value], it: Invocation, place: int | str
) -> None:
    news = Value(ctx.use(it.base) | call_contexts.all_used(ctx, (list(given), {})))
    if news.deps:
        updates.add_element(ctx, value, containers.through_statement(ctx, news, it.frame, it.call, place))


def _stream(ctx: Interpreter, value: Value) -> Value:
    """Return the streams in memory that an object is, or into which it writes."""
    if _is_stream(value):
        return value
    held = (ctx.store.get((obj, STREAM)) for obj in value.objects if obj.kind == "lib")
    return join_all(one for one in held if one is not None)


def _is_stream(value: Value) -> bool:
    """Return whether a value is a stream in memory, such as an `io.StringIO`."""
    return bool(value.pts) and all(
        o.kind == "lib" and o.name.startswith(containers.IN_MEMORY) for o in value.pts
    )


def stream_itself(ctx: Interpreter, it: Invocation) -> Value:
    """Return the stream of `csv.writer(stream)`: data that the writer gets is in the stream."""
    given = it.arguments[0]
    if given and _is_stream(given[0]):
        return given[0]
    return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
