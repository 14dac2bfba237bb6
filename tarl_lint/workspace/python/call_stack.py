"""The stack of interpreted calls, with receivers of yielded values."""

from __future__ import annotations

import ast
import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from tarl_lint.workspace.python.evaluation import Execution
from tarl_lint.workspace.python.functions import arguments, yields
from tarl_lint.workspace.python.jumps import Enough, Left, Returned
from tarl_lint.workspace.python.objects import Class, Function
from tarl_lint.workspace.python.values import Scope, Stream, Suspended, Unknown

DEEPEST: Final = 30  # maximum nesting of calls of the file's own functions
YIELDED: Final = 1_000  # maximum number of values that are read from a generator
OWN: Final = "__class__"  # name under which the class of a method is stored, for `super()`

Taking = list[Any] | Callable[[Any], None]  # receives the values that the function yields


@dataclass(frozen=True)
class _Frame:
    """A call: its file, and the function that receives its yielded values."""

    file: Path
    taking: Taking


class CallStack:
    """The calls that are being interpreted; the first frame is the file itself."""

    def __init__(self, file: Path) -> None:
        self._frames = [_Frame(file, [])]
        self._generators: dict[ast.FunctionDef, bool] = {}  # function → whether it contains `yield`

    @property
    def file(self) -> Path:
        """Return the file of the current function."""
        return self._frames[-1].file

    def is_full(self) -> bool:
        """Return whether the limit of nested calls is reached."""
        return len(self._frames) > DEEPEST

    def push(self, file: Path) -> None:
        """Begin with the statements of a module."""
        self._frames.append(_Frame(file, []))

    def pop(self) -> None:
        """End the statements of a module."""
        self._frames.pop()

    def give(self, values: list[Any]) -> None:
        """Add yielded values. Raises Enough if the generator may be endless."""
        frame = self._frames[-1]
        if isinstance(frame.taking, list):
            frame.taking.extend(values)
            if len(frame.taking) >= YIELDED:
                raise Enough
            return
        self._frames.pop()  # the block of a `with` statement runs in the frame of the function around it
        try:
            for one in values:
                frame.taking(one)
        finally:
            self._frames.append(frame)

    def enter(
        self,
        run: Execution,
        function: Function,
        args: list[Any],
        keywords: dict[str, Any],
        owner: Class | None,
    ) -> Any:
        """Interpret a call; return its value, a Stream or a Suspended."""
        if function.kind == "contextmanager":
            plain = dataclasses.replace(function, kind="")
            return Suspended(lambda entered: self._taken(run, entered, plain, (args, keywords, owner)))
        return self._taken(run, [], function, (args, keywords, owner))

    def _taken(
        self,
        run: Execution,
        taking: Taking,
        function: Function,
        given: tuple[list[Any], dict[str, Any], Class | None],
    ) -> Any:
        if self.is_full():
            return Unknown(function.node.lineno, function.node.name)
        args, keywords, owner = given
        inside = Scope(arguments(function, args, keywords), function.scope)
        if owner is not None:
            inside.names[OWN] = owner
        self._frames.append(_Frame(function.file, taking))
        returned: Any = None
        endless = False
        try:
            run.body(function.node.body, inside)
        except Returned as found:
            returned = found.value
        except Enough:
            endless = True
        except Left:
            pass
        finally:
            self._frames.pop()
        if isinstance(taking, list) and self._generates(function.node):
            return Stream(iter(taking), endless=endless)
        return returned

    def _generates(self, node: ast.FunctionDef) -> bool:
        if node not in self._generators:
            self._generators[node] = yields(node)
        return self._generators[node]
