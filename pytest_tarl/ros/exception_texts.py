"""Describe a node's exception: a sentence, the node's own traceback, and the line of the test."""

from __future__ import annotations

import linecache
import traceback
from pathlib import Path
from types import TracebackType

from pytest_tarl.errors import NodeError, text_of

_PACKAGE = str(Path(__file__).parent.parent)


def account(error: BaseException, test: Path) -> str:
    """Return the text for an error in a test: its message and, if a node failed, the node's traceback."""
    cause = error.__cause__
    if not isinstance(error, NodeError) or cause is None or cause.__traceback__ is None:
        return text_of(error)
    lines = traceback.format_exception(type(cause), cause, of_node(cause.__traceback__))
    parts = [text_of(error), "".join(lines).rstrip(), _called(error.__traceback__, test)]
    return "\n\n".join(part for part in parts if part)


def of_node(frames: TracebackType) -> TracebackType:
    """Return a traceback without the scheduler's frames at the start."""
    here: TracebackType | None = frames
    while here is not None and here.tb_frame.f_code.co_filename.startswith(_PACKAGE):
        here = here.tb_next
    return here or frames


def _called(frames: TracebackType | None, test: Path) -> str:
    """Return the line of the test that ran the node."""
    line = 0
    while frames is not None:
        if frames.tb_frame.f_code.co_filename == str(test):
            line = frames.tb_lineno
        frames = frames.tb_next
    code = linecache.getline(str(test), line).strip()
    return f"The test was at {test.name}, line {line}: {code}" if code else ""
