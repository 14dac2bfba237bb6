"""Find the quality of service of rclpy publishers and subscriptions, as far as it is constant."""

from __future__ import annotations

import ast
from dataclasses import replace
from typing import Final

from tarl_lint.evidence import Outline
from tarl_lint.ir.nodes import Pos
from tarl_lint.system.model import Qos
from tarl_lint.trees import last_name

_NAMED: Final = {
    "qos_profile_sensor_data": Qos(reliable=False, latched=False),
    "qos_profile_system_default": Qos(),
    "qos_profile_default": Qos(reliable=True, latched=False),
}
_PLACES: Final = {"create_publisher": 2, "create_subscription": 3}
_RELIABILITY: Final = {"RELIABLE": True, "BEST_EFFORT": False}
_DURABILITY: Final = {"TRANSIENT_LOCAL": True, "VOLATILE": False}
# attribute of a profile, its values, and the part of `Qos`
_POLICIES: Final = (("reliability", _RELIABILITY, "reliable"), ("durability", _DURABILITY, "latched"))


def of_call(outline: Outline, pos: Pos) -> Qos | None:
    """Return the quality of service in a call at a position; None if it is not constant."""
    call = outline.call(pos)
    if call is None:
        return None
    name = call.func.attr if isinstance(call.func, ast.Attribute) else ""
    place = _PLACES.get(name)
    if place is None:
        return None
    given = next((one.value for one in call.keywords if one.arg in ("qos_profile", "qos")), None)
    given = given if given is not None else call.args[place] if len(call.args) > place else None
    return None if given is None else _of(given, outline, 0)


def _of(expr: ast.expr, outline: Outline, depth: int) -> Qos | None:
    if isinstance(expr, ast.Constant) and isinstance(expr.value, int):
        return Qos(reliable=True, latched=False)
    last = last_name(expr)
    if last in _NAMED:
        return _NAMED[last]
    if isinstance(expr, ast.Call) and last_name(expr.func) == "QoSProfile":
        return _profile(expr)
    if isinstance(expr, ast.Name | ast.Attribute) and depth < 3:
        values = outline.assigned.get(last, [])
        if len(values) == 1:
            found = _of(values[0], outline, depth + 1)
            return None if found is None else _changed(found, outline, last)
    return None


def _profile(call: ast.Call) -> Qos | None:
    stated = {one.arg: one.value for one in call.keywords}
    if None in stated:
        return None
    reliable = _RELIABILITY.get(_policy(stated.get("reliability"), "RELIABLE"))
    latched = _DURABILITY.get(_policy(stated.get("durability"), "VOLATILE"))
    return Qos(reliable, latched)


def _policy(expr: ast.expr | None, otherwise: str) -> str:
    """Return the name of a policy: the last part of `ReliabilityPolicy.BEST_EFFORT`, without an old prefix."""
    if expr is None:
        return otherwise
    name = last_name(expr)
    for prefix in ("RMW_QOS_POLICY_RELIABILITY_", "RMW_QOS_POLICY_DURABILITY_"):
        name = name.removeprefix(prefix)
    return name


def _changed(qos: Qos, outline: Outline, name: str) -> Qos:
    """Return a profile whose policies are set after its creation; a policy that is set several times is unknown."""
    stated: dict[str, list[ast.expr]] = {}
    for node in ast.walk(outline.tree):
        if isinstance(node, ast.Assign):
            for target in node.targets:
                if isinstance(target, ast.Attribute) and last_name(target.value) == name:
                    stated.setdefault(target.attr, []).append(node.value)
    for field, policies, part in _POLICIES:
        values = stated.get(field)
        if values:
            policy = policies.get(_policy(values[0], "")) if len(values) == 1 else None
            qos = replace(qos, **{part: policy})
    return qos
