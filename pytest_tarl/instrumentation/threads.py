"""Hear of a program's next thread before it runs its first line."""

from __future__ import annotations

import _thread
import sys
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any


class ThreadWatch:
    """Call `heard` as soon as a thread starts, by `threading` or by `_thread` itself.

    A thread that an extension module makes by itself is not heard of.
    """

    def __init__(self, heard: Callable[[], None]) -> None:
        self._heard = heard
        self._profile = threading.getprofile()
        self._raw: Callable[..., int] = _thread.start_new_thread

    def begin(self) -> None:
        """Watch."""
        threading.setprofile(self._runs)
        _thread.start_new_thread = self._started

    def end(self) -> None:
        """Leave both modules as they were, unless somebody else has changed them in between."""
        if threading.getprofile() == self._runs:
            threading.setprofile(self._profile)
        if _thread.start_new_thread == self._started:
            _thread.start_new_thread = self._raw

    def _runs(self, _frame: FrameType, _event: str, _argument: object) -> None:
        sys.setprofile(self._profile)
        self._heard()

    def _started(self, *arguments: Any, **options: Any) -> int:
        # `threading` has a name of its own for this function, and a profiler for the threads that it starts.
        self._heard()
        return self._raw(*arguments, **options)
