"""The names of all parameters that a program reads, also names that it composes from parts.

The analysis of the program knows the names at each call, for each caller and iteration. The list of names is
complete only if the analysis has reached every call from every caller.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from tarl_lint.evidence import Outline
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir.lower_expressions import position
from tarl_lint.ir.nodes import Pos
from tarl_lint.read.source import Module
from tarl_lint.system.parameters import OPEN, READERS
from tarl_lint.trees import last_name

_Place = tuple[str, Pos]
_INIT: Final = "__init__"
_MOST: Final = 500  # maximum number of functions whose callers are examined


def composed_names(
    machine: Interpreter, modules: Sequence[Module], outlines: Mapping[str, Outline]
) -> frozenset[str] | None:
    """Return the names of all parameters of a program; None if some are unknown."""
    if machine.cut or any(OPEN.search(module.text) for module in modules):
        return None
    found: set[str] = set()
    composing: set[str] = set()
    for module in modules:
        outline = outlines[module.path]
        for call in (
            one for calls in outline.calls.values() for one in calls if last_name(one.func) in READERS
        ):
            names = _literal(call)
            if names is None:
                read = machine.parameter_reads.get((module.path, position(call)))
                if read is None:
                    return None
                names = frozenset(read)
                composing.add(outline.qualname(call.lineno))
            found |= names
    names = frozenset(one.strip("~/").lstrip(".") for one in found)
    whole = "" in names  # the program reads all its parameters as one mapping
    return None if whole or not _reached_by_all(machine, modules, outlines, composing) else names


def _literal(call: ast.Call) -> frozenset[str] | None:
    """Return the name in a call that states one; None for other calls."""
    named = {one.arg: one.value for one in call.keywords if one.arg}
    first = call.args[0] if call.args else named.get("name") or named.get("param_name")
    several = last_name(call.func) in ("declare_parameters", "get_parameters")
    if several or not (isinstance(first, ast.Constant) and isinstance(first.value, str)):
        return None
    return frozenset([first.value])


def _reached_by_all(
    machine: Interpreter, modules: Sequence[Module], outlines: Mapping[str, Outline], composing: set[str]
) -> bool:
    """Return whether the analysis followed all calls of the functions and their callers."""
    entered: dict[str, set[_Place]] = {}
    for frame in machine.frames.values():
        if frame.caller is not None and frame.call_pos is not None:
            place = (frame.caller.program.path, frame.call_pos)
            entered.setdefault(frame.function.qualname, set()).add(place)
        else:
            entered.setdefault(frame.function.qualname, set())
    pending, seen = sorted(composing), set(composing)
    while pending:
        qualname = pending.pop()
        if not qualname:
            continue  # the function is the module itself
        if qualname not in entered or len(seen) > _MOST:
            return False
        for path, call in _calls_of(qualname, modules, outlines):
            around = outlines[path].qualname(call.lineno)
            # a call of a base `__init__` may reach several classes
            followed = (path, position(call)) in entered[qualname] or (
                last_name(call.func) == _INIT and (around in entered or not around)
            )
            if not followed:
                return False
            if around not in seen:
                seen.add(around)
                pending.append(around)
    return True


def _calls_of(
    qualname: str, modules: Sequence[Module], outlines: Mapping[str, Outline]
) -> Iterator[tuple[str, ast.Call]]:
    """Yield the calls that may call a function or a class's `__init__`."""
    *around, name = qualname.split(".")
    names = {name, around[-1]} if name == _INIT and around else {name}
    for module in modules:
        for call in (one for calls in outlines[module.path].calls.values() for one in calls):
            if last_name(call.func) in names:
                yield module.path, call
