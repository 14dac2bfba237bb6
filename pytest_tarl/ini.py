"""TARL's flags as ini options: `--tarl-alpha=0.01` is `tarl_alpha = 0.01`. The command line takes precedence."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from pytest_tarl.errors import SettingsError
from pytest_tarl.flags import FLAGS, Flag

SWITCHES = {
    "true": True,
    "yes": True,
    "on": True,
    "1": True,
    "false": False,
    "no": False,
    "off": False,
    "0": False,
}
MODES = ("record", "online", "repair", "stress")
# option → modes that use it; other modes ignore its ini value
WITHIN: Mapping[str, tuple[str, ...]] = {
    "drift": ("record", "online", "stress"),
    "resume": ("record", "online", "stress"),
    "search": ("repair",),
    "localize": ("repair",),
    "strict": ("online", "stress"),
    "holm": ("online",),
    "log": ("online",),
    "bag": ("online",),
}


def declare(parser: pytest.Parser) -> None:
    """Declare an ini option for each flag."""
    for flag in FLAGS:
        about = f"as {flag.name}: {flag.help}"
        if flag.many:
            parser.addini(ini_name(flag), about, "linelist", None)
        else:
            parser.addini(ini_name(flag), about, "string", None)


def ini_name(flag: Flag) -> str:
    """Return the name of a flag in an ini file."""
    return flag.name.removeprefix("--").replace("-", "_")


def mode_asked(config: pytest.Config) -> bool:
    """Return whether the command line has a flag that starts a TARL run, or the ini file selects a mode.

    Raise SettingsError for an invalid value in the ini file.
    """
    if any(config.getoption(flag.name) for flag in FLAGS if flag.asks):
        return True
    return any(_from_ini(config, flag) for flag in FLAGS if flag.key in MODES)


def value_of(config: pytest.Config, key: str) -> Any:
    """Return a flag's value: from the command line, the ini file, or its default. Raise SettingsError if invalid."""
    flag = next(flag for flag in FLAGS if flag.key == key)
    typed = config.getoption(flag.name)
    if typed not in (None, False):
        return typed
    found = _from_ini(config, flag)
    return found if found is not None else flag.unset


def values(config: pytest.Config) -> tuple[dict[str, Any], list[Flag]]:
    """Return key → value for all flags, and the flags that the ini file sets.

    Raise SettingsError for an invalid value.
    """
    found = {flag.key: value_of(config, flag.key) for flag in FLAGS}
    chosen = [flag for flag in FLAGS if config.getoption(flag.name) in (None, False)]
    for flag in chosen:
        if flag.key in WITHIN and not any(found[mode] for mode in WITHIN[flag.key]):
            found[flag.key] = flag.unset
    return found, [flag for flag in chosen if found[flag.key] not in (None, flag.unset)]


def _from_ini(config: pytest.Config, flag: Flag) -> Any:
    name = ini_name(flag)
    try:
        text = config.getini(name)
    except (TypeError, ValueError) as error:  # the TOML value is of another type
        raise SettingsError(f"{config.inipath}: {name}: {error}") from None
    if text is None or text == []:
        return None
    if flag.many:
        return [_resolved(config, flag, line) for line in text]
    text = text.strip()
    if flag.metavar is None:
        if text.lower() not in SWITCHES:
            raise SettingsError(f"{config.inipath}: {name}: it must be true or false, got {text!r}.")
        return SWITCHES[text.lower()]
    try:
        return _resolved(config, flag, flag.type(text))
    except ValueError:
        what = "a whole number" if flag.type is int else "a number"
        raise SettingsError(f"{config.inipath}: {name}: it must be {what}, got {text!r}.") from None


def _resolved(config: pytest.Config, flag: Flag, value: Any) -> Any:
    """Resolve a path in an ini file relative to the file's folder."""
    return str(config.rootpath / value) if flag.metavar == "FILE" else value
