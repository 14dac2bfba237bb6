"""Carry samples through a hospital's tube post: blow the carrier to the far station, and brake it with air."""

from collections import deque
from enum import Enum

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32, Int32, String


class Phase(Enum):
    READY = 0
    BLOW = 1
    BRAKE = 2
    CREEP = 3
    ARRIVED = 4


class TubePost(Node):
    REED = 0.5  # distance between two reed switches (m)

    def __init__(self):
        super().__init__("tube_post")
        self.length = self.declare_parameter("length", 70.0).value  # m
        self.cruise = self.declare_parameter("cruise", 6.0).value  # m/s
        self.deceleration = self.declare_parameter("deceleration", 2.4).value  # m/s²
        self.margin = self.declare_parameter("margin", 2.5).value  # m
        self.creep = self.declare_parameter("creep", 1.2).value  # m/s
        self.gain = self.declare_parameter("gain", 0.8).value  # 1/(m/s)
        self.phase = Phase.READY
        self.reeds = 0
        self.passed = None
        self.passages = deque(maxlen=5)
        self.speed = 0.0
        self.sender = ""
        self.create_subscription(Int32, "tube/reed", self.on_reed, 10)
        self.create_subscription(String, "sender/request", self.on_request, 10)
        self.blower = self.create_publisher(Float32, "blower/drive", 10)
        self.state = self.create_publisher(String, "tube/state", 10)
        self.create_timer(0.05, self.tick)

    def seconds(self):
        return self.get_clock().now().nanoseconds * 1e-9

    def on_request(self, msg):
        if self.phase is Phase.READY:
            self.sender = msg.data
            self.phase = Phase.BLOW

    def on_reed(self, msg):
        """Count the switches; the time between some of them gives the speed."""
        now = self.seconds()
        self.passages.append((now, msg.data))
        if len(self.passages) > 1:
            (begin, first), (end, last) = self.passages[0], self.passages[-1]
            self.speed = (last - first) * self.REED / max(0.01, end - begin)
        self.reeds = msg.data
        self.passed = now

    def left(self):
        since = self.seconds() - self.passed if self.passed is not None else 0.0
        ahead = min(self.REED, self.speed * since)
        return self.length - self.reeds * self.REED - ahead

    def braking_way(self):
        over = max(0.0, self.speed**2 - self.creep**2)
        return over / (2.0 * self.deceleration) + self.margin

    def at_most(self):
        """Return the speed; no reed for a while means that the carrier is slower than at the last one."""
        if self.passed is None:
            return self.speed
        return min(self.speed, self.REED / max(0.05, self.seconds() - self.passed))

    def held(self, wanted):
        """Return the drive that holds a speed."""
        drive = self.gain * (wanted - self.at_most()) + 0.02 * wanted
        return max(-1.0, min(1.0, drive))

    def tick(self):
        drive = 0.0
        if self.phase is Phase.BLOW:
            drive = self.held(self.cruise)
            if self.left() <= self.braking_way():
                self.phase = Phase.BRAKE
        elif self.phase is Phase.BRAKE:
            drive = -1.0
            if self.at_most() <= 1.5 * self.creep:
                self.phase = Phase.CREEP
        elif self.phase is Phase.CREEP:
            drive = self.held(self.creep)
            if self.left() <= 0.0:
                self.phase = Phase.ARRIVED
        self.blower.publish(Float32(data=float(drive)))
        self.state.publish(String(data=self.sender + ": " + self.phase.name.lower()))


def main():
    rclpy.init()
    rclpy.spin(TubePost())


if __name__ == "__main__":
    main()
