#!/usr/bin/env python3
"""Driverless haul truck: drive to the dump edge, tip, and stop whenever the supervisor's radio is silent."""

import math
from dataclasses import dataclass, field

import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.duration import Duration
from rclpy.node import Node
from std_msgs.msg import Bool, Empty, Float64


@dataclass
class Limits:
    cruise: float = 8.0  # speed with a load (m/s)
    comfort: float = 1.2  # deceleration by the service brake before the edge (m/s2)
    hurry: float = 1.5  # acceleration up to cruise (m/s2)


@dataclass
class Heartbeat:
    """The supervisor's handheld sends five beats a second. After a loss of beats, only a restart clears the stop."""

    patience: float = 0.6  # s
    last: object = None
    lost: bool = False
    log: list = field(default_factory=list)

    def beat(self, now):
        self.last = now

    def check(self, now):
        if self.last is not None and now - self.last > Duration(seconds=self.patience):
            if not self.lost:
                self.log.append(now)
            self.lost = True
        return not self.lost


class StopMixin:
    """Publish the signal that the safety relay requires."""

    def setup_stop(self):
        self.relay = self.create_publisher(Bool, "relay/brake", 5)

    def set_brake(self, on):
        self.relay.publish(Bool(data=on))


class HaulTruck(StopMixin, Node):
    dt = 0.1

    def __init__(self):
        super().__init__("haul_truck")
        self.limits = Limits()
        self.heartbeat = Heartbeat()
        self.distance = None
        self.speed = 0.0
        self.setup_stop()
        self.cmd = self.create_publisher(TwistStamped, "truck/cmd", 5)
        self.tip = self.create_publisher(Bool, "truck/tip", 5)
        self.create_subscription(Empty, "supervisor/heartbeat", self.heartbeat_cb, 5)
        self.create_subscription(Float64, "gps/to_edge", self.edge_cb, 5)
        self.create_subscription(Float64, "truck/speed", self.speed_cb, 5)
        self.create_timer(self.dt, self.control)

    def heartbeat_cb(self, _msg):
        self.heartbeat.beat(self.get_clock().now())

    def edge_cb(self, msg):
        self.distance = msg.data

    def speed_cb(self, msg):
        self.speed = msg.data

    def profile(self):
        """Return the highest speed from which the truck stops 4 m before the edge."""
        left = max(0.0, self.distance - 4.0)
        braked = math.sqrt(2.0 * self.limits.comfort * left)
        return min(self.limits.cruise, braked, self.speed + self.limits.hurry * self.dt * 3)

    def control(self):
        if self.distance is None:
            return
        alive = self.heartbeat.check(self.get_clock().now())
        out = TwistStamped()
        out.header.stamp = self.get_clock().now().to_msg()
        out.twist.linear.x = self.profile() if alive else 0.0
        self.cmd.publish(out)
        self.set_brake(not alive)
        standing = self.speed < 0.15 and self.distance < 6.0
        self.tip.publish(Bool(data=alive and standing))


def main(args=None):
    rclpy.init(args=args)
    truck = HaulTruck()
    rclpy.spin(truck)
    truck.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
