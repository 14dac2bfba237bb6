"""Find the quality of service of rclpy publishers and subscriptions, as far as it is constant."""

from __future__ import annotations

import ast
from collections.abc import Collection
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
# members of QoSPresetProfiles, which are used through `value`, and the short keys of `get_from_short_key`
_PRESETS: Final = {
    "SENSOR_DATA": _NAMED["qos_profile_sensor_data"],
    "DEFAULT": _NAMED["qos_profile_default"],
    "SYSTEM_DEFAULT": Qos(),
    "BEST_AVAILABLE": Qos(),
}
_PLACES: Final = {"create_publisher": 2, "create_subscription": 3}
_RELIABILITY: Final = {"RELIABLE": True, "BEST_EFFORT": False}
_DURABILITY: Final = {"TRANSIENT_LOCAL": True, "VOLATILE": False}
# attribute of a profile, its values, and the part of `Qos`
_POLICIES: Final = (("reliability", _RELIABILITY, "reliable"), ("durability", _DURABILITY, "latched"))


def of_call(outline: Outline, pos: Pos, others: Collection[Outline] = ()) -> Qos | None:
    """Return the quality of service in a call at a position; None if it is not constant.

    `others` are the outlines of all modules of the program, which may define the profile.
    """
    call = outline.call(pos)
    if call is None:
        return None
    name = call.func.attr if isinstance(call.func, ast.Attribute) else ""
    place = _PLACES.get(name)
    if place is None:
        return None
    given = next((one.value for one in call.keywords if one.arg in ("qos_profile", "qos")), None)
    given = given if given is not None else call.args[place] if len(call.args) > place else None
    if given is None:
        return None
    found = _of(given, outline, 0)
    if found is None and last_name(given) not in outline.assigned:
        defining = [one for one in others if one is not outline and last_name(given) in one.assigned]
        return _of(given, defining[0], 0) if len(defining) == 1 else None
    return found


def _of(expr: ast.expr, outline: Outline, depth: int) -> Qos | None:
    if isinstance(expr, ast.Constant) and isinstance(expr.value, int):
        return Qos(reliable=True, latched=False)
    last = last_name(expr)
    imported = _imported_as(outline.tree).get(last, last)
    if imported in _NAMED:
        return _NAMED[imported]
    if _preset(expr) in _PRESETS:
        return _PRESETS[_preset(expr)]
    if isinstance(expr, ast.Call) and last_name(expr.func) == "QoSProfile":
        return _profile(expr)
    if isinstance(expr, ast.Name | ast.Attribute) and depth < 3:
        values = outline.assigned.get(last, [])
        if len(values) == 1:
            found = _of(values[0], outline, depth + 1)
            return None if found is None else _changed(found, outline, last)
    return None


def _imported_as(tree: ast.Module) -> dict[str, str]:
    """Return local name → name for `from rclpy.qos import NAME as LOCAL`."""
    return {
        alias.asname: alias.name
        for node in tree.body
        if isinstance(node, ast.ImportFrom) and node.module == "rclpy.qos"
        for alias in node.names
        if alias.asname
    }


def _preset(expr: ast.expr) -> str:
    """Return `SENSOR_DATA` for `QoSPresetProfiles.SENSOR_DATA.value`, also by its short key; "" for others."""
    match expr:
        case ast.Attribute(attr="value", value=ast.Attribute(value=enumeration, attr=name)) if (
            last_name(enumeration) == "QoSPresetProfiles"
        ):
            return name
        case ast.Call(func=ast.Attribute(attr="get_from_short_key"), args=[ast.Constant(value=str(key))]):
            return key.upper()
    return ""


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
