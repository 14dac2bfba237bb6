"""Resolve imports: analysed modules and their names, or else library names."""

from __future__ import annotations

from tarl_lint.interpret import expressions
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import heap
from tarl_lint.memory.values import BOTTOM, UNKNOWN, Obj, Value, pointer
from tarl_lint.models import objects
from tarl_lint.read.source import Module


def imported(ctx: Interpreter, module: str, member: str | None, importer: object) -> Value:
    """Return the value that an import binds: an analysed module or its name, or a library name."""
    assert isinstance(importer, Module)  # noqa: S101 - the callers pass modules
    found = _module(ctx, module, importer)
    if member is None:
        return found if found is not None else expressions.external(ctx, module)
    if found is not None:
        for obj in found.objects:
            value = ctx.store.get((obj, member))
            if value is None:
                value = heap.opened(ctx, obj, member)
            if value is not BOTTOM:
                return value
    inner = _module(ctx, f"{module}.{member}" if module else member, importer)
    if inner is not None:
        return inner
    return BOTTOM if found is not None else expressions.external(ctx, f"{module}.{member}")


def _module(ctx: Interpreter, name: str, importer: Module) -> Value | None:
    found = ctx.index.find(name, importer)
    if found is None:
        return None
    ctx.note_import(found, importer)
    program = ctx.by_path.get(found.path)
    return pointer(ctx.module_objects[program.name]) if program is not None else None


def default(ctx: Interpreter, obj: Obj, name: str) -> Value:
    """Return the value of an unset field; a field of a package may be a submodule."""
    value = objects.default(ctx, obj, name)
    if value is BOTTOM and obj.kind == "module":
        inner = ctx.module_objects.get(f"{obj.name}.{name}")
        return pointer(inner) if inner is not None else UNKNOWN
    return value
