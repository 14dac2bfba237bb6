"""Operands of structural changes: each parameter of a template at each expression that the template fits."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from pytest_tarl.patching.clamps import CLAMPS, OPPOSITE
from pytest_tarl.patching.document import Document, called, document
from pytest_tarl.patching.mutate import Mutation, form_values
from pytest_tarl.patching.structures import Form, described
from pytest_tarl.patching.templates import FIELD, FIXED, OF_SENSORS, PAIR, TRACKED, Template
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.steady_values import adds_to, has_effect
from pytest_tarl.repairing.telling_sensors import continuous, usual
from pytest_tarl.repairing.template_places import Spot, axes_of, axis_twin, pairs
from pytest_tarl.sensors import Sensor
from tarl_lint.model import Operand

MOST = {
    "value": 5,
    "input": 3,
    "tracked": 4,
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


def form_words(order: Order, mutation: Mutation) -> str:
    """Describe a structural mutation."""
    form = mutation.form
    assert form is not None  # noqa: S101
    source = document(mutation.operand.span.path, order.analysis.sources[mutation.operand.span.path])
    x = form.target(_folded(source, source.find(mutation.operand.span)))
    y = _folded(source, source.find(form.partner)) if form.partner is not None else ""
    if y and form.template.on != PAIR:
        x = f"{x} and {y}"
    return described(form, x, y, form_values(mutation), form.sensor.name if form.sensor else form.variable)


def forms(
    order: Order, template: Template, among: Sequence[Spot], before: Sequence[Spot] = ()
) -> Iterator[list[tuple[Operand, Form]]]:
    """Yield, for each expression that a template fits, an operand for each of its parameters.

    If an earlier expression, perhaps among those `before`, is the same for another axis, both change together: what
    moves along x moves along y by the same laws.
    """
    if template.on == PAIR:
        for one, other in pairs(among, MOST[PAIR]):
            partner = other.source.span(other.node)
            yield list(
                _operands(template, one, Form(template, partner=partner), {"typical": 1.0, "larger": 1.0})
            )
        return
    chosen = fitting(template, among)[: MOST[template.on]]
    for at, spot in enumerate(chosen):
        twin = axis_twin(spot, [*before, *chosen[:at]])
        if template.on not in OF_SENSORS:
            scales = {"typical": spot.typical, "larger": spot.larger}
            bare = Form(template, field=spot.field)
            if twin is not None and template.on in ("value", TRACKED):
                bare = replace(bare, partner=twin.source.span(twin.node))
            yield list(_operands(template, spot, bare, scales))
            continue
        if template.inside:
            spot, twin = _inside(spot, twin)
        by_sensor: list[tuple[Operand, Form]] = []
        for sensor in order.comparison.sensors:
            if continuous(sensor):
                by_sensor += _operands(
                    template, spot, _by(template, sensor, spot, twin), _scales(order, sensor, spot)
                )
        yield by_sensor


def _inside(spot: Spot, twin: Spot | None) -> tuple[Spot, Spot | None]:
    """Return the expressions that are limited for both axes, or else the values themselves."""
    if spot.within is None or (twin is not None and twin.within is None):
        return spot, twin
    return spot.within, twin.within if twin is not None else None


def _by(template: Template, sensor: Sensor, spot: Spot, twin: Spot | None) -> Form:
    """Return the form with a sensor, for both axes if the message has the other axis's field."""
    bare = Form(template, sensor=sensor)
    axes = axes_of(spot, twin) if twin is not None else None
    path, _, last = sensor.path.rpartition(".")
    if twin is None or axes is None or not path or last not in axes:
        return bare
    other = axes[1 - axes.index(last)]
    sibling = replace(sensor, name=f"{sensor.name}_{other}", field=f"{path}.{other}", expr="")
    mine, its = (sensor, sibling) if last == axes[0] else (sibling, sensor)
    return replace(bare, sensor=mine, sibling=its, partner=twin.source.span(twin.node))


def fitting(template: Template, among: Sequence[Spot]) -> list[Spot]:
    """Return the expressions that a template fits, in the order to try them."""
    among = [spot for spot in among if _may_help(template, spot)]
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
        # sensors are read where messages arrive. A term of a sensor is added to a sent value before the value is
        # limited, so that the limits still hold.
        fitting.sort(key=lambda spot: (spot.kind != kind, not spot.hears, _limited(spot.node), spot.away))
    else:
        fitting.sort(key=lambda spot: spot.kind != kind)
    return fitting


def _may_help(template: Template, spot: Spot) -> bool:
    return has_effect(template, spot.constant, spot.steady, adds_to(spot.source, spot.node))


def _limited(node: ast.expr) -> bool:
    """Return whether an expression limits a value to a range, as `max(low, min(high, x))` or `clamp(x)` do."""
    if not isinstance(node, ast.Call):
        return False
    name = called(node)
    inner = [ast.unparse(each.func) for each in node.args if isinstance(each, ast.Call)]
    return name in CLAMPS or (OPPOSITE.get(name) in inner)


def _scales(order: Order, sensor: Sensor, spot: Spot) -> dict[str, float]:
    """For each value that `of` may have in a template (such as `usual`), return the size that scales the default."""
    drifted = usual(order, sensor)
    scales = {"sensor": 1.0 / drifted, "usual": drifted, "ratio": spot.larger / drifted}
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
    if bare.partner is not None and template.on != PAIR:
        code = f"{code} and {_folded(spot.source, spot.source.find(bare.partner))}"
    for name, value in defaults or (("", None),):
        form = replace(bare, parameter=name, defaults=defaults)
        by = f" by {bare.sensor.name}" if bare.sensor else ""
        text = f"{template.name.replace('_', ' ')}{by} of {code}{f', {name}' if name else ''}"
        yield Operand(spot.site, spot.source.span(spot.node), text, value if name else False), form


def fixed(form: Form) -> bool:
    """Return whether the parameter of a form is fixed, that is, moved only after the change gained much."""
    return any(one.name == form.parameter and one.of == FIXED for one in form.template.parameters)


def _folded(source: Document, node: ast.expr) -> str:
    return " ".join(source.source(node).split())
