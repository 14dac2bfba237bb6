"""The types of messages, and the names of their fields that a program asks for: `for name in msg.__slots__`.

The names are not data. If the type is not known, each name may be any name.
"""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import recency
from tarl_lint.memory.values import UNKNOWN, Obj, Value, const, pointer
from tarl_lint.message_fields import ELEMENTS, KNOWN_FIELDS, NUMBER_FIELDS, WHOLE

MESSAGE_MODULE: Final = ".msg."  # part of the name of every message class
NAMES: Final = frozenset(["__slots__", "_fields_and_field_types", "_slots"])
TYPES: Final = frozenset(
    ["_slot_types", "SLOT_TYPES"]
)  # attributes with the types of the fields, in the same order
DESCRIPTIONS: Final = NAMES | TYPES
KINDS: Final = frozenset(["message", "lib", "ext"])  # kinds of objects that may be messages, or their classes


def type_of(ctx: Interpreter, obj: Obj) -> str:
    """Return the type of a message or of its part, without package; "" if unknown."""
    outer = obj.parent
    if outer is None:
        ctx.look([obj])
        if obj.kind == "message":
            return obj.defined
        return obj.name.rpartition(".")[2] if MESSAGE_MODULE in obj.name else ""
    if obj.name.startswith("["):
        within = type_of(ctx, outer.parent) if outer.parent is not None else ""
        return ELEMENTS.get(within, {}).get(f"{outer.name}[]", "")
    return KNOWN_FIELDS.get(type_of(ctx, outer), {}).get(obj.name, "")


def is_number(ctx: Interpreter, value: Value, *, whole: bool) -> bool:
    """Return whether a value is a number in a message of a known type; with `whole`, a whole number."""
    return bool(value.pts) and all(_is_number(ctx, obj, whole=whole) for obj in value.pts)


def _is_number(ctx: Interpreter, obj: Obj, *, whole: bool) -> bool:
    field, listed = (obj.parent, "[]") if obj.name.startswith("[") else (obj, "")
    if field is None or field.parent is None:
        return False
    within = type_of(ctx, field.parent)
    return f"{field.name}{listed}" in NUMBER_FIELDS.get(within, ()) and (not whole or within in WHOLE)


def field_names(ctx: Interpreter, obj: Obj) -> tuple[str, ...]:
    """Return the names of a message's fields; none if its type is not known."""
    return tuple(KNOWN_FIELDS.get(type_of(ctx, obj), ()))


def description(ctx: Interpreter, obj: Obj, attribute: str, name: str) -> Value:
    """Return the value of `__slots__` and similar attributes: a sequence with one element for each field.

    `name` is the name of a sequence over which a loop is executed element by element. In ROS 2, the names in
    `__slots__` begin with an underscore.
    """
    fields, listed = field_names(ctx, obj), attribute not in TYPES
    prefix = "_" if attribute == "__slots__" and of_ros2(ctx) else ""
    made = recency.intern(ctx, "sequence", (attribute, type_of(ctx, obj), prefix), name if fields else "")
    for number, field in enumerate(fields):
        ctx.store.put((made, f"[{number!r}]"), const(prefix + field) if listed else UNKNOWN)
    if not fields:
        ctx.store.put((made, "*"), UNKNOWN)
    return pointer(made)


def of_ros2(ctx: Interpreter) -> bool:
    """Return whether the running file mentions rclpy."""
    module = ctx.modules.get(ctx.stack[-1].program.path) if ctx.stack else None
    return module is not None and module.contains("rclpy")


def field(ctx: Interpreter, value: Value, name: str) -> str:
    """Return the field that a name stands for: in ROS 2, x for `_x`."""
    plain = name[1:] if name.startswith("_") else name
    known = plain != name and value.pts and all(o.kind in KINDS for o in value.pts)
    return plain if known and all(plain in field_names(ctx, o) for o in value.pts) else name
