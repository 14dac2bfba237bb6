"""Conditions of launched nodes that are known only on the robot: combine them, and find pairs that exclude each other.

A condition is a text such as `if $(arg real)`, `unless $(arg real)` (ROS 1), `not $(var real)`, `mode == 'sim'`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from typing import Final

from tarl_lint.workspace.launch_model import LaunchedNode

_AND: Final = " and "
_COMPARED: Final = re.compile(r"(.+?)\s*(==|!=)\s*(.+)", re.DOTALL)
_EQUALS: Final = re.compile(r"\$\((not-)?equals (\$\([^()]*\)|\S+) (\$\([^()]*\)|\S+)\)")
_Literal = tuple[str, str | None, bool]  # (tested expression, compared constant, whether they must be equal)


def combined(outer: str, inner: str) -> str:
    """Return the text of two conditions that both hold."""
    for one, other in ((inner, outer), (outer, inner)):
        if f"{_AND}{other}{_AND}" in f"{_AND}{one}{_AND}":
            return one
    return f"{outer}{_AND}{inner}" if outer and inner else outer or inner


def exclusive(one: LaunchedNode, other: LaunchedNode) -> bool:
    """Return whether two nodes are never started together, as with `if` and `unless` of one argument."""
    if not one.condition or not other.condition:
        return False
    return _contradict(one.condition, other.condition, same_file=one.file == other.file)


@lru_cache(maxsize=4096)
def _contradict(one: str, other: str, *, same_file: bool) -> bool:
    literals = [
        {each for each in _literals(text) if same_file or "$(" in each[0]} for text in (one, other)
    ]  # equal names in two files are different variables, unlike texts with `$(`
    return any(_opposite(first, second) for first in literals[0] for second in literals[1])


def _opposite(one: _Literal, other: _Literal) -> bool:
    (subject, constant, holds), (second, other_constant, also) = one, other
    if subject != second or (constant is None) != (other_constant is None):
        return False
    if constant == other_constant:
        return holds is not also
    return holds and also  # one value cannot be equal to two constants


def _literals(text: str) -> Iterator[_Literal]:
    for part in _conjuncts(text):
        yield _literal(part)


def _literal(text: str) -> _Literal:
    holds, text = True, text.strip()
    while (plain := _stripped(text)) != (text, True):
        text, kept = plain
        holds = holds is kept
    alike = _EQUALS.fullmatch(text)
    compared = _COMPARED.fullmatch(text)
    if alike:
        subject, constant, equal = alike[2], alike[3], alike[1] is None
    elif compared:
        subject, constant, equal = compared[1], compared[3], compared[2] == "=="
    else:
        return text, None, holds
    if "$(" in constant and "$(" not in subject:
        subject, constant = constant, subject
    value = constant.strip("'\"")
    if "$(" in value or (compared and not _constant(constant, subject)):
        return text, None, holds
    return subject, value, holds is equal


def _constant(text: str, subject: str) -> bool:
    """Return whether a text is a quoted string or a number, or a word that is compared with a substitution."""
    word = r"|[\w./+-]+" if subject.startswith("$(") else ""
    return re.fullmatch(rf"'[^']*'|\"[^\"]*\"|[+-]?\d[\d.]*{word}", text) is not None


def _stripped(text: str) -> tuple[str, bool]:
    """Return a condition without its outermost operator, and whether its truth stays the same without the operator."""
    for word, kept in (("if ", True), ("unless ", False), ("not ", False)):
        if text.startswith(word):
            return text.removeprefix(word).strip(), kept
    for start, kept in (("$(eval ", True), ("$(not ", False), ("(", True)):
        if text.startswith(start) and _end(text, start.index("(")) == len(text) - 1:
            return text[len(start) : -1].strip(), kept
    return text, True


def _conjuncts(text: str) -> Iterator[str]:
    """Split a condition at each `and` outside parentheses."""
    depth = start = 0
    for index, letter in enumerate(text):
        depth += {"(": 1, ")": -1}.get(letter, 0)
        if not depth and text.startswith(_AND, index):
            yield text[start:index]
            start = index + len(_AND)
    yield text[start:]


def _end(text: str, start: int) -> int:
    """Return the index of the parenthesis that closes the one at `start`; -1 if there is none."""
    depth = 0
    for index in range(start, len(text)):
        depth += {"(": 1, ")": -1}.get(text[index], 0)
        if not depth:
            return index
    return -1
