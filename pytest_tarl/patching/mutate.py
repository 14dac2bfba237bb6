"""Mutations: new values of constants at their uses, written into the source exactly as in the later patch."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.charts import Chart, distance
from pytest_tarl.patching.definitions import Place
from pytest_tarl.patching.definitions import edits as definition_edits
from pytest_tarl.patching.document import Document, Edit, apply_edits, apply_plain_edits, document
from pytest_tarl.patching.expressions import counting, negated, number, rounded, scaled, shifted
from pytest_tarl.patching.fields import in_integer_field
from pytest_tarl.patching.guards import Reading, always, condition, held
from pytest_tarl.patching.statements import Change, branched, choices, doubled, lazy, neighbours, replaced
from pytest_tarl.patching.structures import Form, form_edits
from pytest_tarl.patching.subscriptions import Subscriptions
from pytest_tarl.patching.templates import Template
from pytest_tarl.sensors import Sensor
from tarl_lint.model import Operand, SiteId, Span

if TYPE_CHECKING:
    from tarl_lint.api import Analysis


@dataclass(frozen=True, slots=True)
class Mutation:
    """A new value for an operand at its use.

    An operand is a use of a constant. `value` is the new value of a literal. For other operands, `value` is a factor on
    the use, or a summand if the constant is zero. A boolean operand is flipped. With a `place`, the change is made at
    the constant's definition instead.
    """

    operand: Operand
    value: float | int | bool
    place: Place | None = None
    # set for a structural repair: the operand is then an expression and the value a factor
    form: Form | None = None
    # the scale on which the search moves the operand
    chart: Chart | None = field(default=None, compare=False)


def mutations(operand: Operand, factor: float, integral: bool = False) -> Mutation | None:
    """Return the mutation of an operand by a factor, or None if it changes nothing.

    A zero becomes `factor - 1`, or `1 - 1/factor` for factors below 1, so that the factors f and 1/f are symmetric.
    With `integral` (see `is_integral`), an integer remains an integer and changes by at least 1.
    """
    value = operand.value
    if isinstance(value, bool):
        return Mutation(operand, not value)
    if not math.isfinite(factor) or (value is not None and not math.isfinite(value)):
        return None
    if value == 0:
        return (
            _literal(operand, 0, _step(factor), integral)
            if operand.literal
            else _moved(operand, _step(factor), 0.0)
        )
    if operand.literal and value is not None:
        return _literal(operand, value, value * factor, integral)
    return _moved(operand, factor, 1.0)


def stepped(
    operand: Operand, step: float, chart: Chart | None, mutate: Callable[[Operand, float], Mutation | None]
) -> Mutation | None:
    """Return the mutation for a step on a chart (for a factor if `chart` is None), or None if nothing changes."""
    if chart is None or operand.value is None:
        return mutate(operand, step)
    by = chart.factor(float(operand.value), step)
    made = mutate(operand, by) if by is not None else None
    return replace(made, chart=chart) if made is not None else None


def to_step(
    mutation: Mutation, step: float, mutate: Callable[[Operand, float], Mutation | None]
) -> Mutation | None:
    """Return the mutation of the same operand by another step, or None if there is none."""
    if mutation.form is not None:
        return replace(mutation, value=step)
    return stepped(mutation.operand, step, mutation.chart, mutate)


def step_of(mutation: Mutation) -> float | None:
    """Return the step of a mutation on its chart, or None if it has no chart or no step gives its value."""
    constant = mutation.operand.value
    if mutation.chart is None or constant is None:
        return None
    by = float(mutation.value)
    new = by if mutation.operand.literal or not constant else float(constant) * by
    return mutation.chart.step(float(constant), new)


def is_integral(analysis: Analysis, operand: Operand) -> bool:
    """Return whether an operand must stay an integer: an index, a length, a compared code, or an integer field."""
    source = _document(analysis, operand.span.path)
    return isinstance(operand.value, int) and _whole(source, source.find(operand.span))


def redefinition(mutation: Mutation) -> float | int | bool:
    """Return the new number at the mutation's place."""
    value = mutation.operand.value
    if isinstance(value, bool) or mutation.operand.literal:
        return not value if isinstance(value, bool) else mutation.value
    old = mutation.place.value if mutation.place is not None else value
    if isinstance(old, bool):
        return not old
    if value == 0 or not old:
        return rounded(mutation.value)
    share = mutation.place.share if mutation.place is not None else 1.0
    return rounded(old * (1.0 + (mutation.value - 1.0) * share) if share != 1.0 else old * mutation.value)


def rewrite(
    analysis: Analysis,
    mutations: Sequence[Mutation],
    guard: Guard,
    topics: Mapping[str, str],
    texts: Mapping[str, str] = MappingProxyType({}),
) -> dict[str, str]:
    """Apply mutations under a guard; return the new text of every changed file, by path.

    `topics` maps topic names to message types (`std_msgs/msg/Bool`), for subscriptions that must be added. `texts`
    holds further files that define constants. Raise RepairError if a change cannot be written.
    """
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
        sensor = conditions.value(form.sensor, source, site, statement) if form.sensor is not None else ""
        edits.setdefault(source.path, []).extend(form_edits(source, node, form, values, condition, sensor))
    for path, added in conditions.subscriptions.edits().items():
        edits[path] = [*added, *edits.get(path, [])]
    return {
        path: apply_edits(_document(analysis, path), edits[path])
        if path in analysis.sources
        else apply_plain_edits(path, texts[path], edits[path])
        for path in sorted(edits)
    }


def form_values(mutation: Mutation) -> dict[str, float]:
    """Return the parameters of a structural mutation; the one that is searched is scaled by the mutation's value."""
    if mutation.form is None:
        return {}
    values = dict(mutation.form.defaults)
    if mutation.form.parameter:
        values[mutation.form.parameter] = rounded(values[mutation.form.parameter] * float(mutation.value))
    return values


def _formed(
    analysis: Analysis, mutations: Sequence[Mutation]
) -> Iterator[tuple[Document, ast.expr, Form, dict[str, float], SiteId]]:
    """Yield each form (template at an expression) once, with the parameters from all its mutations."""
    found: dict[tuple[Span, Template], tuple[Mutation, dict[str, float]]] = {}
    for mutation in mutations:
        if mutation.form is not None:
            key = (mutation.operand.span, mutation.form.template)
            _, values = found.setdefault(key, (mutation, dict(mutation.form.defaults)))
            moved = form_values(mutation)
            values |= {name: moved[name] for name in moved if name == mutation.form.parameter}
    for (span, _), (mutation, values) in found.items():
        if mutation.form is not None:
            source = _document(analysis, span.path)
            yield source, source.find(span), mutation.form, values, mutation.operand.site


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
    """Return the Python code of the guard at the first mutation, or "" if the guard always holds."""
    conditions = Conditions(analysis, guard, topics)
    for source, node, _, _, site in _formed(analysis, mutations[:1]):
        return conditions.at(source, site, source.statement(node))
    for source, statements in _by_file(analysis, mutations[:1]):
        for statement, uses in statements:
            return conditions.at(source, uses[0].site, _place(source, statement, uses)(uses[0]))
    return ""


@dataclass(frozen=True)
class Use:
    """A change of one use, with its site (statement)."""

    site: SiteId
    change: Change


class Conditions:
    """The Python code of a guard at every place that checks it, and the subscriptions that the guard needs."""

    def __init__(self, analysis: Analysis, guard: Guard, topics: Mapping[str, str]) -> None:
        self._analysis = analysis
        self._guard = guard
        self._topics = topics
        self.subscriptions = Subscriptions(analysis, topics)

    def at(self, source: Document, site: SiteId, place: ast.AST) -> str:
        """Return the guard as Python at a place. Raise RepairError if a sensor's value is not available there."""
        wanted = [each for each in self._guard.conjuncts if not always(each)]
        readings = {each.sensor.name: self._reading(each, source, site, place) for each in wanted}
        return condition(self._guard, readings, self._topics)

    def value(self, sensor: Sensor, source: Document, site: SiteId, place: ast.AST) -> str:
        """Return a sensor's value at a place as Python; it is 0 before the first message. Raise RepairError."""
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
    """Yield the edits of one file: plain ones, conditional expressions, and branches around statements."""
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
    """Return the mutated uses by file and statement, in the order of the text."""
    files: dict[str, dict[ast.stmt, list[Use]]] = {}
    for mutation in sorted(mutations, key=lambda each: each.operand.span):
        source = _document(analysis, mutation.operand.span.path)
        use = Use(mutation.operand.site, _change(source, mutation))
        files.setdefault(source.path, {}).setdefault(source.statement(use.change.node), []).append(use)
    return [(_document(analysis, path), list(statements.items())) for path, statements in files.items()]


def _place(source: Document, statement: ast.stmt, uses: Sequence[Use]) -> Callable[[Use], ast.AST]:
    """Return a function that gives the place where a use checks the condition: a statement, lambda or generator."""
    if doubled(source, statement, [use.change for use in uses]):
        return lambda _: statement
    return lambda use: lazy(source, use.change.node) or statement


def _change(source: Document, mutation: Mutation) -> Change:
    """Return the replacement of an operand."""
    operand, value = mutation.operand, mutation.value
    node = source.find(operand.span)
    integral = isinstance(operand.value, int) and _whole(source, node)
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


def _whole(source: Document, node: ast.expr) -> bool:
    """Return whether a place needs an integer."""
    return counting(source, node) or in_integer_field(source, node)


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


def _literal(operand: Operand, value: float, wanted: float, integral: bool) -> Mutation | None:
    """Return the mutation of a literal; an integer remains an integer if possible."""
    new: float | int = rounded(wanted)
    if isinstance(value, int) and integral:
        new = round(new) if round(new) != value else value + (1 if wanted > value else -1)
        new = value if wanted == value else new
    elif isinstance(value, int) and float(new).is_integer():
        new = int(new)
    return None if new == value or not math.isfinite(new) else Mutation(operand, new)


def _moved(operand: Operand, wanted: float, unchanged: float) -> Mutation | None:
    new = rounded(wanted)
    return None if new == unchanged else Mutation(operand, new)


def _step(factor: float) -> float:
    """Return the value of a zero after a factor: negated for the inverse factor, 0 for factor 1."""
    size = abs(factor)
    if size < 1e-9:
        return 0.0
    return math.copysign(1.0, factor) * distance(size)


def _document(analysis: Analysis, path: str) -> Document:
    if path not in analysis.sources:
        raise RepairError(f"{path} is not among the analysed files: add it to the nodes of the test.")
    return document(path, analysis.sources[path])
