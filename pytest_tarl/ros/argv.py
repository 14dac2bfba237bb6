"""The command line that a program believes it was started with."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager


@contextmanager
def command_line(argv: Sequence[str]) -> Iterator[None]:
    """Let `sys.argv` be this for a while."""
    before = sys.argv
    sys.argv = list(argv)
    try:
        yield
    finally:
        sys.argv = before
