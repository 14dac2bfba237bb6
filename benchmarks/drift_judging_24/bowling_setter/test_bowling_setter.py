"""A pinsetter serves a lane. It gets new pins with a smaller foot, for good; few of them wobble for a long time."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Int32 = message_type("std_msgs/msg/Int32")

DT = 0.2
WOODEN = {"wobbly": 0.0}
PLASTIC = {"wobbly": 0.022}


class Lane:
    """A lane on which a pin wobbles for seconds after a part `wobbly` of the balls."""

    def __init__(self, rng, wobbly):
        self.rng = rng
        self.wobbly = wobbly
        self.standing, self.wobble = 10, None  # wobble: when the pin falls
        self.balls, self.truth = 0, None
        self.next = 1.0
        self.rolled = False
        self.moves, self.scores = [], []
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the players go home."""
        return bool(self.failure) or (self.balls >= 6 and self.truth is None)

    def roll(self):
        """Roll a ball; the pins that it hits fall at once, or after a wobble."""
        before = self.standing
        hit = (
            int(self.rng.integers(2, 9))
            if self.standing == 10
            else int(self.rng.integers(0, self.standing + 1))
        )
        self.standing -= hit
        late = self.standing > 0 and self.rng.random() < self.wobbly
        self.wobble = None
        if late:
            self.wobble = self.time + float(self.rng.uniform(3.8, 4.8))
        elif self.standing > 0 and self.rng.random() < 0.4:
            self.wobble = self.time + float(self.rng.uniform(0.5, 2.0))
        self.truth = before - self.standing + (self.wobble is not None)
        self.balls += 1
        self.rolled = True

    def publish(self, bus, ready):
        """Publish the pit and the camera."""
        if self.next is None and ready and self.truth is None:
            self.next = self.time + float(self.rng.uniform(1.0, 2.0))
        if self.next is not None and self.time >= self.next:
            self.next = None
            self.roll()
        bus.publish("pit/ball", Bool(data=self.rolled))
        self.rolled = False
        bus.publish("camera/standing", Int32(data=self.standing))

    def advance(self):
        """Let one step pass."""
        self.time += DT
        self.gained = -0.002
        if self.wobble is not None and self.time >= self.wobble:
            self.wobble = None
            self.standing -= 1
        for score in self.scores:
            if score == self.truth:
                self.gained += 1.0
            else:
                self.failure = "score is wrong"
            self.truth = None
            over = self.standing == 0 or self.balls % 2 == 0
            if over:
                self.standing = 10
            elif self.wobble is not None:
                self.failure = "pin jams in the gripper"
        self.scores.clear()
        if self.time > 150.0:
            self.failure = "players leave"
        if self.failure:
            self.gained -= 6.0


@pytest.mark.tarl(
    nodes=["bowling_setter.py"],
    sensors=[
        Sensor("standing", topic="camera/standing", field="data", low=0.0, high=10.0, bins=10),
    ],
    drifts={"plastic": Drift(PLASTIC, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_serves(tarl, tarl_drift):
    """Serve six balls."""
    lane = Lane(tarl.rng("lane"), **(tarl_drift or WOODEN))
    tarl.start("bowling_setter.py")
    tarl.bus.subscribe("lane/fallen", lambda message: lane.scores.append(message.data))
    while not lane.done:
        ready = tarl.bus.latest("lane/ready")
        lane.publish(tarl.bus, ready is not None and ready.data)
        tarl.step(DT)
        lane.advance()
        tarl.reward(lane.gained)
    assert not lane.failure, lane.failure
