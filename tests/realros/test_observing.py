"""Observe a node on a real ROS, in real time and in separate processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from pytest_tarl.external.domain import Domain
from pytest_tarl.learning.fixture import load
from pytest_tarl.logged import Mission, missions
from pytest_tarl.observing.writer import unpacked
from pytest_tarl.rosmaster import Master
from tests.plugin.tank import NODE, RECORD, TEST
from tests.realros.probes.running import installed

MISSIONS, STEPS = 3, 20
# ROS does not define the order of messages on different topics, so the world waits until the log contains a message
LOGGED = """
import sys
import time
from pathlib import Path
from pytest_tarl.observing.log_format import records
from pytest_tarl.observing.writer import unpacked

LOG = Path(".tarl/missions.log")

def logged(kind):
    kept = [one for one in records(LOG) if one["kind"] == kind]
    return sum(unpacked(one["reward"], "float64").size for one in kept) if kind == "steps" else len(kept)

def until(kind, count):
    end = time.monotonic() + 300.0
    while logged(kind) < count:
        if time.monotonic() > end:
            sys.exit(f"{kind}: {logged(kind)} of {count} were logged")
        time.sleep(0.02)
"""
ROS1_WORLD = """
import rospy
from std_msgs.msg import Float64, String
rospy.init_node("world", disable_signals=True)
make = lambda name, kind: rospy.Publisher(name, kind, queue_size=100)
publishers = mission, level, monitor = make("/mission", String), make("/level", Float64), make("/monitor", Float64)
heard = []
rospy.Subscriber("/valve", Float64, heard.append)
pause = rospy.sleep
while not heard or not all(one.get_num_connections() for one in publishers):
    level.publish(0.0)
    pause(0.05)
"""
ROS2_WORLD = """
import time
import rclpy
from std_msgs.msg import Float64, String
rclpy.init()
node = rclpy.create_node("world")
make = lambda name, kind: node.create_publisher(kind, name, 100)
publishers = mission, level, monitor = make("/mission", String), make("/level", Float64), make("/monitor", Float64)
heard = []
node.create_subscription(Float64, "/valve", heard.append, 10)
pause = time.sleep
while not heard or not all(one.get_subscription_count() for one in publishers):
    level.publish(Float64(data=0.0))
    rclpy.spin_once(node, timeout_sec=0.05)
"""
MISSIONS_OF_IT = f"""
for number in range({MISSIONS}):
    mission.publish(String(data="begin"))
    until("mission", number + 1)
    for step in range({STEPS}):
        level.publish(Float64(data=step / {STEPS}))
        pause(0.02 if number else 0.0)  # the first time faster than the node takes them
        monitor.publish(Float64(data=-step / {STEPS}))
    until("steps", {STEPS} * (number + 1))
    mission.publish(String(data="succeeded"))
    until("end", number + 1)
print("over", flush=True)
"""
ROS2_NODE = """
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64

GAIN = 2.0

class Keeper(Node):
    def __init__(self):
        super().__init__("keeper")
        self.level = None
        self.valve = self.create_publisher(Float64, "/valve", 10)
        self.create_subscription(Float64, "/level", self.on_level, 10)
        self.create_timer(0.1, self.control)

    def on_level(self, msg):
        self.level = msg.data

    def control(self):
        if self.level is not None:
            missing = 1.0 - self.level
            flow = GAIN * missing
            self.valve.publish(Float64(data=flow))

rclpy.init()
try:
    rclpy.spin(Keeper())
except (KeyboardInterrupt, ExternalShutdownException):
    pass
"""


@pytest.mark.parametrize("generation", ["ros1", "ros2"])
@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGKILL])
def test_real_missions_are_logged(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, generation: str, ending: signal.Signals
) -> None:
    if not installed(generation):
        pytest.skip(f"{generation} is not installed here")
    folder = pytester.path
    folder.joinpath("keeper.py").write_text(NODE if generation == "ros1" else ROS2_NODE)
    folder.joinpath("test_tank.py").write_text(TEST)
    assert pytester.runpytest_subprocess(*RECORD).ret == 0
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4")  # a killed process leaves nothing in /dev/shm
    domain = Domain()
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain.number))
    master = Master() if generation == "ros1" else None
    try:
        observed(folder, ROS1_WORLD if generation == "ros1" else ROS2_WORLD, ending)
    finally:
        domain.release()
        if master is not None:
            master.close()
    found = written(folder)
    assert [one.ended for one in found] == [True] * MISSIONS
    for one in found:
        assert sum(unpacked(chunk["reward"], "float64").size for chunk in one.chunks) == STEPS
        assert sum(unpacked(chunk["site"], "int32").size for chunk in one.chunks) > 0


def written(folder: Path) -> list[Mission]:
    """Return the missions in the log so far."""
    (fixture,) = folder.glob(".tarl/utility/*.npz")
    log = folder / ".tarl/missions.log"
    return missions(log, load(fixture))


def observed(folder: Path, world: str, ending: signal.Signals) -> None:
    """Run node and world until all missions have ended, then end the node."""
    options = ["--reward-topic", "/monitor", "--mission-topic", "/mission"]
    command = [sys.executable, "-W", "ignore", "-m", "pytest_tarl", "observe", "keeper.py", *options]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(command, cwd=folder, env=environment) as node:
        try:
            played = subprocess.run(
                [sys.executable, "-W", "ignore", "-c", world + LOGGED + MISSIONS_OF_IT],
                cwd=folder,
                env=environment,
                capture_output=True,
                text=True,
                timeout=1000,
            )
            assert "over" in played.stdout, played.stderr
        finally:
            node.send_signal(ending)
            node.wait(300)
