"""`return`, `break`, `continue` and `raise` of an interpreted file."""

from __future__ import annotations

from typing import Any


class Returned(Exception):  # noqa: N818 - control flow, never an error
    """A `return` of the file."""

    def __init__(self, value: Any) -> None:
        self.value = value


class Left(Exception):  # noqa: N818 - control flow, never an error
    """A `break` of the file; with `whole` False, a `continue`."""

    def __init__(self, *, whole: bool) -> None:
        self.whole = whole


class Enough(Exception):  # noqa: N818 - control flow, never an error
    """A generator of the file may be endless."""


class Raised(Exception):  # noqa: N818 - control flow of the file
    """An exception of the file; `error` is None if it is unknown."""

    def __init__(self, line: int, error: Any = None) -> None:
        self.line, self.error = line, error
