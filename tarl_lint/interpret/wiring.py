"""Assign the functions that lower parts call through `ctx.ops`."""

from __future__ import annotations

from tarl_lint.interpret.calls import call, call_object, call_value
from tarl_lint.interpret.exceptions import escaped, may_fail, may_wait
from tarl_lint.interpret.expressions import evaluate, holder, read_item
from tarl_lint.interpret.imports import default, imported
from tarl_lint.interpret.passed_tags import note as note_origins
from tarl_lint.interpret.passed_tags import origins
from tarl_lint.interpret.statements import assign, assign_fallback, bind_target, block, run
from tarl_lint.interpret.tags import narrow_part, widen
from tarl_lint.interpret.worklist import add_root, root_frame, wait
from tarl_lint.memory.reachable_data import deep
from tarl_lint.models.iterators import gate
from tarl_lint.models.library_functions import generic, named_by_settings
from tarl_lint.models.library_methods import call_method
from tarl_lint.models.records import entries, fill, missing
from tarl_lint.models.ros.catalog_calls import ros_call
from tarl_lint.models.ros.clients import launched_call
from tarl_lint.models.ros.publications import receiver, send
from tarl_lint.models.ros.services import serve
from tarl_lint.models.ros.subscriptions import call_later, register_filter
from tarl_lint.models.sizes import unpacked
from tarl_lint.models.strings import remainder
from tarl_lint.models.unpacking import call_library

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
    "launched_call",
    "may_fail",
    "may_wait",
    "missing",
    "named_by_settings",
    "narrow_part",
    "note_origins",
    "origins",
    "read_item",
    "receiver",
    "register_filter",
    "remainder",
    "root_frame",
    "ros_call",
    "run",
    "send",
    "serve",
    "unpacked",
    "wait",
    "widen",
]
