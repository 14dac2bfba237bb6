"""Tags among arguments: if several parameters get parts of one object, a test narrows all of them together.

In `handle(*job)` and `handle(job.kind, job.value)`, a test of the first parameter also narrows the second one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tarl_lint.interpret import call_contexts, tags
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.interpret.tag_tests import of_variable
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import REST, Frame, Origin, Taken
from tarl_lint.memory.values import Value, const
from tarl_lint.models import sizes


def origins(ctx: Interpreter, caller: Frame, call: ir.Call, passed: Arguments) -> tuple[Origin, ...]:
    """Return the arguments that are one of several objects, or a part of one of several objects."""
    written = call_contexts.written(call, passed[0])
    found = [*_positional(ctx, caller, call, written), *_named(ctx, caller, call)]
    if (mapping := passed[1].get("**")) is not None and tags.several(mapping):
        found.append(("**", mapping, None))
    return (*found, *_before(found, caller))


def _before(found: Sequence[Origin], caller: Frame) -> Iterator[Origin]:
    """Yield where the objects came from, without a place.

    A replayed call depends on this, too.
    """
    for _, value, _ in found:
        place: Frame | None = caller
        while place is not None and (whole := tags.whole_of(value, place)) is not None:
            place, _, taken = whole
            place, value = taken.frame or place, taken.before
            yield "", value, None


def note(ctx: Interpreter, frame: Frame, given: Sequence[Origin]) -> None:
    """Record where the parameters got their values, after they are bound."""
    places = {place: (before, field) for place, before, field in given}
    taken_by_name = {place for place, _, _ in given if isinstance(place, str)}
    everything = places.get("**")
    for number, parameter in enumerate(frame.function.parameters):
        if parameter.kind == "star" and number in places:
            _note_rest(ctx, frame, parameter.name, number, *places[number])
        if parameter.kind in ("star", "mapping"):
            continue
        place: int | str = number if parameter.kind == "plain" and number in places else parameter.name
        origin = places.get(place)
        if origin is None and everything is not None and parameter.name not in taken_by_name:
            origin = everything[0], const(parameter.name)
        key = (frame, parameter.name)
        now = ctx.store.get(key)
        if origin is None or now is None or frame.caller is None or frame.caller.statement is None:
            continue
        slot = f"argument {frame.slot} {place}"
        tags.keep(
            frame, key, Taken(now, origin[0], frame.caller.statement, slot, origin[1], None, frame.caller)
        )


def _note_rest(
    ctx: Interpreter, frame: Frame, name: str, number: int, whole: Value, field: str | Value | None
) -> None:
    """Give a parameter `*rest` one sequence for each of the objects whose last elements it gets."""
    first = field.constant()[1] if isinstance(field, Value) else None
    caller, ways = frame.caller, sizes.each_unpacked(ctx, whole)
    if not isinstance(first, int) or caller is None or caller.statement is None or not ways:
        return
    parts = {
        obj: [
            ctx.carry(value, ctx.node(caller, ("argument", frame.slot, place, obj.number), "call"))
            for place, value in enumerate(way[first:], number)
        ]
        for obj, way in ways.items()
    }
    value = sizes.rests(ctx, parts, frame, ("passed", name))
    ctx.store.put((frame, name), value)
    slot = f"argument {frame.slot} {number}"
    tags.keep(frame, (frame, name), Taken(value, whole, caller.statement, slot, REST, None, caller))


def _positional(
    ctx: Interpreter, caller: Frame, call: ir.Call, written: Sequence[ir.Expr | None]
) -> Iterator[Origin]:
    first = next((n for n, expr in enumerate(written) if isinstance(expr, ir.Starred)), 0)
    for number, expr in enumerate(written):
        if isinstance(expr, ir.Starred):
            if (whole := caller.spread.get(call.slot)) is not None:
                yield number, whole, const(number - first)
        elif expr is not None and (origin := _origin(ctx, expr, caller)) is not None:
            yield number, *origin


def _named(ctx: Interpreter, caller: Frame, call: ir.Call) -> Iterator[Origin]:
    for name, expr in call.keywords:
        if name is not None and (origin := _origin(ctx, expr, caller)) is not None:
            yield name, *origin


def _origin(ctx: Interpreter, expr: ir.Expr, caller: Frame) -> tuple[Value, str | Value | None] | None:
    """Return an argument's containing objects, and its attribute or index; None if unknown."""
    if isinstance(expr, ir.Name):
        key = tags.key_of(expr, caller)
        taken = tags.taken_from(ctx, key, caller)
        if taken is not None and taken.field is not None:
            return taken.before, taken.field
        whole, field = ctx.store.get(key), None
    elif (of := of_variable(expr)) is not None:
        whole, field = ctx.store.get(tags.key_of(of[0], caller)), of[1]
    else:
        return None
    return (whole, field) if whole is not None and tags.several(whole) else None
