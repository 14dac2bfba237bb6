"""Builtins that ask for the type of an object: `isinstance`, `callable`, `hasattr`. A type is not data."""

from __future__ import annotations

from collections import deque
from types import FunctionType, GeneratorType, MethodType

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import function_attributes, heap, namespaces
from tarl_lint.memory.message_types import MESSAGE_MODULE
from tarl_lint.memory.values import (
    BOTTOM,
    NO_CONSTANTS,
    UNKNOWN,
    ClassInfo,
    Obj,
    Value,
    const,
    function_of,
    lineage,
    pointer,
)
from tarl_lint.models import sizes

# kind of objects of Python's own and of ROS → names of their attributes
BUILT_IN = {
    "sequence": frozenset(name for kind in (list, tuple, set, deque, GeneratorType) for name in dir(kind)),
    "mapping": frozenset(dir(dict)),
    "publisher": frozenset(["publish", "get_num_connections", "unregister", "topic", "topic_name", "name"]),
}
SPECIAL = frozenset([*dir(FunctionType), *dir(MethodType)])  # attributes of all functions and methods
NOT_CALLABLE = frozenset(["sequence", "mapping", "message", "publisher"])


def is_instance(ctx: Interpreter, it: Invocation) -> Value:
    """Return whether an object is an instance of analysed classes, or a message of given types; else unknown."""
    given = it.arguments[0]
    if len(given) != 2:
        return UNKNOWN
    named = [one for part in sizes.unpacked(ctx, given[1]) or [given[1]] for one in part.objects]
    if named and all(one.kind == "class" for one in named):
        return _of_classes(given[0], frozenset(named))
    if [one.name for one in named] == ["builtins.str"] and (known := _is_text(given[0])) is not None:
        return const(value=known)
    if not named or not all(one.kind == "ext" and MESSAGE_MODULE in one.name for one in named):
        # the class may be a base class of all messages
        return UNKNOWN
    ctx.look(given[0].pts)
    received = {
        one.defined if one.kind == "message" and one.parent is None else "" for one in given[0].objects
    }
    if not received or "" in received:
        return UNKNOWN
    types = {one.name.rpartition(".")[2] for one in named}
    found = {one in types for one in received}
    return const(found.pop()) if len(found) == 1 else UNKNOWN


def _is_text(value: Value) -> bool | None:
    """Return whether a value is a text; None if that is not known."""
    constants = value.keys()
    if constants is None or any(o.kind not in ("sequence", "mapping") for o in value.pts):
        return None
    found = {isinstance(one, str) for one in constants} | ({False} if value.pts else set())
    return found.pop() if len(found) == 1 else None


def _of_classes(value: Value, classes: frozenset[Obj]) -> Value:
    """Return whether instances of some analysed classes are instances of other classes."""
    if value.consts != NO_CONSTANTS or not value.pts or any(o.kind != "instance" for o in value.pts):
        return UNKNOWN
    kinds = [o.info for o in value.pts if isinstance(o.info, Obj)]
    found = {not classes.isdisjoint(lineage(kind)) for kind in kinds}
    return const(found.pop()) if len(found) == 1 and len(kinds) == len(value.pts) else UNKNOWN


def is_callable(ctx: Interpreter, it: Invocation) -> Value:
    """Return False for numbers, containers and instances without `__call__`; other objects may be callable."""
    value = it.arguments[0][0] if it.arguments[0] else UNKNOWN
    if value.constant()[0] or (
        value.pts and not value.deps and all(_never_called(ctx, o) for o in value.pts)
    ):
        return const(value=False)
    return UNKNOWN


def _never_called(ctx: Interpreter, obj: Obj) -> bool:
    if obj.kind != "instance" or not isinstance(obj.info, Obj):
        return obj.kind in NOT_CALLABLE
    return not _opaque(obj.info) and not heap.read_field(ctx, obj, "__call__").pts


def _opaque(cls: Obj) -> bool:
    return any(isinstance(one.info, ClassInfo) and one.info.opaque for one in lineage(cls))


def has_attribute(ctx: Interpreter, it: Invocation) -> Value:
    """Return False if no possible object has such an attribute.

    Otherwise, the result depends on the conditions under which the program stores the attribute in its instances.
    """
    given = it.arguments[0]
    names = given[1].texts() if len(given) == 2 else ()
    if names and all(lacks(ctx, given[0], name) for name in names):
        return const(value=False)
    ours = [o for o in given[0].objects if o.kind == "instance"] if names else []
    decides = namespaces.existence(ctx, ours, names, it.frame, it.call.slot)
    return Value(decides) if decides is not None else UNKNOWN


def lacks(ctx: Interpreter, value: Value, name: str) -> bool:
    """Return whether all possible objects of a value certainly have no attribute of this name."""
    special = name.startswith("__") and not all(_own_special(obj, name) for obj in value.objects)
    if value.deps or special or not (value.pts or value.keys()):
        return False
    return not any(hasattr(constant, name) for constant in value.keys() or ()) and all(
        _lacks(ctx, obj, name) for obj in value.objects
    )


def _own_special(obj: Obj, name: str) -> bool:
    """Return whether only analysed code can set an attribute with this name, such as `__port__` of a function."""
    return obj.kind in ("closure", "bound") and name not in SPECIAL


def _lacks(ctx: Interpreter, obj: Obj, name: str) -> bool:
    if obj.kind in BUILT_IN:
        return name not in BUILT_IN[obj.kind]
    if obj.kind == "instance" and isinstance(obj.info, Obj):
        dynamic = heap.read_field(ctx, obj, "__getattr__").pts or heap.replaced_attributes(ctx, obj)
        return not dynamic and not _opaque(obj.info) and heap.read_field(ctx, obj, name) is BOTTOM
    if function_of(obj) is None or function_attributes.may_have_more(ctx, pointer(obj)):
        return False
    return function_attributes.attribute(ctx, obj, name) is None


def of_type(ctx: Interpreter, it: Invocation) -> Value:  # noqa: ARG001 - shared signature
    """Return the result of a query about a type; a type is not data."""
    return UNKNOWN
