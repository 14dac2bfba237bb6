"""Find the keys above a number in a YAML or JSON file, which show to which node a parameter belongs."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

from pytest_tarl.patching.constant_definitions import Place

_WILDCARDS = frozenset({"*", "**", "ros__parameters"})
_MOST_FILES = 64  # maximum number of files whose keys are cached


def keys_above(place: Place, text: str) -> tuple[str, ...] | None:
    """Return the keys above a number; None for other kinds of files."""
    if not place.path.endswith((".yaml", ".yml", ".json")):
        return None
    return _keys(text).get(place.start)


def belongs(name: str, keys: Sequence[str]) -> bool:
    """Return whether a number under these keys may be a parameter's value."""
    return name.strip("/").split("/")[-len(keys) :] == [*keys]


@lru_cache(_MOST_FILES)
def _keys(text: str) -> dict[int, tuple[str, ...]]:
    """Map each number's offset to the keys above it, without wildcards; empty if PyYAML is missing."""
    try:
        import yaml

        root = yaml.compose(text, Loader=yaml.SafeLoader)
    except (ModuleNotFoundError, ValueError, RecursionError):
        return {}
    except yaml.YAMLError:
        return {}
    found: dict[int, tuple[str, ...]] = {}
    pending: list[tuple[tuple[str, ...], Any]] = [((), root)] if root is not None else []
    seen: set[int] = set()
    while pending:
        above, node = pending.pop()
        if node.id == "scalar":
            found[node.start_mark.index] = above
        elif node.id == "mapping" and id(node) not in seen:
            seen.add(id(node))
            for key, value in node.value:
                parts = re.split(r"[/.]", str(key.value)) if key.id == "scalar" else []
                named = tuple(part for part in parts if part and part not in _WILDCARDS)
                pending.append(((*above, *named), value))
    return found
