"""Find the names that a module imports, and add imports where a maintainer would."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from pytest_tarl.patching.document import Document, Edit, Function


@dataclass(frozen=True, slots=True)
class Import:
    """`from module import name as alias`, or `import module` if `name` is empty."""

    module: str
    name: str = ""
    alias: str = ""

    @property
    def written(self) -> str:
        """Return the text that follows `import`."""
        name = self.name or self.module
        return f"{name} as {self.alias}" if self.alias and self.alias != name else name


def imported(source: Document, module: str, name: str) -> str:
    """Return the expression for `module.name` in this file; empty if it is not imported."""
    for node in top_imports(source):
        if isinstance(node, ast.ImportFrom) and node.module == module and not node.level:
            for alias in node.names:
                if alias.name in (name, "*"):
                    return alias.asname or name
        elif isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name == module:
                    return f"{alias.asname or module}.{name}"
    return ""


def reference(source: Document, module: str, name: str) -> tuple[str, Import | None] | None:
    """Return the expression for a new name of `module`, and the import to add (or None).

    Return None if the file imports nothing from `module`. Modules match if one dotted name ends with the other, which
    covers relative imports and files that are run as scripts.
    """
    leaf = module.rpartition(".")[2]
    for node in top_imports(source):
        if isinstance(node, ast.ImportFrom):
            origin = "." * node.level + (node.module or "")
            if _same(node.module or "", module):
                return name, Import(origin, name)
            for alias in node.names:
                if alias.name == leaf and _same(f"{node.module or ''}.{leaf}".lstrip("."), module):
                    return f"{alias.asname or leaf}.{name}", None
        else:
            for alias in node.names:
                if _same(alias.name, module):
                    return f"{alias.asname or alias.name}.{name}", None
    return None


def import_edits(source: Document, wanted: Iterable[Import]) -> list[Edit]:
    """Return edits that add imports; an existing import from the same module is extended."""
    by_module: dict[str, list[Import]] = {}
    for each in dict.fromkeys(wanted):
        by_module.setdefault(each.module, []).append(each)
    return [edit for module, group in by_module.items() for edit in _added(source, module, group)]


def top_imports(source: Document) -> Iterator[ast.Import | ast.ImportFrom]:
    """Yield the imports outside functions, in order."""
    for node in ast.walk(source.tree):
        if isinstance(node, ast.Import | ast.ImportFrom) and source.function(node) is None:
            yield node


def _same(imported_as: str, module: str) -> bool:
    shorter, longer = sorted((imported_as.split("."), module.split(".")), key=len)
    return bool(imported_as) and longer[-len(shorter) :] == shorter


def _added(source: Document, module: str, group: Sequence[Import]) -> Iterator[Edit]:
    """Yield the edits that import more names from a module."""
    for node in _import_block(source):
        same = isinstance(node, ast.ImportFrom) and "." * node.level + (node.module or "") == module
        if same and group[0].name:
            yield from (_extended(source, node, each) for each in group)
            return
    names = ", ".join(each.written for each in group)
    yield _new_line(source, module, f"from {module} import {names}" if group[0].name else f"import {names}")


def _extended(source: Document, node: ast.Import | ast.ImportFrom, wanted: Import) -> Edit:
    """Add a name to an import; keep names sorted, or on separate lines, if they are."""
    names = [alias.name for alias in node.names]
    later = [alias for alias in node.names if alias.name > wanted.name and names == sorted(names)]
    neighbour = later[0] if later else node.names[-1]
    start = source.offset(neighbour.lineno, neighbour.col_offset)
    indent = source.text[source.line_starts[neighbour.lineno - 1] : start]
    between = f",\n{indent}" if indent.isspace() and len(names) > 1 else ", "
    if later:
        return Edit(start, start, wanted.written + between)
    end = source.offset(neighbour.end_lineno or neighbour.lineno, neighbour.end_col_offset or 0)
    return Edit(end, end, between + wanted.written)


def _new_line(source: Document, module: str, line: str) -> Edit:
    """Add an import to the block at the top of the module, next to similar ones."""
    block = [node for node in _import_block(source) if source.alone(node)]
    kind = f".{module.rpartition('.')[2]}"
    alike = [
        node for node in block if isinstance(node, ast.ImportFrom) and (node.module or "").endswith(kind)
    ]
    earlier = [node for node in alike if (node.module or "") < module]
    if alike and not earlier:
        start = source.line_start(alike[0])
        return Edit(start, start, f"{line}\n")
    if block:
        end = source.line_end((earlier or block)[-1])
        return Edit(end, end, f"\n{line}")
    body = source.tree.body
    if ast.get_docstring(source.tree, clean=False) is not None and source.alone(body[0]):
        end = source.line_end(body[0])
        return Edit(end, end, f"\n\n{line}")
    start = source.line_start(body[0])
    return Edit(start, start, f"{line}\n\n")


def _import_block(source: Document) -> Iterator[ast.Import | ast.ImportFrom]:
    for node in source.tree.body:
        if isinstance(node, Function | ast.ClassDef):
            return
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node
