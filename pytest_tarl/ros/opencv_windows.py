"""OpenCV windows of nodes: nothing is drawn, and `cv2.waitKey` waits in virtual time for keys typed by the test.

Test machines often have no display, their OpenCV often has no windows (`opencv-python-headless`), and a real window
would wait in real time. The rest of `cv2`, such as images and drawing, is the real library.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.abc import Loader
from importlib.machinery import ModuleSpec, PathFinder
from types import BuiltinFunctionType, ModuleType
from typing import Any

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.keyboard import own_terminal
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.process import Process, running_process

_NO_KEY = -1  # return value of waitKey if no key is typed
_LIBRARY = "cv2"


class Windows:
    """The windows of a node: their names, and their trackbars' positions."""

    def __init__(self, _process: Process) -> None:
        self.names: set[str] = set()
        self.positions: dict[tuple[str, str], int] = {}  # (trackbar, window) → position
        self.moved: dict[tuple[str, str], Callable[[int], object]] = {}  # (trackbar, window) → callback

    def open(self, name: str, *_: object, **__: object) -> None:
        """Add a window, as `namedWindow` and `imshow` do."""
        self.names.add(name)

    def close(self, name: str) -> None:
        """Remove a window."""
        self.names.discard(name)

    def close_all(self) -> None:
        """Remove all windows."""
        self.names.clear()

    def look(self, name: str, _property: int = 0) -> float:
        """Return 1.0 for a property of an open window, and -1.0 if there is no such window."""
        return 1.0 if name in self.names else -1.0

    def place(self, _name: str) -> tuple[int, int, int, int]:
        """Return a rectangle for a window, whose size is unknown."""
        return (0, 0, -1, -1)

    def add_trackbar(
        self,
        trackbarName: str,  # noqa: N803 (the library's names)
        windowName: str,  # noqa: N803
        value: int,
        count: int,  # noqa: ARG002 (the end of the range; only code sets positions, so it needs no check)
        onChange: Callable[[int], object] = lambda _: None,  # noqa: N803
    ) -> None:
        """Add a trackbar at the position `value`."""
        self.positions[trackbarName, windowName] = value
        self.moved[trackbarName, windowName] = onChange

    def position(self, trackbarname: str, winname: str) -> int:
        """Return a trackbar's position, or -1 if it does not exist."""
        return self.positions.get((trackbarname, winname), -1)

    def move(self, trackbarname: str, winname: str, pos: int) -> None:
        """Move a trackbar, and call its callback if the position changes."""
        place = (trackbarname, winname)
        if self.positions.get(place, pos) != pos:
            self.positions[place] = pos
            self.moved[place](pos)

    def wait(self, delay: int = 0) -> int:
        """Return the code of the next key typed by the test, or -1 after `delay` ms without one (0: no limit)."""
        return _code(nanoseconds(delay / 1000) if delay > 0 else None)

    def poll(self) -> int:
        """Return the code of a typed key, or -1."""
        asked()
        return _code(0)

    def ignore(self, *_: object, **__: object) -> None:
        """Do nothing."""


def _code(patience: int | None) -> int:
    """Return the code of the next key within `patience` (ns), or -1."""
    terminal = own_terminal()
    key = terminal.key(patience) if terminal is not None else ""
    return ord(key) if key else _NO_KEY


_FUNCTIONS: Mapping[str, Callable[..., Any]] = {  # function of cv2 → what nodes call instead
    "namedWindow": Windows.open,
    "imshow": Windows.open,
    "destroyWindow": Windows.close,
    "destroyAllWindows": Windows.close_all,
    "getWindowProperty": Windows.look,
    "getWindowImageRect": Windows.place,
    "createTrackbar": Windows.add_trackbar,
    "getTrackbarPos": Windows.position,
    "setTrackbarPos": Windows.move,
    "waitKey": Windows.wait,
    "waitKeyEx": Windows.wait,
    "pollKey": Windows.poll,
    **dict.fromkeys(
        (
            "moveWindow", "resizeWindow", "setMouseCallback", "setTrackbarMax", "setTrackbarMin",
            "setWindowProperty", "setWindowTitle", "startWindowThread",
        ),
        Windows.ignore,
    ),
}  # fmt: skip


class _OfNodes:
    """Replaces a function of cv2: nodes use their own windows, other code the library."""

    def __init__(self, real: Callable[..., Any], ours: Callable[..., Any]) -> None:
        self.real = real
        self._ours = ours

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        process = running_process()
        if process is None:
            return self.real(*arguments, **named)
        return self._ours(process.part(Windows), *arguments, **named)


class _Finder:
    """Replaces the functions when a node imports OpenCV."""

    def __init__(self) -> None:
        self._importing = False

    def find_spec(
        self, name: str, _path: Sequence[str] | None = None, _target: object = None
    ) -> ModuleSpec | None:
        """Find OpenCV itself; its loader replaces the functions."""
        # while it is imported, OpenCV imports its binary module under the same name
        if name != _LIBRARY or self._importing:
            return None
        self._importing = True
        try:
            spec = PathFinder.find_spec(name)
        finally:
            self._importing = False
        if spec is not None and spec.loader is not None:
            spec.loader = _ReplacingLoader(self, spec.loader)
        return spec

    @contextmanager
    def by_library(self) -> Iterator[None]:
        """Leave imports to other finders."""
        self._importing = True
        try:
            yield
        finally:
            self._importing = False


class _ReplacingLoader(Loader):
    def __init__(self, finder: _Finder, real: Loader) -> None:
        self._finder = finder
        self._real = real

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """Create the library's module."""
        return self._real.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        """Load the library, then replace its functions."""
        if module.__spec__ is not None:
            module.__spec__.loader = self._real
        module.__loader__ = self._real
        with self._finder.by_library():
            self._real.exec_module(module)
        _replace(sys.modules.get(_LIBRARY, module))


@contextmanager
def windows_discarded() -> Iterator[None]:
    """Replace OpenCV's window functions for nodes, whether OpenCV is already imported or a node imports it later.

    Functions that the test itself has replaced stay.
    """
    finder = _Finder()
    sys.meta_path.insert(0, finder)
    _replace(sys.modules.get(_LIBRARY))
    try:
        yield
    finally:
        sys.meta_path.remove(finder)
        module = sys.modules.get(_LIBRARY)
        for name in _FUNCTIONS:
            ours = getattr(module, name, None)
            if isinstance(ours, _OfNodes):
                setattr(module, name, ours.real)


def _replace(module: ModuleType | None) -> None:
    for name, ours in _FUNCTIONS.items():
        real = getattr(module, name, None)
        if isinstance(real, BuiltinFunctionType):
            setattr(module, name, _OfNodes(real, ours))
