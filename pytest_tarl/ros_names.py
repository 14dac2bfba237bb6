"""The rules for names of topics, services and nodes in both ROS generations; characters are ASCII.

ROS 1: wiki.ros.org/Names, rosgraph/names.py and rosmaster/validators.py. ROS 2: design.ros2.org, "Topic and Service
name mapping to DDS", as checked by rcl_validate_topic_name and rmw_validate_*.
"""

from __future__ import annotations

import re
from collections.abc import Callable

Problem = tuple[str, int]  # (description, index of the wrong character)

_LEGAL_ROS1 = re.compile(r"[~/A-Za-z][A-Za-z0-9_/]*")
# maximum length of a topic's or service's absolute name: DDS allows 255 characters, of which a prefix takes 8
_TOPIC_LENGTH = 247
_NODE_LENGTH = 255
_NAMESPACE_LENGTH = 245  # leaves room for a slash and a topic of one character within _TOPIC_LENGTH


def objection(name: object) -> str:
    """Return why no node in either ROS can have a topic or service of this name, or an empty text.

    The text starts with "must". Names that rospy accepts with a warning, such as `/cam-1`, are accepted.
    """
    if not isinstance(name, str):
        return f"must be a text, not {name!r}"
    if not name.strip("/"):
        return f"must not be empty, got {name!r}"
    if name.startswith("~"):
        return (
            f"must not be private: give the full name instead of {name!r}, such as '/node/{name.strip('~/')}'"
        )
    bad = next((one for one in name if one in ":~{}" or one.isspace() or not one.isprintable()), "")
    return f"must consist of letters, digits, '_' and '/', without {bad!r}, got {name!r}" if bad else ""


def is_legal_ros1(name: str) -> bool:
    """Return whether a name follows the rules of ROS 1; rospy warns about names that do not."""
    return bool(_LEGAL_ROS1.fullmatch(name)) and "//" not in name


def is_refused_by_master(name: str) -> bool:
    """Return whether the ROS 1 master rejects a topic or service of this name."""
    return " " in name or ":" in name


def topic_problem(name: str) -> Problem | None:
    """Return what rcl finds wrong with a name, which may be relative or have `~` and `{node}` substitutions."""
    if not name:
        return "topic name must not be empty string", 0
    if name[0] in "0123456789":
        return "topic name token must not start with a number", 0
    if name.endswith("/"):
        return "topic name must not end with a forward slash", len(name) - 1
    if (bad := _stray_in_topic(name)) is not None:
        return bad
    if name[0] == "~" and len(name) > 2 and name[1] != "/":
        return "topic name must not have a tilde '~' that is not followed by a forward slash '/'", 1
    return _numbered(name, "topic name token must not start with a number")


def full_topic_problem(name: str) -> Problem | None:
    """Return what rmw finds wrong with the absolute name of a topic or service."""
    return (
        _absolute_problem(name, "topic name", "topic name must not end with a '/'")
        or _numbered(name, "topic name must not have a token that starts with a number")
        or _too_long(name, _TOPIC_LENGTH, "topic length should not exceed '255U - 8U'")
    )


def namespace_problem(name: str) -> Problem | None:
    """Return what rmw finds wrong with the absolute name of a namespace."""
    if name == "/":
        return None
    return (
        _absolute_problem(name, "namespace", "namespace must not end with a '/', unless only a '/'")
        or _numbered(name, "namespace must not have a token that starts with a number")
        or _too_long(name, _NAMESPACE_LENGTH, "namespace should not exceed 'RMW_NAMESPACE_MAX_NAME_LENGTH'")
    )


def node_problem(name: str) -> Problem | None:
    """Return what rmw finds wrong with the name of a node."""
    if not name:
        return "node name must not be empty", 0
    said = "node name must not contain characters other than alphanumerics or '_'"
    if name[0].isdigit() and _is_word(name[0]):
        return _stray(name, _is_word, said) or ("node name must not start with a number", 0)
    return _stray(name, _is_word, said) or _too_long(
        name, _NODE_LENGTH, f"node name length should not exceed '{_NODE_LENGTH}'"
    )


def _stray_in_topic(name: str) -> Problem | None:
    """Return the first misplaced character; a substitution is a name in braces."""
    unbalanced = "topic name must not have unmatched (unbalanced) curly braces '{}'"
    opened: int | None = None
    for at, one in enumerate(name):
        if one == "~" and at:
            return "topic name must not have tilde '~' unless it is the first character", at
        if opened is not None:
            if one == "}":
                opened = None
            elif problem := _stray_in_substitution(one, first=at == opened + 1):
                return problem, at
        elif one == "{":
            opened = at
        elif one == "}":
            return unbalanced, at
        elif one not in "~/" and not _is_word(one):
            said = "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}'"
            return said, at
    return (unbalanced, opened) if opened is not None else None


def _stray_in_substitution(one: str, *, first: bool) -> str:
    if not _is_word(one):
        return "substitution name must not contain characters other than alphanumerics or '_'"
    return "substitution name must not start with a number" if first and one.isdigit() else ""


def _absolute_problem(name: str, what: str, slash_at_end: str) -> Problem | None:
    if not name:
        return f"{what} must not be empty", 0
    if name[0] != "/":
        return f"{what} must be absolute, it must lead with a '/'", 0
    if name.endswith("/"):
        return slash_at_end, len(name) - 1
    said = f"{what} must not contain characters other than alphanumerics, '_', or '/'"
    stray = _stray(name, lambda one: one == "/" or _is_word(one), said)
    if stray is None and "//" in name:
        return f"{what} must not contain repeated '/'", name.index("//") + 1
    return stray


def _stray(name: str, allowed: Callable[[str], bool], said: str) -> Problem | None:
    return next(((said, at) for at, one in enumerate(name) if not allowed(one)), None)


def _numbered(name: str, said: str) -> Problem | None:
    token = re.search(r"(?:^|/)[0-9]", name)
    return (said, token.end() - 1) if token is not None else None


def _too_long(name: str, most: int, said: str) -> Problem | None:
    return (said, most) if len(name) > most else None


def _is_word(one: str) -> bool:
    return one.isascii() and (one.isalnum() or one == "_")
