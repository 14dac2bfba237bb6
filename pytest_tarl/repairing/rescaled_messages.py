"""Correct messages whose numbers have another unit or scale, by a factor where the node reads the numbers.

For example, a new sensor sends degrees instead of radians, or millimetres instead of metres. What the node computes
from such a number may look like noise (if an angle is wrapped) or like a constant (if a value is limited). The numbers
in the message itself still show the factor. If both missions begin in the same state, the first message already shows
it. Otherwise, the ratio between the usual sizes shows it, if only a change of unit explains this ratio. The factor
belongs where the number is read, before anything is computed from it.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from math import exp, log

from pytest_tarl.errors import RepairError
from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.patching.document import Document, argument_names, document
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.templates import Template, templates
from pytest_tarl.repairing.message_units import ratios
from pytest_tarl.repairing.mission_pairs import Recorded, series
from pytest_tarl.repairing.readings import AGREE, GAIN, first_value, spread
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.template_forms import forms
from pytest_tarl.repairing.template_places import Spot
from pytest_tarl.symptoms.series import Pair
from tarl_lint.model import Flow, SiteId, Step

MOST = 2  # maximum number of messages that are corrected
# a factor between first values is replaced by a ratio of units if their |log| differs by at most this
EXACT = 0.01
# a factor between usual sizes is replaced by a ratio of units if their |log| differs by at most this. Usual sizes also
# differ because missions differ. One random factor in five to ten is this close to a ratio of units, but rarely in
# every mission.
CLOSE = 0.07
# minimum |log| of a factor between first values, and between usual sizes; other changes of the world alter usual sizes
# by less than a factor of five
LEAST, LARGE = 0.05, log(5.0)
_LEFT_OUT = frozenset({"header", "stamp", "seq", "covariance"})
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)


def rescaled(order: Order, recorded: Sequence[Recorded]) -> list[tuple[Mutation, ...]]:
    """Return corrections, largest factor first. Each correction multiplies all numbers that are read from a message."""
    gain = next((one for one in templates(order.root) if one.name == GAIN), None) if recorded else None
    if gain is None:
        return []
    steps = {str(step.site): step for step in order.analysis.sites}
    found: list[tuple[float, tuple[Mutation, ...]]] = []
    for number, place in enumerate(plan(order.analysis).places):
        if place.role != "receive" or place.id not in steps:
            continue
        step = steps[place.id]
        read = _read(order, step)
        if read is None:
            continue
        source, nodes = read
        pairs = [Pair(series(one, number), series(other, number)) for one, other in recorded]
        factor = _factor(pairs, ratios(_described(order, step, source, nodes)))
        if factor is None:
            continue
        mutations = tuple(_mutations(order, gain, step, source, nodes, factor))
        if mutations:
            found.append((abs(log(factor)), mutations))
    found.sort(key=lambda one: -one[0])
    return [mutations for _, mutations in found[:MOST]]


def _factor(pairs: Sequence[Pair], units: Sequence[float]) -> float | None:
    """Return the factor that makes a message's numbers as large as designed, or None.

    `units` are the ratios of the units that the message may have.
    """
    firsts = [(first_value(pair.designed), first_value(pair.drifted)) for pair in pairs]
    known = [(one, other) for one, other in firsts if one and other]
    if len(known) == len(pairs) > 1:
        factors = [designed / drifted for designed, drifted in known]
        by_offset = spread([designed - drifted for designed, drifted in known])
        size = log(sum(factors) / len(factors))
        if spread(factors) <= min(AGREE, by_offset) and abs(size) >= LEAST:
            return _snapped(size, EXACT, units) or exp(size)
    sizes = [
        tuple(float(abs(one.values).mean()) for one in (pair.designed, pair.drifted))
        for pair in (pair.together() for pair in pairs)
        if pair.designed.values.size and pair.drifted.values.size
    ]
    if len(sizes) < max(len(pairs), 2) or not all(map(all, sizes)):
        return None
    found = {_snapped(log(designed / drifted), CLOSE, units) for designed, drifted in sizes}
    same = found.pop() if len(found) == 1 else None
    return same if same is not None and abs(log(same)) >= LARGE else None


def _snapped(size: float, close: float, units: Sequence[float]) -> float | None:
    """Return the ratio of units whose logarithm is nearest to `size`, or None if none is within `close`."""
    nearest = min(units, key=lambda one: abs(log(one) - size))
    return nearest if abs(log(nearest) - size) <= close else None


def _read(order: Order, step: Step) -> tuple[Document, list[ast.expr]] | None:
    """Return the expressions that read a number of the message that a callback receives, and their file."""
    try:
        source = document(step.span.path, order.analysis.sources[step.span.path])
    except (RepairError, KeyError):
        return None
    return source, reads(source, step.span.line)


def _described(order: Order, step: Step, source: Document, nodes: Sequence[ast.expr]) -> Iterator[str]:
    """Yield texts that suggest a message's quantity: topic, type, sensors, and the expressions that use the message."""
    arriving = [one.source for one in order.analysis.flows if _first_received(one) == step]
    topics = {topic for one in arriving for topic in one.topics}
    yield from sorted(topics | {one.type for one in arriving})
    for sensor in order.comparison.sensors:
        if sensor.topic is not None and sensor.topic.strip("/") in {one.strip("/") for one in topics}:
            yield f"{sensor.name} {sensor.unit}"
    for node in nodes:
        whole: ast.expr | ast.keyword = node
        while isinstance(around := source.parents.get(whole), ast.expr | ast.keyword):
            whole = around
        yield ast.unparse(whole)
        if isinstance(around, ast.Assign | ast.AnnAssign):
            yield from map(ast.unparse, around.targets if isinstance(around, ast.Assign) else [around.target])


def _first_received(flow: Flow) -> Step | None:
    return next((one for one in flow.steps if one.role == "receive"), None)


def _mutations(
    order: Order, gain: Template, step: Step, source: Document, nodes: Sequence[ast.expr], factor: float
) -> Iterator[Mutation]:
    """Yield a factor at each expression that reads a number of a message."""
    for node in nodes:
        site = _site(order, source, node) or step.site
        spot = Spot(site, source, node, "input", typical=1.0, larger=1.0, away=0, hears=True)
        for (operand, form), *_ in forms(order, gain, [spot]):
            yield Mutation(operand, factor / dict(form.defaults)[form.parameter], form=form)


def _site(order: Order, source: Document, node: ast.expr) -> SiteId | None:
    """Return the site of the innermost statement of a flow around an expression."""
    around = [
        step
        for step in order.analysis.sites
        if step.span.path == source.path and step.span.line <= node.lineno <= step.span.end_line
    ]
    return max(around, key=lambda step: step.span.line).site if around else None


def reads(source: Document, line: int) -> list[ast.expr]:
    """Return the expressions that read a number from the message of a callback at a line.

    If the callback stores the message, as `self.pose = msg` does, its later reads count as well.
    """
    function = next(
        (one for one in ast.walk(source.tree) if isinstance(one, _FUNCTIONS) and one.lineno == line), None
    )
    names = argument_names(function) if function else []
    if function is None or not names:
        return []
    found = list(_of(source, function, names[0]))
    around = next((one for one in source.ancestors(function) if isinstance(one, ast.ClassDef)), source.tree)
    for each in ast.walk(function):
        if isinstance(each, ast.Assign) and isinstance(each.value, ast.Name) and each.value.id == names[0]:
            for target in each.targets:
                scope = function if isinstance(target, ast.Name) else around
                found += _of(source, scope, ast.unparse(target))
    return list({source.start(one): one for one in found}.values())


def _of(source: Document, scope: ast.AST, message: str) -> Iterator[ast.expr]:
    """Yield the expressions in a scope that read a field of a message, given by its name."""
    for each in ast.walk(scope):
        if not isinstance(each, ast.Name | ast.Attribute) or ast.unparse(each) != message:
            continue
        node, around = each, source.parents.get(each)
        fields: list[str] = []
        while isinstance(around, ast.Attribute):
            fields.append(around.attr)
            node, around = around, source.parents.get(around)
        if not fields or not _LEFT_OUT.isdisjoint(fields) or not isinstance(node.ctx, ast.Load):
            continue
        if (
            isinstance(around, ast.Subscript)
            and around.value is node
            and not isinstance(around.slice, ast.Slice)
        ):
            yield around
        elif _number(node, around):
            yield node


def _number(node: ast.expr, around: ast.AST | None) -> bool:
    """Return whether a field may be used as a number, judging by the syntax node `around` it."""
    if isinstance(around, ast.Call):
        return around.func is not node and ast.unparse(around.func) not in (
            "len",
            "list",
            "str",
            "enumerate",
            "zip",
        )
    if isinstance(around, ast.Compare):
        sides = [one for one in (around.left, *around.comparators) if one is not node]
        return not any(isinstance(one, ast.Constant) and isinstance(one.value, str | None) for one in sides)
    return not isinstance(
        around, ast.Subscript | ast.For | ast.comprehension | ast.If | ast.While | ast.BoolOp
    )
