#!/usr/bin/env python3
"""Climb a utility pole with two driven rollers that a spring-loaded clamp presses against it.

The clamp presses as hard as slip demands, the rollers climb at the speed that the clamp permits. At the mark the
robot stops, holds, and reports for the inspection.
"""

import math
from dataclasses import dataclass, fields

import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.node import Node
from rclpy.parameter import Parameter
from sensor_msgs.msg import BatteryState, Imu, Range
from std_msgs.msg import Float64, String


@dataclass
class ClampConfig:
    """Force control of the clamp."""

    rest: float = 90.0  # N
    most: float = 320.0  # force of the spring (N)
    raise_by: float = 40.0  # increase per cycle with slip (N)
    relax_by: float = 1.5  # decrease per cycle without slip (N)
    slip_ratio: float = 0.12


@dataclass
class DriveConfig:
    """Speed of the rollers."""

    climb: float = 0.35  # m/s
    near: float = 0.6  # distance below the mark at which the climber slows down (m)
    creep: float = 0.08  # m/s
    lean_limit: float = 0.20  # rad
    hold_gain: float = 1.5  # 1/s


@dataclass
class EnergyConfig:
    """Limits set by the charge of the battery."""

    low: float = 0.15


class Slip:
    """Compare the turns of the rollers with the height measured by the range finder."""

    def __init__(self, window=6):
        self.window = window
        self.heights = []
        self.turned = []

    def add(self, height, turned):
        """Take one pair of readings (m)."""
        self.heights = [*self.heights[-self.window :], height]
        self.turned = [*self.turned[-self.window :], turned]

    @property
    def ratio(self):
        """Return the share of the rollers' travel that did not raise the robot."""
        if len(self.heights) <= self.window:
            return 0.0
        rolled = self.turned[-1] - self.turned[0]
        climbed = self.heights[-1] - self.heights[0]
        if abs(rolled) < 0.02:
            return 1.0 if climbed < -0.05 else 0.0
        return 1.0 - climbed / rolled


class Clamp:
    """Raise the force quickly if the rollers slip, and relax it slowly otherwise."""

    def __init__(self, config):
        self.config = config
        self.force = config.rest

    def update(self, slip):
        """Return the force for this cycle (N)."""
        c = self.config
        self.force += c.raise_by if slip > c.slip_ratio else -c.relax_by
        self.force = min(c.most, max(c.rest, self.force))
        return self.force


def with_parameters(node, prefix, config):
    """Overwrite a configuration with the parameters `prefix.name` of the node."""
    for item in fields(config):
        given = node.declare_parameter(f"{prefix}.{item.name}", getattr(config, item.name))
        if given.type_ is Parameter.Type.DOUBLE:
            setattr(config, item.name, given.value)
    return config


class Climber(Node):
    """Wire the parts together at 10 Hz."""

    PERIOD = 0.1

    def __init__(self):
        super().__init__("climber")
        self.drive = with_parameters(self, "drive", DriveConfig())
        self.energy = with_parameters(self, "energy", EnergyConfig())
        self.clamp = Clamp(with_parameters(self, "clamp", ClampConfig()))
        self.slip = Slip()
        self.mark = None
        self.height = None
        self.turned = 0.0
        self.lean = 0.0
        self.charge = 1.0
        self.state = "parked"
        self.create_subscription(Float64, "inspection/mark", self.on_mark, 10)
        self.create_subscription(Range, "ground", self.on_ground, 10)
        self.create_subscription(Float64, "rollers/turned", self.on_turned, 10)
        self.create_subscription(Imu, "imu", self.on_imu, 10)
        self.create_subscription(BatteryState, "battery", self.on_battery, 10)
        self.rollers = self.create_publisher(TwistStamped, "rollers/speed", 10)
        self.press = self.create_publisher(Float64, "clamp/force", 10)
        self.report = self.create_publisher(String, "climber/state", 10)
        self.create_timer(self.PERIOD, self.cycle)

    def on_mark(self, msg):
        """Store the height of the mark (m)."""
        self.mark = msg.data

    def on_ground(self, msg):
        """Store the height above ground if it is valid."""
        if msg.min_range <= msg.range <= msg.max_range:
            self.height = msg.range

    def on_turned(self, msg):
        """Store the travel of the rollers so far (m)."""
        self.turned = msg.data

    def on_imu(self, msg):
        """Store the lean of the robot: the angle between its axis and the pole."""
        q = msg.orientation
        upright = max(-1.0, min(1.0, 1.0 - 2.0 * (q.x * q.x + q.y * q.y)))
        self.lean = math.acos(upright)

    def on_battery(self, msg):
        """Store the charge of the battery, 0 to 1."""
        self.charge = msg.percentage

    def next_state(self):
        """Return the state for this cycle."""
        left = self.mark - self.height
        if self.charge < self.energy.low:
            return "descending"
        if self.state in ("climbing", "parked"):
            return "holding" if left < 0.05 else "climbing"
        return self.state

    def speed(self):
        """Return the required speed of the rollers (m/s)."""
        left = self.mark - self.height
        if self.state == "descending":
            return -self.drive.creep if self.height > 0.1 else 0.0
        if self.state == "holding":
            return max(-self.drive.creep, min(self.drive.creep, self.drive.hold_gain * left))
        if self.lean > self.drive.lean_limit:
            return self.drive.creep
        share = min(1.0, left / self.drive.near)
        return max(self.drive.creep, self.drive.climb * share)

    def cycle(self):
        """Run one cycle."""
        if self.mark is None or self.height is None:
            return
        self.slip.add(self.height, self.turned)
        self.state = self.next_state()
        self.press.publish(Float64(data=self.clamp.update(self.slip.ratio)))
        out = TwistStamped()
        out.header.stamp = self.get_clock().now().to_msg()
        out.twist.linear.z = self.speed()
        self.rollers.publish(out)
        self.report.publish(String(data=self.state))


def main(args=None):
    """Climb."""
    rclpy.init(args=args)
    climber = Climber()
    try:
        rclpy.spin(climber)
    finally:
        climber.destroy_node()


if __name__ == "__main__":
    main()
