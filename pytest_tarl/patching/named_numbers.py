"""Find numbers, by name, that may define a constant that the analysis cannot follow.

Examples: for `args.gain`, the default in `add_argument("--gain", default=2.0)`; for a table that a loop reads, its
entry `("gain", 2.0)`; for `C[1]`, the second number of `C = array([1.0, 2.0])`. Only a test can show whether the
program really uses a number.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import TYPE_CHECKING

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.constant_definitions import Place, literal_number, number_at
from pytest_tarl.patching.document import Document, called, document, strings
from tarl_lint.model import Operand

if TYPE_CHECKING:
    from tarl_lint.api import Analysis

OPTION = "add_argument"  # argparse method that declares an option
PAIR = 2  # minimum number of elements of a table entry: a name and a number


def named_numbers(analysis: Analysis, operand: Operand) -> list[Place]:
    """Return the numbers that may define an operand, those in its own expression and file first.

    Zeros are left out. If the operand's value is known, so are numbers with other values.
    """
    found: dict[Place | None, None] = {}
    name = _name(analysis, operand)
    for path in sorted(analysis.sources, key=lambda one: one != operand.span.path):
        try:
            source = document(path, analysis.sources[path])
            own = source.find(operand.span) if path == operand.span.path else None
        except RepairError:
            continue
        if own is not None:
            found |= dict.fromkeys(_inside(source, own))
            found |= dict.fromkeys(_elements(source, own))
        for node in ast.walk(source.tree) if name else ():
            found |= dict.fromkeys(_place(source, name, number) for number in _numbers(node, name))
    return [one for one in found if one is not None and one.value and operand.value in (None, one.value)]


def _inside(source: Document, own: ast.expr) -> Iterator[Place | None]:
    """Yield the number of a call that reads a constant by name, if it is the only one."""
    given = [*own.args, *(one.value for one in own.keywords)] if isinstance(own, ast.Call) else []
    texts = strings(given)
    numbers = [one for one in given if _is_number(one)]
    if len(texts) == 1 and len(numbers) == 1:
        yield _place(source, texts[0], numbers[0])


def _elements(source: Document, own: ast.expr) -> Iterator[Place | None]:
    """Yield the list element that an expression reads from an array."""
    if not isinstance(own, ast.Subscript):
        return
    index = literal_number(own.slice)
    if not isinstance(index, int):
        return
    base = ast.unparse(own.value)
    for node in ast.walk(source.tree):
        if not isinstance(node, ast.Assign) or base not in map(ast.unparse, node.targets):
            continue
        made = node.value.args[:1] if isinstance(node.value, ast.Call) else []
        for table in made:
            if isinstance(table, ast.List | ast.Tuple) and -len(table.elts) <= index < len(table.elts):
                element = table.elts[index]
                if _is_number(element):
                    yield _place(source, f"{base}[{index}]", element)


def _name(analysis: Analysis, operand: Operand) -> str:
    """Return the name of a constant: `gain` for `args.gain`, `C["gain"]` and `getattr(self, "gain")`."""
    try:
        node = document(operand.span.path, analysis.sources[operand.span.path]).find(operand.span)
    except (RepairError, KeyError):
        return ""
    if isinstance(node, ast.Call):
        texts = strings(node.args)
        return texts[0].removeprefix("~") if len(texts) == 1 else ""
    if isinstance(node, ast.Subscript):
        return next(iter(strings([node.slice])), "")
    return ast.unparse(node).rpartition(".")[2] if isinstance(node, ast.Name | ast.Attribute) else ""


def _numbers(node: ast.AST, name: str) -> Iterator[ast.expr]:
    """Yield the numbers that code assigns to a name in an option, a table entry or a keyword."""
    if isinstance(node, ast.Call):
        named = {one.arg: one.value for one in node.keywords}
        if called(node) == OPTION and name in _destinations(node, named):
            yield from filter(_is_number, [named[key] for key in named if key == "default"])
        elif name in named and _is_number(named[name]):
            yield named[name]
    elif isinstance(node, ast.Dict):
        for key, value in zip(node.keys, node.values, strict=True):
            if isinstance(key, ast.Constant) and key.value == name and _is_number(value):
                yield value
    elif isinstance(node, ast.Tuple | ast.List) and len(node.elts) >= PAIR:
        first, *rest = node.elts
        if isinstance(first, ast.Constant) and first.value == name:
            yield from [one for one in rest if _is_number(one)][:1]


def _destinations(call: ast.Call, named: dict[str | None, ast.expr]) -> list[str]:
    """Return the attributes in which argparse may store an option."""
    given = [named["dest"]] if "dest" in named else call.args
    return [text.lstrip("-").replace("-", "_") for text in strings(given)]


def _is_number(node: ast.expr) -> bool:
    number = literal_number(node)
    return number is not None and not isinstance(number, bool)


def _place(source: Document, name: str, node: ast.expr) -> Place | None:
    value = literal_number(node)
    return None if value is None else number_at(source, node, name, value)
