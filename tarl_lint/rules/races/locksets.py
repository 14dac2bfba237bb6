"""Locksets: the locks held at each access to shared state, along the chain of calls."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from tarl_lint.evidence import Evidence
from tarl_lint.ir.nodes import Pos
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import Obj
from tarl_lint.rules.races.accesses import Access, How, accesses
from tarl_lint.rules.races.function_threads import EXECUTOR, MAIN, Threads
from tarl_lint.rules.races.held_locks import asked_before, in_loop, locks_around, tried_around
from tarl_lint.trees import last_name

MADE: Final = re.compile(r"\b(R?Lock|Condition|(Bounded)?Semaphore)\(")
RUNS_COROUTINES: Final = frozenset(["run", "run_until_complete"])
State = tuple[object, str]  # (object, name of an attribute) or (module, name of a global)


@dataclass(frozen=True)
class Spot:
    """An access, or a call that leads to it: its place, its function, and the locks held there.

    `tried` contains the locks that the function takes only if they are free. `asked` has entries only if this
    access decides on nothing but an early return: the locks that the function takes later.
    """

    path: str
    pos: Pos
    function: str
    locks: frozenset[str] = frozenset()
    tried: frozenset[str] = frozenset()
    asked: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Use:
    """One access to shared state in one thread: the access first, then the calls that lead to it.

    `name` is as in the source (`self.pose`, `pose`). `constant` means that the access stores a constant, for
    example in a flag.
    """

    name: str
    spots: tuple[Spot, ...]
    thread: object
    writes: bool
    constant: bool = False
    how: How = "reads"

    @property
    def locks(self) -> frozenset[str]:
        """Return the locks held at the access."""
        return self.spots[0].locks

    @property
    def guards(self) -> frozenset[str]:
        """Return the locks that another access to the same state is also expected to take."""
        return self.locks - self.spots[0].tried


class Locking:
    """Collects the accesses to attributes and globals in modules that create locks."""

    def __init__(self, evidence: Evidence) -> None:
        self.evidence = evidence
        modules = evidence.machine.modules.values()
        self.paths = {m.path for m in modules if m.matches(MADE) or m.contains("with self.")}
        self.active = any(m.matches(MADE) for m in modules)
        self._accesses: dict[tuple[str, Pos], list[Access]] = {}

    def uses(self) -> dict[State, list[Use]]:
        """Return all accesses by state, without those during construction of the object."""
        found: dict[State, dict[Use, None]] = {}
        if not self.active:
            return {}
        threads = Threads(self.evidence)
        for frame in list(self.evidence.machine.frames.values()):
            written = self.accesses(frame) if frame.program.path in self.paths else []
            thread = threads.of(frame) if written else None
            if thread is None or self._scheduled(frame):
                continue
            callers, repeated = self._callers(frame)
            receiver = _receiver(frame)
            for access in written:
                state = _state(access, frame, receiver)
                if state is None:
                    continue
                if thread in (MAIN, EXECUTOR) and _top(frame) and not (repeated or access.repeated):
                    # the main program may make this access before the threads start
                    continue
                use = self._use(access, frame, thread, callers)
                found.setdefault(state, {})[use] = None
        return {state: list(uses) for state, uses in found.items()}

    def _use(self, access: Access, frame: Frame, thread: object, callers: Sequence[Spot]) -> Use:
        node, path = access.node, frame.program.path
        pos = (node.lineno, node.col_offset, node.end_lineno or 0, node.end_col_offset or 0)
        outline = self.evidence.outline(path)
        above = callers[0].locks if callers else frozenset[str]()
        tried = tried_around(node, outline) | (callers[0].tried if callers else frozenset())
        spot = Spot(path, pos, frame.function.name, access.locks | above, tried, asked_before(node, outline))
        name = access.name if access.is_global else f"self.{access.name}"
        return Use(name, (spot, *callers), thread, access.writes, access.constant, access.how)

    def _callers(self, frame: Frame) -> tuple[list[Spot], bool]:
        """Return the calls that lead to a frame, nearest first, and whether one of these calls is in a loop."""
        spots: list[Spot] = []
        repeated = False
        current: Frame = frame
        while current.caller is not None and current.call is not None and current.call_pos is not None:
            path, pos, caller = current.caller.program.path, current.call_pos, current.caller
            outline = self.evidence.outline(path)
            call = outline.call(pos)
            spot = Spot(path, pos, caller.function.name)
            if call is not None:
                locks, tried = locks_around(call, outline), tried_around(call, outline)
                spot = replace(spot, locks=locks, tried=tried, asked=asked_before(call, outline))
                repeated |= in_loop(call, outline)
            spots.append(spot)
            current = caller
        for index in range(len(spots) - 2, -1, -1):
            spot, outer = spots[index], spots[index + 1]
            spots[index] = replace(spot, locks=spot.locks | outer.locks, tried=spot.tried | outer.tried)
        return spots, repeated

    def _scheduled(self, frame: Frame) -> bool:
        """Return whether the code is in a coroutine that an event loop runs later, without the locks of its caller."""
        current: Frame = frame
        while current.caller is not None and current.call_pos is not None:
            caller = current.caller
            if isinstance(current.function.node, ast.AsyncFunctionDef):
                outline = self.evidence.outline(caller.program.path)
                call = outline.call(current.call_pos)
                if call is not None and not runs_here(outline.parents.get(call)):
                    return True
            current = caller
        return False

    def accesses(self, frame: Frame) -> list[Access]:
        """Return the accesses in the source of a function."""
        key = (frame.program.path, frame.function.pos)
        known = self._accesses.get(key)
        if known is None:
            outline = self.evidence.outline(key[0])
            found = accesses(frame.function.node, _receiver_name(frame), outline, self.evidence.assigned)
            known = self._accesses[key] = list(found)
        return known


def unguarded(uses: Sequence[Use]) -> Iterator[tuple[Use, Spot]]:
    """Yield the accesses without a lock, each with the place where the lock is missing.

    This place is the access itself. If other calls reach the access with a lock, the place is the call that
    does not hold the lock.
    """
    held = {(s.path, s.pos) for use in uses for s in use.spots if s.locks}
    locks = frozenset(lock for use in uses for lock in use.locks)
    for use in uses:
        if use.locks:
            continue
        spot = next((s for s in use.spots if (s.path, s.pos) not in held), use.spots[-1])
        if use.writes or not spot.asked & locks:
            yield use, spot


def runs_here(outer: ast.AST | None) -> bool:
    """Return whether a coroutine runs in the place where the code creates it: `await it()`, `asyncio.run(it())`."""
    return isinstance(outer, ast.Await) or (
        isinstance(outer, ast.Call) and last_name(outer.func) in RUNS_COROUTINES
    )


class Harm:
    """Decides whether an access without a lock can go wrong while another thread accesses the state under the lock.

    Python replaces a reference atomically: if a value is never changed in place, a single read sees either the old
    or the new value. A store is lost only if another thread changes the value in place or relies on it across
    several accesses.
    """

    def __init__(self, uses: Mapping[State, Sequence[Use]]) -> None:
        # (state, function) → positions of the function's accesses to the state
        self._times: dict[object, set[Pos]] = {}
        self._read: dict[object, set[State]] = {}  # function → state that the function reads without a lock
        self._written: dict[object, set[State]] = {}  # function → state that the function writes under a lock
        self._locked: set[object] = set()  # (state, function) pairs with an access under a lock
        for state, every in uses.items():
            for use in every:
                if use.locks:
                    self._locked.add((state, *_by(use)[:3]))
                self._times.setdefault((state, *_by(use)), set()).add(use.spots[0].pos)
                if use.writes and use.locks:
                    self._written.setdefault(_by(use), set()).add(state)
                elif not use.writes and not use.locks:
                    self._read.setdefault(_by(use), set()).add(state)

    def between(self, state: State, use: Use, guarded: Use) -> bool:
        """Return whether `use`, which holds no lock, can go wrong while another thread performs `guarded`."""
        if use.how == "length":
            return False
        if use.writes:
            changed = guarded.how in ("adds", "inside") or (guarded.writes and self._relied_on(state, use))
            return use.how != "replaces" or changed or self._often(state, guarded)
        torn = self._read.get(_by(use), set()) & self._written.get(_by(guarded), set())
        return guarded.how == "inside" or self._often(state, use) or len(torn) > 1

    def _relied_on(self, state: State, use: Use) -> bool:
        """Return whether a function stores the state without a lock and also accesses it under the lock."""
        return (state, *_by(use)[:3]) in self._locked

    def _often(self, state: State, use: Use) -> bool:
        """Return whether a function accesses the same state several times."""
        return len(self._times[(state, *_by(use))]) > 1


def _by(use: Use) -> tuple[object, ...]:
    """Return the key of a function's accesses: its definition, its thread, the locks held."""
    return use.spots[0].path, use.spots[0].function, use.thread, use.locks


def _state(access: Access, frame: Frame, receiver: Obj | None) -> State | None:
    """Return the state that is accessed; None if it is under construction or unknown."""
    if access.is_global:
        return frame.module, access.name
    return None if receiver is None or _making(frame, receiver) else (receiver, access.name)


def _method(frame: Frame) -> Frame | None:
    """Return the method that is, or encloses, a function."""
    current: Frame | None = frame
    while current is not None and current.owner is None:
        current = current.outer
    return current


def _receiver(frame: Frame) -> Obj | None:
    """Return the receiver of the running method."""
    method = _method(frame)
    key = method.key if method is not None else None
    found = key[4] if isinstance(key, tuple) and len(key) == 5 else None
    if not isinstance(found, frozenset) or len(found) != 1:
        return None
    obj = next(iter(found))
    return obj if isinstance(obj, Obj) and obj.kind == "instance" else None


def _receiver_name(frame: Frame) -> str:
    method = _method(frame)
    parameters = method.function.parameters if method is not None else ()
    return parameters[0].name if parameters else ""


def _making(frame: Frame, receiver: Obj) -> bool:
    """Return whether the object is under construction; other threads cannot access it then."""
    current: Frame | None = frame
    while current is not None:
        if current.function.name == "__init__" and _receiver(current) is receiver:
            return True
        current = current.caller
    return False


def _top(frame: Frame) -> bool:
    """Return whether the main program reaches this code, rather than a callback."""
    top = frame
    while top.caller is not None:
        top = top.caller
    key = top.key
    if not isinstance(key, tuple):
        return False
    return key[0] == "module" or (isinstance(key[1], tuple) and key[1][0] in ("main", "node"))
