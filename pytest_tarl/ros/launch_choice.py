"""Choose the settings for a script that several launch files start."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pytest_tarl.ros.launch_sources import NOTHING, Given

# what a launch file gives to a node, and the file's path
Start = tuple[Given, Path]


def chosen(script: Path, package: Path | None, starts: Sequence[Start]) -> Given:
    """Return what the script gets; `package` is the folder of its package.

    If the launch files differ, only those of the package count. If these differ as well, the one named after the script
    counts. If there is none, return what all of them have in common.
    """
    giving = [one for one in starts if one[0].gives]
    near = [one for one in giving if package is not None and one[1].is_relative_to(package)]
    after = [one for one in near or giving if is_named_after(one[1], script)]
    for some in (giving, near):
        if some and all(_same(given, some[0][0]) for given, _ in some):
            return some[0][0]
    if after and all(_same(given, after[0][0]) for given, _ in after):
        return replace(after[0][0], note=f"{after[0][0].note} Other launch files give it other values.")
    if not giving:
        return replace(NOTHING, valueless=_valueless(starts))
    return _common(script, near or giving)


def is_named_after(launch: Path, script: Path) -> bool:
    """Return whether a launch file's name contains a script's name as whole words."""
    words = re.escape(script.stem.removesuffix("_node"))
    return re.search(rf"(?:^|[_-]){words}(?:[_-]|\.|$)", launch.name) is not None


def _common(script: Path, differing: Sequence[Start]) -> Given:
    """Return what all launch files have in common, with a note that lists them."""
    names = sorted({file.name for _, file in differing})
    shown = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
    first = differing[0][0]
    common = Given(
        _agreed([one.private for one, _ in differing]),
        _agreed([one.shared for one, _ in differing]),
        valueless=_valueless(differing),
        argv=first.argv if all(one.argv == first.argv for one, _ in differing) else (),
    )
    got = "only those that are equal in all of them" if common.gives else "none of them"
    what = "arguments" if not any(one.private or one.shared for one, _ in differing) else "parameters"
    stated = "argv=[…]" if what == "arguments" else "parameters={…}"
    return replace(
        common,
        note=f"{script.name} gets different {what} in these launch files: {shown}. In this test, it got {got}: "
        f"choose a launch file with tarl.start(…, launch=FILE), or pass {stated}.",
    )


def _valueless(starts: Sequence[Start]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name for given, _ in starts for name in given.valueless))


def _agreed(mappings: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the entries that are the same in all mappings, comparing nested mappings entry by entry."""
    first, *others = mappings
    agreed: dict[str, Any] = {}
    for name, value in first.items():
        values = [other.get(name, NOTHING) for other in others]
        if all(_equal(value, other) for other in values):
            agreed[name] = value
        elif isinstance(value, Mapping) and all(isinstance(other, Mapping) for other in values):
            part = _agreed([value, *values])
            if part:
                agreed[name] = part
    return agreed


def _equal(one: Any, other: Any) -> bool:
    """Return whether two YAML values are identical; 1, 1.0 and True differ, unlike in Python."""
    return repr(one) == repr(other)


def _same(one: Given, other: Given) -> bool:
    return (one.private, one.shared, one.argv) == (other.private, other.shared, other.argv)
