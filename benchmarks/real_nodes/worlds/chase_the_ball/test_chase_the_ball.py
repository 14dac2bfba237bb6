"""donkey_car's chase_the_ball.py keeps a ball in view and drives to it. A lens with more zoom enlarges angles."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Point = message_type("geometry_msgs/Point")
Bool = message_type("std_msgs/Bool")

NODE = "donkey_car/src/chase_the_ball.py"
DT = 0.2
TIME_BOUND = 30.0


class Yard:
    """A ball that rolls across; `zoom` is the magnification of the lens relative to the usual one."""

    def __init__(self, rng, zoom):
        self.rng = rng
        self.zoom = zoom
        self.x, self.y, self.heading = 0.0, 0.0, rng.uniform(-0.03, 0.03)
        self.ball = [rng.uniform(7.0, 9.0), rng.uniform(-0.5, 0.5)]
        self.rolls = rng.uniform(-0.1, 0.1)
        self.speed, self.turn = 0.0, 0.0
        self.time, self.hidden = 0.0, 0.0
        self.pictures = [0.0] * 3  # images in transit: the camera has a latency of three periods
        self.failure = ""

    @property
    def away(self):
        """Return the distance to the ball, m."""
        return math.hypot(self.ball[0] - self.x, self.ball[1] - self.y)

    @property
    def there(self):
        """Return whether the car is at the ball."""
        return self.away < 0.6

    def publish(self, bus):
        """Publish the ball in the image, from -1 at the left edge to 1 at the right edge, and the mounted lens."""
        bearing = math.atan2(self.ball[1] - self.y, self.ball[0] - self.x) - self.heading
        seen = -self.zoom * math.tan(max(-1.4, min(1.4, bearing))) / 0.8 + self.rng.normal(0.0, 0.01)
        self.pictures.append(seen)
        seen = self.pictures.pop(0)
        bus.publish("/tele", Bool(data=self.zoom > 1.0))
        self.hidden = self.hidden + DT if abs(seen) > 1.0 else 0.0
        if abs(seen) <= 1.0:
            bus.publish("/blob/point_blob", Point(x=seen, y=0.0))

    def advance(self, cmd):
        """Drive for one step; the steering servo is slow."""
        speed, steer = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        self.speed += (0.6 * speed - self.speed) * 0.4
        self.turn += (steer - self.turn) * 0.2
        self.heading += self.turn * self.speed * 1.2 * DT
        self.before = self.away
        self.x += self.speed * math.cos(self.heading) * DT
        self.y += self.speed * math.sin(self.heading) * DT
        self.ball[1] += self.rolls * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step."""
        if self.hidden > 1.0:
            self.failure = "lost the ball"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        return -5.0 if self.failure else self.before - self.away


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[
        Sensor("tele", topic="/tele", field="data"),
        Sensor("ball", topic="/blob/point_blob", field="x", low=-1, high=1, bins=8),
    ],
    drifts={"tele lens": 5.0},
    episodes=60,
    min_success=0.95,
)
def test_gets_the_ball(tarl, tarl_drift):
    """Chase."""
    yard = Yard(tarl.rng("yard"), tarl_drift or 1.0)
    tarl.start(NODE)
    while not (yard.there or yard.failure):
        yard.publish(tarl.bus)
        tarl.step(DT)
        yard.advance(tarl.bus.latest("/dkcar/control/cmd_vel"))
        tarl.reward(yard.judge())
    assert yard.there, yard.failure
