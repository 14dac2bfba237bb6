"""Exceptions on their way from a `raise` in a function to the handler in a caller."""

from __future__ import annotations

from tarl_lint.valueflow.frames import Escape, Frame
from tarl_lint.valueflow.taking import Taking
from tarl_lint.valueflow.values import join


class Raising(Taking):
    """Lets exceptions leave functions. One that nothing takes is left alone: the node ends there."""

    def leave(self, escape: Escape, frame: Frame) -> None:
        """Hand an exception to the handlers around it in the function, else out of the function."""
        attempt = next((t for t in reversed(frame.tries) if t.handled), None)
        if attempt is not None:
            attempt.raised = join(attempt.raised, escape.value)
        else:
            frame.escapes.append(escape)

    def escaped(self, frame: Frame, caller: Frame) -> None:
        """Let what comes after a call depend on whether the called function raises, when somebody takes that."""
        statement = caller.statement
        if statement is None or not any(t.handled for f in self.stack for t in f.tries):
            return
        for escape in frame.escapes:
            known = caller.function.raising.setdefault(statement.id, {})
            if escape.name not in known and caller.cls is None:
                known[escape.name] = None
                caller.function.control = None
            decision = self.condition(caller, statement)
            self.under(escape.frame, escape.statement, decision)
            if escape.decision is not None:
                self.graph.depend(decision, (escape.decision,))
            self.leave(Escape(caller, statement, escape.name, escape.value, decision), caller)
