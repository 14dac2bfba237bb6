"""Strings that stand for parameters in the names of topics, until the launch of a node gives their values.

The topic of `rospy.Subscriber(rospy.get_param("~scan", "scan") + "/front", …)` is known only at launch. In a run that
follows such names, `get_param` returns a string with a mark, which string operations keep.
"""

from __future__ import annotations

from tarl_lint.memory.values import GIVEN, Consts, Symbolic, Value
from tarl_lint.parameter_names import MARK, ParameterName


def text_of_parameter(known: list[ParameterName] | None, name: str, default: Value) -> Consts:
    """Return the text that stands for a parameter; None if the default is not a string.

    If `known` is None, the analysis does not follow the names of parameters, and the default remains as one
    possible text.
    """
    if known is None:
        return with_default(default)
    if not name.strip("~/") or default.pts:
        return None
    texts = default.names()
    if default.consts and not texts:
        return None
    return frozenset([marked(known, ParameterName(name, texts[0] if len(texts) == 1 else None))])


def with_default(default: Value) -> Consts:
    """Return the strings of a value known only on the robot, with a default; None if the default is not a string."""
    if default.pts or not default.names():
        return None
    return frozenset([GIVEN, *(default.consts or ())])


def marked(known: list[ParameterName], one: ParameterName) -> Symbolic:
    """Return the text that stands for a part of a name."""
    if one not in known:
        known.append(one)
    return Symbolic(f"{MARK}{known.index(one)}{MARK}")
