"""Insert the recording function (hook) and the event list (buffer) into code objects as constants.

If they were globals, the program could see them in `vars(module)` and `globals()`. Therefore the transform inserts
marks, which compile to constants and are cached with the code. `bound` replaces the marks just before the code runs.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from types import CodeType
from typing import Any

Mark = bytes  # a digest, which no program contains by accident


def _mark(name: str) -> Mark:
    return hashlib.sha256(f"pytest_tarl.instrumentation {name}".encode()).digest()


# the function `hook(number, value)`, which records the number of a site and returns the value
HOOK = _mark("hook")
BUFFER = _mark("buffer")  # the list to which instrumented code appends its events
TYPE = _mark("type")  # the builtin `type`, since the program may shadow its name
FLOAT = _mark("float")
_BUILTINS: Mapping[Mark, Any] = {TYPE: type, FLOAT: float}


def bound(code: CodeType, hook: Callable[[int, Any], Any], buffer: list[Any] | None = None) -> CodeType:
    """Return code that calls `hook` to record. Code instrumented with `inline` also appends to `buffer`.

    Both must be hashable, since code objects are used as keys.
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
