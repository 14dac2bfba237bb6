"""`tarl watch` as a node on a real ROS, in a separate process: published messages, and shutdown."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.external.domain import Domain
from pytest_tarl.rosmaster import Master
from tests.plugin.monitoring.missions import content, fixture, log, walks
from tests.realros.probes.running import installed

LISTENING = """
import json
import sys
import time

END = time.monotonic() + 600.0  # its test ends it before

def heard(message):
    (status,) = message.status
    level = status.level if isinstance(status.level, int) else status.level[0]
    told = {"level": level, "name": status.name, "message": status.message}
    told["values"] = {one.key: one.value for one in status.values}
    told["stamp"] = message.header.stamp.STAMP
    print(json.dumps(told), flush=True)
"""
ROS1_LISTENER = (
    LISTENING.replace("STAMP", "secs")
    + """
import rospy
from diagnostic_msgs.msg import DiagnosticArray
rospy.init_node("listener")
rospy.Subscriber("/diagnostics", DiagnosticArray, heard)
while time.monotonic() < END:
    time.sleep(0.1)
"""
)
ROS2_LISTENER = (
    LISTENING.replace("STAMP", "sec")
    + """
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
rclpy.init()
node = rclpy.create_node("listener")
node.create_subscription(DiagnosticArray, "/diagnostics", heard, 10)
while time.monotonic() < END:
    rclpy.spin_once(node, timeout_sec=0.1)
"""
)
LISTENERS = {"ros1": ("rospy", ROS1_LISTENER), "ros2": ("rclpy", ROS2_LISTENER)}


@pytest.fixture(params=["ros1", "ros2"])
def generation(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """Yield each installed ROS generation, with a private network."""
    found: str = request.param
    if not installed(found):
        pytest.skip(f"{found} is not installed here")
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4")  # a killed process leaves nothing in /dev/shm
    domain = Domain()
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain.number))
    master = Master() if found == "ros1" else None
    yield found
    domain.release()
    if master is not None:
        master.close()


def watch(state: str, *more: str) -> list[str]:
    options = ["--fixture", "f.npz", "--state", f"{state}.npz", "--json", f"{state}.json", *more]
    return [sys.executable, "-W", "ignore", "-m", "pytest_tarl", "watch", "m.log", *options]


@contextmanager
def running(folder: Path, *command: str) -> Iterator[subprocess.Popen[str]]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(
        command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def received(listener: subprocess.Popen[str], missions: int) -> dict[str, Any]:
    """Return the first message that covers this number of missions; the listener ends after ten minutes."""
    assert listener.stdout is not None
    for line in listener.stdout:
        told: dict[str, Any] = json.loads(line)
        if told["values"]["missions"] == str(missions):
            return told
    raise AssertionError(listener.communicate()[1])


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_a_subscriber_receives_the_verdict_while_the_log_grows(
    tmp_path: Path, generation: str, ending: signal.Signals
) -> None:
    fixture(tmp_path / "f.npz", walks(80, 1))
    path = log(tmp_path / "m.log", walks(60, 2))
    library, listening = LISTENERS[generation]
    with (
        running(tmp_path, sys.executable, "-W", "ignore", "-c", listening) as listener,
        running(tmp_path, *watch("node", "--diagnostics", library, "--interval", "0.1")) as node,
    ):
        quiet = received(listener, 60)
        with path.open("ab") as file:
            file.write(content(walks(50, 3, drift=1.0)))
        drifted = received(listener, 110)
        node.send_signal(ending)
        out, err = node.communicate(timeout=300)
    assert (quiet["level"], drifted["level"]) == (0, 2)
    assert quiet["name"] == "tarl: test_walk.py::test_walk"
    assert quiet["message"].startswith("60 missions, 60 passed")
    assert drifted["values"]["where"].startswith("x 2-3")
    assert float(drifted["values"]["success.log10_evidence"]) > 1.3
    assert drifted["stamp"] > 1e9
    if ending != signal.SIGKILL:
        assert node.returncode == 1, err
        assert "110 missions" in out
        assert "Traceback" not in err
    again(tmp_path)


def again(folder: Path) -> None:
    """A watch that resumes from the stored state has the same evidence as one that read everything at once."""
    for state in ("node", "once"):
        done = subprocess.run(watch(state, "--once"), cwd=folder, capture_output=True, text=True, timeout=600)
        assert done.returncode == 1, done.stderr
    assert (folder / "node.npz").read_bytes() == (folder / "once.npz").read_bytes()
