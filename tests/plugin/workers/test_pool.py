"""Workers without processes: heartbeats, silence, and the end of a pool."""

from __future__ import annotations

import io
import threading
from time import sleep
from typing import Any

import pytest

from pytest_tarl.workers import pool, protocol
from pytest_tarl.workers.pool import Pool, Post, Worker, WorkerDiedError, WorkerHeldError

POST = Post("/", "{}", b"first")


class Process:
    """A process that answers with the given bytes and stores how it is ended."""

    def __init__(self, *answers: bytes) -> None:
        self.stdin, self.stdout = io.BytesIO(), io.BytesIO()
        for one in answers:
            protocol.write(self.stdout, one)
        self.stdout.seek(0)
        self.signals: list[str] = []
        self.returncode = 3

    def send_signal(self, number: int) -> None:
        self.signals.append(f"signal {number}")

    def kill(self) -> None:
        self.signals.append("kill")

    def wait(self, timeout: float | None = None) -> int:
        return self.returncode


def worker(process: Any, log: bytes = b"") -> Worker:
    one: Worker = object.__new__(Worker)
    one._process, one._post = process, POST
    one._log = io.BytesIO(log)  # type: ignore[assignment]
    one._asked = one._held = False
    one._silent = 0
    one._over = threading.Event()
    return one


class Contested(io.BytesIO):
    """A pipe that another thread closes at the same time."""

    def close(self) -> None:
        super().close()
        raise ValueError("I/O operation on closed file")


def test_two_threads_may_end_a_worker() -> None:
    process = Process()
    process.stdin, process.stdout = Contested(), Contested()
    one = worker(process)
    one.end()
    assert process.stdin.closed
    assert process.stdout.closed
    assert one._log.closed


class Checks(threading.Event):
    """Run the checks of a listener one after the other, without waiting."""

    def __init__(self, *before: Any) -> None:
        super().__init__()
        self.before = [*before]
        self.count = 0

    def wait(self, timeout: float | None = None) -> bool:
        self.count += 1
        if not self.before:
            return True
        self.before.pop(0)()
        return False


def nothing() -> None:
    pass


def test_each_message_of_a_worker_resets_its_silence_counter() -> None:
    one = worker(Process(protocol.ALIVE, protocol.ALIVE, b"answer"))
    found = []
    read = protocol.read

    def read_late(pipe: Any) -> bytes | None:
        one._silent += 10
        found.append((one._silent, one._asked))
        return read(pipe)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(protocol, "read", read_late)
        one._silent = 7
        assert one.ask(b"request") == b"answer"
    assert found == [(10, True)] * 3
    assert not one._asked
    assert protocol.read(io.BytesIO(one._process.stdin.getvalue())) == b"request"  # type: ignore[union-attr]


@pytest.mark.parametrize(("checks", "ended"), [(3, False), (4, True), (9, True)])
def test_silent_worker_is_ended(checks: int, ended: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "SILENCE", 3)
    one = worker(Process())
    one._asked = True
    one._over = Checks(*[nothing] * checks)
    one._listen()
    assert one._held is ended
    assert one._process.signals == (["signal 6", "kill"] if ended else [])  # type: ignore[attr-defined]
    assert one._over.count == min(checks + 1, 4)


def test_a_worker_without_a_request_may_be_silent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "SILENCE", 3)
    one = worker(Process())
    one._over = Checks(*[nothing] * 20)
    one._listen()
    assert not one._held


LOG = b"""Fatal Python error: Aborted
  File "%s/workers/worker.py", line 3 in answer
  File "/robot/keeper.py", line 12 in control
"""


def test_the_error_states_how_a_worker_ended() -> None:
    with pytest.raises(WorkerDiedError, match=r"^ended with status 3: last words$"):
        worker(Process(), b"first\nlast words\n").ask(b"request")
    with pytest.raises(WorkerDiedError, match=r"^ended with status 3$"):
        worker(Process()).ask(b"request")
    held = worker(Process(), LOG % str(pool.WORKER_MAIN.parent.parent).encode())
    held._held = True
    with pytest.raises(WorkerHeldError, match=r"keeper\.py.*12"):
        held.ask(b"request")


def test_unprepared_test_gives_the_reason() -> None:
    with pytest.raises(pool.TarlError, match="no marker"):
        worker(Process(protocol.error_message(pool.TarlError("no marker")))).greet()


class Idle:
    """A worker that takes some time to leave."""

    def __init__(self) -> None:
        self.said: list[str] = []

    def dismiss(self) -> None:
        sleep(0.05)
        self.said.append("dismissed")

    def end(self) -> None:
        self.said.append("ended")


def test_closing_a_pool_ends_busy_workers() -> None:
    workers: list[Any] = [Idle() for _ in range(4)]
    one = Pool()
    one._idle = {POST: workers[:2], Post("/x", "", b""): workers[2:3]}
    one._busy = workers[3:]
    one.close()
    assert [worker.said for worker in workers] == [["dismissed"]] * 3 + [["ended"]]
    assert one._idle == {}


class Dying:
    """A kind of worker that dies in its first requests."""

    deaths, made = 0, 0

    def __init__(self, post: Post) -> None:
        type(self).made += 1
        self.ends = 0

    def greet(self) -> None:
        pass

    def ask(self, request: bytes) -> bytes:
        if type(self).deaths:
            type(self).deaths -= 1
            raise WorkerDiedError("ended")
        return b"answer to " + request

    def end(self) -> None:
        self.ends += 1


@pytest.mark.parametrize("deaths", [0, 2, 3])
def test_request_is_tried_on_three_workers(deaths: int, monkeypatch: pytest.MonkeyPatch) -> None:
    kind = type("Kind", (Dying,), {"deaths": deaths, "made": 0})
    monkeypatch.setattr(pool, "Worker", kind)
    one = Pool()
    if deaths == 3:
        with pytest.raises(WorkerDiedError):
            one.serve(POST, b"x")
        assert (one._busy, one._idle, kind.made) == ([], {}, 3)  # type: ignore[attr-defined]
        return
    assert one.serve(POST, b"x") == b"answer to x"
    assert kind.made == deaths + 1  # type: ignore[attr-defined]
    (kept,) = one._idle[POST]
    assert one.serve(POST, b"y") == b"answer to y"
    assert one._idle == {POST: [kept]}
    assert kind.made == deaths + 1  # type: ignore[attr-defined]
    assert one._busy == []


def test_a_closed_pool_starts_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "Worker", Dying)
    one = Pool()
    one.close()
    with pytest.raises(WorkerDiedError, match="the run is over"):
        one.serve(POST, b"x")
    assert one._busy == []
