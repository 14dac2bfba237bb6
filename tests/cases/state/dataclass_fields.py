from dataclasses import dataclass, field, replace
from typing import NamedTuple

import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Float64


@dataclass
class Vehicle:
    speed: float = 0.0
    heading: float = 0.0
    wheel: float = 0.3
    trace: list = field(default_factory=list)

    def stop_distance(self) -> float:
        return self.speed * self.speed / 2.0


@dataclass(frozen=True)
class Limits:
    low: float
    high: float = 2.0


class Sample(NamedTuple):
    value: float
    weight: float = 1.0


class Tracker(Node):
    def __init__(self):
        super().__init__("tracker")
        self.vehicle = Vehicle()
        self.limits = Limits(0.1)
        self.sample = Sample(0.0)
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Odometry, "odom", self.on_odom, 10)  # source odom
        self.create_timer(0.1, self.tick)

    def on_odom(self, msg):
        self.vehicle.speed = msg.twist.twist.linear.x
        self.vehicle.trace.append(msg.pose.pose.position.x)
        self.limits = Limits(low=msg.twist.twist.linear.y)
        self.sample = Sample(msg.twist.twist.angular.z, weight=0.5)

    def tick(self):
        self.pub.publish(Float64(data=self.vehicle.speed))  # sink odom
        self.pub.publish(Float64(data=self.vehicle.heading))  # clean
        self.pub.publish(Float64(data=self.vehicle.wheel))  # clean
        self.pub.publish(Float64(data=self.vehicle.stop_distance()))  # sink odom
        self.pub.publish(Float64(data=self.vehicle.trace[0]))  # sink odom
        self.pub.publish(Float64(data=self.limits.low))  # sink odom
        self.pub.publish(Float64(data=self.limits.high))  # clean
        value, weight = self.sample
        self.pub.publish(Float64(data=value))  # sink odom
        self.pub.publish(Float64(data=weight))  # clean
        slow = replace(self.vehicle, speed=0.0, trace=[])
        self.pub.publish(Float64(data=slow.speed))  # clean
        turned = replace(self.vehicle, heading=1.0)
        self.pub.publish(Float64(data=turned.speed))  # sink odom
        self.pub.publish(Float64(data=turned.heading))  # clean


def main():
    rclpy.init()
    rclpy.spin(Tracker())
