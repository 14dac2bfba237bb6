"""The boom reaches two angles. After a repair of the valve, its two hoses are permanently swapped."""

from pathlib import Path

import pytest
import yaml

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
JointState = message_type("sensor_msgs/msg/JointState")

DT = 0.05
EACH = 110  # number of steps per angle
HOLD = 25  # number of last steps that are rewarded
NEAR = 0.04  # rad
STOPS = (-0.6, 1.1)  # rad
LEAK = 0.12  # rad/s


class Loader:
    """A boom on a cylinder; `hoses` is -1 if the hoses are swapped."""

    def __init__(self, rng, hoses):
        self.rng = rng
        self.hoses = hoses
        self.angle = rng.uniform(-0.2, 0.2)
        self.goals = [rng.uniform(0.3, 0.6), rng.uniform(-0.2, 0.1)]
        self.strength = rng.uniform(0.45, 0.55)  # rate with a fully open valve (rad/s)
        self.line = [0.0, 0.0]
        self.rate, self.missed, self.step = 0.0, 0, 0
        self.failure = ""

    @property
    def done(self):
        """Return whether the time for both angles is over."""
        return self.step >= EACH * len(self.goals)

    @property
    def goal(self):
        """Return the target angle at this step."""
        return self.goals[min(self.step // EACH, len(self.goals) - 1)]

    def publish(self, bus):
        """Publish goal and joints."""
        bus.publish("/loader/boom/goal", Float64(data=self.goal))
        seen = self.angle + self.rng.normal(0.0, 0.001)
        bus.publish("/loader/joint_states", JointState(name=["bucket", "boom"], position=[0.1, seen]))

    def advance(self, spool):
        """Let the oil flow for one step."""
        open_ = max(-1.0, min(1.0, spool.data)) if spool else 0.0
        self.line.append(0.0 if abs(open_) < 0.04 else open_)
        oil = self.line.pop(0)  # the spool moves with a delay
        self.rate += (self.hoses * self.strength * oil - self.rate) * 0.15
        self.angle = max(STOPS[0], min(STOPS[1], self.angle + (self.rate - LEAK) * DT))

    def judge(self):
        """Return the reward of the step: a little for progress, most for holding still at the end."""
        off = abs(self.goal - self.angle)
        late = self.step % EACH >= EACH - HOLD
        self.step += 1
        if late:
            self.missed += off > NEAR
            if self.missed > 6:
                self.failure = f"the boom is {off:.2f} rad away from its angle"
                return -5.0
            return 10.0 / (2 * HOLD) * max(0.0, 1.0 - off / NEAR * 0.5) if off <= NEAR else 0.0
        return 0.0


@pytest.mark.tarl(
    nodes=["boom_controller.py", "pid.py"],
    sensors=[
        Sensor(
            "boom", topic="/loader/joint_states", field="position.1", low=-0.6, high=1.1, bins=6, unit="rad"
        ),
        Sensor("goal", topic="/loader/boom/goal", field="data", low=-0.4, high=0.8, bins=4, unit="rad"),
    ],
    drifts={"swapped hoses": Drift(-1.0, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_reaches_its_angles(tarl, tarl_drift):
    """Raise, then lower."""
    loader = Loader(tarl.rng("loader"), tarl_drift or 1.0)
    config = yaml.safe_load(Path(__file__).with_name("boom.yaml").read_text())
    given = dict(config["/loader/boom_controller"]["ros__parameters"])
    gains = given.pop("pid")
    tarl.start("boom_controller.py", parameters={**given, **{f"pid.{key}": g for key, g in gains.items()}})
    while not (loader.done or loader.failure):
        loader.publish(tarl.bus)
        tarl.step(DT)
        loader.advance(tarl.bus.latest("/loader/boom/spool"))
        tarl.reward(loader.judge())
    assert not loader.failure, loader.failure
