"""Structural repairs, for drifts that no constant repairs: templates at the expressions that the slices rank first.

Each parameter of a template at an expression is an operand like any other, so the sweep can search it.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from itertools import groupby

from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.patching.document import Document, document
from pytest_tarl.patching.mutate import Mutation, form_values
from pytest_tarl.patching.structures import Form, described
from pytest_tarl.patching.templates import Template, templates
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.telling_sensors import continuous, telling, usual
from pytest_tarl.repairing.template_places import Spot, pairs, spots
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Trials
from pytest_tarl.searching.sweep import Sweep
from tarl_lint.model import Operand, Span

MOST = {
    "value": 5,
    "input": 3,
    "comparison": 5,
    "pair": 4,
    "sensor": 3,
}  # expressions at which to try a template, by its kind
FIRST = (
    2  # expressions that get all templates first: the slices' first one and the one next to the publish call
)
LEAST = 40  # episodes that templates with a sensor get at least if the sensor tells the drift


class Structures:
    """A search over templates, cheapest first: at the best `FIRST` expressions of a kind, then at the others.

    Templates of equal cost share a part of the episodes, in proportion to their number of parameters; if one gains
    much, they also get half of what the others have left.
    """

    def __init__(self, order: Order, guards: Sequence[Guard], trials: Trials) -> None:
        self.order = order
        self.guards = guards
        self.trials = trials
        self._sweeps: list[Sweep] = []
        self._found: dict[Operand, Form] = {}

    def candidates(self) -> Iterator[Candidate]:
        """Yield confirmed candidates, cheap templates first. Raises BudgetSpentError."""
        known, places = templates(self.order.root), list(spots(self.order))
        told = self._told(known, places)
        groups = [*([told] if told else []), *self._groups(known, places)]
        whole = self.trials.budget
        sizes = [len(operands) for operands in groups]
        for number, operands in enumerate(groups):
            sweep = Sweep(
                operands,
                self.mutate,
                self.guards,
                self.trials,
                self.order.goal,
                proposed=True,
                weaker=self.weaker,
            )
            self._sweeps.append(sweep)
            left = whole - self.trials.spent
            share = left * sizes[number] // sum(sizes[number:])
            if operands is told:
                share = min(max(share, LEAST), left)
            self.trials.budget = self.trials.spent + share
            self.trials.reserve, self.trials.worth = (left - share) // 2, self.order.goal
            try:
                yield from sweep.candidates()
            except BudgetSpentError:
                if number == len(groups) - 1:
                    raise
            finally:
                self.trials.budget, self.trials.reserve = whole, 0

    def effects(self) -> dict[str, list[OperandEffect]]:
        """Return, for each site, the gains of each template's best values."""
        found: dict[str, list[OperandEffect]] = {}
        for sweep in self._sweeps:
            for site, effects in sweep.effects().items():
                found.setdefault(site, []).extend(effects)
        return found

    def mutate(self, operand: Operand, factor: float) -> Mutation | None:
        """Return one step of a parameter; a template without parameters has a single step."""
        form = self._found[operand]
        if not form.parameter:
            return Mutation(operand, True, form=form)
        if factor == 1.0 and form.parameter != form.defaults[0][0]:
            return (
                None  # unchanged, hence the same change for every parameter; only the first one proposes it
            )
        return Mutation(operand, factor, form=form) if factor > 0 or form.template.on == "sensor" else None

    def weaker(self, operand: Operand, factor: float) -> bool:
        """Return whether a factor on a parameter makes the structural change weaker."""
        form = self._found[operand]
        growing = {one.name: one.stronger == "larger" for one in form.template.parameters}
        return 0.0 < factor != 1.0 and (factor < 1.0) == growing.get(form.parameter, factor > 1.0)

    def _told(self, known: Sequence[Template], among: Sequence[Spot]) -> list[Operand]:
        """Return the operands of templates with a sensor that tells the drift, at all of their expressions."""
        sensors = telling(self.order)
        found: list[Operand] = []
        for made in known if sensors else ():
            for forms in _forms(self.order, made, among) if made.on == "sensor" else ():
                for operand, form in forms:
                    if form.sensor in sensors:
                        self._found[operand] = form
                        found.append(operand)
        return found

    def _groups(self, known: Sequence[Template], among: Sequence[Spot]) -> list[list[Operand]]:
        groups: list[list[Operand]] = []
        for first in (True, False):
            for _, same in groupby(known, key=lambda one: one.cost):
                operands = [operand for one in same for operand in self._at(one, among, first)]
                groups += [operands] if operands else []
        return groups

    def _at(self, template: Template, among: Sequence[Spot], first: bool) -> Iterator[Operand]:
        """Yield a template's operands at the first or at the other expressions, and remember their forms."""
        for number, forms in enumerate(_forms(self.order, template, among)):
            if (number < FIRST) == first:
                for operand, form in forms:
                    if operand not in self._found:
                        self._found[operand] = form
                        yield operand


def form_words(order: Order, mutation: Mutation) -> str:
    """Describe a structural mutation."""
    form = mutation.form
    assert form is not None  # noqa: S101
    source = document(mutation.operand.span.path, order.analysis.sources[mutation.operand.span.path])
    x = _folded(source, source.find(mutation.operand.span))
    y = _folded(source, source.find(form.partner)) if form.partner is not None else ""
    return described(form, x, y, form_values(mutation), form.sensor.name if form.sensor else "")


def _forms(order: Order, template: Template, among: Sequence[Spot]) -> Iterator[list[tuple[Operand, Form]]]:
    """Yield, for every expression that a template fits, an operand for each of its parameters."""
    kind = "value" if template.on == "sensor" else template.on
    if template.on == "pair":
        for one, other in pairs(among, MOST["pair"]):
            partner = _span(other.source, other.node)
            yield list(_operands(template, one, Form(template, partner=partner), 1.0))
        return
    fitting = [spot for spot in among if spot.kind == kind or (kind == "value" and spot.kind == "input")]
    if template.on == "sensor":  # a sensor is read where messages arrive, and corrects what is sent
        fitting.sort(key=lambda spot: (spot.kind != kind, not spot.hears, spot.away))
    else:
        fitting.sort(key=lambda spot: spot.kind != kind)
    for spot in fitting[: MOST[template.on]]:
        if template.on != "sensor":
            yield list(_operands(template, spot, Form(template), spot.typical))
            continue
        by_sensor: list[tuple[Operand, Form]] = []
        for sensor in order.comparison.sensors:
            if continuous(sensor):
                scale = 1.0 / usual(order, sensor)
                by_sensor += _operands(template, spot, Form(template, sensor=sensor), scale)
        yield by_sensor


def _operands(template: Template, spot: Spot, bare: Form, scale: float) -> Iterator[tuple[Operand, Form]]:
    defaults = tuple(
        (one.name, float(f"{one.default * (scale if one.of else 1.0):.4g}")) for one in template.parameters
    )
    code = _folded(spot.source, spot.node)
    for name, value in defaults or (("", None),):
        form = Form(template, name, defaults, bare.partner, bare.sensor)
        by = f" by {bare.sensor.name}" if bare.sensor else ""
        text = f"{template.name.replace('_', ' ')}{by} of {code}{f', {name}' if name else ''}"
        yield Operand(spot.site, _span(spot.source, spot.node), text, value if name else False), form


def _span(source: Document, node: ast.expr) -> Span:
    start = source.start(node) - source.line_starts[node.lineno - 1]
    last = node.end_lineno or node.lineno
    end = source.end(node) - source.line_starts[last - 1]
    return Span(source.path, node.lineno, start + 1, last, end + 1)


def _folded(source: Document, node: ast.expr) -> str:
    return " ".join(source.source(node).split())
