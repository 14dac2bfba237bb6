"""Dispense a label onto each bottle: wait until it is at the peel edge, then feed the web as fast as the belt runs."""

from collections import deque

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Int32


class LabelApplicator(Node):
    """Both axes have the same encoder wheel; the wheel of the belt turns with the motor, before the pulleys."""

    def __init__(self):
        super().__init__("label_applicator")
        self.mm_per_count = self.declare_parameter("mm_per_count", 0.40).value
        self.belt_ratio = self.declare_parameter("belt_ratio", 1.25).value  # pulleys 50:40
        self.eye_to_peel = self.declare_parameter("eye_to_peel", 180.0).value  # mm
        self.label_length = self.declare_parameter("label_length", 80.0).value  # length with the gap (mm)
        self.lead = self.declare_parameter("lead", 6.0).value  # distance in which the web starts (mm)
        self.slowing = self.declare_parameter("slowing", 12.0).value  # distance from the end of a label (mm)
        self.belt = None
        self.web = 0
        self.belt_speed = 0.0
        self.blocked = False
        self.waiting = deque()  # belt positions at which a bottle passed the eye (counts)
        self.feed_from = None
        self.create_subscription(Int32, "belt/counts", self.on_belt, 10)
        self.create_subscription(Int32, "web/counts", self.on_web, 10)
        self.create_subscription(Bool, "eye/blocked", self.on_eye, 10)
        self.feed = self.create_publisher(Float32, "web/speed", 10)
        self.line = self.create_publisher(Float32, "panel/metres_of_web", 10)
        self.period = 0.02
        self.create_timer(self.period, self.tick)

    def belt_mm(self, counts):
        """Return the way of the belt for a number of counts."""
        return counts * self.mm_per_count * self.belt_ratio

    def web_mm(self, counts):
        return counts * self.mm_per_count

    def on_belt(self, msg):
        if self.belt is not None:
            speed = self.belt_mm(msg.data - self.belt) / self.period
            self.belt_speed += 0.2 * (speed - self.belt_speed)
        self.belt = msg.data

    def on_web(self, msg):
        self.web = msg.data

    def on_eye(self, msg):
        if msg.data and not self.blocked and self.belt is not None:
            self.waiting.append(self.belt)
        self.blocked = msg.data

    def at_peel_edge(self):
        if not self.waiting:
            return False
        return self.belt_mm(self.belt - self.waiting[0]) >= self.eye_to_peel - self.lead

    def web_speed(self):
        fed = self.web_mm(self.web - self.feed_from)
        left = self.label_length - fed
        if left <= 1.0:
            self.feed_from = None
            return 0.0
        return self.belt_speed * max(0.25, min(1.0, left / self.slowing))

    def tick(self):
        if self.feed_from is None and self.at_peel_edge():
            self.waiting.popleft()
            self.feed_from = self.web
        speed = self.web_speed() if self.feed_from is not None else 0.0
        self.feed.publish(Float32(data=float(speed)))
        self.line.publish(Float32(data=self.web_mm(self.web) / 1000.0))


def main():
    rclpy.init()
    rclpy.spin(LabelApplicator())


if __name__ == "__main__":
    main()
