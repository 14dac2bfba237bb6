"""The crawler reaches the end of the pipe; only arrival and the time taken are rewarded."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Float64 = message_type("std_msgs/Float64")

DT = 0.1
LENGTH = 4.0
NARROW = (1.5, 2.6)
GRIP = 30.0  # force above which the wheels spin and wear in the wide pipe (N)
TIME_BOUND = 16.0


class Pipe:
    """A pipe with a narrowing in which `drag` N may hold the crawler back."""

    def __init__(self, rng, drag):
        self.rng = rng
        self.drag = drag * rng.uniform(0.95, 1.05)
        self.x, self.speed = 0.0, 0.0
        self.debris = rng.uniform(0.3, 3.3)
        self.spun = 0
        self.time = 0.0
        self.failure = ""

    @property
    def narrow(self):
        """Return whether the crawler is in the narrowing."""
        return self.drag > 8.0 and NARROW[0] <= self.x <= NARROW[1]

    def publish(self, bus):
        """Publish the measurements of feelers, camera and wheels."""
        bus.publish("/feeler", Float32(data=(205.0 if self.narrow else 240.0) + self.rng.normal(0.0, 2.0)))
        bus.publish("/debris", Float32(data=0.9 if 0.0 <= self.x - self.debris <= 0.4 else 0.1))
        bus.publish("/speed", Float64(data=self.speed + self.rng.normal(0.0, 0.005)))

    def advance(self, command):
        """Crawl for one step."""
        push = max(0.0, min(60.0, command.data)) if command else 0.0
        if push > GRIP and not self.narrow:
            self.spun += 1
            push = 5.0
        drag = self.drag if self.narrow else 8.0
        gain = push - drag - 10.0 * self.speed if push > drag or self.speed > 0.02 else -50.0 * self.speed
        self.speed = max(0.0, self.speed + gain / 12.0 * DT)
        self.x += self.speed * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step, which is 0 before the end."""
        if self.spun > 10:
            self.failure = "wheels worn out"
        elif self.time > TIME_BOUND:
            self.failure = "stuck"
        if self.failure:
            return -10.0
        return 11.0 - 2.0 * self.time / TIME_BOUND if self.x >= LENGTH else 0.0


@pytest.mark.tarl(
    nodes=["crawler.py"],
    sensors=[
        Sensor("feeler", topic="/feeler", field="data", low=190, high=250, bins=6, unit="mm"),
        Sensor("speed", topic="/speed", field="data", low=0, high=0.6, bins=6, unit="m/s"),
    ],
    drifts={"narrowing": 30.0},
    episodes=100,
    min_success=0.95,
)
def test_gets_through(tarl, tarl_drift):
    """Reach the other end."""
    pipe = Pipe(tarl.rng("pipe"), tarl_drift or 8.0)
    tarl.start("crawler.py")
    while pipe.x < LENGTH and not pipe.failure:
        pipe.publish(tarl.bus)
        tarl.step(DT)
        pipe.advance(tarl.bus.latest("/push"))
        tarl.reward(pipe.judge())
    assert not pipe.failure, pipe.failure
