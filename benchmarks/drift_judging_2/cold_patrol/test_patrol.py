"""The robot returns to its dock. In frost the battery is empty early, which only affects long patrols."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

BatteryState = message_type("sensor_msgs/msg/BatteryState")
Float64 = message_type("std_msgs/msg/Float64")
Float64MultiArray = message_type("std_msgs/msg/Float64MultiArray")

DT = 0.25
LONG = 0.12  # share of patrols along the whole fence
TIME_BOUND = 120.0


class Fence:
    """A fence with posts; the battery fails below a charge of `dead` percent."""

    def __init__(self, rng, dead):
        self.rng = rng
        self.frost = dead > 0.0
        self.dead = dead * rng.uniform(0.85, 1.15)
        self.air = rng.uniform(-12.0, -4.0) if self.frost else rng.uniform(5.0, 25.0)
        self.charge = rng.uniform(92.0, 100.0)
        self.per_metre = rng.uniform(1.4, 1.6)
        far = rng.uniform(27.0, 31.0) if rng.random() < LONG else rng.uniform(8.0, 16.0)
        self.posts = [far * share for share in (0.25, 0.5, 0.75, 1.0)]
        self.looks = [0.0] * len(self.posts)
        self.seen = 0
        self.x, self.speed = 0.0, 0.0
        self.step = 0
        self.time = 0.0
        self.home = False
        self.failure = ""

    def publish(self, bus):
        """Publish posts, thermometer and odometer, and the battery once a second."""
        bus.publish("air_temperature", Float64(data=self.air + self.rng.normal(0.0, 0.3)))
        bus.publish("posts", Float64MultiArray(data=self.posts))
        bus.publish("odometer", Float64(data=self.x))
        if self.step % 4 == 0:
            share = self.charge / 100.0 + self.rng.normal(0.0, 0.003)
            bus.publish("battery", BatteryState(percentage=max(0.0, min(1.0, share))))
        self.step += 1

    def advance(self, cmd):
        """Drive for one step."""
        wanted = max(-1.5, min(1.5, cmd.linear.x)) if cmd else 0.0
        self.speed += (wanted - self.speed) * 0.7
        self.x += self.speed * DT
        self.charge -= self.per_metre * abs(self.speed) * DT + 0.02 * DT
        for i, post in enumerate(self.posts):
            if abs(self.x - post) < 0.3:
                self.looks[i] += DT
        self.time += DT

    def judge(self):
        """Return the reward of the step, for inspected posts and the return."""
        seen = sum(look >= 0.8 for look in self.looks)
        reward, self.seen = 2.0 * (seen - self.seen), seen
        if self.charge <= self.dead:
            self.failure = f"battery empty {self.x:.0f} m from the dock"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        self.home = self.seen > 0 and self.x < 0.15 and self.speed <= 0.0
        if self.failure:
            return reward - 25.0
        return reward + (2.0 if self.home else 0.0)


@pytest.mark.tarl(
    nodes=["patrol.py", "energy.py"],
    sensors=[
        Sensor("air", topic="air_temperature", field="data", low=-15, high=25, bins=8, unit="°C"),
        Sensor("away", topic="odometer", field="data", low=0, high=32, bins=8, unit="m"),
    ],
    drifts={"frost": 18.0},
    episodes=150,
    min_success=0.95,
)
def test_comes_home(tarl, tarl_drift):
    """Patrol once."""
    fence = Fence(tarl.rng("fence"), tarl_drift or 0.0)
    tarl.start("patrol.py")
    while not (fence.home or fence.failure):
        fence.publish(tarl.bus)
        tarl.step(DT)
        fence.advance(tarl.bus.latest("cmd_vel"))
        tarl.reward(fence.judge())
    assert fence.home, fence.failure
