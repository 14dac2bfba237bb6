"""Find the user code that caused an event: the innermost frame outside libraries."""

from __future__ import annotations

import inspect
import sysconfig
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from types import CodeType, FrameType, TracebackType
from typing import Any

_HERE = str(Path(__file__).parent)
_LIBRARIES = tuple({sysconfig.get_path(key) for key in ("stdlib", "platstdlib", "purelib", "platlib")})
# folders of a ROS installed on the system, which sysconfig does not list in a virtual environment
_SYSTEM = ("/dist-packages/", "/opt/ros/")

Place = tuple[str, int, str]  # file, line, function


def of_traceback(traceback: TracebackType | None) -> Place | None:
    """Return the innermost place in user code where an exception occurred."""
    places = []
    while traceback is not None:
        places.append(
            (traceback.tb_frame.f_code.co_filename, traceback.tb_lineno, traceback.tb_frame.f_code.co_name)
        )
        traceback = traceback.tb_next
    return _innermost(reversed(places))


def of_frame(frame: FrameType | None) -> Place | None:
    """Return the innermost place in user code that a running or suspended frame has reached."""
    return _innermost(_outwards(frame))


def of_function(function: Any) -> Place | None:
    """Return where a function is defined, or None if it has no code, like a builtin."""
    while isinstance(function, partial):
        function = function.func
    if not hasattr(function, "__code__") and not hasattr(function, "__func__"):
        function = type(function).__call__  # the callable is an object with a `__call__` method
    code = getattr(inspect.unwrap(function), "__code__", None)
    return (code.co_filename, code.co_firstlineno, code.co_name) if isinstance(code, CodeType) else None


def describe(place: Place | None) -> str:
    """Format a place, as in `traveller.py, line 31, in travel`; relative to the working directory if below it."""
    if place is None:
        return "an unknown line"
    file, line, function = place
    path = Path(file)
    if path.is_absolute() and path.is_relative_to(Path.cwd()):
        path = path.relative_to(Path.cwd())
    return f"{path}, line {line}" + ("" if function == "<module>" else f", in {function}")


def describe_first(places: Iterable[Place]) -> str:
    """Format the first place in user code."""
    return describe(_innermost(iter(places)))


def is_library(file: str) -> bool:
    """Return whether a file belongs to Python or to an installed package, not to the user."""
    return file.startswith((*_LIBRARIES, "<")) or any(place in file for place in _SYSTEM)


def _outwards(frame: FrameType | None) -> Iterator[Place]:
    while frame is not None:
        yield frame.f_code.co_filename, frame.f_lineno, frame.f_code.co_name
        frame = frame.f_back


def _innermost(places: Iterator[Place]) -> Place | None:
    fallback = None
    for place in places:
        if place[0].startswith(_HERE):
            continue
        if not is_library(place[0]):
            return place
        fallback = fallback or place
    return fallback
