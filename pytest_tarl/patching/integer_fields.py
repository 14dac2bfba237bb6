"""Integer fields of messages, for which ROS rejects floats."""

from __future__ import annotations

import ast
import re
from functools import cache

from pytest_tarl.errors import TarlError
from pytest_tarl.patching.document import Document
from pytest_tarl.ros import message_type

_INTEGER = re.compile(r"(?:sequence<)?(?:u?int(?:8|16|32|64)|byte|char|octet)\b")
_SHAPING = ast.BinOp | ast.UnaryOp | ast.IfExp | ast.List | ast.Tuple


def in_integer_field(source: Document, node: ast.expr) -> bool:
    """Return whether an expression is in an integer field of a message."""
    child: ast.AST = node
    for parent in source.ancestors(node):
        if isinstance(parent, ast.keyword) and parent.arg is not None:
            call = source.parents[parent]
            return isinstance(call, ast.Call) and _is_integer(source, call.func, (parent.arg,))
        if isinstance(parent, ast.Call):
            return any(each is child for each in parent.args) and _takes_positional(source, parent, child)
        if isinstance(parent, ast.Assign | ast.AugAssign | ast.AnnAssign):
            targets = parent.targets if isinstance(parent, ast.Assign) else [parent.target]
            return child is parent.value and any(_takes_integer(source, target) for target in targets)
        if not isinstance(parent, _SHAPING) or (isinstance(parent, ast.IfExp) and child is parent.test):
            return False
        child = parent
    return False


def _takes_positional(source: Document, call: ast.Call, argument: ast.AST) -> bool:
    """Return whether a message constructor's positional argument sets an integer field."""
    name = _type_name(source, call.func)
    at = next(at for at, each in enumerate(call.args) if each is argument)
    return _INTEGER.match([*_fields(name).values(), *[""] * (at + 1)][at]) is not None


def _takes_integer(source: Document, target: ast.expr) -> bool:
    """Return whether a target is an integer field of a message created in this file."""
    fields: list[str] = []
    while isinstance(target, ast.Attribute | ast.Subscript):
        if isinstance(target, ast.Attribute):
            fields.insert(0, target.attr)
        target = target.value
        made = _constructors(source).get(ast.unparse(target))
        if made is not None and fields and _is_integer(source, made, tuple(fields)):
            return True
    return False


@cache
def _constructors(source: Document) -> dict[str, ast.expr]:
    """Map each variable to the function whose result it holds."""
    return {
        ast.unparse(target): node.value.func
        for node in ast.walk(source.tree)
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call)
        for target in node.targets
    }


def _is_integer(source: Document, kind: ast.expr, fields: tuple[str, ...]) -> bool:
    """Return whether a field of a message type is an integer; `kind` is the type's name in this file."""
    found = _type_name(source, kind)
    for field in fields:
        found = _fields(found).get(field, "")
        package, _, short = found.partition("/")
        found = f"{package}/msg/{short}" if short else found
    return _INTEGER.match(found) is not None


def _type_name(source: Document, kind: ast.expr) -> str:
    """Return the ROS name of a message type; empty if the type is not imported."""
    package, _, short = _packages(source).get(ast.unparse(kind).partition(".")[0], "").partition("/")
    return f"{package}/msg/{short or ast.unparse(kind).rpartition('.')[2]}" if package else ""


@cache
def _fields(name: str) -> dict[str, str]:
    """Return the types of a message's fields, in order; empty if the message is unknown."""
    try:
        return dict(message_type(name).get_fields_and_field_types()) if name else {}
    except (TarlError, AttributeError):
        return {}


@cache
def _packages(source: Document) -> dict[str, str]:
    """Map imported names to ROS names, such as `Int32` to `std_msgs/Int32`."""
    found: dict[str, str] = {}
    for node in ast.walk(source.tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            package, _, part = node.module.partition(".")
            for each in node.names:
                found[each.asname or each.name] = f"{package}/{each.name if part == 'msg' else ''}"
        elif isinstance(node, ast.Import):
            for each in node.names:
                found[each.asname or each.name.partition(".")[0]] = f"{each.name.partition('.')[0]}/"
    return found
