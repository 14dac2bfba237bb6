"""Insert the recording function (hook) and the list of events (buffer) into code objects, as constants.

As globals, they would be visible to the program in `vars(module)` and `globals()`. The transform therefore inserts
marks, which compile to constants and are cached with the code. `bound` replaces the marks just before the code runs.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from types import CodeType
from typing import Any

Mark = bytes  # a digest, which does not occur in a program by accident


def _mark(name: str) -> Mark:
    return hashlib.sha256(f"pytest_tarl.instrumentation {name}".encode()).digest()


# `hook(number, value)` records a site's number and value, and returns the value
HOOK = _mark("hook")
BUFFER = _mark("buffer")  # the list that instrumented code appends its events to
TYPE = _mark("type")  # the builtin `type`, whose name the program may shadow
FLOAT = _mark("float")
_BUILTINS: Mapping[Mark, Any] = {TYPE: type, FLOAT: float}


def bound(code: CodeType, hook: Callable[[int, Any], Any], buffer: list[Any] | None = None) -> CodeType:
    """Return code that records by calling `hook`. Code instrumented with `inline` also appends to `buffer`.

    Both must be hashable, because code objects are used as keys.
    """
    return _replaced(code, {**_BUILTINS, HOOK: hook, BUFFER: buffer})


def _replaced(code: CodeType, values: Mapping[Mark, Any]) -> CodeType:
    constants = code.co_consts
    changed = tuple(
        _replaced(one, values)
        if type(one) is CodeType
        else values[one]
        if type(one) is Mark and one in values
        else one
        for one in constants
    )
    if all(new is old for new, old in zip(changed, constants, strict=True)):
        return code
    return code.replace(co_consts=changed)
