"""Derive steps for constants from recorded missions in which a node's values differ by a factor or an offset.

For example, if electrodes deliver 45 % of their signal, the threshold for the signal must be 45 % as large. If a sensor
reads 14 too high, a set point that is compared with the reading must be 14 higher. Such steps have the unit and the
size of the error, which fixed factors match only by chance. Recorded missions with the same seed in both worlds show
these steps.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import exp, log

import numpy as np

from pytest_tarl.errors import RepairError
from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.instrumentation.trace import Floats
from pytest_tarl.patching.document import Document, argument_names, document
from pytest_tarl.repairing.mission_pairs import Recorded, series
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.separating import between_groups, reaching, separating
from pytest_tarl.searching.plainness import Oddness, writing
from pytest_tarl.searching.suggestions import Hint
from pytest_tarl.symptoms.series import Pair
from tarl_lint.model import Operand

MOST = 6  # maximum number of hints
# maximum number of hints for thresholds that no longer separate the values as in the designed missions
SEPARATED = 3
LEAST = 0.05  # minimum change of a value, as a logarithm or as a share of its designed size
AGREE = 0.25  # maximum difference between the changes of the mission pairs, as a share of the change
ALIKE = 0.05  # maximum difference between the logarithms of two factors that count as equal
SIZES = ("abs", "math.fabs", "fabs", "np.abs", "numpy.abs")  # functions that return the size of a value
NUMBER = "data"  # the field of a message that holds a single number
LARGEST = 20.0  # maximum factor of a hint; the minimum is the inverse


@dataclass(frozen=True)
class Change:
    """A value's change in the drifted world, as factor and difference (None if pairs disagree)."""

    ratio: float | None
    difference: float | None


def hints(order: Order, recorded: Sequence[Recorded], operands: Sequence[Operand]) -> list[Hint]:
    """Return the changes of named constants that the recorded mission pairs suggest, the most certain ones first.

    - A constant that is compared with a value, added to it or subtracted from it has the unit of this value, so it must
      change as the value did. If values changed by the same factor, the constants beside them first change together by
      this factor, then one by one, then by the difference.
    - A constant that multiplies or divides a value changes by the factor by which the result changed, and by the
      inverse of this factor.
    - A threshold that only designed missions cross moves to where drifted missions cross it, even if it is a literal.
    """
    changes = _changes(order, recorded)
    values = _values(order, recorded)
    separated: list[Hint] = []
    beside: list[tuple[Operand, float]] = []
    shifted: list[Hint] = []
    scaled: list[Hint] = []
    for operand in _first_uses(operands):
        value, found = _number(operand), _place(order, operand)
        if not value or found is None:
            continue
        compared = _compared(order, values, operand, *found)
        separated += [((operand, by),) for by in _separating(value, compared)]
        for change in _beside(order, changes, operand, *found):
            beside += [(operand, change.ratio)] if change.ratio else []
            shifted += [((operand, 1.0 + change.difference / value),)] if change.difference else []
        own = changes.get(str(operand.site))
        if own is not None and own.ratio is not None and _multiplies(*found):
            scaled += [((operand, 1.0 / own.ratio),), ((operand, own.ratio),)]
    alone = [((operand, by),) for operand, by in beside]
    reached = [((operand, by),) for operand, by in _reaching(order, values, operands)]
    every = [*_together(beside), *alone, *separated[:SEPARATED], *reached[:SEPARATED], *shifted, *scaled]
    fitting = [hint for hint in every if all(_sensible(by) for _, by in hint)]
    return list(dict.fromkeys(tuple((one, float(f"{by:.3g}")) for one, by in hint) for hint in fitting))[
        :MOST
    ]


def _reaching(
    order: Order, values: Mapping[str, Sequence[tuple[Floats, Floats]]], operands: Sequence[Operand]
) -> Iterator[tuple[Operand, float]]:
    """Yield the thresholds that only designed missions cross, with a factor that lets drifted missions cross them."""
    for operand in dict.fromkeys(operands):
        value, found = _number(operand), _place(order, operand)
        if not value or found is None:
            continue
        for pairs in _compared(order, values, operand, *found):
            by = reaching(value, pairs) if between_groups(value, pairs) is None else None
            if by is not None:
                yield operand, by


def _first_uses(operands: Sequence[Operand]) -> Iterator[Operand]:
    """Yield the named constants. If a statement uses a constant several times, yield only the first use."""
    known: set[object] = set()
    for operand in operands:
        key = (operand.site, operand.code)
        if writing(operand) is Oddness.NAMED and key not in known:
            known.add(key)
            yield operand


def _sensible(by: float) -> bool:
    return 1.0 / LARGEST <= by <= LARGEST and abs(log(by)) >= LEAST


def _together(beside: Sequence[tuple[Operand, float]]) -> Iterator[Hint]:
    """If several constants change by about the same factor, yield them together."""
    left = list(beside)
    while left:
        first = left[0]
        alike = {one: by for one, by in left if abs(log(by) - log(first[1])) <= ALIKE}
        left = [part for part in left if abs(log(part[1]) - log(first[1])) > ALIKE]
        if len({one.definition or one for one in alike}) > 1:
            yield tuple(alike.items())


def _changes(order: Order, recorded: Sequence[Recorded]) -> dict[str, Change]:
    """For each site id, return how the values of the statement differ in the drifted world."""
    found: dict[str, Change] = {}
    for number, place in enumerate(plan(order.analysis).places):
        pairs = [Pair(series(one, number), series(other, number)).together() for one, other in recorded]
        if pairs and all(one.designed.values.size and one.drifted.values.size for one in pairs):
            found[place.id] = _change(pairs)
    return found


def _values(order: Order, recorded: Sequence[Recorded]) -> dict[str, list[tuple[Floats, Floats]]]:
    """For each site id, return the statement's values in the designed and the drifted mission of each pair."""
    found: dict[str, list[tuple[Floats, Floats]]] = {}
    for number, place in enumerate(plan(order.analysis).places):
        pairs = [Pair(series(one, number), series(other, number)) for one, other in recorded]
        found[place.id] = [(one.designed.values, one.drifted.values) for one in pairs]
    return found


def _separating(value: float, compared: Iterable[Sequence[tuple[Floats, Floats]]]) -> Iterator[float]:
    """Yield the factors with which a threshold separates the drifted values as it separated the designed ones.

    For example, a node ignores positions that differ from its estimate by more than a threshold. After a wheel has
    slipped, the node ignores all positions. The new threshold must be larger than the slip and smaller than the errors
    that the node should ignore.
    """
    for pairs in compared:
        grouped = between_groups(value, pairs)
        by = separating(value, pairs) if grouped is None else grouped
        if by is not None:
            yield by


def _compared(
    order: Order,
    values: Mapping[str, Sequence[tuple[Floats, Floats]]],
    operand: Operand,
    source: Document,
    node: ast.expr,
) -> Iterator[Sequence[tuple[Floats, Floats]]]:
    """For each statement that computes the values compared with a threshold, yield these values by mission pair."""
    around = source.parents.get(node)
    if not isinstance(around, ast.Compare) or len(around.ops) != 1:
        return
    other = around.left if node is not around.left else around.comparators[0]
    size = isinstance(other, ast.Call) and ast.unparse(other.func) in SIZES and len(other.args) == 1
    inner = other.args[0] if size and isinstance(other, ast.Call) else other
    for site in (*_made_at(order, operand, source, inner), *_receiving(order, source, inner)):
        yield [(np.abs(one), np.abs(other)) if size else (one, other) for one, other in values.get(site, ())]


def _change(pairs: Sequence[Pair]) -> Change:
    sizes = [tuple(float(abs(one.values).mean()) for one in (pair.designed, pair.drifted)) for pair in pairs]
    means = [tuple(float(one.values.mean()) for one in (pair.designed, pair.drifted)) for pair in pairs]
    ratio = None
    if all(designed > 0 and drifted > 0 for designed, drifted in sizes):
        by = _agreed([log(drifted / designed) for designed, drifted in sizes], LEAST)
        ratio = exp(by) if by is not None else None
    usual = max(designed for designed, _ in sizes)
    return Change(ratio, _agreed([drifted - designed for designed, drifted in means], LEAST * usual))


def _agreed(changes: Sequence[float], least: float) -> float | None:
    """Return the mean change of the pairs if it is at least `least` and they agree, else None."""
    mean = sum(changes) / len(changes)
    spread = max(changes) - min(changes)
    return mean if abs(mean) >= max(least, 1e-12) and spread <= AGREE * abs(mean) else None


def _number(operand: Operand) -> float:
    """Return the value of a constant; 0 for booleans and values known only at run time."""
    return 0.0 if operand.value is None or isinstance(operand.value, bool) else float(operand.value)


def _place(order: Order, operand: Operand) -> tuple[Document, ast.expr] | None:
    try:
        source = document(operand.span.path, order.analysis.sources[operand.span.path])
        return source, source.find(operand.span)
    except (RepairError, KeyError):
        return None


def _beside(
    order: Order, changes: Mapping[str, Change], operand: Operand, source: Document, node: ast.expr
) -> Iterator[Change]:
    """Yield the changes of the values with which a constant is compared, or to which it is added."""
    inner: ast.AST = node
    for around in source.ancestors(node):
        if isinstance(around, ast.Compare):
            others = [one for one in (around.left, *around.comparators) if one is not inner]
        elif isinstance(around, ast.BinOp) and isinstance(around.op, ast.Add | ast.Sub):
            others = [around.right if around.left is inner else around.left]
        elif isinstance(around, ast.UnaryOp):
            inner = around
            continue
        else:
            return
        for other in others:
            sites = _made_at(order, operand, source, other)
            known = (changes[site] for site in sites if site in changes)
            yield from (_mirrored(one, around, inner, node) for one in known)
        if isinstance(around, ast.Compare):
            return
        inner = around


def _mirrored(change: Change, around: ast.AST, inner: ast.AST, node: ast.expr) -> Change:
    """Return the change of the constant: the opposite one if `-constant` is compared or a value is added to it."""
    opposite = isinstance(inner, ast.UnaryOp) and isinstance(inner.op, ast.USub) and inner.operand is node
    if isinstance(around, ast.BinOp) and isinstance(around.op, ast.Add):
        opposite = not opposite
    difference = change.difference
    return Change(change.ratio, -difference if opposite and difference else difference)


def _made_at(order: Order, operand: Operand, source: Document, node: ast.expr) -> list[str]:
    """Return the ids of sites that assign a name or attribute. Look for a local name only in its function."""
    if not isinstance(node, ast.Name | ast.Attribute):
        return []
    code, found = ast.unparse(node), []
    for step in order.analysis.sites:
        site = step.site
        if step.span.path != source.path or (
            isinstance(node, ast.Name) and site.qualname != operand.site.qualname
        ):
            continue
        if _assigned(site.text) == code:
            found.append(str(site))
    return found


def _receiving(order: Order, source: Document, node: ast.expr) -> list[str]:
    """Return the site id of the callback around `msg.data` if `msg` is the message that the callback receives."""
    if not isinstance(node, ast.Attribute) or node.attr != NUMBER:
        return []
    function = source.function(node)
    names = argument_names(function) if function else []
    if function is None or ast.unparse(node.value) not in names[:1]:
        return []
    return [
        str(step.site)
        for step in order.analysis.sites
        if step.role == "receive" and step.span.path == source.path and step.span.line == function.lineno
    ]


def _assigned(text: str) -> str:
    """Return the name or attribute that a statement assigns, or "" if it assigns none."""
    try:
        statement = ast.parse(text).body[0]
    except (SyntaxError, IndexError):
        return ""
    if isinstance(statement, ast.AugAssign | ast.AnnAssign):
        return ast.unparse(statement.target)
    return ast.unparse(statement.targets[0]) if isinstance(statement, ast.Assign) else ""


def _multiplies(source: Document, node: ast.expr) -> bool:
    """Return whether a constant is a factor or a divisor."""
    around = source.parents.get(node)
    return isinstance(around, ast.BinOp) and isinstance(around.op, ast.Mult | ast.Div)
