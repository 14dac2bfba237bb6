"""Turn the wrappers in the settings into facts of the catalog."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Final

from tarl_lint import catalog
from tarl_lint.catalog import Fact
from tarl_lint.errors import ConfigError
from tarl_lint.settings.config import suggestion
from tarl_lint.settings.schema import Wrapper

KINDS: Final = frozenset(
    {"subscribe", "publisher", "receive", "filter", "timer", "service", "call later", "thread"}
)


@cache
def facts(wrappers: tuple[Wrapper, ...]) -> Mapping[str, Fact]:
    """Return qualified name → fact. Raises ConfigError if `like` is not a function that can be wrapped."""
    return {wrapper.name: _fact(wrapper) for wrapper in wrappers}


def _fact(wrapper: Wrapper) -> Fact:
    every = (*catalog.FUNCTIONS.items(), *catalog.METHODS.items())
    known = {name: fact for name, fact in every if fact.kind in KINDS}
    if wrapper.like not in known:
        raise ConfigError(
            f"The wrapper {wrapper.name!r} has like = {wrapper.like!r}, which is not a function that can be wrapped"
            f"{suggestion(wrapper.like, known)} Use one of {', '.join(sorted(known))}."
        )
    fact = known[wrapper.like]
    return replace(
        fact,
        api=wrapper.name,
        topic=_where(wrapper.topic, fact.topic),
        type=_where(wrapper.type, fact.type),
        callback=_where(wrapper.callback, fact.callback),
        extra=_where(wrapper.extra, fact.extra),
    )


def _where(place: int | str | None, usual: tuple[int, str]) -> tuple[int, str]:
    if place is None:
        return usual
    return (place, "") if isinstance(place, int) else (-1, place)
