#!/usr/bin/env python3
"""Parking carousel: bring the requested bay to the gate, lock it, open the gate, and wait for the next request."""

import rclpy
from profiles import Approach
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, String, UInt8

COUNTS_PER_BAY = 4096.0


class Carousel(Node):
    """A state machine with one method per state, which returns the name of the next state."""

    TOLERANCE = 0.05  # distance within which the bolt finds its hole (bays)
    SETTLE = 4  # number of ticks within the tolerance before the bolt moves
    OPEN_FOR = 8  # ticks

    def __init__(self):
        super().__init__("carousel")
        self.approach = Approach()
        self.states = {
            "idle": self.idle,
            "turn": self.turn,
            "lock": self.lock,
            "gate": self.gate,
        }
        self.state, self.ticks = "idle", 0
        self.counts, self.request, self.bolted = None, None, False
        self.drive = self.create_publisher(Float32, "motor/drive", 1)
        self.bolt = self.create_publisher(Bool, "bolt/close", 1)
        self.open = self.create_publisher(Bool, "gate/open", 1)
        self.show = self.create_publisher(String, "carousel/state", 1)
        self.create_subscription(Float32, "motor/counts", lambda m: setattr(self, "counts", m.data), 1)
        self.create_subscription(UInt8, "gate/request", lambda m: setattr(self, "request", m.data), 1)
        self.create_subscription(Bool, "bolt/closed", lambda m: setattr(self, "bolted", m.data), 1)
        self.create_timer(0.1, self.tick)

    @property
    def error(self):
        """Return the number of bays still to go."""
        return self.request - self.counts / COUNTS_PER_BAY

    def idle(self):
        self.drive.publish(Float32(data=0.0))
        self.bolt.publish(Bool(data=False))
        if self.request is None or self.counts is None or abs(self.error) < self.TOLERANCE:
            return "idle"
        self.approach.reset()
        return "turn"

    def turn(self):
        error = self.error
        self.drive.publish(Float32(data=self.approach.drive(error, self.TOLERANCE)))
        if abs(error) >= self.TOLERANCE:
            self.ticks = 0
        return "lock" if self.ticks >= self.SETTLE else "turn"

    def lock(self):
        self.drive.publish(Float32(data=0.0))
        self.bolt.publish(Bool(data=True))
        return "gate" if self.bolted else "lock"

    def gate(self):
        self.open.publish(Bool(data=self.ticks < self.OPEN_FOR))
        return "gate" if self.ticks < self.OPEN_FOR else "idle"

    def tick(self):
        after = self.states[self.state]()
        self.ticks = self.ticks + 1 if after == self.state else 0
        self.state = after
        self.show.publish(String(data=after))


def main():
    rclpy.init()
    rclpy.spin(Carousel())


if __name__ == "__main__":
    main()
