"""Standard input of nodes: a terminal on which the test types, with reads that wait in virtual time."""

from __future__ import annotations

import builtins
import io
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from types import BuiltinFunctionType
from typing import Any

from pytest_tarl.ros.process import Process, running_process
from pytest_tarl.ros.scheduler import Task, current_task

_DEBUGGERS = frozenset(
    {"bdb", "cmd", "code", "pdb"}
)  # debuggers, which read from the user's terminal even while a node is running
_LOCAL_MODES = 3  # index of the local modes in termios.tcgetattr's result


class NodeInterruptedError(KeyboardInterrupt):
    """Ends a read at the end of the episode, as Ctrl-C does on a robot."""

    tarl_shutdown = True  # a normal end of a node, which is not reported


class Terminal(io.TextIOBase):
    """The standard input of one node.

    As on a real terminal, a node can read only whole lines until it switches to raw or cbreak mode.
    """

    encoding = "utf-8"
    name = "<stdin>"

    def __init__(self, process: Process) -> None:
        self._process = process
        self._typed = ""
        self._descriptors: tuple[int, ...] = ()
        self._waiting: list[Task] = []
        self.waited = False  # whether the node has waited for input
        self.used = False  # whether the test has typed

    def type(self, text: str) -> None:
        """Add text to the input of the node, and wake tasks that wait for input."""
        self.used = True
        self._typed += text
        for task in self._waiting:
            self._process.scheduler.wake(task)

    def look(self) -> bool:
        """Return whether a read would return immediately."""
        self.waited = True
        return bool(self._readable())

    def read(self, size: int | None = -1, /) -> str:
        """Return up to `size` characters; without a size, return all text until the node ends."""
        if size is None or size < 0:
            lines = list(iter(self.readline, ""))
            return "".join(lines)
        if size == 0:
            return ""  # do not wait, like a file
        self._wait()
        return self._take(min(size, self._readable()))

    def readline(self, size: int | None = -1, /) -> str:  # type: ignore[override]
        """Return a line of at most `size` characters. Raise NodeInterruptedError when the node ends."""
        limit = sys.maxsize if size is None or size < 0 else size
        while "\n" not in self._typed[:limit] and len(self._typed) < limit:
            self._pause()
        return self._take(min(self._typed.find("\n") + 1 or limit, limit))

    def key(self, patience: int | None) -> str:
        """Return the next typed character; empty if none is typed within `patience` (ns; None: no limit).

        At the end of the episode, return an empty string at once.
        """
        scheduler = self._process.scheduler
        until = None if patience is None else scheduler.time + patience
        self.waited |= until is None
        while not self._typed and not self._process.ending and (until is None or scheduler.time < until):
            self._park(until)
        if self._process.ending:
            self._process.refuse_to_wait()
        return self._take(1)

    def fileno(self) -> int:
        """Return a descriptor that termios can configure. Raise OSError if the system has no terminals."""
        if not self._descriptors:
            if not hasattr(os, "openpty"):
                raise io.UnsupportedOperation("This operating system has no pseudo-terminals.")
            self._descriptors = os.openpty()
        return self._descriptors[1]

    def owns(self, stream: Any) -> bool:
        """Return whether a stream or descriptor is this terminal."""
        return isinstance(stream, _StandardInput) or stream is self or stream in self._descriptors

    def isatty(self) -> bool:
        """Return True."""
        return True

    def readable(self) -> bool:
        """Return True."""
        return True

    @property
    def buffer(self) -> Bytes:
        """The terminal as a stream of bytes."""
        return Bytes(self)

    def release(self) -> None:
        """Close the descriptors."""
        for one in self._descriptors:
            os.close(one)
        self._descriptors = ()

    def _readable(self) -> int:
        """Return the number of characters available now."""
        return self._typed.rfind("\n") + 1 if self._collects_lines() else len(self._typed)

    def _collects_lines(self) -> bool:
        if not self._descriptors:
            return True
        import termios

        return bool(termios.tcgetattr(self._descriptors[1])[_LOCAL_MODES] & termios.ICANON)

    def _wait(self) -> None:
        while not self._readable():
            self._pause()

    def _pause(self) -> None:
        if self._process.ending:
            raise NodeInterruptedError
        self.waited = True
        self._park(None)

    def _park(self, until: int | None) -> None:
        """Suspend the task until the test types something, or until the time `until`."""
        task = current_task()
        self._waiting.append(task)
        try:
            self._process.scheduler.wait(until)
        finally:
            self._waiting.remove(task)

    def _take(self, size: int) -> str:
        taken, self._typed = self._typed[:size], self._typed[size:]
        return taken


class Bytes:
    """`sys.stdin.buffer` of a node."""

    def __init__(self, terminal: Terminal) -> None:
        self.raw = self
        self._terminal = terminal

    def read(self, size: int = -1) -> bytes:
        """Return up to `size` characters, encoded."""
        return self._terminal.read(size).encode()

    def readline(self, size: int = -1) -> bytes:
        """Return a line, encoded."""
        return self._terminal.readline(size).encode()

    def fileno(self) -> int:
        """Return the descriptor of the terminal."""
        return self._terminal.fileno()


class _StandardInput:
    """`sys.stdin` while nodes run: each node has its own terminal, other code the real stream."""

    def __init__(self, real: Any) -> None:
        self.real = real

    def __getattr__(self, name: str) -> Any:
        return getattr(own_terminal() or self.real, name)

    def __iter__(self) -> Iterator[str]:
        return iter(own_terminal() or self.real)

    @contextmanager
    def by_real(self) -> Iterator[None]:
        """Use the real stream as `sys.stdin`."""
        before = sys.stdin
        sys.stdin = self.real if before is self else before
        try:
            yield
        finally:
            sys.stdin = before


def own_terminal() -> Terminal | None:
    """Return the terminal of the running node, or None outside nodes."""
    process = running_process()
    return process.part(Terminal) if process is not None else None


def split(streams: Sequence[Any]) -> tuple[list[Any], list[Any], Terminal | None]:
    """Split the streams of a `select`.

    Return the streams that are the node's terminal, all other streams, and the terminal (None if no stream is it).
    """
    terminal = own_terminal()
    own = [one for one in streams if terminal is not None and terminal.owns(one)]
    return own, [one for one in streams if one not in own], terminal if own else None


@contextmanager
def terminals(processes: Sequence[Process]) -> Iterator[None]:
    """Give nodes terminals as `sys.stdin`, for `input` and for `os.read`; close them at the end.

    If the test has replaced `input` or `sys.stdin`, its replacement stays, and `input` reads from the test's stream.
    """
    mine = _StandardInput(sys.stdin)
    replaced: list[tuple[Any, str, Any, Any]] = [(os, "read", os.read, _read(os.read))]
    if not _from_test(sys.stdin):
        replaced.append((sys, "stdin", sys.stdin, mine))
        if isinstance(input, BuiltinFunctionType):
            replaced.append((builtins, "input", input, _input(input, mine)))
    for owner, name, _, ours in replaced:
        setattr(owner, name, ours)
    try:
        yield
    finally:
        for owner, name, real, ours in replaced:
            if getattr(owner, name) is ours:
                setattr(owner, name, real)
        with ExitStack() as all_of_them:
            for process in processes:
                all_of_them.callback(process.part(Terminal).release)


def _from_test(stream: Any) -> bool:
    """Return whether the test has replaced `sys.stdin` by a stream such as StringIO."""
    of_pytest = type(stream).__module__.startswith("_pytest.")
    return not (stream is None or of_pytest or isinstance(stream, io.TextIOWrapper | _StandardInput))


def _input(real: Callable[..., str], replaced: _StandardInput) -> Callable[..., str]:
    def input(prompt: object = "", /) -> str:  # noqa: A001
        terminal = own_terminal()
        if terminal is None or sys._getframe(1).f_globals.get("__name__") in _DEBUGGERS:
            with replaced.by_real():
                return real(prompt)
        sys.stdout.write(str(prompt))
        return terminal.readline().removesuffix("\n")

    return input


def _read(real: Callable[[int, int], bytes]) -> Callable[[int, int], bytes]:
    def read(fd: int, length: int, /) -> bytes:
        terminal = own_terminal()
        return (
            terminal.buffer.read(length) if terminal is not None and terminal.owns(fd) else real(fd, length)
        )

    return read
