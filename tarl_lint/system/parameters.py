"""The strings of a program, which include its parameter names."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from typing import Final

from tarl_lint.evidence import Outline
from tarl_lint.parameter_names import ARGUMENTS
from tarl_lint.read.source import Module
from tarl_lint.system.own_strings import OwnStrings
from tarl_lint.trees import last_name

READERS: Final = frozenset(
    ["get_param", "get_param_cached", "has_param", "search_param", "declare_parameter", "declare_parameters",
     "get_parameter", "get_parameter_or", "get_parameters", "get_parameters_by_prefix", "has_parameter"]
)  # fmt: skip
OPEN: Final = re.compile(
    r"(?:automatically_declare_parameters_from_overrides|allow_undeclared_parameters)(?!\s*=\s*False)|"
    r"get_parameters_by_prefix|get_param_names|rosparam|param_server|generate_parameter_library|"
    r"dynamic_reconfigure\.(?!server\b)|import dynamic_reconfigure|from dynamic_reconfigure import"
)
_SERVER: Final = "dynamic_reconfigure.server"

COMMAND_LINE: Final = re.compile(r"\b(?:sys\.argv|myargv|argparse|optparse)\b")
# matches the places of a format string where a value is inserted
_GAPS: Final = re.compile(r"%[sdi]|\{[^{}]*\}")
COPYING: Final = frozenset(
    ["bool", "int", "float", "str", "list", "tuple"]
)  # functions that return the value of their argument


def words(modules: Sequence[Module]) -> frozenset[str]:
    """Return every string of a program as a name: without `~`, slashes around the name, and dots before it.

    Names of fields of classes and of keywords of `dict` count as strings.
    """
    return frozenset(
        text.strip("~/").lstrip(".")
        for module in modules
        for node in ast.walk(module.tree)
        for text in _texts(node)
    )


def private_words(modules: Sequence[Module]) -> frozenset[str]:
    """Return the words that occur only in private names, such as `~path`."""
    texts = {text for module in modules for node in ast.walk(module.tree) for text in _texts(node)}
    own = {one.strip("~/") for one in texts if one.startswith("~")}
    return frozenset(own - {one.strip("/").lstrip(".") for one in texts if not one.startswith("~")})


def _texts(node: ast.AST) -> Iterator[str]:
    match node:
        case ast.Constant(value=str(text)):
            yield text
            yield from _GAPS.split(text) if _GAPS.search(text) else ()
        case (
            ast.For(iter=ast.Constant(value=str(letters)))
            | ast.comprehension(iter=ast.Constant(value=str(letters)))
        ):
            yield from letters
        case ast.ClassDef(body=body):
            yield from (
                one.target.id
                for one in body
                if isinstance(one, ast.AnnAssign) and isinstance(one.target, ast.Name)
            )
        case ast.Call(func=ast.Name(id="dict" | "OrderedDict"), keywords=keywords):
            yield from (one.arg for one in keywords if one.arg)


def scopes(modules: Sequence[Module]) -> tuple[frozenset[str], frozenset[str]]:
    """Return the parameters that a program of rospy reads only as private ones, and those only in its namespace.

    `~gain` is a private one. A name is included only if each string with this name in the program is the literal
    name in such a call.
    """
    if not any("rospy" in module.text for module in modules) or any(
        "rclpy" in module.text for module in modules
    ):
        return frozenset(), frozenset()
    forms: dict[str, set[str]] = {}
    for module in modules:
        nodes = list(ast.walk(module.tree))
        read = {id(node.args[0]) for node in nodes
                if isinstance(node, ast.Call) and node.args and last_name(node.func) in READERS}  # fmt: skip
        for node in nodes:
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                text = node.value
                plain = id(node) in read and "/" not in text
                form = "own" if text.startswith("~") else "namespace"
                forms.setdefault(text.strip("~/"), set()).add(form if plain else "")
    own, namespace = (frozenset(name for name, found in forms.items() if found == {form})
                      for form in ("own", "namespace"))  # fmt: skip
    return own, namespace


def reads_named_parameters(modules: Sequence[Module]) -> bool:
    """Return whether a program states the names of all its parameters."""
    if any(OPEN.search(module.text) for module in modules):
        return False
    outlines = [Outline(module.tree) for module in modules if any(one in module.text for one in READERS)]
    strings = OwnStrings([Outline(module.tree) for module in modules] if outlines else [])
    for outline in outlines:
        calls = (one for found in outline.calls.values() for one in found if last_name(one.func) in READERS)
        if not all(_stated(call, outline, strings) for call in calls):
            return False
    return True


def configurations(modules: Sequence[Module]) -> tuple[str, ...] | None:
    """Return the classes `PACKAGE.cfg.NAMEConfig` of a program whose servers of dynamic_reconfigure add parameters.

    Return None if the class of a server is not certain.
    """
    serving = [module for module in modules if _SERVER in module.text]
    found: list[str] = []
    for module in serving:
        named = [
            f"{node.module}.{alias.name}"
            for node in ast.walk(module.tree)
            if isinstance(node, ast.ImportFrom) and (node.module or "").endswith(".cfg")
            for alias in node.names
        ]
        if not named:
            return None
        found += named
    return tuple(sorted(set(found)))


def _stated(call: ast.Call, outline: Outline, strings: OwnStrings) -> bool:
    """Return whether a call uses only parameters with stated names."""
    several = last_name(call.func) == "declare_parameters"
    named = {one.arg: one.value for one in call.keywords if one.arg}
    if several:
        # `declare_parameters` takes a namespace first, then the parameters
        found = call.args[1] if len(call.args) > 1 else named.get("parameters")
        above = call.args[0] if call.args else named.get("namespace")
        return (
            found is not None
            and strings.holds(found, outline)
            and (above is None or strings.holds(above, outline))
        )
    first = call.args[0] if call.args else named.get("name") or named.get("names") or named.get("param_name")
    return first is None or (not _group(first) and strings.holds(first, outline))


def _group(argument: ast.expr) -> bool:
    """Return whether an argument is no name or a whole group (`~` or `/`)."""
    if not isinstance(argument, ast.Constant):
        return False
    return not isinstance(argument.value, str) or argument.value.rstrip("/") in ("", "~")


def deciding(modules: Sequence[Module]) -> tuple[str, ...]:
    """Return the parameters that are used in conditions, directly or through variables, sorted by name in the code.

    Variables are followed by name, through plain copies and as arguments of the program's functions. A parameter also
    counts if a loop iterates over it or if it is the key of a table look-up, because a launch file may set it to a list
    of names. ARGUMENTS stands for the command line, which may also provide names.
    """
    found = {ARGUMENTS for module in modules if COMMAND_LINE.search(module.text)}
    nodes = [node for module in modules for node in ast.walk(module.tree)]
    asked = [
        *(node.test for node in nodes if isinstance(node, ast.If | ast.IfExp | ast.While)),
        *(node.iter for node in nodes if isinstance(node, ast.For | ast.comprehension)),
        *(node.slice for node in nodes if isinstance(node, ast.Subscript)),
    ]
    stored = [*_assigned(nodes), *_passed(nodes)]
    tests: set[str] = set()
    fresh = {one for condition in asked for one in _variables(condition)}
    while fresh:
        tests |= fresh
        copied = (value for name, value in stored if name in fresh and _copies(value))
        fresh = {one for value in copied for one in _variables(value)} - tests
    for expr in (*asked, *(value for name, value in stored if name in tests)):
        found |= set(_read_in(expr))
    return tuple(sorted(found))


def _assigned(nodes: Sequence[ast.AST]) -> Iterator[tuple[str, ast.expr]]:
    """Yield the last part of each assigned name, with its value."""
    for node in nodes:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                yield from ((one, node.value) for one in _variables(target))


def _passed(nodes: Sequence[ast.AST]) -> Iterator[tuple[str, ast.expr]]:
    """Yield each function parameter with the arguments passed for it."""
    made: dict[str, list[str]] = {}
    for node in nodes:
        if isinstance(node, ast.FunctionDef):
            made.setdefault(node.name, [one.arg for one in node.args.args])
        elif isinstance(node, ast.ClassDef):
            built = (one for one in node.body if isinstance(one, ast.FunctionDef) and one.name == "__init__")
            made.update((node.name, [arg.arg for arg in one.args.args]) for one in built)
    for node in nodes:
        names = made.get(last_name(node.func)) if isinstance(node, ast.Call) else None
        if names is None or not isinstance(node, ast.Call):
            continue
        plain = names[1:] if names[:1] == ["self"] else names
        yield from zip(plain, node.args, strict=False)
        yield from ((one.arg, one.value) for one in node.keywords if one.arg in plain)


def _copies(value: ast.expr) -> bool:
    """Return whether an expression is a variable, possibly negated or converted."""
    if isinstance(value, ast.UnaryOp):
        return _copies(value.operand)
    if isinstance(value, ast.Call):
        return last_name(value.func) in COPYING and len(value.args) == 1 and _copies(value.args[0])
    return isinstance(value, ast.Name | ast.Attribute)


def _variables(expr: ast.AST) -> Iterator[str]:
    """Yield the variables and attributes in an expression, by the last part of their names."""
    for node in ast.walk(expr):
        if isinstance(node, ast.Attribute):
            yield node.attr
        elif isinstance(node, ast.Name) and node.id != "self":
            yield node.id


def _read_in(expr: ast.AST) -> Iterator[str]:
    """Yield the literal names of the parameters that an expression reads."""
    for node in ast.walk(expr):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute | ast.Name) and node.args:
            name = node.func.attr if isinstance(node.func, ast.Attribute) else node.func.id
            first = node.args[0]
            if name in READERS and isinstance(first, ast.Constant) and isinstance(first.value, str):
                yield first.value
