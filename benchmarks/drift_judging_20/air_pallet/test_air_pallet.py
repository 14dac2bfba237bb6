"""A pallet floats on air to a dock. The hall gets a sealed floor, on which the skirts no longer drag."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Odometry = message_type("nav_msgs/Odometry")
PoseStamped = message_type("geometry_msgs/PoseStamped")

DT = 0.1
CONCRETE, SEALED = 1.45, 0.12  # drag of the skirts, 1/s


class Hall:
    """A hall whose floor drags with `drag`, in 1/s; the dock has a stop behind it and at its sides."""

    def __init__(self, rng, drag):
        self.rng = rng
        self.drag = drag * rng.normal(1.0, 0.06)
        self.mass = rng.normal(240.0, 8.0)
        self.dock = (float(rng.uniform(2.5, 4.0)), float(rng.uniform(-1.2, 1.2)))
        self.tilt = rng.normal(0.0, 0.004, 2)  # m/s², from the slope of the floor
        self.at, self.speed, self.lift = [0.0, 0.0], [0.0, 0.0], 0.0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the pallet stands, or something broke."""
        return bool(self.failure) or self.over

    @property
    def off(self):
        """Return how far the pallet is from its dock, in m."""
        return sum((here - there) ** 2 for here, there in zip(self.at, self.dock, strict=True)) ** 0.5

    def publish(self, bus):
        """Publish the position and the dock."""
        odom = Odometry()
        odom.pose.pose.position.x = self.at[0] + self.rng.normal(0.0, 0.004)
        odom.pose.pose.position.y = self.at[1] + self.rng.normal(0.0, 0.004)
        odom.twist.twist.linear.x = self.speed[0] + self.rng.normal(0.0, 0.006)
        odom.twist.twist.linear.y = self.speed[1] + self.rng.normal(0.0, 0.006)
        bus.publish("odom", odom)
        if round(self.time / DT) % 10 == 0:
            dock = PoseStamped()
            dock.pose.position.x, dock.pose.position.y = self.dock
            bus.publish("dock", dock)

    def advance(self, wrench, air, state):
        """Float for one step; without air the pallet sinks and stands."""
        self.lift += 0.25 * (float(bool(air and air.data)) - self.lift)
        fast = (self.speed[0] ** 2 + self.speed[1] ** 2) ** 0.5
        push = (wrench.force.x, wrench.force.y) if wrench else (0.0, 0.0)
        for axis in (0, 1):
            if self.lift < 0.5:
                self.speed[axis] *= 0.3
            else:
                pull = push[axis] / self.mass + self.tilt[axis] - self.drag * self.speed[axis]
                self.speed[axis] += DT * pull
            self.at[axis] += DT * self.speed[axis]
        self.time += DT
        self.gained = -0.001
        if self.at[0] > self.dock[0] + 0.4 and fast > 0.15:
            self.failure = f"pallet hits the stop with {fast:.2f} m/s"
        elif air and not air.data and self.lift > 0.7 and self.time > 3.0 and fast > 0.2:
            self.failure = f"cushions tear, set down at {fast:.2f} m/s"
        elif self.time > 45.0:
            self.failure = "dock waits in vain"
        elif state and state.data == "docked":
            self.over = True
            self.gained += 6.0 - 2.0 * (self.off / 0.1) ** 2
            if self.off > 0.1:
                self.failure = f"pallet stands {self.off:.2f} m off"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["air_pallet.py"],
    sensors=[
        Sensor("x", topic="odom", field="pose.pose.position.x", low=0.0, high=5.0, bins=6, unit="m"),
        Sensor("speed", topic="odom", field="twist.twist.linear.x", low=-1.0, high=1.5, bins=5, unit="m/s"),
    ],
    drifts={"sealed floor": SEALED},
    episodes=200,
    min_success=0.97,
)
def test_docks(tarl, tarl_drift):
    """Float one pallet to its dock."""
    hall = Hall(tarl.rng("hall"), tarl_drift or CONCRETE)
    tarl.start("air_pallet.py")
    while not hall.done:
        hall.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        hall.advance(bus.latest("fans/wrench"), bus.latest("cushions/air"), bus.latest("pallet/state"))
        tarl.reward(hall.gained)
    assert not hall.failure, hall.failure
