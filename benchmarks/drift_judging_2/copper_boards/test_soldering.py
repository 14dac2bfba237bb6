"""All joints are sound; they are inspected after the last one. Boards with a ground plane heat up more slowly."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Float32MultiArray = message_type("std_msgs/Float32MultiArray")
String = message_type("std_msgs/String")

DT = 0.05
JOINTS = 3
SOUND = (210.0, 260.0)  # range for the highest temperature of a joint, °C
HOTTEST = 400.0  # highest possible temperature of the iron, °C
TIME_BOUND = 20.0


class Board:
    """A board whose joints take `slow` times as long to heat as those of a plain board."""

    def __init__(self, rng, slow, bus):
        self.rng = rng
        self.kind = "plain" if slow == 1.0 else "ground plane"
        self.areas = [rng.uniform(0.8, 2.4) for _ in range(JOINTS)]
        self.constants = [(0.7 + 0.25 * area) * slow * rng.uniform(0.96, 1.04) for area in self.areas]
        self.joints = [25.0] * JOINTS
        self.peaks = [25.0] * JOINTS
        self.tip = rng.uniform(330.0, 350.0)
        self.touching = 0.0
        self.time = 0.0
        self.done = False
        self.failure = ""
        bus.subscribe("head/touch", self.on_touch)

    def on_touch(self, msg):
        """Lower the head for some seconds."""
        self.touching = msg.data

    def publish(self, bus):
        """Publish the label and the temperature of the tip."""
        bus.publish("board/kind", String(data=self.kind))
        bus.publish("board/pads", Float32MultiArray(data=self.areas))
        bus.publish("iron/tip", Float32(data=self.tip + self.rng.normal(0.0, 0.5)))

    def advance(self, bus):
        """Heat for one step."""
        setpoint, joint, done = (bus.latest(topic) for topic in ("iron/setpoint", "head/joint", "board/done"))
        wanted = min(HOTTEST, setpoint.data) if setpoint else 180.0
        self.tip += (wanted - self.tip) * DT / 0.5
        at = int(joint.data) if joint else -1
        for i in range(JOINTS):
            if i == at and self.touching > 0.0:
                self.joints[i] += (self.tip - self.joints[i]) * DT / self.constants[i]
            else:
                self.joints[i] += (25.0 - self.joints[i]) * DT / 3.0
            self.peaks[i] = max(self.peaks[i], self.joints[i])
        self.touching -= DT
        self.done = bool(done and done.data)
        self.time += DT

    def judge(self):
        """Return the reward of the step, which is 0 before the inspection."""
        if self.time > TIME_BOUND:
            self.failure = "late"
            return -8.0
        if not self.done:
            return 0.0
        bad = [peak for peak in self.peaks if not SOUND[0] <= peak <= SOUND[1]]
        if bad:
            self.failure = f"{len(bad)} joints bad, one got {bad[0]:.0f} degrees"
            return -8.0
        return 10.0


@pytest.mark.tarl(
    nodes=["soldering.py", "solder_profile.py"],
    sensors=[
        Sensor("board", topic="board/kind", field="data", categories=("plain", "ground plane")),
        Sensor("tip", topic="iron/tip", field="data", low=320, high=360, bins=4, unit="°C"),
    ],
    drifts={"ground plane": 1.8},
    episodes=100,
    min_success=0.95,
)
def test_joints_are_sound(tarl, tarl_drift):
    """Solder one board."""
    board = Board(tarl.rng("board"), tarl_drift or 1.0, tarl.bus)
    tarl.start("soldering.py")
    while not (board.done or board.failure):
        board.publish(tarl.bus)
        tarl.step(DT)
        board.advance(tarl.bus)
        tarl.reward(board.judge())
    assert not board.failure, board.failure
