"""The guardian: a process that runs a simulator.

The guardian reads commands and writes events, one JSON line each.

It ends the simulator's processes when the test asks for it, or when the test's process has ended.
"""

from __future__ import annotations

import json
import os
import sys
import threading
import traceback
import xmlrpc.client
from collections import deque
from contextlib import suppress
from time import monotonic, sleep
from typing import Any

from pytest_tarl.errors import TarlError
from pytest_tarl.external.descendants import outlive_the_test, wait_for_end_of_parent
from pytest_tarl.external.domain import Domain
from pytest_tarl.external.group import Group
from pytest_tarl.external.link import Link
from pytest_tarl.external.link_ros1 import LinkROS1
from pytest_tarl.rosmaster import Master

LOOK = 0.05  # seconds between two checks of the ROS graph during the first CALM seconds; later 1 s
CALM = 5.0  # seconds during which the ROS graph is checked every LOOK seconds
LAST = 20.0  # seconds after the end of the test until a hanging simulator is killed


class Guardian:
    """The main loop of the process, for one simulator at a time."""

    def __init__(self, events: int) -> None:
        self._events = os.fdopen(events, "w", buffering=1, encoding="utf-8")
        self._commands: deque[dict[str, Any] | None] = deque()
        self._arrival = threading.Event()
        self._waking = threading.Lock()  # held while another thread wakes or removes a link
        self._group: Group | None = None
        self._domain: Domain | None = None
        self._master: Master | None = None
        self._link: Link | LinkROS1 | None = None
        self._begun = self._looked = 0.0
        self._ended = False

    def read(self) -> None:
        """Read commands until the test's process has ended; runs in a thread."""
        try:
            for line in sys.stdin:
                self._put(json.loads(line))
        except ValueError:  # the test was killed in the middle of a line
            pass
        finally:
            self._finish()

    def watch(self) -> None:
        """Wait until the test's process ends; runs in a thread.

        The end of stdin does not show this, because forked children of the test may keep stdin open.
        """
        try:
            wait_for_end_of_parent()
        except OSError:  # the kernel is too old for this wait, or the test has already ended
            return
        self._finish()

    def run(self) -> None:
        """Handle commands and events until there are no more commands."""
        try:
            while True:
                while self._commands:
                    command = self._commands.popleft()
                    if command is None:
                        return
                    getattr(self, f"_do_{command.pop('do')}")(**command)
                self._wait()
        finally:
            self._do_stop()

    def _finish(self) -> None:
        with suppress(Exception):
            self._put(None)
        sleep(LAST)
        if self._group is not None:
            self._group.kill()
        os._exit(1)

    def _put(self, command: dict[str, Any] | None) -> None:
        self._commands.append(command)
        self._arrival.set()
        with self._waking:
            if self._link is not None:
                self._link.wake()

    def _wait(self) -> None:
        if self._link is None:
            self._arrival.wait()
            self._arrival.clear()
            return
        now = monotonic()
        if now - self._looked > (LOOK if now - self._begun < CALM else 1.0):
            self._looked = now
            self._link.look()
        if not self._commands:
            self._link.spin(LOOK)
        if self._group is not None and not self._ended and self._group.status is not None:
            self._ended = True
            self.say({"kind": "ended", "status": self._group.status})

    def say(self, event: dict[str, Any]) -> None:
        """Write an event."""
        try:
            self._events.write(json.dumps(event, separators=(",", ":")) + "\n")
        except OSError:  # the test's process has ended
            self._commands.append(None)

    def _do_start(
        self,
        command: list[str],
        folder: str,
        environment: dict[str, str],
        clock: str,
        topics: list[str],
        ros: str = "ros2",
    ) -> None:
        self._do_stop()
        try:
            own = self._network(ros)
        except TarlError as problem:
            self.say({"kind": "failed", "reason": str(problem)})
            return
        os.environ.update(own)
        self._ended = False
        try:
            self._group = Group(command, folder, {**environment, **own})
        except OSError as problem:
            self.say({"kind": "failed", "reason": problem.strerror or str(problem)})
            return
        self._begun = monotonic()
        domain = self._domain
        self._link = LinkROS1(clock, self.say) if domain is None else Link(domain.number, clock, self.say)
        self._link.subscribe(topics)

    def _network(self, ros: str) -> dict[str, str]:
        """Return the environment for the simulator's private network."""
        if ros == "ros1":
            self._master = Master()
            with xmlrpc.client.ServerProxy(self._master.uri) as master:
                master.setParam("/tarl", "/use_sim_time", True)
            return self._master.variables
        self._domain = Domain()
        return {
            "ROS_DOMAIN_ID": str(self._domain.number),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",  # shared memory would leave files in /dev/shm after a kill
        }

    def _do_stop(self) -> None:
        with self._waking:
            link, self._link = self._link, None
        if self._group is not None:
            self._group.end()
        if link is not None:
            link.close()
        if self._domain is not None:
            self._domain.release()
        if self._master is not None:
            self._master.close()
        self._group = self._domain = self._master = None
        self.say({"kind": "stopped"})

    def _do_subscribe(self, topics: list[str]) -> None:
        if self._link is not None:
            self._link.subscribe(topics)
            self._link.look()
            self._begun = monotonic()

    def _do_send(self, topic: str, data: dict[str, Any]) -> None:
        if self._link is not None:
            self._link.send(topic, data)

    def _do_call(self, **asked: Any) -> None:
        if self._link is not None:
            self._link.call(asked)


def main() -> None:
    """Reserve stdout for events, and outlive the test."""
    outlive_the_test()
    events = os.dup(1)
    os.dup2(2, 1)
    guardian = Guardian(events)
    for follow in (guardian.read, guardian.watch):
        threading.Thread(target=follow, daemon=True).start()
    try:
        guardian.run()
    except Exception:
        traceback.print_exc()
        os._exit(1)
    os._exit(0)  # do not wait for threads of the middleware
