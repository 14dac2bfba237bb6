"""Questions about single statements, answered by running the analysis once more and looking on."""

from __future__ import annotations

from dataclasses import dataclass, field

from tarl_lint.model import Operand, SiteId, Span
from tarl_lint.taint import closure
from tarl_lint.valueflow import ir
from tarl_lint.valueflow.link import Linker
from tarl_lint.valueflow.machine import Machine
from tarl_lint.valueflow.sites import Text, Written
from tarl_lint.valueflow.values import Frame, Obj, Value, join

Place = tuple[str, ir.Pos]  # path and position of an expression
MAX_PATHS = 400  # expressions that are looked at for one state


@dataclass(slots=True)
class Use:
    """An expression of a statement: what it was in any execution."""

    expr: ir.Expr
    value: Value


@dataclass(slots=True)
class Seen:
    """What was seen at one statement: its expressions, and what its variables may hold before it runs."""

    uses: dict[ir.Pos, Use] = field(default_factory=dict)
    holding: dict[str, Value] = field(default_factory=dict)
    visits: int = 0


class Prober:
    """Remembers what was seen at each statement of the analysed modules."""

    def __init__(self, machine: Linker) -> None:
        self.machine = machine
        self.texts = {path: Text(module) for path, module in machine.modules.items()}
        self.seen: dict[SiteId, Seen] = {}
        self.places: dict[tuple[str, tuple[int, int]], SiteId] = {}
        forward: list[list[int]] = [[] for _ in machine.graph.places]
        self.wanted: set[SiteId] = set()
        self.forward = forward

    def operands(self, site: SiteId) -> tuple[Operand, ...]:
        """Return the constants that a site uses."""
        return ()

    def holders(self, topic: str, field: str, site: SiteId) -> tuple[str, ...]:
        """Return expressions that hold a topic's field unchanged at a site."""
        return ()


__all__ = ["Frame", "Machine", "Obj", "Span", "Written", "closure", "join"]
