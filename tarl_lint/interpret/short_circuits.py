"""Generator expressions in `any`, `all` and `next`: an earlier element decides whether later ones are evaluated."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Final

from tarl_lint.interpret import literals, operators
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.registrations import calls_method_of
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import NONE, Value, pointer
from tarl_lint.models import object_lists, sizes

MAX_ASKED: Final = 16  # maximum number of objects whose methods are called one by one


def comprehension(ctx: Interpreter, expr: ir.Comprehension, frame: Frame) -> Value:
    """Return the container that a comprehension makes.

    If it is lazy and calls methods of known objects, each element depends on the results of the earlier elements.
    """
    (target, source, tests) = expr.loops[0]
    if expr.lazy and len(expr.loops) == 1 and calls_method_of(target, (expr.node, *expr.tests)):
        given = sizes.counted(ctx, source, frame, each=True)
        known = sizes.unpacked(ctx, object_lists.without_empty(ctx, given))
        if known and len(known) <= MAX_ASKED and object_lists.asked(ctx, known):
            return _asked(ctx, expr, target, tests, known, frame)
    return literals.comprehension(ctx, expr, frame)


def _asked(
    ctx: Interpreter,
    expr: ir.Comprehension,
    target: ir.Expr,
    tests: Sequence[ir.Expr],
    known: Sequence[Value],
    frame: Frame,
) -> Value:
    """Evaluate the elements in order, each under the conditions that the earlier elements decide."""
    obj = recency.allocate(ctx, "sequence", frame, ("display", expr.slot))
    turn, guards, decides = frame.turn, len(ctx.guards), NONE
    for number, one in enumerate(known):
        frame.turn = (*turn, expr.slot, number)
        ctx.ops.assign(ctx, target, one, frame)
        for test in tests:
            answer = ctx.ops.evaluate(ctx, test, frame)
            decides |= ctx.use(answer)
            _guard(ctx, answer, (expr.slot, number, test.pos), frame)
        element = ctx.ops.evaluate(ctx, expr.element, frame)
        gate = ctx.ops.gate(ctx, decides, frame, (expr.slot, number))
        element = Value(element.deps | gate, element.pts, element.consts)
        ctx.store.put((obj, heap.item_field(number)), element)
        if not isinstance(expr.element, ir.Name):
            _guard(ctx, element, (expr.slot, number), frame)
    frame.turn = turn
    del ctx.guards[guards:]
    return pointer(obj)


def _guard(ctx: Interpreter, answer: Value, slot: Hashable, frame: Frame) -> None:
    if not answer.fixed():
        decides = operators.truth(ctx, answer, frame, slot)
        ctx.guards.append((operators.guard(ctx, decides, frame, slot), "rest"))
