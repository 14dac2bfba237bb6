"""A plate balances a ball. After a service, the plugs of its two servos are swapped."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Point = message_type("geometry_msgs/msg/Point")

DT = 0.04
STEPS = 280


class Plate:
    """A ball on a plate of 38 by 28 cm; `swapped` tells that each servo moves the other axis."""

    def __init__(self, rng, swapped):
        self.rng = rng
        self.swapped = swapped
        self.place = [float(rng.uniform(-0.06, 0.06)), float(rng.uniform(-0.05, 0.05))]
        self.speed = [0.0, 0.0]
        self.angle = [0.0, 0.0]
        self.level = rng.normal(0.0, 0.002, 2)  # tilt of the table (rad)
        sides = [float(side) for side in rng.choice([-1.0, 1.0], 2)]
        self.goals = [(0.10 * sides[0], 0.06 * sides[1]), (-0.10 * sides[0], 0.07 * sides[1])]
        self.now, self.near, self.gained, self.fallen = 0, 0, 0.0, False

    @property
    def done(self):
        """Return whether the ball has fallen, or the visitor leaves."""
        return self.fallen or self.now >= STEPS

    @property
    def goal(self):
        """Return the button that the visitor has pressed."""
        return self.goals[0] if self.now < STEPS // 2 else self.goals[1]

    def publish(self, bus):
        """Publish the ball in the image, and the button."""
        seen = Point()
        seen.x = 320.0 + 1180.0 * self.place[0] + self.rng.normal(0.0, 0.7)
        seen.y = 240.0 - 1180.0 * self.place[1] + self.rng.normal(0.0, 0.7)
        bus.publish("camera/ball", seen)
        if self.now % 20 == 0:
            bus.publish("exhibit/goal", Point(x=self.goal[0], y=self.goal[1], z=0.0))

    def advance(self, command):
        """Tilt the plate and roll the ball for one step."""
        wish = [command.x, command.y] if command else [0.0, 0.0]
        if self.swapped:
            wish.reverse()
        off = 0.0
        for i, rim in enumerate((0.19, 0.14)):
            self.angle[i] += max(-0.06, min(0.06, 0.5 * (wish[i] - self.angle[i])))
            pull = 7.0 * (self.angle[i] + self.level[i]) - 0.25 * self.speed[i]
            self.speed[i] += DT * (pull + self.rng.normal(0.0, 0.05))
            self.place[i] += DT * self.speed[i]
            self.fallen = self.fallen or abs(self.place[i]) > rim
            off = max(off, abs(self.place[i] - self.goal[i]))
        self.now += 1
        self.gained = 0.02 - min(0.06, 0.3 * off)
        if self.now % (STEPS // 2) > STEPS // 4:
            self.near += off < 0.03
            self.gained += 0.06 * (off < 0.03)
        if self.fallen:
            self.gained -= 8.0


@pytest.mark.tarl(
    nodes=["ball_plate.py", "axis_pd.py"],
    sensors=[
        Sensor("column", topic="camera/ball", field="x", low=100.0, high=540.0, bins=4, unit="px"),
        Sensor("row", topic="camera/ball", field="y", low=75.0, high=405.0, bins=4, unit="px"),
    ],
    drifts={"swapped plugs": Drift(True, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_balances(tarl, tarl_drift):
    """Carry the ball to two buttons."""
    plate = Plate(tarl.rng("plate"), bool(tarl_drift))
    tarl.start("ball_plate.py")
    while not plate.done:
        plate.publish(tarl.bus)
        tarl.step(DT)
        plate.advance(tarl.bus.latest("plate/tilt"))
        tarl.reward(plate.gained)
    assert not plate.fallen, "ball fell from the plate"
    assert plate.near >= 100, f"ball at the goals for {DT * plate.near:.1f} s"
