"""Choose where an added subscription stores its values: on the instance or in the module."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.anchors import REGISTERING, Anchor
from pytest_tarl.patching.document import Document, Edit, Function


@dataclass(frozen=True)
class Store:
    """A place to store values: attributes on instances of `owner`, or module globals if it is None.

    `places` are the syntax nodes that read the values. `module` is the dotted name by which other modules import this
    one if they subscribe.
    """

    source: Document
    owner: ast.ClassDef | None = None
    instance: str = ""
    module: str = ""
    places: list[ast.AST] = field(default_factory=list)

    def variable(self, name: str) -> str:
        """Return the expression that reads a value."""
        return f"{self.instance}.{name}" if self.owner else name


@dataclass(frozen=True)
class Callback:
    """A function that a repair adds; it stores message fields in variables (`names`: field → variable)."""

    store: Store
    anchor: Anchor
    name: str
    names: Mapping[str, str]
    annotation: str = ""

    def lines(self, instance: str = "") -> list[str]:
        """Return the lines of the function; with `instance`, it is a method."""
        unit = self.store.source.unit
        argument = "message" if "message" not in self.names.values() else "received"
        typed = f"{argument}: {self.annotation}" if self.annotation else argument
        parameters = f"{instance}, {typed}" if instance else typed
        returned = " -> None" if self.annotation else ""
        shared = [] if instance else [f"{unit}global {', '.join(self.names.values())}"]
        owner = f"{instance}." if instance else ""
        stored = [f"{unit}{owner}{name} = {_field(argument, path)}" for path, name in self.names.items()]
        return [f"def {self.name}({parameters}){returned}:", *shared, *stored]


def store_edits(callbacks: Sequence[Callback]) -> list[tuple[str, Edit]]:
    """Return the edits (with paths) that add the callbacks and their variables."""
    edits: list[tuple[str, Edit]] = []
    modules: dict[str, list[Callback]] = {}
    for callback in callbacks:
        path = callback.store.source.path
        if callback.store.owner is None:
            modules.setdefault(path, []).append(callback)
        else:
            edits += [(path, edit) for edit in _instance_edits(callback, callback.store.owner)]
    for path, group in modules.items():
        edits += [(path, edit) for edit in _module_edits(group)]
    return edits


def first_statement(definition: Function | ast.ClassDef) -> ast.stmt:
    """Return the first statement after the docstring; the docstring itself if there is no other."""
    documented = ast.get_docstring(definition, clean=False) is not None and len(definition.body) > 1
    return definition.body[1 if documented else 0]


def _instance_edits(callback: Callback, owner: ast.ClassDef) -> list[Edit]:
    """Initialise attributes before any code reads them; put the callback after the method that subscribes."""
    source, method = callback.store.source, callback.anchor.source.method(callback.anchor.statement)
    if method is None:
        raise RepairError(f"{source.path}: {owner.name} cannot subscribe outside its methods.")
    end, indent = source.line_end(method[1]), source.indentation(method[1])
    text = "\n".join(indent + line for line in callback.lines(method[2]))
    crowded = re.match(r"\r?\n[ \t]*\S", source.text[end:])
    after = "\n" if crowded else ""
    return [_attributes(callback, owner, method[1], method[2]), Edit(end, end, f"\n\n{text}{after}")]


def _attributes(callback: Callback, owner: ast.ClassDef, method: Function, instance: str) -> Edit:
    source, names = callback.store.source, callback.names.values()
    early = _first_reader(callback, owner, method, instance) if method.name == "__init__" else None
    if early is not None and source.leads(early):
        start, indent = source.start(early), source.indentation(early)
        return Edit(start, start, "".join(f"{instance}.{name} = None\n{indent}" for name in names))
    first = first_statement(owner)
    start, indent = source.line_start(first), source.indentation(first)
    return Edit(start, start, "".join(f"{indent}{name} = None\n" for name in names) + "\n")


def _first_reader(
    callback: Callback, owner: ast.ClassDef, constructor: Function, instance: str
) -> ast.stmt | None:
    """Return a constructor's first statement that may read an attribute, directly or through a call."""
    methods = {f"{instance}.{each.name}" for each in owner.body if isinstance(each, Function)}
    for statement in constructor.body:
        inside = list(ast.walk(statement))
        calls = {ast.unparse(each.func) for each in inside if isinstance(each, ast.Call)}
        registers = any(call.rpartition(".")[2] in REGISTERING for call in calls)
        reads = any(each is place for each in inside for place in callback.store.places)
        if registers or reads or calls & methods or callback.anchor.statement in inside:
            return statement
    return None


def _module_edits(callbacks: Sequence[Callback]) -> list[Edit]:
    """Put variables and functions before the first definition, or before an earlier statement that needs them.

    If there are module variables just before this place, add the new ones after them.
    """
    source = callbacks[0].store.source
    start = _before_definitions(source, callbacks)
    names = [name for callback in callbacks for name in callback.names.values()]
    initial = "".join(f"{name} = None\n" for name in names)
    functions = "".join("\n".join(callback.lines()) + "\n\n\n" for callback in callbacks)
    state = _state(source, start)
    if state is not None:
        end = source.line_end(state)
        return [
            Edit(end, end, f"\n{initial}".removesuffix("\n")),
            Edit(start, start, _gap(source, start) + functions),
        ]
    return [Edit(start, start, f"{_gap(source, start)}{initial}\n\n{functions}")]


def _before_definitions(source: Document, callbacks: Sequence[Callback]) -> int:
    """Return the offset of the first definition, or of an earlier statement that needs the callbacks."""
    needing = [place for each in callbacks for place in each.store.places if place in source.parents]
    needing += [each.anchor.statement for each in callbacks if each.anchor.source is source]
    definitions = [each for each in source.tree.body if isinstance(each, Function | ast.ClassDef)]
    first = min(source.line_start(each) for each in [*definitions, *map(source.top_level, needing)])
    return _above_comments(source, first)


def _gap(source: Document, start: int) -> str:
    """Return the empty lines needed between a definition and the text before it."""
    before = source.text[:start].replace("\r\n", "\n")
    return "" if before.endswith("\n\n") or not before.strip() else "\n\n"


def _state(source: Document, limit: int) -> ast.stmt | None:
    """Return the module variable directly before an offset, or None."""
    before = [each for each in source.tree.body if source.end(each) <= limit]
    last = before[-1] if before else None
    return last if isinstance(last, ast.Assign | ast.AnnAssign) and source.alone(last) else None


def _above_comments(source: Document, start: int) -> int:
    """Move up over a line's comment, but not into the first lines of the file."""
    index = source.line_starts.index(start)
    while index > 2 and source.text[source.line_starts[index - 1] :].lstrip(" \t").startswith("#"):
        index -= 1
    return source.line_starts[index]


def _field(message: str, field: str) -> str:
    """Return the expression for a dotted field; a number in it is an index, and the length is checked."""
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
