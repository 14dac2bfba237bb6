"""Modules that record which function bodies an analysis reads, and its questions about the text with their answers.

If a run has read neither a function's body nor the whole text, the run does not depend on this body. Reads are
recorded where they happen, so the reads of new code are recorded, too. Looking up statements for a report is not
recorded, since a report only shows what the analysis has read.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, SupportsIndex

from tarl_lint.read.source import Module

FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
Question = Callable[[str], bool]
Place = tuple[int, int]  # line and column of a definition, as `ast` counts them


class Body(list[ast.stmt]):
    """A function's statements; `read` is set once any code reads the statements."""

    read = False

    def __iter__(self) -> Iterator[ast.stmt]:
        self.read = True
        return super().__iter__()

    def __reversed__(self) -> Iterator[ast.stmt]:
        self.read = True
        return super().__reversed__()

    def __getitem__(self, index: SupportsIndex | slice) -> Any:
        self.read = True
        return super().__getitem__(index)

    def __len__(self) -> int:
        self.read = True
        return super().__len__()

    def __contains__(self, item: object) -> bool:
        self.read = True
        return super().__contains__(item)

    def __add__(self, other: list[Any]) -> list[Any]:
        self.read = True
        return super().__add__(other)


@dataclass(frozen=True)
class Reading:
    """The parts of one file that an analysis did not read, and its questions about the text with their answers.

    `unread` are the functions whose bodies were not read. `whole` means that the analysis read the whole text.
    """

    unread: frozenset[Place]
    answers: tuple[tuple[Question, bool], ...]
    whole: bool


@dataclass(frozen=True)
class Watched(Module):
    """A module that records which of its parts are read."""

    answers: list[tuple[Question, bool]] = field(default_factory=list)
    # a list with one entry for each use of the complete text
    texts_read: list[None] = field(default_factory=list)

    def __getattribute__(self, name: str) -> Any:
        """Record uses of the text."""
        if name == "text":
            object.__getattribute__(self, "texts_read").append(None)
        return object.__getattribute__(self, name)

    def answer(self, question: Question) -> bool:
        """Record a question and its answer."""
        known = question(displayed(self))
        self.answers.append((question, known))
        return known

    def reading(self) -> Reading:
        """Return the parts of the module that were read since watching began."""
        unread = frozenset(
            (function.lineno, function.col_offset)
            for function in _functions(self.tree.body)
            if isinstance(function.body, Body) and not function.body.read
        )
        return Reading(unread, tuple(self.answers), bool(self.texts_read))


def watched(module: Module) -> Watched:
    """Return a module with the same syntax tree that records which of its parts are read from now on."""
    for function in [*_functions(module.tree.body)]:
        function.body = Body(unwatched(function.body))
    return Watched(
        module.path, module.name, module.text, module.tree, module.is_package, module.started,
        module.installed,
    )  # fmt: skip


def displayed(module: Module) -> str:
    """Return a module's text without recording the read; used to display statements that the analysis has read."""
    text: str = object.__getattribute__(module, "text")
    return text


def unwatched(body: Sequence[ast.stmt]) -> Sequence[ast.stmt]:
    """Return a function's statements without recording the read."""
    return body.copy() if isinstance(body, Body) else body


def _functions(body: Sequence[ast.stmt]) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    """Yield the functions that statements define, also nested statements, without recording the read."""
    pending = [*body]
    while pending:
        node = pending.pop()
        if isinstance(node, FUNCTIONS):
            yield node
            pending += unwatched(node.body)
            continue
        for name in ("body", "orelse", "finalbody"):
            pending += getattr(node, name, ())
        for part in (*getattr(node, "handlers", ()), *getattr(node, "cases", ())):
            pending += part.body
