"""New values for constants where they are used (see `rewriting.py`)."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.charts import Chart, distance
from pytest_tarl.patching.constant_definitions import ParameterInFile, Place
from pytest_tarl.patching.document import Document, document
from pytest_tarl.patching.expression_texts import counting, rounded
from pytest_tarl.patching.integer_fields import in_integer_field
from pytest_tarl.patching.structures import Form
from tarl_lint.model import Operand

if TYPE_CHECKING:
    from tarl_lint.api import Analysis


@dataclass(frozen=True, slots=True)
class Mutation:
    """A new value for an operand.

    An operand is a use of a constant. For a literal, `value` is the new value. For any other operand, it is a factor on
    the use, or a summand if the constant is zero. A boolean operand is flipped. If `place` is set, the constant is
    changed there, where it is defined, instead of at the use.
    """

    operand: Operand
    value: float | int | bool
    place: Place | None = None
    # set for a structural repair: the operand is then an expression, and the value a factor
    form: Form | None = None
    # the scale on which the search moves the operand
    chart: Chart | None = field(default=None, compare=False)


def mutations(operand: Operand, factor: float, integral: bool = False) -> Mutation | None:
    """Return the change of an operand by a factor, or None if it has no effect.

    A zero becomes `factor - 1`, or `1 - 1/factor` for factors below 1, so that f and 1/f are symmetric. With `integral`
    (see `is_integral`), an integer stays an integer and changes by at least 1.
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
    """Return the mutation for a step on a chart, or by a factor without a chart; None if it has no effect."""
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
    """Return a mutation's step on its chart; None without a chart or such a step."""
    constant = mutation.operand.value
    if mutation.chart is None or constant is None:
        return None
    by = float(mutation.value)
    new = by if mutation.operand.literal or not constant else float(constant) * by
    return mutation.chart.step(float(constant), new)


def located(mutation: Mutation) -> Mutation:
    """Add the place in the file to the mutation of a parameter in a file."""
    operand = mutation.operand
    if isinstance(operand, ParameterInFile) and mutation.place is None:
        return replace(mutation, place=operand.place)
    return mutation


def is_integral(analysis: Analysis, operand: Operand) -> bool:
    """Return whether an operand must stay an integer, for example as an index."""
    source = analysed_document(analysis, operand.span.path)
    return isinstance(operand.value, int) and needs_integer(source, source.find(operand.span))


def needs_integer(source: Document, node: ast.expr) -> bool:
    """Return whether a place needs an integer."""
    return counting(source, node) or in_integer_field(source, node)


def analysed_document(analysis: Analysis, path: str) -> Document:
    """Return an analysed file as a document. Raise RepairError if it was not analysed."""
    if path not in analysis.sources:
        raise RepairError(f"{path} is not among the analysed files: add it to the nodes of the test.")
    return document(path, analysis.sources[path])


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


def form_values(mutation: Mutation) -> dict[str, float]:
    """Return the parameters of a structural mutation, with the searched one scaled by its value."""
    if mutation.form is None:
        return {}
    values = dict(mutation.form.defaults)
    if mutation.form.parameter:
        values[mutation.form.parameter] = rounded(values[mutation.form.parameter] * float(mutation.value))
    return values


def _literal(operand: Operand, value: float, wanted: float, integral: bool) -> Mutation | None:
    """Return the mutation of a literal; an integer stays an integer if possible."""
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
    """Return what a factor makes of zero, with opposite values for f and 1/f."""
    size = abs(factor)
    if size < 1e-9:
        return 0.0
    return math.copysign(1.0, factor) * distance(size)
