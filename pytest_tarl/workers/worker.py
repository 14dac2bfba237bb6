"""The main loop of a worker: it runs one episode of one test per request."""

from __future__ import annotations

import _thread
import json
import os
import sys
import threading
import traceback
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, BinaryIO

import pytest
from _pytest.config import Config

from pytest_tarl.errors import TarlError
from pytest_tarl.item_episode import Instruments, designated
from pytest_tarl.repeating import ItemRollout, finish
from pytest_tarl.rollout import Rollout
from pytest_tarl.scenarios import without_drift
from pytest_tarl.sensors import with_edges
from pytest_tarl.workers import protocol
from pytest_tarl.workers.replaying import replaying

MEMORIES = ("lfplugin", "nfplugin", "stepwiseplugin")
BEAT = 1.0  # seconds between two heartbeats
ENDED = 70  # exit status after the parent run has ended


def serve(requests: int, answers: int, config: Config | None, problem: str) -> None:
    """Serve the parent process until it closes the pipe or exits.

    `requests` and `answers` are pipe descriptors. `config` is pytest's configuration; if there is none, `problem` is
    the error.
    """
    alive, told = os.pipe()
    _thread.start_new_thread(_forwarded, (requests, told))
    with os.fdopen(alive, "rb") as asked, os.fdopen(answers, "wb") as said:
        first = protocol.read(asked)
        if not first:
            return
        if config is None:
            protocol.write(said, protocol.error_message(TarlError(problem)))
            return
        post: dict[str, Any] = json.loads(first)
        server = Server(post, asked, said)
        config.pluginmanager.register(server, "tarl-worker")
        config.hook.pytest_cmdline_main(config=config)
        server.refuse("no test was run")


class Server:
    """The pytest plugin that answers requests instead of running tests."""

    def __init__(self, post: dict[str, Any], requests: BinaryIO, answers: BinaryIO) -> None:
        self.post = post
        self.requests = requests
        self.answers = answers
        self.problems: list[str] = []
        self.serving = False
        self.turn = threading.Lock()

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Store the reason why a test could not be collected."""
        if report.failed:
            self.problems.append(report.longreprtext)

    def pytest_internalerror(self, excrepr: object) -> None:
        """Store an internal error of pytest or of a plugin."""
        self.problems.append(str(excrepr))

    def pytest_sessionstart(self, session: pytest.Session) -> None:
        """Disable the cache of failed tests, which only the parent run writes."""
        for name in MEMORIES:
            session.config.pluginmanager.unregister(name=name)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Run an episode for each request."""
        replays = self.post["instruments"] is None
        named = without_drift if replays else _nodeid
        wanted = [item for item in session.items if named(item) == self.post["nodeid"]]
        if not wanted or not isinstance(wanted[0], pytest.Function):
            self.refuse(f"{self.post['nodeid']} was not collected")
            return True
        item = wanted[0]
        marked = designated(item)
        if marked is None:
            self.refuse(f"{item.nodeid} has no tarl marker")
            return True
        edges = {name: tuple(ends) for name, ends in self.post["edges"].items()}
        told = replace(marked, sensors=with_edges(marked.sensors, edges))
        if replays:
            try:
                rollout: Rollout = replaying(item, told, self.post["sensors"], self.post["sites"])
            except TarlError as problem:
                self.refused(problem)
                return True
        else:
            rollout = ItemRollout(item, told, instruments(self.post["instruments"]))
        self.serving = True
        self._say(protocol.READY)
        _thread.start_new_thread(self._beat, ())
        while request := protocol.read(self.requests):  # an empty request or a closed pipe ends the session
            self._say(answer(rollout, request))
        finish(item, None)
        return True

    def _say(self, message: bytes) -> None:
        with self.turn:
            protocol.write(self.answers, message)

    def _beat(self) -> None:
        """Send heartbeats; a worker without heartbeats is ended by its parent."""
        pause = threading.Event()
        with suppress(OSError, ValueError):  # the parent run has ended
            while not pause.wait(BEAT):
                self._say(protocol.ALIVE)

    def refuse(self, problem: str) -> None:
        """Answer the first request with the reason why the test cannot be prepared."""
        self.refused(TarlError("\n".join([problem, *self.problems])))

    def refused(self, problem: TarlError) -> None:
        """Answer the first request with an error."""
        if not self.serving:
            protocol.write(self.answers, protocol.error_message(problem))
            self.serving = True


def _nodeid(item: pytest.Item) -> str:
    return item.nodeid


def answer(rollout: Rollout, request: bytes) -> bytes:
    """Run the requested episode; if it fails, return the error as the answer."""
    try:
        return protocol.run_message(rollout(protocol.planned(request)))
    except TarlError as problem:
        return protocol.error_message(problem)
    except pytest.skip.Exception as skipped:
        return protocol.error_message(protocol.SkippedError(str(skipped)))
    except pytest.exit.Exception as ended:
        return protocol.error_message(protocol.EndedError(str(ended)))
    except Exception:
        return protocol.error_message(
            TarlError(f"An episode failed in a worker process:\n{traceback.format_exc()}")
        )


def instruments(given: dict[str, Any]) -> Instruments:
    """Return the instruments: which sites to record in each node."""
    positions = {
        Path(path): {(line, column): number for line, column, number in places}
        for path, places in given["positions"].items()
    }
    return Instruments(positions, frozenset(given["publishes"]))


def _forwarded(requests: int, told: int) -> None:
    """Forward requests. When the parent run ends, end this process at once, even while a node runs.

    The thread that runs this is not listed by `threading`, because the recorder assumes that every listed thread runs
    nodes.
    """
    while chunk := os.read(requests, 1 << 16):
        while chunk:
            chunk = chunk[os.write(told, chunk) :]
    sys.stderr.flush()
    os._exit(ENDED)
