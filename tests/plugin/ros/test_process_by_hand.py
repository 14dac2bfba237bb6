"""The start, the end and the errors of a node's process, its clocks and its keyboard, without files of nodes."""

from __future__ import annotations

import select
import sys
import time
from collections.abc import Callable
from typing import Any

import pytest

from pytest_tarl.errors import NodeError, RecordingError, StuckNodeError, UnsupportedApiError
from pytest_tarl.ros.exiting import ProcessExit
from pytest_tarl.ros.hosttime import virtual_host_time
from pytest_tarl.ros.keyboard import NodeInterruptedError, Terminal, own_terminal, split, terminals
from pytest_tarl.ros.process import (
    Network,
    Process,
    _status,
    current_process,
    running_process,
)
from pytest_tarl.ros.watchdog import Spinning, Watchdog

SECOND = 10**9


def started(network: Network, program: Callable[[], None], name: str = "pilot") -> Process:
    process = Process(network, name, [])
    network.processes.append(process)
    process.run(program)
    network.scheduler.settle()
    return process


def wait(network: Network) -> Callable[[], None]:
    return lambda: (network.scheduler.wait(), None)[1]


# starting and ending


def test_a_process_ends_with_its_main_program(network: Network) -> None:
    seen: list[Any] = []
    process = started(network, lambda: seen.append((running_process(), current_process("x"))))
    assert seen == [(process, process)]
    assert (process.ended, process.ending, process.tasks) == (True, True, [])
    assert running_process() is None


def test_process_continues_while_its_main_program_waits(network: Network) -> None:
    process = started(network, wait(network))
    network.scheduler.spawn(process, lambda: None)
    network.scheduler.settle()
    assert not process.ended
    assert process.main is not None
    network.scheduler.wake(process.main)
    network.scheduler.settle()
    assert process.ended


def test_hooks_run_before_tasks_are_woken(
    network: Network,
) -> None:
    trail: list[str] = []

    def stubborn() -> None:
        try:
            while True:
                network.scheduler.wait()
                trail.append("woken")
        finally:
            trail.append("killed")

    process = started(network, stubborn)
    process.at_end(lambda: trail.append("hook"))
    process.end()
    assert trail == ["hook", *["woken"] * 5, "killed"]
    assert process.ended
    process.end()
    assert trail.count("hook") == 1


def test_ending_process_calls_its_hooks_once(network: Network) -> None:
    trail: list[str] = []
    process = started(network, wait(network))
    process.at_end(lambda: trail.append("hook"))
    process.ask_to_end()
    assert (process.ending, process.ended) == (True, False)
    process.end()
    assert trail == ["hook"]


def test_a_killed_process_calls_no_hooks(network: Network) -> None:
    trail: list[str] = []
    process = started(network, wait(network))
    process.at_end(lambda: trail.append("hook"))
    process.kill()
    assert (trail, process.ended, process.ending, process.tasks) == ([], True, True, [])


def test_task_of_a_dying_process_is_killed(network: Network) -> None:
    def restarting() -> None:
        try:
            network.scheduler.wait()
        finally:
            network.scheduler.spawn(process, wait(network))

    process = started(network, restarting)
    process.kill()
    assert process.tasks == []


def test_services_are_created_per_process_or_episode(network: Network) -> None:
    made: list[Any] = []

    def part(owner: Any) -> str:
        made.append(owner)
        return "part"

    one, other = started(network, wait(network)), started(network, wait(network))
    assert [one.part(part), one.part(part), other.part(part), network.part(part), network.part(part)] == [
        "part"
    ] * 5
    assert made == [one, other, network]
    assert network.parameter_server is network.parameter_server
    assert network.remappings == {"old": "new"}


def test_code_outside_of_nodes_has_no_process() -> None:
    with pytest.raises(UnsupportedApiError, match=r"^rospy\.get_time was called outside a node"):
        current_process("rospy.get_time")


# errors


def failing(network: Network, error: BaseException) -> Process:
    def program() -> None:
        raise error

    return started(network, program)


def test_node_exception_is_an_error_with_its_place(network: Network) -> None:
    error = ValueError("boom")
    failing(network, error)
    failure = network.scheduler.failure
    assert isinstance(failure, NodeError)
    assert str(failure).startswith("Node 'pilot' raised ValueError: boom (")
    assert "test_process_by_hand.py" in str(failure)
    assert failure.__cause__ is error


def test_the_first_error_is_kept(network: Network) -> None:
    failing(network, ValueError("first"))
    failing(network, ValueError("second"))
    assert "first" in str(network.scheduler.failure)


@pytest.mark.parametrize("error", [RecordingError("x"), KeyboardInterrupt()])
def test_foreign_errors_are_passed_on(error: BaseException, network: Network) -> None:
    failing(network, error)
    assert network.scheduler.failure is error


def test_an_outcome_of_pytest_is_passed_on(network: Network) -> None:
    failing(network, pytest.fail.Exception("no"))
    assert isinstance(network.scheduler.failure, pytest.fail.Exception)


@pytest.mark.parametrize("code", [None, 0])
def test_a_program_may_exit_without_an_error(code: int | None, network: Network) -> None:
    process = failing(network, SystemExit(code))
    assert network.scheduler.failure is None
    assert process.ended


def test_an_exit_with_a_status_is_an_error(network: Network) -> None:
    failing(network, SystemExit(3))
    assert str(network.scheduler.failure).startswith("Node 'pilot' exited with status 3 (")


@pytest.mark.parametrize(
    ("code", "status"),
    [
        (2, "2"),
        ("  \n why \n not", "1: why"),
        ("", "1: "),
        ("x" * 101, f"1: {'x' * 100}…"),
        ("x" * 100, f"1: {'x' * 100}"),
    ],
)
def test_text_exit_has_status_one(code: Any, status: str) -> None:
    assert _status(SystemExit(code)) == status


def test_sys_exit_ends_only_its_task(
    network: Network,
) -> None:
    def exits(error: SystemExit) -> Callable[[], None]:
        def task() -> None:
            raise error

        return task

    process = started(network, wait(network))
    network.scheduler.spawn(process, exits(SystemExit(3)))
    network.scheduler.settle()
    assert (process.ended, network.scheduler.failure) == (False, None)
    network.scheduler.spawn(process, exits(ProcessExit(0)))
    network.scheduler.settle()
    assert (process.ended, network.scheduler.failure) == (True, None)
    other = started(network, wait(network))
    network.scheduler.spawn(other, exits(ProcessExit(4)))
    assert "exited with status 4" in str(network.scheduler.failure)


def test_shutdown_errors_are_stored_separately(
    network: Network,
) -> None:
    class ExpectedError(Exception):
        tarl_shutdown = True

    def program(error: Exception) -> Callable[[], None]:
        def run() -> None:
            network.scheduler.wait()
            raise error

        return run

    late, quiet = started(network, program(ValueError("late"))), started(network, program(ExpectedError()))
    for process in (late, quiet):
        process.end()
    assert [str(one)[:36] for one in late.errors] == ["Node 'pilot' raised ValueError: late"]
    assert quiet.errors == []
    assert network.scheduler.failure is None
    early = failing(network, ExpectedError())
    assert early.errors == []
    assert "ExpectedError" in str(network.scheduler.failure)


def test_error_names_a_node_that_never_waits(network: Network) -> None:
    process = failing(network, Spinning())
    failure = network.scheduler.failure
    assert isinstance(failure, StuckNodeError)
    assert str(failure).startswith(
        "Node 'pilot' never waits: 10 s of computing passed while virtual time stood still"
    )
    process.label = "renamed"
    assert str(process.spins(None)).startswith("Node 'renamed' never waits")


def test_task_that_ignores_the_shutdown_is_suspended(
    network: Network,
) -> None:
    counted: list[int] = []

    def program() -> None:
        network.scheduler.wait()
        for number in range(2000):
            process.refuse_to_wait()
            counted.append(number)

    process = started(network, program)
    process.end()
    assert len(counted) == 1000
    assert process.ended


def test_the_watchdog_distinguishes_computing_from_waiting() -> None:
    dog = Watchdog()
    assert dog.hanging(2.5) == "2.5 s of computing"
    dog.hung = True
    assert dog.hanging(2.5) == "30 s of waiting for something outside of ROS"


# clocks


def in_node(network: Network, task: Callable[[], None], seconds: float = 100.0) -> Process:
    """Run a task of a node on the virtual clock, for some seconds."""
    with virtual_host_time(network.scheduler):
        process = started(network, task)
        network.scheduler.advance(network.scheduler.time + round(seconds * SECOND))
    if network.scheduler.failure is not None:
        raise network.scheduler.failure
    return process


def test_only_nodes_read_the_virtual_clock(network: Network) -> None:
    network.scheduler.advance(3 * SECOND // 2)
    seen: list[Any] = []
    in_node(
        network, lambda: seen.extend([time.time(), time.monotonic(), time.perf_counter(), time.time_ns()])
    )
    assert seen == [1.5, 1.5, 1.5, 3 * SECOND // 2]
    real = time.time
    with virtual_host_time(network.scheduler):
        assert time.time() > 10**9
    assert time.time is real


def test_a_node_sleeps_in_virtual_time(network: Network) -> None:
    seen: list[float] = []

    def program() -> None:
        time.sleep(2.5)
        seen.append(time.time())
        time.sleep(0)
        seen.append(time.time())

    in_node(network, program)
    assert seen == [2.5, 2.5]


def test_a_negative_sleep_is_refused(network: Network) -> None:
    with pytest.raises(NodeError, match="ValueError: sleep length must be non-negative"):
        in_node(network, lambda: time.sleep(-1))


def test_a_sleep_ends_with_the_process(network: Network) -> None:
    seen: list[float] = []

    def program() -> None:
        time.sleep(50)
        seen.append(network.scheduler.time / SECOND)

    with virtual_host_time(network.scheduler):
        process = started(network, program)
        network.scheduler.advance(2 * SECOND)
        process.end()
    assert seen == [2.0]


def test_select_without_streams_waits_for_its_timeout(network: Network) -> None:
    seen: list[Any] = []

    def program() -> None:
        seen.append((select.select([], [], [], 0.025), time.time()))
        seen.append((select.select([], [], [], 0), time.time()))

    in_node(network, program)
    assert seen == [(([], [], []), 0.025), (([], [], []), 0.025)]


# the keyboard


def typing(network: Network, program: Callable[[], None], *texts: str) -> Process:
    """Run a node and type each text a second after the one before."""
    with virtual_host_time(network.scheduler):
        process = Process(network, "pilot", [])
        with terminals([process]):
            process.run(program)
            for number, text in enumerate(texts, 1):
                network.scheduler.advance(number * SECOND)
                process.part(Terminal).type(text)
                network.scheduler.settle()
            if not process.ended:
                process.end()
    return process


def test_a_node_reads_whole_lines_when_they_are_typed(network: Network) -> None:
    seen: list[Any] = []

    def program() -> None:
        seen.append((sys.stdin.readline(), time.time()))
        seen.append((sys.stdin.read(2), time.time()))
        seen.append((sys.stdin.readline(3), time.time()))
        seen.append((input("? "), time.time()))

    process = typing(network, program, "on", "e\n", "twothree\n", "four\n")
    assert seen == [("one\n", 2.0), ("tw", 3.0), ("oth", 3.0), ("ree", 3.0)]
    assert process.part(Terminal).used
    assert process.part(Terminal).waited


def test_reading_to_the_end_waits_for_the_episode(network: Network) -> None:
    seen: list[Any] = []

    def program() -> None:
        seen.append(sys.stdin.read(0))
        seen.append(list(sys.stdin))

    typing(network, program, "a\nb\n")
    assert seen == [""]


def test_a_read_at_the_end_is_interrupted(network: Network) -> None:
    seen: list[Any] = []

    def program() -> None:
        try:
            sys.stdin.readline()
        except KeyboardInterrupt as error:
            seen.append(type(error))

    typing(network, program)
    assert seen == [NodeInterruptedError]


def test_select_returns_when_a_line_can_be_read(network: Network) -> None:
    seen: list[Any] = []

    def program() -> None:
        seen.append(select.select([sys.stdin], [], [], 0.5)[0])
        seen.append((select.select([sys.stdin], [], [], None)[0] == [sys.stdin], time.time()))
        seen.append(sys.stdin.readline())

    typing(network, program, "x\n")
    assert seen[0] == []
    assert seen[1][0] is True
    assert seen[1][1] == pytest.approx(1.0, abs=0.011)
    assert seen[2] == "x\n"


def test_window_gets_each_key_until_its_timeout(network: Network) -> None:
    seen: list[Any] = []

    def program() -> None:
        terminal = own_terminal()
        assert terminal is not None
        seen.extend((terminal.key(one), network.scheduler.time) for one in (SECOND // 2, None, 0, 0))

    typing(network, program, "ab")
    assert seen == [("", SECOND // 2), ("a", SECOND), ("b", SECOND), ("", SECOND)]


def test_the_bytes_of_a_terminal_are_its_text(network: Network) -> None:
    seen: list[Any] = []

    def program() -> None:
        seen.append(sys.stdin.buffer.readline())
        seen.append(sys.stdin.buffer.raw.read(3))
        seen.append((sys.stdin.isatty(), sys.stdin.readable()))

    typing(network, program, "é\nabc\n")
    assert seen == ["é\n".encode(), b"abc", (True, True)]


def test_outside_of_nodes_no_stream_is_a_terminal() -> None:
    assert own_terminal() is None
    assert split([1, 2]) == ([], [1, 2], None)
