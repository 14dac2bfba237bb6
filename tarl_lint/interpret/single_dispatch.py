"""`functools.singledispatch`: the type of the first argument chooses the implementation. A type is not data."""

from __future__ import annotations

from collections.abc import Sequence

from tarl_lint.interpret.annotated import named_types, written
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.values import NO_CONSTANTS, NONE, Nodes, Obj, Value, closure_of, function_of, lineage

RECEIVERS = ("self", "cls")


def note(ctx: Interpreter, decorator: ir.Expr, given: Sequence[Value], made: Value) -> None:
    """Note the types for which a function is registered: the arguments of the decorator, or the annotation."""
    types = frozenset(_last(o.name) for value in given for o in value.pts)
    for obj in made.objects:
        function = function_of(obj)
        if function is not None and not isinstance(decorator, ir.Call):
            annotations = [one for name, one in written(function).items() if name not in RECEIVERS]
            types = frozenset(_last(name) for name in (named_types(annotations[0]) if annotations else ()))
        if types:
            ctx.dispatches[obj] = types


def chosen(ctx: Interpreter, targets: list[Obj], arguments: Arguments) -> list[Obj]:
    """Return the implementations that a call may run; all for an unknown argument type."""
    known = _types(ctx, arguments[0][0]) if arguments[0] else None
    return targets if known is None else for_types(ctx, targets, known)


def decides(ctx: Interpreter, targets: list[Obj], arguments: Arguments) -> Nodes:
    """Return the nodes that decide which implementation runs: those that chose the object passed as first argument."""
    registered = any(closure_of(one) in ctx.dispatches for one in targets)
    return arguments[0][0].deps if registered and arguments[0] and arguments[0][0].pts else NONE


def for_types(ctx: Interpreter, targets: list[Obj], known: Sequence[Sequence[str]]) -> list[Obj]:
    """Return the implementations for types; `known` lists each type with its base classes, nearest first."""
    registered = {one: types for one in targets if (types := ctx.dispatches.get(closure_of(one))) is not None}
    if not registered:
        return targets
    found: dict[Obj, None] = {}
    for names in known:
        fitting = (one for name in names for one in targets if name in registered.get(one, ()))
        first = next(fitting, None)
        found.update(
            dict.fromkeys([first] if first is not None else [t for t in targets if t not in registered])
        )
    return list(found) or targets


def _types(ctx: Interpreter, value: Value) -> list[list[str]] | None:
    """Return the possible type names, each with its base classes; None if unknown."""
    if not value.pts or value.consts not in (None, NO_CONSTANTS):
        return None
    ctx.look(value.pts)
    found: list[list[str]] = []
    for obj in value.objects:
        if obj.kind == "message" and obj.parent is None and obj.defined:
            found.append([obj.defined])
        elif obj.kind == "instance" and isinstance(obj.info, Obj):
            found.append([cls.name for cls in lineage(obj.info)])
        else:
            return None
    return found


def _last(name: str) -> str:
    return name.rpartition(".")[2]
