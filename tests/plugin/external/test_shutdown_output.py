"""The SIGINT of TARL does not look like a failure of the simulator in its output."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

from pytest_tarl.external import client
from pytest_tarl.external.shutdown_output import without_interrupts

UP = "print('up', flush=True)\n"
WAITS = "import time\n" + UP + "time.sleep(600)"
INTERRUPTED = {
    "waiting": WAITS,
    "in a function": "import time\ndef wait():\n    time.sleep(600)\n" + UP + "wait()",
    "while an error is handled": "import time\ntry:\n    1 / 0\nexcept ZeroDivisionError:\n    "
    + UP
    + "    time.sleep(600)",
    "in a finaliser": "import time\nclass One:\n    def __del__(self):\n        "
    + UP
    + "        time.sleep(600)\none = One()\ndel one",
    "at exit": "import atexit, time\ndef last():\n    " + UP + "    time.sleep(600)\natexit.register(last)",
    "while it waits for a thread": "import threading, time\ndef work():\n    "
    + UP
    + "    time.sleep(1)\nthreading.Thread(target=work).start()",
    "asyncio": "import asyncio\nasync def main():\n    "
    + UP
    + "    await asyncio.sleep(600)\nasyncio.run(main())",
    "as rclpy says it": "import time\nclass ExternalShutdownException(Exception): pass\ntry:\n    "
    + UP
    + "    time.sleep(600)\nexcept KeyboardInterrupt:\n    raise ExternalShutdownException() from None",
}
SHUT_DOWN = (  # of rclpy and rospy, as they are printed
    "rclpy._rclpy_pybind11.RCLError: failed to initialize wait set: the given context is not valid, …",
    "rclpy._rclpy_pybind11.RCLError: Failed to publish: publisher's context is invalid, at ./src/rcl/publisher.c:423",
    "rclpy._rclpy_pybind11.RCLError: failed to shutdown: rcl_shutdown already called on the given context",
    "RuntimeError: Context must be initialized before it can be shutdown",
    "rclpy.exceptions.NotInitializedException: rclpy.init() has not been called. msg:cannot create node",
    "rclpy._rclpy_pybind11.InvalidHandle: cannot use Destroyable because destruction was requested",
    "rospy.exceptions.ROSException: publish() to a closed topic",
)
FAULTY = {
    "an error at the end": (
        "import time\ntry:\n    " + UP + "    time.sleep(600)\nfinally:\n    1 / 0",
        "ZeroDivisionError",
    ),
    "an error from it": (
        "import time\ntry:\n    "
        + UP
        + "    time.sleep(600)\nexcept KeyboardInterrupt as why:\n    raise ValueError('first\\nsecond') from why",
        "ValueError: first\nsecond",
    ),
}


def interrupted(program: str) -> str:
    """Run a program until it says `up`, send SIGINT, and return what it prints afterwards."""
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as running:
        assert running.stdout is not None
        assert running.stdout.readline() == "up\n"
        running.send_signal(signal.SIGINT)
        return running.stdout.read()


@pytest.mark.parametrize("kind", INTERRUPTED)
def test_interrupt_traceback_is_left_out(kind: str) -> None:
    output = interrupted(INTERRUPTED[kind])
    assert "Traceback" in output
    assert without_interrupts(output) == ""
    assert without_interrupts(f"saved\n{output}done\n") == "saved\ndone\n"


@pytest.mark.parametrize("last", SHUT_DOWN)
def test_errors_of_a_stopped_ros_are_left_out(last: str) -> None:
    frames = (
        'Traceback (most recent call last):\n  File "sim.py", line 1, in <module>\n    rclpy.spin(node)\n'
    )
    link = "\nDuring handling of the above exception, another exception occurred:\n\n"
    for output in (f"{frames}{last}\n", f"{frames}KeyboardInterrupt\n{link}{frames}{last}\n"):
        assert without_interrupts(f"saved\n{output}done\n") == "saved\ndone\n"
    own = f"{frames}rclpy._rclpy_pybind11.RCLError: failed to create node\n"
    assert without_interrupts(own) == own


def test_signal_handler_messages_are_left_out() -> None:
    failed = "rcl_trigger_guard_condition() failed: guard condition implementation is invalid, at guard_condition.c:170"
    handler = f"[ERROR] [1795828810.626488426] [rclpy.signals]: {failed}"
    own = f"[ERROR] [1795828810.626488426] [sim.signals]: {failed}"
    assert without_interrupts(f"drained\n{handler}\n{own}\n{handler}") == f"drained\n{own}\n"


@pytest.mark.parametrize("kind", FAULTY)
def test_errors_while_the_simulator_ends_stay_in_the_output(kind: str) -> None:
    program, error = FAULTY[kind]
    output = interrupted(program)
    assert error in output
    assert without_interrupts(output) == output


@pytest.mark.parametrize("killed", [False, True])
def test_stopping_waits_for_a_running_guardian(killed: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client, "PATIENCE", 10_000.0)  # s; a wait in vain would exceed the limit of the test
    guardian = client.Client()
    try:
        if killed:
            guardian._process.kill()
            guardian._process.wait()
        guardian.stop()
        assert guardian.alive == (not killed)
        assert guardian.output() == ""
    finally:
        guardian.close()
