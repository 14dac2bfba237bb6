#!/usr/bin/env python3
"""Pinsetter of a bowling lane: counts the pins that a ball leaves, lifts them, sweeps the deck, and sets them again.

After the second ball of a frame, or a strike, the deck is swept empty and gets ten new pins.
"""

from dataclasses import dataclass

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Int32, String

SETTLE = 2.6  # s from the ball in the pit until the pins that still stand are at rest
SCAN = 0.6  # s
MOVES = {
    # s of each movement of the machine
    "lower": 1.0,
    "lift": 1.0,
    "sweep": 1.6,
    "set": 1.4,
}
ALL = 10


@dataclass
class Frame:
    ball: int = 1
    standing: int = ALL

    def next_ball(self, left):
        """Note how many pins are left; return whether the frame is over."""
        self.standing = left
        self.ball += 1
        return left == 0 or self.ball > 2


class BowlingSetter(Node):
    def __init__(self):
        super().__init__("bowling_setter")
        self.votes = self.declare_parameter("scan_votes", 3).value
        self.lane = self.declare_parameter("lane", 7).value
        self.state = "ready"
        self.since = self.now()
        self.frame = Frame()
        self.frames = 0
        self.counts = []
        self.over = False
        self.pit_seen = False
        self.machine_pub = self.create_publisher(String, "machine/move", 1)
        self.light_pub = self.create_publisher(Bool, "lane/ready", 1)
        self.score_pub = self.create_publisher(Int32, "lane/fallen", 5)
        self.create_subscription(Bool, "pit/ball", self.on_ball, 5)
        self.create_subscription(Int32, "camera/standing", self.on_count, 5)
        self.create_timer(0.2, self.cycle)

    def now(self):
        return self.get_clock().now().nanoseconds / 1e9

    def on_ball(self, msg):
        if msg.data and self.state == "ready":
            self.pit_seen = True

    def on_count(self, msg):
        if self.state == "scan":
            self.counts.append(msg.data)

    def go(self, state):
        self.state = state
        self.since = self.now()
        if state in MOVES:
            self.machine_pub.publish(String(data=state))

    def elapsed(self):
        return self.now() - self.since

    def left(self):
        """Return the count that most of the last pictures agree about."""
        last = self.counts[-self.votes :]
        return max(set(last), key=last.count)

    def score(self):
        left = self.left()
        fallen = self.frame.standing - left
        if fallen < 0:
            self.get_logger().warning(f"lane {self.lane}: {left} pins after {self.frame.standing}")
            fallen = 0
        self.score_pub.publish(Int32(data=fallen))
        self.over = self.frame.next_ball(left)

    def after(self, move):
        """Go on after a movement."""
        if move == "lower":
            self.go("lift")
        elif move == "lift":
            self.go("sweep")
        elif move == "sweep":
            if self.over:
                self.frame = Frame()
                self.frames += 1
            self.go("set")
        else:
            self.go("ready")

    def cycle(self):
        if self.state == "ready":
            if self.pit_seen:
                self.pit_seen = False
                self.counts = []
                self.go("settle")
        elif self.state == "settle":
            if self.elapsed() >= SETTLE:
                self.go("scan")
        elif self.state == "scan":
            if self.elapsed() >= SCAN and self.counts:
                self.score()
                self.go("sweep" if self.over else "lower")
        elif self.elapsed() >= MOVES[self.state]:
            self.after(self.state)
        self.light_pub.publish(Bool(data=self.state == "ready"))


def main(args=None):
    rclpy.init(args=args)
    setter = BowlingSetter()
    rclpy.spin(setter)
    setter.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
