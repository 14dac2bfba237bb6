"""What instrumented code records with: constants of its code objects, put there when it is about to run.

As globals they would show in `vars(module)`, in `globals()` and in class bodies with a namespace of their own. The
transform leaves marks, which compile to constants and are stored with the code; `bound` replaces them.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from types import CodeType
from typing import Any

Mark = bytes  # a constant that no program holds by accident


def _mark(name: str) -> Mark:
    return hashlib.sha256(f"pytest_tarl.instrumentation {name}".encode()).digest()


HOOK = _mark("hook")  # hook(number, value) gives value back
BUFFER = _mark("buffer")  # the list of events
TYPE = _mark("type")  # the builtins, which the program may have hidden
FLOAT = _mark("float")
_BUILTINS: Mapping[Mark, Any] = {TYPE: type, FLOAT: float}


def bound(code: CodeType, hook: Callable[[int, Any], Any], buffer: list[Any] | None = None) -> CodeType:
    """Return code that records by `hook` and, where it was instrumented with `inline`, to `buffer`.

    Both become keys wherever code objects do, so they must be hashable.
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
