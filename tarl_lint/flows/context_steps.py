"""Context steps of a flow: the registration, the `__main__` guard, loops around steps and calls."""

from __future__ import annotations

from collections.abc import Sequence

from tarl_lint.flows.statement_text import Texts, Written
from tarl_lint.memory.frames import Frame
from tarl_lint.models.ros.endpoints import SourceRecord

Enclosing = dict[int, Written]  # `id` of a statement → the statement, in order
# keys: pairs of the `id` of an enclosing statement and the `id` of the step that this statement precedes
Before = dict[tuple[int, int], None]


class Surroundings:
    """Finds the context steps of flows."""

    def __init__(self, texts: Texts) -> None:
        self.texts = texts
        self._above: dict[int, Written | None] = {}  # statement → nearest enclosing loop or guard
        # results by frame and statement
        self._known: dict[tuple[Frame, int], tuple[Enclosing, Before]] = {}

    def registration(self, origin: SourceRecord) -> Written | None:
        """Return the statement that subscribes."""
        return self.texts[origin.path].statement(origin.statement.pos)

    def context(
        self, origin: SourceRecord, steps: Sequence[tuple[Frame, Written]]
    ) -> tuple[list[Written], list[tuple[int, int]]]:
        """Return the statements around the steps and the registration, and pairs of such a statement and its step."""
        found: Enclosing = {}
        edges: Before = {}
        registration = self.registration(origin)
        if registration is not None:
            found[id(registration)] = registration
            steps = [(origin.frame, registration), *steps]
        for frame, written in steps:
            enclosing, before = self._enclosing(frame, written)
            found.update(enclosing)
            edges.update(before)
        return list(found.values()), list(edges)

    def _enclosing(self, frame: Frame, written: Written) -> tuple[Enclosing, Before]:
        """Return the statements that enclose a step and the calls leading to it.

        The result is the same for all flows.
        """
        known = self._known.get((frame, id(written)))
        if known is None:
            known = self._known[frame, id(written)] = {}, {}
            self._around(written, written, written, *known)
            self._callers(frame, written, *known)
        return known

    def _callers(self, frame: Frame, step: Written, found: Enclosing, edges: Before) -> None:
        """Add the statements that enclose the calls leading to a frame, innermost first."""
        current: Frame | None = frame
        inner = step
        while current is not None and current.caller is not None and current.call is not None:
            call = self.texts[current.caller.program.path].statement(current.call.pos)
            if call is not None:
                inner = self._around(call, step, inner, found, edges)
            current = current.caller

    def _around(
        self,
        written: Written,
        step: Written,
        inner: Written,
        found: Enclosing,
        edges: Before,
    ) -> Written:
        """Add the loops and guards that enclose a statement; return the outermost one."""
        around = self._shown(written)
        while around is not None:
            found[id(around)] = around
            edges[id(around), id(step)] = None
            if inner is not step:
                edges[id(around), id(inner)] = None
            inner = around
            around = self._shown(around)
        return inner

    def _shown(self, written: Written) -> Written | None:
        """Return the nearest loop or guard that encloses a statement in its function."""
        passed = [written]
        while id(passed[-1]) not in self._above:
            around = passed[-1].around
            if around is None or around.defines or around.shown:
                self._above[id(passed[-1])] = None if around is None or around.defines else around
            else:
                passed.append(around)
        answer = self._above[id(passed[-1])]
        self._above.update((id(w), answer) for w in passed)
        return answer
