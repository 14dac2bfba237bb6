"""Find the constant quality of service of rclpy endpoints."""

from __future__ import annotations

import ast
from collections.abc import Collection
from dataclasses import replace
from typing import Final

from tarl_lint.evidence import Outline
from tarl_lint.ir.nodes import Pos
from tarl_lint.system.model import Qos
from tarl_lint.system.table_rows import rows
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
_PLACES: Final = {"create_publisher": 2, "create_lifecycle_publisher": 2, "create_subscription": 3}
_FILTER: Final = "Subscriber"  # class of message_filters; its profile is passed as a keyword
_OF_NODE: Final = 3  # arguments of a filter in ROS 2: node, type and topic
_DEPTH: Final = 10  # queue depth of a filter that is created without a profile
_ROW: Final = 3  # minimum length of a row: topic, type and profile
_RELIABILITY: Final = {"RELIABLE": True, "BEST_EFFORT": False}
_DURABILITY: Final = {"TRANSIENT_LOCAL": True, "VOLATILE": False}
# (attribute of a profile, its possible values, field of `Qos` that stores it)
_POLICIES: Final = (("reliability", _RELIABILITY, "reliable"), ("durability", _DURABILITY, "latched"))


def of_call(
    outline: Outline,
    pos: Pos,
    others: Collection[Outline] = (),
    topics: Collection[str] = (),
    inside: Collection[tuple[Outline, Pos]] = (),
) -> Qos | None:
    """Return the quality of service in a call at a position; None if it is not constant.

    `others` are the outlines of all modules of the program, which may define the profile. If the call is a call of
    a wrapper, `inside` are the calls that the wrapper makes. A profile may be a variable of a wrapper. Its value is
    then taken from the tables and calls that contain it beside one of the `topics`, or else from all calls of the
    wrapper.
    """
    call = outline.call(pos)
    if call is None:
        return None
    if last_name(call.func) not in (*_PLACES, _FILTER):
        made = ((where, where.call(at)) for where, at in inside)
        return next(
            (_through(call, outline, where, one, others) for where, one in made if one and _given(one)), None
        )
    given = _given(call) if isinstance(call.func, ast.Attribute) else None
    if given is None:
        return None
    found = _anywhere(given, outline, others)
    if found is None and isinstance(given, ast.Name | ast.Starred | ast.Subscript | ast.Attribute):
        return _beside(topics, outline, others) or _passed(last_name(given), call, outline, others)
    return found


def _given(call: ast.Call) -> ast.expr | None:
    """Return the profile in a call that makes a publisher or subscription; None for other calls."""
    place = _PLACES.get(last_name(call.func))
    named = next((one.value for one in call.keywords if one.arg in ("qos_profile", "qos")), None)
    if last_name(call.func) == _FILTER:
        if len(call.args) < _OF_NODE:
            return None
        return named if named is not None else ast.Constant(_DEPTH)
    # a launch file may change a profile whose call allows it
    if place is None or any(one.arg == "qos_overriding_options" for one in call.keywords):
        return None
    return named if named is not None else call.args[place] if len(call.args) > place else None


def _through(
    call: ast.Call, outline: Outline, where: Outline, made: ast.Call, others: Collection[Outline]
) -> Qos | None:
    """Return the quality of service of a subscription made by a wrapper."""
    given = _given(made)
    found = None if given is None else _anywhere(given, where, others)
    function = _function_around(made, where)
    if found is not None or given is None or function is None or function.name != last_name(call.func):
        return found
    value = _argument(call, function, last_name(given))
    return None if value is None else _anywhere(value, outline, others)


def _function_around(node: ast.AST, outline: Outline) -> ast.FunctionDef | None:
    return next((one for one in outline.around(node) if isinstance(one, ast.FunctionDef)), None)


def _argument(call: ast.Call, function: ast.FunctionDef, name: str) -> ast.expr | None:
    """Return the argument of a call for a parameter; None if unknown."""
    plain = [one.arg for one in function.args.args]
    given = next((word.value for word in call.keywords if word.arg == name), None)
    if given is not None or any(isinstance(one, ast.Starred) for one in call.args):
        return given
    defaults = dict(zip(reversed(plain), reversed(function.args.defaults), strict=False))
    keywords = zip(function.args.kwonlyargs, function.args.kw_defaults, strict=True)
    defaults |= {one.arg: value for one, value in keywords if value is not None}
    place = plain.index(name) - (plain[0] in ("self", "cls")) if name in plain else len(call.args)
    return call.args[place] if place < len(call.args) else defaults.get(name)


def _anywhere(expr: ast.expr, outline: Outline, others: Collection[Outline]) -> Qos | None:
    """Return the quality of service of an expression."""
    found = _of(expr, outline, 0)
    name = last_name(expr.func if isinstance(expr, ast.Call) else expr)
    if found is None and name not in outline.assigned and not _functions(name, outline):
        defining = [
            one for one in others if one is not outline and (name in one.assigned or _functions(name, one))
        ]
        return _of(expr, defining[0], 0) if len(defining) == 1 else None
    return found


def _beside(topics: Collection[str], outline: Outline, others: Collection[Outline]) -> Qos | None:
    """Return the only quality of service beside a topic in a row or call."""
    found = [
        [one for part in row if (one := _anywhere(part, where, others)) is not None]
        for where in (outline, *(one for one in others if one is not outline))
        for row in rows(topics, where)
        if len(row) >= _ROW
    ]
    profiles = [profile for row in found for profile in row]
    alike = bool(profiles) and all(len(row) == 1 and row[0] == profiles[0] for row in found)
    return profiles[0] if alike else None


def _either(one: Qos | None, other: Qos | None) -> Qos | None:
    """Return the policies that two possible profiles have in common."""
    if one is None or other is None:
        return None
    return Qos(
        one.reliable if one.reliable == other.reliable else None,
        one.latched if one.latched == other.latched else None,
    )


def _passed(name: str, call: ast.Call, outline: Outline, others: Collection[Outline]) -> Qos | None:
    """Return the only quality of service that calls pass for a parameter."""
    function = _function_around(call, outline)
    if function is None or name not in [one.arg for one in (*function.args.args, *function.args.kwonlyargs)]:
        return None
    found: set[Qos | None] = set()
    for where in (outline, *(one for one in others if one is not outline)):
        calls = [one for same in where.calls.values() for one in same if last_name(one.func) == function.name]
        for value in (_argument(one, function, name) for one in calls):
            found.add(None if value is None else _anywhere(value, where, others))
    return found.pop() if len(found) == 1 else None


def _functions(name: str, outline: Outline) -> list[ast.FunctionDef]:
    return [one for one in outline.definitions if isinstance(one, ast.FunctionDef) and one.name == name]


def _returned(call: ast.Call, outline: Outline, depth: int) -> Qos | None:
    """Return the constant profile that a function returns."""
    functions = _functions(last_name(call.func), outline)
    returned = [
        one.value for each in functions for one in ast.walk(each) if isinstance(one, ast.Return) and one.value
    ]
    return _of(returned[0], outline, depth + 1) if len(functions) == len(returned) == 1 else None


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
        return _profile(expr, outline)
    if isinstance(expr, ast.Call) and depth < 3:
        return _returned(expr, outline, depth)
    if isinstance(expr, ast.IfExp):
        return _either(_of(expr.body, outline, depth + 1), _of(expr.orelse, outline, depth + 1))
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
    """Return `SENSOR_DATA` for `QoSPresetProfiles.SENSOR_DATA.value` or its short key; "" for other expressions."""
    match expr:
        case ast.Attribute(attr="value", value=ast.Attribute(value=enumeration, attr=name)) if (
            last_name(enumeration) == "QoSPresetProfiles"
        ):
            return name
        case ast.Call(func=ast.Attribute(attr="get_from_short_key"), args=[ast.Constant(value=str(key))]):
            return key.upper()
    return ""


def _table(expr: ast.expr, outline: Outline) -> dict[str, ast.expr] | None:
    """Return the entries of a mapping; None if unknown."""
    if isinstance(expr, ast.Name | ast.Attribute):
        values = outline.assigned.get(last_name(expr), [])
        return (
            _table(values[0], outline)
            if len(values) == 1 and isinstance(values[0], ast.Dict | ast.Call)
            else None
        )
    if isinstance(expr, ast.Call) and last_name(expr.func) == "dict" and not expr.args:
        named = {one.arg: one.value for one in expr.keywords if one.arg}
        return named if len(named) == len(expr.keywords) else None
    if not isinstance(expr, ast.Dict):
        return None
    keys = [one.value for one in expr.keys if isinstance(one, ast.Constant) and isinstance(one.value, str)]
    return dict(zip(keys, expr.values, strict=True)) if len(keys) == len(expr.keys) else None


def _profile(call: ast.Call, outline: Outline) -> Qos | None:
    stated: dict[str, ast.expr] = {}
    for one in call.keywords:
        table = {one.arg: one.value} if one.arg else _table(one.value, outline)
        if table is None:
            return None
        stated |= table
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
    """Return a profile with the policies that are set once after its creation."""
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
