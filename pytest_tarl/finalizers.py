"""Run the `__del__` methods of a node's objects when its episode ends.

A node's objects are in reference cycles, so Python would run their `__del__` at some later allocation, perhaps while
parsing a file in the next episode. An error in such a `__del__` would then end the whole run: to report it, Python has
to parse a line of the traceback, and Python 3.11 cannot parse inside `ast.parse`.
"""

from __future__ import annotations

import gc
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

METHOD = b"def __del__"


def run_finalizers(nodes: Iterable[Path]) -> None:
    """Collect garbage if a node's file defines `__del__`; for other nodes, do nothing."""
    if any(_defines(node, _changed(node)) for node in nodes):
        gc.collect()


def _changed(node: Path) -> int:
    try:
        return node.stat().st_mtime_ns
    except OSError:
        return 0


@lru_cache
def _defines(node: Path, changed: int) -> bool:  # noqa: ARG001 (a changed file is read again)
    try:
        return METHOD in node.read_bytes()
    except OSError:
        return False
