"""Models of functions that return the node's names, or resolve a name for the node.

They are used only for launch files.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, Literal

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import recency
from tarl_lint.memory.heap import item_field
from tarl_lint.memory.symbolic_names import marked
from tarl_lint.memory.values import UNKNOWN, Value, const, pointer
from tarl_lint.parameter_names import Launched, ParameterName

NAMES: Final[Mapping[str, Literal["node", "own", "namespace"]]] = {
    "rospy.get_name": "node",
    "rospy.get_caller_id": "node",
    "rospy.get_namespace": "namespace",
    "get_fully_qualified_name": "node",
    "get_namespace": "namespace",
    "get_name": "own",
}
RESOLVING: Final = frozenset(["rospy.resolve_name", "rospy.remap_name", "resolve_topic_name"])
TYPES: Final = frozenset(
    ["rostopic.get_topic_class", "rostopic.get_topic_type"]
)  # functions that return a tuple (type, topic, function)


def node_name(ctx: Interpreter, it: Invocation) -> Value | None:
    """Return the result of a call that names the node or a topic; None for other calls."""
    known = ctx.parameter_names
    if known is None:
        return None
    given = it.arguments[0]
    if it.name in NAMES and not given and not it.base.deps:
        if ctx.launched is not None:
            return const(_own(ctx.launched, NAMES[it.name]))
        return Value(it.base.deps, consts=frozenset([marked(known, ParameterName("", None, NAMES[it.name]))]))
    if it.name in RESOLVING and len(given) == 1 and (texts := given[0].names()):
        return Value(
            given[0].deps,
            consts=frozenset(marked(known, ParameterName(text, None, "resolved")) for text in texts),
        )
    if it.name in TYPES and given and given[0].names():
        found = recency.allocate(ctx, "sequence", it.frame, ("topic type", it.call.slot))
        for number, value in enumerate((UNKNOWN, given[0], UNKNOWN)):
            ctx.store.put((found, item_field(number)), value)
        return pointer(found)
    return None


def _own(node: Launched, kind: Literal["node", "own", "namespace"]) -> str:
    if kind == "node":
        return node.name
    return node.name.rpartition("/")[2] if kind == "own" else f"{node.namespace}/"
