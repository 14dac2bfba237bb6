"""Activations of functions, and exceptions on their way out of them."""

from __future__ import annotations

from dataclasses import dataclass

from tarl_lint.ir import nodes as ir
from tarl_lint.memory.values import BOTTOM, Branches, Key, Obj, Value


@dataclass(slots=True, eq=False)
class Attempt:
    """A `try` whose body is being executed: states in which a handler can be entered, and what it is given."""

    depth: int
    states: list[dict[Key, Value]]
    handled: bool
    raised: Value
    takes: frozenset[str] = frozenset()  # names of the exceptions that are handled; none: any


@dataclass(slots=True, eq=False)
class Escape:
    """An exception that leaves a function: where, what, and the decision of the call that it comes from."""

    frame: Frame
    statement: ir.Stmt
    name: str
    value: Value
    decision: int | None = None


class Frame(Obj):
    """One activation of a function, known by its chain of calls. Its fields are the local variables."""

    __slots__ = (
        "answer",
        "arguments",
        "base",
        "call",
        "call_pos",
        "caller",
        "captured",
        "closures",
        "cls",
        "control",
        "depth_of_layers",
        "escapes",
        "function",
        "guards",
        "id",
        "jumps",
        "module",
        "outer",
        "owner",
        "passed",
        "program",
        "recorded",
        "result",
        "returns",
        "root_waits",
        "shared",
        "slot",
        "statement",
        "tries",
        "turn",
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
        self.turn: tuple[int, ...] = ()  # which element a comprehension is at, where these are told apart
        self.answer: object = None  # who gets what the function returns, when ROS asked for it
        self.guards: Branches = frozenset()  # decisions inside the calling expression
        self.outer: Frame | None = None
        self.owner: Obj | None = None  # the class a method is defined in, for super()
        self.cls: Obj | None = None  # the class that is being made, when this is a class body
        self.base: Branches = frozenset()
        self.statement: ir.Stmt | None = None
        self.closures: dict[int, Branches] = {}
        self.control: object = None
        self.captured = False
        self.returns: list[tuple[dict[Key, Value], Value]] = []
        self.jumps: list[tuple[int, dict[str, list[dict[Key, Value]]]]] = []
        self.depth_of_layers = 0
        self.root_waits = False  # runs beside callbacks: every turn of a loop may find news
        self.tries: list[Attempt] = []
        self.escapes: list[Escape] = []
        self.result = BOTTOM
        self.recorded: object = None  # the last run, to be replayed
        self.shared = False  # by calls from several places, whose arguments are joined
        self.passed: tuple[list[Value], dict[str, Value]] | None = (
            None  # arguments of all calls that share it
        )
        self.yielded = BOTTOM
        self.arguments: list[Value] = []

    def release(self) -> None:
        """Let go of what may lead back here."""
        super().release()
        self.returns, self.jumps, self.tries, self.escapes, self.arguments = [], [], [], [], []
        self.recorded = self.passed = None

    def owner_class(self) -> Obj | None:
        """Return the class whose body this is, None in functions."""
        return self.cls
