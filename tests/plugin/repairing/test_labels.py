"""A search changes quantities, but no members of an enumeration, exponents or values used only as truth values."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.repairing.labels import quantities
from tarl_lint.model import Operand, SiteId, Span

MODES = "from enum import Enum\n\n\nclass Mode(Enum):\n    WAIT = 1\n    DRIVE = 2\n"


@pytest.mark.parametrize(
    ("line", "code", "value", "moved"),
    [
        ("self.mode = Mode.DRIVE", "Mode.DRIVE", 2, False),
        ("self.mode = modes.Mode.DRIVE", "modes.Mode.DRIVE", 2, False),
        ("while self.mode is Mode.DRIVE: step()", "self.mode", 1, False),
        ("ready = self.mode == Mode.DRIVE", "self.mode", 1, False),
        ("ready = self.count == 3", "self.count", 2, True),
        ("if self.eager and not self.done: step()", "self.eager", None, False),
        ("if self.eager and not self.done: step()", "self.done", None, False),
        ("if self.eager and not self.done: step()", "self.done", True, True),
        ("if self.eager and not self.done: step()", "self.done", 0, True),
        ("if self.eager > 2.5: step()", "self.eager", 3.0, True),
        ("publish((x**2 + y**2) ** 0.5)", "2", 2, False),
        ("publish((x**2 + y**2) ** 0.5)", "0.5", 0.5, False),
        ("publish(x**1.8 * 2)", "1.8", 1.8, True),
        ("publish(turn.dot(array([x, -y, 0.3, 1]))[:3])", "1", 1, False),
        ("publish(turn.dot(array([x, -y, 0.3, 1]))[:3])", "0.3", 0.3, True),
        ("publish(turn.dot(array([x, y, 1]))[:3])", "1", 1, True),
        ("publish(lerp([2, 4, 8, 1]))", "1", 1, True),
        ("publish(x**1.8 * 2)", "2", 2, True),
        ("publish(2**x)", "2", 2, True),
        ("stamp = msg.sec + msg.nanosec * 1e-9", "1e-9", 1e-9, False),
        ("stamp = msg.sec + msg.nanosec / 1e9", "1e9", 1e9, False),
        ("late = now - stamp > 1e-6", "1e-6", 1e-6, True),
        ("def on(msg): self.kpa = msg.pressure / 1000.0", "1000.0", 1000.0, False),
        ("def on(msg): self.gap = 0.001 * float(msg.range) - 0.2", "0.001", 0.001, False),
        ("def on(msg): self.gap = 0.001 * float(msg.range) - 0.2", "0.2", 0.2, True),
        ("def on(msg): self.speed = min(msg.data * 3.6, 50)", "3.6", 3.6, False),
        ("def on(msg): self.angle = -msg.data * 57.3", "57.3", 57.3, False),
        ("def on(msg): self.angle = msg.data * 180 / math.pi", "180", 180, False),
        ("def on(msg): self.angle = self.raw * (180 / math.pi)", "180", 180, False),
        ("def on(msg): self.angle = msg.data * 180 / 7.0", "180", 180, True),
        ("def on(msg): self.share = msg.data / 100.0", "100.0", 100.0, False),
        ("def on(msg): self.share = msg.data * 0.01", "0.01", 0.01, False),
        ("def on(msg): self.turn = 0.01 * msg.data + 0.2", "0.01", 0.01, True),  # perhaps a gain
        ("def on(msg): self.turn = 0.5 * msg.data", "0.5", 0.5, True),
        ("def on(msg): self.turn = 1000.0 * self.error", "1000.0", 1000.0, True),
        ("def on(msg): self.turn = 1000.0 * (self.goal - msg.data)", "1000.0", 1000.0, True),
        ("def on(msg): self.rate = 1000.0 / msg.period", "1000.0", 1000.0, True),
        ("def on(msg): self.far = msg.range > 1000.0", "1000.0", 1000.0, True),
        ("level = alpha * level + (1.0 - alpha) * x", "1.0", 1.0, False),
        ("publish(gain * (1.0 - level))", "1.0", 1.0, True),
        ("publish((self.eager or 1.0) * x)", "self.eager", 3.0, True),
        ("publish(LIMIT if self.eager else x)", "self.eager", 3.0, False),
        ("publish(LIMIT if self.eager else x)", "LIMIT", 0.8, True),
    ],
)
def test_a_search_changes_quantities_but_not_indices_or_sizes(
    line: str, code: str, value: float | bool | None, moved: bool
) -> None:
    at = line.index(code) + 1
    span = Span("node.py", 1, at, 1, at + len(code))
    operand = Operand(SiteId("node", "run", line, 0), span, code, value)
    analysis: Any = SimpleNamespace(sources={"node.py": line + "\n", "modes.py": MODES})
    assert quantities(analysis, [operand]) == ([operand] if moved else [])
