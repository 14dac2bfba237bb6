"""Find values from a subscription whose magnitude nothing limits."""

from __future__ import annotations

import ast
import re
from typing import Final

from tarl_lint.evidence import Evidence
from tarl_lint.flows.reachability import closure
from tarl_lint.model import Span
from tarl_lint.models.ros.endpoints import SinkRecord, SourceRecord
from tarl_lint.rules.limits.range_checks import LIMITING, comparisons, computes, dotted, side

HOLDS: Final = {"then": True, "body": True, "else": False, "done": False}


class Magnitudes:
    """Follows the data of one source until something limits its magnitude."""

    def __init__(self, evidence: Evidence, origin: SourceRecord) -> None:
        self.evidence = evidence
        self.graph = evidence.machine.graph
        self.origin = origin
        self.reached = evidence.tracer.reach(origin).data
        self._limits: dict[int, bool] = {}
        self._behind: dict[int, set[int]] = {}
        self.free = self._follow()

    def computed(self, sink: SinkRecord) -> list[Span]:
        """Return the statements that last compute the unlimited values of a published message."""
        found: dict[Span, None] = {}
        seen = set(sink.nodes & self.free)
        pending = list(seen)
        while pending:
            node = pending.pop()
            written = self.evidence.tracer.statements.of(node)
            if written is not None and computes(written.node):
                found[written.text.span(written)] = None
                continue
            following = {d for d in self.graph.data[node] & self.free if not self._guarded(node, d)} - seen
            seen |= following
            pending += following
        return list(found)

    def _follow(self) -> set[int]:
        """Return the nodes that data of the source reaches without passing a limit."""
        start = {n for n in self.origin.nodes if not self._limiting(n)}
        found = set(start)
        pending = sorted(start)
        while pending:
            node = pending.pop()
            for following in self.evidence.tracer.forward_data[node]:
                if following in found or self._limiting(following) or self._guarded(following, node):
                    continue
                found.add(following)
                pending.append(following)
        return found

    # --- limits -------------------------------------------------------------------------------------------

    def _limiting(self, node: int) -> bool:
        known = self._limits.get(node)
        if known is None:
            known = self._limits[node] = self._limited_by_text(node) or any(
                self._holds_below(number, way, node) for number, way in self.graph.branches[node]
            )
        return known

    def _limited_by_text(self, node: int) -> bool:
        place = self.graph.places[node]
        if LIMITING.search(place.frame.function.name):
            return True
        if place.statement is None:
            return False
        written = self.evidence.tracer.statements.of(node)
        return written is not None and self.evidence.limited(written.node)

    def _holds_below(self, condition: int, way: str, node: int) -> bool:
        """Return whether a node is reached only under a condition that bounds its value from above."""
        test = self._test(condition)
        if test is None or not any(comparisons(test)) or not self._about(condition, test, node):
            return False
        holds = HOLDS.get(way)
        return holds is None or side(test, holds=holds) != "above"

    def _guarded(self, node: int, dep: int) -> bool:
        """Return whether a comparison of `dep` can put another value in the place of `dep` at `node`."""
        mine = self.graph.branches[dep]
        for other in self.graph.data[node]:
            if other != dep and any(self._compares(b, dep) for b in self.graph.branches[other] - mine):
                return True
        return False

    def _compares(self, branch: tuple[int, str], dep: int) -> bool:
        test = self._test(branch[0])
        return test is not None and any(comparisons(test)) and self._about(branch[0], test, dep)

    def _test(self, condition: int) -> ast.expr | None:
        """Return the condition of a decision."""
        place = self.graph.places[condition]
        if place.statement is None:
            return None
        written = self.evidence.tracer.statements.of(condition)
        node = written.node if written is not None else None
        return node.test if isinstance(node, (ast.If, ast.While, ast.Assert)) else None

    def _about(self, condition: int, test: ast.expr, node: int) -> bool:
        """Return whether a condition tests the same field, or a value from which `node` is computed."""
        asked = self._back(condition)
        made = self._back(node)
        if not asked:
            return False
        if (asked & made) - self.origin.nodes:
            return True
        written = self.evidence.tracer.statements.of(node)
        if written is None:
            return False
        text = written.text.text(written)
        return any(re.search(rf"\b{re.escape(name)}\b(?!\.)", text) for name in dotted(test))

    def _back(self, node: int) -> set[int]:
        """Return a node, and those nodes of the source from which it is computed."""
        known = self._behind.get(node)
        if known is None:
            start = (self.graph.data[node] | {node}) & (self.reached | {node})
            known = self._behind[node] = closure(start, [self.graph.data], self.reached)
        return known
