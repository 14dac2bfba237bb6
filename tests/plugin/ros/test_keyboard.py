"""Nodes that read a keyboard get a terminal on which the test types; reading waits in virtual time."""

from __future__ import annotations

import io
import sys

import pytest

from pytest_tarl.errors import SettingsError
from pytest_tarl.ros import Ros
from tests.plugin.ros.conftest import Start, heard

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="termios")

NODE = """
import os, select, sys, termios, tty
import rospy
from std_msgs.msg import String

rospy.init_node("teleop")
out = rospy.Publisher("keys", String, queue_size=10)
{body}
"""
RAW = """
settings = termios.tcgetattr(sys.stdin)
try:
    while not rospy.is_shutdown():
        tty.setraw(sys.stdin.fileno())
        {read}
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, settings)
        if not rospy.is_shutdown():
            out.publish(key)
finally:
    restored.append(termios.tcsetattr(sys.stdin, termios.TCSADRAIN, settings))
"""
WAITING = {
    "input": "while not rospy.is_shutdown():\n    out.publish(input('speed: '))",
    "readline": "while not rospy.is_shutdown():\n    out.publish(sys.stdin.readline().strip())",
    "lines": "for line in sys.stdin:\n    out.publish(line.strip())",
    "bytes": "while not rospy.is_shutdown():\n    out.publish(sys.stdin.buffer.readline().decode().strip())",
}
KEYS = {
    "read": "key = sys.stdin.read(1)",
    "os.read": "key = os.read(sys.stdin.fileno(), 1).decode()",
    "select": "key = sys.stdin.read(1) if select.select([sys.stdin], [], [], 0.1)[0] else ''",
    "select by descriptor": "key = sys.stdin.read(1) if select.select([sys.stdin.fileno()], [], [], 0.1)[0] else ''",
}


@pytest.mark.parametrize("way", WAITING)
def test_reading_node_waits_for_the_text_of_the_test(way: str, start: Start) -> None:
    ros = start(NODE.format(body=WAITING[way]))
    keys = heard(ros, "/keys")
    ros.step(1.0)
    assert not keys
    ros.type("0.5\n1.")
    ros.step(0.1)
    assert [one.data for one in keys] == ["0.5"]  # a terminal passes on whole lines
    ros.type("5\n")
    ros.step(0.1)
    ros.close()
    assert [one.data for one in keys] == ["0.5", "1.5"]
    assert not ros.shutdown_errors


@pytest.mark.parametrize("way", KEYS)
def test_a_node_in_raw_mode_gets_each_key(way: str, start: Start) -> None:
    body = "restored = []\n" + RAW.format(read=KEYS[way])
    ros = start(NODE.format(body=body))
    keys = heard(ros, "/keys")
    ros.step(1.0)
    ros.type("wx")
    ros.step(1.0)
    ros.close()
    assert [one.data for one in keys if one.data] == ["w", "x"]
    if "select" in way:
        assert 19 <= sum(not one.data for one in keys) <= 21  # one time-out each 0.1 s
    assert ros.namespace["restored"] == [None]  # type: ignore[attr-defined]
    assert not ros.shutdown_errors


def test_node_that_is_still_reading_is_interrupted(start: Start) -> None:
    body = "ended = []\ntry:\n    input()\nexcept KeyboardInterrupt:\n    ended.append(rospy.is_shutdown())"
    ros = start(NODE.format(body=body))
    ros.step(0.1)
    ros.close()
    assert ros.namespace["ended"] == [True]  # type: ignore[attr-defined]
    assert not ros.shutdown_errors


def test_each_node_has_its_own_keyboard(start: Start) -> None:
    ros = start(NODE.format(body=WAITING["input"]))
    start(NODE.format(body=WAITING["input"]).replace('"teleop"', '"other"'), ros=ros)
    keys = heard(ros, "/keys")
    ros.type("a\n", node="/other")
    ros.step(0.1)
    assert len(keys) == 1
    assert len(ros.notes) == 1  # the other node still waits
    ros.type("b\n")
    ros.step(0.1)
    assert len(keys) == 3
    with pytest.raises(SettingsError, match="no running node is called '/third'"):
        ros.type("c", node="/third")


@pytest.mark.parametrize("called", ["scripts/teleop.py", "teleop.py", "teleop", "/teleop"])
def test_node_is_named_by_script_or_names(start: Start, called: str) -> None:
    ros = start(NODE.format(body=WAITING["input"]), name="teleop")
    keys = heard(ros, "/keys")
    ros.type("a\n", node=called)
    ros.step(0.1)
    assert len(keys) == 1


def test_error_names_a_node_that_waits_for_a_key(start: Start) -> None:
    ros = start(NODE.format(body=WAITING["input"]))
    ros.step(0.1)
    assert ros.notes == (
        "Node '/teleop' waits for the keyboard, but the test types nothing: call tarl.type(text).",
    )
    ros.type("a\n")
    assert not ros.notes


def test_code_of_the_test_still_reads_the_real_stdin(start: Start) -> None:
    before = sys.stdin
    ros = start(NODE.format(body=WAITING["input"]))
    assert sys.stdin is not before
    assert sys.stdin.encoding == before.encoding
    with pytest.raises(OSError, match="captured"):
        input()
    ros.close()


def test_input_function_of_the_test_stays(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    answers = iter(["0.5", "1.5"])
    monkeypatch.setattr("builtins.input", lambda prompt="": next(answers))
    ros = start(
        NODE.format(body="for _ in range(2):\n    out.publish(input('speed: '))\n    rospy.sleep(0.1)")
    )
    keys = heard(ros, "/keys")
    ros.step(1.0)
    assert [one.data for one in keys] == ["1.5"]  # the first message was published before the test subscribed
    assert not ros.notes


@pytest.mark.parametrize("read", ["input()", "sys.stdin.readline().strip()", "next(sys.stdin).strip()"])
def test_stdin_of_the_test_stays(read: str, start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.StringIO("0.5\n1.5\n")
    monkeypatch.setattr(sys, "stdin", stream)
    ros = Ros()
    keys = heard(ros, "/keys")
    with ros.installed():
        start(NODE.format(body=f"for _ in range(2):\n    out.publish({read})"), ros=ros)
        assert sys.stdin is stream
    ros.close()
    assert [one.data for one in keys] == ["0.5", "1.5"]
