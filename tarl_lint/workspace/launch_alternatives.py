"""Values that depend on a condition known only on the robot."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from typing import Any, Final

from tarl_lint.workspace.conditions import combined
from tarl_lint.workspace.launch_actions import Action
from tarl_lint.workspace.launch_values import Substitution
from tarl_lint.workspace.python.elements import plain
from tarl_lint.workspace.python.evaluator import Unknown

LONGEST: Final = 60  # maximum length of conditions and values in a symbolic text (characters)
ABSENT: Final = Unknown(0, "nothing")  # stands for an unbound name or a missing element
_OPPOSITE: Final[Mapping[type[ast.cmpop], type[ast.cmpop]]] = {
    ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
}  # fmt: skip


def negated(text: str) -> str:
    """Return the text of the opposite condition."""
    tree = _parsed(text)
    if isinstance(tree, ast.UnaryOp) and isinstance(tree.op, ast.Not):
        return ast.unparse(tree.operand)
    if isinstance(tree, ast.Compare) and len(tree.ops) == 1 and type(tree.ops[0]) in _OPPOSITE:
        opposite = _OPPOSITE[type(tree.ops[0])]()
        return ast.unparse(ast.Compare(tree.left, [opposite], tree.comparators))
    simple = isinstance(tree, ast.Name | ast.Attribute | ast.Call | ast.Subscript)
    return f"not {text}" if simple else f"not ({text if tree is None else ast.unparse(tree)})"


def closed(text: str) -> str:
    """Return a condition in a form that can be combined with others."""
    tree = _parsed(text)
    return f"({text})" if tree is None or isinstance(tree, ast.BoolOp | ast.IfExp | ast.Lambda) else text


def _parsed(text: str) -> ast.expr | None:
    try:
        return ast.parse(text, mode="eval").body
    except SyntaxError:  # the condition was longer than LONGEST and was cut off
        return None


def conditional(value: Any, condition: str, line: int) -> Any:
    """Return a conditional value: actions become conditional, data unknown."""
    if isinstance(value, Action):
        assumed = combined(condition, value.values.get("assumed", ""))
        if assumed == value.values.get("assumed"):
            return value
        return Action("group", value.line, {"actions": [value], "assumed": condition})
    if isinstance(value, tuple) and len(value) == 2 and plain(value[0]):
        # only the second element of a pair becomes conditional
        return value[0], conditional(value[1], condition, line)
    if isinstance(value, list | tuple):
        return type(value)(conditional(one, condition, line) for one in value)
    if isinstance(value, dict):
        return {key: conditional(one, condition, line) for key, one in value.items()}
    if plain(value) or isinstance(value, Substitution):
        return Unknown(line, f"{_text(value)} if {condition}")
    return value


def either(one: Any, other: Any, text: str, line: int) -> Any:
    """Return the value that is `one` under a condition, and else `other`."""
    return one_of([(text, one), (negated(text), other)], line)


def one_of(values: list[tuple[str, Any]], line: int) -> Any:
    """Return one of several values with exclusive conditions."""
    if all(_actions(one) for _, one in values):
        return _one_of_actions(values, line)
    (text, one), *others = values
    for other_text, other in others:
        one = _one_of_two(one, other, text, other_text, line)
    return one


def _one_of_two(one: Any, other: Any, text: str, other_text: str, line: int) -> Any:
    if one is other or (plain(one) and plain(other) and one == other):
        return one
    if one is ABSENT or other is ABSENT:
        return conditional(*((other, other_text) if one is ABSENT else (one, text)), line)
    if _remaps(one) and _remaps(other):
        return list(_one_of_two(dict(one), dict(other), text, other_text, line).items())
    for kind in (list, tuple):
        if isinstance(one, kind) and isinstance(other, kind):
            many = max(len(one), len(other))
            pairs = zip(_filled(one, many), _filled(other, many), strict=True)
            return kind(one_of([(text, first), (other_text, second)], line) for first, second in pairs)
    if isinstance(one, dict) and isinstance(other, dict):
        keys = [*one, *(key for key in other if key not in one)]
        return {
            key: one_of([(text, one.get(key, ABSENT)), (other_text, other.get(key, ABSENT))], line)
            for key in keys
        }
    if _data(one) and _data(other):
        return Unknown(line, f"{_text(one)} if {text} else {_text(other)}")
    # of several functions, classes or modules, the first known one is used
    return one if not isinstance(one, Unknown) else other


def _remaps(value: Any) -> bool:
    """Return whether a value is a list of pairs that begin with a string."""
    return isinstance(value, list) and all(
        isinstance(one, tuple) and len(one) == 2 and isinstance(one[0], str) for one in value
    )


def _actions(value: Any) -> bool:
    """Return whether a value is an action, several of them, or nothing."""
    if isinstance(value, list | tuple):
        return all(isinstance(one, Action) for one in value)
    return value is None or value is ABSENT or isinstance(value, Action)


def _one_of_actions(values: list[tuple[str, Any]], line: int) -> Any:
    """Return the common actions, and the others as conditional ones."""
    lists = [_listed(one) for _, one in values]
    groups = [one[0] for one in lists if len(one) == 1 and _plain_group(one[0])]
    if len(groups) == len(values) and len({id(one) for one in groups}) > 1:
        inner = [(text, one.values["actions"]) for (text, _), one in zip(values, groups, strict=True)]
        return Action("group", groups[0].line, {"actions": _one_of_actions(inner, line)})
    common = set.intersection(*({id(each) for each in one} for one in lists))
    found: list[Any] = []
    for (text, _), one in zip(values, lists, strict=True):
        found += [each if id(each) in common else conditional(each, text, line) for each in one
                  if id(each) not in common or each not in found]  # fmt: skip
    if any(isinstance(one, list | tuple) for _, one in values):
        return found
    return None if not found else found[0] if len(found) == 1 else Action("group", line, {"actions": found})


def _plain_group(action: Action) -> bool:
    """Return whether an action is a launch description that contains nothing but actions."""
    return action.kind == "group" and set(action.values) <= {"actions", "assumed"}


def _listed(value: Any) -> list[Any]:
    if isinstance(value, list | tuple):
        return list(value)
    return [value] if isinstance(value, Action) else []


def _filled(values: list[Any] | tuple[Any, ...], many: int) -> Iterator[Any]:
    yield from values
    yield from [ABSENT] * (many - len(values))


def _data(value: Any) -> bool:
    """Return whether a value is data, and not a function, class or module."""
    return isinstance(value, Unknown | Substitution | list | tuple | dict) or plain(value)


def _text(value: Any) -> str:
    if isinstance(value, Unknown):
        return value.text[:LONGEST]
    return repr(value)[:LONGEST] if plain(value) else "…"
