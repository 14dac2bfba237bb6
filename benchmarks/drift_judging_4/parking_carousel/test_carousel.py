"""Three cars are brought to the gate. The motor was replaced permanently by one that needs more voltage to turn."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
UInt8 = message_type("std_msgs/msg/UInt8")

DT = 0.1
CARS = 3
COUNTS = 4096.0
HOLE = 0.08  # distance in bays within which the bolt closes
TIME_BOUND = 30.0


class Tower:
    """A carousel whose motor turns above a share `breakaway` of its voltage."""

    def __init__(self, rng, breakaway):
        self.rng = rng
        self.breakaway = breakaway * rng.uniform(0.93, 1.07)
        self.bays = [int(bay) for bay in rng.choice([2, 3, 4, 5, 6], CARS, replace=False)]
        self.place, self.speed = 0.0, 0.0
        self.bolted, self.served, self.handed = False, 0, False
        self.opened = False
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all drivers have their cars or one has waited too long."""
        return self.served == CARS or bool(self.failure)

    def publish(self, bus):
        """Publish the request, the encoder and the bolt's switch."""
        bus.publish("gate/request", UInt8(data=self.bays[min(self.served, CARS - 1)]))
        bus.publish("motor/counts", Float32(data=self.place * COUNTS + self.rng.normal(0.0, 8.0)))
        bus.publish("bolt/closed", Bool(data=self.bolted))

    def advance(self, drive, bolt, gate):
        """Turn for one step if the bolt is open."""
        volts = max(-1.0, min(1.0, drive.data)) if drive else 0.0
        turning = abs(volts) > self.breakaway and not self.bolted
        pull = 1.3 * (abs(volts) - 0.5 * self.breakaway) * (1.0 if volts > 0 else -1.0) if turning else 0.0
        self.speed += (pull - self.speed) * 0.6
        if not turning and abs(self.speed) < 0.02:
            self.speed = 0.0
        self.place += self.speed * DT
        off = abs(self.place - self.bays[min(self.served, CARS - 1)])
        self.bolted = bool(bolt and bolt.data and off < HOLE and abs(self.speed) < 0.05)
        opens = bool(gate and gate.data)
        self.handed = opens and not self.opened and self.bolted
        if opens and not self.opened and not self.bolted:
            self.failure = "the gate opens before a loose bay"
        self.opened = opens
        self.served += self.handed
        self.time += DT

    def judge(self):
        """Return the reward of the step: each car is rewarded, waiting time costs."""
        if self.time > TIME_BOUND and self.served < CARS:
            self.failure = f"{self.served} of {CARS} cars"
        return -3.0 if self.failure else 3.5 * self.handed - 0.003


@pytest.mark.tarl(
    nodes=["carousel.py", "profiles.py"],
    sensors=[
        Sensor("counts", topic="motor/counts", field="data", low=0, high=26000, bins=6),
        Sensor("request", topic="gate/request", field="data", low=1.5, high=6.5, bins=5),
    ],
    drifts={"new motor": Drift(0.27, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_brings_cars(tarl, tarl_drift):
    """Serve some drivers."""
    tower = Tower(tarl.rng("tower"), tarl_drift or 0.08)
    tarl.start("carousel.py")
    while not tower.done:
        tower.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        tower.advance(latest("motor/drive"), latest("bolt/close"), latest("gate/open"))
        tarl.reward(tower.judge())
    assert not tower.failure, tower.failure
