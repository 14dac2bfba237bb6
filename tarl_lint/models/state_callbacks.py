"""Models of smach's states that are made of functions, which get the shared userdata."""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import recency, userdata
from tarl_lint.memory.values import Value, pointer
from tarl_lint.models import states_and_behaviours
from tarl_lint.models.ros import subscriptions
from tarl_lint.models.smach import LATER

# keywords for functions whose result is the outcome of the state
ENDING: Final = frozenset(["cb", "cond_cb", "result_cb", "response_cb"])


def state_by_callbacks(ctx: Interpreter, it: Invocation) -> Value:
    """Create a state from functions that get the shared userdata. For some, the result is the state's outcome."""
    state = recency.allocate(ctx, "lib", it.frame, ("made", it.call.slot))
    part = states_and_behaviours.part_of(ctx, state, it.frame)
    plain, named = it.arguments
    given = [*(("cb" if n == 0 else "", v) for n, v in enumerate(plain)), *named.items()]
    for keyword, value in given:
        for target in value.objects:
            if target.kind in LATER:
                subscriptions.call_when(
                    ctx,
                    ("state", state.key),
                    target,
                    [userdata.userdata(ctx, state)],
                    "callback",
                    guards=[part.runs],
                    answer=part if keyword in ENDING else None,
                )
    return pointer(state)


def monitor(ctx: Interpreter, it: Invocation) -> Value:
    """Create a state that receives messages until its function returns False for one of them."""
    callback = it.argument(it.fact.callback)
    record = subscriptions.source(ctx, it, callback)
    state = recency.allocate(ctx, "lib", it.frame, ("made", it.call.slot))
    part = states_and_behaviours.part_of(ctx, state, it.frame)
    for target in callback.objects:
        if target.kind in LATER:
            values = [userdata.userdata(ctx, state), pointer(subscriptions.message(ctx, record, target))]
            key = ("monitor", *record.key)
            subscriptions.call_when(ctx, key, target, values, "callback", guards=[part.runs], answer=part)
    return pointer(state)
