"""The possible paths through a launch file with unknown conditions."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from tarl_lint.workspace.python.values import Scope


@dataclass
class Branch:
    """A condition on statements. `old` are the containers that existed before the condition, by identity."""

    condition: str
    old: dict[int, Any]
    # whether the condition holds until the end of the loop, not of the iteration
    whole: bool = True


@dataclass
class Frame:
    """A function call with its conditional returned values."""

    branches: int
    returned: list[tuple[str, Any]] = field(default_factory=list)
    last: str = ""  # the condition of the last `return`


@dataclass
class Names:
    """The names of a scope and of the scopes around it."""

    scopes: list[dict[str, Any]]
    values: list[dict[str, Any]]

    @classmethod
    def of(cls, names: Scope) -> Names:
        """Return the current names of a scope and of the scopes around it."""
        scopes: list[dict[str, Any]] = []
        scope: Scope | None = names
        while scope is not None:
            scopes.append(scope.names)
            scope = scope.around
        return cls(scopes, [dict(one) for one in scopes])

    def restore(self) -> None:
        """Bind all names as they were."""
        for scope, values in zip(self.scopes, self.values, strict=True):
            scope.clear()
            scope.update(values)


@dataclass
class Loop:
    """A loop with its conditional `break` and `continue` statements."""

    begin: int  # number of conditions around the loop
    start: int  # number of conditions around the current iteration
    line: int
    breaks: list[tuple[str, Names]] = field(default_factory=list)
    continues: list[tuple[str, Names]] = field(default_factory=list)
