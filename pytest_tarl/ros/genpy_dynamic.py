"""`genpy.dynamic`: build message classes from the full definition in a bag or topic header."""

from __future__ import annotations

import re
from typing import Any

from pytest_tarl.ros.messages import ros1
from pytest_tarl.ros.messages.type_definitions import parse

__all__ = ["generate_dynamic"]


def generate_dynamic(core_type: str, msg_cat: str) -> dict[str, Any]:
    """Return the classes of a message type and of all types in its full definition, by name."""
    first, *others = re.split(r"^={3,}\s*$", msg_cat, flags=re.MULTILINE)
    texts = {core_type: first}
    for other in others:
        header, _, text = other.strip().partition("\n")
        texts[header.removeprefix("MSG:").strip()] = text
    made: dict[str, Any] = {}
    # reversed, because the text has each type before the types of its fields
    for name in reversed(texts):
        package, _, short = name.partition("/")
        known = ros1.message_class(package, short)
        made[name] = known or ros1.build(parse("ros1", package, short, texts[name]), f"{package}.msg")
        ros1.CARRIED.setdefault(name, made[name])
    return made
