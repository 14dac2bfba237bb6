"""Replay calls: skip a call whose reads are all unchanged since its last run in the same context.

Because the context is the same, the call's nodes, objects and entry points exist already, and only the stores of
the call are repeated. `memory/reads.py` records the reads.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from tarl_lint.interpret import worklist
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.memory.frames import Escape, Frame, Origin
from tarl_lint.memory.reads import Reads
from tarl_lint.memory.same_reads import unchanged
from tarl_lint.memory.store import Delta, Store
from tarl_lint.memory.value_flow_graph import MAX_EDGES
from tarl_lint.memory.values import ABSENT, Key, Value, join, join_all

READS = 40  # this number of compared facts counts as one statement of work

Mode = tuple[object, ...]


@dataclass(slots=True, eq=False)
class Run:
    """A run of a function in a call context: arguments, objects around them, reads, results."""

    passed: Arguments
    parts: tuple[Origin, ...]
    mode: Mode
    reads: Reads
    found: dict[Key, Value | None]  # key → value that the run read; None if no value was set
    stored: dict[Key, bool]
    cost: int
    result: Value
    returned: list[Value]
    escapes: list[Escape]
    blocked: dict[int, None]  # decisions of calls that may wait for ever
    thrown: Delta | None  # stores before an exception leaves the function
    delta: Delta
    edges: int  # number of edges that the run made
    noted: bool  # whether the stores in `delta` have already been applied to the state, one by one
    heard: dict[Key, Value]  # key → value that other roots may have stored when the run waited


def run(
    ctx: Interpreter, frame: Frame, passed: Arguments, parts: tuple[Origin, ...], execute: Callable[[], Delta]
) -> Run:
    """Return a frame's last run if a new one would give the same; otherwise execute the frame."""
    mode = _mode(ctx)
    last = frame.recorded
    same = isinstance(last, Run) and last.parts == parts and _same(ctx, last, passed, mode)
    if isinstance(last, Run) and same and not ctx.checking:
        ctx.work.spent += last.cost
        ctx.work.saved += last.cost - len(last.found) // READS
        if last.reads.waits:
            _wait_again(ctx, last.reads)
        ctx.store.reads.add(last.reads)
        frame.escapes, frame.thrown = list(last.escapes), last.thrown
        return last
    made = _executed(ctx, frame, passed, parts, mode, execute)
    if isinstance(last, Run) and same and made.reads.whole:
        _check(ctx, frame, last, made)
    frame.recorded = made if made.reads.whole and ctx.probe is None and ctx.watch is None else None
    return made


def _executed(
    ctx: Interpreter,
    frame: Frame,
    passed: Arguments,
    parts: tuple[Origin, ...],
    mode: Mode,
    execute: Callable[[], Delta],
) -> Run:
    outer = ctx.store.reads
    reads = ctx.store.reads = ctx.graph.reads = Reads()
    before, edges = ctx.work.spent, ctx.graph.edges
    delta = execute()
    store = ctx.store
    store.reads = ctx.graph.reads = outer
    outer.add(reads)
    returned = [value for _, value in frame.returns]
    if reads.waits:  # reads after a wait may include values of other roots
        reads.stored |= reads.keys
    found, stored = store.found_by(reads)
    ctx.work.handled += len(found) + len(reads.objects)
    reads.finish(found.keys(), stored.keys())
    # the states of memory are left out, because `delta` contains them
    frame.returns = [({}, value) for value in returned]
    return Run(
        passed, parts, mode, reads, found, stored, ctx.work.spent - before,
        join_all(returned), returned, list(frame.escapes), dict(frame.blocked), frame.thrown, delta,
        ctx.graph.edges - edges, len(returned) == 1, store.heard() if reads.waits else {},
    )  # fmt: skip


def _hears(store: Store, last: Run) -> bool:
    """Return whether other roots may still store the values that they could store during the last run of the call."""
    heard = store.heard()
    if last.heard is not heard and last.heard == heard:
        last.heard = heard
    return last.heard is heard and last.reads.heard == len(heard)


def _check(ctx: Interpreter, frame: Frame, last: Run, made: Run) -> None:
    """Compare a run with the run that would have been replayed; raise AssertionError if they differ."""
    keys = last.delta.keys() | made.delta.keys()
    wrong = {key for key in keys if _left(ctx, last, key) != _left(ctx, made, key)}
    raised = _raised(last), _raised(made)
    if wrong or last.result != made.result or raised[0] != raised[1] or made.edges:
        what = [(key, last.delta.get(key), made.delta.get(key)) for key in sorted(wrong, key=str)]
        results = f"{last.result} or {made.result}, {raised[0]} or {raised[1]}"
        raise AssertionError(f"{frame}: {what}, {results}, {made.edges} new edges")


def _raised(run: Run) -> dict[tuple[int, str], Value]:
    """Return the values of the exceptions that leave a function, by statement and name.

    A loop raises an exception once in each pass, and a later run needs fewer passes.
    """
    values: dict[tuple[int, str], Value] = {}
    for escape in run.escapes:
        key = escape.statement.id, escape.name
        values[key] = join(values.get(key, escape.value), escape.value)
    return values


def _left(ctx: Interpreter, run: Run, key: Key) -> Value | None:
    """Return a key's value after a run; clearing a field that was unset makes no difference."""
    value = run.delta.get(key)
    return None if value is ABSENT and ctx.store.peek(key) is None else value


def _wait_again(ctx: Interpreter, reads: Reads) -> None:
    """Repeat a replayed call's wait: publish the earlier stores that it did not overwrite."""
    worklist.show(ctx, reads.own)
    for key, value in reads.admitted.items():
        ctx.store.take(key, value)


def _mode(ctx: Interpreter) -> Mode:
    """Return the global facts on which all calls depend."""
    graph = ctx.graph
    return (
        ctx.store.waited,
        ctx.shared.edition,
        graph.edges >= MAX_EDGES,
        ctx.probe,
        ctx.watch,
    )


def _same(ctx: Interpreter, last: Run, passed: Arguments, mode: Mode) -> bool:
    """Return whether all reads of a run are unchanged."""
    if last.mode != mode or last.passed != passed:
        return False
    if ctx.work.call_limit is not None and ctx.work.spent + last.cost > ctx.work.call_limit:
        return False
    reads, store = last.reads, ctx.store
    if reads.waits and not _hears(store, last):
        return False
    ctx.work.handled += len(last.found)
    return unchanged(reads, last.found, last.stored, store, ctx.graph)
