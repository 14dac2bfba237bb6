"""The keys of `[tool.tarl-lint]` and the types of their values."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal, get_args

FailOn = Literal["never", "hazard", "explicit", "implicit"]

BASELINE_NAME: Final = "tarl-flows.json"
FAIL_ON: Final[tuple[FailOn, ...]] = get_args(FailOn)


@dataclass(frozen=True)
class Wrapper:
    """A function that does the same as the ROS function `like`. The other fields give the places of its arguments.

    A number is a position, and a string is a keyword. None means the same place as in `like`.
    """

    name: str
    like: str
    topic: int | str | None = None
    type: int | str | None = None
    callback: int | str | None = None
    extra: int | str | None = None


def _texts(value: Any) -> tuple[str, ...] | None:
    texts = isinstance(value, list) and all(isinstance(v, str) and v for v in value)
    return tuple(value) if texts else None


def _patterns(value: Any) -> tuple[str, ...] | None:
    patterns = _texts(value)
    for pattern in patterns or ():
        check_pattern(pattern)
    return patterns


def check_pattern(pattern: str) -> str:
    """Return a pattern. Raises ValueError for a pattern with backslashes, because it would match nothing."""
    if re.search(r"\\(\w|$)", pattern):
        meant = pattern.replace("\\", "/")
        raise ValueError(f"{pattern!r} has backslashes: write it with slashes, as in .gitignore: {meant!r}.")
    return pattern


def _codes(value: Any) -> tuple[str, ...] | None:
    codes = _texts(value)
    return codes and tuple(code.upper() for code in codes) if codes is not None else None


def _names(value: Any) -> tuple[str, ...] | None:
    """Return dotted names such as `robot.bus.listen`; None if one of them has no module."""
    names = _texts(value)
    good = names is not None and all("." in name and _identifiers(name) for name in names)
    return names if good else None


def _packages(value: Any) -> tuple[str, ...] | None:
    """Return names of packages as imported; None if one of them contains dots."""
    names = _texts(value)
    return names if names is not None and all(name.isidentifier() for name in names) else None


def _identifiers(name: str) -> bool:
    return all(part.isidentifier() for part in name.split("."))


def _per_file(value: Any) -> tuple[tuple[str, tuple[str, ...]], ...] | None:
    if not isinstance(value, dict):
        return None
    checked = [(check_pattern(pattern), _codes(codes)) for pattern, codes in value.items()]
    return (
        tuple((pattern, codes) for pattern, codes in checked if codes) if all(c for _, c in checked) else None
    )


def _wrappers(value: Any) -> tuple[Wrapper, ...] | None:
    if not isinstance(value, dict):
        return None
    made = [_wrapper(name, spec) for name, spec in value.items()]
    return tuple(w for w in made if w) if all(made) else None


def _wrapper(name: str, spec: Any) -> Wrapper | None:
    spec = {"like": spec} if isinstance(spec, str) else spec
    unknown = [key for key in spec if key not in _WRAPPER_KEYS] if isinstance(spec, dict) else []
    if unknown:
        keys = ", ".join(sorted(_WRAPPER_KEYS))
        raise ValueError(f"the wrapper {name!r} has no key {unknown[0]!r}: its keys are {keys}.")
    known = isinstance(spec, dict) and isinstance(spec.get("like"), str)
    if not known or _names([name]) is None:
        return None
    places = {key: place for key, place in spec.items() if key != "like"}
    return Wrapper(name, spec["like"], **places) if all(map(_place, places.values())) else None


def _remaps(value: Any) -> tuple[tuple[str, str], ...] | None:
    good = isinstance(value, dict) and all(_text(old) and _text(new) for old, new in value.items())
    return tuple(value.items()) if good else None


def _place(value: Any) -> bool:
    """Return whether a value is the place of an argument: a position from 0 or a keyword."""
    return (type(value) is int and value >= 0) or (isinstance(value, str) and value.isidentifier())


_WRAPPER_KEYS: Final = frozenset({"like", "topic", "type", "callback", "extra"})


def _text(value: Any) -> str | None:
    return value if isinstance(value, str) and value else None


def _switch(value: Any) -> bool | None:
    return value if isinstance(value, bool) else None


def _fail_on(value: Any) -> str | None:
    return value if value in FAIL_ON else None


KEYS: Final[Mapping[str, tuple[Callable[[Any], Any], str]]] = {
    "select": (_codes, 'a list of rule codes such as ["TARL1"]'),
    "extend-select": (_codes, 'a list of rule codes such as ["TARL103"]'),
    "ignore": (_codes, 'a list of rule codes such as ["TARL102"]'),
    "exclude": (_patterns, 'a list of patterns as in .gitignore, such as ["vendor/"]'),
    "baseline": (_text, f'the name of a file, such as "{BASELINE_NAME}"'),
    "per-file-ignores": (_per_file, 'a table of patterns and rule codes, such as {"tests/" = ["TARL1"]}'),
    "sources": (_names, 'a list of qualified names of functions, such as ["robot.bus.listen"]'),
    "sinks": (_names, 'a list of qualified names of functions, such as ["robot.bus.send"]'),
    "sanitizers": (_names, 'a list of qualified names of functions, such as ["robot.safety.clamp"]'),
    "wrappers": (
        _wrappers,
        'a table such as {"bus.listen" = "rospy.Subscriber", "bus.talk" = {like = "rospy.Publisher", topic = 1}}',
    ),
    "follow-installed": (_packages, 'a list of packages that are installed, such as ["robot_base"]'),
    "python": (_text, 'the virtual environment that holds them, such as ".venv"'),
    "remaps": (
        _remaps,
        'a table from topics in the code to topics on the robot, such as {"scan" = "/front/scan"}',
    ),
    "tf2": (_switch, "true or false"),
    "clients": (_switch, "true or false"),
    "arrivals": (_switch, "true or false"),
    "fail-on": (_fail_on, f"one of {', '.join(map(repr, FAIL_ON))}"),
}
