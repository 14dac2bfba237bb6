"""Parse values on a ROS command line (scalars and flow collections of YAML)."""

from __future__ import annotations

import ast
from typing import Any

_WORDS = {
    "true": True,
    "yes": True,
    "on": True,
    "false": False,
    "no": False,
    "off": False,
    "null": None,
    "~": None,
}


def parse_value(text: str) -> Any:
    """Parse a number, boolean, list or string as `rosrun … _gain:=2.5` and `-p gain:=2.5` do."""
    text = text.strip()
    if text.lower() in _WORDS:
        return _WORDS[text.lower()]
    if text.startswith("[") and text.endswith("]"):
        return [parse_value(item) for item in text[1:-1].split(",") if item.strip()]
    try:
        value = ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return text
    return value if isinstance(value, bool | int | float | str) else text
