"""Where a subscription that a repair adds keeps its values: on the instance, or in the module."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pytest_tarl.anchors import REGISTERING, Anchor
from pytest_tarl.document import Document, Edit, Function
from pytest_tarl.errors import RepairError


@dataclass(frozen=True)
class Store:
    """Values are kept in attributes of `owner`'s instances, or in globals of the module where there is no owner."""

    source: Document
    place: ast.AST
    owner: ast.ClassDef | None = None
    instance: str = ""
    module: str = ""

    def variable(self, name: str) -> str:
        """Return the expression under which a value is read."""
        return f"{self.instance}.{name}" if self.owner else name


def variable_edits(store: Store, anchor: Anchor, names: Sequence[str]) -> list[Edit]:
    """Return the edits that give the variables their value before the first message."""
    if store.owner is None:
        state = _state(store, anchor)
        if state is None:
            return []
        end = store.source.line_end(state)
        return [Edit(end, end, "".join(f"\n{name} = None" for name in names))]
    early = _first_registration(anchor)
    if early is not None:
        indent, instance = store.source.indentation(early), _instance(anchor)
        lines = "".join(f"{instance}.{name} = None\n{indent}" for name in names)
        return [Edit(store.source.start(early), store.source.start(early), lines)]
    first = first_statement(store.owner)
    start, indent = store.source.line_start(first), store.source.indentation(first)
    lines = "".join(f"{indent}{name} = None\n" for name in names)
    return [Edit(start, start, f"{lines}\n")]


def callback_edit(
    store: Store, anchor: Anchor, callback: str, names: Mapping[str, str], annotation: str
) -> Edit:
    """Return the edit that adds the callback, which keeps the fields of a message under their names."""
    argument = "message" if "message" not in names.values() else "received"
    typed = f"{argument}: {annotation}" if annotation else argument
    returned = " -> None" if annotation else ""
    unit = store.source.unit
    stored = [
        f"{unit}{_kept(store, anchor, name)} = {_field(argument, field)}" for field, name in names.items()
    ]
    if store.owner is not None:
        return _method(store, anchor, [f"def {callback}({_instance(anchor)}, {typed}){returned}:", *stored])
    shared = f"{unit}global {', '.join(names.values())}"
    initial = [] if _state(store, anchor) else [*(f"{name} = None" for name in names.values()), "", ""]
    return _function(store, anchor, [*initial, f"def {callback}({typed}){returned}:", shared, *stored])


def first_statement(definition: Function | ast.ClassDef) -> ast.stmt:
    """Return the first statement behind the docstring; the docstring where there is nothing else."""
    documented = ast.get_docstring(definition, clean=False) is not None and len(definition.body) > 1
    return definition.body[1 if documented else 0]


def _method(store: Store, anchor: Anchor, lines: Sequence[str]) -> Edit:
    """Place a method behind the one that makes the subscription."""
    method = anchor.source.method(anchor.statement)
    assert method is not None  # noqa: S101  (an owner is only chosen inside its methods)
    indent, end = store.source.indentation(method[1]), store.source.line_end(method[1])
    return Edit(end, end, "\n\n" + "\n".join(indent + line for line in lines))


def _function(store: Store, anchor: Anchor, lines: Sequence[str]) -> Edit:
    """Place code of the module before its first definition, or before whatever needs it sooner."""
    source, start = store.source, _before_definitions(store, anchor)
    before = source.text[:start].replace("\r\n", "\n")
    gap = "" if before.endswith("\n\n") or not before.strip() else "\n\n"
    return Edit(start, start, gap + "\n".join(lines) + "\n\n\n")


def _before_definitions(store: Store, anchor: Anchor) -> int:
    source = store.source
    needing = [source.top_level(store.place)] if source.parents.get(store.place) else []
    needing += [source.top_level(anchor.statement)] if anchor.source is source else []
    definitions = [each for each in source.tree.body if isinstance(each, Function | ast.ClassDef)]
    return _above_comments(source, min(source.line_start(each) for each in [*definitions, *needing]))


def _state(store: Store, anchor: Anchor) -> ast.stmt | None:
    """Return the variable of the module behind which others read well, or None."""
    source, limit = store.source, _before_definitions(store, anchor)
    before = [each for each in source.tree.body if source.end(each) <= limit]
    last = before[-1] if before else None
    return last if isinstance(last, ast.Assign | ast.AnnAssign) and source.alone(last) else None


def _above_comments(source: Document, start: int) -> int:
    """Move up over the comment that belongs to a line, but not over the head of the file."""
    index = source.line_starts.index(start)
    while index > 2 and source.text[source.line_starts[index - 1] :].lstrip(" \t").startswith("#"):
        index -= 1
    return source.line_starts[index]


def _first_registration(anchor: Anchor) -> ast.stmt | None:
    """Return the first statement of a constructor from which a callback can run, if the anchor is in one."""
    method = anchor.source.method(anchor.statement)
    if method is None or method[1].name != "__init__":
        return None
    for statement in method[1].body:
        inside = list(ast.walk(statement))
        called = {ast.unparse(each.func).rpartition(".")[2] for each in inside if isinstance(each, ast.Call)}
        if called & REGISTERING or anchor.statement in inside:
            return statement if anchor.source.leads(statement) else None
    return None


def _instance(anchor: Anchor) -> str:
    method = anchor.source.method(anchor.statement)
    return method[2] if method else "self"


def _kept(store: Store, anchor: Anchor, name: str) -> str:
    return f"{_instance(anchor)}.{name}" if store.owner else name


def _field(message: str, field: str) -> str:
    """Write the access to a dotted field; a number indexes a sequence, which may be too short."""
    code, checks = message, list[str]()
    for part in field.split("."):
        if part.lstrip("-").isdigit():
            index = int(part)
            checks.append(f"len({code}) > {index}" if index >= 0 else f"len({code}) >= {-index}")
            code = f"{code}[{index}]"
        elif part.isidentifier():
            code = f"{code}.{part}"
        else:
            raise RepairError(f"Field {field!r} of a sensor is not a dotted path of names and indices.")
    return f"{code} if {' and '.join(checks)} else None" if checks else code
