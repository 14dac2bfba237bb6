"""Call a function before a program's new thread runs its first line."""

from __future__ import annotations

import _thread
import threading
from collections.abc import Callable
from types import ModuleType
from typing import Any

# threading.setprofile is no alternative: CPython 3.11 repeats the first instruction of a profiled thread while other
# threads wait for the interpreter lock, so threads that start at the same time would never proceed.
_STARTERS = (
    (_thread, "start_new_thread"),
    (_thread, "start_joinable_thread"),  # Python ≥ 3.13
    (threading, "_start_new_thread"),
    (threading, "_start_joinable_thread"),
)


class ThreadWatch:
    """Call `heard` before a thread starts through `threading` or `_thread`.

    Threads that extension modules start in other ways are not detected.
    """

    def __init__(self, heard: Callable[[], None]) -> None:
        self._heard = heard
        self._replaced: list[tuple[ModuleType, str, Any, Any]] = []

    def begin(self) -> None:
        """Replace the functions in both modules that start threads."""
        for module, name in _STARTERS:
            original = getattr(module, name, None)
            if original is not None:
                telling = self._telling(original)
                setattr(module, name, telling)
                self._replaced.append((module, name, original, telling))

    def end(self) -> None:
        """Restore both modules, unless other code has changed them since."""
        for module, name, original, telling in self._replaced:
            if getattr(module, name) is telling:
                setattr(module, name, original)
        self._replaced.clear()

    def _telling(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def started(*arguments: Any, **options: Any) -> Any:
            self._heard()
            return original(*arguments, **options)

        return started
