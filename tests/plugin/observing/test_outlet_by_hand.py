"""The outlet and the memory that it shares with the writer, without a writer process."""

from __future__ import annotations

import io
import json
import marshal
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.errors import LogError
from pytest_tarl.observing import outlet, ring
from pytest_tarl.observing.outlet import ENDED, Outlet
from pytest_tarl.observing.ring import Ring, shared_memory
from pytest_tarl.observing.writer import Rotation
from pytest_tarl.observing.writer_main import LENGTH


class WriterProcess:
    """A writer process that says these lines, and ends when the test says so."""

    def __init__(self, *lines: str) -> None:
        self.stdout: Any = io.BytesIO("".join(f"{line}\n" for line in lines).encode())
        self.stdin: Any = io.BytesIO()
        self.status: int | None = None
        self.returncode = 0
        self.communicated = 0

    def poll(self) -> int | None:
        return self.status

    def communicate(self) -> None:
        assert self.stdin is None or not self.stdin.closed  # a closed pipe must be removed before
        self.communicated += 1


OpenOutlet = Callable[..., tuple[Outlet, WriterProcess, Ring]]


@pytest.fixture
def connect(monkeypatch: pytest.MonkeyPatch) -> OpenOutlet:
    """Return a function that makes an outlet whose writer says these lines; the ring is the writer's end."""

    def made(*lines: str, size: int = 400) -> tuple[Outlet, WriterProcess, Ring]:
        process, given = WriterProcess(*lines), dict[str, Any]()
        ends: list[Ring] = []

        def popen(command: list[str], **how: Any) -> WriterProcess:
            given.update(how, command=command)
            (memory,) = how["pass_fds"]
            ends.append(Ring(memory))
            return process

        monkeypatch.setattr(ring, "SIZE", size)
        monkeypatch.setattr(outlet, "_PIECE", size // 4)
        monkeypatch.setattr(subprocess, "Popen", popen)
        one = Outlet(Path("the log"), {"node": "n"}, Rotation(9, 2))
        assert given["command"][:3] == [sys.executable, "-m", "pytest_tarl.observing.writer_main"]
        order = json.loads(given["command"][3])
        assert order == {
            "log": "the log",
            "about": {"node": "n"},
            "rotation": [9, 2],
            "ring": given["pass_fds"][0],
        }
        assert (given["stdin"], given["stdout"], given["bufsize"]) == (subprocess.PIPE, subprocess.PIPE, 0)
        with pytest.raises(OSError, match="Bad file descriptor"):
            os.fstat(order["ring"])
        return one, process, ends[0]

    return made


def taken(end: Ring, rest: bytearray | None = None) -> list[Any]:
    """Return the messages in the ring; an end mark is the text END."""
    waiting = bytearray() if rest is None else rest
    while (piece := end.read()) is not None:
        waiting += piece
    found = []
    while len(waiting) >= LENGTH.size:
        (length,) = LENGTH.unpack_from(waiting)
        if len(waiting) < LENGTH.size + length:
            break
        found.append(marshal.loads(waiting[LENGTH.size : LENGTH.size + length]) if length else "END")
        del waiting[: LENGTH.size + length]
    return found


@pytest.mark.parametrize(
    ("lines", "says"), [(("log is damaged",), "log is damaged"), ((), "the writer's process")]
)
def test_a_writer_that_cannot_write_is_reported(
    connect: OpenOutlet, lines: tuple[str, ...], says: str
) -> None:
    with pytest.raises(LogError, match=says):
        connect(*lines)


def test_small_messages_go_into_the_shared_memory_at_once(connect: OpenOutlet) -> None:
    one, _, end = connect("ready")
    one.put("start", 1.5)
    one.put("mission", 2.0)
    assert (one.unsent, one.full, one.problem) == (end.unread, False, "")
    assert taken(end) == [("start", 1.5), ("mission", 2.0)]
    assert one.unsent == 0


def test_large_messages_are_sent_in_ordered_pieces(connect: OpenOutlet) -> None:
    one, _, end = connect("ready")
    texts = ["a" * 10, "b" * 1000, "c" * 10]
    for text in texts:
        one.put(text)
    assert (one.unsent > 1000, [*map(len, one._waiting)][:2]) == (True, [100, 100])
    assert one._held == sum(map(len, one._waiting))
    found, rest = [], bytearray()
    for _ in range(20):
        one.pump()
        found += taken(end, rest)
    assert found == [(text,) for text in texts]
    assert (one.unsent, len(one._waiting), one._held) == (0, 0, 0)


def test_an_outlet_is_full_if_too_many_bytes_wait(
    connect: OpenOutlet, monkeypatch: pytest.MonkeyPatch
) -> None:
    one, _, end = connect("ready")
    one.put("x" * 200)
    held = one._held
    monkeypatch.setattr(outlet, "MOST_WAITING", held)
    assert not one.full
    monkeypatch.setattr(outlet, "MOST_WAITING", held - 1)
    assert one.full
    one.pump()
    taken(end)
    assert not one.full


@pytest.mark.parametrize("says", ["the disk is full", ""])
def test_ended_writer_receives_nothing_more(connect: OpenOutlet, says: str) -> None:
    one, process, _ = connect("ready", *([says] if says else []))
    for _ in range(3):
        one.put("x" * 900)
    process.status = 1
    for _ in range(10):
        assert not one.problem
        one.pump()
    assert one.problem == (says or ENDED)
    assert (len(one._waiting), one._held) == (0, 0)
    one.put("more")
    assert not one._waiting
    process.stdout = io.BytesIO(b"something else\n")
    for _ in range(20):
        one.pump()
    assert one.problem == (says or ENDED)


@pytest.mark.parametrize(
    ("lines", "status", "problem"),
    [((), 0, ""), (("some bytes are lost",), 1, "some bytes are lost"), ((), -9, ENDED)],
)
def test_closing_sends_everything_and_an_end_mark(
    connect: OpenOutlet, monkeypatch: pytest.MonkeyPatch, lines: tuple[str, ...], status: int, problem: str
) -> None:
    one, process, end = connect("ready", *lines)
    found: list[Any] = []
    rest = bytearray()
    pauses: list[float] = []

    def pause(seconds: float) -> None:
        pauses.append(seconds)
        found.extend(taken(end, rest))

    monkeypatch.setattr(outlet, "sleep", pause)
    process.returncode = status
    for text in ("a" * 900, "b"):
        one.put(text)
    pipe = process.stdin
    one.close()
    found += taken(end, rest)
    assert found == [("a" * 900,), ("b",), "END"]
    assert (pipe.closed, process.stdin, process.communicated, one.problem) == (True, None, 1, problem)
    assert 0 < len(pauses) < 20
    assert set(pauses) == {0.005}


def test_closing_does_not_wait_for_an_ended_writer(
    connect: OpenOutlet, monkeypatch: pytest.MonkeyPatch
) -> None:
    one, process, _ = connect("ready", "the disk is full")
    one.put("a" * 9000)
    process.status = 1
    pauses: list[float] = []
    monkeypatch.setattr(outlet, "sleep", pauses.append)
    one.close()
    assert (one.problem, len(pauses)) == ("the disk is full", 9)


def test_a_forked_child_sends_nothing(connect: OpenOutlet, monkeypatch: pytest.MonkeyPatch) -> None:
    one, process, end = connect("ready")
    one.put("a" * 200)
    child = os.getpid() + 1
    monkeypatch.setattr(os, "getpid", lambda: child)
    one.put("b")
    one.pump()
    one.close()
    assert (taken(end), one._pumped, process.communicated) == ([], 0, 0)


@pytest.mark.parametrize("named", [True, False])
def test_shared_memory_is_filled_with_zeros_and_large_enough(
    named: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ring, "SIZE", 100)
    if not named:
        monkeypatch.delattr(os, "memfd_create", raising=False)
    memory = shared_memory()
    try:
        assert os.fstat(memory).st_size == 116
        one = Ring(memory)
        assert (bytes(one._memory), one._size, one.unread) == (bytes(116), 100, 0)
        one._memory[:] = b"x" * 116
        assert bytes(Ring(memory, writes=True)._memory) == bytes(116)
    finally:
        os.close(memory)
