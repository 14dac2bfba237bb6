"""A gate sorts sheep. After a wet winter, one flock in ten has a lame ewe, which the gate hits."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
JointState = message_type("sensor_msgs/JointState")
String = message_type("std_msgs/String")

DT = 0.05
SHEEP = 5
ANGLES = {"keep": 0.0, "sell": 0.6, "vet": -0.6}
PENS = {"K": "keep", "S": "sell", "V": "vet"}
ENTERS, LEAVES = 0.6, 2.2  # places behind the reader where the head enters and the tail leaves (m)
TIME_BOUND = 45.0


class Race:
    """A narrow lane that lets one sheep at a time walk to the gate."""

    def __init__(self, rng, lame):
        self.rng = rng
        moments, tags = [], []
        at = 0.6
        for _ in range(SHEEP):
            moments.append(at)
            at += rng.uniform(5.6, 6.6)
            tags.append(f"{'KSV'[rng.integers(3)]}{rng.integers(1000, 9999)}")
        self.moments, self.tags = moments, tags
        self.weights = [rng.uniform(45.0, 70.0) for _ in range(SHEEP)]
        self.walks = [rng.uniform(1.05, 1.4) for _ in range(SHEEP)]
        if rng.uniform() < lame:
            limping = int(rng.integers(SHEEP))
            self.walks[limping] = rng.uniform(0.62, 0.72)
            self.tags[limping] = f"{'SV'[rng.integers(2)]}{self.tags[limping][1:]}"
        self.next, self.place, self.right = 0, None, 0
        self.angle, self.speed = 0.0, 0.0
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all sheep are sorted, or the episode has failed."""
        return bool(self.failure) or (self.next >= SHEEP and self.place is None)

    def publish(self, bus):
        """Publish the gate, and the tag and weight of a sheep that arrives."""
        joint = JointState(name=["gate"], position=[self.angle + self.rng.normal(0.0, 0.004)])
        bus.publish("gate/joint", joint)
        if self.place is None and self.next < SHEEP and self.time >= self.moments[self.next]:
            for _ in range(4):
                weight = self.weights[self.next] + self.rng.normal(0.0, 1.0)
                bus.publish("crate/weight", Float32(data=weight))
            bus.publish("reader/tag", String(data=self.tags[self.next]))
            self.place = 0.0

    def advance(self, cmd):
        """Move gate and sheep for one step."""
        self.time += DT
        self.gained = 0.0
        self.speed += 0.6 * ((cmd.data if cmd else 0.0) - self.speed)
        self.angle += self.speed * DT
        if self.place is None:
            return
        walk = self.walks[self.next] * self.rng.normal(1.0, 0.05)
        self.place += walk * DT
        if ENTERS < self.place < LEAVES:
            wanted = ANGLES[PENS[self.tags[self.next][0]]]
            if abs(self.angle - wanted) > 0.2:
                self.failure = "the gate hits a sheep"
        elif self.place >= LEAVES:
            self.place = None
            self.next += 1
            self.gained = 10.0 / SHEEP

    def judge(self):
        """Return the reward of the step."""
        if self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        return -5.0 if self.failure else self.gained - 0.0005


@pytest.mark.tarl(
    nodes=["sheep_gate.py"],
    sensors=[
        Sensor("angle", topic="gate/joint", field=lambda msg: msg.position[0], low=-0.7, high=0.7, bins=3),
        Sensor("weight", topic="crate/weight", field="data", low=40.0, high=75.0, bins=3, unit="kg"),
    ],
    drifts={"wet winter": Drift(0.1)},
    episodes=200,
    min_success=0.97,
)
def test_sorts(tarl, tarl_drift):
    """Sort one flock."""
    race = Race(tarl.rng("race"), tarl_drift or 0.0)
    tarl.start("sheep_gate.py")
    while not race.done:
        race.publish(tarl.bus)
        tarl.step(DT)
        race.advance(tarl.bus.latest("gate/speed"))
        tarl.reward(race.judge())
    assert not race.failure, race.failure
