"""Corrections of messages whose numbers come in another unit or scale: a factor where the node reads them.

A new sensor sends degrees in place of radians, or millimetres in place of metres. What the node computes from such a
number may look like noise, for example an angle that is wrapped, or like a constant, for example a value that is
limited. The size of the message itself still shows the factor: from the first message on if both missions begin in the
same state, or else as a ratio of usual sizes that only a unit explains. The factor belongs where the number is read,
before anything is computed from it.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from math import exp, log, pi

from pytest_tarl.errors import RepairError
from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.patching.document import Document, document
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.templates import Template, templates
from pytest_tarl.repairing.mission_pairs import Recorded, series
from pytest_tarl.repairing.readings import AGREE, GAIN, first_value, spread
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.template_forms import forms
from pytest_tarl.repairing.template_places import Spot
from pytest_tarl.symptoms.series import Pair
from tarl_lint.model import SiteId, Step

MOST = 2  # maximum number of messages that are corrected
# ratios of units in use: degrees, turns and rpm per rad (and per second), parts of a metre, km/h and knots per m/s,
# feet and inches per metre, seconds per minute and hour, N per kilogram-force and pound-force, kPa and bar per psi,
# pounds per kilogram
RATIOS = (
    180 / pi, 2 * pi, 30 / pi, 10.0, 100.0, 1e3, 1e6, 3.6, 1.9438, 3.2808, 39.37, 60.0, 3600.0, 9.80665, 4.4482,
    6.8948, 14.504, 2.2046,
)  # fmt: skip
EXACT = 0.01  # maximum |log| between a factor of first values and a ratio of units that replaces it
CLOSE = 0.25  # the same for a factor of usual sizes, which also differ because the missions do
# minimum |log| of a factor of first values, and of usual sizes: what a node does changes sizes by less than five times
LEAST, LARGE = 0.05, log(5.0)
_LEFT_OUT = frozenset({"header", "stamp", "seq", "covariance"})
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)


def rescaled(order: Order, recorded: Sequence[Recorded]) -> list[tuple[Mutation, ...]]:
    """Return corrections of messages, the largest factors first; each multiplies all numbers read from a message."""
    gain = next((one for one in templates(order.root) if one.name == GAIN), None) if recorded else None
    if gain is None:
        return []
    steps = {str(step.site): step for step in order.analysis.sites}
    found: list[tuple[float, tuple[Mutation, ...]]] = []
    for number, place in enumerate(plan(order.analysis).places):
        if place.role != "receive" or place.id not in steps:
            continue
        factor = _factor([Pair(series(one, number), series(other, number)) for one, other in recorded])
        if factor is None:
            continue
        mutations = tuple(_mutations(order, gain, steps[place.id], factor))
        if mutations:
            found.append((abs(log(factor)), mutations))
    found.sort(key=lambda one: -one[0])
    return [mutations for _, mutations in found[:MOST]]


def _factor(pairs: Sequence[Pair]) -> float | None:
    """Return the factor that makes a message as large as in the designed world, or None if there is none."""
    firsts = [(first_value(pair.designed), first_value(pair.drifted)) for pair in pairs]
    known = [(one, other) for one, other in firsts if one and other]
    if len(known) == len(pairs) > 1:
        factors = [designed / drifted for designed, drifted in known]
        by_offset = spread([designed - drifted for designed, drifted in known])
        size = log(sum(factors) / len(factors))
        if spread(factors) <= min(AGREE, by_offset) and abs(size) >= LEAST:
            return _snapped(size, EXACT) or exp(size)
    sizes = [
        tuple(float(abs(one.values).mean()) for one in (pair.designed, pair.drifted))
        for pair in (pair.together() for pair in pairs)
        if pair.designed.values.size and pair.drifted.values.size
    ]
    if len(sizes) < max(len(pairs), 2) or not all(map(all, sizes)):
        return None
    ratios = [_snapped(log(designed / drifted), CLOSE) for designed, drifted in sizes]
    same = ratios[0] if len(set(ratios)) == 1 else None
    return same if same is not None and abs(log(same)) >= LARGE else None


def _snapped(size: float, close: float) -> float | None:
    """Return the ratio of units whose logarithm is nearest to `size`, or None if none is close."""
    ratios = [ratio for each in RATIOS for ratio in (each, 1.0 / each)]
    nearest = min(ratios, key=lambda one: abs(log(one) - size))
    return nearest if abs(log(nearest) - size) <= close else None


def _mutations(order: Order, gain: Template, step: Step, factor: float) -> Iterator[Mutation]:
    """Yield a factor at each expression that reads a number of the message that a callback receives."""
    try:
        source = document(step.span.path, order.analysis.sources[step.span.path])
    except (RepairError, KeyError):
        return
    for node in reads(source, step.span.line):
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
    """Return the expressions that read a number from the message of the callback that is defined at a line.

    If the callback stores the message, as `self.pose = msg` does, its later reads count as well.
    """
    function = next(
        (one for one in ast.walk(source.tree) if isinstance(one, _FUNCTIONS) and one.lineno == line), None
    )
    names = [one.arg for one in function.args.args if one.arg not in ("self", "cls")] if function else []
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
    """Return whether a field may be used as a number, judging by the node around it."""
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
