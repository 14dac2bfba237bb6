"""Usual sizes (mean absolute values) of expressions in the recording, used as start values of structural changes."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping

import numpy as np

from pytest_tarl.errors import RepairError
from pytest_tarl.finite_numbers import finite_number
from pytest_tarl.learning.tables import START, Sample
from pytest_tarl.patching.document import called, document
from pytest_tarl.repairing.request import Order
from tarl_lint.model import SiteId

# functions whose result has the unit of their arguments
KEEPING_UNITS = ("abs", "float", "int", "max", "min", "round")


class TypicalSizes:
    """Mean absolute values by site, by assigned name and by constant; in the recorded world by default."""

    def __init__(self, order: Order, world: Sample | None = None) -> None:
        self.by_site = _recorded(order, world)
        self.returned = dict(_returned(order, self.by_site))
        self._by_name = dict(_assigned(order, self.by_site))
        self._constants = {
            (operand.site, operand.code): abs(float(operand.value))
            for step in order.analysis.sites
            for operand in order.analysis.operands(step.site)
            if operand.value and not isinstance(operand.value, bool)
        }

    def of(self, site: SiteId, node: ast.expr) -> float:
        """Return the usual size of an expression at a site: recorded, else estimated from its parts, else 1."""
        return self.by_site.get(str(site)) or self._estimated(site, node) or 1.0

    def known(self, site: SiteId, node: ast.expr) -> float | None:
        """Return a part's usual size, estimated from its operands, or None if unknown."""
        return self._estimated(site, node)

    def _estimated(self, site: SiteId, node: ast.expr) -> float | None:
        """Return the size estimated from parts (the largest of a sum), or None if unknown."""
        if isinstance(node, ast.Constant):
            number = finite_number(node.value)
            return None if number is None else abs(number)
        if isinstance(node, ast.UnaryOp):
            return self._estimated(site, node.operand)
        if isinstance(node, ast.BinOp):
            return self._of_two(site, node)
        if isinstance(node, ast.Call) and ast.unparse(node.func) in KEEPING_UNITS:
            return max(filter(None, (self._estimated(site, each) for each in node.args)), default=None)
        if isinstance(node, ast.Call) and called(node) in self.returned:
            return self.returned[called(node)]
        code = ast.unparse(node)
        return self._constants.get((site, code)) or self._by_name.get(code)

    def _of_two(self, site: SiteId, node: ast.BinOp) -> float | None:
        left, right = self._estimated(site, node.left), self._estimated(site, node.right)
        if isinstance(node.op, ast.Add | ast.Sub):
            return max(filter(None, (left, right)), default=None)
        if not left or not right:
            return None
        if isinstance(node.op, ast.Mult):
            return left * right
        return left / right if isinstance(node.op, ast.Div) else None


def threshold(node: ast.expr) -> float:
    """Return the absolute value of the number in a comparison, or 1 if there is none."""
    numbers = [each.value for each in ast.walk(node) if isinstance(each, ast.Constant)]
    sizes = [abs(float(value)) for value in numbers if isinstance(value, int | float) and value]
    return sizes[0] if sizes else 1.0


def _recorded(order: Order, world: Sample | None) -> Mapping[str, float]:
    """Return the mean flow value of each site, by site ID, in a world (default: the recorded one)."""
    sample = world or order.fixture.sample
    found: dict[str, float] = {}
    for taint_list, recorded in zip(order.fixture.lists, sample.lists, strict=True):
        visits = recorded.visits
        events = visits.state != START
        site = (visits.state[events] - 1) % max(recorded.width, 1)
        counts = np.bincount(site, weights=visits.count[events], minlength=recorded.width)
        flows = recorded.flow.sum(axis=0)
        for place, count, flow in zip(taint_list.sites, counts.tolist(), flows.tolist(), strict=True):
            if count and flow:
                found[place.id] = flow / count
    return found


def _returned(order: Order, by_site: Mapping[str, float]) -> Iterator[tuple[str, float]]:
    """Yield the functions in the flows that returned numbers, each with the recorded size."""
    for step in order.analysis.sites:
        size = by_site.get(str(step.site))
        if size and step.site.text.startswith("return "):
            yield step.site.qualname.rpartition(".")[2], size


def _assigned(order: Order, by_site: Mapping[str, float]) -> Iterator[tuple[str, float]]:
    """Yield the names and attributes that flows assign, each with the size recorded at the assignment."""
    for step in order.analysis.sites:
        size = by_site.get(str(step.site))
        try:
            source = document(step.span.path, order.analysis.sources[step.span.path])
        except (RepairError, KeyError):
            continue
        for node in source.statements_at.get(step.span.line, ()):
            if size and isinstance(node, ast.Assign):
                yield ast.unparse(node.targets[0]), size
