"""The tail lift of a parcel van. On winter mornings its oil is thick: a small opening moves nothing, and shuts late."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Range = message_type("sensor_msgs/Range")
Bool = message_type("std_msgs/Bool")

DT = 0.1
SUMMER = {"stiction": 0.17, "gain": 0.30, "shut": 0.12}
WINTER = {"stiction": 0.29, "gain": 0.42, "shut": 1.15}  # opening, m/s per opening, s


class Hydraulics:
    """A platform on a cylinder; openings below `stiction` move nothing; the valve follows within about `shut` s."""

    def __init__(self, rng, stiction, gain, shut):
        self.rng = rng
        self.stiction = stiction + rng.normal(0.0, 0.006)
        self.gain = gain * rng.normal(1.0, 0.03)
        self.shut = shut * rng.uniform(0.7, 1.3)
        self.height, self.slot = float(rng.uniform(0.15, 0.3)), 0.0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the platform is locked, or the lift failed."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the height, and first the request."""
        if self.time < 0.15:
            bus.publish("lift/request", Bool(data=True))
        bus.publish("platform/height", Range(range=self.height + self.rng.normal(0.0, 0.0008)))

    def advance(self, opening, state):
        """Move for one step."""
        self.time += DT
        self.gained = -0.015
        wish = max(0.0, min(1.0, opening.data)) if opening else 0.0
        for _ in range(4):
            self.slot += min(1.0, DT / 4.0 / self.shut) * (wish - self.slot)
            flow = self.gain * max(0.0, self.slot - self.stiction)
            self.height += DT / 4.0 * flow
        if self.height > 1.085:
            self.failure = "platform hits the door frame"
        elif state and state.data == "fault":
            self.failure = "platform is stuck"
        elif self.time > 18.0:
            self.failure = "lift takes too long"
        elif state and state.data == "locked":
            step = abs(self.height - 1.05)
            self.over = True
            self.gained += 5.0 - 80.0 * step
            if step > 0.014:  # the trolley does not roll over it
                self.failure = "platform is not level with the floor"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["tail_lift.py"],
    sensors=[
        Sensor("height", topic="platform/height", field="range", low=0.0, high=1.2, bins=6, unit="m"),
        Sensor("valve", topic="hydraulics/valve", field="data", low=0.0, high=1.0, bins=5),
    ],
    drifts={"winter": WINTER},
    episodes=200,
    min_success=0.97,
)
def test_lifts(tarl, tarl_drift):
    """Raise the platform once."""
    lift = Hydraulics(tarl.rng("hydraulics"), **(tarl_drift or SUMMER))
    tarl.start("tail_lift.py")
    while not lift.done:
        lift.publish(tarl.bus)
        tarl.step(DT)
        lift.advance(tarl.bus.latest("hydraulics/valve"), tarl.bus.latest("lift/state"))
        tarl.reward(lift.gained)
    assert not lift.failure, lift.failure
