"""Structural repairs, for drifts that no constant repairs: templates applied to the expressions ranked first.

Each parameter of a template at an expression is an operand like any other, so that the sweep can search it.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from types import MappingProxyType

from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.patching.document import Document, document
from pytest_tarl.patching.mutate import Mutation, form_values
from pytest_tarl.patching.structures import Form, described
from pytest_tarl.patching.templates import FIXED, OF_SENSORS, Template, templates
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.telling_sensors import continuous, telling, usual
from pytest_tarl.repairing.template_places import Spot, pairs, spots
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.sensors import Sensor
from tarl_lint.model import Operand, Span

MOST = {
    "value": 5,
    "input": 3,
    "number": 5,
    "comparison": 5,
    "pair": 4,
    "sent": 3,
    "sensor": 3,
    "sent by sensor": 2,
}  # kind of template → maximum number of expressions at which to try one
COMMANDED = ("stored", "sent")  # kinds of expressions that go into a published message
NUMBERS = ("value", "input", "stored", "sent")  # kinds of expressions that templates for any number fit
RESPONDS = 0.2  # a statement responds if one of its constants gains at least this share of the wanted gain
FIRST = 2  # number of expressions tried first: the one ranked first, and the one nearest to a publish call
CLAMPS = ("clamp", "clip", "saturate", "constrain")
# minimum number of episodes for templates with a telling sensor (see `telling_sensors`), but never more than a third
# of the episodes left
LEAST = 50
# if the candidates of a group need more than the group's own episodes, they leave this share of the remaining
# episodes to later groups
KEPT = 0.6
COMMANDS = 3  # maximum number of commands that are scaled or shifted before all other changes
# minimum number of episodes for each of these changes, but never more than a third of the episodes left
LEAST_EACH = 4


class Structures:
    """A search over templates, cheapest first; for each kind, the best `FIRST` expressions come first.

    Templates of equal cost form a group. A group gets a part of the episodes, in proportion to its number of
    parameters. If one of its templates gains much, the group also gets half of the episodes left for the other groups.
    The statements whose constants gained come first (`effects`, by the statement's id), and the best of them has a
    group of its own. Changes of a whole command by a gain or an offset come before all others, because they compensate
    for an actuator whatever the node computes.
    """

    def __init__(
        self,
        order: Order,
        guards: Sequence[Guard],
        trials: Trials,
        effects: Mapping[str, Sequence[OperandEffect]] = MappingProxyType({}),
    ) -> None:
        self.order = order
        self.responding = _responding(effects, order.goal.wanted)
        self.guards = guards
        self.trials = trials
        self._sweeps: list[Sweep] = []
        self._found: dict[Operand, Form] = {}

    def candidates(self) -> Iterator[Candidate]:
        """Yield confirmed candidates, cheap templates first. Raise BudgetSpentError."""
        known, places = templates(self.order.root), list(spots(self.order, self.responding))
        told = self._told(known, places)
        sent = self._at_commands(known, places)
        near = self._at_the_best(known, places)
        groups = [group for group in (told, sent, near) if group] + self._groups(known, places)
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
                given=self.given,
                responding=self.responding,
            )
            self._sweeps.append(sweep)
            left = whole - self.trials.spent
            share = left * sizes[number] // sum(sizes[number:])
            if operands is told:
                share = min(max(share, LEAST), left // 3)
            elif operands is sent:
                share = min(max(share, LEAST_EACH * len(sent)), left // 3)
            elif operands is near:
                share = max(share, left // 2)
            limit = whole if number == len(groups) - 1 else whole - int(KEPT * (left - share))
            self.trials.budget = self.trials.spent + share
            self.trials.reserve, self.trials.worth = (left - share) // 2, self.order.goal
            try:
                for candidate in sweep.candidates():
                    if self.trials.spent > limit:
                        break
                    yield from self._beyond_its_share(candidate, whole)
            except BudgetSpentError:
                if number == len(groups) - 1:
                    raise
            finally:
                self.trials.budget, self.trials.reserve = whole, 0

    def _beyond_its_share(self, candidate: Candidate, whole: int) -> Iterator[Candidate]:
        """Yield a candidate; its examination may spend more than its templates' share of the episodes."""
        trials = self.trials
        budget, reserve, spent = trials.budget, trials.reserve, trials.spent
        trials.budget, trials.reserve = whole, 0
        yield candidate
        trials.budget = min(budget + trials.spent - spent, whole)
        trials.reserve = min(reserve, whole - trials.budget)

    def effects(self) -> dict[str, list[OperandEffect]]:
        """Return, for each site, the gains of each template's best values."""
        found: dict[str, list[OperandEffect]] = {}
        for sweep in self._sweeps:
            for site, effects in sweep.effects().items():
                found.setdefault(site, []).extend(effects)
        return found

    def mutate(self, operand: Operand, factor: float) -> Mutation | None:
        """Return the mutation of one parameter by a factor; a template without parameters has only one mutation."""
        form = self._found[operand]
        if not form.parameter:
            return Mutation(operand, True, form=form)
        if factor == 1.0 and form.parameter != form.defaults[0][0]:
            return None  # factor 1 is the same change for all parameters, so only the first one proposes it
        mine = next((one for one in form.template.parameters if one.name == form.parameter), None)
        grid = mine.grid if mine is not None else 0.0
        if grid:  # only the first parameter of a template has a grid
            start = dict(form.defaults)[form.parameter]
            factor = round(start * factor / grid) * grid / start
            if not factor:
                return None
        signed = form.template.on == "sensor" or (mine is not None and mine.signed)
        return Mutation(operand, factor, form=form) if factor > 0 or signed else None

    def weaker(self, operand: Operand, factor: float) -> bool:
        """Return whether a factor on a parameter makes the structural change weaker."""
        form = self._found[operand]
        growing = {one.name: one.stronger == "larger" for one in form.template.parameters}
        return 0.0 < factor != 1.0 and (factor < 1.0) == growing.get(form.parameter, factor > 1.0)

    def given(self, operand: Operand) -> list[Operand]:
        """Return the fixed parameters of a structural change, which are moved only after the change gained much."""
        form = self._found[operand]
        bare = replace(form, parameter="")
        return [
            other
            for other, its in self._found.items()
            if other.span == operand.span and replace(its, parameter="") == bare and _fixed(its)
        ]

    def _told(self, known: Sequence[Template], among: Sequence[Spot]) -> list[Operand]:
        """Return the operands of templates with a telling sensor (see `telling_sensors`), at all expressions."""
        sensors = telling(self.order)
        found: list[Operand] = []
        for made in known if sensors else ():
            for forms in _forms(self.order, made, among) if made.on in OF_SENSORS else ():
                for operand, form in forms:
                    if form.sensor in sensors:
                        self._found[operand] = form
                        found += [] if _fixed(form) else [operand]
        return found

    def _at_commands(self, known: Sequence[Template], among: Sequence[Spot]) -> list[Operand]:
        """Return the operands of the templates for any number at the values that are published."""
        nearest = sorted((spot for spot in among if spot.kind in COMMANDED), key=lambda spot: spot.away)
        fitting = [one for one in known if one.on == "number"]
        return [operand for one in fitting for operand in self._at(one, nearest[:COMMANDS], first=None)]

    def _at_the_best(self, known: Sequence[Template], among: Sequence[Spot]) -> list[Operand]:
        """Return, at the statement that responds most, the operands of the templates that need no sensor."""
        here = [spot for spot in among if str(spot.site) in self.responding[:1]]
        fitting = [one for one in known if one.on not in OF_SENSORS]
        return [operand for one in fitting for operand in self._at(one, here, first=True)]

    def _groups(self, known: Sequence[Template], among: Sequence[Spot]) -> list[list[Operand]]:
        groups: list[list[Operand]] = []
        for first in (True, False):
            for _, same in groupby(known, key=lambda one: one.cost):
                operands = [operand for one in same for operand in self._at(one, among, first)]
                groups += [operands] if operands else []
        return groups

    def _at(self, template: Template, among: Sequence[Spot], first: bool | None) -> Iterator[Operand]:
        """Yield a template's operands at the first, the later or all expressions; store their forms."""
        for number, forms in enumerate(_forms(self.order, template, among)):
            if first is None or (number < FIRST) == first:
                for operand, form in forms:
                    if operand not in self._found:
                        self._found[operand] = form
                        if not _fixed(form):
                            yield operand


def _responding(effects: Mapping[str, Sequence[OperandEffect]], wanted: float) -> tuple[str, ...]:
    """Return the IDs of the statements that respond (see RESPONDS), largest gain first.

    Operands without a known value are left out: they stand for several constants, such as the parameters that a helper
    function looks up, so that their gain does not say where to change the program.
    """
    known = {site: [one.effect for one in each if one.value is not None] for site, each in effects.items()}
    gains = {site: max(gains, default=0.0) for site, gains in known.items()}
    found = [site for site, gain in gains.items() if gain > 0.0 and gain >= RESPONDS * wanted]
    return tuple(sorted(found, key=lambda site: -gains[site]))


def form_words(order: Order, mutation: Mutation) -> str:
    """Describe a structural mutation."""
    form = mutation.form
    assert form is not None  # noqa: S101
    source = document(mutation.operand.span.path, order.analysis.sources[mutation.operand.span.path])
    x = _folded(source, source.find(mutation.operand.span))
    y = _folded(source, source.find(form.partner)) if form.partner is not None else ""
    return described(form, x, y, form_values(mutation), form.sensor.name if form.sensor else "")


def _forms(order: Order, template: Template, among: Sequence[Spot]) -> Iterator[list[tuple[Operand, Form]]]:
    """Yield, for each expression that a template fits, an operand for each of its parameters."""
    if template.on == "pair":
        for one, other in pairs(among, MOST["pair"]):
            partner = _span(other.source, other.node)
            yield list(
                _operands(template, one, Form(template, partner=partner), {"typical": 1.0, "larger": 1.0})
            )
        return
    for spot in _fitting(template, among)[: MOST[template.on]]:
        if template.on not in OF_SENSORS:
            scales = {"typical": spot.typical, "larger": spot.larger}
            yield list(_operands(template, spot, Form(template), scales))
            continue
        by_sensor: list[tuple[Operand, Form]] = []
        for sensor in order.comparison.sensors:
            if continuous(sensor):
                by_sensor += _operands(template, spot, Form(template, sensor=sensor), _scales(order, sensor))
        yield by_sensor


def _fitting(template: Template, among: Sequence[Spot]) -> list[Spot]:
    """Return the expressions that a template fits, in the order to try them."""
    if template.on.startswith("sent"):
        return [spot for spot in among if spot.kind == "sent" or (spot.kind == "value" and not spot.away)]
    if template.on == "number":
        return [
            spot
            for spot in among
            if spot.kind in NUMBERS and spot.numeric and template.without not in spot.constants
        ]
    kind = "value" if template.on == "sensor" else template.on
    fitting = [spot for spot in among if spot.kind == kind or (kind == "value" and spot.kind == "input")]
    if template.on == "sensor":
        # sensors are read where messages arrive; they correct sent values before the values are limited, so that the
        # limits still hold
        fitting.sort(key=lambda spot: (spot.kind != kind, not spot.hears, _limited(spot.node), spot.away))
    else:
        fitting.sort(key=lambda spot: spot.kind != kind)
    return fitting


def _limited(node: ast.expr) -> bool:
    """Return whether an expression limits a value to a range, as `max(low, min(high, x))` or `clamp(x)` do."""
    if not isinstance(node, ast.Call):
        return False
    name = ast.unparse(node.func).rpartition(".")[2]
    inner = [ast.unparse(each.func) for each in node.args if isinstance(each, ast.Call)]
    return name in CLAMPS or (name in ("max", "min") and {"max", "min"} - {name} <= set(inner))


def _scales(order: Order, sensor: Sensor) -> dict[str, float]:
    """Return, for each key of `of` in a template (such as `usual`), the size by which defaults are multiplied."""
    drifted = usual(order, sensor)
    scales = {"sensor": 1.0 / drifted, "usual": drifted}
    if sensor.low is not None and sensor.low >= 0.0:
        scales["designed"] = usual(order, sensor, order.fixture.sample)
    return scales


def _operands(
    template: Template, spot: Spot, bare: Form, scales: Mapping[str, float]
) -> Iterator[tuple[Operand, Form]]:
    """Yield an operand for each parameter; nothing if a default is unknown."""
    if any(one.of and one.of not in scales for one in template.parameters):
        return
    defaults = tuple(
        (one.name, float(f"{one.default * scales.get(one.of, 1.0):.4g}")) for one in template.parameters
    )
    code = _folded(spot.source, spot.node)
    for name, value in defaults or (("", None),):
        form = Form(template, name, defaults, bare.partner, bare.sensor)
        by = f" by {bare.sensor.name}" if bare.sensor else ""
        text = f"{template.name.replace('_', ' ')}{by} of {code}{f', {name}' if name else ''}"
        yield Operand(spot.site, _span(spot.source, spot.node), text, value if name else False), form


def _fixed(form: Form) -> bool:
    """Return whether the parameter of a form is fixed, that is, moved only after the change gained much."""
    return any(one.name == form.parameter and one.of == FIXED for one in form.template.parameters)


def _span(source: Document, node: ast.expr) -> Span:
    start = source.start(node) - source.line_starts[node.lineno - 1]
    last = node.end_lineno or node.lineno
    end = source.end(node) - source.line_starts[last - 1]
    return Span(source.path, node.lineno, start + 1, last, end + 1)


def _folded(source: Document, node: ast.expr) -> str:
    return " ".join(source.source(node).split())
