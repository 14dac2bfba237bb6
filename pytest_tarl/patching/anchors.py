"""Find where a node creates its subscriptions, so that a repair can add another one there."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.document import Document, Edit, Function, Loop, called, document
from pytest_tarl.patching.imports import top_imports
from tarl_lint.model import SiteId

if TYPE_CHECKING:
    from tarl_lint.api import Analysis
    from tarl_lint.model import Source

REGISTERING = {
    "Subscriber", "create_subscription", "create_timer", "Timer", "Service", "create_service", "TimeSynchronizer",
    "ApproximateTimeSynchronizer", "SimpleActionServer", "ActionServer", "registerCallback",
}  # fmt: skip
_NO_START = 9
_NODE_METHODS = {
    "create_subscription",
    "create_publisher",
    "create_timer",
    "create_service",
    "declare_parameter",
}


@dataclass(frozen=True)
class Anchor:
    """A statement next to which a subscription can be added.

    `node` is the expression for the rclpy node; it is empty for rospy.
    """

    source: Document
    statement: ast.stmt
    after: bool
    node: str
    quote: str = '"'

    @property
    def annotated(self) -> bool:
        """Return whether the surrounding function has a return annotation."""
        function = self.source.function(self.statement)
        return function is not None and function.returns is not None

    def edit(self, line: str) -> Edit:
        """Return the edit that inserts a line of code here."""
        indent = self.source.indentation(self.statement)
        if self.after:
            end = self.source.line_end(self.statement)
            return Edit(end, end, f"\n{indent}{line}")
        start = self.source.start(self.statement)
        return Edit(start, start, f"{line}\n{indent}")


def anchors(analysis: Analysis, site: SiteId, path: str) -> Iterator[Anchor]:
    """Yield places to subscribe: next to subscriptions in the site's flows, then next to those in its file.

    Last come the places where a node starts, for nodes without a usable subscription.
    """
    own = {flow.source for flow in analysis.flows if any(step.site == site for step in flow.steps)}
    sources = dict.fromkeys(flow.source for flow in analysis.flows)
    for each in sorted(sources, key=lambda each: (each not in own, each.span.path != path)):
        yield from _registered(analysis, each)
    for name in sorted(analysis.sources, key=lambda name: (name != path, name)):
        with suppress(RepairError):  # a file that cannot be parsed cannot start a node
            yield from _started(document(name, analysis.sources[name]))


def beside(source: Document, call: ast.expr, node: str) -> Anchor | None:
    """Return the place for another subscription after `call`, outside any loop, or None."""
    statement = source.statement(call)
    within = [statement, *_until_function(source, statement)]
    loops = [each for each in within if isinstance(each, Loop)]
    statement = loops[-1] if loops else statement
    text = source.source(call)
    quote = "'" if "'" in text and '"' not in text else '"'
    if hasattr(statement, "body") or isinstance(statement, ast.Return | ast.Raise):
        return Anchor(source, statement, False, node, quote) if source.leads(statement) else None
    if source.alone(statement):
        return Anchor(source, statement, True, node, quote)
    leader = _leader(source, statement)
    return None if leader is None else Anchor(source, leader, False, node, quote)


def is_ros2(source: Document, api: str = "") -> bool:
    """Return whether code uses rclpy rather than rospy."""
    if api.startswith(("rclpy", "rospy")):
        return api.startswith("rclpy")
    modules = {
        alias.name for node in top_imports(source) if isinstance(node, ast.Import) for alias in node.names
    }
    modules |= {node.module or "" for node in top_imports(source) if isinstance(node, ast.ImportFrom)}
    return any(module.partition(".")[0] == "rclpy" for module in modules)


def _registered(analysis: Analysis, origin: Source) -> Iterator[Anchor]:
    """Yield the place next to a subscription call found by the analysis."""
    text = analysis.sources.get(origin.span.path)
    if text is None or origin.api.endswith("wait_for_message"):
        return
    source = document(origin.span.path, text)
    call = source.at(origin.span)
    if call is None:
        return
    node = (
        _node(source, call) if is_ros2(source, origin.api) or _called(call) == "create_subscription" else ""
    )
    anchor = None if node is None else beside(source, call, node)
    if anchor is not None:
        yield anchor


def _started(source: Document) -> Iterator[Anchor]:
    """Yield the places after calls that start a node, then those after calls that use the node."""
    ros2 = is_ros2(source)
    calls = [node for node in ast.walk(source.tree) if isinstance(node, ast.Call)]
    ranked = [(_start_rank(source, call, ros2), call) for call in calls]
    for rank, call in sorted(ranked, key=lambda each: each[0]):
        node = _node(source, call) if ros2 else ""
        anchor = beside(source, call, node) if rank < _NO_START and node is not None else None
        if anchor is not None:
            yield anchor


def _start_rank(source: Document, call: ast.Call, ros2: bool) -> int:
    """Return 0 if a call runs once when a node starts, 1 or 2 if this is less certain, else `_NO_START`."""
    name = _called(call)
    if not ros2:
        return 0 if name == "init_node" else _NO_START
    if name == "create_node" or (name == "__init__" and _is_node_class(source, call)):
        return 0
    function = source.function(call)
    early = function is None or function.name in ("__init__", "main")
    return _NO_START if name not in _NODE_METHODS else 1 if early else 2


def _node(source: Document, call: ast.expr) -> str | None:
    """Return the expression for the rclpy node at a call, or None."""
    if isinstance(call, ast.Call) and _receiver(call):
        return _receiver(call)
    statement = source.statement(call)
    if _called(call) == "create_node" and isinstance(statement, ast.Assign) and statement.value is call:
        return ast.unparse(statement.targets[0])
    method = source.method(call)
    if method is not None and _is_node_class(source, call):
        return method[2]
    around = source.function(call) or source.tree
    found = [_receiver(each) for each in ast.walk(around) if isinstance(each, ast.Call)]
    if method is not None:
        everywhere = [_receiver(each) for each in ast.walk(method[0]) if isinstance(each, ast.Call)]
        found += [each for each in everywhere if each.startswith(f"{method[2]}.")]
    return next(filter(None, found), None)


def _receiver(call: ast.Call) -> str:
    """Return the receiver of a call `node.create_…(…)`, or an empty text."""
    named = isinstance(call.func, ast.Attribute) and call.func.attr in _NODE_METHODS
    return ast.unparse(call.func.value) if named and isinstance(call.func, ast.Attribute) else ""


def _is_node_class(source: Document, place: ast.AST) -> bool:
    method = source.method(place)
    return method is not None and any(ast.unparse(base).endswith("Node") for base in method[0].bases)


def _called(call: ast.expr) -> str:
    return called(call) if isinstance(call, ast.Call) else ""


def _until_function(source: Document, statement: ast.stmt) -> Iterator[ast.stmt]:
    for around in source.ancestors(statement):
        if isinstance(around, Function | ast.ClassDef | ast.Module):
            return
        if isinstance(around, ast.stmt):
            yield around


def _leader(source: Document, statement: ast.stmt) -> ast.stmt | None:
    """Return the first statement on a statement's line; None if that is a definition."""
    around = [*reversed(source.block(statement)), *_until_function(source, statement)]
    return next((each for each in around if each.lineno == statement.lineno and source.leads(each)), None)
