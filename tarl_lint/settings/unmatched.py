"""Find names in the settings that no file mentions; a misspelt name would otherwise silently have no effect."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from tarl_lint.settings.config import Config


def unmatched(config: Config, texts: Iterable[str]) -> tuple[str, ...]:
    """Return a message for each source, sink, sanitizer and wrapper that no text mentions."""
    if not config.named:
        return ()
    known = list(texts)
    origins = dict(config.origins)
    return tuple(
        f"{origins.get(key, 'settings')}: {key!r} names {name!r}, which no file mentions: check the name."
        for key, name in _names(config)
        if not any(_mentions(text, name) for text in known)
    )


def _names(config: Config) -> Iterator[tuple[str, str]]:
    for key in ("sources", "sinks", "sanitizers"):
        for name in getattr(config, key):
            yield key, name
    for wrapper in config.wrappers:
        yield "wrappers", wrapper.name


def _mentions(text: str, name: str) -> bool:
    """Return whether a file defines the last part of a name, or uses it and mentions its module."""
    first, last = re.escape(name.partition(".")[0]), re.escape(name.rpartition(".")[2])
    if not re.search(rf"\b{last}\b", text):
        return False
    return re.search(rf"\b{first}\b|\b(?:def|class)\s+{last}\b|^{last}\s*=", text, re.MULTILINE) is not None
