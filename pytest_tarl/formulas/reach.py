"""Check that every part of a formula is evaluated at some time during the episode."""

from __future__ import annotations

import math
from typing import Any

from pytest_tarl.formulas.semantics import BOOLEAN, FUTURE, PAST, TIMED, bounds, operands
from pytest_tarl.formulas.signals import NANOSECONDS

Span = tuple[float, float]  # first and last time in ns, both inclusive


def unjudged(tree: Any, end: float = math.inf) -> str:
    """Return why a formula can never be judged in an episode that ends at `end` (ns), or an empty text.

    A formula is evaluated at the start of the episode, and its operands at the times that the windows of its operators
    reach from there. The reason has no full stop.
    """
    if not _temporal(tree):
        return "it is evaluated at the beginning of the episode only: put always or eventually before it"
    return _unjudged(tree, (0.0, 0.0), end)


def _unjudged(node: Any, span: Span, end: float) -> str:
    first, last = span[0], min(span[1], end)
    if first > end:
        return f"a part of it is evaluated after {first / NANOSECONDS:g} s at the earliest"
    if last < 0 or (isinstance(node, PAST) and last == 0):
        return "a part of it looks back from the beginning of the episode: put always or eventually before it"
    spans = _spans(node, max(first, 0.0), last)
    problems = (_unjudged(child, one, end) for child, one in zip(operands(node), spans, strict=True) if spans)
    return next((problem for problem in problems if problem), "") if spans else ""


def _spans(node: Any, first: float, last: float) -> list[Span]:
    """Return the time spans in which a node's operands are evaluated; none for a comparison."""
    if isinstance(node, FUTURE):
        begin, end = bounds(node) if isinstance(node, TIMED) else (0, math.inf)
        return [(first, last + end), (first + begin, last + end)][-len(operands(node)) :]
    if isinstance(node, PAST):
        begin, end = bounds(node) if isinstance(node, TIMED) else (0, math.inf)
        return [(max(first - end, 0.0), last), (max(first - end, 0.0), last - begin)][-len(operands(node)) :]
    if isinstance(node, BOOLEAN):
        return [(first, last)] * len(operands(node))
    return []


def _temporal(node: Any) -> bool:
    return isinstance(node, FUTURE + PAST) or (
        isinstance(node, BOOLEAN) and any(_temporal(child) for child in operands(node))
    )
