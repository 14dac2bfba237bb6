"""Find where a constant is defined: in code, YAML, launch or .cfg files."""

from __future__ import annotations

import ast
import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.document import Document, Edit, called, document, parse, strings
from pytest_tarl.patching.expression_texts import number
from pytest_tarl.patching.launch_numbers import computed, key_of, numerals
from tarl_lint.model import Operand, Span

if TYPE_CHECKING:
    from tarl_lint.api import Analysis

PARAMETER_CALLS = ("declare_parameter", "get_param", "get_parameter_or", "cached_param")
# rclpy method that declares several parameters: a namespace and (name, default) pairs
SEVERAL = "declare_parameters"
_CONVERSIONS = ("int", "float", "round")
ENTRY = "get"  # method that reads an entry of a mapping parameter
_FOREIGN = {".git", ".tarl", ".venv", "venv", "build", "install", "log", "node_modules", "__pycache__"}
_MOST_FILES = 400  # maximum number of configuration files to read per package
ENVIRONMENT = ("os.environ.get", "environ.get", "os.getenv", "getenv")
_NUMERAL = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_NUMBER = r"(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|true|false|True|False)"
_ARGUMENT = r"\$\((?:arg|var) ([\w-]+)\)"  # matches a value taken from a launch argument
_PLAIN = re.compile(r"[-+]?\d+")


@dataclass(frozen=True, slots=True)
class Place:
    """A number at a definition: its offsets `start` and `end` in a file, its name there, and its value.

    To multiply the constant by f, multiply the number by (1 + (f - 1) · `share`).
    """

    path: str
    start: int
    end: int
    line: int
    name: str
    value: bool | int | float
    share: float = 1.0


@dataclass(frozen=True, slots=True)
class ParameterInFile(Operand):
    """A parameter that is changed in the file that sets it, because its uses read several parameters.

    `span` is a use of the parameter. If its value is 0, `size` is the usual size of such a parameter, or 0 if that is
    unknown.
    """

    place: Place | None = None
    size: float = 0.0


def defined(analysis: Analysis, operand: Operand) -> tuple[Place, ...]:
    """Return where an operand's constants are defined, if all are numbers outside the use; else nothing.

    An operand can have several definitions, for example if it is a parameter of a function with several calls. Zeros
    beside other numbers are left out, because a factor does not change them.
    """
    if operand.literal:
        return ()
    spans = (operand.definition,) if operand.definition is not None else operand.definitions
    found = [_defined_at(analysis, operand, span) for span in spans]
    places = tuple(place for place in found if place is not None)
    if len(places) < len(spans):
        return ()
    return tuple(place for place in places if place.value or operand.value == 0)


def alternatives(analysis: Analysis, places: Sequence[Place]) -> bool:
    """Return whether the program chooses between these numbers."""
    holders = [_holders(analysis, place) for place in places] if len(places) > 1 else []
    return any(one & other for one, other in itertools.combinations(holders, 2))


def _holders(analysis: Analysis, place: Place) -> set[tuple[str, int, int]]:
    """Return path and offsets of each table literal and conditional expression around a number."""
    source = document(place.path, analysis.sources[place.path])
    return {
        (place.path, source.start(node), source.end(node))
        for node in ast.walk(source.tree)
        if isinstance(node, ast.Dict | ast.List | ast.Tuple | ast.IfExp)
        and source.start(node) <= place.start
        and place.end <= source.end(node)
    }


def _defined_at(analysis: Analysis, operand: Operand, span: Span) -> Place | None:
    """Return the number where an operand's constant is defined, or None if there is none."""
    if span.path not in analysis.sources:
        return None
    source = document(span.path, analysis.sources[span.path])
    node = _written(source.at(span))
    value = literal_number(node)
    if node is None or value is None or operand.value not in (None, value):
        return None
    name = parameter(analysis, operand) or _name(source, node) or operand.code
    return number_at(source, node, name, value)


def number_at(
    source: Document, node: ast.expr, name: str, value: bool | int | float, share: float = 1.0
) -> Place | None:
    """Return the place of a number with this name and value; in a string, the place inside the quotes.

    Return None if the text of the string is not exactly its value, for example because of escape sequences.
    """
    start, end = source.start(node), source.end(node)
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        numeral = node.value.strip()
        start = source.text.find(numeral, start, end)
        end = start + len(numeral)
    return Place(source.path, start, end, node.lineno, name, value, share) if start >= 0 else None


def parameter(analysis: Analysis, operand: Operand) -> str:
    """Return the ROS parameter or configuration key that an operand's value comes from, or an empty text.

    The value may be the default of the parameter.
    """
    span = operand.definition
    if operand.setting or span is None or span.path not in analysis.sources:
        return operand.setting
    source = document(span.path, analysis.sources[span.path])
    node = _converted(source.at(span))
    if (key := entry_key(node)) and operand.value is None:
        return key  # an entry of a table parameter
    around = [node, *source.ancestors(node)] if node is not None else []
    entry = next((each for each in around if isinstance(each, ast.Tuple | ast.List)), None)
    for each in around:
        if isinstance(each, ast.Call) and called(each) == SEVERAL:
            return _entry_name(each, entry)
        if isinstance(each, ast.Call) and called(each) in PARAMETER_CALLS:
            return next(iter(strings(each.args[:1])), "")
        if isinstance(each, ast.Call) and node in each.args[1:] and called(each) == ENTRY:
            return _entry_of_parameter(each)
        if isinstance(each, ast.stmt):
            break
    return ""


def entry_key(node: ast.expr | None) -> str:
    """Return the key of an entry: "gain" for `table["gain"]` or `table.get("gain")`."""
    if isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Load):
        return next(iter(strings([node.slice])), "")
    if isinstance(node, ast.Call) and called(node) == ENTRY and len(node.args) == 1:
        return next(iter(strings(node.args)), "")
    return ""


def _converted(node: ast.expr | None) -> ast.expr | None:
    """Remove conversions to a number: `int(get_param("~times"))` becomes the call of `get_param`."""
    while isinstance(node, ast.Call) and called(node) in _CONVERSIONS and len(node.args) == 1:
        node = node.args[0]
    return node


def package_files(root: Path, *nodes: Path) -> dict[str, str]:
    """Return path (relative to `root`) → text for the configuration files of the nodes' packages."""
    found: dict[str, str] = {}
    for top in dict.fromkeys(_package(root, node) for node in nodes):
        found |= _files_in(top, root)
    return found


def _package(root: Path, node: Path) -> Path:
    """Return the package folder that contains a node, or `root`."""
    top = next((folder for folder in node.parents if (folder / "package.xml").is_file()), root)
    return top if top.is_relative_to(root) else root


def _files_in(top: Path, root: Path) -> dict[str, str]:
    """Return path (relative to `root`) → text for at most `_MOST_FILES` configuration files."""
    found: dict[str, str] = {}
    for path in sorted(top.rglob("*")):
        if len(found) >= _MOST_FILES:
            break
        if _kind(path) and not _FOREIGN & {*path.relative_to(top).parts} and path.is_file():
            try:
                found[path.relative_to(root).as_posix()] = path.read_bytes().decode("utf-8")
            except (OSError, UnicodeDecodeError):
                continue
    return found


def configured(name: str, files: Mapping[str, str]) -> Iterator[Place]:
    """Yield the numbers that configuration files assign to the parameter `name`."""
    key = key_of(name)
    for path, text in files.items():
        if _kind(Path(path)) == "launch.py":
            yield from _launched(path, key, text)
            continue
        for match in _matches(_kind(Path(path)), key, text):
            start, end = match
            value = ast.literal_eval(
                text[start:end].capitalize() if text[start].isalpha() else text[start:end]
            )
            yield Place(path, start, end, text.count("\n", 0, start) + 1, key, value)


def _launched(path: str, key: str, text: str) -> Iterator[Place]:
    """Yield the numbers in a Python launch file that determine a parameter."""
    source = _python(path, text)
    if source is None:
        return
    for one in numerals(key, source.tree):
        place = number_at(source, one.node, _target(source, one.node) or key, one.value, one.share)
        if place is not None:
            yield place


def _target(source: Document, node: ast.expr) -> str:
    """Return a name for a number, or its place in an expression, or an empty text."""
    around = source.parents.get(node)
    if isinstance(around, ast.Assign) and len(around.targets) == 1:
        return source.source(around.targets[0])
    return f"the {source.source(node)} in {source.source(around)}" if isinstance(around, ast.BinOp) else ""


def computed_at(name: str, files: Mapping[str, str]) -> str:
    """Describe where a launch file computes a parameter without a number to change, or return an empty text."""
    key = key_of(name)
    for path, text in files.items():
        source = _python(path, text) if _kind(Path(path)) == "launch.py" else None
        node = next(computed(key, source.tree), None) if source is not None else None
        if source is not None and node is not None:
            return f"{path}:{node.lineno} computes it as `{' '.join(source.source(node).split())[:80]}`"
    return ""


def _python(path: str, text: str) -> Document | None:
    try:
        return Document(path, text, parse(text))
    except (SyntaxError, ValueError):
        return None


def redefined(place: Place, value: bool | int | float) -> str:
    """Format a new value in the style of the old one: `true`, `3`, `0.75`."""
    if isinstance(value, bool):
        return str(value)
    whole = isinstance(place.value, int) and float(value).is_integer()
    return number(int(value) if whole else float(value))


def edits(places: Mapping[Place, bool | int | float], text: str) -> list[Edit]:
    """Return the edits to one file. Raise RepairError if a place no longer has its number."""
    found = []
    for place, value in places.items():
        new = redefined(place, value)
        old = text[place.start : place.end]
        lower = old in ("true", "false")
        if old.capitalize() != str(place.value) and not _same(old, place.value):
            raise RepairError(
                f"{place.path}:{place.line}: expected {place.value}, but the file changed: run again."
            )
        found.append(Edit(place.start, place.end, new.lower() if lower else new))
    return found


def _written(node: ast.expr | None) -> ast.expr | None:
    """Return the number in an expression, such as a default inside `float(…)`."""
    while isinstance(node, ast.Call):
        function = ast.unparse(node.func)
        if function in ("float", "int") and len(node.args) == 1 and not node.keywords:
            node = node.args[0]
        elif function in ENVIRONMENT:
            named = (one.value for one in node.keywords if one.arg == "default")
            return next(iter([*node.args[1:2], *named]), None)
        else:
            return None
    return node


def literal_number(node: ast.expr | None) -> bool | int | float | None:
    """Return the number in a literal or string, or None."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str) and re.fullmatch(_NUMERAL, node.value):
        return int(node.value) if _PLAIN.fullmatch(node.value) else float(node.value)
    if negative := isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        node = node.operand
    if not isinstance(node, ast.Constant) or not isinstance(node.value, int | float):
        return None
    return -node.value if negative else node.value


def _same(old: str, value: float) -> bool:
    try:
        return float(old) == float(value)
    except ValueError:
        return False


def users(analysis: Analysis, used: Sequence[Operand]) -> list[str]:
    """Return where else the operands' constants are used, as `path:line`."""
    mine = {(operand.span.path, operand.span.line) for operand in used}
    spans = {span for operand in used for span in (operand.definition, *operand.definitions)} - {None}
    names = {key_of(parameter(analysis, operand)) for operand in used} - {""}
    found: dict[str, None] = {}
    for step in analysis.sites:
        for operand in analysis.operands(step.site):
            theirs = {operand.definition, *operand.definitions}
            shared = not spans.isdisjoint(theirs) or key_of(parameter(analysis, operand)) in names
            if shared and (operand.span.path, operand.span.line) not in mine:
                found[f"{operand.span.path}:{operand.span.line}"] = None
    return list(found)


def _entry_of_parameter(call: ast.Call) -> str:
    """Return the key of an entry that is read from a parameter."""
    of_environment = ast.unparse(call.func) in ENVIRONMENT
    return "" if of_environment else next(iter(strings(call.args[:1])), "")


def _entry_name(call: ast.Call, entry: ast.AST | None) -> str:
    """Return the parameter that an entry of `declare_parameters` declares, with its namespace."""
    elements = entry.elts if isinstance(entry, ast.Tuple | ast.List) else []
    namespace = [*call.args[:1], *(one.value for one in call.keywords if one.arg == "namespace")]
    texts = strings((*namespace[:1], *elements[:1]))
    return ".".join(text for text in texts if text) if len(texts) > 1 else ""


def _name(source: Document, node: ast.expr) -> str:
    """Return the variable or parameter that a literal defines, or an empty text."""
    key = ""
    inner: ast.AST = node
    for each in source.ancestors(node):
        child, inner = inner, each
        if isinstance(each, ast.Dict | ast.List | ast.Tuple) and isinstance(child, ast.expr):
            key = _key(source, each, child) + key
            continue
        if isinstance(each, ast.Assign) and len(each.targets) == 1:
            return source.source(each.targets[0]) + key
        if isinstance(each, ast.AnnAssign):
            return source.source(each.target) + key
        if isinstance(each, ast.arguments):
            named = [*each.posonlyargs, *each.args]
            pairs = zip(named[len(named) - len(each.defaults) :], each.defaults, strict=True)
            keywords = zip(each.kwonlyargs, each.kw_defaults, strict=True)
            return next((arg.arg for arg, default in (*pairs, *keywords) if default is node), "")
        if isinstance(each, ast.stmt):
            break
    return ""


def _key(source: Document, table: ast.Dict | ast.List | ast.Tuple, entry: ast.expr) -> str:
    """Return the subscript for an entry of a table, such as `["hold"]` or `[2]`."""
    if isinstance(table, ast.Dict):
        keys = [key for key, value in zip(table.keys, table.values, strict=True) if value is entry and key]
        return f"[{source.source(keys[0])}]" if keys else ""
    return f"[{table.elts.index(entry)}]"


def _kind(path: Path) -> str:
    if path.suffix in (".yaml", ".yml", ".json"):
        return "yaml"
    if path.suffix == ".toml":
        return "toml"
    if path.name.endswith((".launch", ".launch.xml", "_launch.xml")):
        return "launch"
    if path.name.endswith((".launch.py", "_launch.py")):
        return "launch.py"
    return "cfg" if path.suffix == ".cfg" else ""


def _matches(kind: str, key: str, text: str) -> Iterator[tuple[int, int]]:
    """Yield the offsets (start, end) of the numbers assigned to a key."""
    if kind == "cfg":
        yield from _added(key, text)
        return
    word = re.escape(key)
    if kind == "toml":
        for match in re.finditer(rf"(?m)^[ \t]*{word}[ \t]*=[ \t]*{_NUMBER}(?=[ \t]*(?:\#|\r?\n|$))", text):
            yield match.span("number")
        return
    patterns = [rf"""(?<![\w.-])["']?{word}["']?[ \t]*:[ \t]*{_NUMBER}(?=[ \t]*(?:\#|,|\}}|\)|<|\r?\n|$))"""]
    if kind == "launch":
        words = [
            word,
            *(re.escape(one) for one in re.findall(rf"{_named(word)}{_ARGUMENT}", text) if one != key),
        ]
        patterns += [rf"""{_named(one)}{_NUMBER}[ \t]*["']""" for one in dict.fromkeys(words)]
    for pattern in patterns:
        for match in re.finditer(pattern, text):
            yield match.span("number")


def _named(word: str) -> str:
    """Return a pattern that matches a launch-file element of this name, up to its value."""
    named = rf"""name[ \t]*=[ \t]*["'](?:[^"']*(?<![\w-]))?{word}["'][^<>]*?"""
    return rf"""{named}(?:value|default)[ \t]*=[ \t]*["'][ \t]*"""


def _added(key: str, text: str) -> Iterator[tuple[int, int]]:
    """Yield the offsets of defaults in a dynamic_reconfigure file: `gen.add(name, type, level, text, default, …)`."""
    source = _python("", text)
    if source is None:
        return
    for node in ast.walk(source.tree):
        if not (
            isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "add"
        ):
            continue
        named = {each.arg: each.value for each in node.keywords}
        first = node.args[0] if node.args else named.get("name")
        default = node.args[4] if len(node.args) > 4 else named.get("default")
        named_so = isinstance(first, ast.Constant) and first.value == key
        if named_so and isinstance(default, ast.Constant) and isinstance(default.value, int | float):
            yield source.start(default), source.end(default)
