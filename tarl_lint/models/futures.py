"""Models of futures and executors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from tarl_lint.interpret import calls
from tarl_lint.interpret.call_contexts import CALLABLE
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, recency, updates
from tarl_lint.memory.heap import RESULT, item_field
from tarl_lint.memory.values import BOTTOM, NONE, UNKNOWN, Value, join, pointer
from tarl_lint.models import containers, context_managers
from tarl_lint.models.containers import READERS as CONTAINER_READERS
from tarl_lint.models.records import RECORDS

MAX_REPEATED: Final = 3  # maximum number of times that the calls of `gather` are evaluated again


def _set_result(ctx: Interpreter, it: Invocation) -> Value:
    plain, named = it.arguments
    value = plain[0] if plain else named.get("result", UNKNOWN)
    updates.write_field(ctx, it.base, RESULT, containers.through_statement(ctx, value, it.frame, it.call))
    return UNKNOWN


def _result(ctx: Interpreter, it: Invocation) -> Value:
    """Return a future's result; for a library's future, an object with the data passed to the future."""
    result, passed = BOTTOM, None
    for obj in it.base.objects:
        stored = ctx.store.get((obj, RESULT))
        if stored is not None:
            result = join(result, heap.arrive(ctx, stored, it.base.deps))
        if stored is None or heap.content(ctx, obj).deps:
            passed = (passed or NONE) | ctx.use(Value(it.base.deps, frozenset([obj])))
    if passed is None:
        return result
    made = recency.allocate(ctx, "lib", it.frame, ("result", it.call.slot))
    if passed:
        ctx.store.put((made, heap.ANY), Value(passed))
    return join(result, pointer(made))


def _is_done(ctx: Interpreter, it: Invocation) -> Value:
    """Return the value of `done()`.

    It depends on the conditions under which the result is set, but not on the result.
    """
    node = ctx.node(it.frame, ("done", it.call.slot), "call")
    deps = it.base.deps
    for obj in it.base.objects:
        stored = ctx.store.get((obj, RESULT))
        if stored is None:
            deps |= ctx.use(Value(it.base.deps, frozenset([obj])))
        else:
            ctx.graph.choice(stored.deps, node)
    return Value(deps | ctx.kept(node))


def gathered_results(ctx: Interpreter, it: Invocation) -> Value:
    """Return the results of several coroutines, one by one.

    Each coroutine may see what the others store, so their calls are evaluated again, unless they make objects.
    """
    running = [one for one in it.call.arguments if isinstance(one, ir.Call) and _makes_nothing(one)]
    for _ in range(min(len(running) - 1, MAX_REPEATED)):
        for coroutine in running:
            ctx.ops.evaluate(ctx, coroutine, it.frame)
    obj = recency.allocate(ctx, "sequence", it.frame, ("gathered", it.call.slot))
    for number, value in enumerate(it.arguments[0]):
        ctx.store.put((obj, item_field(number)), value)
    rest = it.arguments[1].get("*")
    if rest is not None:
        updates.add_element(ctx, pointer(obj), rest)
    return pointer(obj)


def _makes_nothing(call: ir.Call) -> bool:
    """Return whether the receiver and the arguments of a call are only names, attributes and constants."""
    parts = [call.function, *call.arguments, *(value for _, value in call.keywords)]
    while parts:
        part = parts.pop()
        if isinstance(part, ir.Attribute):
            parts.append(part.base)
        elif not isinstance(part, (ir.Name, ir.Const)):
            return False
    return True


def awaited_result(ctx: Interpreter, it: Invocation) -> Value:
    """Return the result of a coroutine that is run, started or awaited."""
    ctx.ops.wait(ctx, it.frame)
    return it.arguments[0][0] if it.arguments[0] else UNKNOWN


def _submit(ctx: Interpreter, it: Invocation) -> Value:
    """Call a function submitted to an executor; the future gets its result."""
    plain, named = it.arguments
    skipped = 1 if it.name == "run_in_executor" else 0
    given = plain[skipped:]
    if not given or not any(o.kind in CALLABLE for o in given[0].pts):
        return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    result = calls.call_value(ctx, given[0], (given[1:], named), it.frame, it.call)
    obj = recency.allocate(ctx, "lib", it.frame, ("future", it.call.slot))
    ctx.store.put((obj, RESULT), result)
    return pointer(obj)


def called_in_thread(ctx: Interpreter, it: Invocation) -> Value:
    """Return the result of a function that a library calls in a thread while a coroutine waits."""
    ctx.ops.wait(ctx, it.frame)
    (first, *rest), named = it.arguments[0] or [UNKNOWN], it.arguments[1]
    return calls.call_value(ctx, first, (rest, named), it.frame, it.call)


READERS: Final[Mapping[str, Callable[..., Value]]] = {
    **CONTAINER_READERS,
    **RECORDS,
    "result": _result,
    "submit": _submit,
    "run_in_executor": _submit,
    "done": _is_done,
    "enter_context": context_managers.put_on_stack,
    "enter_async_context": context_managers.put_on_stack,
    "set_result": _set_result,
}
