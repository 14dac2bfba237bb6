"""The interface through which lower parts of the interpreter call higher ones; assigned in `wiring.py`."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import Protocol, TypeVar

from tarl_lint.interpret.invocation import Arguments, Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Former, Frame, Origin
from tarl_lint.memory.shared import Root
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
        """Store the arguments in fields, as a dataclass or named tuple does."""
        ...

    def add_root(self, ctx: Ctx, root: Root, run: Callable[[Root], None], *, news: bool = False) -> None:
        """Queue a root; re-queue a known one only if its arguments changed."""
        ...

    def assign(self, ctx: Ctx, target: ir.Expr, value: Value, frame: Frame) -> None:
        """Store into a target."""
        ...

    def assign_fallback(self, ctx: Ctx, expr: ir.Expr, value: Value, frame: Frame) -> None:
        """Add data to the variable that holds an unknown object."""
        ...

    def bind_target(
        self, ctx: Ctx, target: ir.Expr, value: Value, frame: Frame, slot: str, source: ir.Expr
    ) -> None:
        """Bind a target to a value through a node of the statement, element by element."""
        ...

    def block(self, ctx: Ctx, body: Sequence[ir.Stmt], frame: Frame) -> bool:
        """Execute statements in order."""
        ...

    def call(self, ctx: Ctx, expr: ir.Call, frame: Frame) -> Value:
        """Evaluate a call expression."""
        ...

    def launched_call(self, ctx: Ctx, target: Obj | None, it: Invocation) -> Value | None:
        """Model a call that makes or uses a service or action client, or names the node; else None."""
        ...

    def call_later(self, ctx: Ctx, target: Obj, values: Sequence[Value]) -> None:
        """Queue a function as root; the other arguments of the function are unknown."""
        ...

    def call_library(
        self, ctx: Ctx, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:
        """Call a library function or class; a function that iterates over analysed objects calls their iterators."""
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
        """Call a method of an object whose class is not analysed."""
        ...

    def call_object(
        self, ctx: Ctx, target: Obj, arguments: Arguments, frame: Frame, call: ir.Call, carriers: Nodes = NONE
    ) -> Value:
        """Call one object; `carriers` are the nodes through which a method's receiver arrived."""
        ...

    def call_value(
        self,
        ctx: Ctx,
        function: Value,
        arguments: Arguments,
        frame: Frame,
        call: ir.Call,
        carriers: Nodes = NONE,
    ) -> Value:
        """Call every object that a value may be. The result of an unknown callee depends on its arguments."""
        ...

    def deep(self, ctx: Ctx, objects: frozenset[Obj]) -> Nodes:
        """Return all nodes whose data is inside objects, cached until something is stored."""
        ...

    def default(self, ctx: Ctx, obj: Obj, name: str) -> Value:
        """Return the value of an unset field; a field of a package may be a submodule."""
        ...

    def entries(self, ctx: Ctx, obj: Obj, value: Value) -> None:
        """Copy the entries of a mapping or a sequence of pairs."""
        ...

    def escaped(self, ctx: Ctx, frame: Frame, caller: Frame) -> None:
        """Make statements after a call depend on whether the called function raises."""
        ...

    def evaluate(self, ctx: Ctx, expr: ir.Expr, frame: Frame) -> Value:
        """Return the abstract value of an expression."""
        ...

    def gate(self, ctx: Ctx, decides: Nodes, frame: Frame, slot: Hashable) -> Nodes:
        """Return the node that decides which elements a new container gets; empty if no data decides this."""
        ...

    def generic(self, ctx: Ctx, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Make the result depend on all arguments; store into the argument that is written according to the catalog."""
        ...

    def holder(self, expr: ir.Name, frame: Frame) -> Obj:
        """Return the object that holds a variable: a frame, a class under construction, or a module."""
        ...

    def imported(self, ctx: Ctx, module: str, member: str | None, importer: object) -> Value:
        """Return the value that an import binds: an analysed module or its name, or a library name."""
        ...

    def may_fail(self, ctx: Ctx, deps: Nodes, raises: str, frame: Frame, *, named: bool = False) -> None:
        """Make later statements depend on whether a library call raises for its arguments."""
        ...

    def may_wait(self, ctx: Ctx, decides: Nodes, frame: Frame) -> None:
        """Make the rest of a function, or of a loop iteration, depend on the event of a waiting call."""
        ...

    def missing(self, ctx: Ctx, mapping: Obj, name: str) -> Value:
        """Return the value that a mapping with a default creates for a missing key."""
        ...

    def named_by_settings(self, ctx: Ctx, target: Obj) -> str:
        """Return the qualified name of an analysed function or method that the settings mention; "" for others."""
        ...

    def narrow_part(self, ctx: Ctx, test: ir.Expr, frame: Frame, *, holds: bool) -> Former:
        """Narrow variables for the rest of an expression. Return the values from before, and the new values."""
        ...

    def note_origins(self, ctx: Ctx, frame: Frame, given: Sequence[Origin]) -> None:
        """Record where the parameters of a call got their values, after they are bound."""
        ...

    def origins(self, ctx: Ctx, caller: Frame, call: ir.Call, passed: Arguments) -> tuple[Origin, ...]:
        """Return the arguments that are one of several objects, or a part of one of several objects."""
        ...

    def read_item(self, ctx: Ctx, base: Value, index: Value) -> Value:
        """Return an element; a tainted index taints it."""
        ...

    def receiver(self, ctx: Ctx, base: Value) -> Value:
        """Return the receiver of a publish call.

        Decisions between publishers that are all alike are left out.
        """
        ...

    def register_filter(self, ctx: Ctx, target: Obj | None, it: Invocation) -> Value:
        """Run a callback with one message of each subscriber."""
        ...

    def remainder(self, ctx: Ctx, values: list[Value]) -> Consts:
        """Return the constants of `text % values` if all parts are known."""
        ...

    def root_frame(self, ctx: Ctx, root: Root) -> Frame:
        """Return the frame that represents ROS as the caller."""
        ...

    def ros_call(self, ctx: Ctx, it: Invocation) -> Value:
        """Apply the catalog's entry for a call."""
        ...

    def run(self, ctx: Ctx, frame: Frame) -> Value:
        """Execute a frame's body and return its result."""
        ...

    def send(self, ctx: Ctx, it: Invocation, info: Publisher) -> Value:
        """Record a sink, which depends on everything inside the message and on the conditions of the call."""
        ...

    def serve(self, ctx: Ctx, target: Obj, it: Invocation) -> Value:
        """Call a method of an action server or goal handle."""
        ...

    def unpacked(self, ctx: Ctx, value: Value) -> list[Value] | None:
        """Return the elements of a sequence with known elements."""
        ...

    def widen(self, ctx: Ctx, former: Former) -> None:
        """After an expression, restore the value of each narrowed variable to which the expression has not assigned."""
        ...

    def wait(self, ctx: Ctx, frame: Frame) -> None:
        """Exchange stored values with other roots, at a wait."""
        ...
