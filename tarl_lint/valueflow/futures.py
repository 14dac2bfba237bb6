"""Futures and executors: a result that somebody else sets or computes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.activations import CALLABLE
from tarl_lint.valueflow.containers import READERS as CONTAINER_READERS
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.heap import item_field
from tarl_lint.valueflow.invocation import Arguments, Invocation
from tarl_lint.valueflow.records import RECORDS, Records
from tarl_lint.valueflow.values import BOTTOM, UNKNOWN, Value, join, pointer

RESULT: Final = "<result>"  # the field of a future that holds its result


class Futures(Records):
    """Calls methods of futures and executors."""

    def _set_result(self, it: Invocation) -> Value:
        plain, named = it.arguments
        value = plain[0] if plain else named.get("result", UNKNOWN)
        self.write_field(it.base, RESULT, self.through_statement(value, it.frame, it.call))
        return UNKNOWN

    def _result(self, it: Invocation) -> Value:
        """Return a future's result; of one that comes from a library, whatever went into it."""
        result = BOTTOM
        for obj in it.base.pts:
            stored = self.store.get((obj, RESULT))
            if stored is not None:
                result = join(result, self.arrive(stored, it.base.deps))
            if stored is None or self.content(obj).deps:
                result = join(result, Value(self.use(Value(it.base.deps, frozenset([obj])))))
        return result

    def _is_done(self, it: Invocation) -> Value:
        """Return whether a future has a result: what decided to set it, whatever it is."""
        node = self.node(it.frame, ("done", it.call.slot), "call")
        deps = it.base.deps
        for obj in it.base.pts:
            stored = self.store.get((obj, RESULT))
            if stored is None:
                deps |= self.use(Value(it.base.deps, frozenset([obj])))
            else:
                self.graph.choice(stored.deps, node)
        return Value(deps | self.kept(node))

    def _gathered(self, it: Invocation) -> Value:
        """Return the results of several coroutines, one by one."""
        obj = self.allocate("sequence", it.frame, ("gathered", it.call.slot))
        for number, value in enumerate(it.arguments[0]):
            self.store.put((obj, item_field(number)), value)
        rest = it.arguments[1].get("*")
        if rest is not None:
            self.add_element(pointer(obj), rest)
        return pointer(obj)

    def _awaited(self, it: Invocation) -> Value:
        """Return what a coroutine gives that is run, started or waited for."""
        self.wait(it.frame)
        return it.arguments[0][0] if it.arguments[0] else UNKNOWN

    def _submit(self, it: Invocation) -> Value:
        """Call the function that an executor is given; its result is the future's."""
        plain, named = it.arguments
        skipped = 1 if it.name == "run_in_executor" else 0
        given = plain[skipped:]
        if not given or not any(o.kind in CALLABLE for o in given[0].pts):
            return self.generic(it.name, it.arguments, it.frame, it.call)
        result = self.call_value(given[0], (given[1:], named), it.frame, it.call)
        obj = self.allocate("lib", it.frame, ("future", it.call.slot))
        self.store.put((obj, RESULT), result)
        return pointer(obj)

    def generic(self, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Pass the arguments on to the result."""
        raise NotImplementedError


READERS: Final[Mapping[str, Callable[..., Value]]] = {
    **CONTAINER_READERS,
    **RECORDS,
    "result": Futures._result,
    "submit": Futures._submit,
    "run_in_executor": Futures._submit,
    "done": Futures._is_done,
    "set_result": Futures._set_result,
}
