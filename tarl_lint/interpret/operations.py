"""What lower parts of the interpreter ask of higher ones: the calls that go up, wired in `wiring.py`."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import Protocol, TypeVar

from tarl_lint.interpret.invocation import Arguments, Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.store import Root
from tarl_lint.memory.values import (
    NONE,
    Consts,
    Nodes,
    Obj,
    Value,
)
from tarl_lint.models.ros.endpoints import Publisher

Ctx = TypeVar("Ctx", contravariant=True)


class Operations(Protocol[Ctx]):
    """The operations, on an interpreter of type `Ctx`."""

    def fill(self, ctx: Ctx, obj: Obj, cls: Obj, arguments: Arguments, frame: Frame, call: ir.Call) -> None:
        """Store the arguments as a dataclass or named tuple does."""
        ...

    def add_root(self, ctx: Ctx, root: Root, run: Callable[[Root], None], *, news: bool = False) -> None:
        """Have something run on its own; seen again, only if its arguments are news."""
        ...

    def assign(self, ctx: Ctx, target: ir.Expr, value: Value, frame: Frame) -> None:
        """Store into a target."""
        ...

    def assign_fallback(self, ctx: Ctx, expr: ir.Expr, value: Value, frame: Frame) -> None:
        """Add data to the variable that holds an object of which nothing is known."""
        ...

    def bind_target(
        self, ctx: Ctx, target: ir.Expr, value: Value, frame: Frame, slot: str, source: ir.Expr
    ) -> None:
        """Let a value pass through the statement into a target, element by element."""
        ...

    def block(self, ctx: Ctx, body: Sequence[ir.Stmt], frame: Frame) -> bool:
        """Execute statements in order."""
        ...

    def call(self, ctx: Ctx, expr: ir.Call, frame: Frame) -> Value:
        """Evaluate a call expression."""
        ...

    def call_later(self, ctx: Ctx, target: Obj, values: Sequence[Value]) -> None:
        """Have a function run on its own; of other arguments than these nothing is known."""
        ...

    def call_library(
        self, ctx: Ctx, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:
        """Call a function or class of a library; those that go over objects of ours ask these for iterators."""
        ...

    def call_method(
        self,
        ctx: Ctx,
        base: Value,
        target: Obj | None,
        name: str,
        arguments: Arguments,
        frame: Frame,
        call: ir.Call,
    ) -> Value:
        """Call a method of an object that is not a class of ours."""
        ...

    def call_object(
        self, ctx: Ctx, target: Obj, arguments: Arguments, frame: Frame, call: ir.Call, carriers: Nodes = NONE
    ) -> Value:
        """Call one object; a method's receiver is what `carriers` handed on, which may have been chosen by data."""
        ...

    def call_value(
        self, ctx: Ctx, function: Value, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:
        """Call whatever a value may be; what is not known passes its arguments on."""
        ...

    def deep(self, ctx: Ctx, objects: frozenset[Obj]) -> Nodes:
        """Return all nodes whose data is inside objects, as long as nothing is stored the same as before."""
        ...

    def default(self, ctx: Ctx, obj: Obj, name: str) -> Value:
        """Return a field to which nothing was stored; of a package, its modules."""
        ...

    def entries(self, ctx: Ctx, obj: Obj, value: Value) -> None:
        """Take over the entries of a mapping, or of a sequence of pairs."""
        ...

    def escaped(self, ctx: Ctx, frame: Frame, caller: Frame) -> None:
        """Let what comes after a call depend on whether the called function raises, when somebody takes that."""
        ...

    def evaluate(self, ctx: Ctx, expr: ir.Expr, frame: Frame) -> Value:
        """Return what an expression may be."""
        ...

    def gate(self, ctx: Ctx, decides: Nodes, frame: Frame, slot: Hashable) -> Nodes:
        """Return the node of a decision which elements a new container gets, none where no data decides."""
        ...

    def generic(self, ctx: Ctx, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Pass the arguments on to the result; write the argument that the catalog says is written."""
        ...

    def holder(self, expr: ir.Name, frame: Frame) -> Obj:
        """Return the object that holds a variable: an activation, a class being made, a module."""
        ...

    def imported(self, ctx: Ctx, module: str, member: str | None, importer: object) -> Value:
        """Return what an import binds: a module of ours, a name in one, or something of a library."""
        ...

    def may_fail(self, ctx: Ctx, deps: Nodes, raises: str, frame: Frame, *, named: bool = False) -> None:
        """Let what comes after a statement depend on whether a library can do with what it is given."""
        ...

    def missing(self, ctx: Ctx, mapping: Obj, name: str) -> Value:
        """Return what a mapping with a default makes for a key that it does not have."""
        ...

    def named_by_settings(self, ctx: Ctx, target: Obj) -> str:
        """Return the qualified name of a function or method of ours that the settings speak of, else ""."""
        ...

    def read_item(self, ctx: Ctx, base: Value, index: Value) -> Value:
        """Return an element; a tainted index taints it."""
        ...

    def register_filter(self, ctx: Ctx, target: Obj | None, it: Invocation) -> Value:
        """Run a callback with one message of each subscriber."""
        ...

    def remainder(self, ctx: Ctx, values: list[Value]) -> Consts:
        """Return `text % values` where all is known."""
        ...

    def root_frame(self, ctx: Ctx, root: Root) -> Frame:
        """Return the frame that stands for ROS itself, calling."""
        ...

    def ros_call(self, ctx: Ctx, it: Invocation) -> Value:
        """Do what the catalog says about a call."""
        ...

    def run(self, ctx: Ctx, frame: Frame) -> Value:
        """Execute a frame's body and return its result."""
        ...

    def send(self, ctx: Ctx, it: Invocation, info: Publisher) -> Value:
        """Record a sink: everything inside the message reaches it, and whether it is reached at all."""
        ...

    def serve(self, ctx: Ctx, target: Obj, it: Invocation) -> Value:
        """Call a method of an action server or of a goal's handle."""
        ...

    def unpacked(self, ctx: Ctx, value: Value) -> list[Value] | None:
        """Return the elements of a sequence whose elements are known one by one."""
        ...

    def wait(self, ctx: Ctx, frame: Frame) -> None:
        """Let other roots see what was stored, and store what they may."""
        ...
