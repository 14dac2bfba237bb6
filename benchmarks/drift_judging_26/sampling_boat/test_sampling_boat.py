"""A boat takes samples beside buoys. With heavy sediment corers on board it coasts for far longer, and rams the buoys.

Each sample earns, less the further it is from its station, seconds cost a little, and a rammed buoy ends the mission.
"""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Float64 = message_type("std_msgs/msg/Float64")
Point = message_type("geometry_msgs/msg/Point")
Pose2D = message_type("geometry_msgs/msg/Pose2D")

DT = 0.2
LIGHT = {"mass": 1.0, "draught": 0.21}
HEAVY = {"mass": 2.6, "draught": 0.38}  # times the light boat, m
STATIONS = ((14.0, 2.0), (26.0, 9.0))


class Lake:
    """A lake with a boat of some `mass`; a buoy floats 2.5 m behind each station."""

    def __init__(self, rng, mass, draught):
        self.rng = rng
        self.slow = 2.6 * mass * rng.normal(1.0, 0.03)  # s
        self.draught = draught
        self.x, self.y, self.heading = 0.0, 0.0, float(rng.uniform(-0.3, 0.3))
        self.speed, self.throttle = 0.0, 0.0
        self.stations = [(x + rng.uniform(-1.5, 1.5), y + rng.uniform(-1.5, 1.5)) for x, y in STATIONS]
        self.start = (0.0, 0.0)
        self.taken = 0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the mission is over."""
        return bool(self.failure) or self.taken >= len(self.stations)

    def publish(self, bus):
        """Publish position, speed and station, and now and then the draught."""
        noise = self.rng.normal(0.0, 0.03, 2)
        bus.publish("gps/pose", Pose2D(x=self.x + noise[0], y=self.y + noise[1], theta=self.heading))
        bus.publish("gps/speed", Float64(data=self.speed + self.rng.normal(0.0, 0.01)))
        if round(self.time / DT) % 5 == 0:
            x, y = self.stations[self.taken]
            bus.publish("mission/station", Point(x=float(x), y=float(y), z=float(self.taken + 1)))
            bus.publish("hull/draught", Float32(data=self.draught + self.rng.normal(0.0, 0.005)))

    def past(self):
        """Return how far in m the boat is behind the station."""
        x, y = self.stations[self.taken]
        along = math.atan2(y - self.start[1], x - self.start[0])
        return (self.x - x) * math.cos(along) + (self.y - y) * math.sin(along)

    def advance(self, throttle, rudder, taken):
        """Drive for one step."""
        self.time += DT
        self.gained = -0.0015
        self.throttle += 0.4 * ((throttle.data if throttle else 0.0) - self.throttle)
        self.speed += DT / self.slow * (1.6 * self.throttle - self.speed)
        turn = (rudder.data if rudder else 0.0) * (0.15 + 0.45 * self.speed)
        self.heading += DT * turn
        self.x += DT * self.speed * math.cos(self.heading)
        self.y += DT * self.speed * math.sin(self.heading)
        if taken and taken.data > self.taken:
            self.gained += 4.2 - 0.15 * math.dist((self.x, self.y), self.stations[self.taken])
            self.start = self.stations[self.taken]
            self.taken = taken.data
        elif self.past() > 2.3:
            self.failure = "boat rams a buoy"
        if self.time > 150.0:
            self.failure = "battery is empty"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["sampling_boat.py", "hull.py"],
    sensors=[
        Sensor("draught", topic="hull/draught", field="data", low=0.1, high=0.5, bins=8, unit="m"),
        Sensor("speed", topic="gps/speed", field="data", low=0.0, high=1.6, bins=4, unit="m/s"),
    ],
    drifts={"heavy": HEAVY},
    episodes=200,
    min_success=0.97,
)
def test_samples(tarl, tarl_drift):
    """Take two samples: up to 4.2 for each, a small cost per second, -4 for a rammed buoy."""
    lake = Lake(tarl.rng("lake"), **(tarl_drift or LIGHT))
    tarl.start("sampling_boat.py")
    bus = tarl.bus
    while not lake.done:
        lake.publish(bus)
        tarl.step(DT)
        lake.advance(bus.latest("motor/throttle"), bus.latest("motor/rudder"), bus.latest("sampler/taken"))
        tarl.reward(lake.gained)
    assert not lake.failure, lake.failure
