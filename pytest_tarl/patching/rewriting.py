"""Write mutations and their guard into the source."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.added_subscriptions import Subscriptions
from pytest_tarl.patching.conditional_changes import (
    Change,
    branched,
    choices,
    doubled,
    lazy,
    neighbours,
    replaced,
)
from pytest_tarl.patching.constant_definitions import Place
from pytest_tarl.patching.constant_definitions import edits as definition_edits
from pytest_tarl.patching.document import Document, Edit, apply_edits, apply_plain_edits
from pytest_tarl.patching.expression_texts import negated, number, scaled, shifted
from pytest_tarl.patching.guards import Reading, always, condition, held
from pytest_tarl.patching.mutate import (
    Mutation,
    analysed_document,
    form_values,
    located,
    needs_integer,
    redefinition,
)
from pytest_tarl.patching.structures import Form, form_edits
from pytest_tarl.patching.templates import PAIR, Template
from pytest_tarl.sensors import Sensor
from tarl_lint.model import Operand, SiteId, Span

if TYPE_CHECKING:
    from tarl_lint.api import Analysis


def conditional_definition(mutations: Sequence[Mutation], guard: Guard) -> bool:
    """Return whether a guard would have to apply to a number at its definition."""
    placed = any(located(mutation).place is not None for mutation in mutations)
    return placed and not all(map(always, guard.conjuncts))


def rewrite(
    analysis: Analysis,
    mutations: Sequence[Mutation],
    guard: Guard,
    topics: Mapping[str, str],
    texts: Mapping[str, str] = MappingProxyType({}),
) -> dict[str, str]:
    """Apply mutations under a guard; return path → new text for every changed file.

    `topics` maps topic names to message types (`std_msgs/msg/Bool`), for subscriptions that have to be added. `texts`
    has further files that define constants. Raise RepairError if a change cannot be written.
    """
    mutations = [located(mutation) for mutation in mutations]
    if conditional_definition(mutations, guard):
        raise RepairError("A number at its definition cannot have a condition.")
    conditions = Conditions(analysis, guard, topics)
    edits: dict[str, list[Edit]] = {}
    here = [mutation for mutation in mutations if mutation.place is None and mutation.form is None]
    for source, statements in _by_file(analysis, here):
        edits[source.path] = list(_file_edits(source, statements, conditions))
    for path, places in _redefined(mutations).items():
        text = analysis.sources.get(path) or texts[path]
        edits.setdefault(path, []).extend(definition_edits(places, text))
    for source, node, form, values, site in _formed(analysis, mutations):
        statement = source.statement(node)
        condition = conditions.at(source, site, statement)
        sensor = (
            conditions.value(form.sensor, source, site, statement)
            if form.sensor is not None
            else form.variable
        )
        edits.setdefault(source.path, []).extend(form_edits(source, node, form, values, condition, sensor))
    for path, added in conditions.subscriptions.edits().items():
        edits[path] = [*added, *edits.get(path, [])]
    return {
        path: apply_edits(analysed_document(analysis, path), edits[path])
        if path in analysis.sources
        else apply_plain_edits(path, texts[path], edits[path])
        for path in sorted(edits)
    }


def _formed(
    analysis: Analysis, mutations: Sequence[Mutation]
) -> Iterator[tuple[Document, ast.expr, Form, dict[str, float], SiteId]]:
    """Yield each form (a template at an expression) once, with the parameters from all its mutations.

    If a form's partner is the same expression for another axis, the form is yielded for both axes.
    """
    found: dict[tuple[Span, Template, str, Span | None], tuple[Mutation, dict[str, float]]] = {}
    for mutation in mutations:
        if mutation.form is not None:
            form = mutation.form
            key = (mutation.operand.span, form.template, form.field, form.partner)
            _, values = found.setdefault(key, (mutation, dict(mutation.form.defaults)))
            moved = form_values(mutation)
            values |= {name: moved[name] for name in moved if name == mutation.form.parameter}
    for (span, template, _, partner), (mutation, values) in found.items():
        if mutation.form is not None:
            source = analysed_document(analysis, span.path)
            yield source, source.find(span), mutation.form, values, mutation.operand.site
            if partner is not None and template.on != PAIR:
                other = replace(
                    mutation.form, partner=None, sensor=mutation.form.sibling or mutation.form.sensor
                )
                yield source, source.find(partner), other, values, mutation.operand.site


def _redefined(mutations: Sequence[Mutation]) -> dict[str, dict[Place, float | int | bool]]:
    """Return the new numbers at definitions, by file."""
    found: dict[str, dict[Place, float | int | bool]] = {}
    for mutation in mutations:
        if mutation.place is not None:
            found.setdefault(mutation.place.path, {})[mutation.place] = redefinition(mutation)
    return found


def guard_text(
    guard: Guard, analysis: Analysis, mutations: Sequence[Mutation], topics: Mapping[str, str]
) -> str:
    """Return the code of the guard at the first mutation, or an empty text."""
    conditions = Conditions(analysis, guard, topics)
    for source, node, _, _, site in _formed(analysis, mutations[:1]):
        return conditions.at(source, site, source.statement(node))
    for source, statements in _by_file(analysis, mutations[:1]):
        for statement, uses in statements:
            return conditions.at(source, uses[0].site, _place(source, statement, uses)(uses[0]))
    return ""


@dataclass(frozen=True)
class Use:
    """A change to one use of a constant, with its site (statement)."""

    site: SiteId
    change: Change


class Conditions:
    """The code of a guard at each place, and the subscriptions that it needs."""

    def __init__(self, analysis: Analysis, guard: Guard, topics: Mapping[str, str]) -> None:
        self._analysis = analysis
        self._guard = guard
        self._topics = topics
        self.subscriptions = Subscriptions(analysis, topics)

    def at(self, source: Document, site: SiteId, place: ast.AST) -> str:
        """Return the guard as Python at a place. Raise RepairError."""
        wanted = [each for each in self._guard.conjuncts if not always(each)]
        readings = {each.sensor.name: self._reading(each, source, site, place) for each in wanted}
        return condition(self._guard, readings, self._topics)

    def value(self, sensor: Sensor, source: Document, site: SiteId, place: ast.AST) -> str:
        """Return the code for a sensor's value, which is 0 before the first message. Raise RepairError."""
        reading = self._reading(Conjunct(sensor, math.inf, math.inf), source, site, place)
        if reading.absent and reading.absent != reading.code:
            raise RepairError(
                f"Sensor {sensor.name!r} cannot be read at {site.text!r} before its first message."
            )
        return f"{reading.code} or 0.0" if reading.absent else reading.code

    def _reading(self, conjunct: Conjunct, source: Document, site: SiteId, place: ast.AST) -> Reading:
        sensor = conjunct.sensor
        if not sensor.guardable:
            raise RepairError(
                f"Sensor {sensor.name!r} is computed or observed by the test only, so the node cannot read it: give "
                "the sensor a topic and a dotted field, or the node's variable that holds its value (expr=…), or leave "
                "it out of the guard."
            )
        known = (
            self._analysis.holders(sensor.topic, sensor.path, site) if sensor.topic and sensor.path else ()
        )
        reading = held(source, place, (sensor.expr, *known) if sensor.expr else known, conjunct)
        if reading is None and not sensor.path:
            raise RepairError(
                f"Sensor {sensor.name!r} (expr={sensor.expr!r}) cannot be read at {site.text!r}, or its initial value "
                "makes the guard true before the first message."
            )
        return reading or self.subscriptions.reading(sensor, site, source, place)


def _file_edits(
    source: Document, statements: Sequence[tuple[ast.stmt, list[Use]]], conditions: Conditions
) -> Iterator[Edit]:
    """Yield all edits of one file."""
    twice: list[tuple[ast.stmt, list[Change], str]] = []
    for statement, uses in statements:
        changes = [use.change for use in uses]
        place = _place(source, statement, uses)
        tests = [conditions.at(source, use.site, place(use)) for use in uses]
        if not tests[0]:
            yield from replaced(source, changes)
        elif doubled(source, statement, changes):
            twice.append((statement, changes, tests[0]))
        else:
            yield from choices(source, statement, changes, tests)
    for group in neighbours(source, twice):
        yield branched(source, [(statement, changes) for statement, changes, _ in group], group[0][2])


def _by_file(
    analysis: Analysis, mutations: Sequence[Mutation]
) -> list[tuple[Document, list[tuple[ast.stmt, list[Use]]]]]:
    """Group the changed uses by file and statement, in the order of the text."""
    files: dict[str, dict[ast.stmt, list[Use]]] = {}
    for mutation in sorted(mutations, key=lambda each: each.operand.span):
        source = analysed_document(analysis, mutation.operand.span.path)
        use = Use(mutation.operand.site, _change(source, mutation))
        files.setdefault(source.path, {}).setdefault(source.statement(use.change.node), []).append(use)
    return [
        (analysed_document(analysis, path), list(statements.items())) for path, statements in files.items()
    ]


def _place(source: Document, statement: ast.stmt, uses: Sequence[Use]) -> Callable[[Use], ast.AST]:
    """Return a function from a use to the code that checks its condition."""
    if doubled(source, statement, [use.change for use in uses]):
        return lambda _: statement
    return lambda use: lazy(source, use.change.node) or statement


def _change(source: Document, mutation: Mutation) -> Change:
    """Return the replacement of an operand."""
    operand, value = mutation.operand, mutation.value
    node = source.find(operand.span)
    integral = isinstance(operand.value, int) and needs_integer(source, node)
    if operand.literal:
        _check_literal(node, operand)
        new = value if isinstance(value, bool) or not integral else round(value)
        return Change(node, number(new))
    code = source.source(node)
    if isinstance(operand.value, bool):
        return Change(node, negated(code))
    if operand.value == 0:
        return Change(node, shifted(code, round(value) if integral else value))
    if integral:
        return Change(node, f"round({scaled(code, value)})")
    factored = operand.value is not None
    rest = scaled(code, value).removeprefix(number(value))
    return Change(node, scaled(code, value), number(value) if factored else "", rest)


def _check_literal(node: ast.expr, operand: Operand) -> None:
    try:
        written = ast.literal_eval(node)
    except ValueError:
        written = None
    if written != operand.value:
        raise RepairError(
            f"{operand.span.path}:{operand.span.line} holds {ast.unparse(node)}, but the analysis found "
            f"{operand.code}: if the file was edited during the run, run again."
        )
