"""An arm moves chess pieces. The club has bought tournament boards, whose squares are larger."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

PointStamped = message_type("geometry_msgs/PointStamped")
Pose2D = message_type("geometry_msgs/Pose2D")
String = message_type("std_msgs/String")

DT = 0.1
CLUB = 0.050  # side of a square (m)
TOURNAMENT = 0.057
FRAME = 0.018
TIME_BOUND = 32.0
PIECES = {"pawn": 0.042, "knight": 0.054, "bishop": 0.062, "queen": 0.074}


class Table:
    """A board, one piece to be moved, and an arm with a two-finger gripper."""

    def __init__(self, rng, square):
        self.rng = rng
        self.square = square
        self.x, self.y = 0.22 + rng.normal(0.0, 0.01), -0.02 + rng.normal(0.0, 0.01)
        self.yaw = rng.normal(0.0, 0.05)
        self.piece = rng.choice(list(PIECES))
        start = rng.integers(0, 8), rng.integers(0, 3)
        self.goal = rng.integers(0, 8), rng.integers(3, 7)
        self.move = f"{self.piece} {self.name(start)}{self.name(self.goal)}"
        self.at = [c + rng.normal(0.0, 0.002) for c in self.centre(start)]
        self.tip, self.width = [0.10, -0.12, 0.16], 1.0
        self.held, self.failure, self.placed, self.time, self.gained = False, "", False, 0.0, 0.0

    @staticmethod
    def name(cell):
        """Return the name of a square."""
        return "abcdefgh"[cell[0]] + str(cell[1] + 1)

    def centre(self, cell):
        """Return the centre of a square in the frame of the arm."""
        a, b = (FRAME + (index + 0.5) * self.square for index in cell)
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return self.x + c * a - s * b, self.y + s * a + c * b

    @property
    def done(self):
        """Return whether the move has ended."""
        return bool(self.failure) or self.placed

    def publish(self, bus):
        """Publish the tip of the arm, the corner of the board, and the move after one second."""
        tip = PointStamped()
        tip.point.x, tip.point.y, tip.point.z = (v + self.rng.normal(0.0, 0.0004) for v in self.tip)
        bus.publish("arm/tip", tip)
        noise = self.rng.normal(0.0, (0.001, 0.001, 0.003))
        bus.publish("board/corner", Pose2D(self.x + noise[0], self.y + noise[1], self.yaw + noise[2]))
        if abs(self.time - 1.0) < 0.5 * DT:
            bus.publish("chess/move", String(self.move))

    def advance(self, target, grip):
        """Move the arm for one step."""
        self.time += DT
        self.gained = -0.01
        if target:
            for axis, wish in enumerate((target.x, target.y, target.z)):
                self.tip[axis] += max(-0.03, min(0.03, 0.6 * (wish - self.tip[axis])))
        before = self.width
        self.width += max(-0.34, min(0.34, (0.0 if grip and grip.data else 1.0) - self.width))
        off = math.hypot(self.tip[0] - self.at[0], self.tip[1] - self.at[1])
        if before >= 0.3 > self.width and self.tip[2] < PIECES[self.piece]:
            self.held = off < 0.012
            self.failure = "" if self.held else f"fingers close {1000 * off:.0f} mm beside the piece"
            self.gained += 2.0 if self.held else 0.0
        if self.held:
            self.at = self.tip[:2]
            if self.width > 0.3:
                self.release()
        if self.time > TIME_BOUND and not self.done:
            self.failure = "the move takes too long"
        if self.failure:
            self.gained -= 5.0

    def release(self):
        """Put the piece down and see where it stands."""
        self.held = False
        goal = self.centre(self.goal)
        off = math.hypot(self.at[0] - goal[0], self.at[1] - goal[1])
        if off > 0.014:
            self.failure = f"piece stands {1000 * off:.0f} mm from its square"
        else:
            self.placed = True
            self.gained += 8.0 * (1.0 - 0.3 * off / 0.014)


@pytest.mark.tarl(
    nodes=["chess_arm.py", "board.py"],
    sensors=[
        Sensor("tip_x", topic="arm/tip", field="point.x", low=0.1, high=0.7, bins=4, unit="m"),
        Sensor("tip_y", topic="arm/tip", field="point.y", low=-0.1, high=0.5, bins=4, unit="m"),
        Sensor("tip_z", topic="arm/tip", field="point.z", low=0.0, high=0.2, bins=3, unit="m"),
    ],
    drifts={"tournament board": Drift(TOURNAMENT, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_plays(tarl, tarl_drift):
    """Play one move."""
    table = Table(tarl.rng("table"), tarl_drift or CLUB)
    tarl.start("chess_arm.py")
    while not table.done:
        table.publish(tarl.bus)
        tarl.step(DT)
        table.advance(tarl.bus.latest("arm/target"), tarl.bus.latest("gripper/close"))
        tarl.reward(table.gained)
    assert not table.failure, table.failure
