"""A cart carries potted trees to beds. Tall trees rock when it starts at once with full speed."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32MultiArray = message_type("std_msgs/msg/Float32MultiArray")
Odometry = message_type("nav_msgs/msg/Odometry")

DT = 0.1
FINE = 5  # number of steps of the rocking pot per step of the world
POT = 0.11  # half of its width (m)
ROCKED = 0.012  # rad
SHRUBS, TREES = 0.22, 0.88  # heights of the centre of mass (m)
UNLOADING = 1.6  # s
TIME_BOUND = 31.5


class Cart:
    """A cart on a lane with a pot on it; `height` is that of the pot's centre of mass in m."""

    def __init__(self, rng, height):
        self.rng = rng
        self.height = height * rng.uniform(0.95, 1.05)
        self.lag = rng.uniform(0.18, 0.24)
        self.beds = [rng.uniform(3.6, 4.4)]
        for _ in range(2):
            self.beds.append(self.beds[-1] + rng.uniform(3.6, 4.4))
        self.x, self.y, self.yaw = 0.0, rng.uniform(-0.03, 0.03), rng.uniform(-0.02, 0.02)
        self.speed = 0.0
        self.rocking, self.rock = 0.0, 0.0
        self.unloaded, self.unloading = 0, 0.0
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all pots are in their beds, or the trip has ended."""
        return bool(self.failure) or self.unloaded == len(self.beds)

    def publish(self, bus):
        """Publish odometry, the beds and that nobody is in the way."""
        odom = Odometry()
        odom.pose.pose.position.x = self.x + self.rng.normal(0.0, 0.004)
        odom.pose.pose.position.y = self.y + self.rng.normal(0.0, 0.004)
        odom.pose.pose.orientation.z = 0.5 * self.yaw
        odom.pose.pose.orientation.w = 1.0
        odom.twist.twist.linear.x = self.speed
        bus.publish("odom", odom)
        bus.publish("beds", Float32MultiArray(data=self.beds))
        bus.publish("bumper/person", Bool(data=False))

    def advance(self, cmd, unload):
        """Drive for one step; a pot rocks on its edge while the cart accelerates too much."""
        ahead, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        for _ in range(FINE):
            dt = DT / FINE
            change = (ahead - self.speed) * (1.0 - math.exp(-dt / self.lag))
            self.speed += change
            self._tip(abs(change) / dt, dt)
            self.x += self.speed * dt
        self.yaw += turn * DT + self.rng.normal(0.0, 0.002)
        self.y += self.speed * self.yaw * DT
        self.time += DT
        self.gained = -0.003
        self.unloading = max(0.0, self.unloading - DT)
        if self.unloading > 0.0 and ahead > 0.0:
            self.failure = "the cart leaves while a planter lifts the pot"
        if unload is not None and unload.data == self.unloaded:
            self._unload()

    def _tip(self, acceleration, dt):
        moment = acceleration * self.height - 9.81 * POT
        inertia = 1.33 * (self.height**2 + POT**2)
        if moment > 0.0 or self.rock > 0.0:
            self.rocking += moment / inertia * dt
            self.rock = max(0.0, self.rock + self.rocking * dt)
        if self.rock == 0.0:
            self.rocking = 0.0
        if self.rock > ROCKED:
            self.failure = "a tree leans over and breaks its ties"

    def _unload(self):
        error = abs(self.x - self.beds[self.unloaded])
        self.unloaded += 1
        self.unloading = UNLOADING
        self.gained += 10.0 / len(self.beds) * (1.0 - 0.5 * min(1.0, max(0.0, error - 0.08) / 0.2))

    def judge(self):
        """Return the reward of the step: pots at their beds."""
        if self.time > TIME_BOUND:
            self.failure = "planters wait"
        elif abs(self.y) > 0.4:
            self.failure = "off the lane"
        return self.gained - (3.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["nursery_cart.py"],
    sensors=[
        Sensor("x", topic="odom", field="pose.pose.position.x", low=0.0, high=13.0, bins=8, unit="m"),
        Sensor("speed", topic="odom", field="twist.twist.linear.x", low=0.0, high=1.0, bins=4, unit="m/s"),
    ],
    drifts={"tall trees": TREES},
    episodes=200,
    min_success=0.97,
)
def test_carries(tarl, tarl_drift):
    """Carry pots to three beds."""
    cart = Cart(tarl.rng("cart"), tarl_drift or SHRUBS)
    tarl.start("nursery_cart.py")
    while not cart.done:
        cart.publish(tarl.bus)
        tarl.step(DT)
        cart.advance(tarl.bus.latest("cmd_vel"), tarl.bus.latest("unload"))
        tarl.reward(cart.judge())
    assert not cart.failure, cart.failure
