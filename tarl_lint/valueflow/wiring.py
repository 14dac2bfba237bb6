"""The parts of the interpreter that others reach only through `ctx.ops`: which function does what."""

from __future__ import annotations

from tarl_lint.valueflow.calls import call, call_object, call_value
from tarl_lint.valueflow.combining import unpacked
from tarl_lint.valueflow.contents import deep
from tarl_lint.valueflow.evaluate import evaluate, holder, read_item
from tarl_lint.valueflow.execute import assign, assign_fallback, bind_target, block, run
from tarl_lint.valueflow.importing import default, imported
from tarl_lint.valueflow.iterating import gate
from tarl_lint.valueflow.library import call_method, generic, named_by_settings
from tarl_lint.valueflow.publishing import send
from tarl_lint.valueflow.raising import escaped, may_fail
from tarl_lint.valueflow.records import entries, fill, missing
from tarl_lint.valueflow.ros import ros_call
from tarl_lint.valueflow.serving import serve
from tarl_lint.valueflow.subscribing import call_later, register_filter
from tarl_lint.valueflow.taking import call_library
from tarl_lint.valueflow.texts import remainder
from tarl_lint.valueflow.worklist import add_root, root_frame, wait

__all__ = [
    "add_root",
    "assign",
    "assign_fallback",
    "bind_target",
    "block",
    "call",
    "call_later",
    "call_library",
    "call_method",
    "call_object",
    "call_value",
    "deep",
    "default",
    "entries",
    "escaped",
    "evaluate",
    "fill",
    "gate",
    "generic",
    "holder",
    "imported",
    "may_fail",
    "missing",
    "named_by_settings",
    "read_item",
    "register_filter",
    "remainder",
    "root_frame",
    "ros_call",
    "run",
    "send",
    "serve",
    "unpacked",
    "wait",
]
