"""The main loop of the guardian, with stand-ins for the simulator's processes, its network and the middleware."""

from __future__ import annotations

import io
import json
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest

from pytest_tarl.errors import SettingsError
from pytest_tarl.external import guardian as module
from pytest_tarl.external.guardian import CALM, LAST, LOOK, Guardian

LOG = list[tuple[Any, ...]]


class Part:
    """A stand-in for a group, a link, a domain or a master that records its calls."""

    number = 7
    uri = "http://master"
    variables = MappingProxyType({"ROS_MASTER_URI": "http://master"})

    def __init__(self, log: LOG, kind: str, *given: Any) -> None:
        self.log, self.kind, self.status = log, kind, None
        self.during: Callable[[], None] = lambda: None
        log.append((kind, *given))

    def __getattr__(self, name: str) -> Callable[..., None]:
        def noted(*given: Any) -> None:
            self.log.append((f"{self.kind}.{name}", *given))
            if name == "spin":
                self.during()

        return noted


class Now:
    """A clock that stands still until it is set."""

    def __init__(self) -> None:
        self.time = 100.0

    def __call__(self) -> float:
        return self.time


class Made:
    """A guardian, the recorded calls of its parts, and its events."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, events: Path) -> None:
        self.log: LOG = []
        self.now = Now()
        self.events = events
        self.guardian = Guardian(os.open(events, os.O_WRONLY | os.O_CREAT))
        self.failing: Exception | None = None

        def group(command: list[str], folder: str, environment: dict[str, str]) -> Part:
            if self.failing is not None:
                raise self.failing
            return Part(self.log, "group", command, folder, environment)

        @contextmanager
        def proxy(uri: str) -> Iterator[Any]:
            yield Part(self.log, "proxy", uri)

        monkeypatch.setattr(module, "Group", group)
        monkeypatch.setattr(module, "Link", lambda *given: Part(self.log, "link", *given))
        monkeypatch.setattr(module, "LinkROS1", lambda *given: Part(self.log, "link1", *given))
        monkeypatch.setattr(module, "Domain", lambda: Part(self.log, "domain"))
        monkeypatch.setattr(module, "Master", lambda: Part(self.log, "master"))
        monkeypatch.setattr(module.xmlrpc.client, "ServerProxy", proxy)
        monkeypatch.setattr(module, "monotonic", self.now)
        monkeypatch.setattr(module, "sleep", lambda seconds: self.log.append(("sleep", seconds)))
        monkeypatch.setattr(module.os, "_exit", lambda status: self.log.append(("exit", status)))

    def told(self) -> list[dict[str, Any]]:
        """Return the events so far: each one is written at once."""
        return [json.loads(line) for line in self.events.read_text().splitlines()]

    def handle(self, *commands: dict[str, Any]) -> None:
        """Run the main loop until it has handled these commands."""
        for command in commands:
            self.guardian._put(command)
        self.guardian._put(None)
        self.guardian.run()

    def names(self) -> list[str]:
        return [one[0] for one in self.log]


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Made]:
    variables = dict(os.environ)
    guardian = Made(monkeypatch, tmp_path / "events")
    with guardian.guardian._events:  # as it is now, also if the test replaces it
        yield guardian
    os.environ.clear()
    os.environ.update(variables)


def start(**changes: Any) -> dict[str, Any]:
    return {"do": "start", "command": ["sim"], "folder": "/p", "environment": {"A": "1", "ROS_DOMAIN_ID": "3"},
            "clock": "/clock", "topics": ["/odom"], **changes}  # fmt: skip


def test_ros2_simulator_runs_in_its_own_domain(made: Made) -> None:
    made.handle(start())
    own = {
        "ROS_DOMAIN_ID": "7",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
    }
    assert made.log == [
        ("domain",),
        ("group", ["sim"], "/p", {"A": "1", **own}),
        ("link", 7, "/clock", made.guardian.say),
        ("link.subscribe", ["/odom"]),
        ("group.end",),
        ("link.close",),
        ("domain.release",),
    ]
    assert {name: os.environ[name] for name in own} == own
    assert made.told() == [{"kind": "stopped"}, {"kind": "stopped"}]


def test_ros1_simulator_has_a_master_and_simulated_time(made: Made) -> None:
    made.handle(start(ros="ros1"))
    assert made.log == [
        ("master",),
        ("proxy", "http://master"),
        ("proxy.setParam", "/tarl", "/use_sim_time", True),
        ("group", ["sim"], "/p", {"A": "1", "ROS_DOMAIN_ID": "3", "ROS_MASTER_URI": "http://master"}),
        ("link1", "/clock", made.guardian.say),
        ("link1.subscribe", ["/odom"]),
        ("group.end",),
        ("link1.close",),
        ("master.close",),
    ]


@pytest.mark.parametrize(
    ("problem", "reason"),
    [
        (FileNotFoundError(2, "No such file or directory"), "No such file or directory"),
        (OSError("odd"), "odd"),
    ],
)
def test_a_command_that_cannot_be_started_is_reported(made: Made, problem: Exception, reason: str) -> None:
    made.failing = problem
    made.handle(start())
    assert made.told() == [{"kind": "stopped"}, {"kind": "failed", "reason": reason}, {"kind": "stopped"}]
    assert made.names() == ["domain", "domain.release"]


def test_a_ros_master_that_cannot_be_started_is_reported(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused() -> Part:
        raise SettingsError("no port is free")

    monkeypatch.setattr(module, "Master", refused)
    made.handle(start(ros="ros1"))
    assert made.told()[1] == {"kind": "failed", "reason": "no port is free"}
    assert made.names() == []


def test_commands_are_ignored_without_a_simulator(made: Made) -> None:
    commands: list[dict[str, Any]] = [
        {"do": "subscribe", "topics": ["/scan"]},
        {"do": "send", "topic": "/cmd", "data": {"data": 1.0}},
        {"do": "call", "id": 1, "service": "/step", "request": {}},
    ]
    made.handle(*map(dict, commands), start(), *map(dict, commands), {"do": "stop"}, *map(dict, commands))
    assert [one for one in made.log if one[0].startswith("link.")] == [
        ("link.subscribe", ["/odom"]),
        ("link.subscribe", ["/scan"]),
        ("link.look",),
        ("link.send", "/cmd", {"data": 1.0}),
        ("link.call", {"id": 1, "service": "/step", "request": {}}),
        ("link.close",),
    ]
    assert made.told() == [{"kind": "stopped"}] * 3


def test_a_new_simulator_ends_the_previous_simulator(made: Made) -> None:
    made.handle(start(), start(command=["other"]))
    one = ["domain", "group", "link", "link.subscribe", "group.end", "link.close", "domain.release"]
    assert made.names() == one * 2


def link_of(made: Made) -> Part:
    link = made.guardian._link
    assert isinstance(link, Part)
    return link


def looks(made: Made, times: list[float]) -> list[float]:
    """Return the times at which the guardian looks at the graph, if it waits at all of these times."""
    found = []
    for time in times:
        made.now.time = time
        before = made.names().count("link.look")
        made.guardian._wait()
        found += [time] * (made.names().count("link.look") - before)
    return found


def test_ros_graph_is_checked_often_at_first(made: Made) -> None:
    made.guardian._do_start(**{name: value for name, value in start().items() if name != "do"})
    quick = [100.0, 100.0 + LOOK / 2, 100.0 + LOOK * 1.5, 100.0 + LOOK * 2, 100.0 + LOOK * 3]
    assert looks(made, quick) == [quick[0], quick[2], quick[4]]
    slow = [105.0, 105.0 + LOOK * 2, 106.0, 106.1, 107.2]
    assert CALM == 5.0
    assert looks(made, slow) == [105.0, 106.1, 107.2]
    made.guardian._do_subscribe(
        ["/scan"]
    )  # the link has just looked; afterwards the checks are frequent again
    assert looks(made, [107.21, 107.2 + LOOK * 1.5]) == [107.2 + LOOK * 1.5]
    assert ("link.spin", LOOK) in made.log


def test_waiting_commands_come_before_messages(made: Made) -> None:
    made.guardian._do_start(**{name: value for name, value in start().items() if name != "do"})
    made.guardian._put({"do": "stop"})
    made.guardian._wait()
    assert "link.spin" not in made.names()
    assert made.names().count("link.wake") == 1


def test_end_of_each_simulator_is_reported_once(made: Made) -> None:
    arguments = {name: value for name, value in start().items() if name != "do"}
    for status in (3, -9):
        made.guardian._do_start(**arguments)
        made.guardian._wait()  # it still runs
        group: Any = made.guardian._group
        group.status = status
        made.guardian._wait()
        made.guardian._wait()
    stopped = {"kind": "stopped"}
    assert made.told() == [stopped, {"kind": "ended", "status": 3}, stopped, {"kind": "ended", "status": -9}]


def test_loop_handles_commands_in_order_until_the_test_ends(
    made: Made, monkeypatch: pytest.MonkeyPatch
) -> None:
    def arrive() -> None:
        made.guardian._put({"do": "send", "topic": "/cmd", "data": {}})
        made.guardian._put({"do": "stop"})
        made.guardian._put(None)
        made.guardian._put({"do": "start"})  # after the end of the test, so it is not handled

    original = module.Link
    monkeypatch.setattr(module, "Link", lambda *given: changed(original(*given), arrive))
    made.guardian._put(start())
    made.guardian.run()
    assert made.names()[-4:] == ["link.send", "group.end", "link.close", "domain.release"]
    assert made.told() == [{"kind": "stopped"}] * 3


def changed(link: Any, during: Callable[[], None]) -> Any:
    link.during = during
    return link


def test_loop_without_a_simulator_waits_for_commands(made: Made) -> None:
    waits: list[bool] = []
    wait = made.guardian._arrival.wait

    def waited(timeout: float | None = None) -> bool:
        waits.append(made.guardian._arrival.is_set())
        if not waits[-1]:
            made.guardian._put(None)
        return wait(timeout)

    made.guardian._arrival.wait = waited  # type: ignore[method-assign]
    made.guardian._put({"do": "stop"})
    made.guardian.run()
    assert waits == [True, False]


def test_if_nobody_reads_the_events_the_loop_ends(made: Made) -> None:
    class Closed:
        def write(self, _: str) -> None:
            raise BrokenPipeError

    made.guardian._events = Closed()  # type: ignore[assignment]
    made.guardian._put({"do": "stop"})
    made.guardian.run()
    assert [*made.guardian._commands] == [None]


@pytest.mark.parametrize("text", ['{"do": "stop"}\n', '{"do": "stop"}\n{"do": "st'])
def test_hanging_middleware_is_killed_after_the_last_line(
    made: Made, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    made.guardian._group = Part(made.log, "group")  # type: ignore[assignment]
    monkeypatch.setattr(sys, "stdin", io.StringIO(text))
    made.guardian.read()
    assert [*made.guardian._commands] == [{"do": "stop"}, None]
    assert made.log == [("group",), ("sleep", LAST), ("group.kill",), ("exit", 1)]


@pytest.mark.parametrize("known", [True, False])
def test_end_of_the_test_is_noticed_through_the_kernel(
    made: Made, known: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def wait() -> None:
        if not known:
            raise OSError

    monkeypatch.setattr(module, "wait_for_end_of_parent", wait)
    made.guardian.watch()
    assert made.log == ([("sleep", LAST), ("exit", 1)] if known else [])
    assert [*made.guardian._commands] == ([None] if known else [])


def test_guardian_exits_even_with_a_blocked_link(made: Made) -> None:
    class Broken:
        def wake(self) -> None:
            raise RuntimeError

    made.guardian._link = Broken()  # type: ignore[assignment]
    made.guardian._finish()
    assert made.log == [("sleep", LAST), ("exit", 1)]


@pytest.mark.parametrize("fails", [False, True])
def test_process_ends_at_once_with_separate_output(
    made: Made, fails: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    begun: list[Any] = []
    runs: list[str] = []

    class Silent:
        def __init__(self, events: int) -> None:
            begun.append(events)

        def read(self) -> None:
            runs.append("read")

        def watch(self) -> None:
            runs.append("watch")

        def run(self) -> None:
            if fails:
                raise ValueError("broken")

    class Thread:
        def __init__(self, target: Callable[[], None], daemon: bool) -> None:
            assert daemon
            self.start = target

    copied: list[tuple[int, ...]] = []
    monkeypatch.setattr(module, "Guardian", Silent)
    monkeypatch.setattr(threading, "Thread", Thread)
    monkeypatch.setattr(module, "outlive_the_test", lambda: runs.append("outlive"))
    monkeypatch.setattr(module.os, "dup", lambda one: copied.append((one,)) or 77)  # type: ignore[func-returns-value]
    monkeypatch.setattr(module.os, "dup2", lambda one, other: copied.append((one, other)))
    module.main()
    assert (copied, begun, runs) == ([(1,), (2, 1)], [77], ["outlive", "read", "watch"])
    assert [one for one in made.log if one[0] == "exit"] == ([("exit", 1)] if fails else []) + [("exit", 0)]
    assert ("ValueError: broken" in capsys.readouterr().err) == fails
