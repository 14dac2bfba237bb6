"""Worker processes, with retries after a worker dies."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from typing import BinaryIO

from pytest_tarl.errors import TarlError
from pytest_tarl.held_interpreter import SIGNAL
from pytest_tarl.ros.blame import describe_first
from pytest_tarl.workers import protocol

TRIES = 3  # maximum number of runs of an episode if its worker dies
PATIENCE = 5.0  # time for tearing down fixtures before a worker is killed (s)
# a worker is ended after this many checks (one per second) without a heartbeat; while the machine is suspended, there
# are no checks
SILENCE = 180
_FRAME = re.compile(r'^ *File "(.+)", line (\d+) in (.+)$', re.MULTILINE)
WORKER_MAIN = Path(__file__).with_name("worker_main.py")


class WorkerDiedError(TarlError):
    """A worker process died during an episode."""


class WorkerHeldError(TarlError):
    """A worker was ended because a node held its interpreter lock."""


@dataclass(frozen=True)
class Post:
    """A worker's job: folder, pytest's configuration, and the first message."""

    folder: str
    start: str
    first: bytes
    loud: bool = False  # whether to show the nodes' output


class Worker:
    """One process that runs episodes of one test."""

    def __init__(self, post: Post) -> None:
        self._log = TemporaryFile()  # noqa: SIM115 - open as long as the process runs
        self._process = subprocess.Popen(
            [sys.executable, str(WORKER_MAIN), post.start],
            cwd=post.folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=None if post.loud else self._log,
        )
        self._post = post
        self._asked = False
        self._silent = 0
        self._held = False
        self._over = threading.Event()

    def greet(self) -> None:
        """Send the first message and wait until the worker has prepared its test.

        Raise TarlError if the worker cannot prepare it, WorkerDiedError if it dies.
        """
        greeting = self.ask(self._post.first)
        if greeting != protocol.READY:
            protocol.refused(greeting)
        threading.Thread(target=self._listen, name="tarl-listener", daemon=True).start()

    def ask(self, request: bytes) -> bytes:
        """Send a request; return the answer. Raise WorkerDiedError or WorkerHeldError."""
        asked, told = self._pipes()
        self._silent, self._asked = 0, True
        try:
            protocol.write(asked, request)
            while (answer := protocol.read(told)) == protocol.ALIVE:
                self._silent = 0
        except (OSError, ValueError):  # ValueError if `end` has closed the pipe
            answer = None
        finally:
            self._asked = False
        if answer is None:
            said = self._last_words()
            if self._held or self._process.returncode == -(SIGNAL or 0):
                raise WorkerHeldError(place_held(self._log_text()))
            raise WorkerDiedError(said)
        return answer

    def _listen(self) -> None:
        """Check for heartbeats once per second.

        After SILENCE checks without one, end the worker, so that it cannot block the run.
        """
        while not self._over.wait(1.0):
            self._silent += self._asked
            if self._silent > SILENCE:
                self._held = True
                with suppress(OSError, subprocess.TimeoutExpired):
                    self._process.send_signal(
                        signal.SIGABRT
                    )  # pytest has enabled faulthandler, which then prints the stack
                    self._process.wait(PATIENCE)
                self._process.kill()
                return

    def _last_words(self) -> str:
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(PATIENCE)
        said = self._log_text().strip().splitlines()
        return f"ended with status {self._process.returncode}" + (f": {said[-1]}" if said else "")

    def _log_text(self) -> str:
        with suppress(OSError, ValueError):
            self._log.seek(0)
            return self._log.read().decode(errors="replace")
        return ""

    def dismiss(self) -> None:
        """Let the worker tear down; end it after PATIENCE seconds if it has not finished."""
        with suppress(OSError, ValueError):
            protocol.write(self._pipes()[0], b"")
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(PATIENCE)
        self.end()

    def end(self) -> None:
        """End the worker immediately.

        Two threads may call this: the one waiting for the worker, and the one stopping the run.
        """
        self._over.set()
        self._process.kill()
        self._process.wait()
        for pipe in (*self._pipes(), self._log):
            with suppress(OSError, ValueError):  # ValueError if another thread has just closed the pipe
                pipe.close()

    def _pipes(self) -> tuple[BinaryIO, BinaryIO]:
        process = self._process
        assert process.stdin is not None  # noqa: S101 - for the type checker: both are pipes
        assert process.stdout is not None  # noqa: S101
        return process.stdin, process.stdout  # type: ignore[return-value]


def place_held(log: str) -> str:
    """Return the place of the innermost user code in faulthandler's output, or an empty text."""
    ours = str(WORKER_MAIN.parent.parent)
    frames = [
        (file, int(line), function)
        for file, line, function in _FRAME.findall(log)
        if not file.startswith(ours)
    ]
    return describe_first(frames)


class Pool:
    """The workers of this process by job; several threads may use them."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._idle: dict[Post, list[Worker]] = {}
        self._busy: list[Worker] = []
        self._closed = False

    def serve(self, post: Post, request: bytes) -> bytes:
        """Run a request. Raise WorkerDiedError if TRIES workers died in a row."""
        for _ in range(TRIES - 1):
            with suppress(WorkerDiedError):
                return self._once(post, request)
        return self._once(post, request)

    def close(self) -> None:
        """Dismiss idle workers and end the others."""
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
                raise WorkerDiedError("not needed: the run is over")
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
        """Remove a worker from the busy ones; if `post` is given, keep it for that job."""
        with self._lock:
            self._busy.remove(worker)
            if post is not None:
                self._idle.setdefault(post, []).append(worker)
