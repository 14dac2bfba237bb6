"""Bookkeeping: numbers that ROS needs but that do not influence how a node controls the robot.

No search changes them. Examples are the `0` in `rospy.Time(0)`, which means the latest transform, the timeout of a
look-up, the length of a queue or of a transform buffer, the id of a marker, and the period of a timer that only logs.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache

from pytest_tarl.patching.document import Document, called
from tarl_lint.api import Analysis

# endings of the names of calls that create time stamps
STAMPS = ("Time", "Time.from_sec", "Time.from_seconds")
# call → index of the first positional argument that is a time stamp, a timeout or a queue length
MIDDLEWARE = {
    **dict.fromkeys(
        ("lookup_transform", "lookupTransform", "can_transform", "canTransform", "lookup_twist"), 2
    ),
    **dict.fromkeys(("waitForTransform", "wait_for_transform_async", "lookup_transform_async"), 2),
    **dict.fromkeys(("lookup_transform_full", "lookupTransformFull", "can_transform_full"), 1),
    **dict.fromkeys(("wait_for_server", "wait_for_result", "wait_for_transform"), 0),
    **dict.fromkeys(("Buffer", "TransformListener", "BufferClient"), 0),
    **dict.fromkeys(("QoSProfile", "Cache", "TimeSynchronizer"), 0),
}
# keyword arguments that hold such values in any call
KEYWORDS = (
    "timeout",
    "timeout_sec",
    "cache_time",
    "queue_size",
    "buff_size",
    "depth",
    "history_depth",
    "qos_profile",
)
IDENTITIES = ("seq", "stamp", "frame_id", "id")  # message fields that hold an ID or a time stamp
# function that creates a timer → index of its callback argument
TIMERS = {"Timer": 1, "create_timer": 1, "create_wall_timer": 1}


def is_bookkeeping(analysis: Analysis, source: Document, node: ast.expr) -> bool:
    """Return whether a number at an expression is bookkeeping of the middleware."""
    inner: ast.AST = node
    for around in source.ancestors(node):
        if isinstance(around, ast.Call) and around.func is not inner and _of_call(analysis, around, inner):
            return True
        if isinstance(around, ast.Call) and inner in around.args[:1] and _only_logs(analysis, around):
            return True
        if isinstance(around, ast.keyword) and around.arg in KEYWORDS:
            return True
        if isinstance(around, ast.Assign):
            return any(isinstance(one, ast.Attribute) and one.attr in IDENTITIES for one in around.targets)
        if isinstance(around, ast.stmt):
            return False
        inner = around
    return False


def _of_call(analysis: Analysis, call: ast.Call, inner: ast.AST) -> bool:
    """Return whether an argument of a call is a time stamp, a timeout or the length of a queue.

    If the program itself defines a function or class of this name, the call does not count.
    """
    name = ast.unparse(call.func)
    if name.rpartition(".")[2] in _defined(tuple(analysis.sources.values())):
        return False
    if any(name == one or name.endswith(f".{one}") for one in STAMPS):
        return True
    last = name.rpartition(".")[2]
    return last in MIDDLEWARE and inner in call.args[MIDDLEWARE[last] :]


def _only_logs(analysis: Analysis, call: ast.Call) -> bool:
    """Return whether a call makes a timer whose callback has no influence on what is published."""
    at = TIMERS.get(called(call))
    if at is None:
        return False
    given = [one.value for one in call.keywords if one.arg == "callback"] or call.args[at : at + 1]
    if not given or not isinstance(given[0], ast.Name | ast.Attribute):
        return False
    callees = _callees(tuple(analysis.sources.values()))
    reached, news = set[str](), {ast.unparse(given[0]).rpartition(".")[2]}
    while news:
        reached |= news
        news = {name for one in news for name in callees.get(one, ())} - reached
    known = [*analysis.sites, *analysis.deciding]
    matter = {part for step in known for part in step.site.qualname.split(".")}
    return bool(reached & callees.keys()) and not reached & matter


@cache
def _callees(texts: tuple[str, ...]) -> dict[str, frozenset[str]]:
    """Map function and method names to the names that they mention. Functions with equal names count as one."""
    found: dict[str, frozenset[str]] = {}
    for text in texts:
        for function in _functions(text):
            mentioned = frozenset(_mentioned(function))
            found[function.name] = found.get(function.name, frozenset()) | mentioned
    return found


@cache
def _defined(texts: tuple[str, ...]) -> frozenset[str]:
    """Return the names of the functions, methods and classes of the program."""
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    return frozenset(
        one.name for text in texts for one in ast.walk(ast.parse(text)) if isinstance(one, kinds)
    )


def _functions(text: str) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node


def _mentioned(function: ast.AST) -> Iterator[str]:
    for node in ast.walk(function):
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Attribute):
            yield node.attr
