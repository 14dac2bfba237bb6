"""The watchdog stops a node that computes endlessly or hangs outside of ROS, but no node delayed by a busy machine."""

import subprocess
import sys
import time

import pytest

from pytest_tarl.ros import watchdog
from pytest_tarl.ros.watchdog import Spinning, Watchdog


def _sleep(seconds: float) -> None:
    """Spend wall time in many short waits, like a starved or polling thread."""
    for _ in range(round(seconds / 0.02)):
        time.sleep(0.02)


def _compute_without_end() -> None:
    while True:
        pass


def test_wall_time_alone_does_not_stop_a_node() -> None:
    dog = Watchdog()
    dog.arm(0.2)
    _sleep(0.6)
    assert not dog.disarm()


def test_endless_computation_is_stopped() -> None:
    dog = Watchdog()
    dog.arm(0.1)
    with pytest.raises(Spinning):
        _compute_without_end()
    assert dog.disarm()
    assert dog.hanging(0.1) == "0.1 s of computing"


def test_computation_between_moves_of_the_clock_is_not_stopped() -> None:
    dog = Watchdog()
    dog.arm(0.3)
    start = time.thread_time()
    while time.thread_time() - start < 0.7:
        dog.beat()
    assert not dog.disarm()


def test_endless_waiting_outside_of_ros_is_stopped_much_later(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(watchdog, "_PATIENCE", 3)
    dog = Watchdog()
    dog.arm(0.1)
    with pytest.raises(Spinning):
        _sleep(600)
    assert dog.disarm()
    assert "waiting for something outside" in dog.hanging(0.1)


def test_a_debugger_can_pause_without_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(watchdog, "_PATIENCE", 1)
    dog = Watchdog()
    prompt = {"__name__": "pdb", "wait": _sleep}
    dog.arm(0.1)
    exec("def interaction():\n    wait(0.4)", prompt)
    prompt["interaction"]()
    assert not dog.disarm()


def test_thread_without_a_clock_uses_the_process_clock(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(watchdog, "_CLOCK_OF", None)
    test_endless_computation_is_stopped()


def test_functions_can_be_traced_after_a_node_was_stopped() -> None:
    program = """
import faulthandler, sys
from pytest_tarl.ros.watchdog import Spinning, Watchdog
faulthandler.dump_traceback_later(120, exit=True)  # the call below hangs if the interpreter still expects an exception
dog = Watchdog()
dog.arm(0.1)
try:
    while True:
        pass
except Spinning:
    print(dog.disarm())
seen = []
sys.settrace(lambda frame, event, argument: seen.append(frame.f_code.co_name))
def called(): pass
called()
sys.settrace(None)
print(seen)
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert run.stdout.split("\n") == ["True", "['called']", ""], run.stderr


def test_disarmed_watchdog_raises_no_exception(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # the exception is not raised before the watchdog is disarmed
    monkeypatch.setattr(watchdog, "_raise_in", lambda thread, exception: None)
    dog = Watchdog()
    dog.arm(0.1)
    start = time.thread_time()
    while not dog.fired:
        assert time.thread_time() - start < 60
    monkeypatch.undo()
    assert dog.disarm()
    assert not dog.disarm()  # fired once
