"""Interpret both branches of an `if` in a launch file; its condition is known only on the robot.

`launch_alternatives` joins the values of both branches.
"""

from __future__ import annotations

import ast
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Final

from tarl_lint.workspace.conditions import combined
from tarl_lint.workspace.launch_actions import Action
from tarl_lint.workspace.launch_alternatives import (
    ABSENT,
    LONGEST,
    closed,
    conditional,
    either,
    negated,
    one_of,
)
from tarl_lint.workspace.launch_paths import Branch, Frame, Loop, Names
from tarl_lint.workspace.python.elements import Unique
from tarl_lint.workspace.python.evaluator import Library, Unknown
from tarl_lint.workspace.python.instances import Made
from tarl_lint.workspace.python.interpreter import Interpreter
from tarl_lint.workspace.python.jumps import Left, Raised, Returned
from tarl_lint.workspace.python.match_patterns import fits
from tarl_lint.workspace.python.objects import Class, Function
from tarl_lint.workspace.python.values import Bound, Scope, Stream

_ADDING: Final = frozenset(["append", "appendleft", "extend", "insert", "add", "add_action", "add_entity"])

_Runs = tuple[Callable[[], None], Callable[[], None]]  # functions that interpret the two branches


class BranchingInterpreter(Interpreter):
    """Interprets both branches of an `if` whose condition is not constant."""

    _branches: list[Branch]
    _frames: list[Frame]
    _open_loops: list[Loop]

    def __init__(self, *args: Any, **keywords: Any) -> None:
        super().__init__(*args, **keywords)
        self._branches, self._frames, self._open_loops = [], [], []

    @property
    def condition(self) -> str:
        """Return the conditions under which the current statement runs; "" if there are none."""
        found = ""
        for one in self._branches:
            found = combined(found, one.condition)
        return found

    def _do_if(self, statement: ast.If, names: Scope) -> None:
        test = self.value(statement.test, names)
        if not isinstance(test, Unknown | Library):
            self.body(statement.body if test else statement.orelse, names)
            return
        text, line = ast.unparse(statement.test)[:LONGEST], statement.lineno
        both = "; both branches are read" if statement.orelse else ""
        for kept, left in ((statement.orelse, statement.body), (statement.body, statement.orelse)):
            if left and isinstance(left[-1], ast.Raise):
                self.problem(line, f"the condition `{text}` is not constant", hides=False)
                self.body(kept, names)
                return
        self.problem(line, f"the condition `{text}` is not constant{both}", hides=False)
        runs = (lambda: self.body(statement.body, names)), (lambda: self.body(statement.orelse, names))
        self._alternatives(runs, text, line, names)

    def _do_match(self, statement: ast.Match, names: Scope) -> None:
        self._cases(statement, 0, self.value(statement.subject, names), names)

    def _cases(self, statement: ast.Match, first: int, subject: Any, names: Scope) -> None:
        """Interpret the cases of a `match`, beginning with a given case."""
        for index, case in enumerate(statement.cases[first:], first + 1):
            fit = fits(self, case.pattern, subject, names)
            if fit and case.guard is not None:
                guard = self.value(case.guard, names)
                fit = guard if fit is True or not guard else fit
            if isinstance(fit, Unknown | Library):
                pattern, line = ast.unparse(case.pattern)[:LONGEST], case.pattern.lineno
                self.problem(line, f"the case `{pattern}` is not constant", hides=False)
                compared = "==" if isinstance(case.pattern, ast.MatchValue) else "matches"
                text = f"{ast.unparse(statement.subject)[:LONGEST]} {compared} {pattern}"
                runs = (
                    lambda body=case.body: self.body(body, names),
                    lambda rest=index: self._cases(statement, rest, subject, names),
                )
                self._alternatives(runs, text, line, names)
                return
            if fit:
                self.body(case.body, names)
                return

    def _alternatives(self, runs: _Runs, text: str, line: int, names: Scope) -> None:
        """Interpret both branches, and continue with the names of the branches that do not end early.

        A branch ends early by `return`, `raise`, `break` or `continue`.
        """
        text, other_text = closed(text), negated(text)
        before = Names.of(names)
        old = self._containers(before)
        left, rest = self._branch(runs[0], Branch(text, old))
        after = Names.of(names)
        before.restore()
        other, other_rest = self._branch(runs[1], Branch(other_text, old))
        if left is not None and other is not None:
            self._leave_both(left, other, text, after, old, names)
        if left is None and other is None:
            self._join(after, text, line)
            if rest or other_rest:
                self._go_on(
                    f"({_all(text, rest)} or {_all(other_text, other_rest)})", old, [*rest, *other_rest]
                )
        elif other is None:
            self._note(left, text, after)
            self._go_on(_all(other_text, other_rest), old, other_rest, left)
        else:
            self._note(other, other_text, Names.of(names))
            after.restore()
            self._go_on(_all(text, rest), old, rest, other)

    def _branch(self, run: Callable[[], None], branch: Branch) -> tuple[Exception | None, list[Branch]]:
        """Interpret a branch. Return the exception that ended it early, or None; and its conditions if it goes on."""
        count = len(self._branches)
        self._branches.append(branch)
        try:
            run()
        except (Returned, Left, Raised) as left:
            return left, []
        else:
            return None, self._branches[count + 1 :]
        finally:
            del self._branches[count:]

    def _note(self, left: Exception | None, text: str, names: Names) -> None:
        """Note the value that one branch returns, or its names if it ends with `break` or `continue`."""
        if isinstance(left, Returned):
            if not self._frames:
                raise left
            self._frames[-1].returned.append((combined(self.condition, text), left.value))
        elif isinstance(left, Left):
            loop = self._open_loops[-1]
            within = _all("", self._branches[loop.start :])
            (loop.breaks if left.whole else loop.continues).append((combined(within, text), names))

    def _go_on(
        self, text: str, old: dict[int, Any], within: list[Branch], left: Exception | None = None
    ) -> None:
        """Put the following statements under a condition, up to the end of the function or loop that `left` leaves."""
        whole = any(one.whole for one in within) if left is None else not isinstance(left, Left) or left.whole
        self._branches.append(Branch(text, old, whole))

    def _leave_both(
        self, left: Exception, other: Exception, text: str, after: Names, old: dict[int, Any], names: Scope
    ) -> None:
        """Raise the exception that represents both branches, each of which ended early.

        A branch that ends with `break` or `continue` represents both branches, since statements follow such a
        branch.
        """
        if isinstance(left, Raised):
            raise other
        if isinstance(other, Left) or (isinstance(left, Returned) and isinstance(other, Returned)):
            self._note(left, text, after)
            if isinstance(other, Left):
                self._go_on(negated(text), old, [], left)
            raise other
        if isinstance(other, Returned):
            self._note(other, negated(text), Names.of(names))
            self._go_on(text, old, [], other)
        after.restore()
        raise left

    def _join(self, after: Names, text: str, line: int) -> None:
        """Bind each name to the value of both branches; `after` are the names after the first branch."""
        for scope, first in zip(after.scopes, after.values, strict=True):
            for name in [*first, *(one for one in scope if one not in first)]:
                one, other = first.get(name, ABSENT), scope.get(name, ABSENT)
                if one is not other:
                    scope[name] = either(one, other, text, line)

    def _do_return(self, statement: ast.Return, names: Scope) -> None:
        if self._frames:
            self._frames[-1].last = self.condition
        super()._do_return(statement, names)

    def _containers(self, names: Names) -> dict[int, Any]:
        """Return the lists, dicts and objects that names refer to, by identity."""
        found: dict[int, Any] = {}
        pending: list[Any] = [one for scope in names.values for one in scope.values()]
        while pending:
            one = pending.pop()
            if isinstance(one, list | tuple | dict | Unique | deque | Made | Action) and id(one) not in found:
                found[id(one)] = one
                pending += _inside(one)
        self.spend(len(found) // 10)
        return found

    def kept(self, container: Any, value: Any) -> Any:
        """Return the form in which a container keeps a value that is stored under the current conditions."""
        condition = ""
        for one in self._branches:
            if id(container) in one.old:
                condition = combined(condition, one.condition)
        return conditional(value, condition, self.line) if condition else value

    def call(self, called: Any, args: list[Any], keywords: dict[str, Any], node: ast.Call) -> Any:
        """Return the value of a call; elements that it adds to a list under a condition are conditional."""
        if self._branches and args:
            bound = isinstance(called, Bound)
            owner = called.of if bound else getattr(called, "__self__", None)
            name = called.name if bound else getattr(called, "__name__", "")
            if name in _ADDING and isinstance(owner, list | deque | Unique | Action):
                last = list(args[-1]) if isinstance(args[-1], Stream) and not args[-1].endless else args[-1]
                args = [*args[:-1], self.kept(owner, last)]
        return super().call(called, args, keywords, node)

    def _ifexp(self, node: ast.IfExp, names: Scope) -> Any:
        test = self.value(node.test, names)
        if not isinstance(test, Unknown | Library):
            return self.value(node.body if test else node.orelse, names)
        text = closed(ast.unparse(node.test)[:LONGEST])
        old = self._containers(Names.of(names))
        found = []
        for expression, condition in ((node.body, text), (node.orelse, negated(text))):
            self._branches.append(Branch(condition, old))
            try:
                found.append(self.value(expression, names))
            finally:
                self._branches.pop()
        return either(found[0], found[1], text, node.lineno)

    def _enter(
        self, function: Function, args: list[Any], keywords: dict[str, Any], owner: Class | None = None
    ) -> Any:
        frame = Frame(len(self._branches))
        self._frames.append(frame)
        try:
            returned = super()._enter(function, args, keywords, owner)
        finally:
            self._frames.pop()
            del self._branches[frame.branches :]
        # no branch returns a value, or the function is a generator
        if all(value is None for _, value in frame.returned):
            return returned
        return one_of([*frame.returned, (frame.last, returned)], function.node.lineno)

    def _stops(self, body: list[ast.stmt], names: Scope) -> bool:
        """Interpret the body of a loop once, and return whether no iteration follows.

        If the body ends early, continue with the names with which an unknown condition left the iteration or the
        loop earlier.
        """
        loop, loop.start = self._open_loops[-1], len(self._branches)
        try:
            stops = super()._stops(body, names)
        except (Returned, Raised) as left:
            if not loop.continues and not loop.breaks:
                raise
            self._note(left, "", Names.of(names))
            goes_on = bool(loop.continues)
            self._resume(loop, names)
            return not goes_on
        if stops and loop.continues:
            self._note(Left(whole=True), "", Names.of(names))
            self._resume(loop, names)
            return False
        self._branches[loop.start :] = [one for one in self._branches[loop.start :] if one.whole]
        self._join_all(loop.continues, loop.line)
        return stops

    def _do_for(self, statement: ast.For, names: Scope) -> None:
        count, returned = len(self._branches), self._returned()
        with self._loop(statement.lineno):
            super()._do_for(statement, names)
        if self._returned() == returned:
            del self._branches[count:]

    @contextmanager
    def _loop(self, line: int) -> Iterator[None]:
        """Interpret a loop. After the loop, each name has the values that it may have at any end of the loop."""
        loop = Loop(len(self._branches), len(self._branches), line)
        self._open_loops.append(loop)
        try:
            yield
        finally:
            self._open_loops.pop()
        self._join_all(loop.breaks, line)

    def _resume(self, loop: Loop, names: Scope) -> None:
        """Continue with the names with which an unknown condition left the iteration or, otherwise, the loop."""
        begin, left = (loop.start, loop.continues) if loop.continues else (loop.begin, loop.breaks)
        texts = [text for text, _ in left]
        left.pop()[1].restore()
        self._join_all(left, loop.line)
        text = texts[0] if len(texts) == 1 else f"({' or '.join(dict.fromkeys(texts))})"
        self._branches[begin:] = [Branch(text, self._containers(Names.of(names)))]

    def _join_all(self, left: list[tuple[str, Names]], line: int) -> None:
        """Bind each name to its values where the loop or iteration was left, or else to its current one."""
        while left:
            text, names = left.pop()
            self._join(names, text, line)

    def _do_while(self, statement: ast.While, names: Scope) -> None:
        """Interpret a loop; if an unknown condition may end the loop, interpret it once."""
        count, returned = len(self._branches), self._returned()
        with self._loop(statement.lineno):
            while True:
                test = self.value(statement.test, names)
                if isinstance(test, Unknown | Library):
                    super()._do_while(statement, names)
                    return
                if not test or self._stops(statement.body, names) or len(self._branches) > count:
                    break
            if self._returned() == returned:
                del self._branches[count:]
            if not test:
                self.body(statement.orelse, names)

    def _returned(self) -> int:
        return len(self._frames[-1].returned) if self._frames else 0


def _inside(value: Any) -> list[Any]:
    if isinstance(value, Made):
        return list(value.attributes.values())
    held: Any = value.values if isinstance(value, Action) else value
    return list(held.values()) if isinstance(held, Mapping) else list(held)


def _all(text: str, rest: list[Branch]) -> str:
    for one in rest:
        text = combined(text, one.condition)
    return text
