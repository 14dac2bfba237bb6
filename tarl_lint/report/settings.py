"""The settings in use, in the format of a settings file, with the origin of each."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from tarl_lint.files import shown
from tarl_lint.report.line import Line
from tarl_lint.settings.config import Config
from tarl_lint.settings.schema import Wrapper


def settings(config: Config) -> Iterator[Line]:
    """Yield the settings file, then one setting per line."""
    origins = dict(config.origins)
    yield ((f"# settings file: {shown(config.file) if config.file else 'none'}", "quiet"),)
    yield ((f"# relative to:   {(config.root or Path.cwd()).as_posix()}", "quiet"),)
    for key, value in _values(config).items():
        text = f"{key} = {_toml(value)}" if value is not None else f"# no {key}"
        yield ((f"{text:<40}", ""), (f"  # {origins.get(key, 'default')}", "quiet"))


def _values(config: Config) -> Mapping[str, Any]:
    return {
        "select": list(config.select),
        "extend-select": list(config.extend_select),
        "ignore": list(config.ignore),
        "exclude": list(config.exclude),
        "per-file-ignores": {pattern: list(codes) for pattern, codes in config.per_file_ignores},
        "baseline": shown(config.baseline) if config.baseline else None,
        "sources": list(config.sources),
        "sinks": list(config.sinks),
        "sanitizers": list(config.sanitizers),
        "wrappers": {wrapper.name: _wrapper(wrapper) for wrapper in config.wrappers},
        "remaps": dict(config.remaps),
        "tf2": config.tf2,
        "clients": config.clients,
        "arrivals": config.arrivals,
        "fail-on": config.fail_on,
    }


def _wrapper(wrapper: Wrapper) -> str | Mapping[str, int | str]:
    places = {
        "topic": wrapper.topic,
        "type": wrapper.type,
        "callback": wrapper.callback,
        "extra": wrapper.extra,
    }
    given = {key: place for key, place in places.items() if place is not None}
    return {"like": wrapper.like, **given} if given else wrapper.like


def _toml(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(key)} = {_toml(item)}" for key, item in value.items()) + "}"
    return json.dumps(value, ensure_ascii=False)  # for all other values, TOML and JSON have the same syntax
