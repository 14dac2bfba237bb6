"""Convert configurations between attribute dictionaries and dynamic_reconfigure/Config messages."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.dynamic_reconfigure import DynamicReconfigureParameterException
from pytest_tarl.ros.messages import message_type

_KINDS = (("bools", bool), ("ints", int), ("doubles", float), ("strs", str))
_TYPES = {"bool": bool, "int": int, "double": float, "str": str}


class Config(dict[str, Any]):
    """A configuration, as in `config.speed` and `config["speed"]`; here, `groups` is always empty."""

    def __getattr__(self, name: str) -> Any:
        if name == "groups":
            return {}
        try:
            return self[name]
        except KeyError as error:
            raise AttributeError(name) from error

    def __setattr__(self, name: str, value: Any) -> None:
        self[name] = value


def described(config_type: Any) -> dict[str, dict[str, Any]]:
    """Return the description of each parameter in a generated configuration module, without groups."""
    found = {}
    groups = [config_type.config_description]
    while groups:
        group = groups.pop()
        found.update({one["name"]: one for one in group.get("parameters", ())})
        groups += group.get("groups", ())
    return found


def checked(config_type: Any, given: dict[str, Any]) -> Config:
    """Convert values to their parameters' types, and clip them to the limits.

    Raise DynamicReconfigureParameterException for an unknown parameter.
    """
    known = described(config_type)
    config = Config()
    for name, value in given.items():
        if name == "groups":
            continue
        if name not in known:
            raise DynamicReconfigureParameterException(f"don't know parameter: {name}")
        one = known[name]
        made = _TYPES[one["type"]](value)
        if one["type"] in ("int", "double"):
            made = min(max(made, one.get("min", made)), one.get("max", made))
        config[name] = made
    return config


def level_of(config_type: Any, old: dict[str, Any], new: dict[str, Any]) -> int:
    """Return the bitwise or of all changed parameters' levels."""
    level = 0
    for name, one in described(config_type).items():
        if old.get(name) != new.get(name):
            level |= int(one.get("level", 0))
    return level


def encode_config(config: dict[str, Any]) -> Any:
    """Encode a configuration as dynamic_reconfigure/Config."""
    message: Any = message_type("dynamic_reconfigure/Config")()
    for name, value in config.items():
        for field, kind in _KINDS:
            if type(value) is kind:
                one = message_type(f"dynamic_reconfigure/{field[:-1].capitalize()}Parameter")(name, value)
                getattr(message, field).append(one)
    return message


def decode_config(message: Any) -> Config:
    """Decode the values of a dynamic_reconfigure/Config."""
    return Config({one.name: one.value for field, _ in _KINDS for one in getattr(message, field)})
