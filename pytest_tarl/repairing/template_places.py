"""The expressions to which templates of structural repairs may be applied, in the order to try them."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.built_fields import built_fields
from pytest_tarl.patching.document import Document, called, document
from pytest_tarl.patching.templates import FIELD, TRACKED
from pytest_tarl.repairing.labels import is_member
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.steady_values import defined_once, is_constant
from pytest_tarl.repairing.typical_sizes import TypicalSizes, threshold
from pytest_tarl.repairing.unit_factors import converts_unit
from pytest_tarl.repairing.within_limits import within_limits
from tarl_lint.model import SiteId, Span, Step

_NUMERIC = ("abs", "float", "int", "max", "min", "pow", "round", "sum")
_CHAINS: Mapping[str, tuple[type[ast.operator], ...]] = {
    "factor": (ast.Mult, ast.Div),
    "term": (ast.Add, ast.Sub),
}
CLOCKS = (
    "now",
    "time",
    "get_time",
    "get_rostime",
    "monotonic",
    "perf_counter",
)  # functions that return the time
_AXES = (("x", "y"), ("y", "z"), ("x", "z"), ("left", "right"), ("roll", "pitch"))


@dataclass(frozen=True, eq=False, slots=True)
class Spot:
    """An expression of a kind to which a template may be applied.

    `typical` is the usual size of its value in the designed world, `larger` the larger of its usual sizes in the two
    worlds. `away` is its distance from a publish call, in statements. `hears` says whether its module subscribes to
    topics, so that a template can read a sensor there. `constants` says which constants the expression has at its top
    level: a factor, a term. `numeric` says whether its value is known to be a number; only the value of a published
    name may be something else.
    """

    site: SiteId
    source: Document
    node: ast.expr
    kind: str
    typical: float
    larger: float
    away: int
    hears: bool
    constants: frozenset[str] = frozenset()
    numeric: bool = True
    field: str = ""  # for the kind "field": the field of the published message
    within: Spot | None = None  # the expression that the value limits, if its usual size is known
    constant: bool = False  # whether the value is computed from constants
    steady: bool = False  # whether the value did not vary within any recorded mission


def spots(order: Order, responding: Sequence[str] = (), steady: Collection[str] = ()) -> Iterator[Spot]:
    """Yield the expressions in the statements of flows, in the order of the statements.

    The statements whose ids are in `responding` come first, in that order. The values of those in `steady` did not vary
    within any recorded mission.
    """
    sizes = TypicalSizes(order)
    drifted = TypicalSizes(order, order.online.recorded.sample)
    seen: set[tuple[str, int, str]] = set()
    away = _away(order)
    fixed = {one.code for step in order.analysis.sites for one in order.analysis.operands(step.site)}
    hearing = {flow.source.span.path for flow in order.analysis.flows}
    for step in _steps(order, away, responding):
        try:
            source = document(step.span.path, order.analysis.sources[step.span.path])
        except (RepairError, KeyError):
            continue
        for node, kind, field in (
            *(
                (each, what, "")
                for each, what in _expressions(
                    source, step.span, str(step.site) in sizes.by_site, sizes.returned
                )
            ),
            *_fields(source, step.span),
            *((side, TRACKED, "") for side in _sides(source, step.span)),
        ):
            # a difference and its first side start at the same place
            key = (source.path, source.start(node), TRACKED if kind == TRACKED else field)
            if key not in seen and not is_member(source, node, order.analysis.sources.values()):
                seen.add(key)
                usual, larger = threshold(node), threshold(node)
                if kind != "comparison":
                    usual = sizes.of(step.site, node)
                    larger = max(usual, drifted.of(step.site, node))
                hears = source.path in hearing
                numeric = kind != "sent" or sizes.known(step.site, node) is not None
                operands = order.analysis.operands(step.site)
                own = frozenset(constants(source, node, {one.code for one in operands}))
                spot = Spot(
                    step.site, source, node, kind, usual, larger, away[step.site], hears, own, numeric, field
                )
                if not field:
                    fixed_here = is_constant(source, node, defined_once(operands))
                    same = str(step.site) in steady and _is_the_value(source, node)
                    spot = replace(spot, constant=fixed_here, steady=fixed_here or same)
                inner = None if field else within_limits(source, node, fixed)
                size = sizes.known(step.site, inner) if inner is not None else None
                if inner is not None and size:
                    most = max(size, drifted.known(step.site, inner) or 0.0)
                    spot = replace(spot, within=replace(spot, node=inner, typical=size, larger=most))
                yield spot


def _is_the_value(source: Document, node: ast.expr) -> bool:
    """Return whether the recorded value of a statement is that of an expression."""
    statement = source.statement(node)
    return isinstance(statement, ast.Assign | ast.AnnAssign | ast.Return) and statement.value is node


def _steps(order: Order, away: Mapping[SiteId, int], responding: Sequence[str]) -> list[Step]:
    """Return the flows' statements: those in `responding`, then alternately by slice and backwards from publish calls.

    Publish calls matter because limits, filters and offsets of a command belong where the command is sent.
    """
    rank = {culprit.site.id: at for at, culprit in enumerate(order.comparison.culprits)}
    ranked = sorted(order.analysis.sites, key=lambda step: rank.get(str(step.site), len(rank)))
    late = sorted(order.analysis.sites, key=lambda step: away[step.site])
    first = {site: at for at, site in enumerate(responding)}
    steps = dict.fromkeys(step for pair in zip(ranked, late, strict=True) for step in pair)
    return sorted(steps, key=lambda step: first.get(str(step.site), len(first)))


def _away(order: Order) -> dict[SiteId, int]:
    """Return the distance of each statement from a publish call, counted in statements."""
    away: dict[SiteId, int] = {}
    for flow in order.analysis.flows:
        for distance, step in enumerate(reversed(flow.steps)):
            away[step.site] = min(distance, away.get(step.site, distance))
    return away


def _expressions(
    source: Document, span: Span, numeric: bool, returned: Collection[str]
) -> Iterator[tuple[ast.expr, str]]:
    """Yield (expression, kind) for the expressions to change in the statement at a span.

    `numeric` says whether the recording has numbers for the statement; `returned` names the functions that returned
    numbers.
    """
    for statement in source.statements_at.get(span.line, ()):
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
            elif isinstance(value, ast.Compare) and len(value.ops) == 1 and _orders(value.ops[0]):
                yield value, "comparison"
            elif isinstance(value, ast.Name) and numeric and _stored(statement):
                yield value, "stored"
        elif isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
            numbers = list(_passed(statement.value, returned))
            yield from ((each, "value") for each in numbers)
            yield from ((each, "sent") for each in _sent(statement.value) if each not in numbers)


def _fields(source: Document, span: Span) -> Iterator[tuple[ast.expr, str, str]]:
    """Yield (message, kind, field) for the fields that several statements build before the call that publishes them."""
    for node in source.statements_at.get(span.line, ()):
        if isinstance(node, ast.Expr):
            yield from ((message, FIELD, built.field) for message, built in built_fields(source, node))


def _sides(source: Document, span: Span) -> Iterator[ast.expr]:
    """Yield both sides of each difference of two values that vary, such as a target and a position."""
    for statement in source.statements_at.get(span.line, ()):
        if not isinstance(statement, ast.Assign | ast.AnnAssign | ast.Return) or statement.value is None:
            continue
        for node in ast.walk(statement.value):
            if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Sub):
                sides = (node.left, node.right)
                if all(isinstance(side, ast.Name | ast.Attribute | ast.Subscript) for side in sides):
                    yield from sides


def _passed(call: ast.Call, returned: Collection[str]) -> Iterator[ast.expr]:
    """Yield numeric expressions in the arguments of a call, including those of messages constructed there.

    `returned` are the functions of the program that returned numbers.
    """
    for each in (*call.args, *(keyword.value for keyword in call.keywords)):
        if _is_numeric(each) or (isinstance(each, ast.Call) and called(each) in returned):
            yield each
        elif isinstance(each, ast.Call) and _makes_an_object(each):
            yield from _passed(each, returned)


def _sent(call: ast.Call) -> Iterator[ast.expr]:
    """Yield the names and attributes from which a published message is constructed."""
    if called(call) != "publish":
        return
    for each in ast.walk(call):
        if each is call or (isinstance(each, ast.Call) and _makes_an_object(each)):
            passed = (*each.args, *(keyword.value for keyword in each.keywords))
            yield from (one for one in passed if isinstance(one, ast.Name | ast.Attribute | ast.Compare))


def _computes(node: ast.expr) -> bool:
    """Return whether an expression may yield a number: a function call or a conditional expression.

    The time is left out: it is not a signal that a template could change.
    """
    if isinstance(node, ast.Call):
        return not _makes_an_object(node) and not _reads_clock(node)
    return isinstance(node, ast.IfExp)


def _makes_an_object(call: ast.Call) -> bool:
    return called(call)[:1].isupper()


def _reads_clock(node: ast.expr) -> bool:
    return any(isinstance(each, ast.Call) and called(each) in CLOCKS for each in ast.walk(node))


def _is_numeric(node: ast.expr) -> bool:
    """Return whether an expression computes a number, but not from the time, which is not a signal to change."""
    if _reads_clock(node):
        return False
    if isinstance(node, ast.BinOp):
        return not isinstance(node.left, ast.Constant) or not isinstance(node.left.value, str)
    if isinstance(node, ast.UnaryOp):
        return isinstance(node.op, ast.USub) and not isinstance(node.operand, ast.Constant)
    if isinstance(node, ast.Call):
        name = ast.unparse(node.func)
        return name in _NUMERIC or name.startswith(("math.", "np.", "numpy."))
    return False


def _stored(statement: ast.stmt) -> bool:
    """Return whether a statement assigns to an attribute, such as a field of a message."""
    return isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Attribute)


def constants(source: Document, node: ast.expr, known: Collection[str]) -> Iterator[str]:
    """Yield "factor" for each constant factor or divisor of an expression, and "term" for each constant summand.

    `known` contains the code of named constants. Conversions of units are left out, because no search changes them.
    """
    for name, operators in _CHAINS.items():
        for each in _leaves(node, operators):
            literal = isinstance(each, ast.Constant) and not converts_unit(source, each)
            if literal or source.source(each) in known:
                yield name


def _leaves(node: ast.expr, operators: tuple[type[ast.operator], ...]) -> Iterator[ast.expr]:
    """Yield the parts of an expression that these operators join; nothing if it has no such operator."""
    if isinstance(node, ast.UnaryOp):
        yield from _leaves(node.operand, operators)
    elif isinstance(node, ast.BinOp) and isinstance(node.op, operators):
        for part in (node.left, node.right):
            yield part
            yield from _leaves(part, operators)


def _orders(op: ast.cmpop) -> bool:
    return isinstance(op, ast.Lt | ast.LtE | ast.Gt | ast.GtE)


def pairs(among: Sequence[Spot], most: int) -> list[tuple[Spot, Spot]]:
    """Return at most `most` pairs of expressions in one function that differ only in their axis."""
    found = [(one, other) for one, other in combinations(among, 2) if _axis_apart(one, other)]
    return found[:most]


def axis_twin(spot: Spot, among: Sequence[Spot]) -> Spot | None:
    """Return the first expression that computes the same for another axis, or None.

    In `ex = goal.x - at.x` and `ey = goal.y - at.y`, the values differ only in the name of the axis.
    """
    return next((one for one in among if axes_of(spot, one) is not None), None)


def axes_of(one: Spot, other: Spot) -> tuple[str, str] | None:
    """Return the names of the axes of two expressions that differ only in these names, otherwise None."""
    if not _together(one, other) or one.node is other.node or one.kind != other.kind:
        return None
    first, second = (re.split(r"(\W+)", spot.source.source(spot.node)) for spot in (one, other))
    if len(first) != len(second):
        return None
    apart = {_axes(*pair) for pair in zip(first, second, strict=True) if pair[0] != pair[1]}
    return apart.pop() if len(apart) == 1 else None


def _axes(one: str, other: str) -> tuple[str, str] | None:
    """Return the axes in which two otherwise equal names differ, as in `ex` and `ey`, else None."""
    for axes in (*_AXES, *(axes[::-1] for axes in _AXES)):
        first, second = axes
        if one.endswith(first) and other.endswith(second) and one[: -len(first)] == other[: -len(second)]:
            return first, second
        if one.startswith(first) and other.startswith(second) and one[len(first) :] == other[len(second) :]:
            return first, second
    return None


def _together(one: Spot, other: Spot) -> bool:
    """Return whether two expressions are in the same function."""
    same = one.source is other.source
    return same and one.source.function(one.node) is other.source.function(other.node)


def _axis_apart(one: Spot, other: Spot) -> bool:
    if not _together(one, other) or one.kind == "comparison":
        return False
    for text in (lambda spot: spot.source.source(spot.node), _assigned):
        first, second = text(one).rpartition("."), text(other).rpartition(".")
        names = {(first[2], second[2]), (second[2], first[2])}
        if first[0] == second[0] and any(axes in names for axes in _AXES):
            return True
    return False


def _assigned(spot: Spot) -> str:
    statement = spot.source.statement(spot.node)
    return ast.unparse(statement.targets[0]) if isinstance(statement, ast.Assign) else ""
