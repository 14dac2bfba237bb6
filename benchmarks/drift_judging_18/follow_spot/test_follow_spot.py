"""A follow spot lights an actor. In the new play, the actor walks over the whole depth of the stage."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

PointStamped = message_type("geometry_msgs/msg/PointStamped")
Float32 = message_type("std_msgs/msg/Float32")

DT = 0.05
STEPS = 700
NEAR_THE_MARK = (8.6, 9.6)  # m in front of the light
WHOLE_STAGE = (6.0, 13.0)
LUX = 700.0


class Stage:
    """A stage on which an actor walks between the depths `depth`."""

    def __init__(self, rng, depth):
        self.rng = rng
        self.depth = depth
        self.lamp = float(rng.uniform(0.97, 1.03))
        middle = (depth[0] + depth[1]) / 2
        self.place = [middle + float(rng.uniform(-0.4, 0.4)), float(rng.uniform(-2.0, 2.0))]
        self.back = bool(rng.random() < 0.5)
        self.mark = self.next_mark()
        self.pan, self.tilt, self.now, self.bad, self.gained = 0.0, 0.4, 0, 0, 0.0

    def next_mark(self):
        """Return where the actor goes next: to and fro between the front and the back."""
        low, high = self.depth
        part = 0.3 * (high - low)
        self.back = not self.back
        x = self.rng.uniform(high - part, high) if self.back else self.rng.uniform(low, low + part)
        return [float(x), float(self.rng.uniform(-3.0, 3.0))]

    def publish(self, bus):
        """Publish the place of the actor and the fader of the desk."""
        seen = PointStamped()
        seen.point.x = self.place[0] + self.rng.normal(0.0, 0.02)
        seen.point.y = self.place[1] + self.rng.normal(0.0, 0.02)
        bus.publish("tracker/actor", seen)
        bus.publish("desk/fader", Float32(data=1.0 if self.now > 20 else 0.0))

    def advance(self, pan, tilt, dimmer):
        """Walk for one step; the camera of the theatre wants 700 lux on the face."""
        way = [goal - at for goal, at in zip(self.mark, self.place, strict=True)]
        left = math.hypot(*way)
        if left < 0.1:
            self.mark = self.next_mark()
        else:
            self.place = [at + DT * 1.1 * part / left for at, part in zip(self.place, way, strict=True)]
        self.now += 1
        self.gained = 0.0
        if self.now <= 80 or dimmer is None:
            return
        distance = math.hypot(*self.place, 4.2)
        aside = abs(pan.data - math.atan2(self.place[1], self.place[0]))
        above = abs(tilt.data - math.atan2(4.2, math.hypot(*self.place)))
        hit = math.exp(-((max(aside, above) * distance / 0.9) ** 2))
        lux = self.lamp * hit * LUX / 0.55 * dimmer.data / 255 * (10.0 / distance) ** 2
        stops = abs(math.log2(max(lux, 1.0) / LUX))
        self.bad += stops > 0.5
        self.gained = 0.01 * max(-1.0, 1.0 - 2.0 * stops)


@pytest.mark.tarl(
    nodes=["follow_spot.py"],
    sensors=[
        Sensor("depth", topic="tracker/actor", field="point.x", low=5.0, high=14.0, bins=5, unit="m"),
        Sensor("side", topic="tracker/actor", field="point.y", low=-3.5, high=3.5, bins=3, unit="m"),
    ],
    drifts={"whole stage": WHOLE_STAGE},
    episodes=200,
    min_success=0.97,
)
def test_lights(tarl, tarl_drift):
    """Light an actor through one scene."""
    stage = Stage(tarl.rng("stage"), tarl_drift or NEAR_THE_MARK)
    tarl.start("follow_spot.py")
    while stage.now < STEPS:
        stage.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        stage.advance(bus.latest("spot/pan"), bus.latest("spot/tilt"), bus.latest("spot/dimmer"))
        tarl.reward(stage.gained)
    assert stage.bad <= 62, f"face is too bright or too dark for {DT * stage.bad:.0f} s"
