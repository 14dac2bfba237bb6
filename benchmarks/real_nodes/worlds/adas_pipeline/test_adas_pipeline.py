"""adas-core follows a car at a distance. A new lens shows it smaller; a trailer makes the own car slow to brake."""

import numpy as np
import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Image = message_type("sensor_msgs/msg/Image")
Float32 = message_type("std_msgs/msg/Float32")
Bool = message_type("std_msgs/msg/Bool")

NODE = "drive.py"
FILES = [
    NODE,
    "adas/cli.py",
    "adas/control/controller.py",
    "adas/control/safety.py",
    "adas/core/config.py",
    "adas/planning/behavior_planner.py",
    "adas/ros2/bridge.py",
    "adas/ros2/converters.py",
    "adas/runtime/pipeline.py",
    "adas/tracking/tracker.py",
]
DT = 0.1
TIME = 15.0
HEIGHT, WIDTH = 64, 32  # of the image, px
CAR = 1.5  # height of the car ahead, m
NEAR = 3.0  # closer than this is a failure, m


class Road:
    """A road with a car ahead; `focal` is the focal length in px, `grip` scales throttle and brake."""

    def __init__(self, rng, focal=150.0, grip=1.0):
        self.rng = rng
        self.focal = focal
        self.grip = grip
        self.ahead = rng.uniform(16.0, 22.0)
        self.speed = self.lead = rng.uniform(8.0, 10.0)
        self.wanted, self.until = self.lead, 2.0
        self.time = 0.0
        self.failure = ""

    def publish(self, bus):
        """Publish the image of the car ahead, the speed, and whether a trailer is coupled."""
        tall = min(0.8 * HEIGHT, self.focal * CAR / self.ahead)
        rows = np.clip(tall - (int(0.8 * HEIGHT) - 1 - np.arange(HEIGHT)), 0.0, 1.0)
        rows[int(0.8 * HEIGHT) :] = 0.0
        picture = np.full((HEIGHT, WIDTH), 255.0)
        picture[:, int(0.4 * WIDTH) : int(0.6 * WIDTH)] *= (1.0 - rows)[:, None]
        image = Image(height=HEIGHT, width=WIDTH, encoding="mono8", step=WIDTH)
        image.data = picture.astype(np.uint8).tobytes()
        bus.publish("/vehicle/speed", Float32(data=max(0.0, self.speed + self.rng.normal(0.0, 0.03))))
        bus.publish("/trailer", Bool(data=self.grip < 1.0))
        bus.publish("/camera/image_raw", image)

    def advance(self, throttle, brake):
        """Drive for one step."""
        if self.time > self.until:
            self.wanted, self.until = self.rng.uniform(4.5, 12.0), self.time + 4.0
        self.lead += max(-3.0 * DT, min(1.5 * DT, self.wanted - self.lead))
        push = (4.0 * throttle.data - 8.0 * brake.data) if throttle and brake else 0.0
        self.speed = max(0.0, self.speed + DT * (self.grip * push - 0.01 * self.speed))
        self.ahead += DT * (self.lead - self.speed)
        self.time += DT

    def judge(self):
        """Return the reward of the step: for progress at a distance of about two seconds."""
        if self.ahead < NEAR:
            self.failure = "too close"
            return -5.0
        gap = self.ahead / max(self.speed, 1.0)
        return 0.004 * self.speed * max(-1.0, 1.0 - max(0.0, 1.6 - gap) * 2.0 - max(0.0, gap - 3.0))


@pytest.mark.tarl(
    nodes=FILES,
    sensors=[
        Sensor("speed", topic="/vehicle/speed", field="data", low=0, high=15, bins=6, unit="m/s"),
        Sensor("trailer", topic="/trailer", field="data"),
    ],
    drifts={"new lens": Drift({"focal": 95.0}, permanent=True), "trailer": {"grip": 0.15}},
    episodes=40,
    min_success=0.95,
)
def test_keeps_its_distance(tarl, tarl_drift):
    """Follow the car."""
    road = Road(tarl.rng("road"), **(tarl_drift or {}))
    tarl.start(NODE)
    while road.time < TIME and not road.failure:
        road.publish(tarl.bus)
        tarl.step(DT)
        road.advance(tarl.bus.latest("/vehicle/throttle_cmd"), tarl.bus.latest("/vehicle/brake_cmd"))
        tarl.reward(road.judge())
    assert not road.failure, road.failure
