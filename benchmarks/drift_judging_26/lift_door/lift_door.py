#!/usr/bin/env python3
"""Opens and closes the door of a lift: waits for those who walk in and out, and opens again if it is blocked."""

from typing import NamedTuple

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Int32, String

CLOSED, OPENING, OPEN, CLOSING, NUDGING = "closed", "opening", "open", "closing", "nudging"


class Times(NamedTuple):
    """Times in s."""

    first: float = 3.0  # open at least, after the door has opened
    after: float = 1.0  # open after the light curtain was free
    nudge: float = 25.0  # open at most, then close slowly
    buzzer: float = 18.0


class Watch:
    """A stopwatch that runs on the node's clock."""

    def __init__(self, node):
        self.clock = node.get_clock()
        self.start()

    def start(self):
        self.began = self.clock.now()

    @property
    def seconds(self):
        return (self.clock.now() - self.began).nanoseconds * 1e-9


class LiftDoor(Node):
    def __init__(self):
        super().__init__("lift_door")
        self.times = Times()
        self.fast = self.declare_parameter("speed", 0.45).value  # m/s
        self.slow = self.declare_parameter("nudge_speed", 0.15).value
        self.width = self.declare_parameter("width", 1.1).value  # m
        self.mode = CLOSED
        self.opened = Watch(self)
        self.free = Watch(self)
        self.blocked = False
        self.gap = None
        self.load = 0.0
        self.full_load = self.declare_parameter("full_load", 900.0).value  # kg
        self.reopened = 0
        self.calls = 0
        self.speed_pub = self.create_publisher(Float32, "door/speed", 1)
        self.mode_pub = self.create_publisher(String, "door/mode", 1)
        self.buzzer_pub = self.create_publisher(Bool, "door/buzzer", 1)
        self.stat_pub = self.create_publisher(Int32, "door/reopened", 1)
        self.create_subscription(Float32, "door/gap", self.on_gap, 5)
        self.create_subscription(Bool, "door/curtain", self.on_curtain, 5)
        self.create_subscription(Bool, "lift/at_floor", self.on_floor, 5)
        self.create_subscription(Float32, "cabin/load", self.on_load, 5)
        self.create_timer(0.1, self.tick)
        self.create_timer(10.0, lambda: self.stat_pub.publish(Int32(data=self.reopened)))

    def on_gap(self, msg):
        self.gap = msg.data

    def on_load(self, msg):
        if msg.data > self.full_load >= self.load:
            self.get_logger().warning(f"{msg.data:.0f} kg in the cabin")
        self.load = msg.data

    def on_curtain(self, msg):
        if self.blocked and not msg.data:
            self.free.start()
        self.blocked = msg.data
        if msg.data and self.mode == CLOSING:
            self.reopened += 1
            self.switch(OPENING)

    def on_floor(self, msg):
        if msg.data and self.mode == CLOSED and self.calls == 0:
            self.calls += 1
            self.switch(OPENING)
        elif not msg.data:
            self.calls = 0

    def switch(self, mode):
        self.mode = mode
        self.get_logger().debug(mode)

    def may_close(self):
        """Return whether nobody seems to walk in or out any more."""
        if self.blocked or self.load > self.full_load:
            return False
        return self.opened.seconds >= self.times.first and self.free.seconds >= self.times.after

    def tick(self):
        if self.gap is None:
            return
        speed = 0.0
        if self.mode == OPENING:
            speed = self.fast
            if self.gap >= self.width - 0.02:
                self.opened.start()
                self.switch(OPEN)
        elif self.mode == OPEN:
            if self.may_close():
                self.switch(CLOSING)
            elif self.opened.seconds > self.times.nudge:
                self.switch(NUDGING)
        elif self.mode in (CLOSING, NUDGING):
            speed = -self.fast if self.mode == CLOSING else -self.slow
            if self.gap <= 0.01:
                self.switch(CLOSED)
        self.buzzer_pub.publish(Bool(data=self.mode == NUDGING or self.opened.seconds > self.times.buzzer))
        self.speed_pub.publish(Float32(data=speed))
        self.mode_pub.publish(String(data=self.mode))


def main():
    rclpy.init()
    door = LiftDoor()
    rclpy.spin(door)
    door.destroy_node()


if __name__ == "__main__":
    main()
