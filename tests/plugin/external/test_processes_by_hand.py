"""The processes of a simulator, the ROS domain and the connection to the guardian, one function at a time."""

from __future__ import annotations

import io
import json
import os
import queue
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.external import client as client_module
from pytest_tarl.external import descendants, domain, group
from pytest_tarl.external.client import PATIENCE, Client
from pytest_tarl.external.group import PERIOD, STEPS, Group

# descendants


@pytest.fixture
def processes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder in place of /proc."""
    monkeypatch.setattr(descendants, "_LINUX", True)
    monkeypatch.setattr(descendants, "Path", lambda path: tmp_path if path == "/proc" else Path(path))
    return tmp_path


def process(folder: Path, pid: str, stat: str) -> None:
    (folder / pid).mkdir()
    (folder / pid / "stat").write_text(stat)


def test_running_children_are_listed_in_order(processes: Path) -> None:
    own = os.getpid()
    for pid, stat in {
        "30": f"30 (sim) S {own} 30 30 0",
        "9": f"9 (a) odd) name) R {own} 9",
        "31": f"31 (zombie) Z {own} 31",
        "32": f"32 (dead) X {own} 32",
        "33": f"33 (child of another) S {own + 1} 33",
        "self": f"34 (no process) S {own} 34",
    }.items():
        process(processes, pid, stat)
    (processes / "35").mkdir()  # has ended in the meantime
    assert descendants.adopted() == [9, 30]


def test_without_linux_no_orphans_are_adopted(processes: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    process(processes, "30", f"30 (sim) S {os.getpid()} 30")
    monkeypatch.setattr(descendants, "_LINUX", False)
    monkeypatch.setattr(descendants.ctypes, "CDLL", lambda _: pytest.fail("there is no prctl"))
    assert descendants.adopted() == []
    descendants.adopt()
    assert callable(descendants.die_with_parent())


def test_ended_children_are_collected_until_none_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[int, int]] = []
    ended = iter([(5, 0), (6, 9), (0, 0), (7, 0)])
    monkeypatch.setattr(os, "waitpid", lambda which, how: asked.append((which, how)) or next(ended))  # type: ignore[func-returns-value]
    descendants.reap(-4)
    assert asked == [(-4, os.WNOHANG)] * 3

    def none(*_: Any) -> Any:
        raise ChildProcessError

    monkeypatch.setattr(os, "waitpid", none)
    descendants.reap(-1)


@pytest.fixture
def kernel(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, ...]]:
    """Return the calls of the kernel that a new process makes."""
    calls: list[tuple[Any, ...]] = []
    monkeypatch.setattr(descendants, "_LINUX", True)
    library = SimpleNamespace(prctl=lambda *given: calls.append(("prctl", *given)))
    monkeypatch.setattr(descendants.ctypes, "CDLL", lambda _: library)
    monkeypatch.setattr(signal, "signal", lambda number, what: calls.append((number, what)))
    monkeypatch.setattr(signal, "pthread_sigmask", lambda how, which: calls.append((how, which)))
    monkeypatch.setattr(os, "_exit", lambda status: calls.append(("exit", status)))
    return calls


INTERRUPTING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def test_the_guardian_ignores_the_signals_that_end_the_test(kernel: list[tuple[Any, ...]]) -> None:
    descendants.outlive_the_test()
    assert kernel == [(number, signal.SIG_IGN) for number in INTERRUPTING]


def test_the_guardian_adopts_orphans(kernel: list[tuple[Any, ...]]) -> None:
    descendants.adopt()
    assert kernel == [("prctl", 36, 1, 0, 0, 0)]  # PR_SET_CHILD_SUBREAPER of linux/prctl.h


@pytest.mark.parametrize("orphan", [False, True])
def test_child_dies_with_its_parent(
    kernel: list[tuple[Any, ...]], orphan: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    prepare = descendants.die_with_parent()
    assert kernel == []
    monkeypatch.setattr(os, "getppid", lambda: os.getpid() + orphan)
    prepare()
    assert kernel == [
        *((number, signal.SIG_DFL) for number in INTERRUPTING),
        (signal.SIG_SETMASK, []),
        ("prctl", 1, signal.SIGKILL),  # PR_SET_PDEATHSIG
        *([("exit", 1)] if orphan else []),
    ]


def test_waiting_for_the_parent_needs_linux(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "darwin")
    with pytest.raises(OSError, match=r"^$"):
        descendants.wait_for_end_of_parent()
    monkeypatch.setattr(sys, "platform", "linux")
    calls: list[Any] = []
    monkeypatch.setattr(os, "pidfd_open", lambda pid: calls.append(pid) or 42, raising=False)  # type: ignore[func-returns-value]
    monkeypatch.setattr(descendants.select, "select", lambda *given: calls.append(given))
    monkeypatch.setattr(os, "close", calls.append)
    descendants.wait_for_end_of_parent()
    assert calls == [os.getppid(), ([42], [], []), 42]


# group


class Machine:
    """A process group and adopted processes that end by certain signals, and a clock that moves with each sleep."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.time = 0.0
        self.command_ends = signal.SIGINT
        self.rest_ends: int = signal.SIGINT
        self.left: list[int] = []  # processes that left the group
        self.immortal = False
        self.log: list[tuple[Any, ...]] = []
        self.running, self.rest = True, True
        self.refusing: type[OSError] | None = None
        monkeypatch.setattr(group.os, "killpg", self.killpg)
        monkeypatch.setattr(group.os, "kill", self.kill)
        monkeypatch.setattr(group, "sleep", self.sleep)
        monkeypatch.setattr(group, "monotonic", lambda: self.time)
        monkeypatch.setattr(group, "adopted", lambda: [*self.left])
        monkeypatch.setattr(group, "reap", lambda which: self.log.append(("reap", which)))
        monkeypatch.setattr(group, "adopt", lambda: self.log.append(("adopt",)))
        monkeypatch.setattr(group, "die_with_parent", lambda: "prepare")
        monkeypatch.setattr(subprocess, "Popen", self.popen)

    def popen(self, command: list[str], **given: Any) -> Any:
        self.log.append(("popen", command, given))
        return SimpleNamespace(pid=50, poll=lambda: None if self.running else -2)

    def killpg(self, pid: int, number: int) -> None:
        assert pid == 50
        if self.refusing is not None:
            raise self.refusing
        if not (self.running or self.rest):
            raise ProcessLookupError
        if number:
            self.log.append(("killpg", number, round(self.time, 2)))
            order = (0, signal.SIGINT, signal.SIGTERM, signal.SIGKILL)
            self.running &= order.index(number) < order.index(self.command_ends)
            self.rest &= order.index(number) < order.index(self.rest_ends)

    def kill(self, pid: int, number: int) -> None:
        self.log.append(("kill", pid, number))
        if pid == 60:
            raise ProcessLookupError
        if not self.immortal:
            self.left.remove(pid)

    def sleep(self, seconds: float) -> None:
        assert seconds == PERIOD == 0.01
        self.time += seconds

    def sent(self) -> list[tuple[Any, ...]]:
        return [one[1:] for one in self.log if one[0] == "killpg"]


@pytest.fixture
def machine(monkeypatch: pytest.MonkeyPatch) -> Machine:
    return Machine(monkeypatch)


def test_command_has_its_own_group_and_writes_to_stderr(machine: Machine) -> None:
    made = Group(("sim", "a"), "/p", {"LEVEL": "3"})
    (first, (_, command, given)) = machine.log
    assert (first, command, given.pop("env")) == (("adopt",), ["sim", "a"], {**os.environ, "LEVEL": "3"})
    assert given == {"cwd": "/p", "stdin": subprocess.DEVNULL, "stdout": 2, "stderr": 2,
                     "start_new_session": True, "preexec_fn": "prepare"}  # fmt: skip
    assert made.status is None
    machine.running = False
    assert made.status == -2


@pytest.mark.parametrize(
    ("command", "rest", "expected"),
    [
        (signal.SIGINT, signal.SIGINT, [(signal.SIGINT, 0.0)]),
        (signal.SIGTERM, signal.SIGINT, [(signal.SIGINT, 0.0), (signal.SIGTERM, 2.0)]),
        (signal.SIGINT, signal.SIGTERM, [(signal.SIGINT, 0.0), (signal.SIGTERM, 2.0)]),
        (
            signal.SIGKILL,
            signal.SIGINT,
            [(signal.SIGINT, 0.0), (signal.SIGTERM, 2.0), (signal.SIGKILL, 3.0)],
        ),
        (
            signal.SIGTERM,
            signal.SIGKILL,
            [(signal.SIGINT, 0.0), (signal.SIGTERM, 2.0), (signal.SIGKILL, 3.0)],
        ),
    ],
)
def test_signals_get_harder_until_all_processes_have_ended(
    machine: Machine, command: signal.Signals, rest: int, expected: list[tuple[Any, ...]]
) -> None:
    assert STEPS == ((signal.SIGINT, 2.0), (signal.SIGTERM, 1.0), (signal.SIGKILL, 5.0))
    machine.command_ends, machine.rest_ends = command, rest
    made = Group(["sim"], ".", {})
    made.end()
    assert [(number, pytest.approx(time, abs=0.015)) for number, time in machine.sent()] == expected
    assert (machine.running, machine.rest) == (False, False)
    assert machine.time == pytest.approx(expected[-1][1], abs=0.015)


def test_processes_that_left_the_group_are_killed_and_collected(
    machine: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = Group(["sim"], ".", {})
    machine.left = [60, 61]
    machine.log.clear()
    kill = machine.kill

    def gone(pid: int, number: int) -> None:
        if pid == 60:
            machine.left.remove(60)  # it has just ended
        kill(pid, number)

    monkeypatch.setattr(group.os, "kill", gone)
    made.end()
    assert machine.log[-3:] == [("kill", 60, signal.SIGKILL), ("kill", 61, signal.SIGKILL), ("reap", -1)]
    assert ("reap", -50) in machine.log


def test_unkillable_process_does_not_hold_the_guardian(machine: Machine) -> None:
    made = Group(["sim"], ".", {})
    machine.left, machine.immortal = [61], True
    made.end()
    assert machine.time == pytest.approx(5.0, abs=0.02)


@pytest.mark.parametrize("problem", [ProcessLookupError, PermissionError])
def test_a_group_that_is_gone_gets_no_signal(machine: Machine, problem: type[OSError]) -> None:
    made = Group(["sim"], ".", {})
    machine.refusing, machine.running = problem, False
    made.kill()
    made.end()
    assert (machine.sent(), machine.time) == ([], 0.0)


def test_killing_sends_sigkill(machine: Machine) -> None:
    Group(["sim"], ".", {}).kill()
    assert machine.sent() == [(signal.SIGKILL, 0.0)]


# domain


@pytest.fixture
def claims(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """Return the names of sockets that other guardians have claimed."""
    taken: set[str] = set()

    class Socket:
        def __init__(self, *kind: Any) -> None:
            assert kind == (domain.socket.AF_UNIX, domain.socket.SOCK_STREAM)

        def bind(self, name: str) -> None:
            if name in taken:
                raise OSError
            taken.add(name)

        def close(self) -> None:
            taken.clear()

    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(domain.socket, "socket", Socket)
    return taken


def test_domains_are_claimed_once_until_none_is_left(claims: set[str]) -> None:
    made = [domain.Domain() for _ in domain.DOMAINS]
    assert sorted(one.number for one in made) == [*range(1, 101)]
    assert claims == {f"\0tarl-ros-domain-{number}" for number in domain.DOMAINS}
    with pytest.raises(OSError, match="all 100 ROS domains are in use"):
        domain.Domain()
    made[0].release()
    assert claims == set()


def test_without_abstract_sockets_a_random_domain_is_not_claimed(
    claims: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "platform", "darwin")
    chosen = {domain.Domain().number for _ in range(20)}
    assert chosen <= {*domain.DOMAINS}
    assert len(chosen) > 1
    assert claims == set()


# client


class Process:
    """The process of a guardian."""

    def __init__(self, output: str = "") -> None:
        self.stdin, self.stdout = io.StringIO(), io.StringIO(output)
        self.status: int | None = None
        self.hangs = False
        self.log: list[Any] = []

    def poll(self) -> int | None:
        return self.status

    def wait(self, limit: float | None = None) -> None:
        self.log.append(limit)
        if self.hangs and limit is not None:
            raise subprocess.TimeoutExpired("guardian", limit)

    def kill(self) -> None:
        self.log.append("kill")


Connect = Callable[..., tuple[Client, Process]]


@pytest.fixture
def connect(monkeypatch: pytest.MonkeyPatch) -> Iterator[Connect]:
    """Return a function that connects to a guardian that prints these lines."""
    open_ones: list[Client] = []

    def connected(output: str = "") -> tuple[Client, Process]:
        process = Process(output)
        started: dict[str, Any] = {}

        def popen(command: list[str], **given: Any) -> Process:
            started.update(given, command=command)
            return process

        monkeypatch.setattr(subprocess, "Popen", popen)
        monkeypatch.setattr(
            client_module.threading, "Thread", lambda target, **_: SimpleNamespace(start=target)
        )
        made = Client()
        assert started["start_new_session"] is True
        assert started["cwd"] == Path(client_module.__file__).parents[2]
        assert started["stdin"] == started["stdout"] == subprocess.PIPE
        open_ones.append(made)
        return made, process

    yield connected
    for one in open_ones:
        one._log.close()


def test_events_of_the_guardian_end_with_its_end(connect: Connect) -> None:
    made, process = connect('{"kind": "clock", "time": 5}\n{"kind": "stopped"}\n')
    events = [made.events.get(timeout=0) for _ in range(3)]
    assert events == [{"kind": "clock", "time": 5}, {"kind": "stopped"}, {"kind": "gone"}]
    assert made.events.empty()
    made, _ = connect('{"kind": "clock", "ti')  # the guardian was killed while it wrote
    assert made.events.get(timeout=0) == {"kind": "gone"}
    assert made._gone
    assert made.alive
    process.status = 0
    made._process = process  # type: ignore[assignment]
    assert not made.alive


def test_commands_are_lines_of_json(connect: Connect) -> None:
    made, process = connect()
    made.do("send", topic="/cmd", data={"data": 1.5})
    made.do("stop")
    lines = [json.loads(line) for line in process.stdin.getvalue().splitlines()]
    assert lines == [{"do": "send", "topic": "/cmd", "data": {"data": 1.5}}, {"do": "stop"}]
    process.stdin.close()
    made.do("stop")  # ignored


def test_output_is_returned_once_and_can_be_quoted(connect: Connect) -> None:
    made, _ = connect()
    made._log.write("one\n\xfc\n  two  \n".encode("latin-1") + b"three\nfour\n")
    made._log.flush()
    assert made.last_words() == "two | three | four"
    assert made.last_words() == "two | three | four"
    assert made.output() == "one\n\ufffd\n  two  \nthree\nfour\n"
    assert (made.output(), made.last_words()) == ("", "")
    made._log.write(b"five\n")
    made._log.flush()
    assert (made.last_words(), made.output()) == ("five", "five\n")
    made._log.close()
    assert made.output() == ""


def test_stopping_discards_events_until_the_simulator_has_stopped(
    connect: Connect, monkeypatch: pytest.MonkeyPatch
) -> None:
    made, process = connect()
    now = [0.0]
    limits: list[float] = []

    class Events:
        def __init__(self, events: list[Any]) -> None:
            self.events = events

        def get(self, timeout: float) -> Any:
            limits.append(timeout)
            now[0] += 10.0
            if not self.events or self.events[0] is None:
                self.events = self.events[1:]
                raise queue.Empty
            return self.events.pop(0)

    monkeypatch.setattr(client_module, "monotonic", lambda: now[0])
    made._gone = False
    made.events = Events([{"kind": "clock"}, None, {"kind": "stopped"}, {"kind": "late"}])  # type: ignore[assignment]
    made.stop()
    assert (limits, json.loads(process.stdin.getvalue())) == ([30.0, 20.0, 10.0], {"do": "stop"})
    now[0], made.events = 0.0, Events([])  # type: ignore[assignment]
    limits.clear()
    made.stop()  # gives up
    assert limits == [30.0, 20.0, 10.0]
    made._gone = True
    made.stop()
    assert len(limits) == 3


@pytest.mark.parametrize("hangs", [False, True])
def test_a_guardian_that_does_not_end_is_killed(connect: Connect, hangs: bool) -> None:
    made, process = connect()
    process.hangs = hangs
    made.close()
    assert process.log == [PATIENCE, *(["kill", None] if hangs else [])]
    assert process.stdin.closed
    assert process.stdout.closed
    assert made._log.closed
    made.do("stop")
