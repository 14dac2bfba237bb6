"""Find uses of message fields that the message type does not have, for types whose fields are known.

Fields of types of the workspace are known only when a system is composed; their uses are listed until then.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from typing import Final, NamedTuple

from tarl_lint.evidence import Outline
from tarl_lint.flows.statement_text import Texts
from tarl_lint.ir.lower_expressions import position
from tarl_lint.message_fields import KNOWN_FIELDS, PACKAGES
from tarl_lint.read.source import Module
from tarl_lint.system.model import Misfit
from tarl_lint.trees import last_name

_METHODS: Final = frozenset(
    ["serialize", "deserialize", "serialize_numpy", "deserialize_numpy", "get_fields_and_field_types",
     "connection_header"]
)  # fmt: skip
# functions that register a callback: places and keywords of message type and callback
_REGISTERS: Final[Mapping[str, tuple[tuple[int, str], tuple[int, str]]]] = {
    "Subscriber": ((1, "data_class"), (2, "callback")),
    "create_subscription": ((0, "msg_type"), (2, "callback")),
}
Function = ast.FunctionDef | ast.AsyncFunctionDef
Heard = Mapping[str, frozenset[str]]
_Fields = Mapping[str, Mapping[str, str]]
_NONE: Final[Heard] = {}


class _Use(NamedTuple):
    """A use of the field `path[-1]` of a message: of the message itself, or of the part that `path[:-1]` names."""

    type: str
    path: tuple[str, ...]
    node: ast.expr


def misfits(module: Module, outline: Outline, texts: Texts, heard: Heard = _NONE) -> Iterator[Misfit]:
    """Yield the uses of absent fields, of messages that a callback receives, and of new messages.

    `heard` are the types `package/Name` of the messages that the analysis passes to each function, by its name.
    """
    for use in _uses(module.tree, outline, heard):
        absent = lacking(use.type, use.path, KNOWN_FIELDS)
        if absent is not None:
            yield _found(*absent, use.node, module, outline, texts)


def uses(module: Module, outline: Outline, texts: Texts, heard: Heard = _NONE) -> Iterator[Misfit]:
    """Yield the uses of fields of types `package/Name` that are not known; the field is a dotted path."""
    for use in _uses(module.tree, outline, heard):
        if "/" in use.type:
            yield _found(use.type, ".".join(use.path), use.node, module, outline, texts)


def lacking(kind: str, path: tuple[str, ...], fields: _Fields) -> tuple[str, str] | None:
    """Return the type and its absent field at the end of a path; None if the type has it or is unknown."""
    *before, name = path
    for part in before:
        kind = fields.get(kind, {}).get(part, "")
    known = fields.get(kind)
    if not known or name in known or name in _METHODS or name.startswith("_") or name.upper() == name:
        return None
    return kind, name


def _found(kind: str, field: str, node: ast.expr, module: Module, outline: Outline, texts: Texts) -> Misfit:
    return Misfit(kind, field, texts[module.path].stretch(position(node)), outline.qualname(node.lineno))


def _uses(tree: ast.Module, outline: Outline, heard: Heard) -> Iterator[_Use]:
    """Yield the uses of fields of messages whose types the module imports, or that a callback receives."""
    types = _Types(tree)
    if not types.used and not heard:
        return
    yield from _arguments(tree, types)
    functions = [
        one for one in outline.definitions if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef)
    ]
    received, synchronized = _received(tree, types), _synchronized(tree, types)
    for function in functions:
        held = _made(function, types)
        kinds = received.get(function.name) or _heard(function, heard)
        if sum(one.name == function.name for one in functions) == 1:
            if len(kinds) == 1:
                held |= _parameter(function, *next(iter(kinds)))
            for number, kind in enumerate(synchronized.get(function.name, ())):
                held |= _parameter(function, kind, number) if kind else {}
        for node in ast.walk(function) if held else ():
            if isinstance(node, ast.Attribute):
                name, path = _path(node)
                if name in held:
                    yield _Use(held[name], path, node)


def _path(node: ast.expr) -> tuple[str, tuple[str, ...]]:
    """Return the variable at the beginning of an attribute, and the names after it; "" for another expression."""
    parts: list[str] = []
    expr = node
    while isinstance(expr, ast.Attribute):
        parts.append(expr.attr)
        expr = expr.value
    return (expr.id if isinstance(expr, ast.Name) else ""), tuple(reversed(parts))


def _heard(function: Function, heard: Heard) -> set[tuple[str, int]]:
    """Return the type of the only argument of a function, if the analysis passes it messages of one type."""
    kinds = heard.get(function.name, frozenset())
    plain = [one.arg for one in function.args.args if one.arg not in ("self", "cls")]
    return {(_short(kind), 0) for kind in kinds} if len(plain) == len(kinds) == 1 else set()


def _short(whole: str) -> str:
    """Return the name of a type `package/Name`, without its package if the fields are known."""
    package, _, name = whole.partition("/")
    return name if name in PACKAGES.get(package, ()) else whole


def _arguments(tree: ast.Module, types: _Types) -> Iterator[_Use]:
    """Yield the keyword arguments of calls that create a message."""
    bound = {one.name for one in ast.walk(tree) if isinstance(one, ast.ClassDef | Function)} | {
        one.id for one in ast.walk(tree) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)
    }
    for call in (one for one in ast.walk(tree) if isinstance(one, ast.Call)):
        kind = types.of(call.func)
        if kind and _path(call.func)[0] not in bound:
            yield from (_Use(kind, (one.arg,), call) for one in call.keywords if one.arg)


class _Types:
    """The types of messages that a module imports: `Name` if the fields are known, else `package/Name`."""

    def __init__(self, tree: ast.Module) -> None:
        self._classes: dict[str, str] = {}  # local name → type
        self._modules: dict[
            str, str
        ] = {}  # dotted name that the code uses for a module of messages → package
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module and not node.level:
                package, _, rest = node.module.partition(".")
                for alias in node.names:
                    local = alias.asname or alias.name
                    if rest.partition(".")[0] == "msg":
                        self._classes[local] = _short(f"{package}/{alias.name}")
                    elif not rest and alias.name == "msg":
                        self._modules[local] = package
            elif isinstance(node, ast.Import):
                for alias in node.names:
                    package, _, rest = alias.name.partition(".")
                    if rest == "msg":
                        self._modules[alias.asname or alias.name] = package

    @property
    def used(self) -> bool:
        """Return whether the module imports any."""
        return bool(self._classes or self._modules)

    def of(self, expr: ast.expr) -> str:
        """Return the type that a name in the code stands for; "" if it stands for none."""
        if isinstance(expr, ast.Name):
            return self._classes.get(expr.id, "")
        if not isinstance(expr, ast.Attribute):
            return ""
        first, path = _path(expr)
        package = self._modules.get(".".join((first, *path[:-1])), "")
        return _short(f"{package}/{path[-1]}") if package and first else ""


def _received(tree: ast.Module, types: _Types) -> dict[str, set[tuple[str, int]]]:
    """Return function name → the types of the messages with which a subscription calls it, and their positions.

    The type is "" if it is unknown.
    """
    found: dict[str, set[tuple[str, int]]] = {}
    for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
        places = _REGISTERS.get(last_name(call.func))
        if places is None:
            continue
        kind, callback = (_argument(call, *place) for place in places)
        if kind is not None and callback is not None:
            name, number = _called(callback)
            found.setdefault(name, set()).add((types.of(kind), number))
    return {name: kinds for name, kinds in found.items() if name and all(kind for kind, _ in kinds)}


def _synchronized(tree: ast.Module, types: _Types) -> dict[str, list[str]]:
    """Return function name → the types of the messages that a synchronizer of message_filters passes to it, in order.

    A function that several synchronizers call is left out.
    """
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    calls = [one for one in calls if last_name(one.func) == "registerCallback" and one.args]
    if not calls:
        return {}
    assigned: dict[str, list[ast.expr]] = {}
    for node in ast.walk(tree):
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
            if isinstance(filters, ast.List | ast.Tuple):
                kinds = [_filtered(_only(one, assigned), types) for one in filters.elts]
                found.setdefault(last_name(call.args[0]), []).append(kinds)
    return {name: several[0] for name, several in found.items() if name and len(several) == 1}


def _only(expr: ast.expr, assigned: Mapping[str, list[ast.expr]]) -> ast.expr | None:
    """Return an expression, or the only value of a variable."""
    if not isinstance(expr, ast.Name | ast.Attribute):
        return expr
    values = assigned.get(ast.unparse(expr), [])
    return values[0] if len(values) == 1 else None


def _filtered(made: ast.expr | None, types: _Types) -> str:
    """Return the type of the messages of a `message_filters.Subscriber`; "" if it is unknown."""
    if not isinstance(made, ast.Call) or last_name(made.func) != "Subscriber" or len(made.args) < 2:
        return ""
    return types.of(made.args[1])


def _argument(call: ast.Call, place: int, name: str) -> ast.expr | None:
    named = next((one.value for one in call.keywords if one.arg == name), None)
    return named if named is not None else call.args[place] if len(call.args) > place else None


def _called(callback: ast.expr) -> tuple[str, int]:
    """Return the name of the function that a callback calls, and the position of the message among its arguments."""
    match callback:
        case ast.Call(func=func, args=[function, *given]) if last_name(func) == "partial":
            return last_name(function), len(given)
        case ast.Lambda(args=ast.arguments(args=[first, *_]), body=ast.Call(func=function, args=given)):
            places = [i for i, one in enumerate(given) if isinstance(one, ast.Name) and one.id == first.arg]
            return (last_name(function), places[0]) if len(places) == 1 else ("", 0)
    return last_name(callback), 0


def _parameter(function: Function, kind: str, number: int) -> dict[str, str]:
    names = [one.arg for one in function.args.args if one.arg not in ("self", "cls")]
    stored = {
        one.id for one in ast.walk(function) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)
    }
    return {names[number]: kind} if len(names) > number and names[number] not in stored else {}


def _made(function: Function, types: _Types) -> dict[str, str]:
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
        name: kind
        for name, values in assigned.items()
        if len(values) == stores.get(name) == 1
        and isinstance(values[0], ast.Call)
        and (kind := types.of(values[0].func))
    }
