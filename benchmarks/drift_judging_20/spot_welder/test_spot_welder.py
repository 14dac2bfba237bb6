"""A gun welds spots on a flange. Galvanised sheets take more current, since their zinc melts first."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Int32 = message_type("std_msgs/msg/Int32")
WrenchStamped = message_type("geometry_msgs/msg/WrenchStamped")

DT = 0.01
BARE = {"micron": 0.0, "shunt": 1.0}
ZINC = {"micron": 11.0, "shunt": 0.82}
SPOTS = 4


class Flange:
    """A flange of two sheets with `micron` of zinc; the share `shunt` of the current heats the nugget."""

    def __init__(self, rng, micron, shunt):
        self.rng = rng
        self.micron = micron
        self.shunt = shunt
        self.caps = int(rng.integers(0, 140))
        self.force, self.left = 0.0, SPOTS
        self.time, self.gained, self.failure = 0.0, 0.0, ""
        self.next_spot()

    @property
    def done(self):
        """Return whether all spots are set, or one is bad."""
        return bool(self.failure) or self.left == 0

    def next_spot(self):
        """Bring the gun to the next spot."""
        self.heat, self.cold, self.pause = 0.0, self.rng.normal(1.0, 0.018), 10

    @property
    def nugget(self):
        """Return the diameter of the nugget, in mm."""
        return 5.6 * self.cold * (self.heat / 18.2) ** 0.5

    def publish(self, bus):
        """Publish the robot, the gun, and now and then the caps and the gauge for coatings."""
        bus.publish("robot/in_place", Bool(data=self.pause == 0))
        load = WrenchStamped()
        load.wrench.force.z = 1000.0 * (self.force + self.rng.normal(0.0, 0.015))
        bus.publish("gun/load", load)
        if round(self.time / DT) % 50 == 0:
            bus.publish("caps/welds", Int32(data=self.caps))
            gauge = self.micron + self.rng.normal(0.0, 0.6)
            bus.publish("sheet/coating", Float32(data=max(0.0, gauge)))

    def advance(self, kiloamps, force, state):
        """Weld for one step; worn caps press on a wider face and heat less."""
        self.force += 0.15 * ((force.data if force else 0.0) - self.force)
        current = kiloamps.data if kiloamps else 0.0
        self.time += DT
        self.gained = -0.0003
        if self.pause:
            self.pause -= 1
            return
        worn = 1.0 + 0.0011 * self.caps
        self.heat += DT * (current * self.shunt / worn) ** 2
        if current > 1.0 and self.force < 2.0:
            self.failure = "sparks, the gun presses too little"
        elif self.nugget > 6.7:
            self.failure = "steel spits out of the nugget"
        elif self.time > 12.0:
            self.failure = "robot waits for the gun"
        elif state and state.data == "release":
            self.judge()
        if self.failure:
            self.gained -= 4.0

    def judge(self):
        """Judge a spot by its nugget."""
        off = (self.nugget - 5.6) / 0.8
        self.gained += 1.5 * max(-1.0, 1.0 - off**2)
        if self.nugget < 4.8:
            self.failure = f"nugget of {self.nugget:.1f} mm peels off"
        self.left -= 1
        self.caps += 1
        if self.left:
            self.next_spot()


@pytest.mark.tarl(
    nodes=["spot_welder.py", "weld_schedule.py"],
    sensors=[
        Sensor("coating", topic="sheet/coating", field="data", low=0.0, high=20.0, bins=5, unit="um"),
        Sensor("force", topic="gun/load", field="wrench.force.z", low=0.0, high=3000.0, bins=5, unit="N"),
    ],
    drifts={"galvanised": ZINC},
    episodes=200,
    min_success=0.97,
)
def test_welds(tarl, tarl_drift):
    """Weld four spots on a flange."""
    flange = Flange(tarl.rng("flange"), **(tarl_drift or BARE))
    tarl.start("spot_welder.py")
    while not flange.done:
        flange.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        flange.advance(bus.latest("gun/kiloamps"), bus.latest("gun/force"), bus.latest("gun/state"))
        tarl.reward(flange.gained)
    assert not flange.failure, flange.failure
