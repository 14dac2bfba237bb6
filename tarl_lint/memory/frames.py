"""Frames of function calls, and exceptions that leave them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final, Literal

from tarl_lint.ir import nodes as ir
from tarl_lint.ir.exception_types import ExceptionTypes, Handled
from tarl_lint.memory.values import BOTTOM, Branches, Key, Obj, Value

# narrowed variables, with their values before and after the narrowing
Former = list[tuple[Key, Value, Value]]
Turns = tuple[tuple[ir.Loop, int], ...]  # loops, outer ones first, with the number of the current iteration


@dataclass(slots=True, eq=False)
class Attempt:
    """A running `try` or `with`: what it handles, the states in which a handler can be entered, and the exceptions.

    `final` is set if no exception, `return`, `break` or `continue` can leave the `try` without its `finally`. In
    this case, `leaving` collects everything that has to continue after the `finally`.
    """

    depth: int
    states: list[dict[Key, Value]]
    handlers: tuple[Handled, ...] = ()
    raised: dict[str, Value] = field(default_factory=dict)  # value of each exception, by its name
    final: bool = False
    leaving: list[Leaving] = field(default_factory=list)
    passed: list[Escape] = field(default_factory=list)  # exceptions that may leave the body of a `with`

    def catches(self, name: str, types: ExceptionTypes) -> bool | None:
        """Return whether one of the handlers catches an exception: True, False, or None for maybe."""
        answers = [types.catches(handled, name) for handled in self.handlers]
        return True if True in answers else None if None in answers else False

    def names(self, name: str, types: ExceptionTypes) -> bool:
        """Return whether a handler catches a builtin exception, by its or a base class's name."""
        return any(types.names(handled, name) for handled in self.handlers)

    def caught(self, handled: Handled, types: ExceptionTypes) -> dict[str, Value]:
        """Return the exceptions that one of the handlers may catch, by their names."""
        return {n: v for n, v in self.raised.items() if types.catches(handled, n) is not False}


@dataclass(slots=True, eq=False)
class Escape:
    """An exception that leaves a function: its place, name, value, and the raising call's decision.

    `state` has the stores of the function before the exception.
    """

    frame: Frame
    statement: ir.Stmt
    name: str
    value: Value
    decision: int | None = None
    state: dict[Key, Value] = field(default_factory=dict)


@dataclass(slots=True, eq=False)
class Leaving:
    """Something that leaves a `try` with a `finally`, and the state there.

    It is an exception, the value of a `return`, or a jump.
    """

    state: dict[Key, Value]
    cause: Escape | Value | Literal["break", "continue"]


# in place of an index: the value is the rest of the elements, a sequence whose `info` is the object with all elements
REST: Final = "<rest>"


@dataclass(frozen=True, slots=True, eq=False)
class Taken:
    """A variable value's origin: the statement, and the objects that it may be or be a part of.

    `field` is the attribute or index of the part, or REST; `of` is the variable that holds the objects.
    """

    value: Value
    before: Value  # the objects, before the statement
    statement: ir.Stmt
    slot: str
    field: str | Value | None = None
    of: Key | None = None
    frame: Frame | None = None  # the caller that passed the value, if the variable is a parameter


Spared = frozenset[tuple[int, bool]]


@dataclass(frozen=True, slots=True, eq=False)
class Settled:
    """Objects for which the test of an `if` has a known result.

    The test decides nothing for these objects, and a branch does not run for them. `spared` has the number of the
    `if` with False, and those of the statements in the branch with True.
    """

    value: Value  # the value of the tested variable
    objects: frozenset[Obj]
    spared: Spared


# an argument that is one of several objects, or a part of one of them. The tuple has the argument's position or
# keyword, the objects, and the attribute or index of the part.
Origin = tuple[int | str, Value, str | Value | None]


def inside(statement: ir.Stmt | None, turns: Turns) -> Turns:
    """Return the loops in which a statement is. A loop counts as inside itself, since it binds its target."""
    if not turns or statement is None:
        return ()
    return tuple(turn for turn in turns if turn[0].has(statement.id))


class Frame(Obj):
    """A frame, identified by its chain of calls. The fields of a frame are the local variables."""

    __slots__ = (
        "answer",
        "arguments",
        "base",
        "blocked",
        "call",
        "call_pos",
        "called_in",
        "caller",
        "captured",
        "closures",
        "cls",
        "control",
        "depth_of_layers",
        "entered",
        "escapes",
        "function",
        "guards",
        "handling",
        "heads",
        "id",
        "jumps",
        "module",
        "outer",
        "owner",
        "passed",
        "pauses",
        "program",
        "recorded",
        "result",
        "returns",
        "root_waits",
        "rows",
        "settled",
        "shared",
        "slot",
        "spared",
        "spread",
        "statement",
        "steps",
        "taken",
        "thrown",
        "told_apart",
        "tries",
        "turn",
        "turns",
        "waypoints",
        "yielded",
    )  # fmt: skip

    def __init__(
        self, key: object, number: int, function: ir.Function, program: ir.Program, module: Obj
    ) -> None:
        super().__init__("frame", key, function.name)
        self.id = number
        self.function = function
        self.program = program
        self.module = module
        self.caller: Frame | None = None
        self.call: ir.Stmt | None = None
        self.call_pos: ir.Pos | None = None
        self.slot: object = 0
        self.turn: tuple[
            int, ...
        ] = ()  # numbers of the current elements of unrolled loops and comprehensions
        # current iterations of those unrolled loops in which an iteration decides about later iterations
        self.turns: Turns = ()
        self.called_in: Turns = ()  # the `turns` of the caller at the call
        self.rows = 1  # number of iterations of the unrolled loops around the current statement
        # statements executed exactly once in each iteration of an unrolled loop
        self.steps: frozenset[ir.Stmt] = frozenset()
        self.answer: object = None  # the object that receives the function's result if ROS calls the function
        self.guards: Branches = frozenset()  # decisions inside the calling expression
        self.settled: dict[Key, list[Settled]] = {}  # variable → results of tests since its last assignment
        self.spared: Spared | None = (
            None  # what decides no call of the function for its receiver; None before a call
        )
        self.outer: Frame | None = None
        self.owner: Obj | None = None  # the class that defines the method, for super()
        self.cls: Obj | None = None  # the class under construction, if this is a class body
        self.base: Branches = frozenset()
        self.statement: ir.Stmt | None = None
        self.closures: dict[tuple[int, Turns], Branches] = {}
        self.control: object = None
        # numbers of the conditions that are connected with the current `control` in the graph
        self.waypoints: set[tuple[int, Turns]] = set()
        # the caller's control dependence, after it has been connected with this call
        self.entered: object = None
        self.heads: dict[
            tuple[int, ...], dict[Key, Value]
        ] = {}  # loop and iterations of its outer loops → state at the loop's head in the last fixpoint of the loop
        self.captured = False
        self.told_apart: set[tuple[int, str]] = set()  # branches that have conditions of their own
        # variable → origins of those of its values that are one of several objects or a part of one of these
        self.taken: dict[Key, list[Taken]] = {}
        # slot of a call with an argument `*sequence` → the sequences that the argument may be
        self.spread: dict[int, Value] = {}
        self.returns: list[tuple[dict[Key, Value], Value]] = []
        self.jumps: list[tuple[int, dict[str, list[dict[Key, Value]]]]] = []
        self.handling: list[dict[str, Value]] = []  # exceptions of the handlers that are running, by name
        self.depth_of_layers = 0
        # whether callbacks run concurrently, so that values can change in every loop iteration
        self.root_waits = False
        self.tries: list[Attempt] = []
        self.escapes: list[Escape] = []
        self.blocked: dict[int, None] = {}  # decisions of the calls that may wait for ever
        # stores of the function before an exception leaves it; None if no exception does
        self.thrown: dict[Key, Value] | None = None
        self.result = BOTTOM
        self.recorded: object = None  # the last run of this frame, which a call with equal inputs can replay
        self.shared = False  # whether calls from several places share this frame, with joined arguments
        # arguments of all calls that share this frame, joined
        self.passed: tuple[list[Value], dict[str, Value]] | None = None
        self.yielded = BOTTOM
        # `yield` → stores of the generator when it last paused there
        self.pauses: dict[tuple[int, int, int, int], dict[Key, Value]] = {}
        self.arguments: list[Value] = []

    def release(self) -> None:
        """Drop references, to break reference cycles."""
        super().release()
        self.returns, self.jumps, self.tries, self.escapes, self.arguments = [], [], [], [], []
        self.recorded = self.passed = self.thrown = None
        self.heads.clear()
        self.pauses.clear()
        self.taken.clear()
        self.settled.clear()
        self.spread.clear()

    def owner_class(self) -> Obj | None:
        """Return the class whose body this is; None for functions."""
        return self.cls
