"""A small project: a node that fills a tank, and its test in the test's process or against the simulator."""

from __future__ import annotations

from pathlib import Path

NODE = """\
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64

GAIN = 2.0


class Keeper(Node):
    def __init__(self):
        super().__init__("keeper")
        self.level = None
        self.create_subscription(Float64, "/level", self.on_level, 10)
        self.valve = self.create_publisher(Float64, "/valve", 10)
        self.create_timer(0.1, self.on_timer)

    def on_level(self, msg):
        self.level = msg.data

    def on_timer(self):
        if self.level is not None:
            missing = 1.0 - self.level
            self.valve.publish(Float64(data=GAIN * missing))


def main():
    rclpy.init()
    try:
        rclpy.spin(Keeper())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
"""

TEST = """\
import sys

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
STEPS = {steps}


class Inside:
    def __init__(self, tarl, level, pump):
        self.tarl, self.level, self.pump = tarl, level, pump

    def step(self):
        self.tarl.bus.publish("/level", Float64(data=self.level))
        self.tarl.step(0.1)
        valve = self.tarl.bus.latest("/valve")
        self.level += 0.1 * self.pump * (valve.data if valve else 0.0)


class Outside:
    def __init__(self, tarl, level, pump):
        self.tarl = tarl
        self.simulator = tarl.external(
            [sys.executable, {program!r}],
            ready=("/level", "/valve"),
            step="/step",
            every_step=["/level"],
            timeout=900.0,  # s; long enough for a busy machine
            patience=300.0,  # s
            environment={{"START": repr(level), "PUMP": repr(pump)}},
        )

    def step(self):
        self.tarl.step(0.1)
        self.level = self.simulator.latest("/level").data


@pytest.mark.tarl(
    nodes=["keeper.py"],
    sensors=[Sensor("level", topic="/level", field="data", low=0, high=1, bins=10)],
    drifts={{"clogged": 0.25}},
    tolerance=0.1,
)
def test_fills(tarl, tarl_drift):
    level = float(tarl.rng("world").uniform(0.0, 0.2))
    world = {world}(tarl, level, tarl_drift or 1.0)
    tarl.start("keeper.py")
    for _ in range(STEPS):
        world.step()
        tarl.reward(-abs(1.0 - world.level))
    assert world.level > 0.9
"""


def write(folder: Path, *, external: bool, steps: int = 20) -> Path:
    """Write the project into a new folder."""
    folder.mkdir(parents=True)
    program = str(Path(__file__).with_name("tank_simulator.py"))
    world = "Outside" if external else "Inside"
    (folder / "keeper.py").write_text(NODE)
    (folder / "test_tank.py").write_text(TEST.format(program=program, world=world, steps=steps))
    (folder / "pytest.ini").write_text("[pytest]\n")
    return folder
