"""A laser engraves a board. Oak needs more energy per millimetre, and burns black with less power than lime does."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
PointStamped = message_type("geometry_msgs/PointStamped")
BatteryState = message_type("sensor_msgs/BatteryState")

DT = 0.05
WIDTH, ROWS, PITCH = 90.0, 5, 4.0  # mm
DEEP = 1.2  # mm
TIME_BOUND = 40.0


class Board:
    """A board on a gantry; the depth of each row is the mean over what was burnt."""

    def __init__(self, rng, oak):
        self.rng = rng
        self.density = rng.uniform(700.0, 760.0) if oak else rng.uniform(500.0, 550.0)
        self.depth_per = (1.5 if oak else 2.4) * rng.uniform(0.98, 1.02)  # depth per energy (mm per J/mm)
        self.black_at = 19.0 if oak else 21.0  # W² s/mm
        self.x, self.y, self.vx, self.vy = 3.0, 0.0, 0.0, 0.0
        self.volts = rng.uniform(46.0, 49.0)
        self.burnt, self.length = 0.0, 0.0  # burnt area (mm²) and length (mm) of this row
        self.finished = 0
        self.black = 0
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the board is engraved, or the episode has failed."""
        return self.finished >= ROWS or bool(self.failure)

    def publish(self, bus):
        """Publish place, speed, lid, supply and the weight of the board."""
        place = PointStamped()
        place.point.x, place.point.y = self.x, self.y
        bus.publish("gantry/place", place)
        bus.publish("gantry/speed", Float32(data=self.vx + self.rng.normal(0.0, 0.2)))
        bus.publish("lid/open", Bool(data=self.time < 0.2))
        bus.publish("supply", BatteryState(voltage=self.volts))
        bus.publish("board/density", Float32(data=self.density + self.rng.normal(0.0, 3.0)))

    def advance(self, cmd, power):
        """Move and burn for one step."""
        self.time += DT
        self.gained = 0.0
        x, y = (cmd.linear.x, cmd.linear.y) if cmd else (0.0, 0.0)
        self.vx += 0.7 * (x - self.vx)
        self.vy += 0.7 * (y - self.vy)
        self.x, self.y = self.x + self.vx * DT, self.y + self.vy * DT
        watts = (power.data if power else 0.0) * self.volts / 48.0
        if watts > 0.5 and self.vx > 1.0 and 5.0 < self.x < WIDTH - 6.0:
            self.burn(watts)
        elif self.length > 0.7 * WIDTH and self.x >= WIDTH - 6.0:
            self.finish()

    def burn(self, watts):
        """Burn what the laser passes in one step."""
        way = self.vx * DT
        self.burnt += self.depth_per * watts / self.vx * way * self.rng.normal(1.0, 0.04)
        self.length += way
        self.black = self.black + 1 if watts**2 / self.vx > self.black_at else 0

    def finish(self):
        """Measure a finished row."""
        off = self.burnt / self.length / DEEP - 1.0
        if abs(off) > 0.14:
            self.failure = "a row is not as deep as the others"
        self.gained = 10.0 / ROWS * (1.0 - 0.5 * (off / 0.14) ** 2)
        self.burnt, self.length = 0.0, 0.0
        self.finished += 1

    def judge(self):
        """Return the reward of the step."""
        if self.black >= 4:
            self.failure = "the wood is black"
        elif self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        return -4.0 if self.failure else self.gained - 0.0005


@pytest.mark.tarl(
    nodes=["wood_engraver.py"],
    sensors=[
        Sensor("density", topic="board/density", field="data", low=450.0, high=800.0, bins=4, unit="kg/m³"),
        Sensor("x", topic="gantry/place", field="point.x", low=0.0, high=90.0, bins=4, unit="mm"),
    ],
    drifts={"oak": Drift(True)},
    episodes=100,
    min_success=0.95,
)
def test_engraves(tarl, tarl_drift):
    """Engrave one board."""
    board = Board(tarl.rng("board"), bool(tarl_drift))
    tarl.start("wood_engraver.py")
    while not board.done:
        board.publish(tarl.bus)
        tarl.step(DT)
        board.advance(tarl.bus.latest("gantry/cmd"), tarl.bus.latest("laser/power"))
        tarl.reward(board.judge())
    assert not board.failure, board.failure
