"""Small findings, flows and results for tests of the editor."""

from __future__ import annotations

from typing import Any

from tarl_lint.model import Finding, Flow, Sink, SiteId, Source, Span, Step

TEXT = "import rospy\nspeed = 2 * goal\nif free:\n    out.publish(speed)\n"


def span(line: int, start: int = 1, end: int = 2, path: str = "pilot.py", end_line: int = 0) -> Span:
    return Span(path, line, start, end_line or line, end)


def step(line: int, code: str, role: Any = "assign", path: str = "pilot.py") -> Step:
    return Step(SiteId("pilot", "", code), span(line, 1, 6, path), code, role, "data")


def flow(
    kind: Any = "explicit", topics: tuple[str, ...] = ("/goal",), callback: str = "on_goal", **changed: Any
) -> Flow:
    """Return a flow of two statements into the call in line 4."""
    steps = changed.pop("steps", (step(2, "speed = 2 * goal"), step(3, "if free", "condition")))
    sink = Sink("sink", changed.pop("at", span(4, 5, 23)), ("/wheels",), "Float64", "rospy")
    return Flow(kind, Source("source", span(1), topics, "Float64", callback, "rospy"), sink, steps, **changed)


def finding(code: str = "TARL101", of: Flow | None = None, **changed: Any) -> Finding:
    at = of.sink.span if of is not None else span(2, 1, 6)
    return Finding(code, changed.pop("span", at), f"message of {code}", of, "f1", **changed)
