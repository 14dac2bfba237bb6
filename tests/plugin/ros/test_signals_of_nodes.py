"""Handlers, alarms, signals to the own process, forks and replaced processes of nodes do not affect pytest."""

from __future__ import annotations

import _thread
import os
import signal
import sys
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.errors import NodeError, UnsupportedApiError
from pytest_tarl.ros import Ros
from pytest_tarl.ros.interpreter_state import interpreter_kept
from tests.plugin.ros.conftest import Start
from tests.plugin.tank import changed

HANDLED = (signal.SIGINT, signal.SIGTERM, signal.SIGALRM)


def installed() -> list[Any]:
    """Return the handlers, the functions and the limit of this process that no node may change."""
    functions = os.kill, os.execv, signal.signal, signal.alarm, signal.pthread_kill, _thread.interrupt_main
    return [*map(signal.getsignal, HANDLED), *functions, sys.getrecursionlimit()]


@pytest.fixture(autouse=True)
def handlers_stay() -> Any:
    """No test of this file may change a handler, a timer or a function of pytest's process."""
    before = installed()
    yield
    assert installed() == before
    assert signal.getitimer(signal.ITIMER_REAL)[1] == 0.0


def test_a_handler_of_a_node_is_called_but_not_installed(start: Start) -> None:
    ros = start("""
        import os, signal, rospy
        heard, before = [], [signal.getsignal(signal.SIGUSR1), signal.getsignal(signal.SIGINT)]
        before.append(signal.signal(signal.SIGINT, lambda number, frame: heard.append((number, frame is not None))))
        before.append(signal.signal(signal.SIGUSR1, signal.SIG_IGN))
        rospy.init_node("n")
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGUSR1)
        os.kill(os.getpid(), 0)
        signal.raise_signal(signal.SIGINT)
        same = signal.getsignal(signal.SIGUSR1) is signal.SIG_IGN
    """)
    assert ros.namespace["heard"] == [(signal.SIGINT, True)] * 2
    first, *others = ros.namespace["before"]
    assert (first, ros.namespace["same"]) == (signal.SIG_DFL, True)
    assert others == [signal.default_int_handler, signal.default_int_handler, signal.SIG_DFL]


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_a_node_that_sends_itself_an_interrupt_is_shut_down(start: Start, name: str) -> None:
    ros = start(f"""
        import os, signal, rospy
        rospy.init_node("n")
        done = []
        rospy.on_shutdown(lambda: done.append("hook"))
        os.kill(os.getpid(), signal.{name})
        done.append("goes on")
        rospy.spin()
        done.append("ended")
    """)
    ros.step(0.1)
    assert ros.namespace["done"] == ["goes on", "hook", "ended"]


@pytest.mark.parametrize(
    ("call", "status"),
    [
        ("os.kill(os.getpid(), signal.SIGKILL)", 137),
        ("os.killpg(os.getpgrp(), signal.SIGHUP)", 129),
        ("os.kill(0, signal.SIGUSR2)", 140),
        ("os.abort()", 134),
        ("signal.raise_signal(signal.SIGALRM)", 142),
    ],
)
def test_a_signal_that_would_kill_the_process_ends_only_the_node(
    start: Start, call: str, status: int
) -> None:
    with pytest.raises(NodeError, match=f"exited with status {status}"):
        start(f"import os, signal\n{call}")


def test_invalid_handlers_and_signals_raise_what_python_raises(start: Start) -> None:
    ros = start("""
        import signal
        found = []
        for number, handler in ((signal.SIGKILL, print), (signal.SIGINT, "x"), (999, print)):
            try:
                signal.signal(number, handler)
            except (OSError, TypeError, ValueError) as problem:
                found.append(type(problem))
    """)
    assert ros.namespace["found"] == [OSError, TypeError, ValueError]


def test_an_alarm_rings_in_virtual_time_where_the_main_program_waits(start: Start) -> None:
    ros = start("""
        import signal, time, rospy
        rospy.init_node("n")
        def late(number, frame):
            raise TimeoutError(number)
        signal.signal(signal.SIGALRM, late)
        begun = time.time()
        left = [signal.alarm(9), signal.alarm(3)]
        try:
            rospy.wait_for_message("/none", rospy.AnyMsg)
        except TimeoutError as problem:
            caught = problem.args, round(time.time() - begun, 3)
        left.append(signal.alarm(0))
        time.sleep(20.0)
    """)
    ros.step(5.0)
    assert ros.namespace["caught"] == ((signal.SIGALRM,), 3.0)
    assert ros.namespace["left"] == [0, 9, 0]
    ros.step(20.0)


def test_an_alarm_that_raises_ends_a_pause_with_its_exception(start: Start) -> None:
    ros = start("""
        import signal, time
        def late(number, frame):
            raise TimeoutError(number)
        signal.signal(signal.SIGALRM, late)
        signal.alarm(1)
        caught = False
        try:
            signal.pause()
        except TimeoutError:
            caught = True
        time.sleep(20.0)
    """)
    ros.step(5.0)
    assert ros.namespace["caught"] is True


@pytest.mark.parametrize(
    ("made", "wait", "notify"),
    [("Lock", "acquire", "release"), ("Condition", "wait", "notify")],
)
def test_an_interrupted_wait_for_a_lock_does_not_take_the_turn_of_another(
    start: Start, made: str, wait: str, notify: str
) -> None:
    ros = start(f"""
        import signal, time, threading
        shared, got = threading.{made}(), []
        shared.acquire()
        def late(number, frame):
            raise TimeoutError(number)
        def other():
            time.sleep(0.5)
            if "{wait}" == "wait":
                shared.acquire()
            shared.{wait}()
            got.append("other")
        signal.signal(signal.SIGALRM, late)
        signal.alarm(1)
        threading.Thread(target=other).start()
        try:
            shared.{wait}()
        except TimeoutError:
            got.append("late")
        time.sleep(1.0)
        shared.{notify}()
        if "{notify}" == "notify":
            shared.release()
        time.sleep(20.0)
    """)
    ros.step(5.0)
    assert ros.namespace["got"] == ["late", "other"]


@pytest.mark.parametrize(
    "call",
    [
        "os.kill(os.getpid(), signal.SIGINT)",
        "signal.raise_signal(signal.SIGINT)",
        "signal.pthread_kill(threading.get_ident(), signal.SIGINT)",
        "_thread.interrupt_main()",
    ],
)
def test_the_main_program_gets_the_exception_of_a_handler_that_another_thread_calls(
    start: Start, call: str
) -> None:
    ros = start(f"""
        import _thread, os, signal, sys, threading, time
        got = []
        def stop(number, frame):
            got.append(number)
            sys.exit(0)
        def quits():
            time.sleep(0.5)
            {call}
            got.append("goes on")
        signal.signal(signal.SIGINT, stop)
        threading.Thread(target=quits).start()
        try:
            while True:
                time.sleep(0.2)
        finally:
            got.append("ended")
    """)
    ros.step(5.0)
    assert ros.namespace["got"] == [signal.SIGINT, "goes on", "ended"]


def test_an_interrupt_of_the_main_program_without_a_handler_shuts_the_node_down(start: Start) -> None:
    ros = start("""
        import _thread, signal, rospy
        rospy.init_node("n")
        _thread.interrupt_main(signal.SIGTERM)  # without a Python handler: no effect
        went_on = not rospy.is_shutdown()
        _thread.interrupt_main()
        rospy.spin()
        ended = True
    """)
    ros.step(1.0)
    assert (ros.namespace["went_on"], ros.namespace["ended"]) == (True, True)


def test_a_timer_rings_again_until_it_is_removed(start: Start) -> None:
    ros = start("""
        import signal, time
        rang = []
        def ring(number, frame):
            rang.append(round(time.time() - begun, 3))
            if len(rang) == 3:
                before.append(signal.setitimer(signal.ITIMER_REAL, 0))
        signal.signal(signal.SIGALRM, ring)
        begun, before = time.time(), []
        signal.setitimer(signal.ITIMER_REAL, 0.5, 0.25)
        before.append(signal.getitimer(signal.ITIMER_REAL))
        signal.pause()
        woken = round(time.time() - begun, 3)
        time.sleep(5.0)
    """)
    ros.step(3.0)
    assert ros.namespace["rang"] == [0.5, 0.75, 1.0]
    assert ros.namespace["before"] == [(0.5, 0.25), (0.25, 0.25)]
    assert ros.namespace["woken"] == 0.5


def test_an_alarm_without_a_handler_ends_the_node(start: Start) -> None:
    ros = start("""
        import signal, time
        signal.alarm(1)
        time.sleep(10.0)
    """)
    with pytest.raises(NodeError, match="exited with status 142"):
        ros.step(2.0)


def test_a_pause_ends_with_the_episode(start: Start) -> None:
    ros = start("""
        import signal, rospy
        rospy.init_node("n")
        signal.pause()
        paused = rospy.is_shutdown()
    """)
    ros.step(1.0)
    assert "paused" not in ros.namespace
    ros.close()
    assert ros.namespace["paused"] is True


@pytest.mark.parametrize("call", ["os.execv('/bin/true', ['true'])", "os.execlp('true', 'true')"])
def test_a_node_cannot_replace_its_process(start: Start, call: str) -> None:
    with pytest.raises(UnsupportedApiError, match=r"os\.exec\w+ cannot replace a node by '.*true', since"):
        start(f"import os\n{call}")


def test_timers_of_processor_time_are_refused(start: Start) -> None:
    with pytest.raises(UnsupportedApiError, match="only ITIMER_REAL"):
        start("import signal\nsignal.setitimer(signal.ITIMER_VIRTUAL, 1.0)")


def test_streams_stay_open_and_the_recursion_limit_is_restored(start: Start) -> None:
    usual = sys.getrecursionlimit()
    ros = start(f"import sys\nsys.stdout.close()\nsys.stderr.close()\nsys.setrecursionlimit({usual + 77})")
    assert not sys.stdout.closed
    assert not sys.stderr.closed
    ros.close()


@pytest.mark.parametrize("change", ["os.chdir('/')", "os.fchdir(os.open('/', os.O_RDONLY))"])
def test_the_working_directory_that_a_node_left_is_restored(change: str) -> None:
    before, functions = Path.cwd(), (os.chdir, os.fchdir)
    ros = Ros()
    with ros.installed():
        for _ in range(2):
            ros.start(partial(exec, f"import os\n{change}"), name="node.py")
            assert Path.cwd() == Path("/")
        ros.close()
    assert (Path.cwd(), os.chdir, os.fchdir) == (before, *functions)


def test_a_test_that_leaves_the_working_directory_is_not_moved_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with interpreter_kept():
        monkeypatch.chdir(tmp_path)
    assert Path.cwd() == tmp_path


def test_import_paths_and_finders_that_a_node_removed_come_back(monkeypatch: pytest.MonkeyPatch) -> None:
    paths, finders = [*sys.path], [*sys.meta_path]
    monkeypatch.setattr(sys, "path", [*paths])
    monkeypatch.setattr(sys, "meta_path", [*finders])
    with interpreter_kept():
        sys.path[:] = ["/opt/node", paths[-1]]
        sys.meta_path.clear()
    assert sys.path[:2] == ["/opt/node", paths[-1]]
    assert {*sys.path} == {*paths, "/opt/node"}
    assert sys.meta_path == finders


def test_a_forked_child_that_comes_back_to_the_scheduler_is_ended_with_a_sentence(
    tank: pytest.Pytester,
) -> None:
    forks = "            import os\n            if level > 0.9 and not hasattr(main, 'child'):\n"
    forks += "                main.child = os.fork()\n                if main.child:\n"
    forks += "                    print('child:', os.waitstatus_to_exitcode(os.waitpid(main.child, 0)[1]))\n"
    changed(tank, "keeper", "            flow = GAIN", f"{forks}            flow = GAIN")
    ran = tank.runpytest_subprocess("-s", "test_tank.py")
    ran.assert_outcomes(passed=2)
    assert ran.stdout.str().count("child: 1") == 1
    assert ran.stderr.str().count("a child process that a node forked waits in the in-process ROS") == 1
