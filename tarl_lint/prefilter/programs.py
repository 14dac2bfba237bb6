"""Split a group of modules into programs, which run in separate processes.

A program is a file that is run, with its imports. Since programs run in separate processes, no value reaches one
from another through a module that both import. Programs are therefore analysed separately, even after an edit. They
are analysed together only if a flow may begin or end in a common module. The flow is then reported once, with the
statements of all programs.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from typing import Final, TypeVar

from tarl_lint.read.module_names import Named

M = TypeVar("M", bound=Named)

RUN: Final = "__main__"
LOADS: Final = re.compile(
    r"\b(importlib|__import__|pkgutil|runpy|pluginlib|entry_points|iter_entry_points|exec|execfile|locate)\b"
)  # matches words of files that may load a module without an import statement


def programs(
    group: Sequence[M],
    imports: Mapping[str, Sequence[M]],
    endpoints: Set[str],
    code: Callable[[str], str],
) -> list[tuple[M, ...]]:
    """Return the modules of each program, in the order of the group. A module may be part of several programs.

    `endpoints` are the paths of the modules that may subscribe or publish. Programs stay together if they share one
    of these paths. Programs with a common module also stay together if one of them loads modules by name, or is not
    clearly a program.
    """
    imported = {module.path for one in group for module in imports[one.path]}
    runs = [_reached(one, imports) for one in group if one.path not in imported]
    if len(runs) < 2 or {path for run in runs for path in run} != {one.path for one in group}:
        return [tuple(group)]
    wide = [index for index, run in enumerate(runs) if not _closed(run, code)]
    owners: dict[str, list[int]] = {}
    for index, run in enumerate(runs):
        for path in run:
            owners.setdefault(path, []).append(index)
    joined = [*range(len(runs))]
    for path, sharing in owners.items():
        if path in endpoints or not set(sharing).isdisjoint(wide):
            _join(joined, sharing)
    parts: dict[int, set[str]] = {}
    for index, run in enumerate(runs):
        parts.setdefault(_first(joined, index), set()).update(run)
    return [tuple(one for one in group if one.path in part) for part in parts.values()]


def _reached(start: M, imports: Mapping[str, Sequence[M]]) -> dict[str, M]:
    """Return a module and all modules that it imports, directly or indirectly; the module itself comes first."""
    found = {start.path: start}
    pending = [start]
    while pending:
        for module in imports[pending.pop().path]:
            if module.path not in found:
                found[module.path] = module
                pending.append(module)
    return found


def _closed(run: Mapping[str, Named], code: Callable[[str], str]) -> bool:
    """Return whether a file is a program whose modules are known from its imports."""
    first = next(iter(run.values()))
    if RUN not in first.text and not first.started:
        return False
    return not any(LOADS.search(module.text) and LOADS.search(code(module.text)) for module in run.values())


def _join(joined: list[int], members: Iterable[int]) -> None:
    """Merge sets of runs; each set is represented by its first run."""
    firsts = {_first(joined, member) for member in members}
    for first in firsts:
        joined[first] = min(firsts)


def _first(joined: Sequence[int], index: int) -> int:
    while joined[index] != index:
        index = joined[index]
    return index
