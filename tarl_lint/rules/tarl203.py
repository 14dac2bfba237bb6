"""TARL203: a subscription has no effect.

The callback does not use its messages: it does not store, publish, pass on, log or return anything, or no code reads
what it stores. The subscription wastes bandwidth and time. Often the author forgot a line.

The rule does not report a callback that does something when a message arrives but ignores its content. It does not
report callbacks that intentionally do nothing, either: `lambda msg: None`, or a parameter whose name starts with an
underscore.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from typing import Final

from tarl_lint.evidence import Evidence
from tarl_lint.fingerprints import topic_text
from tarl_lint.flows.apart import by_line, merged
from tarl_lint.ir.nodes import Function
from tarl_lint.model import Finding
from tarl_lint.models.ros.endpoints import SourceRecord
from tarl_lint.prefilter.one_sided_groups import Side
from tarl_lint.rules.wording import end
from tarl_lint.trees import walk

CODE: Final = "TARL203"
SUMMARY: Final = "a subscription has no effect"

INVALID: Final = (
    """
    import rospy
    from sensor_msgs.msg import LaserScan

    def on_scan(msg):
        nearest = min(msg.ranges)

    rospy.init_node("watch")
    rospy.Subscriber("/scan", LaserScan, on_scan)
    rospy.spin()
    """,
    """
    import rclpy
    from nav_msgs.msg import Odometry
    from rclpy.node import Node

    class Follower(Node):
        def __init__(self):
            super().__init__("follower")
            self.create_subscription(Odometry, "odom", self.on_odom, 10)

        def on_odom(self, msg):
            self.position = msg.pose.pose.position

    def main():
        rclpy.init()
        rclpy.spin(Follower())
    """,
)

VALID: Final = (
    """
    import rospy
    from std_msgs.msg import Empty

    armed = False

    def on_start(_):
        global armed
        armed = True

    rospy.init_node("watch")
    rospy.Subscriber("/start", Empty, on_start)
    while not rospy.is_shutdown():
        if armed:
            rospy.loginfo("armed")
    """,
    """
    import rospy
    from sensor_msgs.msg import LaserScan

    def on_scan(msg):
        rospy.loginfo("nearest: %s", min(msg.ranges))

    rospy.Subscriber("/scan", LaserScan, on_scan)
    """,
)

PURE: Final = frozenset(
    ["abs", "all", "any", "bool", "dict", "enumerate", "float", "int", "len", "list", "max", "min", "range", "round",
     "set", "sorted", "str", "sum", "tuple", "zip"]
)  # fmt: skip
ACTIONS: Final = (
    ast.Raise, ast.Assert, ast.Await, ast.Yield, ast.YieldFrom, ast.Delete, ast.With, ast.AsyncWith,
    ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef,
)  # fmt: skip


def ruled_out(side: Side) -> bool:
    """Return whether the group subscribes to nothing, or all functions that it passes on have an effect."""
    if not side.hears:
        return True
    idle = [f for m in side.modules for f in _functions(m.tree.body) if not acting(f)]
    return {f.name for f in idle}.isdisjoint(name for m in side.modules for name in _handed_on(m.tree))


def _handed_on(tree: ast.Module) -> Iterator[str]:
    """Yield the names that are used elsewhere than in calls, and the strings, because a string may name a method."""
    called = {id(n.func) for n in walk(tree) if isinstance(n, ast.Call)}
    for node in walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value
        elif isinstance(node, ast.Attribute) and id(node) not in called:
            yield node.attr
        elif isinstance(node, ast.Name) and id(node) not in called:
            yield node.id


def _functions(body: Sequence[ast.stmt]) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    """Yield the functions that have parameters, among statements at any depth."""
    for statement in body:
        if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef)) and statement.args.args:
            yield statement
        for name in ("body", "orelse", "finalbody"):
            yield from _functions(getattr(statement, name, ()))
        for part in (*getattr(statement, "handlers", ()), *getattr(statement, "cases", ())):
            yield from _functions(part.body)


def findings(evidence: Evidence) -> Iterator[Finding]:
    """Yield a hazard for each subscription whose callbacks have no effect."""
    for records in by_line(evidence.machine.sources.values()):
        functions = _callbacks(evidence, records)
        if not functions or any(_meant(f) for f, _ in functions):
            continue
        kept = [_kept(function, path, evidence) for function, path in functions]
        names = {name for stores in kept for name in stores or ()}
        if any(stores is None for stores in kept) or (names and not _unread(names, functions, evidence)):
            continue
        source = evidence.tracer.ends.source(merged(records))
        reason = "ignores it"
        if names:
            reason = f"stores it in {', '.join(sorted(names))}, which nothing reads"
        message = f"{end(source)}: {source.callback} {reason}"
        about = f"{topic_text(source.topics)}, heard by {source.callback}"
        yield evidence.finding(CODE, source.span, message, about)


def _callbacks(evidence: Evidence, records: Sequence[SourceRecord]) -> list[tuple[Function, str]]:
    """Return the callbacks of the subscriptions at one line, with their files; empty if one callback is unknown."""
    found: list[tuple[Function, str]] = []
    if records[0].kind != "topic" or "ubscri" not in records[0].api:
        return found  # a service handler is allowed to ignore its request
    for record in records:
        for node in sorted(record.nodes):
            place = evidence.machine.graph.places[node]
            if place.statement is not None or place.frame is record.frame:
                return []
            found.append((place.frame.function, place.frame.program.path))
    return found


def _meant(function: Function) -> bool:
    """Return whether a function declares that it ignores its messages, or is meant to be overridden by subclasses."""
    ignored = any(p.name.startswith("_") for p in function.parameters)
    return ignored or bool(function.decorators) or isinstance(function.node, ast.Lambda)


def acting(node: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    """Return whether a function cannot be reported: because it declares that it is idle, acts, or returns a value."""
    if node.decorator_list or any(a.arg.startswith("_") for a in node.args.args):
        return True
    return any(_acts(p) or _returns(p) for statement in node.body for p in walk(statement))


def _kept(function: Function, path: str, evidence: Evidence) -> set[str] | None:
    """Return the attributes (`self.x`) and globals in which a callback stores values; None if it does anything else."""
    node = function.node
    if isinstance(node, ast.Lambda):
        return None
    receiver = node.args.args[0].arg if node.args.args and "." in function.qualname else ""
    shared = {n for s in walk(node) if isinstance(s, (ast.Global, ast.Nonlocal)) for n in s.names}
    stored: set[str] = set()
    for part in (n for statement in node.body for n in walk(statement)):
        if _acts(part) or _returns(part):
            return None
        if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store) and part.id in shared:
            stored.add(part.id)
        elif isinstance(part, (ast.Attribute, ast.Subscript)) and not isinstance(part.ctx, ast.Load):
            name = _attribute(part, receiver)
            if name is None:
                return None
            stored.add(name)
    whole = not stored or (evidence.complete(path) and not evidence.outline(path).by_text)
    return stored if whole else None


def _acts(node: ast.AST) -> bool:
    """Return whether an expression or statement may do something beyond computing a value."""
    if isinstance(node, ast.Call):
        return not (isinstance(node.func, ast.Name) and node.func.id in PURE)
    return isinstance(node, ACTIONS)


def _returns(node: ast.AST) -> bool:
    """Return whether a statement returns something that may be more than a constant."""
    return isinstance(node, ast.Return) and not (node.value is None or isinstance(node.value, ast.Constant))


def _attribute(target: ast.expr, receiver: str) -> str | None:
    """Return the target as `self.x` if it is an attribute of the receiver, otherwise None."""
    if (
        isinstance(target, ast.Attribute)
        and isinstance(target.value, ast.Name)
        and target.value.id == receiver
    ):
        return f"self.{target.attr}"
    return None


def _unread(names: set[str], functions: list[tuple[Function, str]], evidence: Evidence) -> bool:
    """Return whether no code reads the values stored under the names."""
    own = [function.node for function, _ in functions]
    for name in names:
        plain, attribute = name.removeprefix("self."), name.startswith("self.")
        reads = evidence.reads(plain, attribute=attribute)
        if _defined(plain, evidence) or any(not any(f in r.around for f in own) for r in reads):
            return False
        if not attribute and evidence.imported(plain):
            return False
    return True


def _defined(name: str, evidence: Evidence) -> bool:
    """Return whether a function has the name.

    Such a function may be the setter of a property, which does more than store a value.
    """
    marker = f"def {name}("
    return any(m.contains(marker) for m in evidence.machine.modules.values())
