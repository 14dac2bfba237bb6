"""Structural repairs, for drifts that no constant repairs: templates at the expressions that the slices rank first.

Each parameter of a template at an expression is an operand like any other, so the sweep can search it.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Sequence
from itertools import combinations, groupby

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.patching.document import Document, document
from pytest_tarl.patching.mutate import Mutation, form_values
from pytest_tarl.patching.structures import Form, described
from pytest_tarl.patching.templates import Template, templates
from pytest_tarl.repairing.labels import is_member
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.telling_sensors import continuous, telling, usual
from pytest_tarl.repairing.typical_sizes import TypicalSizes, called, threshold
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Trials
from pytest_tarl.searching.sweep import Sweep
from tarl_lint.model import Operand, SiteId, Span, Step

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
_NUMERIC = ("abs", "float", "int", "max", "min", "pow", "round", "sum")
_AXES = (("x", "y"), ("y", "z"), ("x", "z"), ("left", "right"), ("roll", "pitch"))


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
        known, spots = templates(self.order.root), list(_spots(self.order))
        told = self._told(known, spots)
        groups = [*([told] if told else []), *self._groups(known, spots)]
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

    def _told(self, known: Sequence[Template], spots: Sequence[_Spot]) -> list[Operand]:
        """Return the operands of templates with a sensor that tells the drift, at all of their expressions."""
        sensors = telling(self.order)
        found: list[Operand] = []
        for made in known if sensors else ():
            for forms in _forms(self.order, made, spots) if made.on == "sensor" else ():
                for operand, form in forms:
                    if form.sensor in sensors:
                        self._found[operand] = form
                        found.append(operand)
        return found

    def _groups(self, known: Sequence[Template], spots: Sequence[_Spot]) -> list[list[Operand]]:
        groups: list[list[Operand]] = []
        for first in (True, False):
            for _, same in groupby(known, key=lambda one: one.cost):
                operands = [operand for one in same for operand in self._at(one, spots, first)]
                groups += [operands] if operands else []
        return groups

    def _at(self, template: Template, spots: Sequence[_Spot], first: bool) -> Iterator[Operand]:
        """Yield a template's operands at the first or at the other expressions, and remember their forms."""
        for number, forms in enumerate(_forms(self.order, template, spots)):
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


class _Spot:
    """An expression at which a template may be written; `typical` is the usual size of its value."""

    def __init__(self, site: SiteId, source: Document, node: ast.expr, kind: str, typical: float) -> None:
        self.site = site
        self.source = source
        self.node = node
        self.kind = kind
        self.typical = typical


def _forms(order: Order, template: Template, spots: Sequence[_Spot]) -> Iterator[list[tuple[Operand, Form]]]:
    """Yield, for every expression that a template fits, an operand for each of its parameters."""
    kind = "value" if template.on == "sensor" else template.on
    if template.on == "pair":
        for one, other in _pairs(spots):
            partner = _span(other.source, other.node)
            yield list(_operands(template, one, Form(template, partner=partner), 1.0))
        return
    fitting = [spot for spot in spots if spot.kind == kind or (kind == "value" and spot.kind == "input")]
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


def _operands(template: Template, spot: _Spot, bare: Form, scale: float) -> Iterator[tuple[Operand, Form]]:
    defaults = tuple(
        (one.name, float(f"{one.default * (scale if one.of else 1.0):.4g}")) for one in template.parameters
    )
    code = _folded(spot.source, spot.node)
    for name, value in defaults or (("", None),):
        form = Form(template, name, defaults, bare.partner, bare.sensor)
        by = f" by {bare.sensor.name}" if bare.sensor else ""
        text = f"{template.name.replace('_', ' ')}{by} of {code}{f', {name}' if name else ''}"
        yield Operand(spot.site, _span(spot.source, spot.node), text, value if name else False), form


def _spots(order: Order) -> Iterator[_Spot]:
    """Yield the expressions in the statements of flows, in the order of the statements."""
    sizes = TypicalSizes(order)
    seen: set[tuple[str, int]] = set()
    for step in _steps(order):
        try:
            source = document(step.span.path, order.analysis.sources[step.span.path])
        except (RepairError, KeyError):
            continue
        for node, kind in _expressions(source, step.span, str(step.site) in sizes.by_site, sizes.returned):
            key = (source.path, source.start(node))
            if key not in seen and not is_member(source, node, order.analysis.sources.values()):
                seen.add(key)
                usual = threshold(node) if kind == "comparison" else sizes.of(step.site, node)
                yield _Spot(step.site, source, node, kind, usual)


def _steps(order: Order) -> list[Step]:
    """Return the flows' statements, alternately from the slices' ranking and from the publish calls backwards.

    Limits, filters and offsets of a command act where the command is sent, wherever the loss comes from.
    """
    rank = {culprit.site.id: at for at, culprit in enumerate(order.comparison.culprits)}
    ranked = sorted(order.analysis.sites, key=lambda step: rank.get(str(step.site), len(rank)))
    away: dict[SiteId, int] = {}
    for flow in order.analysis.flows:
        for distance, step in enumerate(reversed(flow.steps)):
            away[step.site] = min(distance, away.get(step.site, distance))
    late = sorted(order.analysis.sites, key=lambda step: away[step.site])
    return list(dict.fromkeys(step for pair in zip(ranked, late, strict=True) for step in pair))


def _expressions(
    source: Document, span: Span, numeric: bool, returned: Collection[str]
) -> Iterator[tuple[ast.expr, str]]:
    """Yield the expressions to change in the statement at a span, with kind.

    `numeric` tells whether the statement recorded numbers, `returned` which functions returned some.
    """
    statements = [
        node for node in ast.walk(source.tree) if isinstance(node, ast.stmt) and node.lineno == span.line
    ]
    for statement in statements:
        if isinstance(statement, ast.If | ast.While):
            for node in ast.walk(statement.test):
                if isinstance(node, ast.Compare) and len(node.ops) == 1 and _orders(node.ops[0]):
                    yield node, "comparison"
        elif isinstance(statement, ast.Assign | ast.AnnAssign | ast.AugAssign | ast.Return):
            value = statement.value
            if value is not None and (_is_numeric(value) or (numeric and _computes(value))):
                yield value, "value"
            elif isinstance(value, ast.Attribute):
                yield value, "input"
        elif isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
            yield from ((each, "value") for each in _passed(statement.value, returned))


def _passed(call: ast.Call, returned: Collection[str]) -> Iterator[ast.expr]:
    """Yield the numbers computed for the arguments of a call, also inside messages constructed there.

    `returned` are the functions of the program that returned numbers.
    """
    for each in (*call.args, *(keyword.value for keyword in call.keywords)):
        if _is_numeric(each) or (isinstance(each, ast.Call) and called(each) in returned):
            yield each
        elif isinstance(each, ast.Call) and _makes_an_object(each):
            yield from _passed(each, returned)


def _computes(node: ast.expr) -> bool:
    """Return whether an expression may yield a number: a function call or a conditional expression."""
    return isinstance(node, ast.IfExp) or (isinstance(node, ast.Call) and not _makes_an_object(node))


def _makes_an_object(call: ast.Call) -> bool:
    return ast.unparse(call.func).rpartition(".")[2][:1].isupper()


def _is_numeric(node: ast.expr) -> bool:
    """Return whether an expression computes a number."""
    if isinstance(node, ast.BinOp):
        return not isinstance(node.left, ast.Constant) or not isinstance(node.left.value, str)
    if isinstance(node, ast.UnaryOp):
        return isinstance(node.op, ast.USub) and not isinstance(node.operand, ast.Constant)
    if isinstance(node, ast.Call):
        name = ast.unparse(node.func)
        return name in _NUMERIC or name.startswith(("math.", "np.", "numpy."))
    return False


def _orders(op: ast.cmpop) -> bool:
    return isinstance(op, ast.Lt | ast.LtE | ast.Gt | ast.GtE)


def _pairs(spots: Sequence[_Spot]) -> list[tuple[_Spot, _Spot]]:
    """Return pairs of expressions in one function that differ only in their axis."""
    found = []
    for one, other in combinations(spots, 2):
        together = one.source is other.source and one.source.function(one.node) is other.source.function(
            other.node
        )
        if together and one.kind != "comparison" and _axis_apart(one, other):
            found.append((one, other))
    return found[: MOST["pair"]]


def _axis_apart(one: _Spot, other: _Spot) -> bool:
    for text in (lambda spot: spot.source.source(spot.node), _assigned):
        first, second = text(one).rpartition("."), text(other).rpartition(".")
        names = {(first[2], second[2]), (second[2], first[2])}
        if first[0] == second[0] and any(axes in names for axes in _AXES):
            return True
    return False


def _assigned(spot: _Spot) -> str:
    statement = spot.source.statement(spot.node)
    return ast.unparse(statement.targets[0]) if isinstance(statement, ast.Assign) else ""


def _span(source: Document, node: ast.expr) -> Span:
    start = source.start(node) - source.line_starts[node.lineno - 1]
    last = node.end_lineno or node.lineno
    end = source.end(node) - source.line_starts[last - 1]
    return Span(source.path, node.lineno, start + 1, last, end + 1)


def _folded(source: Document, node: ast.expr) -> str:
    return " ".join(source.source(node).split())
