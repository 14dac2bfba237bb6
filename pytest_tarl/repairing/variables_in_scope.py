"""Find the variables to which a constant can be proportional: they hold numbers where the constant is used."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.document import document
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.typical_sizes import TypicalSizes
from tarl_lint.model import Operand, Span


def variables(order: Order, used: Sequence[Operand]) -> Iterator[tuple[str, float, float]]:
    """Yield the variables that hold a number wherever these constants are used, most suspect statement first.

    Each comes with its mean size in the designed and in the drifted missions. They are attributes that a method of the
    same class sets, and names assigned before in the same function.
    """
    designed, drifted = TypicalSizes(order).by_site, TypicalSizes(order, order.online.recorded.sample).by_site
    rank = {culprit.site.id: at for at, culprit in enumerate(order.comparison.culprits)}
    sites = sorted(designed.keys() & drifted.keys(), key=lambda site: (rank.get(site, len(rank)), site))
    places = {str(step.site): step.span for step in order.analysis.sites}
    found: dict[str, tuple[float, float]] = {}
    for site in sites:
        names = {_held(order, places[site], one) for one in used} if site in places else {""}
        name = names.pop() if len(names) == 1 else ""
        if name:
            found.setdefault(name, (designed[site], drifted[site]))
    yield from ((name, *sizes) for name, sizes in found.items())


def _held(order: Order, span: Span, used: Operand) -> str:
    """Return the name that a statement assigns, if it is readable where a constant is used, else ""."""
    if span.path != used.span.path:
        return ""
    try:
        source = document(span.path, order.analysis.sources[span.path])
        node = source.find(used.span)
    except (RepairError, KeyError):
        return ""
    for statement in source.statements_at.get(span.line, ()):
        if isinstance(statement, ast.Assign) and len(statement.targets) == 1:
            target, here, there = statement.targets[0], source.method(statement), source.method(node)
            if isinstance(target, ast.Name):
                function = source.function(node)
                same = function is not None and source.function(statement) is function
                return target.id if same and statement.lineno < node.lineno else ""
            if here is None or there is None or here[0] is not there[0] or here[2] != there[2]:
                return ""
            name = ast.unparse(target)
            return name if name.startswith(f"{here[2]}.") else ""
    return ""
