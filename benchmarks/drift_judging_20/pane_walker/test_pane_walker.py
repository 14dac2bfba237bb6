"""A walker cleans a glass front. In the next street, one front of eight has a frosted band that the cup seals badly."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

FluidPressure = message_type("sensor_msgs/msg/FluidPressure")
Pose2D = message_type("geometry_msgs/msg/Pose2D")

DT = 0.1
FROSTED = 0.12  # share of the fronts
LANE, LANES, HEIGHT = 0.5, 3, 2.4  # m


class Front:
    """A glass front; with the chance `frosted` it has a band of frosted glass. A few seals fail for good."""

    def __init__(self, rng, frosted):
        self.rng = rng
        self.band = float(rng.uniform(0.8, 1.8)) if rng.random() < frosted else None
        self.wide, self.held = rng.uniform(0.3, 0.4), rng.uniform(0.33, 0.4)
        self.fails_at = float(rng.uniform(8.0, 35.0)) if rng.random() < 0.05 else None
        self.fan = rng.normal(1.0, 0.02)
        self.at, self.speed = [0.0, 0.2], [0.0, 0.0]  # m across, m down
        self.vacuum, self.time = 0.0, 0.0
        self.cleaned = set()
        self.gained, self.failure, self.over = 0.0, "", False

    @property
    def done(self):
        """Return whether the front is clean, or the walker hangs or falls."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the place and the vacuum."""
        noise = self.rng.normal(0.0, 0.004, 2)
        bus.publish("walker/pose", Pose2D(x=self.at[0] + noise[0], y=self.at[1] + noise[1], theta=0.0))
        pascal = 1000.0 * max(0.0, self.vacuum + self.rng.normal(0.0, 0.4))
        bus.publish("cup/vacuum", FluidPressure(fluid_pressure=pascal, variance=0.0))

    def seal(self):
        """Return the share of its vacuum that the cup holds here."""
        if self.fails_at is not None and self.time > self.fails_at:
            return max(0.0, 1.0 - (self.time - self.fails_at) / 5.0)
        if self.band is not None and abs(self.at[1] - self.band) < self.wide / 2.0:
            return self.held
        return 1.0

    def advance(self, fan, velocity, brush, brake, state):
        """Walk for one step."""
        duty = fan.data if fan else 0.0
        self.vacuum += 0.3 * (58.0 * self.fan * duty * self.seal() - self.vacuum)
        wish = (velocity.linear.x, velocity.linear.y) if velocity else (0.0, 0.0)
        for axis in (0, 1):
            self.speed[axis] += 0.6 * (wish[axis] - self.speed[axis])
            self.at[axis] += DT * self.speed[axis]
        self.time += DT
        self.gained = -0.001
        if brush and brush.data > 0.5 and self.vacuum > 7.0:
            spot = (round(self.at[0] / LANE), int(self.at[1] / 0.2))
            if spot not in self.cleaned and spot[0] < LANES:
                self.cleaned.add(spot)
                self.gained += 0.2
        sound = self.fails_at is None or self.time < self.fails_at
        if brake and brake.data:
            self.over = True
            self.gained += 0.0 if sound else 3.0
            if sound:
                self.failure = f"walker hangs on a sound pane at {self.vacuum:.0f} kPa and must be fetched"
        elif self.vacuum < 7.0 and self.time > 4.0:
            self.failure = "walker falls into its rope"
        elif state and state.data == "done":
            self.over = True
            if len(self.cleaned) < 30:
                self.failure = "front is still dirty"
        elif self.time > 90.0:
            self.failure = "front takes too long"
        if self.failure:
            self.gained -= 6.0


@pytest.mark.tarl(
    nodes=["pane_walker.py"],
    sensors=[
        Sensor(
            "vacuum", topic="cup/vacuum", field="fluid_pressure", low=0.0, high=40000.0, bins=6, unit="Pa"
        ),
        Sensor("down", topic="walker/pose", field="y", low=0.0, high=2.6, bins=5, unit="m"),
    ],
    drifts={"frosted bands": FROSTED},
    episodes=200,
    min_success=0.97,
)
def test_cleans(tarl, tarl_drift):
    """Clean three lanes of one front."""
    front = Front(tarl.rng("front"), tarl_drift or 0.0)
    tarl.start("pane_walker.py")
    while not front.done:
        front.publish(tarl.bus)
        tarl.step(DT)
        topics = ("cup/fan", "walker/velocity", "brush/duty", "rope/brake", "walker/state")
        front.advance(*(tarl.bus.latest(topic) for topic in topics))
        tarl.reward(front.gained)
    assert not front.failure, front.failure
