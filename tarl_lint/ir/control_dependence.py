"""Control dependence inside one function, after Ferrante, Ottenstein and Warren (TOPLAS 1987).

Termination-insensitive: a statement after a loop does not depend on the loop's condition. Exceptions come from `raise`
and from the calls that are known to raise.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from typing import Final

from tarl_lint.ir import nodes as ir
from tarl_lint.ir.exception_types import NO_CLASSES, ExceptionTypes, Handled, handled_by, raised
from tarl_lint.ir.postdominance import EXIT, passed, postdominators

Branch = tuple[int, str]  # (number of the statement with the condition, outcome)

Raising = Mapping[int, Iterable[str]]

# maximum number of branches stored for a statement; further branches are found through the stored ones
NEAR: Final = 100
NOTHING_RAISES: Raising = {}
NOTHING: Mapping[int, Set[Branch]] = {}
NEXT: Final = -2  # number of a pseudo-statement: the beginning of the next iteration
# names that are used like the names of exceptions, for statements that may wait for ever:
# a call that waits; the rest of the function, or of an iteration of the innermost `while`, depends on it
BLOCKED: Final = "<blocked>"
SUSPENDED: Final = "<suspended>"  # a `yield` that waits for `send`; the rest of the generator depends on it


@dataclass(slots=True)
class Control:
    """For each statement, the branches on which it depends directly (`direct`) or in any way (`closure`).

    If there are very many branches, only the nearest are stored, and `far` contains the statement. `statements`
    maps numbers to statements.
    """

    direct: Mapping[int, frozenset[Branch]]
    closure: Mapping[int, frozenset[Branch]]
    far: frozenset[int]
    always: frozenset[int]  # numbers of the statements that run whenever the function is entered
    statements: Mapping[int, ir.Stmt]
    raising: Raising
    types: ExceptionTypes
    # numbers of the statements that wait in a `while` with a condition: what follows this loop does not depend on them
    kept_inside: frozenset[int] = frozenset()
    # cache of `iteration`: number of a loop → the control dependence inside it
    iterations: dict[int, Iteration] = field(default_factory=dict)

    def iteration(self, loop: ir.Loop) -> Iteration:
        """Return the control dependence inside one iteration of a loop."""
        found = self.iterations.get(loop.id)
        if found is None:
            found = self.iterations[loop.id] = _iteration(loop, self.raising, self.types)
        return found


@dataclass(frozen=True, slots=True)
class Iteration:
    """Control dependence inside one iteration of a loop, on branches of the same iteration only.

    `direct`, `closure` and `always` are as in `Control`, for the statements in the loop's body. `onward` are the
    branches that decide whether the next iteration begins.
    """

    direct: Mapping[int, frozenset[Branch]]
    closure: Mapping[int, frozenset[Branch]]
    always: frozenset[int]
    onward: frozenset[Branch]


@dataclass(slots=True)
class _Graph:
    """Control-flow edges: statement → successors by outcome."""

    edges: dict[int, dict[str, int]] = field(default_factory=dict)
    raising: Raising = field(default_factory=dict)
    types: ExceptionTypes = NO_CLASSES
    statements: dict[int, ir.Stmt] = field(default_factory=dict)
    waits: bool = False  # whether statements after a `while` depend on its condition
    end: int = EXIT  # where the body goes on: EXIT, or NEXT for the body of a loop
    # statement that waits in a loop → the loops around it, inner ones first, up to the first `while` with a condition
    waiting: dict[int, tuple[ir.Loop, ...]] = field(default_factory=dict)
    ending: frozenset[int] = frozenset()  # statements in loops that end the body by waiting for ever
    finals: list[tuple[ir.Try, int]] = field(
        default_factory=list
    )  # (`try`, number of the first statement of its `finally`), inner `try` statements first

    def link(self, source: int, way: str, target: int) -> None:
        self.edges.setdefault(source, {})[way] = target

    def throw(self, source: int, way: str, name: str, exits: _Exits) -> None:
        """Link a statement to each handler that may catch an exception; if none certainly does, also to the exit."""
        for number, target in enumerate(exits.of(name, self.types)):
            self.link(source, f"{way} {number}" if number else way, target)


@dataclass(frozen=True, slots=True)
class _Exits:
    """Targets of jumps at a statement."""

    on_break: int = EXIT
    on_continue: int = EXIT
    handlers: tuple[
        tuple[Handled, int], ...
    ] = ()  # (what a handler catches, its first statement), inner ones first
    # the loops around the statement, inner ones first, up to the first `while` with a condition
    around: tuple[ir.Loop, ...] = ()

    def inside(self, loop: ir.Loop, follow: int) -> _Exits:
        """Return the targets of jumps in the body of a loop."""
        return _Exits(
            follow, loop.id, self.handlers, (loop,) if _has_condition(loop) else (loop, *self.around)
        )

    def of(self, name: str, types: ExceptionTypes) -> list[int]:
        """Return where an exception may continue: at handlers, or outside the function."""
        targets: list[int] = []
        for handled, entry in self.handlers:
            caught = types.catches(handled, name)
            if caught is not False:
                targets.append(entry)
            if caught:
                return targets
        return [*targets, EXIT]


def control_dependence(
    body: Sequence[ir.Stmt],
    raising: Raising = NOTHING_RAISES,
    types: ExceptionTypes = NO_CLASSES,
    *,
    waits: bool = False,
) -> Control:
    """Return the control dependence of a function's statements. `raising` maps statements to exceptions of calls.

    With `waits`, statements after a `while` depend on its condition.
    """
    return _dependence(body, _Graph(raising=raising, types=types, waits=waits))


def _dependence(body: Sequence[ir.Stmt], graph: _Graph) -> Control:
    entry = _built(graph, body)
    return _control(graph, entry, _after_waits(graph, body) if graph.waiting else NOTHING)


def _built(graph: _Graph, body: Sequence[ir.Stmt]) -> int:
    """Add the body of a function or loop to a graph; return the number of its first statement."""
    if graph.end != EXIT:
        graph.link(graph.end, "", EXIT)
    return _block(graph, body, graph.end, _Exits(on_continue=graph.end))


def _after_waits(graph: _Graph, body: Sequence[ir.Stmt]) -> dict[int, set[Branch]]:
    """Return the branches of statements that wait in loops, with the statements that depend on them.

    These are the rest of the iteration of each loop around the statement, up to the first `while` with a condition,
    and the rest of the body without such a `while`. An earlier iteration does not decide a later one.
    """
    found: dict[int, set[Branch]] = {}
    loops = {loop.id: loop for around in graph.waiting.values() for loop in around}
    for loop in (*loops.values(), None):
        waiting = {
            n: around for n, around in graph.waiting.items() if loop in (around if loop else _last(around))
        }
        if not waiting:
            continue
        end = graph.end if loop is None else NEXT
        part = _Graph(raising=graph.raising, types=graph.types, end=end, ending=frozenset(waiting))
        order = _reachable(part, [_built(part, body if loop is None else loop.body)])
        closure = _closure(_direct(part, order, postdominators(part.edges, order)))
        for number, around in waiting.items():
            inner = (
                around[-1] if loop is None else around[around.index(loop) - 1] if loop in around[1:] else None
            )
            within = (
                {s.id for s in every_statement(inner.body)} | {inner.id} if inner is not None else set[int]()
            )
            for statement in closure.keys() - within:
                ours = {branch for branch in closure[statement] if branch[0] == number}
                if ours and statement != NEXT:
                    found.setdefault(statement, set()).update(ours)
    return found


def _last(around: Sequence[ir.Loop]) -> tuple[None, ...]:
    """Return (None,), which stands for the body itself, if no loop with a condition is among the given ones."""
    return () if _has_condition(around[-1]) else (None,)


def _has_condition(loop: ir.Loop) -> bool:
    """Return whether a loop is a `while` with a condition; what follows it does not depend on what it waits for."""
    return loop.target is None and not loop.endless


def _iteration(loop: ir.Loop, raising: Raising, types: ExceptionTypes) -> Iteration:
    control = _dependence(loop.body, _Graph(raising=raising, types=types, end=NEXT))
    return Iteration(control.direct, control.closure, control.always, control.closure.get(NEXT, frozenset()))


def _control(graph: _Graph, entry: int, after: Mapping[int, Set[Branch]] = NOTHING) -> Control:
    order = _reachable(graph, [entry, *(begin for _, begin in graph.finals)])
    if not after and not graph.finals and all(len(graph.edges[n]) < 2 for n in order):
        nothing = dict.fromkeys(order, frozenset[Branch]())
        return Control(
            nothing, nothing, frozenset(), frozenset(order), graph.statements, graph.raising, graph.types
        )
    nearest = postdominators(graph.edges, order)
    direct = _direct(graph, order, nearest)
    for number, branches in after.items():
        if number in direct:
            direct[number] |= branches
    for attempt, _ in reversed(graph.finals):
        _run_anyway(attempt, direct)
    always = frozenset(passed(entry, EXIT, nearest))
    for attempt, begin in reversed(graph.finals):
        if attempt.id in always:
            ours = {s.id for s in attempt.final}
            always |= ours & {*passed(begin, EXIT, nearest)}
    closed = _closure(direct)
    far = frozenset(n for n, branches in closed.items() if len(branches) >= NEAR)
    kept = frozenset(number for number, around in graph.waiting.items() if not _last(around))
    return Control(direct, closed, far, always, graph.statements, graph.raising, graph.types, kept)


def _block(graph: _Graph, body: Sequence[ir.Stmt], follow: int, exits: _Exits) -> int:
    """Add the statements of a block to the graph, the last one first; return the number of the block's first one."""
    for statement in reversed(body):
        follow = _statement(graph, statement, follow, exits)
    return follow


def _statement(graph: _Graph, s: ir.Stmt, follow: int, exits: _Exits) -> int:
    graph.statements[s.id] = s
    if isinstance(s, ir.If):
        graph.link(s.id, "then", _block(graph, s.body, follow, exits))
        graph.link(s.id, "else", _block(graph, s.orelse, follow, exits))
    elif isinstance(s, ir.Loop):
        graph.link(s.id, "body", _block(graph, s.body, s.id, exits.inside(s, follow)))
        if not s.endless:
            graph.link(s.id, "done", _block(graph, s.orelse, follow, exits))
            if graph.waits and s.target is None:
                graph.link(s.id, "never", EXIT)
        elif graph.waits or not _breaks(s.body):
            graph.link(s.id, "never", EXIT)  # also needed so that every statement reaches the exit
    elif isinstance(s, ir.Try):
        return _try(graph, s, follow, exits)
    elif isinstance(s, ir.With):
        graph.link(s.id, "", _block(graph, s.body, follow, exits))
    elif isinstance(s, ir.Return):
        graph.link(s.id, "", EXIT)
    elif isinstance(s, ir.Raise):
        graph.throw(s.id, "", raised(s.value), exits)
    elif isinstance(s, ir.Jump):
        graph.link(s.id, "", exits.on_break if s.kind == "break" else exits.on_continue)
    else:
        graph.link(s.id, "", follow)
    for name in graph.raising.get(s.id, ()):
        _raising(graph, s, name, exits)
    return s.id


def _raising(graph: _Graph, s: ir.Stmt, name: str, exits: _Exits) -> None:
    if name == BLOCKED and exits.around and not graph.waits:
        graph.waiting[s.id] = exits.around
        if s.id in graph.ending:
            graph.link(s.id, "waits", graph.end)
    elif name == BLOCKED:
        graph.link(s.id, "waits", EXIT if graph.waits else graph.end)
    elif name == SUSPENDED:
        graph.link(s.id, "waits", EXIT)
    else:
        graph.throw(s.id, f"raises {name}", name, exits)


def _try(graph: _Graph, s: ir.Try, follow: int, exits: _Exits) -> int:
    """Add a `try`; the `try` statement represents the unknown choice of a handler. Return its number."""
    after = _block(graph, s.final, follow, exits)
    handlers = [_block(graph, body, after, exits) for _, _, body in s.handlers]
    own = tuple((handled_by(types), entry) for (types, _, _), entry in zip(s.handlers, handlers, strict=True))
    inner = replace(exits, handlers=(*own, *exits.handlers))
    orelse = _block(graph, s.orelse, after, exits)
    graph.link(s.id, "body", _block(graph, s.body, orelse, inner))
    if s.final:
        graph.finals.append((s, after))
    for number, handler in enumerate(handlers):
        graph.link(s.id, f"except {number}", handler)
    return s.id


def _run_anyway(attempt: ir.Try, direct: dict[int, frozenset[Branch]]) -> None:
    """Remove the dependence of a `finally` on branches inside its `try`, since a `finally` always runs.

    Statements after the `finally` that depend on a branch in it still depend on the branches inside the `try`.
    """
    blocks = [attempt.body, attempt.orelse, *(body for _, _, body in attempt.handlers)]
    inside = {s.id for block in blocks for s in every_statement(block)}
    inside.add(attempt.id)
    around = direct.get(attempt.id, frozenset())
    removed: dict[int, frozenset[Branch]] = {}
    final = {s.id for s in every_statement(attempt.final)}
    for statement in every_statement(attempt.final):
        branches = direct.get(statement.id, frozenset())
        kept = frozenset(branch for branch in branches if branch[0] not in inside)
        if kept != branches:
            removed[statement.id] = branches - kept
        direct[statement.id] = kept | around if statement in attempt.final or kept != branches else kept
    for number in direct.keys() - final if removed else ():
        lost = [removed[branch[0]] for branch in direct[number] if branch[0] in removed]
        direct[number] = direct[number].union(*lost)


def every_statement(body: Sequence[ir.Stmt]) -> Iterator[ir.Stmt]:
    """Yield statements and those inside them."""
    for s in body:
        yield s
        for inner in (*_bodies(s), *_loop_bodies(s)):
            yield from every_statement(inner)


def _breaks(body: Sequence[ir.Stmt]) -> bool:
    """Return whether a loop's body can leave the loop."""
    for s in body:
        if isinstance(s, (ir.Return, ir.Raise)) or (isinstance(s, ir.Jump) and s.kind == "break"):
            return True
        if isinstance(s, ir.Loop):
            if _returns(s.body):
                return True
        elif any(_breaks(b) for b in _bodies(s)):
            return True
    return False


def leaving(body: Sequence[ir.Stmt]) -> Iterator[ir.Stmt]:
    """Yield the statements that leave a loop: `break` of the loop itself, and each `return`."""
    for s in body:
        if isinstance(s, ir.Return) or (isinstance(s, ir.Jump) and s.kind == "break"):
            yield s
        elif isinstance(s, ir.Loop):
            yield from (one for one in every_statement(s.body) if isinstance(one, ir.Return))
        for inner in _bodies(s):
            yield from leaving(inner)


def _returns(body: Sequence[ir.Stmt]) -> bool:
    return any(
        isinstance(s, (ir.Return, ir.Raise)) or any(_returns(b) for b in (*_bodies(s), *_loop_bodies(s)))
        for s in body
    )


def _loop_bodies(s: ir.Stmt) -> tuple[Sequence[ir.Stmt], ...]:
    return (s.body, s.orelse) if isinstance(s, ir.Loop) else ()


def _bodies(s: ir.Stmt) -> tuple[Sequence[ir.Stmt], ...]:
    """Return the blocks inside a statement that is not a loop."""
    if isinstance(s, ir.If):
        return (s.body, s.orelse)
    if isinstance(s, ir.With):
        return (s.body,)
    if isinstance(s, ir.Try):
        return (s.body, s.orelse, s.final, *(body for _, _, body in s.handlers))
    return ()


def _reachable(graph: _Graph, entries: Sequence[int]) -> list[int]:
    """Return the statements reachable from the entries in reverse depth-first order."""
    seen: dict[int, None] = {}
    pending = [*reversed(entries)]
    while pending:
        node = pending.pop()
        if node != EXIT and node not in seen:
            seen[node] = None
            pending.extend(graph.edges.get(node, {}).values())
    return list(seen)


def _direct(graph: _Graph, order: Sequence[int], nearest: Mapping[int, int]) -> dict[int, frozenset[Branch]]:
    """Return the direct control dependence.

    Statement n depends on branch (a, b) if n is on every path from b to the exit, but not on every path from a.
    """
    found: dict[int, set[Branch]] = {n: set() for n in order}
    for node in order:
        ways = graph.edges[node]
        if len(ways) < 2:
            continue
        for way, target in ways.items():
            for dependent in passed(target, nearest[node], nearest):
                found[dependent].add((node, way))
    return {n: frozenset(branches) for n, branches in found.items()}


def _closure(direct: Mapping[int, frozenset[Branch]]) -> dict[int, frozenset[Branch]]:
    """Return all branches on which each statement depends; if there are very many, only the nearest ones."""
    closed: dict[int, frozenset[Branch]] = {}
    for node, branches in direct.items():
        found = dict.fromkeys(sorted(branches))
        pending = deque(found)
        while pending and len(found) < NEAR:
            for branch in sorted(direct.get(pending.popleft()[0], ())):
                if branch not in found:
                    found[branch] = None
                    pending.append(branch)
        closed[node] = frozenset(found)
    return closed
