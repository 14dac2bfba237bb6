"""Operands of structural changes: each parameter of a template at each expression that the template fits."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from pytest_tarl.patching.document import Document, called, document
from pytest_tarl.patching.mutate import Mutation, form_values
from pytest_tarl.patching.structures import Form, described
from pytest_tarl.patching.templates import FIELD, FIXED, OF_SENSORS, Template
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.telling_sensors import continuous, usual
from pytest_tarl.repairing.template_places import Spot, pairs
from pytest_tarl.sensors import Sensor
from tarl_lint.model import Operand, Span

MOST = {
    "value": 5,
    "input": 3,
    "number": 5,
    "comparison": 5,
    "pair": 4,
    "sent": 3,
    "field": 4,
    "sensor": 3,
    "sent by sensor": 2,
    "constant": 0,  # tried only at a constant whose value was found (see `following`)
}  # maximum number of expressions at which to try a template, by the template's kind
NUMBERS = ("value", "input", "stored", "sent")  # kinds of expressions to which templates for any number apply
CLAMPS = ("clamp", "clip", "saturate", "constrain")


def form_words(order: Order, mutation: Mutation) -> str:
    """Describe a structural mutation."""
    form = mutation.form
    assert form is not None  # noqa: S101
    source = document(mutation.operand.span.path, order.analysis.sources[mutation.operand.span.path])
    x = form.target(_folded(source, source.find(mutation.operand.span)))
    y = _folded(source, source.find(form.partner)) if form.partner is not None else ""
    return described(form, x, y, form_values(mutation), form.sensor.name if form.sensor else form.variable)


def forms(order: Order, template: Template, among: Sequence[Spot]) -> Iterator[list[tuple[Operand, Form]]]:
    """Yield, for each expression that a template fits, an operand for each of its parameters."""
    if template.on == "pair":
        for one, other in pairs(among, MOST["pair"]):
            partner = _span(other.source, other.node)
            yield list(
                _operands(template, one, Form(template, partner=partner), {"typical": 1.0, "larger": 1.0})
            )
        return
    for spot in fitting(template, among)[: MOST[template.on]]:
        if template.on not in OF_SENSORS:
            scales = {"typical": spot.typical, "larger": spot.larger}
            yield list(_operands(template, spot, Form(template, field=spot.field), scales))
            continue
        by_sensor: list[tuple[Operand, Form]] = []
        for sensor in order.comparison.sensors:
            if continuous(sensor):
                by_sensor += _operands(template, spot, Form(template, sensor=sensor), _scales(order, sensor))
        yield by_sensor


def fitting(template: Template, among: Sequence[Spot]) -> list[Spot]:
    """Return the expressions that a template fits, in the order to try them."""
    if template.on == FIELD:
        return [spot for spot in among if spot.kind == FIELD]
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
    name = called(node)
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
    code = bare.target(_folded(spot.source, spot.node))
    for name, value in defaults or (("", None),):
        form = replace(bare, parameter=name, defaults=defaults)
        by = f" by {bare.sensor.name}" if bare.sensor else ""
        text = f"{template.name.replace('_', ' ')}{by} of {code}{f', {name}' if name else ''}"
        yield Operand(spot.site, _span(spot.source, spot.node), text, value if name else False), form


def fixed(form: Form) -> bool:
    """Return whether the parameter of a form is fixed, that is, moved only after the change gained much."""
    return any(one.name == form.parameter and one.of == FIXED for one in form.template.parameters)


def _span(source: Document, node: ast.expr) -> Span:
    start = source.start(node) - source.line_starts[node.lineno - 1]
    last = node.end_lineno or node.lineno
    end = source.end(node) - source.line_starts[last - 1]
    return Span(source.path, node.lineno, start + 1, last, end + 1)


def _folded(source: Document, node: ast.expr) -> str:
    return " ".join(source.source(node).split())
