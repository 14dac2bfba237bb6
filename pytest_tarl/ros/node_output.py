"""Give nodes standard output streams that they cannot close, because pytest writes to the same streams.

A node may set `sys.stdout = io.TextIOWrapper(sys.stdout.buffer, encoding="utf-8")`. When Python collects the new
stream, it closes the buffer, too.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from pytest_tarl.ros.scheduler import running_task

NAMES = ("stdout", "stderr")


class Output:
    """`sys.stdout` or `sys.stderr` while nodes run: the real stream, which nodes can neither close nor detach."""

    def __init__(self, real: Any) -> None:
        vars(self)["real"] = real

    def __getattr__(self, name: str) -> Any:
        return getattr(self.real, name)

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(self.real, name, value)

    def __delattr__(self, name: str) -> None:
        delattr(self.real, name)

    @property
    def buffer(self) -> Any:
        """The binary stream; nodes get one that they cannot close."""
        return self.real.buffer if running_task() is None else Buffer(self.real.buffer)

    def detach(self) -> Any:
        """Return the binary stream; if a node calls this, the text stream remains usable."""
        self.real.flush()
        return self.real.detach() if running_task() is None else self.buffer

    def close(self) -> None:
        """Close the stream, or only flush it if a node calls this."""
        self.real.flush() if running_task() is not None else self.real.close()


class Buffer:
    """The binary stream that nodes get from a standard stream; they cannot close it, even after the episode."""

    def __init__(self, real: Any) -> None:
        self.real = real

    def __getattr__(self, name: str) -> Any:
        return getattr(self.real, name)

    def detach(self) -> Buffer:
        """Return this stream; it remains usable."""
        return self

    def _dealloc_warn(self, _: object) -> None:
        """Suppress the warning of Python about a text stream that was not closed before it was collected."""

    def close(self) -> None:
        """Only flush the stream."""
        if not self.real.closed:
            self.real.flush()


@contextmanager
def output_of_nodes() -> Iterator[None]:
    """Replace the standard output streams while nodes run; afterwards, remove those that nodes set."""
    real = {name: stream for name in NAMES if (stream := getattr(sys, name)) is not None}
    ours = {name: Output(stream) for name, stream in real.items()}
    for name, stream in ours.items():
        setattr(sys, name, stream)
    try:
        yield
    finally:
        for name, stream in real.items():
            now = getattr(sys, name)
            if now is ours[name] or not (_of_pytest(now) or stream.closed):
                setattr(sys, name, stream)


def _of_pytest(stream: object) -> bool:
    """Return whether pytest set this stream, when it started or stopped capturing the output."""
    return stream in (sys.__stdout__, sys.__stderr__) or type(stream).__module__.startswith("_pytest.")
