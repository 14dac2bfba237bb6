"""The types of messages, requests and goals that functions receive."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from typing import Final

from tarl_lint.system.imported_types import ImportedTypes, short
from tarl_lint.trees import argument, last_name, walk

# functions that register a callback: the places and keywords of the type and of the callback, and the objects that
# the callback gets
_REGISTERS: Final[Mapping[str, tuple[tuple[int, str], tuple[int, str], tuple[str, ...]]]] = {
    "Subscriber": ((1, "data_class"), (2, "callback"), ("",)),
    "create_subscription": ((0, "msg_type"), (2, "callback"), ("",)),
    "Service": ((1, "service_class"), (2, "handler"), (".Request",)),
    "create_service": ((0, "srv_type"), (2, "callback"), (".Request", ".Response")),
    "SimpleActionServer": ((1, "ActionSpec"), (2, "execute_cb"), ("Goal",)),
    "ActionServer": ((1, "action_type"), (3, "execute_callback"), ("@",)),
}
HANDLE: Final = "@"  # end of a goal handle's type; its `request` is the goal


def received(tree: ast.Module, types: ImportedTypes) -> dict[str, set[tuple[str, int]]]:
    """Return function name → (type or "", position) of received objects."""
    found: dict[str, set[tuple[str, int]]] = {}
    for call in _calls(tree):
        for callback, kinds in _registered(call, types):
            name, number = _called(callback)
            found.setdefault(name, set()).update((kind, number + i) for i, kind in enumerate(kinds))
    for name, several in _synchronized(tree, types).items():
        found.setdefault(name, set()).update((kind, i) for i, kind in enumerate(several))
    found.pop("", None)
    return found


def received_by_lambdas(tree: ast.Module, types: ImportedTypes) -> dict[ast.Lambda, tuple[str, ...]]:
    """Return the callback lambdas with the types of received objects."""
    calls = _calls(tree)
    pairs = (pair for call in calls for pair in _registered(call, types))
    return {callback: kinds for callback, kinds in pairs if isinstance(callback, ast.Lambda)}


def _calls(tree: ast.Module) -> list[ast.Call]:
    return [node for node in walk(tree) if isinstance(node, ast.Call)]


def _registered(call: ast.Call, types: ImportedTypes) -> Iterator[tuple[ast.expr, tuple[str, ...]]]:
    """Yield a registered callback with the types of received objects."""
    places = _REGISTERS.get(last_name(call.func))
    if places is None:
        return
    *at, parts = places
    kind, callback = (argument(call, *place) for place in at)
    if kind is not None and callback is not None:
        given = types.of(kind)
        if parts[0] == "Goal":
            given = given.removesuffix("Action")
        yield callback, tuple(short(f"{given}{part}") if given else "" for part in parts)


def _synchronized(tree: ast.Module, types: ImportedTypes) -> dict[str, list[str]]:
    """Return function name → the types of the messages that a synchronizer passes to the function, in order.

    The synchronizer is one of message_filters. A function that several synchronizers call is left out.
    """
    calls = _calls(tree)
    calls = [one for one in calls if last_name(one.func) == "registerCallback" and one.args]
    if not calls:
        return {}
    assigned: dict[str, list[ast.expr]] = {}
    for node in walk(tree):
        if isinstance(node, ast.Assign):
            for target in node.targets:
                assigned.setdefault(ast.unparse(target), []).append(node.value)
    found: dict[str, list[list[str]]] = {}
    for call in calls:
        owner = call.func.value if isinstance(call.func, ast.Attribute) else call
        for made in [owner] if isinstance(owner, ast.Call) else assigned.get(ast.unparse(owner), []):
            if not isinstance(made, ast.Call) or not last_name(made.func).endswith("Synchronizer"):
                continue
            filters = _only(made.args[0], assigned) if made.args else None
            kinds = _of_filters(filters, assigned, types)
            if kinds:
                found.setdefault(last_name(call.args[0]), []).append(kinds)
    return {name: several[0] for name, several in found.items() if name and len(several) == 1}


def _of_filters(
    filters: ast.expr | None, assigned: Mapping[str, list[ast.expr]], types: ImportedTypes
) -> list[str]:
    """Return the types of a list of filters."""
    if isinstance(filters, ast.List | ast.Tuple):
        return [_filtered(_only(one, assigned), types) for one in filters.elts]
    if not isinstance(filters, ast.ListComp) or len(filters.generators) != 1:
        return []
    each, made = filters.generators[0], filters.elt
    table = _only(each.iter, assigned)
    if each.ifs or not isinstance(made, ast.Call) or last_name(made.func) != "Subscriber":
        return []
    kind = _class_of(made)
    names = [ast.unparse(one) for one in each.target.elts] if isinstance(each.target, ast.Tuple) else []
    if kind is None or not isinstance(table, ast.List | ast.Tuple):
        return []
    if ast.unparse(kind) not in names:
        return [types.of(kind)] * len(table.elts)
    place = names.index(ast.unparse(kind))
    rows = [one.elts if isinstance(one, ast.List | ast.Tuple) else [] for one in table.elts]
    return [types.of(row[place]) if len(row) == len(names) else "" for row in rows]


def _only(expr: ast.expr, assigned: Mapping[str, list[ast.expr]]) -> ast.expr | None:
    """Return an expression; for a variable with a single value, this value."""
    if not isinstance(expr, ast.Name | ast.Attribute):
        return expr
    values = assigned.get(ast.unparse(expr), [])
    return values[0] if len(values) == 1 else None


def _filtered(made: ast.expr | None, types: ImportedTypes) -> str:
    """Return the type of the messages of a `message_filters.Subscriber`; "" if it is unknown."""
    if not isinstance(made, ast.Call) or last_name(made.func) != "Subscriber":
        return ""
    kind = _class_of(made)
    return types.of(kind) if kind is not None else ""


def _class_of(made: ast.Call) -> ast.expr | None:
    """Return the second argument of a filter: the class of its messages in ROS 1 and ROS 2."""
    return made.args[1] if len(made.args) > 1 else None


def _called(callback: ast.expr) -> tuple[str, int]:
    """Return the function that a callback calls, and the message's position."""
    match callback:
        case ast.Call(func=func, args=[function, *given]) if last_name(func) == "partial":
            return last_name(function), len(given)
        case ast.Lambda(args=ast.arguments(args=[first, *_]), body=ast.Call(func=function, args=given)):
            places = [i for i, one in enumerate(given) if isinstance(one, ast.Name) and one.id == first.arg]
            return (last_name(function), places[0]) if len(places) == 1 else ("", 0)
    return last_name(callback), 0
