"""Find the literal quality of service of C++ endpoints."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Final

from tarl_lint.system.model import Qos

_DEFAULT: Final = Qos(reliable=True, latched=False)
_SENSORS: Final = Qos(reliable=False, latched=False)
_NAME: Final = re.compile(r"[A-Za-z_]\w*")
_CHANGES: Final = (
    (re.compile(r"\bbest_effort\s*\(|\bBestEffort\b|RELIABILITY_BEST_EFFORT"), "reliable", False),
    (re.compile(r"\breliable\s*\(|\bReliabilityPolicy::Reliable\b|RELIABILITY_RELIABLE"), "reliable", True),
    (re.compile(r"\btransient_local\s*\(|\bTransientLocal\b|DURABILITY_TRANSIENT_LOCAL"), "latched", True),
    (re.compile(r"\bdurability_volatile\s*\(|\bDurabilityPolicy::Volatile\b|DURABILITY_VOLATILE"), "latched", False),
)  # fmt: skip


def after_name(text: str, place: int) -> Qos | None:
    """Return the quality of service after a topic's name in a file."""
    comma = re.compile(r"\s*,").match(text, place)
    return None if comma is None else _of(_argument(text, comma.end()), text)


def _argument(text: str, place: int) -> str:
    """Return the argument of a call that begins at a place."""
    depth = 0
    for at in range(place, min(len(text), place + 500)):
        depth += (text[at] in "([{") - (text[at] in ")]}")
        if depth < 0 or (depth == 0 and text[at] == ","):
            return text[place:at].strip()
    return ""


def _of(argument: str, text: str) -> Qos | None:
    if argument.isdecimal():
        return _DEFAULT
    if _NAME.fullmatch(argument):
        made = re.findall(rf"\b{argument}\s*(?:=(?!=)|\(|\{{)([^;]*);", text)
        if len(made) != 1:
            return None
        qos = _stated(made[0], declared=f"QoS {argument}" in text)
        changes = " ".join(re.findall(rf"\b{argument}\s*\.([^;]*);", text))
        return None if qos is None else _changed(qos, changes)
    return _stated(argument, declared=False)


def _stated(value: str, *, declared: bool) -> Qos | None:
    """Return an expression's profile; with `declared`, it may be a declaration's depth."""
    if "SensorDataQoS" in value or "qos_profile_sensor_data" in value:
        return _changed(_SENSORS, value)
    if "SystemDefaultsQoS" in value or "ServicesQoS" in value or "from_rmw" in value:
        return None
    if re.match(r"(?:rclcpp::)?QoS\s*[({]", value) or (
        declared and re.match(r"\d+\)|(?:rclcpp::)?KeepLast", value)
    ):
        return _changed(_DEFAULT, value)
    return None


def _changed(qos: Qos, text: str) -> Qos:
    for pattern, part, value in _CHANGES:
        if pattern.search(text):
            qos = replace(qos, **{part: value})
    return qos
