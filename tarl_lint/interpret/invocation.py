"""Calls of code that is not analysed, with their arguments."""

from __future__ import annotations

from dataclasses import dataclass

from tarl_lint.catalog import NO_FACT, Fact
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import BOTTOM, Value

Arguments = tuple[list[Value], dict[str, Value]]


@dataclass(slots=True)
class Invocation:
    """A call of code that is not analysed. `base` is the receiver of a method."""

    name: str
    base: Value
    arguments: Arguments
    frame: Frame
    call: ir.Call
    fact: Fact = NO_FACT

    @property
    def statement(self) -> int:
        """Return the number of the calling statement; -1 if ROS is the caller."""
        return self.frame.statement.id if self.frame.statement is not None else -1

    def argument(self, which: tuple[int, str]) -> Value:
        """Return an argument by position or keyword; BOTTOM if the call does not pass it."""
        number, name = which
        plain, named = self.arguments
        if 0 <= number < len(plain):
            return plain[number]
        return named.get(name, BOTTOM)
