"""Plates and soup reach their table in time. Soup is spilt if the robot accelerates or brakes hard."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float64 = message_type("std_msgs/msg/Float64")
Pose2D = message_type("geometry_msgs/msg/Pose2D")
String = message_type("std_msgs/msg/String")

DT = 0.1
DOOR = (2.0, 3.2)  # where the kitchen door opens, m
SPILT = 0.06  # maximum amount spilt, m/s
PACE = 0.85  # average speed at which the robot arrives just in time for the guest, m/s


class Restaurant:
    """An aisle; the load on the tray tolerates accelerations up to `firmness`, m/s²."""

    def __init__(self, rng, firmness):
        self.rng = rng
        self.cargo = "plates" if firmness > 3.0 else "soup"
        self.firmness = firmness * rng.uniform(0.97, 1.03)
        self.table = rng.uniform(5.0, 8.0)
        self.x, self.y, self.speed = 0.0, rng.uniform(-0.05, 0.05), 0.0
        self.spilt = 0.0
        self.gained = 0.0
        self.time = 0.0
        self.arrived = False
        self.failure = ""

    def publish(self, bus):
        """Publish order, tray sensor, door zone and pose."""
        x, y = self.x + self.rng.normal(0.0, 0.005), self.y + self.rng.normal(0.0, 0.005)
        bus.publish("cargo", String(data=self.cargo))
        bus.publish("table", Float64(data=self.table))
        bus.publish("door_zone", Bool(data=DOOR[0] <= self.x <= DOOR[1]))
        bus.publish("pose", Pose2D(x=x, y=y))

    def advance(self, cmd, arrived):
        """Roll for one step; the drive is integrated in tenths of the step."""
        wanted, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        before = self.x
        for _ in range(4):
            accel = (max(0.0, min(1.2, wanted)) - self.speed) / 0.3
            self.speed += accel * DT / 4
            self.x += self.speed * DT / 4
            self.spilt += max(0.0, abs(accel) - self.firmness) * DT / 4
        self.y += self.speed * turn * 0.5 * DT + self.rng.normal(0.0, 0.001)
        self.gained = self.x - before
        self.time += DT
        self.arrived = bool(arrived and arrived.data)

    def judge(self):
        """Return the reward of the step: progress minus the amount spilt."""
        if self.spilt > SPILT:
            self.failure = f"spilt the {self.cargo}"
        elif self.time > 4.0 + self.table / PACE:
            self.failure = "late"
        elif self.arrived and abs(self.x - self.table) > 0.15:
            self.failure = "stopped away from the table"
        if self.failure:
            return -5.0
        return 10.0 * self.gained / self.table - 0.005


@pytest.mark.tarl(
    nodes=["waiter.py"],
    sensors=[
        Sensor("cargo", topic="cargo", field="data", categories=("plates", "soup")),
        Sensor("along", topic="pose", field="x", low=0, high=8, bins=8, unit="m"),
    ],
    drifts={"soup": 1.0},
    episodes=100,
    min_success=0.95,
)
def test_serves_the_table(tarl, tarl_drift):
    """Bring one tray."""
    place = Restaurant(tarl.rng("restaurant"), tarl_drift or 4.0)
    tarl.start("waiter.py")
    while not (place.arrived or place.failure):
        place.publish(tarl.bus)
        tarl.step(DT)
        place.advance(tarl.bus.latest("cmd_vel"), tarl.bus.latest("arrived"))
        tarl.reward(place.judge())
    assert not place.failure, place.failure
