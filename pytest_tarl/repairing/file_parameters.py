"""Change parameters in the file that sets them, if their names in the program are unknown.

In `config[mean]`, in `get_param(f"~{axis}_gain")` or in a loop over names, one expression reads several parameters.
With `[get_param("~x", 0.0), get_param("~y", 0.0)]`, the node may store the parameters where the analysis cannot follow
them. The episodes of the comparison show the names and values of the parameters that were read. If a YAML, launch or
`.cfg` file sets such a parameter, the number in the file is searched as a constant of its own and always changed in the
file. If no file sets the parameter and the analysis loses its value, as in `min(get_param("~cutoff", 10), rate / 2)`,
the default in the program is searched in the same way.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from statistics import median

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.constant_definitions import (
    PARAMETER_CALLS,
    ParameterInFile,
    Place,
    configured,
    literal_number,
    number_at,
    package_files,
    parameter,
)
from pytest_tarl.patching.document import Document, called, strings
from pytest_tarl.patching.key_paths import belongs, keys_above
from pytest_tarl.patching.launch_numbers import key_of
from pytest_tarl.patching.mutate import analysed_document
from pytest_tarl.repairing.request import Order
from tarl_lint.api import Analysis
from tarl_lint.model import Operand, SiteId, Span

MOST = 16  # maximum number of parameters to search in this way
MOST_PLACES = 2  # maximum number of places that are searched for one parameter if several files may set it
NAMED = 2  # a number in a file belongs to a named node if at least this number of keys stand above it
USE = "use"  # value of --tarl-edit with which only uses are changed

Number = bool | int | float


def file_parameters(order: Order, operands: Sequence[Operand]) -> list[ParameterInFile]:
    """Return the parameters that no single operand represents. Those whose names the data flows read come first."""
    analysis = order.analysis
    calls = {key: one for one in operands if (key := _key_of_call(analysis, one))}
    known: dict[str, list[Operand]] = {}
    for one in operands:
        for key in () if one in calls.values() else _keys(analysis, one):
            known.setdefault(key, []).append(one)
    values = [
        (key, place, size)
        for key, place, size in _values(order, operands)
        if not any(_changes(one, place.value) for one in known.get(key, ()))
    ]
    if not values or order.options.edit == USE:
        return []
    named = dict(_named(analysis))
    found: list[ParameterInFile] = []
    for key, place, size in sorted(values, key=lambda one: one[0] not in named):
        use = _use(analysis, operands, key, calls, named)
        if use is not None and len(found) < MOST:
            written = Span(place.path, place.line, place.start, place.line, place.end)  # offsets as columns
            found.append(ParameterInFile(*use, key, place.value, written, key, (), place, size))
    return found


def _changes(use: Operand, value: Number | None) -> bool:
    """Return whether a change at a use can change the parameter. A factor there cannot change 0 or a boolean."""
    return use.value is not None or (bool(value) and not isinstance(value, bool))


def _values(order: Order, operands: Sequence[Operand]) -> Iterator[tuple[str, Place, float]]:
    """Yield parameter keys, each with its number in a file, or else with its default in the program.

    The last element is a likely size for a parameter whose value is 0, and otherwise 0. Defaults that are operands are
    left out.
    """
    read = order.online.recorded.parameters
    texts = files_of_packages(order) if read else {}
    for name, value in read.items():
        key = name.rpartition("/")[2]
        for place in places_in_force(name, value, texts)[:MOST_PLACES]:
            yield key, place, _usual_size(key, read) if not value else 0.0
    given = {name.rpartition("/")[2] for name in read}
    used = {span for one in operands for span in (one.span, one.definition, *one.definitions)}
    for path in order.analysis.sources:
        for key, place, spans in _defaults(order.analysis, path):
            if key not in given and used.isdisjoint(spans) and place.value:
                yield key, place, 0.0


def _defaults(analysis: Analysis, path: str) -> Iterator[tuple[str, Place, set[Span]]]:
    """Yield the parameters read with a literal default, with the spans of default and call."""
    try:
        source = analysed_document(analysis, path)
    except RepairError:
        return
    for node in ast.walk(source.tree):
        if not isinstance(node, ast.Call) or called(node) not in PARAMETER_CALLS or not node.args:
            continue
        names = strings(node.args[:1])
        others = [*node.args[1:2], *(one.value for one in node.keywords if one.arg in ("default", "value"))]
        for number in others:
            value = literal_number(number)
            if value is None or not names:
                continue
            key = key_of(names[0])
            place = number_at(source, number, key, value)
            if place is not None:
                yield key, place, {source.span(number), source.span(node)}


def files_of_packages(order: Order) -> dict[str, str]:
    """Return the texts of the configuration files of the nodes' packages, by path."""
    return package_files(
        order.root.resolve(), *((order.root / path).resolve() for path in order.analysis.sources)
    )


def places_in_force(name: str, value: Number, texts: Mapping[str, str]) -> list[Place]:
    """Return the numbers in files that may have set a parameter, given its absolute name and its value.

    There are three kinds of places, from the best to the worst. Only places of the best kind found are returned:

    - a value in a YAML file whose keys name the node
    - a value in any other file
    - a default in a `.cfg` file, which is in force only if no other file sets the parameter
    """
    ranked: dict[int, list[Place]] = {}
    for place in configured(name, texts):
        if isinstance(place.value, bool) == isinstance(value, bool) and place.value == value:
            keys = keys_above(place, texts[place.path])
            if keys is None or belongs(name, keys):
                ranked.setdefault(_rank(place, keys), []).append(place)
    return ranked[min(ranked)] if ranked else []


def _rank(place: Place, keys: Sequence[str] | None) -> int:
    """Return 0 for a number under a node's names, 1 for other files, 2 for a `.cfg` default."""
    return 2 if place.path.endswith(".cfg") else int(keys is None or len(keys) < NAMED)


def uses_of(
    analysis: Analysis, parameter: ParameterInFile, operands: Sequence[Operand]
) -> tuple[Operand, ...]:
    """Return the operands that each represent a parameter in a file; none if they cannot change its value."""
    uses = tuple(one for one in operands if parameter.setting in _keys(analysis, one))
    return uses if any(_changes(one, parameter.value) for one in uses) else ()


def is_table(order: Order, operand: Operand) -> bool:
    """Return whether an operand is a whole table of parameters, which no factor can change."""
    key = key_of(parameter(order.analysis, operand)) if operand.value is None else ""
    return bool(key) and any(f"/{key}/" in name for name in order.online.recorded.parameters)


def reads_one(analysis: Analysis, operand: Operand) -> bool:
    """Return whether an operand is the call that reads one parameter."""
    return bool(_key_of_call(analysis, operand))


def _key_of_call(analysis: Analysis, operand: Operand) -> str:
    """Return the parameter's key if the operand is the call that reads it, else ""."""
    node = _node(analysis, operand)
    if not isinstance(node, ast.Call) or called(node) not in PARAMETER_CALLS:
        return ""
    return key_of(parameter(analysis, operand))


def _keys(analysis: Analysis, operand: Operand) -> Iterator[str]:
    """Yield the keys of the parameters that an operand may represent."""
    yield key_of(parameter(analysis, operand))
    if operand.value is not None:
        yield operand.code.rpartition(".")[2]


def _is_nameless(analysis: Analysis, operand: Operand) -> bool:
    """Return whether an operand has no known value and no known parameter."""
    return operand.value is None and not operand.definitions and not parameter(analysis, operand)


def _use(
    analysis: Analysis,
    operands: Sequence[Operand],
    key: str,
    calls: Mapping[str, Operand],
    named: Mapping[str, tuple[SiteId, Span]],
) -> tuple[SiteId, Span] | None:
    """Return the statement and expression that likely use a parameter, or None if there is no data flow.

    The first of these that exists is returned:

    - the call that reads the parameter
    - an expression without a known parameter, in a function that contains the key
    - an expression in a flow with the parameter's name
    - any expression without a known parameter
    - any expression
    """
    if key in calls:
        return calls[key].site, calls[key].span
    nameless = [one for one in operands if _is_nameless(analysis, one)]
    near = next((one for one in nameless if key in _texts(analysis, one)), None)
    if near is None and key in named:
        return named[key]
    one = near or next(iter([*nameless, *operands]), None)
    return (one.site, one.span) if one is not None else next(iter(named.values()), None)


def _named(analysis: Analysis) -> Iterator[tuple[str, tuple[SiteId, Span]]]:
    """Yield the names and attributes that the statements of flows read, each with its statement and place."""
    read = {path: list(_read(analysis, path)) for path in {step.span.path for step in analysis.sites}}
    for step in reversed(analysis.sites):
        for source, node in read[step.span.path]:
            if step.span.line <= node.lineno <= step.span.end_line:
                yield ast.unparse(node).rpartition(".")[2], (step.site, source.span(node))


def _read(analysis: Analysis, path: str) -> Iterator[tuple[Document, ast.expr]]:
    """Yield the names and attributes that a file reads, each with the file."""
    try:
        source = analysed_document(analysis, path)
    except RepairError:
        return
    for node in ast.walk(source.tree):
        if isinstance(node, ast.Name | ast.Attribute) and isinstance(node.ctx, ast.Load):
            yield source, node


def _texts(analysis: Analysis, operand: Operand) -> set[str]:
    """Return the strings in the function around an operand."""
    node = _node(analysis, operand)
    if node is None:
        return set()
    source = analysed_document(analysis, operand.span.path)
    return set(strings(ast.walk(source.function(source.statement(node)) or source.tree)))


def _node(analysis: Analysis, operand: Operand) -> ast.expr | None:
    try:
        return analysed_document(analysis, operand.span.path).at(operand.span)
    except RepairError:
        return None


def _usual_size(key: str, read: Mapping[str, Number]) -> float:
    """Return a likely size for a parameter whose value is 0: the median size of parameters with similar names."""
    first = re.split(r"[_.]", key)[0]
    alike = [
        abs(value)
        for name, value in read.items()
        if value and not isinstance(value, bool) and name.rpartition("/")[2].split("_")[0] == first
    ]
    return float(median(alike)) if alike else 0.0
