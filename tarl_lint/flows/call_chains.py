"""Calls that lead from a condition to the function that computes the chosen value."""

from __future__ import annotations

from tarl_lint.memory.frames import Frame
from tarl_lint.memory.value_flow_graph import Place


def calls(frame: Frame, outer: Frame) -> list[Place]:
    """Return the calls that lead from one frame to another, outermost first; empty if no calls lead there."""
    found: list[Place] = []
    current: Frame | None = frame
    while current is not None and current is not outer:
        if current.caller is None or current.call is None:
            return []
        found.append(Place(current.caller, current.call, "call", current.call.pos))
        current = current.caller
    return found[::-1]
