"""Worker processes and how they are spoken to; a worker that dies costs its episode another try, not the run."""

from __future__ import annotations

import subprocess
import sys
import threading
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from typing import BinaryIO

from pytest_tarl.errors import TarlError
from pytest_tarl.working import wire

TRIES = 3  # times that an episode is run whose worker dies
PATIENCE = 5.0  # seconds in which a worker may finish its fixtures before it is ended
BOOT = Path(__file__).with_name("boot.py")


class WorkerDiedError(TarlError):
    """A worker process ended in the middle of an episode."""


@dataclass(frozen=True)
class Post:
    """What a worker is there for: where it is started, what pytest is set up with, and its first message."""

    folder: str
    start: str
    first: bytes
    loud: bool = False  # whether what nodes print is shown


class Worker:
    """One process that runs episodes of one test."""

    def __init__(self, post: Post) -> None:
        self._log = TemporaryFile()  # noqa: SIM115 - as long as the process
        self._process = subprocess.Popen(
            [sys.executable, str(BOOT), post.start],
            cwd=post.folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=None if post.loud else self._log,
        )
        self._post = post

    def greet(self) -> None:
        """Wait until it holds its test ready. Raises TarlError where it cannot, WorkerDiedError."""
        greeting = self.ask(self._post.first)
        if greeting != wire.READY:
            wire.refused(greeting)

    def ask(self, request: bytes) -> bytes:
        """Send a request and return the answer. Raises WorkerDiedError."""
        asked, told = self._pipes()
        try:
            wire.write(asked, request)
            answer = wire.read(told)
        except (OSError, ValueError):  # the latter of a pipe that `end` has closed
            answer = None
        if answer is None:
            raise WorkerDiedError(self._last_words())
        return answer

    def _last_words(self) -> str:
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(PATIENCE)
        with suppress(OSError, ValueError):
            self._log.seek(0)
            said = self._log.read().decode(errors="replace").strip().splitlines()
            if said:
                return f"ended with status {self._process.returncode}: {said[-1]}"
        return f"ended with status {self._process.returncode}"

    def dismiss(self) -> None:
        """Let it tear down its fixtures and go; end it when that takes too long."""
        with suppress(OSError, ValueError):
            wire.write(self._pipes()[0], b"")
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(PATIENCE)
        self.end()

    def end(self) -> None:
        """End it now, whatever it does."""
        self._process.kill()
        self._process.wait()
        for pipe in (*self._pipes(), self._log):
            with suppress(OSError):
                pipe.close()

    def _pipes(self) -> tuple[BinaryIO, BinaryIO]:
        process = self._process
        assert process.stdin is not None  # noqa: S101 - told to the type checker: both were asked for
        assert process.stdout is not None  # noqa: S101
        return process.stdin, process.stdout  # type: ignore[return-value]


class Pool:
    """The workers of this process, by what they are there for; started as they are needed."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._idle: dict[Post, list[Worker]] = {}
        self._busy: list[Worker] = []
        self._closed = False

    def serve(self, post: Post, request: bytes) -> bytes:
        """Let a free worker answer. Raises WorkerDiedError when as many as `TRIES` died of it."""
        for _ in range(TRIES - 1):
            with suppress(WorkerDiedError):
                return self._once(post, request)
        return self._once(post, request)

    def close(self) -> None:
        """Dismiss the idle workers and end the others."""
        with self._lock:
            self._closed = True
            busy, idle = self._busy[:], [worker for all_of in self._idle.values() for worker in all_of]
            self._idle.clear()
        for worker in busy:
            worker.end()
        leaving = [threading.Thread(target=worker.dismiss) for worker in idle]
        for one in leaving:
            one.start()
        for one in leaving:
            one.join()

    def _once(self, post: Post, request: bytes) -> bytes:
        worker = self._idle_one(post)
        known = worker is not None
        worker = worker or Worker(post)
        with self._lock:
            self._busy.append(worker)
        try:
            if self._closed:
                raise WorkerDiedError("not needed any more: the run is over")
            if not known:
                worker.greet()
            answer = worker.ask(request)
        except BaseException:
            worker.end()
            self._move(worker, None)
            raise
        self._move(worker, post)
        return answer

    def _idle_one(self, post: Post) -> Worker | None:
        with self._lock:
            waiting = self._idle.get(post)
            return waiting.pop() if waiting else None

    def _move(self, worker: Worker, post: Post | None) -> None:
        """Take a worker from its work, to wait for more where a post is given."""
        with self._lock:
            self._busy.remove(worker)
            if post is not None:
                self._idle.setdefault(post, []).append(worker)
