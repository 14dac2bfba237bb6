"""Give instrumented code its hook and buffer as constants of its code objects, just before it runs.

As globals they would show in `vars(module)`, in `globals()` and in class bodies with a namespace of their own. The
transform inserts marks, which compile to constants and are cached with the code; `bound` replaces them.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from types import CodeType
from typing import Any

Mark = bytes  # a digest, which no program contains by accident


def _mark(name: str) -> Mark:
    return hashlib.sha256(f"pytest_tarl.instrumentation {name}".encode()).digest()


HOOK = _mark("hook")  # hook(number, value) returns value
BUFFER = _mark("buffer")  # the list of events
TYPE = _mark("type")  # builtins, which the program may have shadowed
FLOAT = _mark("float")
_BUILTINS: Mapping[Mark, Any] = {TYPE: type, FLOAT: float}


def bound(code: CodeType, hook: Callable[[int, Any], Any], buffer: list[Any] | None = None) -> CodeType:
    """Return code that records with `hook` and, if instrumented with `inline`, into `buffer`.

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
