"""Find uses of message fields that the message type does not have, for types whose fields are known.

Fields of types of the workspace become known when a system is composed. Until then, the uses of these fields are
listed.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from typing import Final, NamedTuple

from tarl_lint.evidence import Outline
from tarl_lint.flows.statement_text import Texts
from tarl_lint.ir.lower_expressions import position
from tarl_lint.message_fields import BY_RELEASE, ELEMENTS, KNOWN_FIELDS
from tarl_lint.read.source import Module
from tarl_lint.system.held_messages import Heard, HeldMessages
from tarl_lint.system.imported_types import ImportedTypes, path
from tarl_lint.system.message_callbacks import HANDLE
from tarl_lint.system.model import Misfit
from tarl_lint.trees import last_name, walk

_METHODS: Final = frozenset(
    ["serialize", "deserialize", "serialize_numpy", "deserialize_numpy", "get_fields_and_field_types",
     "connection_header"]
)  # fmt: skip
_Fields = Mapping[str, Mapping[str, str]]
_NONE: Final[Heard] = {}


class _Use(NamedTuple):
    """A use of the field `path[-1]`: of the message itself, or of the part of the message that `path[:-1]` names."""

    type: str
    path: tuple[str, ...]
    node: ast.expr


def examined(
    module: Module, outline: Outline, texts: Texts, heard: Heard = _NONE
) -> tuple[tuple[Misfit, ...], tuple[Misfit, ...]]:
    """Return the uses of absent fields, and the uses of fields of unknown types `package/Name` as dotted paths.

    `heard` maps the name of each function to the types `package/Name` of the messages that the analysis passes to
    it.
    """
    types = ImportedTypes(module.tree)
    known = {**KNOWN_FIELDS, **BY_RELEASE.get(types.ros, {})}
    absent: list[Misfit] = []
    unknown: list[Misfit] = []
    for use in _uses(module.tree, outline, types, heard):
        found = lacking(use.type, use.path, known)
        if found is not None:
            absent.append(_found(*found, use.node, module, outline, texts))
        if "/" in use.type and use.type not in KNOWN_FIELDS:
            unknown.append(_found(use.type, ".".join(use.path), use.node, module, outline, texts))
    return tuple(absent), tuple(unknown)


def lacking(kind: str, path: tuple[str, ...], fields: _Fields) -> tuple[str, str] | None:
    """Return the type and the field at the end of a path if the type lacks the field; None otherwise, or if unknown."""
    *before, name = path
    for part in before:
        kind = fields.get(kind, {}).get(part) or ELEMENTS.get(kind, {}).get(part, "")
    known = fields.get(kind)
    constant = name.upper() == name and len(name) > 1
    if not known or name in known or name in _METHODS or name.startswith("_") or constant:
        return None
    return kind, name


def _found(kind: str, field: str, node: ast.expr, module: Module, outline: Outline, texts: Texts) -> Misfit:
    return Misfit(kind, field, texts[module.path].stretch(position(node)), outline.qualname(node.lineno))


def _uses(tree: ast.Module, outline: Outline, types: ImportedTypes, heard: Heard) -> Iterator[_Use]:
    """Yield the uses of fields of messages whose types the module imports, or which a callback receives."""
    if not types.used and not heard:
        return
    nodes = list(walk(tree))
    yield from _arguments(nodes, types)
    held = HeldMessages(tree, outline, types, heard)
    tried = _tried(nodes)
    for node in nodes:
        if isinstance(node, ast.Attribute) and node.attr not in tried:
            message = held.of(node.value)
            if message is not None and not message.type.endswith(HANDLE):
                yield _Use(message.type, (*message.path, node.attr), node)


def _tried(nodes: Sequence[ast.AST]) -> set[str]:
    """Return the fields that the code looks up by name, or in a `try` that handles AttributeError."""
    found: set[str] = set()
    for node in nodes:
        if isinstance(node, ast.Call) and last_name(node.func) in ("hasattr", "getattr", "setattr"):
            found |= {
                one.value for one in node.args if isinstance(one, ast.Constant) and isinstance(one.value, str)
            }
        elif isinstance(node, ast.Try) and any(
            one.type is not None and "AttributeError" in ast.unparse(one.type) for one in node.handlers
        ):
            inside = walk(*node.body)
            found |= {one.attr for one in inside if isinstance(one, ast.Attribute)}
    return found


def _arguments(nodes: Sequence[ast.AST], types: ImportedTypes) -> Iterator[_Use]:
    """Yield the keyword arguments of calls that create a message."""
    bound = {one.name for one in nodes if isinstance(one, ast.ClassDef | ast.FunctionDef)} | {
        one.id for one in nodes if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)
    }
    for call in (one for one in nodes if isinstance(one, ast.Call)):
        kind = types.of(call.func)
        if kind and path(call.func)[0] not in bound:
            yield from (_Use(kind, (one.arg,), call) for one in call.keywords if one.arg)
