"""Find uses of message fields that the message type does not have, for types whose fields are known."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from typing import Final

from tarl_lint.evidence import Outline
from tarl_lint.flows.statement_text import Texts
from tarl_lint.ir.lower_expressions import position
from tarl_lint.message_fields import ALL_FIELDS
from tarl_lint.read.source import Module
from tarl_lint.system.model import Misfit
from tarl_lint.trees import last_name

_STANDARD: Final = frozenset(["std_msgs", "geometry_msgs", "nav_msgs", "sensor_msgs"])
_METHODS: Final = frozenset(
    ["serialize", "deserialize", "serialize_numpy", "deserialize_numpy", "get_fields_and_field_types",
     "connection_header"]
)  # fmt: skip
_REGISTERS: Final[Mapping[str, tuple[int, int]]] = {"Subscriber": (1, 2), "create_subscription": (0, 2)}
Function = ast.FunctionDef | ast.AsyncFunctionDef


def misfits(module: Module, outline: Outline, texts: Texts) -> Iterator[Misfit]:
    """Yield the uses of absent fields, of messages that a callback receives, and of new messages."""
    types = _imported(module.tree)
    if not types:
        return
    for call, kind, name in _unknown_arguments(module.tree, types):
        span = texts[module.path].stretch(position(call))
        yield Misfit(kind, name, span, outline.qualname(call.lineno))
    functions = [
        one for one in outline.definitions if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef)
    ]
    received = _received(module.tree, types)
    for function in functions:
        held = _made(function, types)
        kinds = received.get(function.name, set())
        if len(kinds) == 1 and sum(one.name == function.name for one in functions) == 1:
            held |= _parameter(function, next(iter(kinds)))
        for node in ast.walk(function) if held else ():
            found = _absent(node, held) if isinstance(node, ast.Attribute) else None
            if found is not None and isinstance(node, ast.Attribute):
                span = texts[module.path].stretch(position(node))
                yield Misfit(*found, span, outline.qualname(node.lineno))


def _unknown_arguments(tree: ast.Module, types: Mapping[str, str]) -> Iterator[tuple[ast.Call, str, str]]:
    """Yield the calls that create a message with an absent field, with message type and field."""
    bound = {one.name for one in ast.walk(tree) if isinstance(one, ast.ClassDef | Function)} | {
        one.id for one in ast.walk(tree) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)
    }
    for call in (one for one in ast.walk(tree) if isinstance(one, ast.Call)):
        name = call.func.id if isinstance(call.func, ast.Name) else ""
        if name in types and name not in bound:
            fields = ALL_FIELDS[types[name]]
            for keyword in call.keywords:
                if keyword.arg and keyword.arg not in fields and not keyword.arg.startswith("_"):
                    yield call, types[name], keyword.arg


def _imported(tree: ast.Module) -> dict[str, str]:
    """Return local name → type for messages of standard packages whose fields are known."""
    return {
        alias.asname or alias.name: alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module and node.module.partition(".")[0] in _STANDARD
        for alias in node.names
        if alias.name in ALL_FIELDS
    }


def _received(tree: ast.Module, types: Mapping[str, str]) -> dict[str, set[str]]:
    """Return function name → types of the messages with which a subscription calls it; "" for an unknown type."""
    found: dict[str, set[str]] = {}
    for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
        places = _REGISTERS.get(last_name(call.func))
        if places is not None and len(call.args) > max(places):
            kind = types.get(last_name(call.args[places[0]]), "")
            found.setdefault(last_name(call.args[places[1]]), set()).add(kind)
    return {name: kinds for name, kinds in found.items() if name and "" not in kinds}


def _parameter(function: Function, kind: str) -> dict[str, str]:
    names = [one.arg for one in function.args.args if one.arg not in ("self", "cls")]
    stored = {
        one.id for one in ast.walk(function) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)
    }
    return {names[0]: kind} if names and names[0] not in stored else {}


def _made(function: Function, types: Mapping[str, str]) -> dict[str, str]:
    """Return the local variables that hold a new message, each assigned once."""
    assigned: dict[str, list[ast.expr]] = {}
    for node in ast.walk(function):
        if isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
            assigned.setdefault(node.targets[0].id, []).append(node.value)
    stores: dict[str, int] = {}
    for node in ast.walk(function):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            stores[node.id] = stores.get(node.id, 0) + 1
    return {
        name: types[last_name(values[0].func)]
        for name, values in assigned.items()
        if len(values) == stores.get(name) == 1
        and isinstance(values[0], ast.Call)
        and isinstance(values[0].func, ast.Name)
        and values[0].func.id in types
    }


def _absent(node: ast.Attribute, held: Mapping[str, str]) -> tuple[str, str] | None:
    """Return (message type, field name) of an attribute that is not a field of the message type."""
    kind = _kind(node.value, held)
    fields = ALL_FIELDS.get(kind)
    name = node.attr
    if not fields or name in fields or name in _METHODS or name.startswith("_") or name.upper() == name:
        return None
    return kind, name


def _kind(expr: ast.expr, held: Mapping[str, str]) -> str:
    """Return the type of a message expression, "" if it is unknown."""
    if isinstance(expr, ast.Name):
        return held.get(expr.id, "")
    if isinstance(expr, ast.Attribute):
        return ALL_FIELDS.get(_kind(expr.value, held), {}).get(expr.attr, "")
    return ""
