"""TARL204: a publisher never publishes.

The topic is advertised, so other nodes see it and may wait for its messages. But no publish call uses the publisher,
and the node does not pass it to code that could publish. Usually the publish call is missing, or the publisher is no
longer needed.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from typing import Final

from tarl_lint import catalog
from tarl_lint.evidence import Evidence, Read
from tarl_lint.fingerprints import topic_text
from tarl_lint.ir.nodes import Pos
from tarl_lint.model import Finding
from tarl_lint.models.ros.endpoints import Publisher
from tarl_lint.prefilter.one_sided_groups import Side
from tarl_lint.read.source import Module
from tarl_lint.trees import last_name, walk

FACTS: Final = {**catalog.FUNCTIONS, **catalog.METHODS}
PUBLISHER_MAKERS: Final = frozenset(n.rpartition(".")[2] for n, f in FACTS.items() if f.kind == "publisher")

CODE: Final = "TARL204"
SUMMARY: Final = "a publisher never publishes"

INVALID: Final = (
    """
    import rospy
    from geometry_msgs.msg import Twist
    from std_msgs.msg import Float64

    class Drive:
        def __init__(self):
            self.cmd = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
            self.speed = rospy.Publisher("/speed", Float64, queue_size=1)

        def run(self):
            if self.cmd.get_num_connections() > 0:
                self.speed.publish(0.5)

    if __name__ == "__main__":
        Drive().run()
    """,
)

VALID: Final = (
    """
    import rospy
    from std_msgs.msg import Float64

    pubs = {"left": rospy.Publisher("/left", Float64, queue_size=1)}

    def send(side, value):
        pubs[side].publish(value)
    """,
    """
    import rospy
    from robot.bridge import Sender
    from std_msgs.msg import Float64

    if __name__ == "__main__":
        pub = rospy.Publisher("/speed", Float64, queue_size=1)
        Sender(pub).run()
    """,
)

HARMLESS: Final = frozenset(
    ["get_num_connections", "get_subscription_count", "unregister", "destroy", "topic", "topic_name", "name",
     "resolved_name", "assert_liveliness", "wait_for_all_acked"]
)  # fmt: skip
SCOPES: Final = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)


def ruled_out(side: Side) -> bool:
    """Return whether the syntax shows that every publisher is used."""
    return all(map(_all_publish, side.modules, side.texts))


def _all_publish(module: Module, text: str) -> bool:
    """Return whether every publisher is stored under its own name, and this name is used to publish."""
    if not any(maker in text for maker in PUBLISHER_MAKERS):
        return True
    mentioned, names = 0, list[str]()
    for node in walk(module.tree):
        if isinstance(node, (ast.Name, ast.Attribute)) and last_name(node) in PUBLISHER_MAKERS:
            mentioned += 1
        elif isinstance(node, ast.ImportFrom) and any(
            a.name in PUBLISHER_MAKERS and a.asname for a in node.names
        ):
            return False
        elif isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
            made = last_name(node.value.func) in PUBLISHER_MAKERS
            names += [last_name(target) for target in node.targets if made]
    apart = mentioned == len(names) == len(set(names))
    return apart and all(n and re.search(rf"\b{n}\s*\.\s*publish\b", text) for n in names)


def findings(evidence: Evidence) -> Iterator[Finding]:
    """Yield a hazard for each call that creates a publisher that never publishes."""
    made: dict[tuple[str, Pos], list[Publisher]] = {}
    for obj in evidence.machine.objects.values():
        if isinstance(obj.info, Publisher):
            made.setdefault((obj.info.path, obj.info.pos), []).append(obj.info)
    for (path, pos), publishers in made.items():
        if any(p.used for p in publishers) or _may_publish(path, pos, evidence):
            continue
        names = sorted({t for p in publishers for t in p.topics})
        topics = ", ".join(names) or "a topic"
        types = " | ".join(sorted({t for p in publishers for t in p.types}))
        named = f"{topics} ({types})" if types else topics
        message = f"{named} is advertised, but nothing is ever published on it"
        yield evidence.finding(CODE, evidence.span(path, pos), message, topic_text(names))


def _may_publish(path: str, pos: Pos, evidence: Evidence) -> bool:
    """Return whether any code could use the publisher that a call creates in order to publish."""
    outline = evidence.outline(path)
    call = outline.call(pos)
    statement = outline.parents.get(call) if call is not None else None
    if call is None or statement is None:
        return True
    if any(keyword.arg == "event_callbacks" for keyword in call.keywords):
        # this publisher may exist only for its event callbacks
        return True
    if isinstance(statement, ast.Expr):
        return False
    targets: list[ast.expr] = []
    if isinstance(statement, ast.Assign):
        targets = statement.targets
    elif isinstance(statement, ast.AnnAssign):
        targets = [statement.target]
    if not targets or outline.by_text or not evidence.complete(path):
        return True
    return any(_target_read(t, path, pos, evidence) for t in targets)


def _target_read(target: ast.expr, path: str, pos: Pos, evidence: Evidence) -> bool:
    """Return whether code uses the publisher stored in a target, other than to ask for its properties."""
    outline = evidence.outline(path)
    if isinstance(target, ast.Attribute):
        reads = evidence.reads(target.attr, attribute=True)
    elif isinstance(target, ast.Name):
        function = outline.scope(target, SCOPES)
        if function is not None and not _declared(function, target.id):
            local = evidence.reads(target.id, attribute=False, path=path)
            reads = (r for r in local if function in r.around)
        elif evidence.imported(target.id):
            return True
        else:
            reads = evidence.reads(target.id, attribute=False)
    else:
        return True
    return any(not _harmless(read, path, pos, evidence) for read in reads)


def _declared(function: ast.AST, name: str) -> bool:
    """Return whether a function declares a name as global or nonlocal."""
    return any(isinstance(n, (ast.Global, ast.Nonlocal)) and name in n.names for n in walk(function))


def _harmless(read: Read, path: str, pos: Pos, evidence: Evidence) -> bool:
    """Return whether a use of a publisher neither publishes nor passes the publisher on."""
    outer = read.around[0]
    if isinstance(outer, ast.Attribute):
        called = read.around[1]
        if outer.attr == "publish" and isinstance(called, ast.Call) and called.func is outer:
            return _others(read, called, path, pos, evidence)
        return outer.attr in HARMLESS
    if isinstance(outer, ast.Call):
        return isinstance(outer.func, ast.Attribute) and outer.func.attr == "destroy_publisher"
    return isinstance(outer, (ast.If, ast.Compare, ast.While, ast.IfExp)) or (
        isinstance(outer, ast.UnaryOp) and isinstance(outer.op, ast.Not)
    )


def _others(read: Read, call: ast.Call, path: str, pos: Pos, evidence: Evidence) -> bool:
    """Return whether a publish call on the same name uses only publishers other than this one."""
    place = (call.lineno, call.col_offset, call.end_lineno or 0, call.end_col_offset or 0)
    records = [one for one in evidence.machine.sinks.values() if (one.path, one.pos) == (read.path, place)]
    if not records or read.path != path or any((path, pos) in one.publishers for one in records):
        return False
    outline = evidence.outline(path)
    made = outline.call(pos)
    mine = outline.scope(made, (ast.ClassDef,)) if made is not None else None
    theirs = outline.scope(read.node, (ast.ClassDef,))
    return mine is not theirs and not (_related(mine, theirs) or _related(theirs, mine))


def _related(one: ast.AST | None, other: ast.AST | None) -> bool:
    """Return whether one class may inherit from the other, directly or through a base class that is not analysed."""
    if not isinstance(one, ast.ClassDef) or not isinstance(other, ast.ClassDef):
        return False
    return any(
        last_name(part) == other.name
        for base in one.bases
        for part in ast.walk(base)
        if isinstance(part, (ast.Name, ast.Attribute))
    )
