"""Replace `sys.argv` while a node's program is running."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager


@contextmanager
def command_line(argv: Sequence[str]) -> Iterator[None]:
    """Set `sys.argv`, and restore it on exit."""
    before = sys.argv
    sys.argv = list(argv)
    try:
        yield
    finally:
        sys.argv = before
